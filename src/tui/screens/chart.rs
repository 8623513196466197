//! Curves over n on logarithmic axes, in braille, each line with its own marker and its name beside it.
//!
//! ```text
//!   Mrays/s
//!   20 ┤        ⣀⠤■⠤⣀          ■ grid
//!   10 ┤    ⣀⠔⠊   ⠈⠑■
//!    5 ┤⠠⠤⠤●⠤⠤⠤⠤⠤⠤⠤⠤⠤⠤⠤⠤⠤⠤⠤⠄ ● bvh      <- no n: a dotted level line
//!      └┬────┬────┬────┬────
//!       1    2    4    8     n
//! ```

use ratatui::Frame;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::symbols::Marker;
use ratatui::widgets::Widget;
use ratatui::widgets::canvas::{Canvas, Line, Points};

use super::axis::Axis;
use crate::report::series::{Quantity, Series};
use crate::tui::figures::figure;
use crate::tui::theme::{Role, Theme};
use crate::tui::view::clipped;

/// A chart of one quantity.
pub struct Chart<'a> {
    /// What is charted.
    pub quantity: Quantity,
    /// The lines; the colour of each is that of its place.
    pub lines: &'a [Series],
    /// Colours.
    pub theme: Theme,
}

impl Chart<'_> {
    /// Draws it, or a sentence where there is nothing to draw yet.
    pub fn draw(&self, frame: &mut Frame, area: Rect) {
        if area.width < 20 || area.height < 4 {
            return;
        }
        self.render(area, frame.buffer_mut());
    }

    fn render(&self, area: Rect, buffer: &mut Buffer) {
        let values = || {
            self.lines
                .iter()
                .flat_map(|s| &s.points)
                .flat_map(|p| [p.y, p.lo, p.hi])
                .filter(|y| *y > 0.0)
        };
        let Some(y_axis) = y_axis(values()) else {
            let text = "The first curve appears with the first values.";
            buffer.set_stringn(
                area.x + 1,
                area.y,
                text,
                area.width as usize - 1,
                Style::new(),
            );
            return;
        };
        let x_axis = x_axis(
            self.lines
                .iter()
                .filter(|s| !s.constant)
                .flat_map(|s| s.points.iter().map(|p| p.n)),
        );
        let y_ticks = y_axis.ticks(area.height - 3);
        let gutter = y_ticks
            .iter()
            .map(|(_, t)| t.chars().count())
            .max()
            .unwrap_or(1) as u16
            + 2;
        let names = self.names_width(area.width);
        let plot = Rect::new(
            area.x + gutter,
            area.y + 1,
            area.width.saturating_sub(gutter + names),
            area.height - 3,
        );
        if plot.width < 6 || plot.height < 1 {
            return;
        }
        let title = match self.quantity.unit() {
            "" => self.quantity.label(),
            unit => unit,
        };
        let quiet = self.theme.style(Role::Quiet);
        buffer.set_stringn(area.x + 1, area.y, title, area.width as usize - 1, quiet);
        self.axes(area, plot, x_axis, &y_ticks, y_axis, buffer);
        self.curves(plot, x_axis, y_axis, buffer);
        self.names(plot, area, y_axis, buffer);
    }

    /// Columns for markers and names at the right.
    fn names_width(&self, width: u16) -> u16 {
        let longest = self.lines.iter().map(|s| s.label.chars().count()).max();
        (longest.unwrap_or(0) as u16 + 3).min(width / 3)
    }

    fn axes(
        &self,
        area: Rect,
        plot: Rect,
        x_axis: Axis,
        y_ticks: &[(f64, String)],
        y_axis: Axis,
        buffer: &mut Buffer,
    ) {
        let quiet = self.theme.style(Role::Quiet);
        let left = plot.x - 1;
        for y in plot.top()..plot.bottom() {
            buffer.set_string(left, y, "│", quiet);
        }
        for (log, text) in y_ticks {
            let y = plot.y + y_axis.row(*log, plot.height);
            let width = (left - area.x) as usize;
            buffer.set_string(left, y, "┤", quiet);
            buffer.set_string(area.x, y, format!("{text:>width$}"), quiet);
        }
        let bottom = plot.bottom();
        buffer.set_string(left, bottom, "└", quiet);
        for x in plot.left()..plot.right() {
            buffer.set_string(x, bottom, "─", quiet);
        }
        let mut free_from = area.x;
        for octave in x_axis.lo.ceil() as i32..=x_axis.hi.floor() as i32 {
            let x = plot.x + x_axis.column(f64::from(octave), plot.width);
            buffer.set_string(x, bottom, "┬", quiet);
            let text = figure(2f64.powi(octave));
            let text = text.trim_end_matches('0').trim_end_matches('.').to_owned();
            let text = if octave >= 0 {
                format!("{}", 1u64 << octave.min(40))
            } else {
                text
            };
            let width = text.chars().count() as u16;
            let from = x.saturating_sub(width / 2).max(plot.x);
            if from >= free_from && from + width <= plot.right() + 1 {
                buffer.set_string(from, bottom + 1, &text, quiet);
                free_from = from + width + 1;
            }
        }
        if free_from + 2 <= area.right() {
            buffer.set_string(free_from + 1, bottom + 1, "n", quiet);
        }
    }

    fn curves(&self, plot: Rect, x_axis: Axis, y_axis: Axis, buffer: &mut Buffer) {
        Canvas::default()
            .marker(Marker::Braille)
            .x_bounds(x_axis.ends())
            .y_bounds(y_axis.ends())
            .paint(|context| {
                for (i, line) in self.lines.iter().enumerate() {
                    let color = self.theme.line(i);
                    if line.constant {
                        let y = line.points.first().map_or(f64::NAN, |p| p.y.log10());
                        // Every third dot: a level line that no one takes for a measured curve.
                        let step = (x_axis.hi - x_axis.lo) / (f64::from(plot.width) * 2.0 / 3.0);
                        let dots: Vec<(f64, f64)> = (0..u32::from(plot.width))
                            .map(|k| (x_axis.lo + f64::from(k) * step, y))
                            .filter(|(x, _)| *x <= x_axis.hi)
                            .collect();
                        context.draw(&Points::new(&dots, color));
                        continue;
                    }
                    let points = logs(line);
                    for pair in points.windows(2) {
                        let [(x1, y1, ..), (x2, y2, ..)] = pair else {
                            continue;
                        };
                        context.draw(&Line::new(*x1, *y1, *x2, *y2, color));
                    }
                    for &(x, _, lo, hi) in &points {
                        context.draw(&Line::new(x, lo, x, hi, color));
                    }
                }
            })
            .render(plot, buffer);
        for (i, line) in self.lines.iter().enumerate() {
            let style = self.theme.style(Role::Line(i));
            for (x, y, ..) in logs(line) {
                // A level line has its marker at its start: it belongs to no n.
                let column = if line.constant {
                    0
                } else {
                    x_axis.column(x, plot.width)
                };
                let row = y_axis.row(y, plot.height);
                let at = (plot.x + column, plot.y + row);
                buffer.set_string(at.0, at.1, self.theme.marker(i), style);
            }
        }
    }

    /// Markers and names at the height of the last point of each line, moved apart where they would collide.
    fn names(&self, plot: Rect, area: Rect, y_axis: Axis, buffer: &mut Buffer) {
        let mut wanted: Vec<(usize, f64)> = self
            .lines
            .iter()
            .enumerate()
            .filter_map(|(i, line)| Some((i, line.points.last()?.y)))
            .filter(|&(_, y)| y > 0.0)
            .collect();
        wanted.sort_by(|a, b| b.1.total_cmp(&a.1));
        let rows: Vec<u16> = wanted
            .iter()
            .map(|&(_, y)| y_axis.row(y.log10(), plot.height))
            .collect();
        let rows = apart(&rows, area.height - 2);
        for (&(i, _), row) in wanted.iter().zip(rows) {
            let room = (area.right() - plot.right()) as usize;
            let text = format!(" {} {}", self.theme.marker(i), self.lines[i].label);
            let style = self.theme.style(Role::Line(i));
            buffer.set_string(plot.right(), plot.y + row, clipped(&text, room), style);
        }
    }
}

/// Logarithms of the points of a line: n to base 2; value and interval to base 10. Zeros have none.
fn logs(line: &Series) -> Vec<(f64, f64, f64, f64)> {
    line.points
        .iter()
        .filter(|p| p.y > 0.0)
        .map(|p| {
            let lo = if p.lo > 0.0 { p.lo } else { p.y };
            (p.n.max(1.0).log2(), p.y.log10(), lo.log10(), p.hi.log10())
        })
        .collect()
}

/// The axis of the resolutions: to base 2, at least an octave.
fn x_axis(n: impl Iterator<Item = f64>) -> Axis {
    let (lo, hi) = n.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), n| {
        let log = n.max(1.0).log2();
        (lo.min(log), hi.max(log))
    });
    match (lo.is_finite(), hi - lo < 1.0) {
        (false, _) => Axis { lo: 0.0, hi: 1.0 },
        (true, true) => Axis {
            lo: (lo - 0.5).max(0.0),
            hi: hi + 0.5,
        },
        (true, false) => Axis { lo, hi },
    }
}

/// The axis of the values: to base 10, a little wider than they are; `None` where there are none.
fn y_axis(values: impl Iterator<Item = f64>) -> Option<Axis> {
    let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), y| {
        (lo.min(y.log10()), hi.max(y.log10()))
    });
    if !lo.is_finite() || !hi.is_finite() {
        return None;
    }
    // At least a factor of two, so that noise does not look like a mountain range.
    let missing = (2f64.log10() - (hi - lo)).max(0.0);
    let pad = (hi - lo) * 0.04 + missing / 2.0;
    Some(Axis {
        lo: lo - pad,
        hi: hi + pad,
    })
}

/// Rows as near as possible to the wanted ones (in rising order), no two equal, all below `height` where they fit.
fn apart(wanted: &[u16], height: u16) -> Vec<u16> {
    let mut rows: Vec<u16> = Vec::new();
    for &row in wanted {
        rows.push(rows.last().map_or(row, |&last| row.max(last + 1)));
    }
    let mut limit = height;
    for row in rows.iter_mut().rev() {
        *row = (*row).min(limit.saturating_sub(1));
        limit = *row;
    }
    // Where there are more names than rows, those at the top share the first row; the colours still tell.
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_would_collide_are_moved_apart_and_stay_inside() {
        assert_eq!(apart(&[2, 2, 2], 10), [2, 3, 4]);
        assert_eq!(apart(&[8, 9, 9], 10), [7, 8, 9]);
        assert_eq!(apart(&[0, 5], 10), [0, 5]);
    }

    #[test]
    fn one_value_still_has_an_axis_around_it() {
        let axis = y_axis([3.0].into_iter()).unwrap();
        assert!(axis.lo < 3f64.log10() && 3f64.log10() < axis.hi);
        assert_eq!(y_axis(std::iter::empty()), None);
        let axis = x_axis([64.0].into_iter());
        assert!(axis.lo < 6.0 && 6.0 < axis.hi);
    }
}
