//! How costs grow with the number of triangles: which runs form a curve over the sizes of a family, and what law it
//! follows.
//!
//! ```text
//! runs --settings()--> (kernel, rays, threads)           one figure, one table
//!      --families()--> soup, sphereflake, …              one column of the figure
//!      --curves()----> accelerator with its parameters   one line, of at least three sizes
//!                      triangles                         one point of a line
//! ```
//!
//! Two laws are fitted to each curve, with N triangles:
//!
//! - the power `y = c · N^e`, a straight line through the logarithms of both;
//! - the logarithm `y = a + b · log2 N`: b is what each doubling of the scene adds.
//!
//! Which of them is nearer says how far off they are in relative terms: the smaller root mean square of `ln(y / law)`.

use std::fmt;

use serde::Serialize;

use crate::scene;
use crate::stats::Line;

use super::Run;
use super::series::{PanelKey, Point, Quantity, accel_label};

pub(super) mod table;

pub use table::{Growth, Laws, growths};

/// Fewest sizes of a family that make a curve.
pub const FEWEST: usize = 3;

/// What is charted over the number of triangles.
pub const COSTS: [Quantity; 3] = [Quantity::Build, Quantity::Time, Quantity::Steps];

/// What the curves of one figure share.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize)]
pub struct Setting {
    /// Kernel, with those of its parameters that differ from their defaults.
    pub kernel: String,
    /// Ray set spec.
    pub rays: String,
    /// Threads.
    pub threads: usize,
}

impl Setting {
    /// The setting of `run`: that of the runs which it was measured beside.
    #[must_use]
    pub fn of(run: &Run) -> Self {
        let key = PanelKey::of(run);
        Self {
            kernel: key.kernel,
            rays: key.rays,
            threads: key.threads,
        }
    }
}

impl fmt::Display for Setting {
    /// `woop · primary rays · 1 thread`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plural = if self.threads == 1 { "" } else { "s" };
        write!(
            f,
            "{} · {} rays · {} thread{plural}",
            self.kernel, self.rays, self.threads
        )
    }
}

/// The cost of one accelerator over the sizes of one family.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Accelerator, with those of its parameters that differ from their defaults.
    pub label: String,
    /// One a size, by rising number of triangles, which stands as n; at least [`FEWEST`], all values above 0.
    pub points: Vec<Point>,
}

/// A law of growth that is nearer to a curve than the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// `c · N^e`.
    Power,
    /// `a + b · log2 N`.
    Logarithm,
}

impl Curve {
    /// ln y over ln N: the slope is the exponent of N.
    #[must_use]
    pub fn power(&self) -> Option<Line> {
        let logs: Vec<(f64, f64)> = self.points.iter().map(|p| (p.n.ln(), p.y.ln())).collect();
        Line::through(&logs)
    }

    /// y over log2 N: the slope is what each doubling adds.
    #[must_use]
    pub fn logarithm(&self) -> Option<Line> {
        let halves: Vec<(f64, f64)> = self.points.iter().map(|p| (p.n.log2(), p.y)).collect();
        Line::through(&halves)
    }

    /// Which law is nearer; `None` where they are equally near, or there is none.
    #[must_use]
    pub fn nearer(&self) -> Option<Law> {
        let (power, logarithm) = (self.power()?, self.logarithm()?);
        let off = |law: &dyn Fn(f64) -> f64| -> f64 {
            let off = |p: &Point| (p.y / law(p.n)).ln().powi(2);
            self.points.iter().map(off).sum()
        };
        let powers = off(&|n| power.at(n.ln()).exp());
        // A law that is nowhere near may pass through 0: then the sum is no number, and it is not nearer.
        let logarithms = off(&|n| logarithm.at(n.log2()));
        if powers < logarithms || logarithms.is_nan() {
            Some(Law::Power)
        } else {
            (logarithms < powers).then_some(Law::Logarithm)
        }
    }
}

/// The settings under which an accelerator was run on enough sizes of a family, in the order in which they first occur.
#[must_use]
pub fn settings(runs: &[Run]) -> Vec<Setting> {
    let mut settings: Vec<Setting> = Vec::new();
    for run in timed(runs) {
        let setting = Setting::of(run);
        if !settings.contains(&setting) {
            settings.push(setting);
        }
    }
    settings.retain(|setting| !families(runs, setting).is_empty());
    settings
}

/// The families of which an accelerator was run on enough sizes, in the order in which they first occur.
#[must_use]
pub fn families(runs: &[Run], setting: &Setting) -> Vec<String> {
    let mut families: Vec<String> = Vec::new();
    for run in timed(runs).filter(|run| Setting::of(run) == *setting) {
        if let Some(family) = scene::family_of(&run.scene)
            && !families.contains(&family)
        {
            families.push(family);
        }
    }
    let charted = |family: &String| {
        let cost = |cost| !curves(runs, setting, family, cost).is_empty();
        COSTS.into_iter().any(cost)
    };
    families.retain(charted);
    families
}

/// The curves of one family, in the order in which their accelerators first occur.
///
/// Where an accelerator was measured on a size at several n, the fastest run counts: that of a choice of n by
/// measurement. Runs without a value above 0 are left out.
#[must_use]
pub fn curves(runs: &[Run], setting: &Setting, family: &str, cost: Quantity) -> Vec<Curve> {
    let mut lines: Vec<(String, Vec<&Run>)> = Vec::new();
    let here = |run: &&Run| {
        Setting::of(run) == *setting && scene::family_of(&run.scene).as_deref() == Some(family)
    };
    for run in timed(runs).filter(here) {
        let label = accel_label(run);
        match lines.iter_mut().find(|(of, _)| *of == label) {
            Some((_, line)) => take(line, run),
            None => lines.push((label, vec![run])),
        }
    }
    let curve = |(label, mut runs): (String, Vec<&Run>)| {
        runs.sort_by_key(|run| run.triangles);
        let points: Vec<Point> = runs.iter().filter_map(|run| point(run, cost)).collect();
        (points.len() >= FEWEST).then_some(Curve { label, points })
    };
    lines.into_iter().filter_map(curve).collect()
}

/// Runs of sweeps: those that the oracle judged lie elsewhere than the scene they name.
fn timed(runs: &[Run]) -> impl Iterator<Item = &Run> {
    runs.iter().filter(|run| run.accuracy.is_none())
}

/// Puts `run` to those of a line, instead of a slower one of the same size.
fn take<'a>(line: &mut Vec<&'a Run>, run: &'a Run) {
    let same = line
        .iter_mut()
        .find(|other| other.triangles == run.triangles);
    match same {
        Some(other) if run.mrays_per_s.median > other.mrays_per_s.median => *other = run,
        Some(_) => {}
        None => line.push(run),
    }
}

fn point(run: &Run, cost: Quantity) -> Option<Point> {
    let [y, lo, hi] = cost.of(run)?;
    (y > 0.0 && run.triangles > 0).then_some(Point {
        n: run.triangles as f64,
        y,
        lo,
        hi,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::{growing, run_of};
    use crate::stats::Summary;

    fn the_setting(runs: &[Run]) -> Setting {
        let settings = settings(runs);
        assert_eq!(settings.len(), 1);
        settings[0].clone()
    }

    #[test]
    fn runs_over_the_sizes_of_a_family_form_a_curve_by_rising_size() {
        let mut runs = growing();
        runs.reverse();
        let setting = the_setting(&runs);
        assert_eq!(setting.to_string(), "woop · primary rays · 1 thread");
        assert_eq!(families(&runs, &setting), ["sphereflake", "soup"]);
        let curves = curves(&runs, &setting, "soup", Quantity::Build);
        let labels: Vec<&str> = curves.iter().map(|c| c.label.as_str()).collect();
        assert_eq!(labels, ["bvh", "kd-tree", "grid"]);
        let sizes: Vec<f64> = curves[0].points.iter().map(|p| p.n).collect();
        assert_eq!(sizes, [1e3, 1e4, 1e5, 1e6]);
    }

    #[test]
    fn fewer_than_three_sizes_are_no_curve_and_files_no_family() {
        let of = |scene: &str, triangles| run_of(scene, triangles, "primary", 1, "bvh", None);
        let few = [of("soup:10", 10), of("soup:20", 20), of("city:9", 812)];
        assert!(settings(&few).is_empty());
        let files = [of("a/1.obj", 10), of("a/2.obj", 20), of("a/3.obj", 30)];
        assert!(settings(&files).is_empty());
        // Three scenes of one size, and sizes of another overlap.
        let same = [of("soup:10", 10), of("soup:10,1", 10), of("soup:20", 20)];
        assert!(settings(&same).is_empty());
        let other = [of("soup:10", 10), of("soup:20,8", 20), of("soup:30", 30)];
        assert!(settings(&other).is_empty());
    }

    #[test]
    fn of_several_n_the_fastest_counts_with_its_build() {
        let sizes = [1_000, 2_000, 4_000];
        let mut runs: Vec<Run> = Vec::new();
        for triangles in sizes {
            for (n, speed) in [(4, 1.0), (8, 3.0), (16, 2.0)] {
                let scene = format!("soup:{triangles}");
                let mut run = run_of(&scene, triangles, "primary", 1, "grid", Some(n));
                run.mrays_per_s = Summary::of(&[speed; 3], 1);
                run.build_ms = Summary::of(&[f64::from(n); 3], 1);
                runs.push(run);
            }
        }
        let setting = the_setting(&runs);
        let build = &curves(&runs, &setting, "soup", Quantity::Build)[0];
        assert!(build.points.len() == 3 && build.points.iter().all(|p| p.y == 8.0));
        // 3 Mrays/s are 333 ns a ray.
        let time = &curves(&runs, &setting, "soup", Quantity::Time)[0];
        assert!(
            time.points
                .iter()
                .all(|p| (p.y - 1e3 / 3.0).abs() < 1e-9 && p.lo <= p.y && p.y <= p.hi)
        );
    }

    fn curve(y: impl Fn(f64) -> f64) -> Curve {
        let point = |n: f64| Point {
            n,
            y: y(n),
            lo: y(n),
            hi: y(n),
        };
        Curve {
            label: "x".to_owned(),
            points: [1e3, 1e4, 1e5, 1e6].map(point).to_vec(),
        }
    }

    #[test]
    fn laws_are_told_apart() {
        let power = curve(|n| 0.3 * n.powf(1.07));
        let fit = power.power().unwrap();
        assert!((fit.slope - 1.07).abs() < 1e-9 && (fit.r2 - 1.0).abs() < 1e-9);
        assert_eq!(power.nearer(), Some(Law::Power));
        let logarithm = curve(|n| 5.0 + 2.5 * n.log2());
        let fit = logarithm.logarithm().unwrap();
        assert!((fit.slope - 2.5).abs() < 1e-9 && fit.points == 4);
        assert_eq!(logarithm.nearer(), Some(Law::Logarithm));
        // The exponent of a logarithm over three decades.
        assert!(logarithm.power().unwrap().slope < 0.11);
    }

    #[test]
    fn runs_without_a_value_are_left_out() {
        let mut runs = growing();
        for run in &mut runs {
            if run.accel == "bvh" && run.scene == "soup:1000" {
                run.build_ms = Summary::default();
            }
            if run.accel == "kd-tree" {
                run.per_ray = None;
            }
        }
        let setting = the_setting(&runs);
        let found = |cost| curves(&runs, &setting, "soup", cost);
        assert_eq!(found(Quantity::Build)[1].label, "kd-tree");
        let bvh = &found(Quantity::Build)[2];
        assert!(bvh.label == "bvh" && bvh.points.len() == 3);
        assert_eq!(found(Quantity::Steps).len(), 2);
    }
}
