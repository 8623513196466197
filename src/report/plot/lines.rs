//! Panels over n: a line an accelerator, its interval as a band, its name beside its end.

use crate::report::series::Quantity;

use super::axis::{Axis, Base, number};
use super::canvas::{Anchor, Canvas};
use super::curves::{self, Column};
use super::figure::{MARGIN, Panel, Plot, WIDTH, label_face, panel_head, quiet_face};
use super::font;
use super::plane::{Plane, Rows, widest_tick};
use super::theme::{Look, Theme};

/// Least height of the area between the axes: alone, and one of several.
const TALL: f64 = 330.0;
const LOW: f64 = 210.0;
/// Least width of the area between the axes.
const LEAST_WIDTH: f64 = 420.0;
/// A panel's heading.
const HEADING: f64 = 24.0;
/// A row that shows a prediction.
const ROW: f64 = 17.0;
/// Ticks below a panel.
const TICKS: f64 = 24.0;
/// The name of the axis below the last panel.
const AXIS_NAME: f64 = 18.0;
/// Between two panels.
const APART: f64 = 16.0;

/// What the model says is best, and of which lines.
struct Best {
    n: f64,
    plateau: [f64; 2],
    look: Look,
    text: String,
}

struct Strip {
    panel: Panel,
    y: Axis,
    bests: Vec<Best>,
    height: f64,
}

impl Strip {
    fn full_height(&self) -> f64 {
        HEADING + self.bests.len() as f64 * ROW + self.height + TICKS
    }
}

struct Lines {
    strips: Vec<Strip>,
    x: Axis,
    left: f64,
    right: f64,
    column: Column,
    width: f64,
}

/// Lays out `panels`, of which at least one has a line over n.
pub(super) fn plan(panels: Vec<Panel>, theme: &Theme) -> impl Plot + use<> {
    let alone = panels.len() == 1;
    let most = panels.iter().map(|p| p.curves.len()).max().unwrap_or(0);
    let column = Column::large(most);
    let labels = panels
        .iter()
        .map(|p| column.width(p, theme))
        .fold(0.0, f64::max);
    let strips: Vec<Strip> = panels
        .into_iter()
        .map(|panel| {
            let least = if alone { TALL } else { LOW };
            let height = least.max(column.height(&panel));
            Strip {
                y: Axis::new(panel.values(), Base::Ten, height, 22.0),
                bests: bests(&panel),
                panel,
                height,
            }
        })
        .collect();
    let ticks = strips
        .iter()
        .map(|s| widest_tick(&s.y, theme))
        .fold(0.0, f64::max);
    let left = MARGIN + ticks + 8.0;
    let width = (left + LEAST_WIDTH + labels + MARGIN).max(WIDTH);
    let right = width - MARGIN - labels;
    let n = strips
        .iter()
        .flat_map(|s| &s.panel.curves)
        .filter(|c| !c.series.constant)
        .flat_map(|c| c.series.points.iter().map(|p| p.n));
    Lines {
        x: Axis::new(n, Base::Two, right - left, 26.0),
        strips,
        left,
        right,
        column,
        width,
    }
}

/// The predictions that a panel shows, those of equal content once.
fn bests(panel: &Panel) -> Vec<Best> {
    if panel.quantity != Quantity::Speed {
        return Vec::new();
    }
    let mut bests: Vec<(Best, Vec<String>)> = Vec::new();
    for curve in panel.curves.iter().filter(|c| !c.series.constant) {
        let (Some(n), Some(plateau)) = (curve.series.best_n, curve.series.plateau) else {
            continue;
        };
        match bests
            .iter_mut()
            .find(|(b, _)| b.n == n && b.plateau == plateau)
        {
            Some((_, names)) => names.push(curve.name.clone()),
            None => bests.push((
                Best {
                    n,
                    plateau,
                    look: curve.look,
                    text: String::new(),
                },
                vec![curve.name.clone()],
            )),
        }
    }
    let one = bests.len() == 1;
    bests
        .into_iter()
        .map(|(best, names)| {
            let of = if one {
                String::new()
            } else {
                format!("{}: ", names.join(", "))
            };
            let [lo, hi] = best.plateau.map(number);
            let text = format!("{of}predicted best n = {}, ties {lo}–{hi}", number(best.n));
            Best { text, ..best }
        })
        .collect()
}

impl Plot for Lines {
    fn width(&self) -> f64 {
        self.width
    }

    fn height(&self) -> f64 {
        let strips: f64 = self.strips.iter().map(Strip::full_height).sum();
        strips + APART * (self.strips.len() as f64 - 1.0) + AXIS_NAME
    }

    fn interval(&self) -> &'static str {
        "band"
    }

    fn legend(&self) -> Vec<&'static str> {
        let curves = || self.strips.iter().flat_map(|s| &s.panel.curves);
        let mut legend = Vec::new();
        if self
            .strips
            .iter()
            .any(|s| s.panel.quantity == Quantity::Speed)
        {
            legend.push("Ring: fastest n.");
        }
        if curves().any(|c| c.series.constant) {
            legend.push("Dashed level lines: accelerators without n.");
        }
        if curves().any(|c| !c.series.predicted.is_empty()) {
            legend.push("Thin dotted: predicted for a random line through the scene's box.");
        }
        legend
    }

    fn draw(&self, canvas: &mut Canvas, theme: &Theme, top: f64) {
        let mut y = top;
        for strip in &self.strips {
            self.draw_strip(canvas, theme, strip, y);
            y += strip.full_height() + APART;
        }
        let middle = f64::midpoint(self.left, self.right);
        canvas.text(
            "grid resolution n",
            (middle, y - APART + 11.0),
            Anchor::Middle,
            label_face(theme),
        );
    }
}

impl Lines {
    fn draw_strip(&self, canvas: &mut Canvas, theme: &Theme, strip: &Strip, top: f64) {
        panel_head(canvas, theme, &strip.panel, MARGIN, top + 12.0);
        let plot_top = top + HEADING + strip.bests.len() as f64 * ROW;
        let plane = Plane::new(
            self.x.clone(),
            strip.y.clone(),
            (self.left, plot_top),
            (self.right, plot_top + strip.height),
        );
        if let [best] = strip.bests.as_slice() {
            let [from, to] = best.plateau.map(|n| plane.at(n, plane.y.hi).0);
            let (from, to) = ((from, plane.top - ROW / 2.0), (to, plane.bottom));
            canvas.rectangle(from, to, theme.axis, 0.13);
        }
        plane.draw(canvas, theme, Rows::Labelled);
        for (row, best) in strip.bests.iter().enumerate() {
            let y = top + HEADING + (row as f64 + 0.5) * ROW;
            self.draw_best(canvas, theme, &plane, best, y);
        }
        curves::draw(canvas, theme, &plane, &strip.panel, &self.column);
    }

    /// A bracket over the plateau with a diamond at the best n, its text on the side where there is room.
    fn draw_best(&self, canvas: &mut Canvas, theme: &Theme, plane: &Plane, best: &Best, y: f64) {
        let colour = theme.lines[best.look.colour];
        let x = |n: f64| plane.at(n, plane.y.hi).0;
        let [from, to] = best.plateau.map(x);
        canvas.line(&[(from, y), (to, y)], colour, 1.2, &[]);
        // A plateau that leaves the axis has no end there.
        let shown = |n: f64| (plane.x.lo..=plane.x.hi).contains(&n);
        for (end, n) in [from, to].into_iter().zip(best.plateau) {
            if shown(n) {
                canvas.line(&[(end, y - 3.5), (end, y + 3.5)], colour, 1.2, &[]);
            }
        }
        if shown(best.n) {
            let at = (x(best.n), y);
            canvas.marker(at, super::theme::Marker::Diamond, colour, theme.ground);
        }
        let face = quiet_face(theme);
        let room = self.width - MARGIN - (to + 8.0);
        let base = y + 0.36 * face.size;
        if face.width(&best.text) <= room {
            canvas.text(&best.text, (to + 8.0, base), Anchor::Start, face);
        } else {
            let text = font::fit(&best.text, face.size, face.weight, from - 8.0 - MARGIN);
            canvas.text(&text, (from - 8.0, base), Anchor::End, face);
        }
    }
}
