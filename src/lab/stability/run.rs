//! The runner: cases in parallel, each cell told as it is finished.

use std::sync::mpsc::{self, Sender};

use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

use crate::accel::{self, ACCELERATORS, Accelerator};
use crate::kernel::{self, KERNELS};
use crate::lab::{Control, LabError};
use crate::registry::Choice;

use super::case::CaseEntry;
use super::cases::CASES;
use super::judge::{Answers, Bench, Found};
use super::known::{MEASURED_WITH, deviation, known_failure};
use super::model::{Cell, Faults, Map, Rung, Verdict, Witness};

/// The kernels with which `quick` tries accelerators: the default one, and the one that is never wrong.
const QUICK: [&str; 2] = [MEASURED_WITH, "exact"];

/// Bytes that a structure of a case may take.
const MEMORY_LIMIT: u64 = 1 << 30;

/// What is tried.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilityPlan {
    /// Names of cases.
    pub cases: Vec<&'static str>,
    /// Kernels, each judged in brute force and tried in every accelerator.
    pub kernels: Vec<Choice>,
    /// Accelerators; brute force, which judges them, need not be named.
    pub accels: Vec<Choice>,
    /// Whether accelerators are tried with `woop` and `exact` only, where these are among the kernels.
    pub quick: bool,
    /// Seed of all cases. The counts of known failures are those of seed 1; with another one a row explains any failure
    /// of its case.
    pub seed: u64,
    /// Threads.
    pub threads: usize,
}

impl Default for StabilityPlan {
    /// Every case, kernel and accelerator of this program, exhibits included. Peers promise nothing: they are tried only
    /// where they are named.
    fn default() -> Self {
        let kernels = KERNELS.iter().filter_map(|k| kernel::parse(k.name).ok());
        let own = ACCELERATORS.iter().filter(|a| a.peer.is_none());
        let accels = own.map(|a| a.name);
        let accels = accels.filter(|name| *name != super::BRUTE);
        Self {
            cases: CASES.iter().map(|c| c.name).collect(),
            kernels: kernels.collect(),
            accels: accels.filter_map(|a| accel::parse(a).ok()).collect(),
            quick: false,
            seed: 1,
            threads: crate::lab::cores(),
        }
    }
}

/// What a running suite tells.
#[derive(Debug, Clone)]
pub enum StabilityEvent {
    /// A cell is finished. Cells come in no particular order.
    Cell {
        /// The cell.
        cell: Box<Cell>,
        /// Cells finished so far, this one included.
        done: usize,
        /// Cells of the plan.
        all: usize,
    },
}

impl StabilityPlan {
    /// The chosen cases, in the order of the registry.
    fn entries(&self) -> Vec<&'static CaseEntry> {
        let chosen = CASES.iter().filter(|c| self.cases.contains(&c.name));
        chosen.collect()
    }

    /// The chosen accelerators but brute force.
    fn structures(&self) -> impl Iterator<Item = &Choice> {
        self.accels.iter().filter(|a| a.name != super::BRUTE)
    }

    /// Whether accelerators are tried with `kernel`.
    fn tries(&self, kernel: &Choice) -> bool {
        let few = |k: &Choice| QUICK.contains(&k.name.as_str());
        !self.quick || few(kernel) || !self.kernels.iter().any(few)
    }

    /// Number of cells.
    #[must_use]
    pub fn cells(&self) -> usize {
        let tried = self.kernels.iter().filter(|k| self.tries(k)).count();
        self.entries().len() * (self.kernels.len() + tried * self.structures().count())
    }

    /// Checks what can be checked before the first cell.
    ///
    /// # Errors
    /// No case or no kernel; a thread count that makes no sense.
    pub fn check(&self) -> Result<(), LabError> {
        if self.entries().is_empty() {
            return Err(LabError::Nothing { what: "case" });
        }
        if self.kernels.is_empty() {
            return Err(LabError::Nothing { what: "kernel" });
        }
        if !(1..=crate::lab::MAX_THREADS).contains(&self.threads) {
            return Err(LabError::Threads(self.threads));
        }
        Ok(())
    }
}

/// Runs the suite and tells `sink`, on the calling thread, of each finished cell. Ends early where `control` is stopped;
/// the map then holds what was finished.
///
/// # Errors
/// As [`StabilityPlan::check`]; the system gives no threads.
pub fn stability(
    plan: &StabilityPlan,
    control: &Control,
    sink: &mut dyn FnMut(StabilityEvent),
) -> Result<Map, LabError> {
    plan.check()?;
    let pool = ThreadPoolBuilder::new().num_threads(plan.threads).build();
    let pool = pool.map_err(|why| LabError::Pool {
        threads: plan.threads,
        why: why.to_string(),
    })?;
    let entries = plan.entries();
    let all = plan.cells();
    let (sender, cells) = mpsc::channel();
    let mut finished: Vec<(usize, Cell)> = Vec::with_capacity(all);
    std::thread::scope(|scope| {
        let entries = &entries;
        scope.spawn(move || {
            pool.install(|| {
                entries
                    .par_iter()
                    .enumerate()
                    .for_each_with(sender, |sender, (i, case)| {
                        let trial = Trial::new(plan, control, case);
                        trial.run(i * (all / entries.len()), sender);
                    });
            });
        });
        for (place, cell) in cells {
            finished.push((place, cell.clone()));
            sink(StabilityEvent::Cell {
                cell: Box::new(cell),
                done: finished.len(),
                all,
            });
        }
    });
    finished.sort_by_key(|(place, _)| *place);
    Ok(Map {
        cases: entries.iter().map(|c| c.name).collect(),
        kernels: plan.kernels.iter().map(kernel_label).collect(),
        accels: plan.structures().map(accel_label).collect(),
        seed: plan.seed,
        stopped: finished.len() < all,
        cells: finished.into_iter().map(|(_, cell)| cell).collect(),
    })
}

/// The kernel's name with what differs from its defaults.
pub(super) fn kernel_label(kernel: &Choice) -> String {
    kernel.label(kernel::entry(kernel).map_or(&[][..], |e| e.params))
}

/// The accelerator's name with what differs from its defaults.
pub(super) fn accel_label(accel: &Choice) -> String {
    accel.label(accel::entry(&accel.name).map_or(&[][..], |e| e.params))
}

/// A case being tried: the scenes and rays of all its rungs, with their truths.
struct Trial<'a> {
    plan: &'a StabilityPlan,
    control: &'a Control,
    case: &'static CaseEntry,
    benches: Vec<Bench>,
}

impl<'a> Trial<'a> {
    fn new(plan: &'a StabilityPlan, control: &'a Control, case: &'static CaseEntry) -> Self {
        let rungs = if control.stopped() {
            0
        } else {
            case.rungs.len()
        };
        let benches = (0..rungs).into_par_iter();
        Self {
            plan,
            control,
            case,
            benches: benches
                .map(|rung| Bench::new(case.setting(rung, plan.seed)))
                .collect(),
        }
    }

    /// Sends all cells, each with its place in the map; the first has the place `first`.
    fn run(&self, first: usize, sender: &Sender<(usize, Cell)>) {
        let tried = |k: &&Choice| self.plan.tries(k);
        let mut at_accel = first + self.plan.kernels.len();
        let mut brutes = Vec::new();
        for (i, kernel) in self.plan.kernels.iter().enumerate() {
            if !self.control.may_go_on() {
                return;
            }
            let (cell, answers) = self.alone(kernel);
            // Nobody listens any more: nothing is left to do.
            if sender.send((first + i, cell)).is_err() {
                return;
            }
            brutes.push((kernel, answers));
        }
        for accel in self.plan.structures() {
            for (kernel, brute) in brutes.iter().filter(|(k, _)| tried(k)) {
                if !self.control.may_go_on() {
                    return;
                }
                let cell = self.with(kernel, accel, brute);
                if sender.send((at_accel, cell)).is_err() {
                    return;
                }
                at_accel += 1;
            }
        }
    }

    /// The kernel in brute force, and its answers at each rung.
    fn alone(&self, kernel: &Choice) -> (Cell, Vec<Option<Answers>>) {
        let brute = Choice {
            name: super::BRUTE.to_owned(),
            params: crate::registry::Params::default(),
        };
        let mut answers = Vec::new();
        let found = self.benches.iter().map(|bench| {
            let built = built(bench, &brute, kernel)?;
            let told = Answers::of(&*built, &bench.setting.rays);
            let found = bench.judge_kernel(&told);
            answers.push(Some(told));
            Ok(found)
        });
        let found: Vec<Result<Found, String>> = found.collect();
        answers.resize(self.benches.len(), None);
        (self.cell(kernel, &brute, &found), answers)
    }

    /// The kernel in `accel`, against brute force.
    fn with(&self, kernel: &Choice, accel: &Choice, brute: &[Option<Answers>]) -> Cell {
        let pairs = self.benches.iter().zip(brute);
        let mut broken = None;
        let found = pairs.map(|(bench, brute)| {
            let built = built(bench, accel, kernel)?;
            let told = Answers::of(&*built, &bench.setting.rays);
            let brute = brute.as_ref().ok_or("brute force was not built")?;
            let found = bench.judge_accel(kernel, brute, &told);
            Ok(match built.validate() {
                Ok(()) => found,
                Err(promise) => {
                    broken.get_or_insert(promise);
                    found.invalid()
                }
            })
        });
        let found: Vec<_> = found.collect();
        let mut cell = self.cell(kernel, accel, &found);
        cell.note = cell.note.or(broken);
        cell
    }

    /// What was found, by the list of known failures.
    fn cell(&self, kernel: &Choice, accel: &Choice, found: &[Result<Found, String>]) -> Cell {
        let refused = found.iter().find_map(|f| f.as_ref().err());
        let found: Vec<Found> = found
            .iter()
            .map(|f| f.as_ref().copied().unwrap_or_default())
            .collect();
        let faults = found
            .iter()
            .fold(Faults::default(), |sum, f| sum.plus(f.faults));
        let first = found.iter().position(|f| f.faults.total() > 0);
        let known = known_failure(kernel, accel, self.case);
        // Counts are those of seed 1; with another seed a row explains any failure.
        let bound = known.and_then(|known| known.bound);
        let deviation = bound
            .filter(|_| self.plan.seed == 1)
            .and_then(|bound| deviation(&bound, self.case, &faults, first));
        let verdict = match (refused, first, &known, &deviation) {
            (Some(_), ..) => Verdict::Refused,
            (_, None, Some(_), Some(_)) => Verdict::Gone,
            (_, None, ..) => Verdict::Ok,
            (_, Some(_), Some(_), None) => Verdict::Known,
            (_, Some(_), ..) => Verdict::Fails,
        };
        let rungs = self.benches.iter().zip(&found).enumerate();
        let witness = first.and_then(|rung| {
            let (ray, fault) = found[rung].first?;
            Some(Witness { rung, ray, fault })
        });
        Cell {
            kernel: kernel_label(kernel),
            accel: accel_label(accel),
            case: self.case.name,
            verdict,
            reason: known
                .filter(|_| first.is_some())
                .map(|k| k.reason.to_owned()),
            first: first.map(|rung| self.case.label(rung)),
            faults,
            rungs: rungs
                .map(|(i, (bench, found))| Rung {
                    label: self.case.label(i),
                    rays: bench.setting.rays.len() as u64,
                    faults: found.faults,
                })
                .collect(),
            note: refused.cloned().or(deviation),
            witness,
        }
    }
}

/// Builds `accel` over the scene of `bench`, at the case's resolution where it has one.
pub(super) fn built(
    bench: &Bench,
    accel: &Choice,
    kernel: &Choice,
) -> Result<Box<dyn Accelerator>, String> {
    let setting = &bench.setting;
    accel::build(&setting.mesh, accel, Some(setting.n), kernel, MEMORY_LIMIT)
        .map_err(|why| why.to_string())
}
