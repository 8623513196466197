//! `raylab accuracy`: what each method decides wrongly by the oracle, beside its speed.

use std::sync::Arc;

use crate::accel;
use crate::kernel;
use crate::lab::{self, AccuracyEvent, AccuracyPlan, Control, Done, Judging, Plan};
use crate::report::{self, Bundle, Places, Provenance, Report, Run};

use super::args::AccuracyArgs;
use super::choices::{split_list, thread_count, with_axes};
use super::progress::Progress;
use super::{Failure, interrupt, print, table};

/// Judges, times, and prints the report or tables; with a folder, keeps a bundle there as it grows.
pub fn run(args: &AccuracyArgs) -> Result<(), Failure> {
    let (mut keeper, plan) = keeper(args)?;
    let outcome = measure(&plan, args, &mut keeper)?;
    let report = keeper.finish(args)?;
    if args.json {
        let text = serde_json::to_string_pretty(&report)
            .map_err(|e| Failure::Failed(format!("cannot write the report as JSON: {e}")))?;
        print(&format!("{text}\n"))?;
    } else {
        print(&table::accuracy(&report.runs))?;
        print("\n")?;
        print(&table::errors(&report.runs))?;
    }
    judge(&report, &outcome)
}

/// Where judged runs are kept.
enum Keeper {
    /// In a folder, run by run.
    Bundle(Box<Bundle>),
    /// Only here.
    Memory(Box<Report>),
}

/// A new keeper, or the one that was left, with what is to be judged.
fn keeper(args: &AccuracyArgs) -> Result<(Keeper, AccuracyPlan), Failure> {
    if let Some(dir) = &args.resume {
        let (bundle, plan) = Bundle::resume_judged(dir)?;
        return Ok((Keeper::Bundle(Box::new(bundle)), plan));
    }
    let plan = plan(args)?;
    plan.check()?;
    let provenance = Provenance::gather(&plan.plan, super::command_line())?;
    let keeper = match &args.out {
        Some(dir) => Keeper::Bundle(Box::new(Bundle::create_judged(dir, &plan, provenance)?)),
        None => Keeper::Memory(Box::new(Report {
            schema: Report::SCHEMA.to_owned(),
            provenance,
            config: plan.plan.clone(),
            judged: Some(Places {
                offsets: plan.offsets.clone(),
                scales: plan.scales.clone(),
            }),
            runs: Vec::new(),
        })),
    };
    Ok((keeper, plan))
}

impl Keeper {
    fn done(&self) -> Done {
        match self {
            Self::Bundle(bundle) => bundle.done().clone(),
            Self::Memory(_) => Done::default(),
        }
    }

    fn note(&mut self, event: &AccuracyEvent) -> Result<(), Failure> {
        match (self, event) {
            (Self::Bundle(bundle), event) => Ok(bundle.note_judged(event)?),
            (Self::Memory(report), AccuracyEvent::Finished { record }) => {
                report.runs.push(Run::from(record.as_ref()));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Writes what is still to be written, and hands over the report in the order of its plan.
    fn finish(self, args: &AccuracyArgs) -> Result<Report, Failure> {
        match self {
            Self::Memory(mut report) => {
                report.put_in_order();
                Ok(*report)
            }
            Self::Bundle(mut bundle) => {
                bundle.finish()?;
                let mut files = 0;
                for format in ["svg", "png", "html"] {
                    files += report::export(bundle.report(), format, bundle.dir())?.len();
                }
                if !args.quiet {
                    let dir = bundle.dir().display();
                    eprintln!("wrote report.json and {files} plots and pages to {dir}");
                }
                Ok(bundle.report().clone())
            }
        }
    }
}

/// How it went beside its figures.
#[derive(Default)]
struct Outcome {
    stopped: bool,
    /// Runs that could not be made.
    failed: usize,
}

fn measure(
    plan: &AccuracyPlan,
    args: &AccuracyArgs,
    keeper: &mut Keeper,
) -> Result<Outcome, Failure> {
    let control = Arc::new(Control::default());
    let _watch = interrupt::watch(&control);
    let mut progress = Progress::new(!args.quiet);
    let start = std::time::Instant::now();
    let mut outcome = Outcome::default();
    let mut broken = None;
    let mut judging = Judging::default();
    let done = keeper.done();
    lab::accuracy_from(plan, &done, &control, &mut |event| {
        if let Err(failure) = keeper.note(&event) {
            broken.get_or_insert(failure);
            control.stop();
        }
        match event {
            AccuracyEvent::Doing { done, what } => {
                // As long again for each run as the finished ones took.
                let left = start.elapsed().as_secs_f64() * (1.0 / done.max(1e-3) - 1.0);
                progress.update(Some((done, left)), &what);
            }
            AccuracyEvent::Failed { why } => {
                outcome.failed += 1;
                progress.say(&format!("raylab: {why}"));
            }
            AccuracyEvent::Ended {
                stopped,
                judging: j,
            } => {
                outcome.stopped = stopped;
                judging = j;
            }
            AccuracyEvent::Sampled { .. } | AccuracyEvent::Finished { .. } => {}
        }
    })?;
    progress.clear();
    if !args.quiet {
        eprintln!("{}", told(&judging));
    }
    match broken {
        Some(failure) => Err(failure),
        None => Ok(outcome),
    }
}

/// How fast was judged, in a sentence.
fn told(judging: &Judging) -> String {
    let speed = |(rays, seconds): (u64, f64)| {
        let millions = rays as f64 * 1e-6;
        format!(
            "{} million rays at {} million/s",
            table::significant(millions),
            table::significant(millions / seconds.max(1e-9))
        )
    };
    format!(
        "asked the oracle about {}; traced (closest hit and occlusion) and judged {}",
        speed(judging.truths),
        speed(judging.answers)
    )
}

/// The exit code: an accelerator that changes a right answer weighs most; a kernel that errs is what is measured.
fn judge(report: &Report, outcome: &Outcome) -> Result<(), Failure> {
    if let Some(run) = report.runs.iter().find(|run| run.is_broken()) {
        return Err(Failure::Mismatch(format!(
            "{} with {} on {} ({}) gives other answers than brute force; its figures mean nothing",
            run.accel, run.kernel, run.scene, run.rays
        )));
    }
    if outcome.stopped {
        return Err(Failure::Interrupted);
    }
    if outcome.failed > 0 {
        return Err(Failure::Failed(
            "some runs could not be made; see above".to_owned(),
        ));
    }
    Ok(())
}

/// What the command line asks for.
fn plan(args: &AccuracyArgs) -> Result<AccuracyPlan, Failure> {
    let or = |given: &[String], default: &[&str]| match split_list(given) {
        list if list.is_empty() => default.iter().map(|&d| d.to_owned()).collect(),
        list => list,
    };
    let kernels: Vec<&str> = kernel::methods().map(|k| k.name).collect();
    let (accels, kernels) = with_axes(
        &or(&args.accel, &[accel::DEFAULT]),
        &or(&args.kernel, &kernels),
        &args.set,
    )?;
    let mut plan = Plan {
        scenes: split_list(&args.scenes),
        accels,
        kernels,
        n: lab::parse_n_list(&args.n)?,
        rays: or(&args.rays, &["edge", "random"]),
        threads: vec![thread_count(&args.threads)?],
        seed: args.seed,
        ..Plan::default()
    };
    if args.quick {
        plan = plan.quickened();
    }
    if let Some(count) = args.rays_count {
        plan.ray_count = count;
    }
    Ok(AccuracyPlan {
        plan,
        offsets: numbers(&args.offset, "an offset; write numbers, e.g. 0,1e4")?,
        scales: numbers(&args.scale, "a scale; write numbers, e.g. 1,1e-30")?,
    })
}

/// Reads a list of numbers; `what` says of an item that is none what it should be.
fn numbers(text: &str, what: &str) -> Result<Vec<f64>, Failure> {
    let number = |item: &str| {
        let item = item.trim();
        let wrong = || Failure::Usage(format!("'{item}' is not {what}"));
        item.parse().ok().ok_or_else(wrong)
    };
    text.split(',').map(number).collect()
}
