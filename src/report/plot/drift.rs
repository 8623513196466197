//! Error against the distance from the origin: one line a method; what is wrong, and how far t is off.
//!
//! ```text
//!   share of rays decided wrongly
//!     |         ,----- sheet-signed
//!     |  ------'------ moller-trumbore
//!    0|--------------- woop
//!     +--//-----------
//!      0     1e2  1e4   offset
//! ```

use crate::lab::Accuracy;
use crate::report::Report;
use crate::report::judged::{Course, labels, offsets, points};

use super::axis::{Axis, Base};
use super::canvas::{Anchor, At, Canvas, Head, finish};
use super::figure::{MARGIN, Style, WIDTH, label_face, quiet_face};
use super::font;
use super::labels::spread;
use super::note;
use super::pareto::{axis_name, heading};
use super::plane::{Plane, Rows, widest_tick};
use super::theme::{Look, Theme};

/// Least height of one panel's area between the axes.
const TALL: f64 = 200.0;
/// From one label to the next.
const PITCH: f64 = 13.5;
/// Between the ends of the lines and the labels.
const GUTTER: f64 = 34.0;
/// Name of a panel above it, ticks below it.
const ABOVE: f64 = 22.0;
const BELOW: f64 = 34.0;
const TOP: f64 = 58.0;

/// What a panel is called and what it shows of a method.
type Quantity = (&'static str, fn(&Accuracy) -> f64);

const QUANTITIES: [Quantity; 2] = [
    ("Wrong decisions (share of rays)", |a| a.wrong_rate()),
    ("Error of t at right hits (ulp, 99th percentile)", |a| {
        a.t_ulp.p99
    }),
];

/// A method's values by rising offset.
struct Line {
    label: String,
    look: Look,
    found: Vec<(f64, Accuracy)>,
}

/// The chart as SVG; `None` where fewer than two offsets were judged.
///
/// # Errors
/// What could not be drawn.
pub(super) fn svg(
    report: &Report,
    course: &Course,
    style: Style,
) -> Result<Option<String>, String> {
    let offsets = offsets(&report.runs, course);
    if offsets.len() < 2 {
        return Ok(None);
    }
    let theme = style.theme;
    let lines = lines(report, course, &offsets);
    let text = format!(
        "Scene and rays moved along each axis and rounded to f32 again; rays are aimed at the moved mesh. The row 0 holds \
         methods of which no error was seen. {}",
        note::machine(&report.provenance)
    );
    let note = font::wrap(&text, note::SMALL, WIDTH - 2.0 * MARGIN);
    let tall = TALL.max(lines.len() as f64 * PITCH + 8.0);
    let foot = TOP + 2.0 * (ABOVE + tall + BELOW) + 16.0;
    let height = (foot + note.len() as f64 * note::PITCH + 6.0).ceil();
    let mut drawn = String::new();
    let mut canvas = Canvas::new(&mut drawn, WIDTH, height, theme.ground);
    let name = heading(&mut canvas, theme, report, course, None);
    for (i, quantity) in QUANTITIES.iter().enumerate() {
        let top = TOP + i as f64 * (ABOVE + tall + BELOW);
        panel(&mut canvas, theme, &lines, quantity, (top, tall));
    }
    let below = (WIDTH / 2.0, foot - 16.0);
    let what = "offset from the origin along each axis";
    canvas.text(what, below, Anchor::Middle, label_face(theme));
    note::draw(&mut canvas, theme, &note, foot);
    let widths = canvas.end()?;
    let head = Head {
        width: WIDTH,
        height,
        title: &format!("{name}: error against offset"),
        adapts: style.adapts,
    };
    Ok(Some(finish(&drawn, &widths, &head)))
}

fn lines(report: &Report, course: &Course, offsets: &[f64]) -> Vec<Line> {
    let mut lines: Vec<Line> = labels(&report.runs)
        .into_iter()
        .enumerate()
        .map(|(index, label)| Line {
            label,
            look: Look::of(index),
            found: Vec::new(),
        })
        .collect();
    for &offset in offsets {
        for point in points(&report.runs, course, offset) {
            if let Some(line) = lines.iter_mut().find(|l| l.label == point.label) {
                line.found.push((offset, point.accuracy));
            }
        }
    }
    lines.retain(|line| !line.found.is_empty());
    lines
}

fn panel(
    canvas: &mut Canvas,
    theme: &Theme,
    lines: &[Line],
    (name, value): &Quantity,
    (top, tall): At,
) {
    axis_name(canvas, theme, name, top + 12.0);
    let face = quiet_face(theme);
    let all = || lines.iter().flat_map(|l| &l.found);
    let y = Axis::new(all().map(|(_, a)| value(a)), Base::Ten, tall, 24.0);
    let left = MARGIN + widest_tick(&y, theme) + 10.0;
    let names = lines
        .iter()
        .map(|l| face.width(&l.label))
        .fold(0.0, f64::max);
    let right = (WIDTH - MARGIN - GUTTER - names).max(left + 200.0);
    let x = Axis::new(
        all().map(|(offset, _)| *offset),
        Base::Ten,
        right - left,
        40.0,
    );
    let plane = Plane::new(x, y, (left, top + ABOVE), (right, top + ABOVE + tall));
    plane.draw(canvas, theme, Rows::Labelled);
    let at = |(offset, found): &(f64, Accuracy)| plane.at(*offset, value(found));
    for line in lines {
        let points: Vec<At> = line.found.iter().map(at).collect();
        let colour = theme.lines[line.look.colour];
        canvas.line(&points, colour, 1.6, line.look.dashes(false));
    }
    for line in lines {
        for point in line.found.iter().map(at) {
            canvas.marker(
                point,
                line.look.marker,
                theme.lines[line.look.colour],
                theme.ground,
            );
        }
    }
    let ends: Vec<At> = lines
        .iter()
        .filter_map(|l| l.found.last().map(at))
        .collect();
    let wishes: Vec<f64> = ends.iter().map(|end| end.1).collect();
    let places = spread(&wishes, PITCH, plane.top + 4.0, plane.bottom - 4.0);
    for ((line, end), y) in lines.iter().zip(ends).zip(places) {
        let colour = theme.lines[line.look.colour];
        let leader = [
            (end.0 + 5.0, end.1),
            (right + 8.0, end.1),
            (right + 22.0, y),
        ];
        canvas.line(&leader, colour, 0.7, &[]);
        // Half a pixel, so that the widest name is not cut for a rounding error.
        let room = WIDTH - MARGIN - (right + GUTTER) + 0.5;
        let text = font::fit(&line.label, face.size, face.weight, room);
        canvas.marker((right + 26.0, y), line.look.marker, colour, theme.ground);
        let base = (right + GUTTER, y + 0.36 * face.size);
        canvas.text(&text, base, Anchor::Start, face);
    }
}
