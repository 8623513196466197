//! `raylab sweep`: the main experiment without a screen.

use std::path::Path;
use std::sync::Arc;

use crate::accel::ACCELERATORS;
use crate::lab::{self, Control, Done, Event, LabError, Plan, RunRecord};
use crate::report::{self, Bundle, Provenance, Report, Run};

use super::args::SweepArgs;
use super::choices::{split_list, thread_counts, with_axes};
use super::progress::Progress;
use super::{Failure, interrupt, print, table};

/// Measures, keeps what was measured, and prints the report or a table.
pub fn run(args: &SweepArgs) -> Result<(), Failure> {
    let mut keeper = match (&args.resume, &args.out) {
        (Some(dir), _) => Keeper::Bundle(Box::new(Bundle::resume(dir)?)),
        (None, Some(dir)) => {
            let plan = plan(args)?;
            let provenance = provenance(&plan)?;
            Keeper::Bundle(Box::new(Bundle::create(dir, &plan, provenance)?))
        }
        (None, None) => {
            let plan = plan(args)?;
            Keeper::Memory(Box::new(Report {
                schema: Report::SCHEMA.to_owned(),
                judged: None,
                provenance: provenance(&plan)?,
                config: plan,
                runs: Vec::new(),
            }))
        }
    };
    let outcome = measure(&mut keeper, args.quiet)?;
    let report = keeper.finish(args)?;
    if args.json {
        let text = serde_json::to_string_pretty(&report)
            .map_err(|e| Failure::Failed(format!("cannot write the report as JSON: {e}")))?;
        print(&format!("{text}\n"))?;
    } else {
        print(&table::runs(&report.runs))?;
        if let Some(growths) = table::growths(&report.runs) {
            print(&format!("\n{growths}"))?;
        }
    }
    judge(&report, &outcome)
}

/// Where finished runs are kept.
enum Keeper {
    /// In a folder, run by run.
    Bundle(Box<Bundle>),
    /// Only here.
    Memory(Box<Report>),
}

impl Keeper {
    fn plan(&self) -> &Plan {
        match self {
            Self::Bundle(bundle) => bundle.plan(),
            Self::Memory(report) => &report.config,
        }
    }

    fn done(&self) -> Done {
        match self {
            Self::Bundle(bundle) => bundle.done().clone(),
            Self::Memory(_) => Done::default(),
        }
    }

    fn note(&mut self, event: &Event) -> Result<(), Failure> {
        match (self, event) {
            (Self::Bundle(bundle), event) => Ok(bundle.note(event)?),
            (Self::Memory(report), Event::Finished { record }) => {
                report.runs.push(Run::from(record.as_ref()));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Writes what is still to be written, and hands over the report.
    fn finish(self, args: &SweepArgs) -> Result<Report, Failure> {
        match self {
            Self::Memory(report) => Ok(*report),
            Self::Bundle(mut bundle) => {
                bundle.finish()?;
                let files = plots(bundle.report(), bundle.dir())?;
                if !args.quiet {
                    eprintln!(
                        "wrote report.json and {files} plots and pages to {}",
                        bundle.dir().display()
                    );
                }
                Ok(bundle.report().clone())
            }
        }
    }
}

/// Writes plots and pages into a bundle; returns how many files.
fn plots(report: &Report, dir: &Path) -> Result<usize, Failure> {
    let mut files = 0;
    for format in ["svg", "png", "html"] {
        files += report::export(report, format, dir)?.len();
    }
    Ok(files)
}

/// How a sweep went beside its figures.
#[derive(Default)]
struct Outcome {
    stopped: bool,
    /// Runs that could not be made.
    failed: usize,
}

/// Runs the sweep; every event goes to the keeper and to the screen.
fn measure(keeper: &mut Keeper, quiet: bool) -> Result<Outcome, Failure> {
    let control = Arc::new(Control::default());
    let _watch = interrupt::watch(&control);
    let mut progress = Progress::new(!quiet);
    let mut outcome = Outcome::default();
    let mut broken = None;
    let plan = keeper.plan().clone();
    let done = keeper.done();
    lab::sweep_from(&plan, &done, &control, &mut |event| {
        if let Err(failure) = keeper.note(&event) {
            broken.get_or_insert(failure);
            control.stop();
        }
        match &event {
            Event::Built { record } => progress.update(None, &doing(record)),
            Event::Sampled {
                done, seconds_left, ..
            } => progress.update(Some((*done, *seconds_left)), "measuring"),
            Event::Failed { why, .. } => {
                outcome.failed += 1;
                progress.say(&format!("raylab: {why}"));
            }
            Event::Ended { stopped } => outcome.stopped = *stopped,
            _ => {}
        }
    })?;
    progress.clear();
    match broken {
        Some(failure) => Err(failure),
        None => Ok(outcome),
    }
}

fn doing(record: &RunRecord) -> String {
    let n = record.n.map_or(String::new(), |n| format!(" n={n}"));
    format!(
        "checked {}{n} on {}",
        record.config.accel.name, record.config.scene
    )
}

/// The exit code: wrong answers weigh more than an interruption, that more than runs that could not be made.
fn judge(report: &Report, outcome: &Outcome) -> Result<(), Failure> {
    let wrong: Vec<&Run> = report.runs.iter().filter(|run| run.is_broken()).collect();
    if let Some(first) = wrong.first() {
        return Err(Failure::Mismatch(format!(
            "{} of {} runs give other answers than brute force, first {} with {} on {} ({}); their figures mean nothing",
            wrong.len(),
            report.runs.len(),
            first.accel,
            first.kernel,
            first.scene,
            first.rays
        )));
    }
    if outcome.stopped {
        return Err(Failure::Interrupted);
    }
    if outcome.failed > 0 {
        return Err(Failure::Failed(format!(
            "{} runs could not be made; see above",
            outcome.failed
        )));
    }
    Ok(())
}

fn provenance(plan: &Plan) -> Result<Provenance, Failure> {
    plan.check()?;
    Ok(Provenance::gather(plan, super::command_line())?)
}

/// The plan that the command line asks for.
fn plan(args: &SweepArgs) -> Result<Plan, Failure> {
    let or = |given: &[String], default: &[&str]| match split_list(given) {
        list if list.is_empty() => default.iter().map(|&d| d.to_owned()).collect(),
        list => list,
    };
    let sound = ACCELERATORS
        .iter()
        .filter(|a| !a.control && a.peer.is_none());
    let accels: Vec<&str> = sound.map(|a| a.name).collect();
    let (accels, kernels) = with_axes(
        &or(&args.accel, &accels),
        &or(&args.kernel, &["woop"]),
        &args.set,
    )?;
    let plan = Plan::default();
    let mut plan = Plan {
        scenes: or(&args.scene, &["teapot"]),
        accels,
        kernels,
        rays: or(&args.rays, &["primary"]),
        seed: args.seed,
        ..plan
    };
    if let Some(n) = &args.n {
        plan.n = lab::parse_n_list(n)?;
    }
    if let Some(threads) = &args.threads {
        plan.threads = thread_counts(threads)?;
    }
    if args.quick {
        plan = plan.quickened();
    }
    if let Some(count) = args.rays_count {
        plan.ray_count = count;
    }
    Ok(plan)
}

impl From<LabError> for Failure {
    fn from(error: LabError) -> Self {
        match error {
            LabError::Scene(error) => error.into(),
            LabError::Rays(error) => error.into(),
            LabError::Pool { .. } | LabError::Unavailable(_) => Self::Failed(error.to_string()),
            _ => Self::Usage(error.to_string()),
        }
    }
}
