//! Experiments: from a plan to raw samples. Nothing here writes files, prints, or draws; what happens is told to a
//! sink as [`Event`]s.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use serde::{Deserialize, Serialize};

use crate::accel::{Prediction, StructureStats};
use crate::registry::Choice;

/// A grid resolution as asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NRule {
    /// The predictor chooses.
    Auto,
    /// This one.
    Fixed(u32),
}

/// What a sweep varies. Its runs are the product of the lists; accelerators without a resolution run once for all n.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Scene specs.
    pub scenes: Vec<String>,
    /// Accelerators with their parameters.
    pub accels: Vec<Choice>,
    /// Grid resolutions.
    pub n: Vec<NRule>,
    /// Kernels with their parameters.
    pub kernels: Vec<Choice>,
    /// Ray set specs: `primary`, `random`, `file:PATH`, …
    pub rays: Vec<String>,
    /// Thread counts.
    pub threads: Vec<usize>,
    /// Rays asked for in a set.
    pub ray_count: usize,
    /// Seed of ray sets and of the order of samples.
    pub seed: u64,
    /// When sampling stops.
    pub budget: Budget,
    /// Bytes a structure may take.
    pub memory_limit: u64,
}

/// When sampling of a run stops, and how much is checked.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Budget {
    /// Least length of a sample in seconds; a ray set is traced repeatedly until it is reached.
    pub sample_seconds: f64,
    /// Fewest samples of a run.
    pub min_samples: usize,
    /// Most samples of a run.
    pub max_samples: usize,
    /// Sampling stops when the half-width of the interval is within this share of the median, …
    pub relative_half_width: f64,
    /// … or when the run's samples took this many seconds.
    pub run_seconds: f64,
    /// Rays checked against brute force.
    pub checked_rays: usize,
}

/// One configuration: what a run measures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunConfig {
    /// Scene spec.
    pub scene: String,
    /// Accelerator and its parameters.
    pub accel: Choice,
    /// Resolution; `None` for accelerators without one.
    pub n: Option<NRule>,
    /// Kernel and its parameters.
    pub kernel: Choice,
    /// Ray set spec.
    pub rays: String,
    /// Threads.
    pub threads: usize,
}

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

/// What was measured of one configuration: raw samples, counts, checks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Hash of the configuration.
    pub id: String,
    /// The configuration.
    pub config: RunConfig,
    /// The resolution that was built.
    pub n: Option<u32>,
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
    /// Counted work.
    pub per_ray: PerRay,
    /// Sizes and shape.
    pub structure: StructureStats,
    /// What the model predicts, where there is one.
    pub predicted: Option<Prediction>,
    /// What identifies the answers.
    pub checksum: Checksum,
    /// Whether every checked ray obeys the rule of `accel`.
    pub valid: bool,
    /// Rays checked against brute force.
    pub checked_rays: u64,
    /// Of these, rays on which the kernel itself errs and the answers differ.
    pub kernel_errors: u64,
    /// What a reader of the figures should know, one sentence each.
    pub warnings: Vec<String>,
}

/// What a running sweep tells.
#[derive(Debug, Clone)]
pub enum Event {
    /// The runs that will be made, those already finished left out.
    Started {
        /// Their ids and configurations, in plan order.
        runs: Vec<(String, RunConfig)>,
    },
    /// A structure is being built.
    Building {
        /// The run.
        id: String,
    },
    /// A structure stands; its counted pass is done.
    Built {
        /// The record so far: no speeds yet.
        record: Box<RunRecord>,
    },
    /// A sample was taken.
    Sampled {
        /// The run.
        id: String,
        /// Speed in millions of rays a second.
        mrays_per_s: f64,
        /// Share of the sweep that is done, 0 to 1.
        done: f64,
        /// Estimated seconds to the end.
        seconds_left: f64,
    },
    /// A run is complete.
    Finished {
        /// Everything measured.
        record: Box<RunRecord>,
    },
    /// A run could not be made; the sweep goes on.
    Failed {
        /// The run.
        id: String,
        /// Why, one sentence.
        why: String,
    },
    /// The sweep has ended, complete or stopped.
    Ended {
        /// Whether it was stopped.
        stopped: bool,
    },
}

/// How others steer a running sweep, and say that they disturb it.
#[derive(Debug, Default)]
pub struct Control {
    stop: AtomicBool,
    paused: AtomicBool,
    sampling: AtomicBool,
    disturbances: AtomicU64,
}

impl Control {
    /// Asks the sweep to end after the sample in progress.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }
    /// Whether it was asked to end.
    pub fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
    /// Asks the sweep to wait before the next sample, or to go on.
    pub fn pause(&self, paused: bool) {
        self.paused.store(paused, Ordering::Relaxed);
    }
    /// Whether it was asked to wait.
    pub fn paused(&self) -> bool {
        self.paused.load(Ordering::Relaxed)
    }
    /// Whether a sample is being timed right now.
    pub fn sampling(&self) -> bool {
        self.sampling.load(Ordering::Relaxed)
    }
    /// Said by the sweep before and after each sample.
    pub fn set_sampling(&self, sampling: bool) {
        self.sampling.store(sampling, Ordering::Relaxed);
    }
    /// Says that something took time from the sample in progress: the sweep takes that sample again.
    pub fn disturb(&self) {
        self.disturbances.fetch_add(1, Ordering::Relaxed);
    }
    /// How often the sweep was disturbed.
    pub fn disturbances(&self) -> u64 {
        self.disturbances.load(Ordering::Relaxed)
    }
}
