//! The area between two axes: where a pair of values lies in pixels, and its grid and ticks.

use plotters::coord::CoordTranslate;
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::combinators::{IntoLogRange, LogCoord};

use super::axis::{Axis, Tick};
use super::canvas::{Anchor, At, Canvas};
use super::figure::quiet_face;
use super::theme::Theme;

/// plotters maps to whole numbers; this many of them are a pixel.
const FINE: f64 = 16.0;

/// What is shown of the y axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rows {
    /// Grid and numbers.
    Labelled,
    /// The grid: the numbers stand at a neighbour.
    Ruled,
    /// Nothing: y has no meaning.
    Hidden,
}

/// Width of the widest number at a y axis.
pub(super) fn widest_tick(y: &Axis, theme: &Theme) -> f64 {
    let width = |t: &Tick| quiet_face(theme).width(&t.label);
    y.ticks.iter().map(width).fold(0.0, f64::max)
}

/// Two logarithmic axes over a rectangle of the sheet.
pub(super) struct Plane {
    spec: Cartesian2d<LogCoord<f64>, LogCoord<f64>>,
    pub x: Axis,
    pub y: Axis,
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

impl Plane {
    /// The axes over the rectangle from `(left, top)` to `(right, bottom)`.
    pub fn new(x: Axis, y: Axis, (left, top): At, (right, bottom): At) -> Self {
        let fine = |v: f64| (v * FINE).round() as i32;
        Self {
            spec: Cartesian2d::new(
                (x.lo..x.hi).log_scale().base(2.0),
                (y.lo..y.hi).log_scale(),
                (fine(left)..fine(right), fine(bottom)..fine(top)),
            ),
            x,
            y,
            left,
            right,
            top,
            bottom,
        }
    }

    /// Where a pair of values lies; values off an axis lie at its end.
    pub fn at(&self, x: f64, y: f64) -> At {
        let (x, y) = self.spec.translate(&(self.x.place(x), self.y.place(y)));
        (f64::from(x) / FINE, f64::from(y) / FINE)
    }

    /// Grid, ticks and their labels.
    pub fn draw(&self, canvas: &mut Canvas, theme: &Theme, rows: Rows) {
        let face = quiet_face(theme);
        for tick in &self.x.ticks {
            let x = self.at(tick.value, self.y.hi).0;
            canvas.line(&[(x, self.top), (x, self.bottom)], theme.grid, 0.75, &[]);
            canvas.line(
                &[(x, self.bottom), (x, self.bottom + 4.0)],
                theme.axis,
                0.9,
                &[],
            );
            let at = (x, self.bottom + 16.0);
            canvas.text(&tick.label, at, Anchor::Middle, face);
        }
        for &value in &self.x.minor {
            let x = self.at(value, self.y.hi).0;
            canvas.line(
                &[(x, self.bottom), (x, self.bottom + 2.5)],
                theme.axis,
                0.75,
                &[],
            );
        }
        if rows != Rows::Hidden {
            self.draw_rows(canvas, theme, rows == Rows::Labelled);
        }
        let base = [(self.left, self.bottom), (self.right, self.bottom)];
        canvas.line(&base, theme.axis, 0.9, &[]);
        if self.x.zero.is_some() {
            let x = f64::midpoint(
                self.at(0.0, self.y.hi).0,
                self.at(self.x.bottom, self.y.hi).0,
            );
            for shift in [-2.0, 2.0] {
                let slash = [
                    (x + shift - 2.0, self.bottom + 4.0),
                    (x + shift + 2.0, self.bottom - 4.0),
                ];
                canvas.line(&slash, theme.axis, 0.9, &[]);
            }
        }
    }

    fn draw_rows(&self, canvas: &mut Canvas, theme: &Theme, labelled: bool) {
        let face = quiet_face(theme);
        for tick in &self.y.ticks {
            let y = self.at(self.x.lo, tick.value).1;
            canvas.line(&[(self.left, y), (self.right, y)], theme.grid, 0.75, &[]);
            // Digits are about 0.72 em tall: a third of an em below the line centres them on it.
            let at = (self.left - 7.0, y + 0.36 * face.size);
            if labelled {
                canvas.text(&tick.label, at, Anchor::End, face);
            }
        }
        for &value in &self.y.minor {
            let y = self.at(self.x.lo, value).1;
            canvas.line(
                &[(self.left, y), (self.left + 3.0, y)],
                theme.axis,
                0.6,
                &[],
            );
        }
        if self.y.zero.is_some() {
            // The break between the zero row and the logarithmic part.
            let y = f64::midpoint(
                self.at(self.x.lo, 0.0).1,
                self.at(self.x.lo, self.y.bottom).1,
            );
            for shift in [-2.0, 2.0] {
                let slash = [
                    (self.left - 4.0, y + shift + 2.0),
                    (self.left + 4.0, y + shift - 2.0),
                ];
                canvas.line(&slash, theme.axis, 0.9, &[]);
            }
        }
    }
}
