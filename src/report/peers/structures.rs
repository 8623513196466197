//! Every structure on one scene: speed by ray set, build, memory, wrong answers.

use crate::report::plot::text::measured;
use crate::report::series::{PanelKey, accel_label};
use crate::report::{Report, Run};

use super::aligned::aligned;
use super::{build_ms, cell, fastest};

/// The table: a row an accelerator with its parameters and kernel, a column a ray set. Speeds are those of the fastest n at
/// one thread; build times those of all builds at one thread and at two.
pub(super) fn table(report: &Report, scene: &str) -> String {
    let sets = ray_sets(report);
    let mut head = ["accelerator", "kernel"].map(str::to_owned).to_vec();
    head.extend(sets.iter().cloned());
    head.extend(["build ms", "2 threads", "MiB", "wrong"].map(str::to_owned));
    let mut table = vec![head];
    let mut seen: Vec<(String, String)> = Vec::new();
    for run in report.runs.iter().filter(|run| run.scene == scene) {
        let key = key(run);
        if !seen.contains(&key) {
            table.push(row(report, run, &sets));
            seen.push(key);
        }
    }
    aligned(&table)
}

/// What tells the rows apart.
fn key(run: &Run) -> (String, String) {
    (accel_label(run), PanelKey::of(run).kernel)
}

/// Ray sets in the order in which they first occur.
fn ray_sets(report: &Report) -> Vec<String> {
    let mut sets: Vec<String> = Vec::new();
    for run in &report.runs {
        if !sets.contains(&run.rays) {
            sets.push(run.rays.clone());
        }
    }
    sets
}

/// The row of all runs that differ from `run` in ray set, n and threads alone.
fn row(report: &Report, run: &Run, sets: &[String]) -> Vec<String> {
    let key = key(run);
    let same = |other: &Run| other.scene == run.scene && self::key(other) == key;
    // The next column names the kernel.
    let accel = key.0.replace(&format!(" ({})", run.kernel), "");
    let mut line = vec![accel, run.kernel.clone()];
    for set in sets {
        let best = fastest(report, |other| {
            same(other) && other.rays == *set && other.threads == 1
        });
        line.push(cell(best.map(|run| run.mrays_per_s.median)));
    }
    line.push(cell(build_ms(report, &run.scene, 1, same)));
    line.push(cell(build_ms(report, &run.scene, 2, same)));
    line.push(measured(run.memory_bytes as f64 / f64::from(1 << 20)));
    let all = report.runs.iter().filter(|other| same(other));
    let (wrong, checked) = all.fold((0, 0), |(wrong, checked), run| {
        (
            wrong + run.wrong_answers.unwrap_or(u64::from(!run.valid)),
            checked + run.checked_rays,
        )
    });
    line.push(format!("{wrong} of {checked}"));
    line
}
