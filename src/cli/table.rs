//! Tables for people.

use crate::report::scaling::{self, Growth, Laws};
use crate::report::series::{accel_label, kernel_label};
use crate::report::{Accuracy, ErrorSpread, Fallbacks, Rate, Run};

/// One row a run: configuration, speed with its interval, work a ray, build, memory, and whether the answers are right.
pub fn runs(runs: &[Run]) -> String {
    let header = [
        "scene", "accel", "n", "kernel", "rays", "thr", "Mrays/s", "95 %", "steps", "tests",
        "build ms", "MB", "valid",
    ];
    let sides = std::array::from_fn(|column| match column {
        0 | 1 | 3 | 4 | 12 => Side::Left,
        _ => Side::Right,
    });
    let mut rows = vec![header.map(str::to_owned)];
    rows.extend(runs.iter().map(row));
    columns(&rows, &sides)
}

fn row(run: &Run) -> [String; 13] {
    let speed = &run.mrays_per_s;
    [
        run.scene.clone(),
        run.accel.clone(),
        run.n.map_or_else(|| "-".to_owned(), |n| n.to_string()),
        run.kernel.clone(),
        run.rays.clone(),
        run.threads.to_string(),
        significant(speed.median),
        format!("{}..{}", significant(speed.lo), significant(speed.hi)),
        run.steps().map_or_else(|| "-".to_owned(), significant),
        run.tests().map_or_else(|| "-".to_owned(), significant),
        significant(run.build_ms.median),
        significant(run.memory_bytes as f64 / 1e6),
        match (run.wrong_answers, run.valid, run.kernel_errors) {
            (Some(wrong), _, _) if wrong > 0 => {
                format!("{wrong} of {} wrong", run.checked_rays)
            }
            (_, true, 0) => "yes".to_owned(),
            (_, true, errors) => format!("yes, {errors} kernel errors"),
            (_, false, _) => "NO".to_owned(),
        },
    ]
}

/// One row an accelerator and family of which it was run on enough sizes: how build and rays grow with the number N of
/// triangles, each as exponent of N, rays also as what a doubling of N adds, with the share of the variance that the law
/// explains. `None` where there is none.
pub fn growths(runs: &[Run]) -> Option<String> {
    let header = [
        "family",
        "accel",
        "kernel",
        "rays",
        "thr",
        "sizes",
        "build N^",
        "R2",
        "ns/ray N^",
        "R2",
        "a doubling",
        "R2",
        "steps N^",
        "R2",
        "a doubling",
        "R2",
    ];
    let sides = std::array::from_fn(|column| match column {
        0..=3 => Side::Left,
        _ => Side::Right,
    });
    let mut rows = vec![header.map(str::to_owned)];
    rows.extend(scaling::growths(runs).iter().map(row_of_growth));
    (rows.len() > 1).then(|| columns(&rows, &sides))
}

fn row_of_growth(growth: &Growth) -> [String; 16] {
    let figure = |laws: Option<Laws>, of: fn(Laws) -> f64| {
        laws.map_or_else(dash, |laws| significant(of(laws)))
    };
    let share = |laws: Option<Laws>, of: fn(Laws) -> f64| {
        laws.map_or_else(dash, |laws| format!("{:.3}", of(laws)))
    };
    let (build, time, steps) = (growth.build_ms, growth.ns_per_ray, growth.steps_per_ray);
    [
        growth.family.clone(),
        growth.accel.clone(),
        growth.setting.kernel.clone(),
        growth.setting.rays.clone(),
        growth.setting.threads.to_string(),
        growth.sizes.to_string(),
        figure(build, |l| l.exponent),
        share(build, |l| l.exponent_r2),
        figure(time, |l| l.exponent),
        share(time, |l| l.exponent_r2),
        figure(time, |l| l.a_doubling),
        share(time, |l| l.a_doubling_r2),
        figure(steps, |l| l.exponent),
        share(steps, |l| l.exponent_r2),
        figure(steps, |l| l.a_doubling),
        share(steps, |l| l.a_doubling_r2),
    ]
}

/// One row a judged run: configuration, speed, each rate in percent with its upper 95 % bound, error of t.
pub fn accuracy(runs: &[Run]) -> String {
    let header = [
        "scene",
        "place",
        "rays",
        "accel",
        "kernel",
        "Mrays/s",
        "leak %",
        "phantom %",
        "wrong surface %",
        "swap %",
        "occl. differs %",
        "t ulp p50",
        "p99",
        "max",
    ];
    let sides = std::array::from_fn(|column| match column {
        0..=4 => Side::Left,
        _ => Side::Right,
    });
    let mut rows = vec![header.map(str::to_owned)];
    rows.extend(runs.iter().filter_map(judged));
    columns(&rows, &sides)
}

/// The cells of a judged run; `None` where it was not judged.
fn judged(run: &Run) -> Option<[String; 14]> {
    let found = run.accuracy?;
    let rate = |seen: u64| percent(Rate::of(seen, found.rays));
    let [scene, place, rays, accel, kernel] = method(run, &found);
    Some([
        scene,
        place,
        rays,
        accel,
        kernel,
        significant(run.mrays_per_s.median),
        rate(found.leaks),
        rate(found.phantoms),
        rate(found.wrong_surface),
        rate(found.neighbour_swaps),
        rate(found.occlusion_disagreements),
        significant(found.t_ulp.p50),
        significant(found.t_ulp.p99),
        significant(found.t_ulp.max),
    ])
}

/// What was judged where.
fn method(run: &Run, found: &Accuracy) -> [String; 5] {
    let place = match found.scale {
        1.0 => format!("{:e}", found.offset),
        scale => format!("{:e} x{scale:e}", found.offset),
    };
    let n = run.n.map_or_else(String::new, |n| format!(" n={n}"));
    [
        run.scene.clone(),
        place,
        run.rays.clone(),
        accel_label(run) + &n,
        kernel_label(run),
    ]
}

/// One row a judged run: how far right hits are off, how often secondary rays meet the triangle they leave, and how
/// often answers change with what means nothing; rates in percent with their upper 95 % bounds. Of the kernel `exact` also
/// how many of its tests `f32` could not decide.
pub fn errors(runs: &[Run]) -> String {
    let header = [
        "scene",
        "place",
        "rays",
        "accel",
        "kernel",
        "to plane p50",
        "p99",
        "max",
        "barycentric p99",
        "max",
        "self-hits % naive",
        "n*1e-4",
        "t_min 1e-4",
        "integer",
        "bound",
        "rotated %",
        "moved %",
        "in f64 %",
        "on integers %",
    ];
    let sides = std::array::from_fn(|column| match column {
        0..=4 => Side::Left,
        _ => Side::Right,
    });
    let mut rows = vec![header.map(str::to_owned)];
    rows.extend(runs.iter().filter_map(row_of_errors));
    columns(&rows, &sides)
}

/// The cells of a judged run; `None` where it was not judged.
fn row_of_errors(run: &Run) -> Option<[String; 19]> {
    let found = run.accuracy?;
    let [scene, place, rays, accel, kernel] = method(run, &found);
    let error = |spread: Option<ErrorSpread>, figure: fn(ErrorSpread) -> f64| {
        spread.map_or_else(dash, |s| significant(figure(s)))
    };
    let rate = |rate: Option<Rate>| rate.map_or_else(dash, percent);
    let of_tests = |count: fn(Fallbacks) -> u64| {
        let share = |f: Fallbacks| 100.0 * count(f) as f64 / f.tests.max(1) as f64;
        found.fallbacks.map_or_else(dash, |f| significant(share(f)))
    };
    let start = |rule: usize| rate(found.self_hits.map(|rules| rules[rule].rate));
    Some([
        scene,
        place,
        rays,
        accel,
        kernel,
        error(found.plane, |s| s.p50),
        error(found.plane, |s| s.p99),
        error(found.plane, |s| s.max),
        error(found.barycentric, |s| s.p99),
        error(found.barycentric, |s| s.max),
        start(0),
        start(1),
        start(2),
        start(3),
        start(4),
        rate(found.vertex_rotation),
        rate(found.translation),
        of_tests(|f| f.f64),
        of_tests(|f| f.integers),
    ])
}

fn dash() -> String {
    "-".to_owned()
}

/// A rate with its upper bound, in percent.
fn percent(rate: Rate) -> String {
    let bound = significant(100.0 * rate.upper95);
    format!("{} <={bound}", significant(100.0 * rate.share()))
}

/// The side of its column that a cell leans to: words to the left, numbers to the right.
#[derive(Debug, Clone, Copy)]
pub enum Side {
    Left,
    Right,
}

/// A line a row, columns as wide as their widest cell.
pub fn columns<const N: usize>(rows: &[[String; N]], sides: &[Side; N]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let widths: [usize; N] = std::array::from_fn(|column| width(column).unwrap_or(0));
    let line = |row: &[String; N]| {
        let cells = row.iter().zip(sides).zip(widths);
        let cells = cells.map(|((cell, side), width)| match side {
            Side::Left => format!("{cell:<width$}"),
            Side::Right => format!("{cell:>width$}"),
        });
        let line = cells.collect::<Vec<_>>().join("  ");
        format!("{}\n", line.trim_end())
    };
    rows.iter().map(line).collect()
}

/// Three significant digits, without exponents.
pub fn significant(x: f64) -> String {
    let magnitude = x.abs();
    match magnitude {
        m if m >= 100.0 => format!("{x:.0}"),
        m if m >= 10.0 => format!("{x:.1}"),
        m if m >= 1.0 => format!("{x:.2}"),
        m if m >= 0.001 => format!("{x:.4}"),
        0.0 => "0".to_owned(),
        _ => format!("{x:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_three_digits() {
        let texts = [1234.5, 12.34, 1.2345, 0.01234, 0.0].map(significant);
        assert_eq!(texts, ["1234", "12.3", "1.23", "0.0123", "0"]);
    }

    #[test]
    fn columns_are_aligned() {
        let rows = [["a", "bb", "7"], ["ccc", "d", "1234"]].map(|row| row.map(str::to_owned));
        let text = columns(&rows, &[Side::Left, Side::Left, Side::Right]);
        assert_eq!(text, "a    bb     7\nccc  d   1234\n");
    }
}
