//! Error against a kernel's parameter, e.g. the tolerance of `sheet-unsigned`: one line a place; what is wrong, and how
//! often a neighbour is named.

use crate::lab::{Accuracy, Place};
use crate::report::Report;
use crate::report::judged::{Course, Tuned, place_of, places};

use super::against::{self, Figure, Line, Quantity};
use super::axis::number;
use super::figure::Style;
use super::theme::Look;

const QUANTITIES: [Quantity; 2] = [
    ("Wrong decisions (share of rays)", |a| a.wrong_rate()),
    ("Neighbour swaps (share of rays)", |a| {
        a.neighbour_swaps as f64 / a.rays.max(1) as f64
    }),
];

/// The chart as SVG; `None` where the report has fewer than two values.
///
/// # Errors
/// What could not be drawn.
pub(super) fn svg(
    report: &Report,
    course: &Course,
    tuned: &Tuned,
    style: Style,
) -> Result<Option<String>, String> {
    let found = |place: Place| {
        let runs = report.runs.iter().filter(|r| Course::of(r) == *course);
        let at = |a: &Accuracy| place_of(a) == place;
        let mut found: Vec<(f64, Accuracy)> = runs
            .filter_map(|run| Some((tuned.value(run)?, run.accuracy.filter(at)?)))
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.dedup_by(|a, b| a.0 == b.0);
        found
    };
    let lines: Vec<Line> = places(&report.runs, course)
        .into_iter()
        .enumerate()
        .map(|(index, place)| Line {
            label: label(place),
            look: Look::of(index),
            found: found(place),
        })
        .filter(|line| !line.found.is_empty())
        .collect();
    if lines.iter().all(|line| line.found.len() < 2) {
        return Ok(None);
    }
    let n = tuned.n.map_or_else(String::new, |n| format!(" n={n}"));
    let figure = Figure {
        facts: format!(", {} in {}{n}", tuned.kernel, tuned.accel),
        title: &format!("error of {} against {}", tuned.kernel, tuned.key),
        x: &tuned.key,
        quantities: &QUANTITIES,
        lines,
        note: "One line a place: how far the scene was moved along each axis, and by what it was scaled before. The row \
               0 holds values at which no error was seen.",
    };
    against::svg(report, course, &figure, style).map(Some)
}

fn label(place: Place) -> String {
    let offset = format!("offset {}", number(place.offset));
    if place.scale == 1.0 {
        offset
    } else {
        format!("{offset}, scale {}", number(place.scale))
    }
}
