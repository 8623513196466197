//! `report.json` as types. The names are a contract; the schema beside this file states them for others.

use serde::{Deserialize, Serialize};

use crate::accel::{Prediction, StructureStats};
use crate::lab::{Checksum, PerRay, Plan, StopReason};
use crate::registry::Params;
use crate::stats::Summary;

/// A whole report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Always [`Report::SCHEMA`].
    pub schema: String,
    /// Where and how it was measured.
    pub provenance: Provenance,
    /// What was asked for.
    pub config: Plan,
    /// What was measured.
    pub runs: Vec<Run>,
}

impl Report {
    /// The name and version of the format.
    pub const SCHEMA: &'static str = "raylab/report/1";
}

/// Where and how a report was measured.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Program version.
    pub version: String,
    /// Commit of the program, empty when unknown.
    pub commit: String,
    /// Whether the program had changes that are not in the commit.
    pub dirty: bool,
    /// Compiler.
    pub rustc: String,
    /// Target triple.
    pub target: String,
    /// `release` or `debug`.
    pub profile: String,
    /// CPU model.
    pub cpu: String,
    /// Cores that the program may use.
    pub cores: usize,
    /// Cache sizes in bytes: L1 data, L2, L3, as far as known.
    pub caches: Vec<u64>,
    /// Instruction set that the traversals use.
    pub instruction_set: String,
    /// Operating system.
    pub os: String,
    /// Load average over one minute when the sweep began; NaN is never written, unknown is -1.
    pub load: f64,
    /// Start, RFC 3339 in UTC.
    pub date: String,
    /// The command line.
    pub command: Vec<String>,
    /// Seeds by purpose.
    pub seed: u64,
    /// The scenes.
    pub scenes: Vec<SceneFacts>,
}

/// What identifies a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneFacts {
    /// Spec.
    pub name: String,
    /// SHA-256 of vertices and triangles, hexadecimal.
    pub hash: String,
    /// Triangles.
    pub triangles: u64,
    /// Of these, without area.
    pub degenerate: u64,
}

/// One measured configuration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Hash of the configuration.
    pub id: String,
    /// Scene spec.
    pub scene: String,
    /// Triangles.
    pub triangles: u64,
    /// Accelerator.
    pub accel: String,
    /// Its parameters and the kernel's; `n_rule: "auto"` where the predictor chose n.
    pub params: Params,
    /// Resolution.
    pub n: Option<u32>,
    /// Kernel.
    pub kernel: String,
    /// Ray set.
    pub rays: String,
    /// Rays of a sample.
    pub ray_count: u64,
    /// Threads.
    pub threads: usize,
    /// Build time in milliseconds.
    pub build_ms: Summary,
    /// Structure and packed triangles.
    pub memory_bytes: u64,
    /// Speed.
    pub mrays_per_s: Summary,
    /// What ended the sampling.
    #[serde(default)]
    pub stopped_by: StopReason,
    /// Counted work.
    pub per_ray: PerRay,
    /// Sizes and shape.
    pub structure: StructureStats,
    /// What the model predicts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub predicted: Option<Prediction>,
    /// What identifies the answers.
    pub checksum: Checksum,
    /// Whether every checked ray obeys the rule.
    pub valid: bool,
    /// Rays checked against brute force.
    pub checked_rays: u64,
    /// Rays on which the kernel itself errs and the answers differ.
    pub kernel_errors: u64,
    /// How often the kernel was wrong by the oracle, where that was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<Accuracy>,
    /// What a reader should know.
    pub warnings: Vec<String>,
}

/// How often a kernel was wrong on some rays, by the oracle.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// Rays that were judged.
    pub rays: u64,
    /// The ray hits, the method misses.
    pub leaks: u64,
    /// The method hits, the ray misses.
    pub phantoms: u64,
    /// Another triangle than any nearest one, at another t.
    pub wrong_surface: u64,
    /// Another triangle than any nearest one, on the same surface.
    pub neighbour_swaps: u64,
    /// Error of t over right hits, in units of the last place.
    pub t_ulp: UlpSpread,
    /// Upper ends of the 95 % intervals of the rates.
    pub upper95: AccuracyBounds,
}

/// Percentiles of an error in units of the last place.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct UlpSpread {
    /// Median.
    pub p50: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Greatest.
    pub max: f64,
}

/// Upper bounds of rates, 0 to 1.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct AccuracyBounds {
    /// Of leaks.
    pub leaks: f64,
    /// Of phantoms.
    pub phantoms: f64,
    /// Of wrong surfaces.
    pub wrong_surface: f64,
    /// Of neighbour swaps.
    pub neighbour_swaps: f64,
}
