//! From runs to the curves of a chart: which runs share a panel, which of them form one line, and what its points are.
//!
//! Plots and the TUI's charts read the same series, so the rules of grouping stand here and nowhere else:
//!
//! ```text
//! runs --panels()--> (scene, kernel, rays, threads)      one panel
//!      --series()--> accelerator with its parameters     one line of a panel
//!                    n                                   one point of a line
//! ```

use std::fmt;

use crate::accel;
use crate::kernel;
use crate::registry::{ParamSpec, Params};

use super::Run;

/// The key under which a run's `params` say that the predictor chose n.
const N_RULE: &str = "n_rule";

/// The key under which they say what `auto` picked.
const PICKED: &str = "picked";

/// What a chart shows over n.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Quantity {
    /// Millions of rays a second.
    Speed,
    /// Cells or nodes that a ray visits, mean.
    Steps,
    /// Ray/triangle tests of a ray, mean.
    Tests,
    /// Build time.
    Build,
    /// Structure and packed triangles.
    Memory,
    /// Time that a ray takes: what speed is the inverse of. Of charts over the number of triangles, not of those over n.
    Time,
}

impl Quantity {
    /// All that are charted over n, in the order in which they are shown.
    pub const ALL: [Self; 5] = [
        Self::Speed,
        Self::Steps,
        Self::Tests,
        Self::Build,
        Self::Memory,
    ];

    /// What an axis is called, without the unit.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Steps => "steps per ray",
            Self::Tests => "tests per ray",
            Self::Build => "build time",
            Self::Memory => "memory",
            Self::Time => "time per ray",
        }
    }

    /// The unit of the values; empty for counts.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Speed => "Mrays/s",
            Self::Steps | Self::Tests => "",
            Self::Build => "ms",
            Self::Memory => "MiB",
            Self::Time => "ns",
        }
    }

    /// `label (unit)`, or the label alone where there is no unit.
    #[must_use]
    pub fn title(self) -> String {
        match self.unit() {
            "" => self.label().to_owned(),
            unit => format!("{} ({unit})", self.label()),
        }
    }

    /// Value and interval of one run; `None` where it has none, e.g. before its first sample.
    pub(super) fn of(self, run: &Run) -> Option<[f64; 3]> {
        let [y, lo, hi] = match self {
            Self::Speed if run.mrays_per_s.samples.is_empty() && run.mrays_per_s.median == 0.0 => {
                return None;
            }
            Self::Speed => [
                run.mrays_per_s.median,
                run.mrays_per_s.lo,
                run.mrays_per_s.hi,
            ],
            Self::Build => [run.build_ms.median, run.build_ms.lo, run.build_ms.hi],
            Self::Steps => [run.steps()?; 3],
            Self::Tests => [run.tests()?; 3],
            Self::Memory => [run.memory_bytes as f64 / f64::from(1 << 20); 3],
            // The slowest ray takes longest.
            Self::Time => {
                let speed = &run.mrays_per_s;
                [speed.median, speed.hi, speed.lo].map(|mrays_per_s| 1e3 / mrays_per_s)
            }
        };
        let within = |x: f64| x.is_finite() && x >= 0.0;
        // A missing or foreign interval shrinks to the value: it never hides the point.
        let lo = if within(lo) { lo.min(y) } else { y };
        let hi = if within(hi) { hi.max(y) } else { y };
        within(y).then_some([y, lo, hi])
    }
}

/// What the runs of one panel share.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PanelKey {
    /// Scene spec.
    pub scene: String,
    /// Kernel, with those of its parameters that differ from their defaults.
    pub kernel: String,
    /// Ray set spec.
    pub rays: String,
    /// Threads.
    pub threads: usize,
}

impl PanelKey {
    /// The panel that `run` belongs to: that of the runs which it was measured beside.
    #[must_use]
    pub fn of(run: &Run) -> Self {
        Self {
            scene: run.scene.clone(),
            kernel: run
                .beside_kernel
                .clone()
                .unwrap_or_else(|| kernel_label(run)),
            rays: run.rays.clone(),
            threads: run.threads,
        }
    }
}

impl fmt::Display for PanelKey {
    /// `teapot · woop · primary rays · 1 thread`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plural = if self.threads == 1 { "" } else { "s" };
        write!(
            f,
            "{} · {} · {} rays · {} thread{plural}",
            self.scene, self.kernel, self.rays, self.threads
        )
    }
}

/// One measured point of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Resolution; 1 in a [`Series::constant`] series, whose value belongs to no n.
    pub n: f64,
    /// Value: finite, at least 0.
    pub y: f64,
    /// Lower end of its interval; equal to `y` where the value is exact.
    pub lo: f64,
    /// Upper end of its interval; equal to `y` where the value is exact.
    pub hi: f64,
}

/// One line of a panel: an accelerator with its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Accelerator, with those of its parameters that differ from their defaults.
    pub label: String,
    /// Its points by rising n, one an n; at least one. One in all where the series is constant.
    pub points: Vec<Point>,
    /// Whether the accelerator has no n: its one value is a level line across the chart.
    pub constant: bool,
    /// The n that the predictor calls best, where a model predicts.
    pub best_n: Option<f64>,
    /// Least and greatest n that the predictor calls as good as the best.
    pub plateau: Option<[f64; 2]>,
    /// `(n, value)` that the model predicts for a random line through the scene's box, by rising n; empty where there
    /// is none. Only steps and tests are predicted.
    pub predicted: Vec<(f64, f64)>,
}

/// The panels of `runs`, in the order in which they first occur. Runs that the oracle judged are not among them: their
/// charts are those of [`super::judged`].
#[must_use]
pub fn panels(runs: &[Run]) -> Vec<PanelKey> {
    let mut panels = Vec::new();
    for run in runs.iter().filter(|run| run.accuracy.is_none()) {
        let key = PanelKey::of(run);
        if !panels.contains(&key) {
            panels.push(key);
        }
    }
    panels
}

/// The lines of one panel, in the order in which their accelerators first occur.
///
/// Runs without a finite value are left out, and so are lines without a point. Where two runs of a line have the same n
/// (asked for and predicted, or measured again) the later one counts.
#[must_use]
pub fn series(runs: &[Run], key: &PanelKey, quantity: Quantity) -> Vec<Series> {
    let mut lines: Vec<Series> = Vec::new();
    for run in runs.iter().filter(|run| PanelKey::of(run) == *key) {
        let Some([y, lo, hi]) = quantity.of(run) else {
            continue;
        };
        let label = accel_label(run);
        let constant = run.n.is_none();
        let at = lines
            .iter()
            .position(|s| s.label == label && s.constant == constant)
            .unwrap_or_else(|| {
                lines.push(Series {
                    label,
                    points: Vec::new(),
                    constant,
                    best_n: None,
                    plateau: None,
                    predicted: Vec::new(),
                });
                lines.len() - 1
            });
        let n = f64::from(run.n.unwrap_or(1));
        let line = &mut lines[at];
        put(&mut line.points, |p| p.n, Point { n, y, lo, hi });
        add_prediction(line, run, quantity, n);
    }
    lines
}

/// Takes over what the model says of `run`.
fn add_prediction(line: &mut Series, run: &Run, quantity: Quantity, n: f64) {
    let Some(prediction) = &run.predicted else {
        return;
    };
    line.best_n = Some(f64::from(prediction.n));
    line.plateau = Some(prediction.plateau.map(f64::from));
    let value = match quantity {
        Quantity::Steps => prediction.steps,
        Quantity::Tests => prediction.tests,
        _ => return,
    };
    if value.is_finite() && value >= 0.0 {
        put(&mut line.predicted, |p| p.0, (n, value));
    }
}

/// Puts `item` at its place by rising `n`, instead of the one that is there.
fn put<T>(items: &mut Vec<T>, n: impl Fn(&T) -> f64, item: T) {
    match items.binary_search_by(|other| n(other).total_cmp(&n(&item))) {
        Ok(at) => items[at] = item,
        Err(at) => items.insert(at, item),
    }
}

/// The accelerator of `run` as a person would have written it: with the parameters that differ from their defaults.
/// Where a peer's own test decided hits, it is named, since the panel names another.
#[must_use]
pub fn accel_label(run: &Run) -> String {
    let ours = |key| kernel_key(run, key).is_none().then_some(key);
    let label = label(&run.accel, &run.params, accel_specs(run), ours);
    match run.beside_kernel {
        Some(_) => format!("{label} ({})", run.kernel),
        None => label,
    }
}

/// The kernel of `run` as a person would have written it: with the parameters that differ from their defaults.
#[must_use]
pub fn kernel_label(run: &Run) -> String {
    label(&run.kernel, &run.params, kernel_specs(run), |key| {
        kernel_key(run, key)
    })
}

/// The kernel's parameters that are numbers.
#[must_use]
pub fn kernel_numbers(run: &Run) -> Vec<(String, f64)> {
    let numbers = run.params.iter().filter_map(|(key, _)| {
        let name = kernel_key(run, key)?;
        Some((name.to_owned(), run.params.number(key)?))
    });
    numbers.collect()
}

fn accel_specs(run: &Run) -> &'static [ParamSpec] {
    accel::entry(&run.accel).map_or(&[][..], |entry| entry.params)
}

fn kernel_specs(run: &Run) -> &'static [ParamSpec] {
    kernel::KERNELS
        .iter()
        .find(|k| k.name == run.kernel)
        .map_or(&[][..], |entry| entry.params)
}

/// What the kernel of `run` calls the parameter that stands under `key`; `None` where it is the accelerator's.
///
/// A run holds both kinds together, the kernel's as `kernel.KEY` where the accelerator has one of the same name.
fn kernel_key<'a>(run: &Run, key: &'a str) -> Option<&'a str> {
    let has = |specs: &[ParamSpec]| specs.iter().any(|s| s.name == key);
    key.strip_prefix("kernel.")
        .or_else(|| (!has(accel_specs(run)) && has(kernel_specs(run))).then_some(key))
}

/// `name:key=value…` with those of `params` that have a key of `ours` and differ from the defaults of `specs`.
fn label<'a>(
    name: &str,
    params: &'a Params,
    specs: &[ParamSpec],
    ours: impl Fn(&'a str) -> Option<&'a str>,
) -> String {
    let defaults = Params::defaults(specs);
    params
        .iter()
        .filter(|(key, _)| ![N_RULE, PICKED].contains(key))
        .filter_map(|(key, value)| Some((ours(key)?, value)))
        .filter(|pair| !defaults.iter().any(|default| default == *pair))
        .fold(name.to_owned(), |label, (key, value)| {
            format!("{label}:{key}={value}")
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::{self, run};

    #[test]
    fn runs_that_share_scene_kernel_rays_and_threads_share_a_panel() {
        let mut runs = vec![run("grid", Some(4)), run("bvh", None), run("grid", Some(8))];
        runs[2].threads = 2;
        let panels = panels(&runs);
        assert_eq!(panels.len(), 2);
        assert_eq!(
            panels[0].to_string(),
            "teapot · woop · primary rays · 1 thread"
        );
        assert_eq!(
            panels[1].to_string(),
            "teapot · woop · primary rays · 2 threads"
        );
    }

    #[test]
    fn a_line_is_ordered_by_n_and_the_later_run_of_an_n_counts() {
        let mut runs = vec![
            run("grid", Some(8)),
            run("grid", Some(2)),
            run("brute", None),
            run("grid", Some(8)),
        ];
        runs[3].mrays_per_s.median = 99.0;
        let lines = series(&runs, &PanelKey::of(&runs[0]), Quantity::Speed);
        assert_eq!(lines.len(), 2);
        let n: Vec<f64> = lines[0].points.iter().map(|p| p.n).collect();
        assert_eq!(n, [2.0, 8.0]);
        assert_eq!(lines[0].points[1].y, 99.0);
        assert!(!lines[0].constant && lines[1].constant);
        assert_eq!(lines[1].points.len(), 1);
    }

    #[test]
    fn values_that_are_missing_or_not_finite_are_left_out() {
        let mut runs = vec![run("grid", Some(2)), run("grid", Some(4)), run("bvh", None)];
        runs[1].mrays_per_s.median = f64::NAN;
        runs[2].mrays_per_s = crate::stats::Summary::default();
        let lines = series(&runs, &PanelKey::of(&runs[0]), Quantity::Speed);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].points.len(), 1);
    }

    #[test]
    fn an_interval_always_contains_its_value() {
        let mut runs = vec![run("grid", Some(2)), run("grid", Some(4))];
        runs[0].mrays_per_s.lo = runs[0].mrays_per_s.median * 2.0;
        runs[1].mrays_per_s.hi = f64::NAN;
        for point in &series(&runs, &PanelKey::of(&runs[0]), Quantity::Speed)[0].points {
            assert!(point.lo <= point.y && point.y <= point.hi, "{point:?}");
        }
    }

    #[test]
    fn only_parameters_that_differ_from_their_defaults_are_named() {
        let mut grid = run("grid", Some(4));
        grid.params = fixture::params(&[("mystery", "7"), ("n_rule", "auto")]);
        assert_eq!(accel_label(&grid), "grid:mystery=7");
        assert_eq!(kernel_label(&grid), "woop");
        let mut auto = run("auto", None);
        auto.params = fixture::params(&[("picked", "bvh-wide:build=reinsert")]);
        assert_eq!(accel_label(&auto), "auto");
        let mut sheet = run("bvh", None);
        sheet.kernel = "sheet-unsigned".to_owned();
        for (eps, label) in [
            ("1e-5", "sheet-unsigned"),
            ("0.5", "sheet-unsigned:eps=0.5"),
        ] {
            for key in ["eps", "kernel.eps"] {
                sheet.params = fixture::params(&[(key, eps)]);
                assert_eq!(accel_label(&sheet), "bvh");
                assert_eq!(kernel_label(&sheet), label);
            }
        }
        for entry in accel::ACCELERATORS {
            let mut default = run(entry.name, None);
            default.params = Params::defaults(entry.params);
            assert_eq!(accel_label(&default), entry.name);
        }
    }

    #[test]
    fn predictions_follow_their_quantity() {
        let report = fixture::teapot();
        let key = &panels(&report.runs)[0];
        let of = |quantity| {
            series(&report.runs, key, quantity)
                .into_iter()
                .find(|s| s.label == "grid")
                .unwrap()
        };
        assert!(!of(Quantity::Steps).predicted.is_empty());
        assert!(of(Quantity::Memory).predicted.is_empty());
        let [lo, hi] = of(Quantity::Speed).plateau.unwrap();
        let best = of(Quantity::Speed).best_n.unwrap();
        assert!(lo <= best && best <= hi);
    }
}
