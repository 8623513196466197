//! `report.json` as types. The names are a contract; the schema beside this file states them for others.

use serde::{Deserialize, Serialize};

use crate::accel::{Prediction, StructureStats};
use crate::lab::{Accuracy, Checksum, PerRay, Plan, StopReason};
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
