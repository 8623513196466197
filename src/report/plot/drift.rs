//! Error against the distance from the origin or against the scale: one line a method; what is wrong, and how far t is
//! off.

use crate::report::Report;
use crate::report::judged::{Along, Course, labels, places, points};

use super::against::{self, Figure, Line, Quantity};
use super::axis::number;
use super::figure::Style;
use super::theme::Look;

const QUANTITIES: [Quantity; 2] = [
    ("Wrong decisions (share of rays)", |a| a.wrong_rate()),
    ("Error of t at right hits (ulp, 99th percentile)", |a| {
        a.t_ulp.p99
    }),
];

/// The chart as SVG; `None` where fewer than two places lie along the axis.
///
/// # Errors
/// What could not be drawn.
pub(super) fn svg(
    report: &Report,
    course: &Course,
    along: Along,
    style: Style,
) -> Result<Option<String>, String> {
    let mut at: Vec<_> = places(&report.runs, course)
        .into_iter()
        .filter_map(|place| Some((along.position(place)?, place)))
        .collect();
    at.sort_by(|a, b| a.0.total_cmp(&b.0));
    if at.len() < 2 {
        return Ok(None);
    }
    let mut lines: Vec<Line> = labels(&report.runs)
        .into_iter()
        .enumerate()
        .map(|(index, label)| Line {
            label,
            look: Look::of(index),
            found: Vec::new(),
        })
        .collect();
    for (position, place) in at {
        for point in points(&report.runs, course, place) {
            if let Some(line) = lines.iter_mut().find(|l| l.label == point.label) {
                line.found.push((position, point.accuracy));
            }
        }
    }
    lines.retain(|line| !line.found.is_empty());
    let (x, title, facts) = match along {
        Along::Offset { scale: 1.0 } => (
            "offset from the origin along each axis",
            "error against offset",
            String::new(),
        ),
        Along::Offset { scale } => (
            "offset from the origin along each axis",
            "error against offset",
            format!(", scaled by {}", number(scale)),
        ),
        Along::Scale { offset: 0.0 } => (
            "scale about the origin",
            "error against scale",
            String::new(),
        ),
        Along::Scale { offset } => (
            "scale about the origin",
            "error against scale",
            format!(", moved by {} along each axis", number(offset)),
        ),
    };
    let figure = Figure {
        facts,
        title,
        x,
        quantities: &QUANTITIES,
        lines,
        note: "Scene and rays scaled, moved along each axis and rounded to f32 again; rays are aimed at the moved mesh. \
               The row 0 holds methods of which no error was seen.",
    };
    against::svg(report, course, &figure, style).map(Some)
}
