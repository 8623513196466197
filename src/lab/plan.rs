//! What is asked for: a plan, and the configurations it stands for.

use serde::{Deserialize, Serialize};

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
    /// Rays asked for in the set.
    pub ray_count: usize,
    /// Seed of the ray set.
    pub seed: u64,
}
