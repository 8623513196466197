//! Speed against accuracy in cells: a marker and a name for each method, the stairs of the front, the floor below which
//! no rate can be told from none.
//!
//! ```text
//!  wrong          │            ● sheet-signed
//!      1e-3 ┤     ┌────────────┘          stairs: the fastest within each rate
//!      1e-4 ┤     │      moller-trumbore ▲
//!           ┄┄┄┄┄┄│┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄  3/N: none seen is at most this
//!        none ┤───● woop                  nothing wrong was seen
//!             └───┬────────┬──────────
//!                 5        10    Mrays/s
//! ```

use ratatui::Frame;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::axis::{Axis, short};
use crate::tui::pareto::Point;
use crate::tui::theme::{Role, Theme};
use crate::tui::view::clipped;

/// A chart of one course at one place.
pub struct ParetoChart<'a> {
    /// The methods.
    pub points: &'a [Point],
    /// Which of them is marked.
    pub marked: usize,
    /// Colours.
    pub theme: Theme,
}

/// Where values lie in cells.
struct Plane {
    plot: Rect,
    x: Axis,
    y: Axis,
}

impl Plane {
    fn column(&self, speed: f64) -> u16 {
        self.plot.x + self.x.column(speed.log10(), self.plot.width)
    }

    /// The last row is for rates of none, the one above it stays free for the break between.
    fn row(&self, rate: f64) -> u16 {
        if rate > 0.0 {
            self.plot.y + self.y.row(rate.log10(), self.rows())
        } else {
            self.plot.bottom() - 1
        }
    }

    /// Rows of the logarithmic part.
    fn rows(&self) -> u16 {
        self.plot.height - 2
    }

    fn place(&self, point: &Point) -> (u16, u16) {
        let judged = &point.judged;
        (
            self.column(judged.speed[0]),
            self.row(judged.accuracy.wrong_rate()),
        )
    }
}

impl ParetoChart<'_> {
    /// Draws it where there is room.
    pub fn draw(&self, frame: &mut Frame, area: Rect) {
        if area.width >= 24 && area.height >= 7 && !self.points.is_empty() {
            self.render(area, frame.buffer_mut());
        }
    }

    fn render(&self, area: Rect, buffer: &mut Buffer) {
        let y = self.y_axis();
        let ticks = y.ticks(area.height - 4);
        let widest = ticks.iter().map(|(_, text)| text.chars().count()).max();
        let gutter = widest.unwrap_or(0).max(4) as u16 + 2;
        let plane = Plane {
            plot: Rect {
                x: area.x + gutter,
                y: area.y,
                width: area.width - gutter,
                height: area.height - 2,
            },
            x: self.x_axis(),
            y,
        };
        self.axes(area, &plane, &ticks, buffer);
        let mut places = Places::new(plane.plot);
        self.floor(&plane, &mut places, buffer);
        self.stairs(&plane, &mut places, buffer);
        self.whiskers(&plane, &mut places, buffer);
        self.markers(&plane, &mut places, buffer);
        self.labels(&plane, &mut places, buffer);
    }

    /// The rate that cannot be told from none: three of the fewest rays of a point.
    fn three_of(&self) -> f64 {
        let rays = self.points.iter().map(|p| p.judged.accuracy.rays).min();
        (3.0 / rays.unwrap_or(1).max(1) as f64).min(1.0)
    }

    fn y_axis(&self) -> Axis {
        let rates = self
            .points
            .iter()
            .flat_map(|p| [p.judged.accuracy.wrong_rate(), p.judged.bound])
            .chain([self.three_of()])
            .filter(|rate| *rate > 0.0)
            .map(f64::log10);
        let (lo, hi) = rates.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), rate| {
            (lo.min(rate), hi.max(rate))
        });
        // At least a decade, so that small differences look small.
        let pad = (1.0 - (hi - lo)).max(0.2) / 2.0;
        Axis {
            lo: lo - pad,
            hi: (hi + pad).min(0.0).max(lo - pad + 0.5),
        }
    }

    fn x_axis(&self) -> Axis {
        let speeds = self.points.iter().flat_map(|p| p.judged.speed);
        let speeds = speeds.map(f64::log10).filter(|log| log.is_finite());
        let (lo, hi) = speeds.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), speed| {
            (lo.min(speed), hi.max(speed))
        });
        // At least a factor of two, with room for a marker at both ends.
        let pad = (2f64.log10() - (hi - lo)).max(0.0) / 2.0 + (hi - lo) * 0.04;
        Axis {
            lo: lo - pad,
            hi: hi + pad,
        }
    }

    fn axes(&self, area: Rect, plane: &Plane, ticks: &[(f64, String)], buffer: &mut Buffer) {
        let quiet = self.theme.style(Role::Quiet);
        let plot = plane.plot;
        let left = plot.x - 1;
        for y in plot.top()..plot.bottom() {
            buffer.set_string(left, y, "│", quiet);
        }
        let width = (left - area.x) as usize - 1;
        for (log, text) in ticks {
            let y = plot.y + plane.y.row(*log, plane.rows());
            buffer.set_string(left, y, "┤", quiet);
            buffer.set_string(area.x, y, format!("{text:>width$}"), quiet);
        }
        buffer.set_string(left, plot.bottom() - 2, "≈", quiet);
        buffer.set_string(left, plot.bottom() - 1, "┤", quiet);
        buffer.set_string(
            area.x,
            plot.bottom() - 1,
            format!("{:>width$}", "none"),
            quiet,
        );
        let bottom = plot.bottom();
        buffer.set_string(left, bottom, "└", quiet);
        for x in plot.left()..plot.right() {
            buffer.set_string(x, bottom, "─", quiet);
        }
        let unit = "Mrays/s";
        let end = plot.right() - unit.len() as u16;
        buffer.set_string(end, bottom + 1, unit, quiet);
        let mut free = plot.x;
        for (log, text) in x_ticks(plane.x, plot.width) {
            let x = plot.x + plane.x.column(log, plot.width);
            let width = text.chars().count() as u16;
            let from = x.saturating_sub(width / 2).max(plot.x);
            if from >= free && from + width < end {
                buffer.set_string(x, bottom, "┬", quiet);
                buffer.set_string(from, bottom + 1, &text, quiet);
                free = from + width + 1;
            }
        }
    }

    fn floor(&self, plane: &Plane, places: &mut Places, buffer: &mut Buffer) {
        let rate = self.three_of();
        let y = plane.row(rate);
        let quiet = self.theme.style(Role::Quiet);
        for x in plane.plot.left()..plane.plot.right() {
            buffer.set_string(x, y, "┄", quiet);
            places.avoid(x, y);
        }
        let text = format!(" 3/N = {rate:.1e} ");
        let width = text.chars().count() as u16;
        if width + 2 < plane.plot.width {
            let x = plane.plot.right() - width;
            buffer.set_string(x, y, &text, quiet);
            places.take(x, y, width);
        }
    }

    /// The stairs of the front: what the fastest method within each rate of wrong decisions is.
    fn stairs(&self, plane: &Plane, places: &mut Places, buffer: &mut Buffer) {
        let mut front: Vec<(u16, u16)> = self
            .points
            .iter()
            .filter(|p| p.judged.front)
            .map(|p| plane.place(p))
            .collect();
        front.sort_by_key(|&(x, y)| (x, std::cmp::Reverse(y)));
        let style = self.theme.style(Role::Text);
        let mut put = |x: u16, y: u16, sign: &str| {
            buffer.set_string(x, y, sign, style);
            places.avoid(x, y);
        };
        let Some(&first) = front.first() else {
            return;
        };
        (plane.plot.x..first.0).for_each(|x| put(x, first.1, "─"));
        for (i, &(x, y)) in front.iter().enumerate() {
            let (next_x, next_y) = front.get(i + 1).copied().unwrap_or((x, plane.plot.y));
            if i + 1 == front.len() {
                (plane.plot.y..y).for_each(|row| put(x, row, "│"));
            } else if next_y == y {
                (x + 1..next_x).for_each(|column| put(column, y, "─"));
            } else {
                (next_y + 1..y).for_each(|row| put(x, row, "│"));
                if x < next_x {
                    put(x, next_y, "┌");
                    (x + 1..next_x).for_each(|column| put(column, next_y, "─"));
                }
            }
        }
    }

    /// Up to the 95 % bound, and from end to end of the interval of the speed.
    fn whiskers(&self, plane: &Plane, places: &mut Places, buffer: &mut Buffer) {
        for point in self.points {
            let style = self.look(point);
            let (x, y) = plane.place(point);
            for row in plane.row(point.judged.bound)..y {
                buffer.set_string(x, row, "┊", style);
                places.avoid(x, row);
            }
            let [_, lo, hi] = point.judged.speed;
            for column in plane.column(lo)..=plane.column(hi) {
                if column != x {
                    buffer.set_string(column, y, "╌", style);
                    places.avoid(column, y);
                }
            }
        }
    }

    /// Colour for the front; what is dominated is quiet.
    fn look(&self, point: &Point) -> Style {
        if point.judged.front {
            self.theme.style(Role::Line(point.look))
        } else {
            self.theme.style(Role::Quiet)
        }
    }

    /// The order of drawing: the front after the rest, the marked one last.
    fn order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.points.len()).collect();
        order.sort_by_key(|&i| (i == self.marked, self.points[i].judged.front));
        order
    }

    fn markers(&self, plane: &Plane, places: &mut Places, buffer: &mut Buffer) {
        for i in self.order() {
            let point = &self.points[i];
            let (x, y) = plane.place(point);
            let mut style = self.look(point);
            if i == self.marked {
                style = style.patch(self.theme.style(Role::Marked));
            }
            buffer.set_string(x, y, self.theme.marker(point.look), style);
            places.take(x, y, 1);
        }
    }

    /// Names at the nearest free places, the marked one and the front first; one that has no place is in the list only.
    fn labels(&self, plane: &Plane, places: &mut Places, buffer: &mut Buffer) {
        for i in self.order().into_iter().rev() {
            let point = &self.points[i];
            let at = plane.place(point);
            let room = plane.plot.width.saturating_sub(2) as usize;
            let near = clipped(&point.judged.label, room);
            // A name that is not beside its marker repeats it.
            let far = clipped(&format!("{} {near}", self.theme.marker(point.look)), room);
            let beside = places.beside(at, near.chars().count() as u16);
            let found = match beside {
                Some(place) => Some((place, near)),
                None => places
                    .around(at, far.chars().count() as u16)
                    .map(|place| (place, far)),
            };
            let Some(((x, y), text)) = found else {
                continue;
            };
            let style = match (i == self.marked, point.judged.front) {
                (true, _) => self.theme.style(Role::Marked),
                (false, true) => self.theme.style(Role::Title),
                (false, false) => self.theme.style(Role::Quiet),
            };
            buffer.set_string(x, y, &text, style);
            places.take(x, y, text.chars().count() as u16);
        }
    }
}

/// Ticks of the speed: 1, 2 and 5 times powers of ten, or all tens of a narrow range.
fn x_ticks(x: Axis, columns: u16) -> Vec<(f64, String)> {
    let ticks = x.ticks(columns / 4);
    if ticks.len() >= 2 {
        return ticks;
    }
    // Less than a factor of two or so: round steps of a twentieth of the next power of ten.
    let step = 10f64.powf(x.hi.ceil()) / 20.0;
    let (from, to) = ((10f64.powf(x.lo) / step).ceil(), 10f64.powf(x.hi) / step);
    let values = (0..40).map(|i| (from + f64::from(i)) * step);
    values
        .take_while(|value| *value <= to * step)
        .map(|value| (value.log10(), short(value)))
        .collect()
}

/// Which cells are taken, and which are better left free.
struct Places {
    area: Rect,
    cells: Vec<u8>,
}

/// Worth avoiding; taken.
const LINE: u8 = 1;
const TAKEN: u8 = 2;

/// How far from its marker a name may stand, in rows; twice that in columns.
const REACH: i32 = 8;

impl Places {
    fn new(area: Rect) -> Self {
        Self {
            area,
            cells: vec![0; area.area() as usize],
        }
    }

    fn index(&self, x: i32, y: i32) -> Option<usize> {
        let (dx, dy) = (x - i32::from(self.area.x), y - i32::from(self.area.y));
        let inside = (0..i32::from(self.area.width)).contains(&dx)
            && (0..i32::from(self.area.height)).contains(&dy);
        inside.then(|| (dy * i32::from(self.area.width) + dx) as usize)
    }

    fn mark(&mut self, x: u16, y: u16, how: u8) {
        if let Some(i) = self.index(i32::from(x), i32::from(y)) {
            self.cells[i] = self.cells[i].max(how);
        }
    }

    fn avoid(&mut self, x: u16, y: u16) {
        self.mark(x, y, LINE);
    }

    fn take(&mut self, x: u16, y: u16, width: u16) {
        (x..x + width).for_each(|x| self.mark(x, y, TAKEN));
    }

    /// How many lines a text would hide; `None` where it would touch what is taken, or leave the plot.
    fn hidden(&self, x: i32, y: i32, width: u16) -> Option<i32> {
        let mut lines = 0;
        for column in x..x + i32::from(width) {
            match self.cells[self.index(column, y)?] {
                TAKEN => return None,
                cell => lines += i32::from(cell),
            }
        }
        // A column of space to both sides, where there is one.
        let near = [x - 1, x + i32::from(width)];
        let touches = near.iter().any(|&column| {
            self.index(column, y)
                .is_some_and(|i| self.cells[i] == TAKEN)
        });
        (!touches).then_some(lines)
    }

    /// The place right or left of a marker, with a space between.
    fn beside(&self, (x, y): (u16, u16), width: u16) -> Option<(u16, u16)> {
        let (x, y) = (i32::from(x), i32::from(y));
        let sides = [x + 2, x - 1 - i32::from(width)];
        let free = sides
            .into_iter()
            .filter_map(|from| Some((self.hidden(from, y, width)?, from)));
        free.min_by_key(|&(lines, _)| lines)
            .map(|(_, from)| (from as u16, y as u16))
    }

    /// The free place around a marker that is nearest, where lines count as distance.
    fn around(&self, (x, y): (u16, u16), width: u16) -> Option<(u16, u16)> {
        let (x, y, wide) = (i32::from(x), i32::from(y), i32::from(width));
        let mut best: Option<(i32, i32, i32)> = None;
        for dy in -REACH..=REACH {
            for from in x - wide - 2 * REACH..=x + 2 * REACH {
                let Some(lines) = self.hidden(from, y + dy, width) else {
                    continue;
                };
                // From the marker to the nearest column of the text; cells are twice as tall as wide.
                let aside = (from - x).max(x - (from + wide - 1)).max(0);
                let cost = 2 * dy.abs() + aside + 2 * lines;
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, from, y + dy));
                }
            }
        }
        best.map(|(_, from, row)| (from as u16, row as u16))
    }
}
