//! Strokes of braille dots on a canvas: solid, dotted or hatched, so that they differ without colour.
//!
//! ```text
//! columns x 2 dots, rows x 4 dots; (0, 0) is the lower left dot
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Color;
use ratatui::symbols::Marker;
use ratatui::widgets::Widget;
use ratatui::widgets::canvas::{Canvas, Points};

use crate::geometry::DVec2;

/// A sheet of dots over an area of the screen, and which part of the plane it shows.
pub struct Strokes {
    area: Rect,
    /// Dots across and upwards.
    size: DVec2,
    /// What lies at the lower left dot.
    from: DVec2,
    /// Dots a unit.
    scale: DVec2,
    /// Dots by colour, in the order of drawing: later ones lie on top.
    layers: Vec<(Color, Vec<(f64, f64)>)>,
}

impl Strokes {
    /// A sheet that shows the plane from `from` at `scale` dots a unit along each axis.
    pub fn new(area: Rect, from: DVec2, scale: DVec2) -> Self {
        Self {
            area,
            size: Self::dots(area),
            from,
            scale,
            layers: Vec::new(),
        }
    }

    /// Dots across and upwards of an area.
    pub fn dots(area: Rect) -> DVec2 {
        DVec2::new(f64::from(area.width) * 2.0, f64::from(area.height) * 4.0)
    }

    /// Where a point lies, in dots; perhaps outside.
    pub fn place(&self, point: DVec2) -> DVec2 {
        (point - self.from) * self.scale
    }

    /// The column and row of the screen where a point lies; `None` outside.
    pub fn cell(&self, point: DVec2) -> Option<(u16, u16)> {
        let dot = self.place(point).round();
        let inside = dot.cmpge(DVec2::ZERO).all() && dot.cmplt(self.size).all();
        inside.then(|| {
            let (column, row) = (dot.x as u16 / 2, (self.size.y - 1.0 - dot.y) as u16 / 4);
            (self.area.x + column, self.area.y + row)
        })
    }

    /// A line from `a` to `b`: every dot, or every `every`-th by a raster that all strokes share, so that lines on top of
    /// each other stay dotted.
    pub fn line(&mut self, a: DVec2, b: DVec2, every: u32, color: Color) {
        let Some((a, b)) = clipped(self.place(a), self.place(b), self.size - 1.0) else {
            return;
        };
        let steps = (b - a).abs().max_element().round().max(0.0) as u32;
        let layer = self.layer(color);
        for step in 0..=steps {
            let share = f64::from(step) / f64::from(steps.max(1));
            let dot = (a + (b - a) * share).round();
            if ((dot.x + dot.y) as u32).is_multiple_of(every.max(1)) {
                layer.push((dot.x, dot.y));
            }
        }
    }

    /// The outline of a polygon.
    pub fn outline(&mut self, corners: &[DVec2], every: u32, color: Color) {
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            self.line(a, b, every, color);
        }
    }

    /// A thin raster of dots within a convex polygon.
    pub fn hatch(&mut self, corners: &[DVec2], color: Color) {
        let placed: Vec<DVec2> = corners.iter().map(|&corner| self.place(corner)).collect();
        if placed.len() < 3 {
            return;
        }
        let fold = |f: fn(DVec2, DVec2) -> DVec2, start| placed.iter().copied().fold(start, f);
        let lo = fold(DVec2::min, DVec2::INFINITY).max(DVec2::ZERO).ceil();
        let hi = fold(DVec2::max, DVec2::NEG_INFINITY).min(self.size - 1.0);
        if !(lo.cmple(hi).all()) {
            return;
        }
        let mut dots = Vec::new();
        for y in lo.y as u32..=hi.y as u32 {
            for x in lo.x as u32..=hi.x as u32 {
                let dot = DVec2::new(f64::from(x), f64::from(y));
                if (x + 2 * y) % 4 == 0 && y % 2 == 0 && holds(&placed, dot) {
                    dots.push((dot.x, dot.y));
                }
            }
        }
        self.layer(color).extend(dots);
    }

    fn layer(&mut self, color: Color) -> &mut Vec<(f64, f64)> {
        if self.layers.last().is_none_or(|(last, _)| *last != color) {
            self.layers.push((color, Vec::new()));
        }
        let last = self.layers.len() - 1;
        &mut self.layers[last].1
    }

    /// Puts the dots on the screen.
    pub fn draw(&self, buffer: &mut Buffer) {
        Canvas::default()
            .marker(Marker::Braille)
            .x_bounds([0.0, self.size.x - 1.0])
            .y_bounds([0.0, self.size.y - 1.0])
            .paint(|context| {
                for (color, dots) in &self.layers {
                    context.draw(&Points::new(dots, *color));
                }
            })
            .render(self.area, buffer);
    }
}

/// Whether a convex polygon, its corners in order, holds a point.
fn holds(corners: &[DVec2], point: DVec2) -> bool {
    let side = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        (b - a).perp_dot(point - a)
    };
    (0..corners.len()).all(|i| side(i) >= 0.0) || (0..corners.len()).all(|i| side(i) <= 0.0)
}

/// The part of a segment within the rectangle from 0 to `size`, by Liang and Barsky; `None` where there is none or a
/// coordinate is no number.
fn clipped(a: DVec2, b: DVec2, size: DVec2) -> Option<(DVec2, DVec2)> {
    let step = b - a;
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let (start, delta, end) = (a[axis], step[axis], size[axis]);
        if delta == 0.0 {
            // NaN is in no range.
            if !(0.0..=end).contains(&start) {
                return None;
            }
            continue;
        }
        let (near, far) = (-start / delta, (end - start) / delta);
        from = from.max(near.min(far));
        to = to.min(near.max(far));
    }
    let (a, b) = (a + step * from, a + step * to);
    (from <= to && a.is_finite() && b.is_finite())
        .then(|| (a.clamp(DVec2::ZERO, size), b.clamp(DVec2::ZERO, size)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(strokes: &Strokes) -> Vec<String> {
        let mut buffer = Buffer::empty(strokes.area);
        strokes.draw(&mut buffer);
        let Rect { width, height, .. } = strokes.area;
        (0..height)
            .map(|y| (0..width).map(|x| buffer[(x, y)].symbol()).collect())
            .collect()
    }

    fn sheet() -> Strokes {
        Strokes::new(Rect::new(0, 0, 4, 2), DVec2::ZERO, DVec2::ONE)
    }

    #[test]
    fn a_line_is_cut_off_at_the_edges_of_the_sheet() {
        let mut strokes = sheet();
        strokes.line(
            DVec2::new(-100.0, 4.0),
            DVec2::new(100.0, 4.0),
            1,
            Color::Reset,
        );
        assert_eq!(
            drawn(&strokes),
            ["⣀⣀⣀⣀", "⠀⠀⠀⠀"].map(|row| row.replace('⠀', " "))
        );
        let mut beside = sheet();
        beside.line(DVec2::new(-9.0, 9.0), DVec2::new(9.0, 9.0), 1, Color::Reset);
        beside.line(DVec2::NAN, DVec2::ONE, 1, Color::Reset);
        beside.line(DVec2::ZERO, DVec2::INFINITY, 1, Color::Reset);
        assert!(beside.layers.iter().all(|(_, dots)| dots.is_empty()));
    }

    #[test]
    fn dotted_lines_on_top_of_each_other_stay_dotted() {
        let mut strokes = sheet();
        for shift in 0..3 {
            let from = DVec2::new(f64::from(shift), 0.0);
            strokes.line(from, DVec2::new(7.0, 0.0), 2, Color::Reset);
        }
        let dots = &strokes.layers[0].1;
        assert!(dots.iter().all(|(x, _)| (*x as u32).is_multiple_of(2)));
    }

    #[test]
    fn a_hatch_stays_within_its_polygon() {
        let mut strokes = sheet();
        let square = [(1.0, 1.0), (6.0, 1.0), (6.0, 6.0), (1.0, 6.0)].map(DVec2::from);
        strokes.hatch(&square, Color::Reset);
        let dots = &strokes.layers[0].1;
        assert!(!dots.is_empty());
        assert!(
            dots.iter()
                .all(|(x, y)| (1.0..=6.0).contains(x) && (1.0..=6.0).contains(y))
        );
        assert!(drawn(&strokes).concat().contains(|c| c > '⠀'));
    }

    #[test]
    fn a_point_is_in_the_cell_of_its_dot() {
        let strokes = sheet();
        assert_eq!(strokes.cell(DVec2::ZERO), Some((0, 1)));
        assert_eq!(strokes.cell(DVec2::new(7.0, 7.0)), Some((3, 0)));
        assert_eq!(strokes.cell(DVec2::new(8.0, 0.0)), None);
    }
}
