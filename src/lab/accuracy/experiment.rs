//! The experiment itself: places, ray sets with their truths, runs judged and then timed in turn.

use std::sync::Arc;
use std::time::Instant;

use rand_pcg::Pcg32;

use crate::accel::{self, AcceleratorEntry};
use crate::lab::judge::Judge;
use crate::lab::live::{Live, Setting};
use crate::lab::machine::{Awake, Pools};
use crate::lab::sampling::{order_round, stop_reason};
use crate::lab::{Control, Done, LabError, Plan, RunConfig, StopReason};
use crate::oracle::Oracle;
use crate::scene::{self, Scene};
use crate::trace::RaySet;

use super::judge::Truths;
use super::probe::{Probed, Probes};
use super::{
    Accuracy, AccuracyEvent, AccuracyPlan, AccuracyRecord, Judging, Place, PlacedRun, place,
};

/// Judges and times the runs of `plan` in its order, and tells `sink` what happens; runs on the same rays end in the
/// order in which they are sampled enough. Runs whose samples were not complete when `control` stopped it are left out.
///
/// # Errors
/// The plan cannot be carried out at all; a run that fails is told and passed over.
pub fn accuracy(
    plan: &AccuracyPlan,
    control: &Control,
    sink: &mut dyn FnMut(AccuracyEvent),
) -> Result<(), LabError> {
    accuracy_from(plan, &Done::default(), control, sink)
}

/// As [`accuracy`], without the runs that `done` names as finished, and going on from its samples.
///
/// # Errors
/// As [`accuracy`].
pub fn accuracy_from(
    plan: &AccuracyPlan,
    done: &Done,
    control: &Control,
    sink: &mut dyn FnMut(AccuracyEvent),
) -> Result<(), LabError> {
    plan.check()?;
    let mut runs = plan.runs();
    runs.retain(|run| !done.finished.contains(&run.id));
    let mut experiment = Experiment {
        plan: &plan.plan,
        done,
        pools: &Pools::new(&plan.plan.threads)?,
        control,
        random: Pcg32::new(plan.plan.seed, 12),
        complete: 0,
        all: runs.len(),
        judging: Judging::default(),
        sink,
    };
    for of_scene in runs.chunk_by(|a, b| a.config.scene == b.config.scene) {
        let still = scene::load(&of_scene[0].config.scene)?;
        for at_place in of_scene.chunk_by(|a, b| a.place == b.place) {
            experiment.at_place(&still, at_place);
        }
    }
    let stopped = experiment.complete < experiment.all;
    let judging = experiment.judging;
    (experiment.sink)(AccuracyEvent::Ended { stopped, judging });
    Ok(())
}

/// A scene in its place.
struct Stage {
    scene: Scene,
    place: Place,
    oracle: Arc<Oracle>,
}

/// Rays with their truths.
struct Course<'a> {
    stage: &'a Stage,
    set: Arc<RaySet>,
    truths: Truths,
    probes: Probes,
}

/// What all runs of a kernel on a course share.
struct Shared {
    judge: Judge,
    probed: Probed,
}

struct Experiment<'a> {
    plan: &'a Plan,
    done: &'a Done,
    pools: &'a Pools,
    control: &'a Control,
    random: Pcg32,
    /// Runs that are complete or failed.
    complete: usize,
    all: usize,
    judging: Judging,
    sink: &'a mut dyn FnMut(AccuracyEvent),
}

impl Experiment<'_> {
    fn at_place(&mut self, still: &Scene, runs: &[PlacedRun]) {
        let place = runs[0].place;
        let scene = match place::scene(still, place) {
            Ok(scene) => scene,
            Err(why) => {
                let name = &runs[0].config.scene;
                return self.fail(runs.len(), format!("'{name}' cannot be {place}: {why}"));
            }
        };
        let stage = Stage {
            oracle: Arc::new(Oracle::new(&scene.mesh)),
            scene,
            place,
        };
        for on_rays in runs.chunk_by(|a, b| a.config.rays == b.config.rays) {
            if !self.control.may_go_on() {
                return;
            }
            match self.course(&stage, &on_rays[0].config) {
                Err(why) => self.fail(on_rays.len(), why),
                Ok(course) => self.on_course(&course, on_rays),
            }
        }
    }

    /// Rays and their truths.
    fn course<'s>(&mut self, stage: &'s Stage, run: &RunConfig) -> Result<Course<'s>, String> {
        let (scene, place) = (&stage.scene, stage.place);
        let name = format!("{} rays of {} {place}", run.rays, run.scene);
        self.tell(&format!("asking the oracle about {name}"));
        let all = self.pools.all();
        let set = all
            .install(|| place::rays(scene, place, &run.rays, run.ray_count, run.seed))
            .map_err(|why| why.to_string())?;
        if set.rays.is_empty() {
            return Err(format!("there are no {name}: choose another set or scene"));
        }
        let start = Instant::now();
        let truths = all.install(|| Truths::new(&stage.oracle, &scene.mesh, &set.rays));
        self.judging.truths.0 += set.rays.len() as u64;
        self.judging.truths.1 += start.elapsed().as_secs_f64();
        let probes = all.install(|| Probes::new(scene, &run.rays, &set.rays, run.seed));
        Ok(Course {
            stage,
            set: Arc::new(set),
            truths,
            probes,
        })
    }

    /// Judges and times all runs on the same rays, as many at once as fit into memory together.
    fn on_course(&mut self, course: &Course, runs: &[PlacedRun]) {
        let mut live: Vec<(Live, Accuracy)> = Vec::new();
        let mut bytes = 0;
        for same in runs.chunk_by(|a, b| a.config.kernel == b.config.kernel) {
            let shared = match self.share(course, &same[0].config) {
                Ok(shared) => shared,
                Err(why) => {
                    self.fail(same.len(), why);
                    continue;
                }
            };
            for run in same {
                if !self.control.may_go_on() {
                    return;
                }
                match self.prepare(course, run, &shared) {
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

    /// The answers of brute force, and what the kernel's own answers show.
    fn share(&mut self, course: &Course, run: &RunConfig) -> Result<Shared, String> {
        self.tell(&format!("probing {} on {}", run.kernel.name, run.rays));
        let stage = course.stage;
        let (budget, seed) = (&self.plan.budget, self.plan.seed);
        self.pools.all().install(|| {
            let mesh = &stage.scene.mesh;
            let judge = Judge::new(mesh, &stage.oracle, &run.kernel, &course.set, budget, seed);
            Ok(Shared {
                judge: judge.map_err(|why| why.to_string())?,
                probed: course.probes.probe(&run.kernel)?,
            })
        })
    }

    /// Builds, counts and checks as a sweep does, and judges both queries about all rays.
    fn prepare(
        &mut self,
        course: &Course,
        run: &PlacedRun,
        shared: &Shared,
    ) -> Result<(Live, Accuracy), String> {
        let (stage, config) = (course.stage, &run.config);
        self.tell(&format!(
            "judging {} in {} on {} rays {}",
            config.kernel.name, config.accel.name, config.rays, stage.place
        ));
        let setting = Setting {
            plan: self.plan,
            pools: self.pools,
            mesh: &stage.scene.mesh,
            set: &course.set,
            judge: &shared.judge,
        };
        let mut live = Live::prepare(run.id.clone(), config, &setting)?;
        if let Some(speeds) = self.done.samples.get(&run.id) {
            live.speeds.clone_from(speeds);
            live.resumed = speeds.len();
        }
        let start = Instant::now();
        let rays = &course.set.rays;
        let all = self.pools.all();
        let mut found = all.install(|| course.truths.judge(live.accel(), rays, stage.place));
        self.judging.answers.0 += rays.len() as u64;
        self.judging.answers.1 += start.elapsed().as_secs_f64();
        // Where a peer's own test decides, the kernel's own answers say nothing of it.
        let own_test = |entry: &AcceleratorEntry| entry.own_test(&config.accel.params).is_some();
        if !accel::entry(&config.accel.name).is_ok_and(own_test) {
            shared.probed.enter(&mut found);
        }
        Ok((live, found))
    }

    /// Takes a sample of each run in turn, in a new random order each round, until all are sampled enough.
    fn sample(&mut self, mut live: Vec<(Live, Accuracy)>) {
        let budget = &self.plan.budget;
        let mut awake = Awake::default();
        while !live.is_empty() {
            order_round(&mut live, &mut self.random, |(run, _)| run.threads());
            for (run, _) in &mut live {
                if !self.control.may_go_on() {
                    return;
                }
                let pool = self.pools.of(run.threads());
                awake.ready(pool);
                self.control.set_sampling(true);
                let (speed, took) = run.time(pool, budget.sample_seconds);
                self.control.set_sampling(false);
                run.speeds.push(speed);
                run.seconds += took;
                (self.sink)(AccuracyEvent::Sampled {
                    id: run.record.id.clone(),
                    mrays_per_s: speed,
                });
            }
            self.tell("measuring");
            let mut going = Vec::with_capacity(live.len());
            for (run, found) in live {
                match stop_reason(&run.speeds, run.seconds, budget, self.plan.seed) {
                    None => going.push((run, found)),
                    Some(why) => self.finish(run, &found, why),
                }
            }
            live = going;
        }
    }

    fn finish(&mut self, live: Live, accuracy: &Accuracy, why: StopReason) {
        self.complete += 1;
        let run = live.finish(why);
        let record = Box::new(AccuracyRecord {
            run,
            accuracy: *accuracy,
        });
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
