//! Runs that the oracle judged: which of them share a chart, and which are not beaten in both speed and accuracy.
//!
//! ```text
//! runs --courses()--> (scene, rays, threads)      one chart of error against offset, one line a method
//!      --offsets()--> offset                      one Pareto chart of a course
//!      --points()---> kernel and accelerator      one point of it
//! ```

use std::fmt;

use crate::lab::Accuracy;
use crate::stats::upper95;

use super::Run;
use super::series::{accel_label, kernel_label};

/// Scene, rays and threads: what methods are compared on.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Course {
    /// Scene spec.
    pub scene: String,
    /// Ray set spec.
    pub rays: String,
    /// Threads.
    pub threads: usize,
}

impl fmt::Display for Course {
    /// `teapot · edge rays · 1 thread`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plural = if self.threads == 1 { "" } else { "s" };
        let (scene, rays, threads) = (&self.scene, &self.rays, self.threads);
        write!(f, "{scene} · {rays} rays · {threads} thread{plural}")
    }
}

impl Course {
    /// The course of `run`.
    #[must_use]
    pub fn of(run: &Run) -> Self {
        Self {
            scene: run.scene.clone(),
            rays: run.rays.clone(),
            threads: run.threads,
        }
    }
}

/// A method on a Pareto chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// Kernel, and accelerator where the report has several; with parameters that differ from their defaults.
    pub label: String,
    /// What the oracle found.
    pub accuracy: Accuracy,
    /// Median of the speed and its interval, in Mrays/s; positive.
    pub speed: [f64; 3],
    /// Upper 95 % bound of the rate of wrong decisions.
    pub bound: f64,
    /// Whether no other method of the chart is at least as fast and decides no more rays wrongly.
    pub front: bool,
}

/// The courses of the judged runs, in the order in which they first occur.
#[must_use]
pub fn courses(runs: &[Run]) -> Vec<Course> {
    let mut courses = Vec::new();
    for run in runs.iter().filter(|run| run.accuracy.is_some()) {
        let course = Course::of(run);
        if !courses.contains(&course) {
            courses.push(course);
        }
    }
    courses
}

/// The offsets of a course, rising.
#[must_use]
pub fn offsets(runs: &[Run], course: &Course) -> Vec<f64> {
    let mut offsets: Vec<f64> = runs
        .iter()
        .filter(|run| Course::of(run) == *course)
        .filter_map(|run| Some(run.accuracy?.offset))
        .collect();
    offsets.sort_by(f64::total_cmp);
    offsets.dedup();
    offsets
}

/// The labels of all judged runs, each once: the same method has the same place in every chart of a report.
#[must_use]
pub fn labels(runs: &[Run]) -> Vec<String> {
    let mut labels = Vec::new();
    for run in runs.iter().filter(|run| run.accuracy.is_some()) {
        let label = label(runs, run);
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    labels
}

/// Kernel, and accelerator where judged runs have several.
fn label(runs: &[Run], run: &Run) -> String {
    let accel = accel_label(run);
    let peers = || {
        runs.iter()
            .filter(|other| other.accuracy.is_some() && Course::of(other) == Course::of(run))
    };
    let several = peers().any(|other| accel_label(other) != accel);
    let resolutions = peers().any(|other| accel_label(other) == accel && other.n != run.n);
    let kernel = kernel_label(run);
    match (several, resolutions, run.n) {
        (_, true, Some(number)) => format!("{kernel} in {accel} n={number}"),
        (true, ..) => format!("{kernel} in {accel}"),
        _ => kernel,
    }
}

/// The methods of a course at one offset, in the order of the report; runs without a speed are left out.
#[must_use]
pub fn points(runs: &[Run], course: &Course, offset: f64) -> Vec<Judged> {
    let mut points: Vec<Judged> = runs
        .iter()
        .filter(|run| Course::of(run) == *course)
        .filter_map(|run| {
            let accuracy = run.accuracy.filter(|a| a.offset == offset)?;
            let s = &run.mrays_per_s;
            let positive = |x: f64| x.is_finite() && x > 0.0;
            let or = |x: f64| if positive(x) { x } else { s.median };
            positive(s.median).then(|| Judged {
                label: label(runs, run),
                accuracy,
                speed: [s.median, or(s.lo).min(s.median), or(s.hi).max(s.median)],
                bound: upper95(accuracy.wrong(), accuracy.rays),
                front: false,
            })
        })
        .collect();
    let beats = |a: &Judged, b: &Judged| {
        let (x, y) = (a.speed[0], b.speed[0]);
        let (e, f) = (a.accuracy.wrong_rate(), b.accuracy.wrong_rate());
        x >= y && e <= f && (x > y || e < f)
    };
    let front: Vec<bool> = points
        .iter()
        .map(|p| !points.iter().any(|other| beats(other, p)))
        .collect();
    for (point, front) in points.iter_mut().zip(front) {
        point.front = front;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::judged;

    #[test]
    fn the_front_holds_what_no_other_method_beats_in_both() {
        let runs = [
            judged("woop", 0.0, 10.0, 0),
            judged("moller-trumbore", 0.0, 12.0, 300),
            judged("sheet-signed", 0.0, 9.0, 400),
            judged("sheet-unsigned", 0.0, 9.5, 0),
        ];
        let points = points(&runs, &Course::of(&runs[0]), 0.0);
        let front: Vec<bool> = points.iter().map(|p| p.front).collect();
        assert_eq!(front, [true, true, false, false]);
        assert!(points[0].bound > 0.0 && points[0].bound < 3.0 / 65_536.0);
    }

    #[test]
    fn offsets_and_methods_come_once_and_runs_that_were_not_judged_not_at_all() {
        let mut runs = vec![
            judged("woop", 1e4, 10.0, 0),
            judged("woop", 0.0, 10.0, 0),
            crate::report::fixture::run("bvh", None),
        ];
        let course = Course::of(&runs[0]);
        assert_eq!(courses(&runs).len(), 1);
        assert_eq!(offsets(&runs, &course), [0.0, 1e4]);
        assert_eq!(labels(&runs), ["woop"]);
        runs[1].accel = "brute".to_owned();
        assert_eq!(labels(&runs), ["woop in bvh", "woop in brute"]);
    }
}
