//! What was measured of one configuration, in raw form.

use serde::{Deserialize, Serialize};

use crate::accel::{Prediction, StructureStats};

use super::RunConfig;

/// Mean and percentiles of one count over the rays of a set.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Median.
    pub p50: u64,
    /// 99th percentile.
    pub p99: u64,
    /// Greatest.
    pub max: u64,
}

/// The work of a ray.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct PerRay {
    /// Cells or nodes visited.
    pub steps: Spread,
    /// Of these, cells or leaves without a reference.
    pub empty_steps: Spread,
    /// Ray/triangle tests.
    pub tests: Spread,
    /// Of these, tests of a triangle that the ray had tested before.
    pub duplicate_tests: Spread,
}

/// What identifies the answers of a run: equal for all right accelerators with the same kernel and rays.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Checksum {
    /// Rays that hit, or are blocked.
    pub hits: u64,
    /// Sum of the triangle indices hit, modulo 2^53 so that JSON readers keep it exact.
    pub id_sum: u64,
    /// Sum of t over hits in ray order, in f64.
    pub t_sum: f64,
}

/// What ended the sampling of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StopReason {
    /// Nothing yet: the run is not complete.
    #[default]
    Unfinished,
    /// The interval of the median became as narrow as asked for.
    Interval,
    /// The run's samples took the time they may take.
    Time,
    /// The greatest number of samples was taken.
    Samples,
}

/// What was measured of one configuration: raw samples, counts, checks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Hash of the configuration.
    pub id: String,
    /// The configuration.
    pub config: RunConfig,
    /// The resolution that was built.
    pub n: Option<u32>,
    /// What `auto` picked, as it is written on the command line; `None` for the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picked: Option<String>,
    /// Triangles of the scene.
    pub triangles: u64,
    /// Rays of a sample.
    pub ray_count: u64,
    /// Build times in milliseconds.
    pub build_ms: Vec<f64>,
    /// Structure and packed triangles.
    pub memory_bytes: u64,
    /// Speeds in millions of rays a second, in the order in which they were taken.
    pub mrays_per_s: Vec<f64>,
    /// What ended the sampling.
    pub stopped_by: StopReason,
    /// Counted work; `None` for peers, which count none.
    pub per_ray: Option<PerRay>,
    /// Sizes and shape; `None` where a peer tells nothing.
    pub structure: Option<StructureStats>,
    /// What the model predicts, where there is one.
    pub predicted: Option<Prediction>,
    /// What identifies the answers.
    pub checksum: Checksum,
    /// Whether every checked ray obeys the rule of `accel`; of a peer, whether it answered none of them wrongly.
    pub valid: bool,
    /// Rays checked against brute force.
    pub checked_rays: u64,
    /// Of these, rays on which the kernel itself errs and the answers differ.
    pub kernel_errors: u64,
    /// Of the checked rays, those that a peer answers wrongly by the oracle: leaks, phantoms and wrong surfaces; `None` for
    /// raylab's own accelerators.
    #[serde(default)]
    pub wrong_answers: Option<u64>,
    /// What a reader of the figures should know, one sentence each.
    pub warnings: Vec<String>,
}
