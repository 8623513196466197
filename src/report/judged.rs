//! Runs that the oracle judged: which of them share a chart, and which are not beaten in both speed and accuracy.
//!
//! ```text
//! runs --courses()--> (scene, rays, threads)      what methods are compared on
//!      --places()---> offset and scale            one Pareto chart of a course
//!      --points()---> kernel and accelerator      one point of it
//!      --drifts()---> an axis of places           one chart of error against it, one line a method
//!      --tuned()----> a kernel's parameter        one chart of error against it, one line a place
//! ```

use std::fmt;

use crate::lab::{Accuracy, Place};
use crate::stats::upper95;

use super::Run;
use super::series::{accel_label, kernel_label, kernel_numbers};

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

/// Where an [`Accuracy`] was found.
#[must_use]
pub fn place_of(accuracy: &Accuracy) -> Place {
    Place {
        offset: accuracy.offset,
        scale: accuracy.scale,
    }
}

/// The places of a course: the scene's own size first, then by rising scale; each by rising offset.
#[must_use]
pub fn places(runs: &[Run], course: &Course) -> Vec<Place> {
    let mut places: Vec<Place> = runs
        .iter()
        .filter(|run| Course::of(run) == *course)
        .filter_map(|run| Some(place_of(&run.accuracy?)))
        .collect();
    places.sort_by(|a, b| {
        let order = |p: &Place| (p.scale != 1.0, p.scale, p.offset);
        let (a, b) = (order(a), order(b));
        (a.0.cmp(&b.0))
            .then(a.1.total_cmp(&b.1))
            .then(a.2.total_cmp(&b.2))
    });
    places.dedup();
    places
}

/// What a chart of error runs along.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Along {
    /// Offsets, at this scale.
    Offset {
        /// The scale.
        scale: f64,
    },
    /// Scales, at this offset.
    Scale {
        /// The offset.
        offset: f64,
    },
}

impl Along {
    /// The position of `place` on the axis; `None` where it is not of this chart.
    #[must_use]
    pub fn position(self, place: Place) -> Option<f64> {
        match self {
            Self::Offset { scale } => (place.scale == scale).then_some(place.offset),
            Self::Scale { offset } => (place.offset == offset).then_some(place.scale),
        }
    }
}

/// The charts of error of a course: each axis along which it has two places or more.
#[must_use]
pub fn drifts(runs: &[Run], course: &Course) -> Vec<Along> {
    let places = places(runs, course);
    let mut axes: Vec<Along> = Vec::new();
    for place in &places {
        let (offset, scale) = (place.offset, place.scale);
        for along in [Along::Offset { scale }, Along::Scale { offset }] {
            let on_it = places.iter().filter_map(|p| along.position(*p)).count();
            if on_it > 1 && !axes.contains(&along) {
                axes.push(along);
            }
        }
    }
    axes
}

/// A numeric parameter of a kernel of which a course has several values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tuned {
    /// Kernel.
    pub kernel: String,
    /// Accelerator with its parameters.
    pub accel: String,
    /// Resolution.
    pub n: Option<u32>,
    /// The parameter.
    pub key: String,
}

impl Tuned {
    /// The parameter's value in `run`; `None` where the run is of another method.
    #[must_use]
    pub fn value(&self, run: &Run) -> Option<f64> {
        let same = run.kernel == self.kernel && run.n == self.n && accel_label(run) == self.accel;
        let mut numbers = kernel_numbers(run).into_iter();
        same.then(|| numbers.find(|(key, _)| *key == self.key))?
            .map(|(_, value)| value)
    }
}

/// The parameters of kernels of which a course has two values or more.
#[must_use]
pub fn tuned(runs: &[Run], course: &Course) -> Vec<Tuned> {
    let judged = |run: &&Run| run.accuracy.is_some() && Course::of(run) == *course;
    let mut tuned: Vec<Tuned> = Vec::new();
    for run in runs.iter().filter(judged) {
        for (key, value) in kernel_numbers(run) {
            let one = Tuned {
                kernel: run.kernel.clone(),
                accel: accel_label(run),
                n: run.n,
                key,
            };
            let others = runs.iter().filter(judged).filter_map(|r| one.value(r));
            if !tuned.contains(&one) && others.into_iter().any(|other| other != value) {
                tuned.push(one);
            }
        }
    }
    tuned
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

/// The methods of a course at one place, in the order of the report; runs without a speed are left out.
#[must_use]
pub fn points(runs: &[Run], course: &Course, place: Place) -> Vec<Judged> {
    let mut points: Vec<Judged> = runs
        .iter()
        .filter(|run| Course::of(run) == *course)
        .filter_map(|run| {
            let accuracy = run.accuracy.filter(|a| place_of(a) == place)?;
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
        let points = points(&runs, &Course::of(&runs[0]), Place::ITS_OWN);
        let front: Vec<bool> = points.iter().map(|p| p.front).collect();
        assert_eq!(front, [true, true, false, false]);
        assert!(points[0].bound > 0.0 && points[0].bound < 3.0 / 65_536.0);
    }

    #[test]
    fn places_and_methods_come_once_and_runs_that_were_not_judged_not_at_all() {
        let mut runs = vec![
            judged("woop", 1e4, 10.0, 0),
            judged("woop", 0.0, 10.0, 0),
            crate::report::fixture::run("bvh", None),
        ];
        let course = Course::of(&runs[0]);
        assert_eq!(courses(&runs).len(), 1);
        let offsets: Vec<f64> = places(&runs, &course).iter().map(|p| p.offset).collect();
        assert_eq!(offsets, [0.0, 1e4]);
        assert_eq!(drifts(&runs, &course), [Along::Offset { scale: 1.0 }]);
        assert_eq!(labels(&runs), ["woop"]);
        runs[1].accel = "brute".to_owned();
        assert_eq!(labels(&runs), ["woop in bvh", "woop in brute"]);
    }
    #[test]
    fn a_parameter_with_several_values_is_charted_and_one_with_a_single_value_is_not() {
        let runs: Vec<Run> = [1e-7, 1e-5]
            .map(|eps| {
                let mut run = judged("sheet-unsigned", 0.0, 10.0, 3);
                run.params.insert("eps", crate::registry::Value::Float(eps));
                run
            })
            .to_vec();
        let course = Course::of(&runs[0]);
        assert!(tuned(&runs[..1], &course).is_empty());
        let found = tuned(&runs, &course);
        assert_eq!((found.len(), found[0].key.as_str()), (1, "eps"));
        assert_eq!(found[0].value(&runs[1]), Some(1e-5));
        assert_eq!(found[0].value(&judged("woop", 0.0, 1.0, 0)), None);
    }
}
