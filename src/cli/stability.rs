//! `raylab stability`: where each kernel and each accelerator breaks, as a lettered map or as JSON.

use std::fmt::Write;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use crate::accel;
use crate::kernel;
use crate::lab::Control;
use crate::lab::stability::{Cell, Map, StabilityEvent, StabilityPlan, Verdict, case, stability};

use crate::report::stability::write_map;

use super::args::StabilityArgs;
use super::choices::{split_list, thread_count};
use super::progress::Progress;
use super::{Failure, interrupt, print};

/// Runs the suite and prints its map.
pub fn run(args: &StabilityArgs) -> Result<(), Failure> {
    let plan = plan(args)?;
    let map = measure(&plan, args)?;
    if let Some(dir) = &args.out {
        write(&map, dir, args.quiet)?;
    }
    if args.json {
        let json = serde_json::to_string_pretty(&map)
            .map_err(|e| Failure::Failed(format!("cannot write the map as JSON: {e}")))?;
        print(&format!("{json}\n"))?;
    } else {
        print(&text(&map))?;
    }
    judge(&map)
}

fn plan(args: &StabilityArgs) -> Result<StabilityPlan, Failure> {
    let mut plan = StabilityPlan {
        quick: args.quick,
        seed: args.seed,
        threads: thread_count(&args.threads)?,
        ..StabilityPlan::default()
    };
    let (cases, kernels) = (split_list(&args.case), split_list(&args.kernel));
    let accels = split_list(&args.accel);
    if !cases.is_empty() {
        let cases = cases.iter().map(|name| Ok(case(name)?.name));
        plan.cases = cases.collect::<Result<_, Failure>>()?;
    }
    if !kernels.is_empty() {
        let kernels = kernels.iter().map(|k| Ok(kernel::parse(k)?));
        plan.kernels = kernels.collect::<Result<_, Failure>>()?;
    }
    if !accels.is_empty() {
        let accels = accels.iter().map(|a| Ok(accel::parse(a)?));
        plan.accels = accels.collect::<Result<_, Failure>>()?;
    }
    plan.check()?;
    Ok(plan)
}

fn measure(plan: &StabilityPlan, args: &StabilityArgs) -> Result<Map, Failure> {
    let control = Arc::new(Control::default());
    let _watch = interrupt::watch(&control);
    let mut progress = Progress::new(!args.quiet);
    let start = Instant::now();
    let map = stability(plan, &control, &mut |event| match event {
        StabilityEvent::Cell { cell, done, all } => {
            let share = done as f64 / all.max(1) as f64;
            let left = start.elapsed().as_secs_f64() * (1.0 / share - 1.0);
            let doing = format!("{} / {} on {}", cell.accel, cell.kernel, cell.case);
            progress.update(Some((share, left)), &doing);
        }
    })?;
    progress.clear();
    Ok(map)
}

/// Writes the map, its picture, and each failing cell as a scene and a ray.
fn write(map: &Map, dir: &Path, quiet: bool) -> Result<(), Failure> {
    let progress = Mutex::new(Progress::new(!quiet));
    let start = Instant::now();
    let files = write_map(map, dir, |done, all| {
        let share = done as f64 / all.max(1) as f64;
        let left = start.elapsed().as_secs_f64() * (1.0 / share - 1.0);
        if let Ok(mut progress) = progress.lock() {
            progress.update(Some((share, left)), "leaving out what failures do not need");
        }
    })?;
    if let Ok(mut progress) = progress.lock() {
        progress.clear();
    }
    if !quiet {
        eprintln!("wrote {} files to {}", files.len(), dir.display());
    }
    Ok(())
}

/// The exit code: a failure that the map does not expect weighs most.
fn judge(map: &Map) -> Result<(), Failure> {
    let failing = map.with(Verdict::Fails).count();
    if failing > 0 {
        return Err(Failure::Mismatch(format!(
            "{failing} cells of the map fail unexpectedly; `raylab stability --out DIR` writes each as a scene and a ray"
        )));
    }
    if map.stopped {
        return Err(Failure::Interrupted);
    }
    Ok(())
}

/// Both maps, what the letters mean, and a line for each cell that is not ok.
fn text(map: &Map) -> String {
    let mut text = matrix("kernels", &map.kernels, map, Map::kernel_cell);
    if !map.accels.is_empty() {
        text.push('\n');
        text.push_str(&matrix("accelerators", &map.accels, map, Map::accel_cell));
    }
    let letters = Verdict::ALL.map(|v| format!("{} {}", v.letter(), v.about()));
    let _ = writeln!(text, "\n{}", letters.join("   "));
    for verdict in [
        Verdict::Fails,
        Verdict::Gone,
        Verdict::Refused,
        Verdict::Known,
    ] {
        for cell in map.with(verdict) {
            text.push_str(&line(cell));
        }
    }
    text
}

/// A line a case, a column a method; the methods are numbered, since their names are long.
fn matrix<'m>(
    title: &str,
    methods: &[String],
    map: &'m Map,
    of: fn(&'m Map, &str, &str) -> Option<&'m Cell>,
) -> String {
    let width = map.cases.iter().map(|c| c.len()).max().unwrap_or(0);
    let mut text = String::new();
    for (i, method) in methods.iter().enumerate() {
        let lines = "   │".repeat(i) + "   ┌";
        let _ = writeln!(text, "{:>width$}{lines} {method}", "");
    }
    let _ = writeln!(text, "{title}");
    for case in &map.cases {
        let letters = methods.iter().map(|method| {
            let letter = of(map, method, case).map_or(' ', |cell| cell.verdict.letter());
            format!("   {letter}")
        });
        let _ = writeln!(text, "{case:<width$}{}", letters.collect::<String>());
    }
    text
}

/// What a cell that is not ok is about.
fn line(cell: &Cell) -> String {
    let method = if cell.of_kernel() {
        cell.kernel.clone()
    } else {
        format!("{} with {}", cell.accel, cell.kernel)
    };
    format!(
        "{} {method} on {}: {}\n",
        cell.verdict.letter(),
        cell.case,
        cell.story()
    )
}
