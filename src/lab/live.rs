//! A run in progress: its structure stands, its work is counted and its answers are checked; samples are being taken.

use std::sync::Arc;
use std::time::Instant;

use rayon::ThreadPool;

use crate::accel::{self, Accelerator, AcceleratorEntry, StructureStats};
use crate::geometry::Ray;
use crate::scene::Mesh;
use crate::trace::RaySet;

use super::answers::{Answers, Findings};
use super::judge::Judge;
use super::machine::{self, Pools};
use super::subset::{measured, stratified};
use super::{NRule, PerRay, Plan, RunConfig, RunRecord, StopReason, sampling};

/// A build shorter than this many milliseconds is made three times, so that its median is of a warm allocator: a first build
/// takes up to twice as long (`grid-skip` on `sphereflake:4` 850 ms, where the median of three is 344), and beside smaller ones
/// would pass for how costs grow, …
const CHEAP_MS: f64 = 1000.0;
/// … and one shorter than this five times.
const VERY_CHEAP_MS: f64 = 10.0;

/// What all runs with the same scene, rays and kernel share.
pub(super) struct Setting<'a> {
    pub plan: &'a Plan,
    pub pools: &'a Pools,
    pub mesh: &'a Arc<Mesh>,
    pub set: &'a Arc<RaySet>,
    pub judge: &'a Judge,
}

/// A run in progress.
pub(super) struct Live {
    accel: Box<dyn Accelerator>,
    /// The rays of a sample; those of the whole set are shared.
    rays: Option<Vec<Ray>>,
    set: Arc<RaySet>,
    /// The counted answers, which timed ones must equal.
    expected: Answers,
    /// Where timed answers go.
    room: Answers,
    findings: Findings,
    /// Everything but the speeds.
    pub record: RunRecord,
    pub speeds: Vec<f64>,
    /// Seconds that samples took, discarded ones included.
    pub seconds: f64,
    /// Samples kept although something disturbed them.
    pub disturbed: usize,
    /// Samples taken over from an interrupted sweep.
    pub resumed: usize,
}

impl Live {
    /// Builds, counts and checks.
    ///
    /// # Errors
    /// One sentence why there is no such structure.
    pub fn prepare(id: String, config: &RunConfig, at: &Setting) -> Result<Self, String> {
        let entry = accel::entry(&config.accel.name).map_err(|why| why.to_string())?;
        let n = resolution(entry, config, at.mesh);
        let pool = at.pools.of(config.threads);
        let (accel, build_ms) = build(config, n, at, pool)?;
        let all = at.pools.all();
        let (plan, query) = (at.plan, at.set.query);
        let count = all.install(|| measured(&*accel, query, &at.set.rays, &plan.budget, plan.seed));
        let rays: Option<Vec<Ray>> = (count < at.set.rays.len()).then(|| {
            let chosen = stratified(at.set.rays.len(), count, plan.seed);
            chosen.into_iter().map(|i| at.set.rays[i]).collect()
        });
        let of_sample: &[Ray] = rays.as_deref().unwrap_or(&at.set.rays);
        let (expected, counts) = all.install(|| Answers::counted(&*accel, query, of_sample));
        let whole_set = rays.is_none().then_some(&expected);
        let findings = all.install(|| at.judge.check(&*accel, whole_set));
        let is_peer = entry.peer.is_some();
        let wrong_answers =
            is_peer.then(|| all.install(|| at.judge.wrong_answers(&*accel, whole_set)));
        let structure = accel.stats();
        let record = RunRecord {
            id,
            config: config.clone(),
            n,
            picked: accel::picked(&config.accel, at.mesh),
            triangles: at.mesh.len() as u64,
            ray_count: count as u64,
            build_ms,
            memory_bytes: accel.memory_bytes(),
            mrays_per_s: Vec::new(),
            stopped_by: StopReason::Unfinished,
            per_ray: (!is_peer).then(|| PerRay::of(&counts)),
            structure: (!is_peer || structure != StructureStats::default()).then_some(structure),
            predicted: prediction(entry, config, at.mesh, n),
            checksum: expected.checksum(),
            valid: wrong_answers.unwrap_or(findings.broken) == 0,
            checked_rays: at.judge.checked_rays(),
            kernel_errors: findings.kernel_errors,
            wrong_answers,
            warnings: warnings(at, count, config.threads),
        };
        let mut live = Self {
            accel,
            rays,
            set: Arc::clone(at.set),
            room: Answers::room(query, count),
            expected,
            findings,
            record,
            speeds: Vec::new(),
            seconds: 0.0,
            disturbed: 0,
            resumed: 0,
        };
        // A pass that is not a sample: it warms caches and predictors, and its answers are checked like all others.
        let _ = live.time(pool, 0.0);
        live.check_room(at.judge);
        Ok(live)
    }

    /// Threads that it is timed on.
    pub fn threads(&self) -> usize {
        self.record.config.threads
    }

    /// The structure.
    pub fn accel(&self) -> &dyn Accelerator {
        &*self.accel
    }

    /// The rays of a sample.
    pub fn rays(&self) -> &[Ray] {
        self.rays.as_deref().unwrap_or(&self.set.rays)
    }

    /// Bytes that the run holds in memory beside the ray set.
    pub fn bytes(&self) -> u64 {
        let rays = self.record.ray_count;
        // Two lists of hits at 16 bytes, and rays of its own at 32.
        self.record.memory_bytes + 32 * rays + 32 * rays * u64::from(self.rays.is_some())
    }

    /// Traces all rays again and again for at least `seconds`, and returns the speed in millions of rays a second and
    /// the seconds that it took.
    pub fn time(&mut self, pool: &ThreadPool, seconds: f64) -> (f64, f64) {
        let mut room = std::mem::replace(&mut self.room, Answers::Blocked(Vec::new()));
        let (accel, rays) = (&*self.accel, self.rays());
        let timed = pool.install(|| room.time(accel, rays, seconds));
        self.room = room;
        timed
    }

    /// Checks the answers of the last timed pass against the counted ones.
    pub fn check_room(&mut self, judge: &Judge) {
        let findings = judge.check_differences(self.rays(), &self.expected, &self.room);
        self.findings.merge(findings);
    }

    /// The complete record.
    pub fn finish(mut self, stopped_by: StopReason) -> RunRecord {
        self.record.stopped_by = stopped_by;
        self.record.valid = self.record.wrong_answers.unwrap_or(self.findings.broken) == 0;
        self.record.kernel_errors = self.findings.kernel_errors;
        self.record
            .warnings
            .extend(sampling::warnings(&self.speeds));
        if self.disturbed > 0 {
            let count = self.disturbed;
            self.record.warnings.push(format!(
                "{count} samples were disturbed each time they were taken"
            ));
        }
        if self.resumed > 0 {
            let count = self.resumed;
            self.record
                .warnings
                .push(format!("{count} samples are from before an interruption"));
        }
        self.record.mrays_per_s = self.speeds;
        self.record
    }
}

/// The n that is built; `None` for structures without one.
fn resolution(entry: &AcceleratorEntry, config: &RunConfig, mesh: &Mesh) -> Option<u32> {
    let resolution = entry.resolution?;
    Some(match config.n {
        Some(NRule::Fixed(n)) => n,
        Some(NRule::Auto) | None => (resolution.auto)(mesh, &config.accel.params),
    })
}

/// What the model predicts; `None` where there is no model, or where it leaves the range of numbers.
fn prediction(
    entry: &AcceleratorEntry,
    config: &RunConfig,
    mesh: &Mesh,
    n: Option<u32>,
) -> Option<accel::Prediction> {
    let predicted = (entry.resolution?.predict)(mesh, &config.accel.params, n?);
    let figures = [predicted.references, predicted.steps, predicted.tests];
    figures.iter().all(|x| x.is_finite()).then_some(predicted)
}

/// Builds, several times where that is cheap, and returns the last structure with all build times.
fn build(
    config: &RunConfig,
    n: Option<u32>,
    at: &Setting,
    pool: &ThreadPool,
) -> Result<(Box<dyn Accelerator>, Vec<f64>), String> {
    let once = || {
        pool.install(|| {
            let start = Instant::now();
            let limit = at.plan.memory_limit;
            let built = accel::build(at.mesh, &config.accel, n, &config.kernel, limit);
            built
                .map(|accel| (accel, start.elapsed().as_secs_f64() * 1e3))
                .map_err(|why| why.to_string())
        })
    };
    pool.install(machine::warm_up);
    let (mut accel, first) = once()?;
    let mut times = vec![first];
    let builds = match first {
        ms if ms < VERY_CHEAP_MS => 5,
        ms if ms < CHEAP_MS => 3,
        _ => 1,
    };
    while times.len() < builds {
        // Never two at once in memory.
        drop(accel);
        let (again, ms) = once()?;
        accel = again;
        times.push(ms);
    }
    Ok((accel, times))
}

/// What is known to a reader's care before the first sample.
fn warnings(at: &Setting, count: usize, threads: usize) -> Vec<String> {
    let mut warnings = at.set.warnings.clone();
    if count < at.set.rays.len() {
        warnings.push(format!(
            "measured on a seeded sample of {count} of {} rays: all of them would exceed the time budget",
            at.set.rays.len()
        ));
    }
    warnings.extend(machine::warnings(threads));
    warnings
}
