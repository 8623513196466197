//! Curves on a plane: the interval as a band, the line, its signs, and its name beside its end.

use crate::report::series::Quantity;

use super::axis::{measured, number};
use super::canvas::{Anchor, At, Canvas, Face};
use super::figure::{Curve, Panel, label_face, quiet_face};
use super::labels;
use super::plane::Plane;
use super::theme::Theme;

/// The column of labels at the right of a plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column {
    /// Between the plane and the texts: leader and sign.
    gutter: f64,
    /// Pixels an em.
    size: f64,
    /// From one label to the next.
    pitch: f64,
    /// Whether numbers stand beside the names.
    figures: bool,
}

impl Column {
    /// For a plane as wide as a figure with `most` labels.
    pub fn large(most: usize) -> Self {
        Self {
            // Among many labels leaders are longer, so that they fan out and can be followed.
            gutter: if most > 8 { 76.0 } else { 34.0 },
            size: 11.5,
            pitch: 15.0,
            figures: true,
        }
    }

    /// For one of several planes in a row.
    pub const fn small() -> Self {
        Self {
            gutter: 30.0,
            size: 9.5,
            pitch: 12.0,
            figures: false,
        }
    }

    fn face(&self, theme: &Theme) -> Face {
        Face {
            size: self.size,
            ..label_face(theme)
        }
    }

    /// Of the figures beside the names: never larger than these.
    fn figure_face(&self, theme: &Theme) -> Face {
        let quiet = quiet_face(theme);
        Face {
            size: quiet.size.min(self.size),
            ..quiet
        }
    }

    /// Width of the labels of `panel` with their leaders.
    pub fn width(&self, panel: &Panel, theme: &Theme) -> f64 {
        let width = |curve: &Curve| {
            let figure = self.figure(curve, panel.quantity);
            let figure = figure.map_or(0.0, |f| 7.0 + self.figure_face(theme).width(&f));
            self.face(theme).width(&curve.name) + figure
        };
        self.gutter + panel.curves.iter().map(width).fold(0.0, f64::max)
    }

    /// Least height of a plane beside which the labels of `panel` stand apart.
    pub fn height(&self, panel: &Panel) -> f64 {
        panel.curves.len() as f64 * self.pitch + 10.0
    }

    /// The figure beside the name: the best speed and where, or the value of a level line.
    fn figure(&self, curve: &Curve, quantity: Quantity) -> Option<String> {
        if !self.figures || curve.figure.is_some() {
            return curve.figure.clone();
        }
        let series = &curve.series;
        if series.constant {
            return series.points.first().map(|p| measured(p.y));
        }
        let best = peak(curve, quantity)?;
        Some(format!("{} at n = {}", measured(best.1), number(best.0)))
    }
}

/// Draws the curves of `panel` and their labels.
pub(super) fn draw(
    canvas: &mut Canvas,
    theme: &Theme,
    plane: &Plane,
    panel: &Panel,
    column: &Column,
) {
    for curve in &panel.curves {
        draw_band(canvas, theme, plane, curve);
    }
    for curve in &panel.curves {
        draw_line(canvas, theme, plane, curve);
    }
    for curve in &panel.curves {
        draw_markers(canvas, theme, plane, curve, panel.quantity);
    }
    draw_labels(canvas, theme, plane, panel, column);
}

/// The fastest point of a line over n.
fn peak(curve: &Curve, quantity: Quantity) -> Option<At> {
    (quantity == Quantity::Speed && !curve.series.constant)
        .then(|| {
            curve
                .series
                .points
                .iter()
                .max_by(|a, b| a.y.total_cmp(&b.y))
        })
        .flatten()
        .map(|p| (p.n, p.y))
}

/// The interval: a band along a line, a whisker at a single point, a bar across for a level line.
fn draw_band(canvas: &mut Canvas, theme: &Theme, plane: &Plane, curve: &Curve) {
    let colour = theme.lines[curve.look.colour];
    let points = &curve.series.points;
    if points.iter().all(|p| p.lo == p.hi) {
        return;
    }
    let band: Vec<At> = match points.as_slice() {
        [p] if curve.series.constant => {
            let (lo, hi) = (plane.at(plane.x.lo, p.lo).1, plane.at(plane.x.lo, p.hi).1);
            vec![
                (plane.left, hi),
                (plane.right, hi),
                (plane.right, lo),
                (plane.left, lo),
            ]
        }
        [p] => {
            canvas.line(
                &[plane.at(p.n, p.lo), plane.at(p.n, p.hi)],
                colour,
                1.2,
                &[],
            );
            return;
        }
        points => {
            let upper = points.iter().map(|p| plane.at(p.n, p.hi));
            let lower = points.iter().rev().map(|p| plane.at(p.n, p.lo));
            upper.chain(lower).collect()
        }
    };
    canvas.polygon(&band, colour, 0.2);
}

fn draw_line(canvas: &mut Canvas, theme: &Theme, plane: &Plane, curve: &Curve) {
    let colour = theme.lines[curve.look.colour];
    let predicted: Vec<At> = curve
        .series
        .predicted
        .iter()
        .map(|&(n, y)| plane.at(n, y))
        .collect();
    if predicted.len() > 1 {
        canvas.line(&predicted, colour, 0.9, &[1.2, 2.2]);
    }
    let line: Vec<At> = if curve.series.constant {
        let y = curve.series.points[0].y;
        let y = plane.at(plane.x.lo, y).1;
        vec![(plane.left, y), (plane.right, y)]
    } else {
        curve
            .series
            .points
            .iter()
            .map(|p| plane.at(p.n, p.y))
            .collect()
    };
    if line.len() > 1 {
        let width = if curve.series.constant { 1.3 } else { 1.7 };
        let dashes = curve.look.dashes(curve.series.constant);
        canvas.line(&line, colour, width, dashes);
    }
}

fn draw_markers(canvas: &mut Canvas, theme: &Theme, plane: &Plane, curve: &Curve, of: Quantity) {
    let colour = theme.lines[curve.look.colour];
    if curve.series.constant {
        return;
    }
    // Signs closer than their size are a smear: then every second, third … point has one.
    let count = curve.series.points.len();
    let every = (count as f64 * 12.0 / (plane.right - plane.left))
        .ceil()
        .max(1.0) as usize;
    for point in curve.series.points.iter().rev().step_by(every) {
        canvas.marker(
            plane.at(point.n, point.y),
            curve.look.marker,
            colour,
            theme.ground,
        );
    }
    if let Some((n, y)) = peak(curve, of) {
        canvas.marker(plane.at(n, y), curve.look.marker, colour, theme.ground);
        canvas.ring(plane.at(n, y), 6.2, colour, 1.1);
    }
}

/// Names beside the ends of the lines, each with a leader and the line's sign.
fn draw_labels(canvas: &mut Canvas, theme: &Theme, plane: &Plane, panel: &Panel, column: &Column) {
    let gutter = column.gutter;
    let ends: Vec<At> = panel
        .curves
        .iter()
        .filter_map(|c| {
            let last = c.series.points.last()?;
            Some(if c.series.constant {
                (plane.right, plane.at(plane.x.lo, last.y).1)
            } else {
                plane.at(last.n, last.y)
            })
        })
        .collect();
    let wishes: Vec<f64> = ends.iter().map(|e| e.1).collect();
    let places = labels::spread(&wishes, column.pitch, plane.top + 4.0, plane.bottom - 4.0);
    for ((curve, end), y) in panel.curves.iter().zip(ends).zip(places) {
        let colour = theme.lines[curve.look.colour];
        if end.0 + 7.0 < plane.right {
            let gap = [(end.0 + 6.0, end.1), (plane.right, end.1)];
            canvas.line(&gap, colour, 0.7, &[1.0, 2.5]);
        }
        let leader = [
            (plane.right, end.1),
            (plane.right + 4.0, end.1),
            (plane.right + gutter - 17.0, y),
            (plane.right + gutter - 14.0, y),
        ];
        canvas.line(&leader, colour, 0.8, &[]);
        let sign = (plane.right + gutter - 9.5, y);
        canvas.marker(sign, curve.look.marker, colour, theme.ground);
        let face = column.face(theme);
        let text = &curve.name;
        let x = plane.right + gutter - 2.0;
        let base = y + 0.36 * face.size;
        canvas.text(text, (x, base), Anchor::Start, face);
        if let Some(figure) = column.figure(curve, panel.quantity) {
            let x = x + face.width(text) + 7.0;
            let face = column.figure_face(theme);
            canvas.text(&figure, (x, base), Anchor::Start, face);
        }
    }
}
