//! The stability screen: the map of methods and cases as letters with colours, and everything known of the marked cell.
//!
//! ```text
//!                     edges shapes      numbers    rays   cells    trees
//!                       ▾
//!   ▸ moller-trumbore  ·k···kk··k·······k····k·······               one letter a case
//!     woop             ·································
//! ```

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use super::sweep;
use crate::lab::stability::{Cell, Verdict, case};
use crate::tui::figures::clock;
use crate::tui::layout;
use crate::tui::stability::Stability;
use crate::tui::state::{Panel, Phase, State};
use crate::tui::theme::{Role, Theme};
use crate::tui::view::{clipped, panel, wrapped};

/// Draws the screen.
pub fn draw(state: &State, frame: &mut Frame, area: Rect) {
    let parts = layout::stability(state, area);
    let stability = &state.stability;
    if !parts.plan.is_empty() {
        let focused = stability.panel == Panel::Plan;
        let title = match (focused, stability.progress.is_running()) {
            (true, false) => "to be tried: Enter runs it, Space changes a line",
            _ => "to be tried",
        };
        sweep::plan(
            state.theme,
            &stability.plan,
            title,
            focused,
            frame,
            parts.plan,
        );
    }
    progress(state, frame, parts.progress);
    map(state, frame, parts.map);
    if !parts.cell.is_empty() {
        cell(state, frame, parts.cell);
    }
}

fn progress(state: &State, frame: &mut Frame, area: Rect) {
    let stability = &state.stability;
    let progress = &stability.progress;
    let rows = [0, 1].map(|y| Rect::new(area.x + 1, area.y + y, area.width.saturating_sub(2), 1));
    let width = rows[0].width as usize;
    let quiet = state.theme.style(Role::Quiet);
    if progress.phase == Phase::Idle {
        let ready = match stability.plan.stability_plan() {
            Some(plan) => format!("Ready: {} cells to try.", plan.cells()),
            None => "The plan has a line that cannot be run, marked with !.".to_owned(),
        };
        let hint = "Press Enter to run it. The map fills as cells are found.";
        frame.render_widget(Line::from(clipped(&ready, width)), rows[0]);
        frame.render_widget(Line::styled(clipped(hint, width), quiet), rows[1]);
        return;
    }
    let seconds = progress.seconds(state.clock);
    let time = match (progress.phase, progress.seconds_left(state.clock)) {
        (Phase::Running, Some(left)) => format!("{}, about {} left", clock(seconds), clock(left)),
        (Phase::Paused, _) => "PAUSED: p goes on".to_owned(),
        (Phase::Stopping, _) => "ends what it is at".to_owned(),
        (Phase::Running, None) => clock(seconds),
        (Phase::Stopped, _) => format!("stopped after {}", clock(seconds)),
        _ => format!("complete in {}", clock(seconds)),
    };
    let text = format!(" {:.0} %  {time}", (progress.done * 100.0).floor());
    frame.render_widget(sweep::bar(state.theme, progress.done, text, width), rows[0]);
    let second = match &stability.error {
        Some(why) => Line::styled(format!("! {why}"), state.theme.style(Role::Bad)),
        None => legend(state.theme, stability, width),
    };
    frame.render_widget(second, rows[1]);
}

/// What the letters mean, and how many cells of the whole suite have each.
fn legend(theme: Theme, stability: &Stability, width: usize) -> Line<'static> {
    let mut spans = Vec::new();
    let mut used = 0;
    let words = |long: bool| {
        move |(verdict, count): &(Verdict, usize)| {
            let about = match (long, verdict) {
                (true, verdict) => verdict.about(),
                (false, Verdict::Ok) => "ok",
                (false, Verdict::Known) => "known",
                (false, Verdict::Gone) => "gone",
                (false, Verdict::Fails) => "FAILS",
                (false, Verdict::Refused) => "not built",
            };
            format!(" {about} {count}  ")
        }
    };
    let counts = stability.counts();
    let whole: usize = counts
        .iter()
        .map(|c| words(true)(c).chars().count() + 1)
        .sum();
    for entry in &counts {
        let (letter, text) = (entry.0.letter().to_string(), words(whole <= width)(entry));
        used += 1 + text.chars().count();
        if used > width + 2 {
            break;
        }
        spans.push(Span::styled(letter, theme.style(role(entry.0))));
        spans.push(Span::raw(text));
    }
    Line::from(spans)
}

fn role(verdict: Verdict) -> Role {
    match verdict {
        Verdict::Ok => Role::Good,
        Verdict::Known => Role::Warning,
        Verdict::Gone => Role::Key,
        Verdict::Fails => Role::Bad,
        Verdict::Refused => Role::Quiet,
    }
}

/// Columns of the names of methods.
const NAMES: usize = 22;

fn map(state: &State, frame: &mut Frame, area: Rect) {
    let stability = &state.stability;
    let focused = stability.panel == Panel::Runs;
    let title = if stability.has_cells() {
        format!("map: {}", stability.title())
    } else {
        "map".to_owned()
    };
    let title = clipped(&title, (area.width as usize).saturating_sub(6));
    let block = panel(state.theme, title, focused);
    let inner = block.inner(area);
    frame.render_widget(block, area);
    if !stability.has_cells() {
        let text = "Nothing tried yet. Each kernel is tried on generated scenes and rays on which methods are known to break, \
             and judged by exact arithmetic; each accelerator is compared with brute force.";
        return sweep::lines(state.theme, text, frame, inner);
    }
    if inner.height < 3 || (inner.width as usize) < NAMES + 4 {
        return;
    }
    Matrix::new(state.theme, stability, inner).draw(frame, focused);
}

/// The map in its area.
struct Matrix<'a> {
    theme: Theme,
    map: &'a Stability,
    area: Rect,
    /// Columns a case.
    pitch: usize,
    /// The first case and the first row that are shown.
    first: (usize, usize),
}

impl<'a> Matrix<'a> {
    fn new(theme: Theme, map: &'a Stability, area: Rect) -> Self {
        let room = area.width as usize - NAMES;
        let pitch = (room / map.cases.len().max(1)).clamp(1, 3);
        let shown = room / pitch;
        let rows = area.height as usize - 2;
        // The marked cell is always within.
        let first = |at: usize, of: usize, room: usize| {
            at.saturating_sub(room / 2).min(of.saturating_sub(room))
        };
        Self {
            theme,
            map,
            area,
            pitch,
            first: (
                first(map.case, map.cases.len(), shown),
                first(map.row, map.rows().len(), rows),
            ),
        }
    }

    /// The cases that are shown, with their columns.
    fn cases(&self) -> impl Iterator<Item = (usize, u16)> {
        let room = self.area.width as usize - NAMES;
        (self.first.0..self.map.cases.len())
            .take(room / self.pitch)
            .enumerate()
            .map(|(i, case)| (case, self.area.x + (NAMES + i * self.pitch) as u16))
    }

    fn draw(&self, frame: &mut Frame, focused: bool) {
        self.groups(frame);
        let rows = self.map.rows();
        let shown = (self.first.1..rows.len()).take(self.area.height as usize - 2);
        for (y, row) in shown.enumerate() {
            self.row(row, self.area.y + 2 + y as u16, focused, frame);
        }
    }

    /// The groups of cases over the columns, each at its first, and a sign over the marked one.
    fn groups(&self, frame: &mut Frame) {
        let buffer = frame.buffer_mut();
        let quiet = self.theme.style(Role::Quiet);
        let group = |case: usize| case_group(self.map.cases[case]);
        let mut heads: Vec<(u16, &str)> = Vec::new();
        let mut last = "";
        for (case, x) in self.cases() {
            if group(case) != last {
                last = group(case);
                heads.push((x, last));
            }
        }
        for (i, &(x, name)) in heads.iter().enumerate() {
            let end = heads.get(i + 1).map_or(self.area.right(), |next| next.0);
            let room = (end - x) as usize;
            // A line between groups, where the columns have room for one.
            let text = clipped(name, room.saturating_sub(1).max(1));
            buffer.set_stringn(x, self.area.y, text, room, quiet);
        }
        if let Some((_, x)) = self.cases().find(|(case, _)| *case == self.map.case) {
            let style = self.theme.style(Role::Title);
            buffer.set_string(x, self.area.y + 1, "▾", style);
            // The name stands beside the sign, on the side that has room.
            let name = self.map.cases[self.map.case];
            let width = name.chars().count() as u16;
            let from = if x + 2 + width <= self.area.right() {
                x + 2
            } else {
                x.saturating_sub(width + 1)
            };
            buffer.set_string(from.max(self.area.x), self.area.y + 1, name, style);
        }
    }

    fn row(&self, row: usize, y: u16, focused: bool, frame: &mut Frame) {
        let marked = row == self.map.row;
        let name = clipped(&self.map.rows()[row], NAMES - 4);
        let sign = if marked { "▸" } else { " " };
        let role = if marked { Role::Title } else { Role::Text };
        let buffer = frame.buffer_mut();
        let text = format!("{sign} {name}");
        buffer.set_string(self.area.x, y, text, self.theme.style(role));
        for (case, x) in self.cases() {
            let (letter, role) = match self.map.at(row, case) {
                Some(cell) => (cell.verdict.letter(), role_of(cell)),
                None => (' ', Role::Quiet),
            };
            let mut style = self.theme.style(role);
            if marked && focused && case == self.map.case {
                style = style.patch(self.theme.style(Role::Marked));
            }
            buffer.set_string(x, y, letter.to_string(), style);
        }
    }
}

fn role_of(cell: &Cell) -> Role {
    role(cell.verdict)
}

fn case_group(name: &str) -> &'static str {
    case(name).map_or("", |case| case.group)
}

/// The marked cell: what it is, what was wrong from where on, and why.
fn cell(state: &State, frame: &mut Frame, area: Rect) {
    let stability = &state.stability;
    let block = panel(state.theme, "marked cell", false);
    let inner = block.inner(area);
    frame.render_widget(block, area);
    let width = (inner.width as usize).saturating_sub(2);
    let Some(name) = stability.cases.get(stability.case) else {
        return;
    };
    let mut lines: Vec<(String, Role)> = Vec::new();
    let mut tell = |text: &str, role| {
        lines.extend(wrapped(text, width).into_iter().map(|line| (line, role)));
    };
    if let Some(cell) = stability.marked() {
        let method = if cell.of_kernel() {
            cell.kernel.clone()
        } else {
            format!("{} with {}", cell.accel, cell.kernel)
        };
        let verdict = cell.verdict;
        let head = format!("{} {method} on {name}", verdict.letter());
        tell(&head, role(verdict));
        let story = cell.story();
        let story = if story.is_empty() {
            format!("nothing wrong on {} rays", cell.rays())
        } else {
            story
        };
        tell(&format!("{}: {story}", verdict.about()), Role::Text);
        tell(&rungs(cell), Role::Text);
    } else {
        let rows = stability.rows();
        let method = rows.get(stability.row).map_or("", String::as_str);
        tell(
            &format!("{method} on {name}: not tried, or not yet"),
            Role::Quiet,
        );
    }
    tell(case(name).map_or("", |case| case.about), Role::Quiet);
    for (y, (text, role)) in lines.into_iter().take(inner.height as usize).enumerate() {
        let row = Rect::new(inner.x + 1, inner.y + y as u16, inner.width - 1, 1);
        frame.render_widget(
            Line::styled(clipped(&text, width + 1), state.theme.style(role)),
            row,
        );
    }
}

/// `offset 0: 0 · offset 1e2: 3 of 1000`; empty where the case has one rung only, or nothing is wrong.
fn rungs(cell: &Cell) -> String {
    if cell.rungs.len() < 2 || cell.faults.total() == 0 {
        return String::new();
    }
    let told = cell.rungs.iter().map(|rung| match rung.faults.total() {
        0 => format!("{}: 0", rung.label),
        wrong => format!("{}: {wrong} of {}", rung.label, rung.rays),
    });
    told.collect::<Vec<_>>().join(" · ")
}
