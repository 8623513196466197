//! The slice through a ray: what a plane through it cuts of the scene, of the visited places and of the triangles that
//! were offered there.

use ratatui::Frame;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;

use super::strokes::Strokes;
use crate::accel::Outcome;
use crate::geometry::DVec2;
use crate::lab::Step;
use crate::tui::figures::fine;
use crate::tui::inspect::{Examined, Inspect};
use crate::tui::slice::{self, Plane};
use crate::tui::theme::{Role, Theme};

/// Dots of a stroke: every one; every third; every fifth.
const SOLID: u32 = 1;
const DOTTED: u32 = 3;
const FAINT: u32 = 5;

/// Draws the slice of one side; the last row tells the range of `t` and what is what.
pub fn draw(theme: Theme, inspect: &Inspect, side: usize, frame: &mut Frame, area: Rect) {
    let Some(examined) = inspect.examined(side) else {
        return;
    };
    if area.width < 8 || area.height < 3 {
        return;
    }
    let plane = inspect.plane_of(&examined.ray);
    let Some(coordinates) = slice::Frame::new(&examined.ray, plane) else {
        return;
    };
    let sheet = Rect {
        height: area.height - 1,
        ..area
    };
    let view = View::new(examined, coordinates.unit, inspect, side);
    let mut drawing = Drawing {
        theme,
        examined,
        frame: coordinates,
        plane,
        step: view.marked,
        strokes: view.sheet(sheet),
    };
    drawing.draw(frame.buffer_mut());
    scale(
        theme,
        &view,
        plane,
        frame,
        Rect {
            y: area.bottom() - 1,
            height: 1,
            ..area
        },
    );
}

/// Which part of the way is shown, in units of length along the ray.
struct View {
    from: f64,
    to: f64,
    unit: f64,
    marked: usize,
}

impl View {
    fn new(examined: &Examined, unit: f64, inspect: &Inspect, side: usize) -> Self {
        let steps = &examined.inspection.steps;
        let marked = inspect.marked[side].min(steps.len().saturating_sub(1));
        let [lo, hi] = whole(examined, unit);
        let width = (hi - lo) / inspect.zoom;
        let middle = match steps.get(marked) {
            Some(step) if inspect.zoom > 1.0 => middle(step, unit, [lo, hi]),
            _ => f64::midpoint(lo, hi),
        };
        Self {
            from: middle - width / 2.0,
            to: middle + width / 2.0,
            unit,
            marked,
        }
    }

    /// A sheet on which a unit is as long across the ray as along it; the ray lies in its middle.
    fn sheet(&self, area: Rect) -> Strokes {
        let dots = Strokes::dots(area);
        let scale = (dots.x - 1.0) / (self.to - self.from);
        let below = (dots.y / 2.0).floor() / scale;
        Strokes::new(area, DVec2::new(self.from, -below), DVec2::splat(scale))
    }
}

/// From the first entry to the last exit, with a margin; the scene's reach where these are not finite.
fn whole(examined: &Examined, unit: f64) -> [f64; 2] {
    let steps = &examined.inspection.steps;
    let ends = steps.iter().flat_map(|s| [s.entry, s.exit]);
    let reach = examined.reach;
    let (mut lo, mut hi) = ends
        .map(|t| (t * unit).clamp(reach[0], reach[1]))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| {
            (lo.min(x), hi.max(x))
        });
    // NaN and too little to be seen give way to the whole scene.
    let enough = hi - lo > (reach[1] - reach[0]) * 1e-6;
    if !enough {
        [lo, hi] = reach;
    }
    let margin = (hi - lo) * 0.06;
    [lo - margin, hi + margin]
}

/// The middle of what a step covers of the way shown.
fn middle(step: &Step, unit: f64, [lo, hi]: [f64; 2]) -> f64 {
    let nearest = step.tests.iter().rfind(|t| t.outcome == Outcome::Nearest);
    match nearest.and_then(|test| test.t) {
        // What a step is about is its hit.
        Some(t) => f64::from(t) * unit,
        None => f64::midpoint(
            (step.entry * unit).clamp(lo, hi),
            (step.exit * unit).clamp(lo, hi),
        ),
    }
}

struct Drawing<'a> {
    theme: Theme,
    examined: &'a Examined,
    frame: slice::Frame,
    plane: Plane,
    step: usize,
    strokes: Strokes,
}

impl Drawing<'_> {
    fn draw(&mut self, buffer: &mut Buffer) {
        // What matters more is drawn later, on top.
        for [a, b] in &self.examined.outlines[self.plane.index()] {
            self.strokes.line(*a, *b, FAINT, self.theme.faint());
        }
        self.places();
        self.triangles();
        self.ray();
        self.strokes.draw(buffer);
        self.signs(buffer);
    }

    fn steps(&self) -> &[Step] {
        &self.examined.inspection.steps
    }

    fn places(&mut self) {
        let cuts: Vec<(bool, Vec<DVec2>)> = self
            .steps()
            .iter()
            .enumerate()
            .filter_map(|(i, step)| Some((i == self.step, self.frame.cut_box(step.bounds?))))
            .collect();
        let (quiet, marked) = (self.theme.line(0), self.theme.line(6));
        for (_, cut) in cuts.iter().filter(|(is_marked, _)| !is_marked) {
            self.strokes.outline(cut, DOTTED, quiet);
        }
        for (_, cut) in cuts.iter().filter(|(is_marked, _)| *is_marked) {
            self.strokes.hatch(cut, marked);
            self.strokes.outline(cut, SOLID, marked);
        }
    }

    /// What was offered: of the marked step on top.
    fn triangles(&mut self) {
        let here: Vec<u32> = (self.steps().get(self.step).iter())
            .flat_map(|step| step.tests.iter().map(|test| test.prim))
            .collect();
        let (offered, now) = (self.theme.line(1), self.theme.line(4));
        for on_top in [false, true] {
            for (prim, corners) in &self.examined.corners {
                if here.contains(prim) == on_top {
                    let color = if on_top { now } else { offered };
                    for [a, b] in self.frame.cut(corners) {
                        self.strokes.line(a, b, SOLID, color);
                    }
                }
            }
        }
    }

    fn ray(&mut self) {
        let ray = &self.examined.ray;
        let [from, to] = self.shown();
        let ends = [ray.t_min, ray.t_max].map(|t| (f64::from(t) * self.frame.unit).clamp(from, to));
        let [a, b] = ends.map(|x| DVec2::new(x, 0.0));
        self.strokes.line(a, b, SOLID, self.theme.line(2));
    }

    /// What the sheet shows along the ray, a little beyond its edges.
    fn shown(&self) -> [f64; 2] {
        let [lo, hi] = whole(self.examined, self.frame.unit);
        let reach = (hi - lo)
            + self.examined.reach[1]
                .abs()
                .max(self.examined.reach[0].abs());
        [lo - reach, hi + reach]
    }

    /// The ends of the ray's interval and the nearest hit so far.
    fn signs(&self, buffer: &mut Buffer) {
        let ray = &self.examined.ray;
        let text = self.theme.style(Role::Title);
        let mut put = |t: f64, sign: &str, style| {
            if let Some(at) = self.strokes.cell(DVec2::new(t * self.frame.unit, 0.0)) {
                buffer.set_string(at.0, at.1, sign, style);
            }
        };
        put(f64::from(ray.t_min), "[", text);
        put(f64::from(ray.t_max), "]", text);
        if let Some(t) = nearest_so_far(self.steps(), self.step) {
            put(f64::from(t.1), "●", self.theme.style(Role::Good));
        }
    }
}

/// The nearest hit after the step at `at`: triangle and t.
#[must_use]
pub fn nearest_so_far(steps: &[Step], at: usize) -> Option<(u32, f32)> {
    let until = steps.get(..=at)?;
    let tests = until.iter().flat_map(|step| &step.tests);
    let mut nearest = tests.filter(|test| test.outcome == Outcome::Nearest);
    let nearest = nearest.next_back()?;
    Some((nearest.prim, nearest.t?))
}

/// The range of t below the sheet, and between its ends what the strokes mean.
fn scale(theme: Theme, view: &View, plane: Plane, frame: &mut Frame, area: Rect) {
    let quiet = theme.style(Role::Quiet);
    let (from, to) = (view.from / view.unit, view.to / view.unit);
    let left = format!("t {}", fine(from, to - from));
    let right = fine(to, to - from);
    let used = left.chars().count() + right.chars().count() + 4;
    let room = (area.width as usize).saturating_sub(used);
    let full = format!("ray × {} · ⠒ tested ⠢ visited ▒ marked", plane.name());
    let short = format!("ray × {}", plane.name());
    frame.render_widget(Line::styled(left, quiet), area);
    frame.render_widget(Line::styled(right, quiet).right_aligned(), area);
    for text in [full, short] {
        if text.chars().count() <= room {
            frame.render_widget(Line::styled(text, quiet).centered(), area);
            break;
        }
    }
}
