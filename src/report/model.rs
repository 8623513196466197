//! `report.json` as types. The names are a contract; the schema beside this file states them for others.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::accel::{Prediction, StructureStats};
use crate::lab::{Accuracy, AccuracyPlan, Checksum, PerRay, Plan, RunConfig, StopReason};
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
    /// Where scenes were judged, where `accuracy` made the report.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub judged: Option<Places>,
    /// What was measured.
    pub runs: Vec<Run>,
}

impl Report {
    /// The name and version of the format.
    pub const SCHEMA: &'static str = "raylab/report/1";

    /// What was asked of `accuracy`; `None` where the report is one of a sweep.
    #[must_use]
    pub fn accuracy_plan(&self) -> Option<AccuracyPlan> {
        let places = self.judged.as_ref()?;
        Some(AccuracyPlan {
            plan: self.config.clone(),
            offsets: places.offsets.clone(),
            scales: places.scales.clone(),
        })
    }

    /// The ids of all runs that were asked for, in the order of the plan.
    #[must_use]
    pub fn planned_ids(&self) -> Vec<String> {
        match self.accuracy_plan() {
            Some(plan) => plan.runs().into_iter().map(|run| run.id).collect(),
            None => self.config.runs().iter().map(RunConfig::id).collect(),
        }
    }

    /// Puts the runs into the order of the plan; those that it does not know come last.
    pub fn put_in_order(&mut self) {
        let order: BTreeMap<String, usize> = self.planned_ids().into_iter().zip(0..).collect();
        self.runs
            .sort_by_key(|run| order.get(&run.id).copied().unwrap_or(usize::MAX));
    }
}

/// Where scenes were judged: at each offset at each scale.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Places {
    /// How far they were moved along each axis.
    pub offsets: Vec<f64>,
    /// Factors about the world's origin, before that.
    pub scales: Vec<f64>,
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
    /// Instruction set that traversals in lanes use: `avx512`, `avx2` or `portable`.
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
    /// Its parameters and the kernel's; `n_rule: "auto"` where the predictor chose n, `picked: "bvh-wide:…"` what
    /// `auto` built.
    pub params: Params,
    /// Resolution.
    pub n: Option<u32>,
    /// What decided hits: the kernel, or a peer's own test.
    pub kernel: String,
    /// Where a peer's own test decided: the kernel, with its parameters, of the runs that it was measured beside.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beside_kernel: Option<String>,
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
    /// Counted work; `None` for peers, which count none.
    pub per_ray: Option<PerRay>,
    /// Sizes and shape; `None` where a peer tells nothing.
    pub structure: Option<StructureStats>,
    /// What the model predicts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub predicted: Option<Prediction>,
    /// What identifies the answers.
    pub checksum: Checksum,
    /// Whether every checked ray obeys the rule; of a peer, whether it answered none of them wrongly.
    pub valid: bool,
    /// Rays checked against brute force.
    pub checked_rays: u64,
    /// Rays on which the kernel itself errs and the answers differ.
    pub kernel_errors: u64,
    /// Of the checked rays, those that a peer answers wrongly by the oracle; `None` for raylab's own accelerators, whose
    /// answers must obey the rule.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wrong_answers: Option<u64>,
    /// Where a report joins several sweeps: which of them made the run. Samples of runs of one sweep on the same rays of a
    /// scene were interleaved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<u32>,
    /// How often the kernel was wrong by the oracle, where that was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<Accuracy>,
    /// What a reader should know.
    pub warnings: Vec<String>,
}

impl Run {
    /// Cells or nodes that a ray visits, mean; `None` where they were not counted.
    #[must_use]
    pub fn steps(&self) -> Option<f64> {
        self.per_ray.map(|work| work.steps.mean)
    }

    /// Ray/triangle tests of a ray, mean; `None` where they were not counted.
    #[must_use]
    pub fn tests(&self) -> Option<f64> {
        self.per_ray.map(|work| work.tests.mean)
    }

    /// Whether it must be taken for wrong: raylab's own accelerators promise right answers, peers do not.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        !self.valid && self.wrong_answers.is_none()
    }
}
