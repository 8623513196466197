//! Errors against something else, as one line a method or place in two panels: what the charts of drift and of
//! parameters share.
//!
//! ```text
//!   name of a panel
//!     |         ,-----o------ line
//!     |  o-----o------------- another
//!    0|--o-----o------o------
//!     +--//-----------
//!      0     1e2  1e4   x
//! ```

use crate::lab::Accuracy;
use crate::report::Report;
use crate::report::judged::Course;

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
pub(super) type Quantity = (&'static str, fn(&Accuracy) -> f64);

/// Values by rising x.
pub(super) struct Line {
    pub label: String,
    pub look: Look,
    pub found: Vec<(f64, Accuracy)>,
}

/// A figure of this kind.
pub(super) struct Figure<'a> {
    /// What the subtitle adds to triangles and rays.
    pub facts: String,
    /// What follows the course in the figure's title.
    pub title: &'a str,
    /// What the horizontal axis is called.
    pub x: &'a str,
    pub quantities: &'a [Quantity; 2],
    pub lines: Vec<Line>,
    /// What the small print says first.
    pub note: &'a str,
}

/// The figure as SVG.
///
/// # Errors
/// What could not be drawn.
pub(super) fn svg(
    report: &Report,
    course: &Course,
    figure: &Figure,
    style: Style,
) -> Result<String, String> {
    let theme = style.theme;
    let text = format!("{} {}", figure.note, note::machine(&report.provenance));
    let note = font::wrap(&text, note::SMALL, WIDTH - 2.0 * MARGIN);
    let tall = TALL.max(figure.lines.len() as f64 * PITCH + 8.0);
    let foot = TOP + 2.0 * (ABOVE + tall + BELOW) + 16.0;
    let height = (foot + note.len() as f64 * note::PITCH + 6.0).ceil();
    let mut drawn = String::new();
    let mut canvas = Canvas::new(&mut drawn, WIDTH, height, theme.ground);
    let name = heading(&mut canvas, theme, report, course, &figure.facts);
    for (i, quantity) in figure.quantities.iter().enumerate() {
        let top = TOP + i as f64 * (ABOVE + tall + BELOW);
        panel(&mut canvas, theme, &figure.lines, quantity, (top, tall));
    }
    let below = (WIDTH / 2.0, foot - 16.0);
    canvas.text(figure.x, below, Anchor::Middle, label_face(theme));
    note::draw(&mut canvas, theme, &note, foot);
    let widths = canvas.end()?;
    let head = Head {
        width: WIDTH,
        height,
        title: &format!("{name}: {}", figure.title),
        adapts: style.adapts,
    };
    Ok(finish(&drawn, &widths, &head))
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
