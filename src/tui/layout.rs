//! Where things are on the screen. Views draw there, and the picture is asked for in just that size.
//!
//! ```text
//! small, planning        small, running         large
//! +--header-----------+  +--header-----------+  +--header-------------------+
//! | plan    | picture |  | chart   | picture |  | plan     | progress        |
//! | progress          |  | progress          |  |----------| chart           |
//! | runs              |  | runs              |  | picture  | runs            |
//! +--notice, footer---+  +--notice, footer---+  +--notice, footer-----------+
//! ```

use ratatui::layout::{Constraint, Layout, Rect};

use super::overlay::Overlay;
use super::plan_editor::Field;
use super::screens::details;
use super::state::{Panel, Screen, State};

/// Fewest columns and rows that the screens need.
pub const LEAST: (u16, u16) = (60, 18);

/// Rows of the plan with its frame.
const PLAN_ROWS: u16 = Field::OF_SWEEP.len() as u16 + 2;

/// The parts of every screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parts {
    /// Names of the screens, state of the sweep.
    pub header: Rect,
    /// The screen itself.
    pub body: Rect,
    /// One sentence.
    pub notice: Rect,
    /// Keys.
    pub footer: Rect,
}

/// The parts of a screen.
#[must_use]
pub fn parts(area: Rect) -> Parts {
    let [header, body, notice, footer] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Fill(1),
        Constraint::Length(1),
        Constraint::Length(1),
    ])
    .areas(area);
    Parts {
        header,
        body,
        notice,
        footer,
    }
}

/// Whether a body has room for everything at once.
#[must_use]
pub fn is_large(body: Rect) -> bool {
    body.width >= 110 && body.height >= 31
}

/// The parts of the sweep screen; those that are not shown have no area.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SweepParts {
    /// The plan.
    pub plan: Rect,
    /// The picture with its frame.
    pub picture: Rect,
    /// How far the sweep is: two rows.
    pub progress: Rect,
    /// Speed against n.
    pub chart: Rect,
    /// The table of runs.
    pub runs: Rect,
}

/// The parts of the sweep screen.
#[must_use]
pub fn sweep(state: &State, body: Rect) -> SweepParts {
    let mut parts = SweepParts::default();
    if state.expanded {
        let [progress, panel] =
            Layout::vertical([Constraint::Length(2), Constraint::Fill(1)]).areas(body);
        parts.progress = progress;
        match state.panel {
            Panel::Plan => parts.plan = panel,
            Panel::Runs => parts.runs = panel,
        }
    } else if is_large(body) {
        let [left, right] = Layout::horizontal([
            Constraint::Length((body.width * 2 / 5).clamp(48, 76)),
            Constraint::Fill(1),
        ])
        .areas(body);
        [parts.plan, parts.picture] =
            Layout::vertical([Constraint::Length(PLAN_ROWS), Constraint::Fill(1)]).areas(left);
        [parts.progress, parts.chart, parts.runs] = Layout::vertical([
            Constraint::Length(2),
            Constraint::Fill(5),
            Constraint::Fill(6),
        ])
        .areas(right);
    } else {
        let top;
        [top, parts.progress, parts.runs] = Layout::vertical([
            Constraint::Length(PLAN_ROWS),
            Constraint::Length(2),
            Constraint::Fill(1),
        ])
        .areas(body);
        let [left, right] =
            Layout::horizontal([Constraint::Fill(17), Constraint::Fill(10)]).areas(top);
        parts.picture = right;
        // The chart takes the place of the plan while the runs have the keys.
        match state.panel {
            Panel::Plan => parts.plan = left,
            Panel::Runs => parts.chart = left,
        }
    }
    parts
}

/// The parts of the preview screen: the picture with its frame, and the figures beside it, without area when the picture
/// is expanded.
#[must_use]
pub fn preview(state: &State, body: Rect) -> (Rect, Rect) {
    if state.expanded {
        return (body, Rect::default());
    }
    let side = if body.width >= 110 { 40 } else { 29 };
    let [picture, figures] =
        Layout::horizontal([Constraint::Fill(1), Constraint::Length(side)]).areas(body);
    (picture, figures)
}

/// The parts of the inspect screen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct InspectParts {
    /// What is looked at: two rows.
    pub head: Rect,
    /// The accelerators; one that is not shown has no area.
    pub sides: [Rect; 2],
}

/// Fewest columns in which two accelerators stand beside each other.
const TWO_SIDES: u16 = 76;

/// The parts of the inspect screen: the focused side alone where it is expanded or there is no room for both.
#[must_use]
pub fn inspect(state: &State, body: Rect) -> InspectParts {
    let [head, rest] = Layout::vertical([Constraint::Length(2), Constraint::Fill(1)]).areas(body);
    let mut sides = [Rect::default(); 2];
    if state.expanded || body.width < TWO_SIDES {
        sides[state.inspect.focus] = rest;
    } else {
        sides = Layout::horizontal([Constraint::Fill(1), Constraint::Fill(1)]).areas(rest);
    }
    InspectParts { head, sides }
}

/// The parts of the Pareto screen; those that are not shown have no area.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ParetoParts {
    /// What is judged.
    pub plan: Rect,
    /// How far it is: two rows.
    pub progress: Rect,
    /// What is shown of it: two rows.
    pub choices: Rect,
    /// The chart.
    pub chart: Rect,
    /// The methods.
    pub list: Rect,
}

/// The parts of the Pareto screen. Where there is little room, chart and list take turns: the list is the expanded view.
#[must_use]
pub fn pareto(state: &State, body: Rect) -> ParetoParts {
    let mut parts = ParetoParts::default();
    let plan = Constraint::Length(Field::OF_ACCURACY.len() as u16 + 2);
    let (two, rest) = (Constraint::Length(2), Constraint::Fill(1));
    if state.expanded {
        [parts.progress, parts.choices, parts.list] =
            Layout::vertical([two, two, rest]).areas(body);
    } else if is_large(body) {
        let left = Constraint::Length((body.width * 2 / 5).clamp(48, 76));
        let [left, right] = Layout::horizontal([left, rest]).areas(body);
        [parts.plan, parts.list] = Layout::vertical([plan, rest]).areas(left);
        [parts.progress, parts.choices, parts.chart] =
            Layout::vertical([two, two, rest]).areas(right);
    } else if state.pareto.panel == Panel::Plan {
        [parts.plan, parts.progress, parts.chart] = Layout::vertical([plan, two, rest]).areas(body);
    } else {
        [parts.progress, parts.choices, parts.chart] =
            Layout::vertical([two, two, rest]).areas(body);
    }
    parts
}

/// The parts of an opened configuration: the picture with its frame, and the figures beside it, without area when the
/// picture is expanded.
#[must_use]
pub fn configuration(state: &State, body: Rect) -> (Rect, Rect) {
    if state.expanded {
        return (body, Rect::default());
    }
    let side = (body.width / 2).min(64);
    let [figures, picture] =
        Layout::horizontal([Constraint::Length(side), Constraint::Fill(1)]).areas(body);
    (picture, figures)
}

/// The parts of the stability screen; those that are not shown have no area.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StabilityParts {
    /// What is tried.
    pub plan: Rect,
    /// How far it is, and what letters mean: two rows.
    pub progress: Rect,
    /// The map.
    pub map: Rect,
    /// The marked cell.
    pub cell: Rect,
}

/// The parts of the stability screen.
#[must_use]
pub fn stability(state: &State, body: Rect) -> StabilityParts {
    let mut parts = StabilityParts::default();
    let plan = Constraint::Length(Field::OF_STABILITY.len() as u16 + 2);
    let (progress, rest) = (Constraint::Length(2), Constraint::Fill(1));
    if state.expanded {
        [parts.progress, parts.map] = Layout::vertical([progress, rest]).areas(body);
    } else if is_large(body) {
        let left = Constraint::Length((body.width * 2 / 5).clamp(44, 76));
        let [left, right] = Layout::horizontal([left, rest]).areas(body);
        [parts.plan, parts.cell] = Layout::vertical([plan, rest]).areas(left);
        [parts.progress, parts.map] = Layout::vertical([progress, rest]).areas(right);
    } else if state.stability.panel == Panel::Plan {
        [parts.plan, parts.progress, parts.map] =
            Layout::vertical([plan, progress, rest]).areas(body);
    } else {
        let cell = Constraint::Length(6);
        [parts.progress, parts.map, parts.cell] =
            Layout::vertical([progress, rest, cell]).areas(body);
    }
    parts
}

/// Columns and rows of cells in which the screen shows the picture now; `None` where it shows none.
#[must_use]
pub fn picture_cells(state: &State) -> Option<(u16, u16)> {
    let (columns, rows) = state.size;
    if columns < LEAST.0 || rows < LEAST.1 {
        return None;
    }
    let body = parts(Rect::new(0, 0, columns, rows)).body;
    let framed = match state.screen {
        Screen::Sweep => sweep(state, body).picture,
        Screen::Preview => preview(state, body).0,
        Screen::Pareto if state.pareto.opened.is_some() => configuration(state, body).0,
        _ => return None,
    };
    let cells = (
        framed.width.saturating_sub(2),
        framed.height.saturating_sub(2),
    );
    (cells.0 > 0 && cells.1 > 0).then_some(cells)
}

/// A box in the middle of `area`, at most as large as it.
#[must_use]
pub fn middle(area: Rect, width: u16, height: u16) -> Rect {
    let (width, height) = (width.min(area.width), height.min(area.height));
    Rect::new(
        area.x + (area.width - width) / 2,
        area.y + (area.height - height) / 2,
        width,
        height,
    )
}

/// Columns of the box of details.
const DETAILS: u16 = 78;

/// The box of an overlay over `body`.
#[must_use]
pub fn overlay(overlay: &Overlay, body: Rect) -> Rect {
    match overlay {
        Overlay::Pick(pick) => middle(body, 78, pick.items.len() as u16 + 6),
        Overlay::Text(_) => middle(body, 76, 6),
        Overlay::Details(facts, _) => {
            let lines = details::text(facts, DETAILS as usize - 2).len();
            middle(body, DETAILS, lines as u16 + 2)
        }
        Overlay::Quit(_) => middle(body, 64, 7),
    }
}
