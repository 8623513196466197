//! Panels without n: a row an accelerator, best first, its value as a dot with a whisker for the interval.

use crate::report::series::Quantity;

use super::axis::{Axis, Base, measured};
use super::canvas::{Anchor, Canvas};
use super::figure::{Curve, MARGIN, Panel, Plot, WIDTH, label_face, panel_head, quiet_face};
use super::plane::{Plane, Rows};
use super::theme::Theme;

/// From one row to the next.
const PITCH: f64 = 22.0;
const HEADING: f64 = 24.0;
/// Ticks below a panel.
const TICKS: f64 = 24.0;
/// Between two panels.
const APART: f64 = 16.0;
/// Least width of the area of the dots.
const LEAST_WIDTH: f64 = 360.0;
/// Room for a value at the right.
const VALUE: f64 = 64.0;

struct Dots {
    panels: Vec<Panel>,
    left: f64,
}

/// Lays out `panels`, whose curves are all constant.
pub(super) fn plan(mut panels: Vec<Panel>, theme: &Theme) -> impl Plot + use<> {
    for panel in &mut panels {
        let down = panel.quantity == Quantity::Speed;
        panel.curves.sort_by(|a, b| {
            let order = value(a).total_cmp(&value(b));
            if down { order.reverse() } else { order }
        });
    }
    let names = panels
        .iter()
        .flat_map(|p| p.curves.iter().map(|c| label_face(theme).width(&c.name)))
        .fold(0.0, f64::max);
    Dots {
        left: MARGIN + names + 12.0,
        panels,
    }
}

fn value(curve: &Curve) -> f64 {
    curve.series.points.first().map_or(0.0, |p| p.y)
}

fn rows(panel: &Panel) -> f64 {
    panel.curves.len() as f64 * PITCH
}

impl Plot for Dots {
    fn width(&self) -> f64 {
        WIDTH.max(self.left + LEAST_WIDTH + VALUE + MARGIN)
    }

    fn height(&self) -> f64 {
        let rows: f64 = self.panels.iter().map(|p| HEADING + rows(p) + TICKS).sum();
        rows + APART * (self.panels.len() as f64 - 1.0)
    }

    fn interval(&self) -> &'static str {
        "bar"
    }

    fn legend(&self) -> Vec<&'static str> {
        Vec::new()
    }

    fn draw(&self, canvas: &mut Canvas, theme: &Theme, top: f64) {
        let mut y = top;
        for panel in &self.panels {
            panel_head(canvas, theme, panel, MARGIN, y + 12.0);
            y += HEADING;
            let right = self.width() - MARGIN - VALUE;
            let plane = Plane::new(
                Axis::new(panel.values(), Base::Ten, right - self.left, 48.0),
                Axis::new([1.0], Base::Ten, rows(panel), PITCH),
                (self.left, y),
                (right, y + rows(panel)),
            );
            plane.draw(canvas, theme, Rows::Hidden);
            for (row, curve) in panel.curves.iter().enumerate() {
                let y = y + (row as f64 + 0.5) * PITCH;
                draw_row(canvas, theme, &plane, curve, y);
            }
            y += rows(panel) + TICKS + APART;
        }
    }
}

fn draw_row(canvas: &mut Canvas, theme: &Theme, plane: &Plane, curve: &Curve, y: f64) {
    let colour = theme.lines[curve.look.colour];
    let (names, values) = (label_face(theme), quiet_face(theme));
    let base = y + 0.36 * names.size;
    let at = (plane.left - 10.0, base);
    canvas.text(&curve.name, at, Anchor::End, names);
    canvas.line(&[(plane.left, y), (plane.right, y)], theme.grid, 0.75, &[]);
    for point in &curve.series.points {
        let x = |value: f64| plane.at(value, plane.y.hi).0;
        if point.lo < point.hi {
            canvas.line(&[(x(point.lo), y), (x(point.hi), y)], colour, 3.2, &[]);
        }
        canvas.marker((x(point.y), y), curve.look.marker, colour, theme.ground);
        let at = (plane.right + 12.0, base);
        canvas.text(&measured(point.y), at, Anchor::Start, values);
    }
}
