//! Sweeps: the runs of a plan, measured side by side.
//!
//! ```text
//! plan ──▶ groups: same scene, same rays
//!             │
//!             ├─ prepare each run:  build ×k ─ counted pass ─ check against brute force ─ warm-up pass
//!             │
//!             └─ rounds:  a sample of each run, in a new seeded random order; a run that is sampled enough leaves
//! ```
//!
//! Within a round runs with fewer threads come first, so that the others' cores are woken once a round.
//!
//! **Source:** samples in random order: T. Mytkowicz et al., "Producing Wrong Data Without Doing Anything Obviously
//! Wrong!", ASPLOS 2009; a slow stretch of the machine then falls on all configurations alike.
//! **Differs:** structures of a group stand in memory together as long as they stay within the plan's memory limit, with
//! what checks them; the next ones are prepared when these are done.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::Instant;

use rand_pcg::Pcg32;

use crate::oracle::Oracle;
use crate::registry::Choice;
use crate::scene::{self, Scene};
use crate::trace::{self, RaySet};

use super::estimate::Estimate;
use super::judge::Judge;
use super::live::{Live, Setting};
use super::machine::{Awake, Pools};
use super::sampling::{order_round, stop_reason};
use super::{Control, Event, LabError, Plan, RunConfig, RunRecord};

/// How often a sample is taken again when something disturbed it.
const RETAKES: usize = 5;

/// What an earlier sweep of the same plan has left.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Done {
    /// Ids of complete runs, which are not made again.
    pub finished: BTreeSet<String>,
    /// Speeds of samples that were taken of incomplete runs, by id; they count.
    pub samples: BTreeMap<String, Vec<f64>>,
}

/// Makes the runs of `plan` whose ids are not in `finished`, and tells `sink` what happens. Returns when all are made
/// or `control` stops it.
///
/// A run that cannot be made is told as [`Event::Failed`], and the sweep goes on. Whatever the threads and however
/// often it is repeated, counters, checksums and verdicts are the same.
///
/// # Errors
/// A plan that cannot be carried out; nothing has been told then.
pub fn sweep(
    plan: &Plan,
    finished: &BTreeSet<String>,
    control: &Control,
    sink: &mut dyn FnMut(Event),
) -> Result<(), LabError> {
    let done = Done {
        finished: finished.clone(),
        samples: BTreeMap::new(),
    };
    sweep_from(plan, &done, control, sink)
}

/// As [`sweep`], going on from samples of incomplete runs, too.
///
/// # Errors
/// As [`sweep`].
pub fn sweep_from(
    plan: &Plan,
    done: &Done,
    control: &Control,
    sink: &mut dyn FnMut(Event),
) -> Result<(), LabError> {
    plan.check()?;
    let mut runs: Vec<(String, RunConfig)> =
        plan.runs().into_iter().map(|run| (run.id(), run)).collect();
    runs.retain(|(id, _)| !done.finished.contains(id));
    let mut scenes = BTreeMap::new();
    for (_, run) in &runs {
        if !scenes.contains_key(&run.scene) {
            scenes.insert(run.scene.clone(), Stage::new(scene::load(&run.scene)?));
        }
    }
    let mut sweep = Sweep {
        plan,
        done,
        control,
        pools: &Pools::new(&plan.threads)?,
        estimate: Estimate::new(runs.len(), &plan.budget),
        random: Pcg32::new(plan.seed, 11),
        complete: 0,
        sink,
    };
    (sweep.sink)(Event::Started { runs: runs.clone() });
    for group in runs.chunk_by(|(_, a), (_, b)| same_group(a, b)) {
        sweep.group(group, &scenes[&group[0].1.scene]);
    }
    let stopped = sweep.complete < runs.len();
    (sweep.sink)(Event::Ended { stopped });
    Ok(())
}

fn same_group(a: &RunConfig, b: &RunConfig) -> bool {
    (&a.scene, &a.rays) == (&b.scene, &b.rays)
}

/// A loaded scene with its oracle.
struct Stage {
    scene: Scene,
    oracle: Arc<Oracle>,
}

impl Stage {
    fn new(scene: Scene) -> Self {
        let oracle = Arc::new(Oracle::new(&scene.mesh));
        Self { scene, oracle }
    }
}

/// What the runs of a group share.
struct Course<'a> {
    stage: &'a Stage,
    set: Arc<RaySet>,
    /// Of the kernel that was asked for last.
    judge: Option<(Choice, Arc<Judge>)>,
}

/// A run that takes its turns at being sampled.
struct Turn {
    run: Live,
    /// Shared by all runs with the same kernel.
    judge: Arc<Judge>,
}

/// Bytes that runs hold in memory, with what checks them.
fn bytes(turns: &[Turn]) -> u64 {
    turns
        .chunk_by(|a, b| Arc::ptr_eq(&a.judge, &b.judge))
        .map(|same| same[0].judge.bytes() + same.iter().map(|turn| turn.run.bytes()).sum::<u64>())
        .sum()
}

struct Sweep<'a> {
    plan: &'a Plan,
    done: &'a Done,
    control: &'a Control,
    pools: &'a Pools,
    estimate: Estimate,
    random: Pcg32,
    /// Runs that are complete or failed.
    complete: usize,
    sink: &'a mut dyn FnMut(Event),
}

impl Sweep<'_> {
    /// Makes all runs of a group.
    fn group(&mut self, runs: &[(String, RunConfig)], stage: &Stage) {
        if !self.control.may_go_on() {
            return;
        }
        let set = match self.rays(&runs[0].1, &stage.scene) {
            Ok(set) => Arc::new(set),
            Err(why) => {
                for (id, _) in runs {
                    self.fail(id, why.clone(), 0.0);
                }
                return;
            }
        };
        let mut course = Course {
            stage,
            set,
            judge: None,
        };
        let mut waiting = runs.iter();
        while waiting.len() > 0 && self.control.may_go_on() {
            let turns = self.prepare(&mut waiting, &mut course);
            self.sample(turns);
        }
    }

    /// The ray set of a group, which has at least one ray.
    fn rays(&self, run: &RunConfig, scene: &Scene) -> Result<RaySet, String> {
        let all = self.pools.all();
        let made = all.install(|| trace::ray_set(scene, &run.rays, run.ray_count, run.seed));
        let set = made.map_err(|why| why.to_string())?;
        if set.rays.is_empty() {
            let (rays, scene) = (&run.rays, &run.scene);
            return Err(format!(
                "the ray set '{rays}' of '{scene}' has no rays: choose another set or scene"
            ));
        }
        Ok(set)
    }

    /// The answers of brute force with `kernel`, made anew where the last run had another.
    fn judge(&self, course: &mut Course, kernel: &Choice) -> Result<Arc<Judge>, String> {
        if let Some((of, judge)) = &course.judge
            && of == kernel
        {
            return Ok(Arc::clone(judge));
        }
        let (mesh, oracle) = (&course.stage.scene.mesh, &course.stage.oracle);
        let (budget, seed) = (&self.plan.budget, self.plan.seed);
        let all = self.pools.all();
        let made = all.install(|| Judge::new(mesh, oracle, kernel, &course.set, budget, seed));
        let judge = Arc::new(made.map_err(|why| why.to_string())?);
        course.judge = Some((kernel.clone(), Arc::clone(&judge)));
        Ok(judge)
    }

    /// Prepares waiting runs until their structures reach the memory limit; none where none is left or the sweep is
    /// stopped.
    fn prepare<'r>(
        &mut self,
        waiting: &mut impl Iterator<Item = &'r (String, RunConfig)>,
        course: &mut Course,
    ) -> Vec<Turn> {
        let mut turns: Vec<Turn> = Vec::new();
        while bytes(&turns) < self.plan.memory_limit && self.control.may_go_on() {
            let Some((id, config)) = waiting.next() else {
                break;
            };
            let judge = match self.judge(course, &config.kernel) {
                Ok(judge) => judge,
                Err(why) => {
                    self.fail(id, why, 0.0);
                    continue;
                }
            };
            (self.sink)(Event::Building { id: id.clone() });
            let start = Instant::now();
            let setting = Setting {
                plan: self.plan,
                pools: self.pools,
                mesh: &course.stage.scene.mesh,
                set: &course.set,
                judge: &judge,
            };
            let prepared = Live::prepare(id.clone(), config, &setting);
            let seconds = start.elapsed().as_secs_f64();
            match prepared {
                Ok(mut run) => {
                    if let Some(speeds) = self.done.samples.get(id) {
                        run.speeds.clone_from(speeds);
                        run.resumed = speeds.len();
                    }
                    self.estimate.prepared(seconds);
                    let record = Box::new(run.record.clone());
                    (self.sink)(Event::Built { record });
                    turns.push(Turn { run, judge });
                }
                Err(why) => self.fail(id, why, seconds),
            }
        }
        turns
    }

    /// Takes samples of all runs in turn until each is sampled enough.
    fn sample(&mut self, mut live: Vec<Turn>) {
        let mut awake = Awake::default();
        while !live.is_empty() {
            order_round(&mut live, &mut self.random, |turn| turn.run.threads());
            let mut turns: Vec<Option<Turn>> = live.into_iter().map(Some).collect();
            for turn in 0..turns.len() {
                let Some(Turn { run, judge }) = &mut turns[turn] else {
                    continue;
                };
                awake.ready(self.pools.of(run.threads()));
                let Some(speed) = self.take_sample(run, judge) else {
                    return;
                };
                run.speeds.push(speed);
                let id = run.record.id.clone();
                let budget = &self.plan.budget;
                let stop = stop_reason(&run.speeds, run.seconds, budget, self.plan.seed);
                let complete = stop.and_then(|reason| Some((turns[turn].take()?.run, reason)));
                if let Some((run, _)) = &complete {
                    self.estimate.complete(run.seconds);
                }
                let going = turns.iter().flatten();
                let spent: Vec<f64> = going.map(|turn| turn.run.seconds).collect();
                let (done, seconds_left) = self.estimate.tell(&spent);
                (self.sink)(Event::Sampled {
                    id,
                    mrays_per_s: speed,
                    done,
                    seconds_left,
                });
                if let Some((run, reason)) = complete {
                    self.finish(run.finish(reason));
                }
            }
            live = turns.into_iter().flatten().collect();
        }
    }

    /// Takes one sample, again where something disturbed it; its speed, or `None` when the sweep is stopped.
    fn take_sample(&mut self, run: &mut Live, judge: &Judge) -> Option<f64> {
        let pool = self.pools.of(run.threads());
        for attempt in 0..=RETAKES {
            if !self.control.may_go_on() {
                return None;
            }
            let before = self.control.disturbances();
            self.control.set_sampling(true);
            let (speed, seconds) = run.time(pool, self.plan.budget.sample_seconds);
            self.control.set_sampling(false);
            run.seconds += seconds;
            run.check_room(judge);
            if self.control.disturbances() == before {
                return Some(speed);
            }
            if attempt == RETAKES {
                run.disturbed += 1;
                return Some(speed);
            }
        }
        None
    }

    fn finish(&mut self, record: RunRecord) {
        self.complete += 1;
        let record = Box::new(record);
        (self.sink)(Event::Finished { record });
    }

    fn fail(&mut self, id: &str, why: String, seconds: f64) {
        self.complete += 1;
        self.estimate.prepared(seconds);
        self.estimate.complete(0.0);
        let id = id.to_owned();
        (self.sink)(Event::Failed { id, why });
    }
}
