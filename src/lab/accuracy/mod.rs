//! Accuracy beside speed: what a method decides wrongly by the oracle, and what it costs, on the same rays.
//!
//! ```text
//! scene ─┬─ offset 0   ─┬─ rays ─── oracle: truths ─┐
//!        └─ offset 1e4  └─ …                        ├─▶ Accuracy
//!                          kernel × accelerator ────┤      +
//!                                                   └─▶ RunRecord (built, counted, checked and timed as in a sweep)
//! ```
//!
//! The scene is moved first and rounded to `f32`; the rays are made there. So the oracle judges the numbers that the
//! method sees, and an error is never one of the input. What counts as what: the table in `judge`. Samples of all runs
//! on the same rays are interleaved in seeded random order, as in a sweep; judging stands between building and timing.
//!
//! **Known bias.** What is judged is kernel and accelerator together; with an accelerator that obeys its rule it is the
//! kernel, except that a phantom outside its triangle's cell may be met by one structure and not by another.

pub(in crate::lab) mod judge;
mod moved;
mod record;

pub use record::{Accuracy, AccuracyBounds, UlpSpread};

use std::sync::Arc;

use rand_core::Rng;
use rand_pcg::Pcg32;

use crate::oracle::Oracle;
use crate::scene::{self, Scene};
use crate::trace::{self, RaySet};

use super::judge::Judge;
use super::live::{Live, Setting};
use super::machine::Pools;
use super::sampling::stop_reason;
use super::{Control, LabError, Plan, RunConfig, RunRecord, StopReason};

pub(super) use judge::Truths;

/// What is judged: the runs of a plan, at each offset.
#[derive(Debug, Clone, PartialEq)]
pub struct AccuracyPlan {
    /// Scenes, accelerators, kernels, ray sets and how they are timed.
    pub plan: Plan,
    /// How far the scene is moved along each axis: finite, not negative.
    pub offsets: Vec<f64>,
}

/// A run that was judged and timed.
#[derive(Debug, Clone, PartialEq)]
pub struct AccuracyRecord {
    /// As of a sweep; its id knows the offset.
    pub run: RunRecord,
    /// What the oracle found.
    pub accuracy: Accuracy,
}

/// What a running experiment tells.
#[derive(Debug, Clone)]
pub enum AccuracyEvent {
    /// Something goes on: share done, 0 to 1, and what.
    Doing {
        /// Share of the runs that are complete.
        done: f64,
        /// What is done now.
        what: String,
    },
    /// A run is complete.
    Finished {
        /// Everything found.
        record: Box<AccuracyRecord>,
    },
    /// A run could not be made; the experiment goes on.
    Failed {
        /// Why, one sentence.
        why: String,
    },
    /// The experiment has ended, complete or stopped.
    Ended {
        /// Whether it was stopped.
        stopped: bool,
    },
}

impl AccuracyPlan {
    /// Checks everything that can be checked before the first run.
    ///
    /// # Errors
    /// As [`Plan::check`]; no offset, or one that is negative or no number.
    pub fn check(&self) -> Result<(), LabError> {
        if self.offsets.is_empty() {
            return Err(LabError::Nothing { what: "offset" });
        }
        if let Some(&bad) = self.offsets.iter().find(|o| !(o.is_finite() && **o >= 0.0)) {
            return Err(LabError::Offset(bad.to_string()));
        }
        self.plan.check()
    }
}

/// Judges and times the runs of `plan` at each offset, by scene, offset, rays, kernel and accelerator, and tells `sink`
/// what happens. Runs whose samples were not complete when `control` stopped it are left out.
///
/// # Errors
/// The plan cannot be carried out at all; a run that fails is told and passed over.
pub fn accuracy(
    plan: &AccuracyPlan,
    control: &Control,
    sink: &mut dyn FnMut(AccuracyEvent),
) -> Result<(), LabError> {
    plan.check()?;
    let runs = plan.plan.runs();
    let mut experiment = Experiment {
        plan: &plan.plan,
        pools: &Pools::new(&plan.plan.threads)?,
        control,
        random: Pcg32::new(plan.plan.seed, 12),
        complete: 0,
        all: runs.len() * plan.offsets.len(),
        sink,
    };
    for of_scene in runs.chunk_by(|a, b| a.scene == b.scene) {
        let still = scene::load(&of_scene[0].scene)?;
        for &offset in &plan.offsets {
            experiment.place(&still, offset, of_scene);
        }
    }
    let stopped = experiment.complete < experiment.all;
    (experiment.sink)(AccuracyEvent::Ended { stopped });
    Ok(())
}

/// A scene in its place.
struct Place {
    scene: Scene,
    offset: f64,
    oracle: Arc<Oracle>,
}

/// Rays with their truths.
struct Course<'a> {
    place: &'a Place,
    set: Arc<RaySet>,
    truths: Truths,
}

struct Experiment<'a> {
    plan: &'a Plan,
    pools: &'a Pools,
    control: &'a Control,
    random: Pcg32,
    /// Runs that are complete or failed.
    complete: usize,
    all: usize,
    sink: &'a mut dyn FnMut(AccuracyEvent),
}

impl Experiment<'_> {
    fn place(&mut self, still: &Scene, offset: f64, runs: &[RunConfig]) {
        let scene = match moved::scene(still, offset) {
            Ok(scene) => scene,
            Err(why) => {
                let name = &runs[0].scene;
                let why = format!("'{name}' cannot be moved by {offset}: {why}");
                return self.fail(runs.len(), why);
            }
        };
        let place = Place {
            oracle: Arc::new(Oracle::new(&scene.mesh)),
            scene,
            offset,
        };
        for on_rays in runs.chunk_by(|a, b| a.rays == b.rays) {
            if self.control.stopped() {
                return;
            }
            match self.course(&place, &on_rays[0]) {
                Ok(course) => self.on_course(&course, on_rays),
                Err(why) => self.fail(on_rays.len(), why),
            }
        }
    }

    /// Rays and their truths.
    fn course<'p>(&mut self, place: &'p Place, run: &RunConfig) -> Result<Course<'p>, String> {
        let (scene, offset) = (&place.scene, place.offset);
        let name = format!("{} rays of {} at {offset}", run.rays, run.scene);
        self.tell(&format!("asking the oracle about {name}"));
        let all = self.pools.all();
        let set = all
            .install(|| moved::rays(scene, offset, &run.rays, run.ray_count, run.seed))
            .map_err(|why| why.to_string())?;
        if set.rays.is_empty() {
            return Err(format!("there are no {name}: choose another set or scene"));
        }
        let truths = all.install(|| Truths::new(&place.oracle, &scene.mesh, &set.rays));
        Ok(Course {
            place,
            set: Arc::new(set),
            truths,
        })
    }

    /// Judges and times all runs on the same rays, as many at once as fit into memory together.
    fn on_course(&mut self, course: &Course, runs: &[RunConfig]) {
        let mut live: Vec<(Live, Accuracy)> = Vec::new();
        let mut bytes = 0;
        for same in runs.chunk_by(|a, b| a.kernel == b.kernel && a.threads == b.threads) {
            let judge = match self.brute_force(course, &same[0]) {
                Ok(judge) => judge,
                Err(why) => {
                    self.fail(same.len(), why);
                    continue;
                }
            };
            for run in same {
                if self.control.stopped() {
                    return;
                }
                self.tell(&format!(
                    "judging {} in {} on {}",
                    run.kernel.name, run.accel.name, run.rays
                ));
                match self.prepare(course, run, &judge) {
                    Ok(one) => {
                        bytes += one.0.bytes();
                        live.push(one);
                    }
                    Err(why) => self.fail(1, why),
                }
                if bytes > self.plan.memory_limit {
                    self.sample(std::mem::take(&mut live));
                    bytes = 0;
                }
            }
        }
        self.sample(live);
    }

    fn brute_force(&self, course: &Course, run: &RunConfig) -> Result<Judge, String> {
        let place = course.place;
        let (budget, seed) = (&self.plan.budget, self.plan.seed);
        let judge = self.pools.all().install(|| {
            let mesh = &place.scene.mesh;
            Judge::new(mesh, &place.oracle, &run.kernel, &course.set, budget, seed)
        });
        judge.map_err(|why| why.to_string())
    }

    /// Builds, counts and checks as a sweep does, and asks both queries of the rays that will be timed.
    fn prepare(
        &self,
        course: &Course,
        run: &RunConfig,
        judge: &Judge,
    ) -> Result<(Live, Accuracy), String> {
        let place = course.place;
        let setting = Setting {
            plan: self.plan,
            pools: self.pools,
            mesh: &place.scene.mesh,
            set: &course.set,
            judge,
            threads: run.threads,
        };
        let live = Live::prepare(id(run, place.offset), run, &setting)?;
        let (accel, rays) = (live.accel(), live.rays());
        let found = self.pools.all().install(|| {
            let hits = trace::closest(accel, rays);
            let blocked = trace::occluded(accel, rays);
            let of_sample;
            let truths = if rays.len() == course.set.rays.len() {
                &course.truths
            } else {
                of_sample = Truths::new(&place.oracle, &place.scene.mesh, rays);
                &of_sample
            };
            truths.judge(rays, &hits, &blocked, place.offset)
        });
        Ok((live, found))
    }

    /// Takes a sample of each run in turn, in a new random order each round, until all are sampled enough.
    fn sample(&mut self, mut live: Vec<(Live, Accuracy)>) {
        let budget = &self.plan.budget;
        while !live.is_empty() {
            for i in (1..live.len()).rev() {
                let pick = (u64::from(self.random.next_u32()) * (i as u64 + 1)) >> 32;
                live.swap(i, pick as usize);
            }
            for (run, _) in &mut live {
                if self.control.stopped() {
                    return;
                }
                self.control.set_sampling(true);
                let pool = self.pools.of(run.record.config.threads);
                let (speed, took) = run.time(pool, budget.sample_seconds);
                self.control.set_sampling(false);
                run.speeds.push(speed);
                run.seconds += took;
            }
            self.tell("measuring");
            let mut going = Vec::with_capacity(live.len());
            for (run, found) in live {
                match stop_reason(&run.speeds, run.seconds, budget, self.plan.seed) {
                    None => going.push((run, found)),
                    Some(why) => self.finish(run, found, why),
                }
            }
            live = going;
        }
    }

    fn finish(&mut self, live: Live, accuracy: Accuracy, why: StopReason) {
        self.complete += 1;
        let run = live.finish(why);
        let record = Box::new(AccuracyRecord { run, accuracy });
        (self.sink)(AccuracyEvent::Finished { record });
    }

    fn fail(&mut self, runs: usize, why: String) {
        self.complete += runs;
        (self.sink)(AccuracyEvent::Failed { why });
    }

    fn tell(&mut self, what: &str) {
        (self.sink)(AccuracyEvent::Doing {
            done: self.complete as f64 / self.all.max(1) as f64,
            what: what.to_owned(),
        });
    }
}

/// The hash of a configuration in its place: that of the configuration itself where it was not moved.
fn id(run: &RunConfig, offset: f64) -> String {
    if offset == 0.0 {
        return run.id();
    }
    let mut moved = run.clone();
    moved.rays = format!("{} moved by {offset}", run.rays);
    moved.id()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel;
    use crate::lab::Budget;

    fn plan(kernels: &[&str], offsets: &[f64]) -> AccuracyPlan {
        AccuracyPlan {
            plan: Plan {
                scenes: vec!["sphereflake:1".to_owned()],
                accels: vec![crate::accel::parse("bvh").unwrap()],
                kernels: kernels.iter().map(|k| kernel::parse(k).unwrap()).collect(),
                rays: vec!["edge".to_owned()],
                threads: vec![1],
                ray_count: 2000,
                budget: Budget {
                    sample_seconds: 1e-4,
                    min_samples: 1,
                    run_seconds: 1e-3,
                    checked_rays: 64,
                    ..Budget::quick()
                },
                ..Plan::default()
            },
            offsets: offsets.to_vec(),
        }
    }

    fn found(plan: &AccuracyPlan) -> Vec<AccuracyRecord> {
        let mut records = Vec::new();
        accuracy(plan, &Control::default(), &mut |event| match event {
            AccuracyEvent::Finished { record } => records.push(*record),
            AccuracyEvent::Failed { why } => panic!("{why}"),
            _ => {}
        })
        .unwrap();
        records
    }

    #[test]
    fn far_from_the_origin_the_sheet_decides_more_edges_wrongly_than_woop() {
        let records = found(&plan(&["woop", "sheet-signed"], &[1e4]));
        let [woop, sheet] = ["woop", "sheet-signed"].map(|kernel| {
            let is = |r: &&AccuracyRecord| r.run.config.kernel.name == kernel;
            records.iter().find(is).unwrap().accuracy
        });
        assert_eq!((woop.rays, woop.offset), (2000, 1e4));
        // Only rims, where a ray touches the mesh from beside, are left to a watertight method.
        assert!(woop.wrong() < 40, "{woop:?}");
        assert!(sheet.wrong() > woop.wrong(), "{sheet:?} {woop:?}");
    }

    #[test]
    fn every_run_has_an_id_of_its_own_and_samples() {
        let records = found(&plan(&["woop", "moller-trumbore"], &[0.0, 1.0]));
        let ids: std::collections::BTreeSet<&str> =
            records.iter().map(|r| r.run.id.as_str()).collect();
        assert_eq!((records.len(), ids.len()), (4, 4));
        assert!(
            records
                .iter()
                .all(|r| !r.run.mrays_per_s.is_empty() && r.run.valid)
        );
    }

    #[test]
    fn a_stopped_experiment_tells_so_and_impossible_offsets_are_refused() {
        let control = Control::default();
        control.stop();
        let mut told = None;
        accuracy(&plan(&["woop"], &[0.0]), &control, &mut |event| {
            if let AccuracyEvent::Ended { stopped } = event {
                told = Some(stopped);
            }
        })
        .unwrap();
        assert_eq!(told, Some(true));
        for (offsets, part) in [(vec![], "no offset"), (vec![f64::NAN], "NaN")] {
            let why = plan(&["woop"], &offsets).check().unwrap_err().to_string();
            assert!(why.contains(part), "{why}");
        }
    }
}
