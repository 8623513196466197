//! What is asked for: a plan, and the configurations it stands for.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::accel;
use crate::kernel;
use crate::registry::Choice;
use crate::scene;
use crate::trace;

use super::{LabError, NRule};

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
    /// Bytes a structure may take; those that are sampled in turn stay within it together.
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
    /// Whether a sample is the whole set, however long a pass over it takes. Without it a run whose pass would burst its
    /// time takes a seeded subset, and so has other rays than runs beside it.
    #[serde(default)]
    pub whole_sets: bool,
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

/// Most threads that a plan may ask for.
pub const MAX_THREADS: usize = 1024;

/// Rays of a set when nothing else is asked for: a picture of 296 × 222.
const RAYS: usize = 1 << 16;

/// Rays of a set in a quick sweep: a picture of 148 × 111.
const QUICK_RAYS: usize = 1 << 14;

impl Default for Budget {
    /// For figures that are to be kept: ±1 % or two seconds of samples a run.
    fn default() -> Self {
        Self {
            sample_seconds: 0.02,
            min_samples: 11,
            max_samples: 101,
            relative_half_width: 0.01,
            run_seconds: 2.0,
            checked_rays: 4096,
            whole_sets: false,
        }
    }
}

impl Budget {
    /// For a first look: ±5 % or a quarter of a second of samples a run.
    #[must_use]
    pub fn quick() -> Self {
        Self {
            sample_seconds: 0.02,
            min_samples: 5,
            max_samples: 15,
            relative_half_width: 0.05,
            run_seconds: 0.25,
            checked_rays: 512,
            whole_sets: false,
        }
    }

    /// Checks that sampling begins and ends.
    fn check(&self) -> Result<(), LabError> {
        let positive = [
            ("sample_seconds", self.sample_seconds),
            ("relative_half_width", self.relative_half_width),
            ("run_seconds", self.run_seconds),
        ];
        // NaN is not greater than 0 either.
        let bad = positive.iter().find(|(_, x)| !(*x > 0.0 && x.is_finite()));
        if let Some((what, value)) = bad {
            return Err(LabError::Budget {
                what,
                value: value.to_string(),
                expected: "a number above 0",
            });
        }
        if self.min_samples == 0 || self.min_samples > self.max_samples {
            return Err(LabError::Budget {
                what: "min_samples",
                value: self.min_samples.to_string(),
                expected: "from 1 to max_samples",
            });
        }
        Ok(())
    }
}

impl Default for Plan {
    /// The plan that the lab opens with: the teapot, grids from 1 to 128 against brute force and the trees.
    fn default() -> Self {
        // A name that is not registered is left out, so the plan is always one that runs.
        let accels = ["brute", "grid", "kd-tree", "bvh"];
        Self {
            scenes: vec!["teapot".to_owned()],
            accels: accels.iter().filter_map(|a| accel::parse(a).ok()).collect(),
            n: (0..8).map(|k| NRule::Fixed(1 << k)).collect(),
            kernels: kernel::parse("woop").into_iter().collect(),
            rays: vec!["primary".to_owned()],
            threads: vec![super::cores()],
            ray_count: RAYS,
            seed: 1,
            budget: Budget::default(),
            memory_limit: 2 << 30,
        }
    }
}

impl Plan {
    /// The default plan, made quick.
    #[must_use]
    pub fn quick() -> Self {
        Self::default().quickened()
    }

    /// The same plan for a first look: fewer rays, a shorter budget.
    #[must_use]
    pub fn quickened(self) -> Self {
        Self {
            ray_count: QUICK_RAYS,
            budget: Budget::quick(),
            ..self
        }
    }

    /// Its runs in the order in which groups of them are measured: by scene, rays, kernel, threads, accelerator, n.
    /// A configuration that the lists name twice comes once.
    #[must_use]
    pub fn runs(&self) -> Vec<RunConfig> {
        let mut runs = Vec::new();
        for (scene, rays) in product(&self.scenes, &self.rays) {
            for (kernel, threads) in product(&self.kernels, &self.threads) {
                for (accel, n) in self.accels.iter().flat_map(|a| self.resolutions(a)) {
                    runs.push(RunConfig {
                        scene: scene.clone(),
                        accel: accel.clone(),
                        n,
                        kernel: kernel.clone(),
                        rays: rays.clone(),
                        threads: *threads,
                        ray_count: self.ray_count,
                        seed: self.seed,
                    });
                }
            }
        }
        let mut ids = BTreeSet::new();
        runs.retain(|run| ids.insert(run.id()));
        runs
    }

    /// `accel` with each n, or once without where it has no resolution.
    fn resolutions<'a>(&'a self, accel: &'a Choice) -> Vec<(&'a Choice, Option<NRule>)> {
        match accel::entry(&accel.name) {
            Ok(entry) if entry.resolution.is_some() => {
                self.n.iter().map(|n| (accel, Some(*n))).collect()
            }
            _ => vec![(accel, None)],
        }
    }

    /// Checks everything that can be checked before the first run.
    ///
    /// # Errors
    /// An empty list, an unknown name, a resolution, thread count, ray count or budget out of bounds, a file that is
    /// not there.
    pub fn check(&self) -> Result<(), LabError> {
        let lists = [
            ("scene", self.scenes.is_empty()),
            ("accelerator", self.accels.is_empty()),
            ("kernel", self.kernels.is_empty()),
            ("ray set", self.rays.is_empty()),
            ("thread count", self.threads.is_empty()),
        ];
        if let Some((what, _)) = lists.iter().find(|(_, empty)| *empty) {
            return Err(LabError::Nothing { what });
        }
        for accel in &self.accels {
            let entry = accel::entry(&accel.name)?;
            if entry.resolution.is_some() && self.n.is_empty() {
                return Err(LabError::Nothing {
                    what: "grid resolution",
                });
            }
            if let Some(why) = entry.standing().unavailable_because {
                return Err(LabError::Unavailable(why));
            }
        }
        for n in &self.n {
            if let NRule::Fixed(n) = n {
                super::parse_n_list(&n.to_string())?;
            }
        }
        for kernel in &self.kernels {
            kernel::parse(&kernel.name)?;
        }
        for threads in &self.threads {
            if !(1..=MAX_THREADS).contains(threads) {
                return Err(LabError::Threads(*threads));
            }
        }
        for scene in &self.scenes {
            scene::check(scene)?;
        }
        for rays in &self.rays {
            trace::check(rays, self.ray_count)?;
        }
        self.budget.check()
    }
}

impl RunConfig {
    /// A hash of the configuration: twelve hexadecimal digits, the same on every machine for the same configuration.
    ///
    /// How long and how often is measured does not enter.
    #[must_use]
    pub fn id(&self) -> String {
        // A struct of strings and numbers always serialises; its fields come in the order of their declaration and
        // parameters by name, so the text is canonical.
        let text = serde_json::to_string(self).unwrap_or_default();
        let digest = Sha256::digest(text.as_bytes());
        let start = digest.iter().take(6);
        let number = start.fold(0_u64, |number, byte| number << 8 | u64::from(*byte));
        format!("{number:012x}")
    }
}

fn product<'a, A, B>(a: &'a [A], b: &'a [B]) -> impl Iterator<Item = (&'a A, &'a B)> {
    a.iter().flat_map(|x| b.iter().map(move |y| (x, y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_the_product_and_structures_without_resolution_come_once() {
        let plan = Plan {
            scenes: vec!["teapot".to_owned(), "one".to_owned()],
            accels: vec![accel::parse("brute").unwrap(), accel::parse("bvh").unwrap()],
            rays: vec!["primary".to_owned(), "random".to_owned()],
            threads: vec![1, 2],
            ..Plan::default()
        };
        assert_eq!(plan.runs().len(), 2 * 2 * 2 * 2);
        assert!(plan.runs().iter().all(|run| run.n.is_none()));
    }

    #[test]
    fn a_run_that_is_named_twice_comes_once() {
        let mut plan = Plan::default();
        let once = plan.runs().len();
        plan.scenes.push(plan.scenes[0].clone());
        assert_eq!(plan.runs().len(), once);
    }

    #[test]
    fn ids_differ_in_whatever_the_configuration_differs_in() {
        let run = Plan::default().runs().remove(0);
        let changes: [fn(&mut RunConfig); 8] = [
            |r| r.scene.push('x'),
            |r| r.accel.name.push('x'),
            |r| r.n = Some(NRule::Auto),
            |r| r.kernel = kernel::parse("sheet-unsigned:eps=0.5").unwrap(),
            |r| r.rays.push('x'),
            |r| r.threads += 1,
            |r| r.ray_count += 1,
            |r| r.seed += 1,
        ];
        let mut ids = BTreeSet::from([run.id()]);
        for change in changes {
            let mut other = run.clone();
            change(&mut other);
            assert!(ids.insert(other.id()));
        }
        assert!(ids.iter().all(|id| id.len() == 12));
    }

    #[test]
    fn an_id_never_changes_from_one_version_to_the_next() {
        let run = RunConfig {
            scene: "teapot".to_owned(),
            accel: accel::parse("brute").unwrap(),
            n: None,
            kernel: kernel::parse("woop").unwrap(),
            rays: "primary".to_owned(),
            threads: 1,
            ray_count: 100,
            seed: 1,
        };
        assert_eq!(run.id(), "387316b867d3");
    }

    #[test]
    fn the_default_plans_can_be_carried_out() {
        assert_eq!(Plan::default().check(), Ok(()));
        assert_eq!(Plan::quick().check(), Ok(()));
    }

    #[test]
    fn a_plan_that_cannot_be_carried_out_is_refused_with_the_reason() {
        type Change = fn(&mut Plan);
        let changes: [(Change, &str); 10] = [
            (|p| p.scenes.clear(), "no scene"),
            (|p| p.kernels.clear(), "no kernel"),
            (|p| p.threads = vec![0], "0 threads"),
            (
                |p| p.scenes = vec!["teapt".to_owned()],
                "did you mean 'teapot'",
            ),
            (
                |p| p.rays = vec!["rndom".to_owned()],
                "did you mean 'random'",
            ),
            (
                |p| p.rays = vec!["file:no.rays".to_owned()],
                "cannot read no.rays",
            ),
            (|p| p.ray_count = 0, "0 rays"),
            (|p| p.n = vec![NRule::Fixed(4096)], "4096 is more than"),
            (|p| p.budget.run_seconds = f64::NAN, "run_seconds is NaN"),
            (|p| p.budget.min_samples = 999, "min_samples is 999"),
        ];
        for (change, part) in changes {
            let mut plan = Plan::default();
            change(&mut plan);
            let why = plan.check().unwrap_err().to_string();
            assert!(why.contains(part), "{why}");
        }
    }
}
