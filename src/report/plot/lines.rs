//! Panels over n: a line an accelerator, its interval as a band, its name beside its end.

use crate::report::series::Quantity;

use super::axis::{Axis, Base, Tick, measured, number};
use super::canvas::{Anchor, At, Canvas};
use super::figure::{Curve, MARGIN, Panel, Plot, WIDTH, label_face, panel_head, quiet_face};
use super::font;
use super::labels;
use super::plane::Plane;
use super::theme::{Look, Theme};

/// From one label to the next.
const PITCH: f64 = 15.0;
/// Least height of the area between the axes: alone, and one of several.
const TALL: f64 = 330.0;
const LOW: f64 = 210.0;
/// Least width of the area between the axes.
const LEAST_WIDTH: f64 = 420.0;
/// Between the right end of the axes and the labels: leader and marker; with many labels leaders are longer, so that
/// they fan out and can be followed.
const GUTTER: f64 = 34.0;
const WIDE_GUTTER: f64 = 76.0;
/// From this many labels in a panel on.
const MANY: usize = 9;
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
    gutter: f64,
    width: f64,
}

/// Lays out `panels`, of which at least one has a line over n.
pub(super) fn plan(panels: Vec<Panel>, theme: &Theme) -> impl Plot + use<> {
    let alone = panels.len() == 1;
    let column = panels
        .iter()
        .flat_map(|p| {
            p.curves
                .iter()
                .map(move |c| label_width(c, p.quantity, theme))
        })
        .fold(0.0, f64::max);
    let strips: Vec<Strip> = panels
        .into_iter()
        .map(|panel| {
            let least = if alone { TALL } else { LOW };
            let height = least.max(panel.curves.len() as f64 * PITCH + 10.0);
            Strip {
                y: Axis::new(panel.values(), Base::Ten, height, 22.0),
                bests: bests(&panel),
                panel,
                height,
            }
        })
        .collect();
    let tick_width = |t: &Tick| quiet_face(theme).width(&t.label);
    let ticks = strips
        .iter()
        .flat_map(|s| s.y.ticks.iter().map(tick_width))
        .fold(0.0, f64::max);
    let left = MARGIN + ticks + 8.0;
    let many = strips.iter().any(|s| s.panel.curves.len() >= MANY);
    let gutter = if many { WIDE_GUTTER } else { GUTTER };
    let width = (left + LEAST_WIDTH + gutter + column + MARGIN).max(WIDTH);
    let right = width - MARGIN - column - gutter;
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
        gutter,
        width,
    }
}

/// The figure beside the name: the best speed and where, or the value of a level line.
fn figure(curve: &Curve, quantity: Quantity) -> Option<String> {
    let series = &curve.series;
    if series.constant {
        return series.points.first().map(|p| measured(p.y));
    }
    let best = peak(curve, quantity)?;
    Some(format!("{} at n = {}", measured(best.1), number(best.0)))
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

fn label_width(curve: &Curve, quantity: Quantity, theme: &Theme) -> f64 {
    let figure = figure(curve, quantity).map_or(0.0, |f| 7.0 + quiet_face(theme).width(&f));
    label_face(theme).width(&curve.name) + figure
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
        plane.draw(canvas, theme, true);
        for (row, best) in strip.bests.iter().enumerate() {
            let y = top + HEADING + (row as f64 + 0.5) * ROW;
            self.draw_best(canvas, theme, &plane, best, y);
        }
        let curves = &strip.panel.curves;
        for curve in curves {
            draw_band(canvas, theme, &plane, curve);
        }
        for curve in curves {
            draw_line(canvas, theme, &plane, curve);
        }
        for curve in curves {
            draw_markers(canvas, theme, &plane, curve, strip.panel.quantity);
        }
        draw_labels(canvas, theme, &plane, &strip.panel, self.gutter);
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
        canvas.ring(plane.at(n, y), 6.2, colour, 1.1);
    }
}

/// Names beside the ends of the lines, each with a leader and the line's sign.
fn draw_labels(canvas: &mut Canvas, theme: &Theme, plane: &Plane, panel: &Panel, gutter: f64) {
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
    let places = labels::spread(&wishes, PITCH, plane.top + 4.0, plane.bottom - 4.0);
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
        let face = label_face(theme);
        let text = &curve.name;
        let x = plane.right + gutter - 2.0;
        let base = y + 0.36 * face.size;
        canvas.text(text, (x, base), Anchor::Start, face);
        if let Some(figure) = figure(curve, panel.quantity) {
            let x = x + face.width(text) + 7.0;
            canvas.text(&figure, (x, base), Anchor::Start, quiet_face(theme));
        }
    }
}
