//! `raylab accuracy`: what each method decides wrongly by the oracle, beside its speed.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use crate::accel;
use crate::kernel;
use crate::lab::{self, AccuracyEvent, AccuracyPlan, Control, Plan};
use crate::report::{self, Provenance, Report, ReportError, Run};

use super::args::AccuracyArgs;
use super::choices::{split_list, thread_count, with_axes};
use super::progress::Progress;
use super::{Failure, interrupt, print, table};

/// Judges, times, and prints the report or a table; with a folder, keeps the report there as it grows.
pub fn run(args: &AccuracyArgs) -> Result<(), Failure> {
    let plan = plan(args)?;
    plan.check()?;
    let mut report = Report {
        schema: Report::SCHEMA.to_owned(),
        provenance: Provenance::gather(&plan.plan, super::command_line())?,
        config: plan.plan.clone(),
        runs: Vec::new(),
    };
    if let Some(dir) = &args.out {
        begin(dir, &report)?;
    }
    let outcome = measure(&plan, args, &mut report)?;
    if let Some(dir) = &args.out {
        let mut files = 0;
        for format in ["svg", "png", "html"] {
            files += report::export(&report, format, dir)?.len();
        }
        if !args.quiet {
            let dir = dir.display();
            eprintln!("wrote report.json and {files} plots and pages to {dir}");
        }
    }
    if args.json {
        let text = serde_json::to_string_pretty(&report)
            .map_err(|e| Failure::Failed(format!("cannot write the report as JSON: {e}")))?;
        print(&format!("{text}\n"))?;
    } else {
        print(&table::accuracy(&report.runs))?;
    }
    judge(&report, &outcome)
}

/// Makes the folder with a report that has no runs yet.
fn begin(dir: &Path, report: &Report) -> Result<(), Failure> {
    let file = dir.join("report.json");
    if file.exists() {
        let dir = dir.to_owned();
        return Err(ReportError::Exists { dir }.into());
    }
    fs::create_dir_all(dir)
        .map_err(|why| Failure::Failed(format!("cannot make {}: {why}", dir.display())))?;
    Ok(report.write(&file)?)
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
    report: &mut Report,
) -> Result<Outcome, Failure> {
    let control = Arc::new(Control::default());
    let _watch = interrupt::watch(&control);
    let mut progress = Progress::new(!args.quiet);
    let start = std::time::Instant::now();
    let mut outcome = Outcome::default();
    let mut broken = None;
    lab::accuracy(plan, &control, &mut |event| match event {
        AccuracyEvent::Doing { done, what } => {
            // As long again for each run as the finished ones took.
            let left = start.elapsed().as_secs_f64() * (1.0 / done.max(1e-3) - 1.0);
            progress.update(Some((done, left)), &what);
        }
        AccuracyEvent::Finished { record } => {
            let mut run = Run::from(&record.run);
            run.accuracy = Some(record.accuracy);
            report.runs.push(run);
            if let Some(dir) = &args.out
                && let Err(why) = report.write(&dir.join("report.json"))
            {
                broken.get_or_insert(why);
                control.stop();
            }
        }
        AccuracyEvent::Failed { why } => {
            outcome.failed += 1;
            progress.say(&format!("raylab: {why}"));
        }
        AccuracyEvent::Ended { stopped } => outcome.stopped = stopped,
    })?;
    progress.clear();
    match broken {
        Some(why) => Err(why.into()),
        None => Ok(outcome),
    }
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
        scenes: args.scenes.clone(),
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
    let offsets = args.offset.split(',').map(str::trim).map(|text| {
        let number = text.parse().ok();
        number.ok_or_else(|| {
            Failure::Usage(format!(
                "'{text}' is not an offset; write numbers, e.g. 0,1e4"
            ))
        })
    });
    let mut offsets: Vec<f64> = offsets.collect::<Result<_, _>>()?;
    offsets.dedup();
    Ok(AccuracyPlan { plan, offsets })
}
