//! The sweep screen: the plan, the picture, how far it is, speed against n, the runs.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use super::chart::Chart;
use super::{preview, table};
use crate::report::series::{PanelKey, Quantity, panels, series};
use crate::tui::figures::{clock, figure};
use crate::tui::layout;
use crate::tui::plan_editor::{Field, PlanEditor};
use crate::tui::runs::RunRow;
use crate::tui::state::{Panel, Phase, State};
use crate::tui::theme::{Role, Theme};
use crate::tui::view::{clipped, panel, wrapped};

/// Draws the screen.
pub fn draw(state: &State, frame: &mut Frame, area: Rect) {
    let parts = layout::sweep(state, area);
    if !parts.plan.is_empty() {
        let focused = state.panel == Panel::Plan;
        let title = match (focused, state.sweep.is_running()) {
            (true, false) => "plan: Enter runs it, Space changes a line",
            _ => "plan",
        };
        plan(state.theme, &state.plan, title, focused, frame, parts.plan);
    }
    if !parts.picture.is_empty() {
        preview::picture(state, frame, parts.picture, false);
    }
    if !parts.chart.is_empty() {
        chart(state, frame, parts.chart);
    }
    progress(state, frame, parts.progress);
    if !parts.runs.is_empty() {
        runs(state, frame, parts.runs);
    }
}

/// Columns of a line's name.
const LABEL: usize = 14;

/// The lines of a plan.
pub(super) fn plan(
    theme: Theme,
    editor: &PlanEditor,
    title: &str,
    focused: bool,
    frame: &mut Frame,
    area: Rect,
) {
    let block = panel(theme, title, focused);
    let inner = block.inner(area);
    frame.render_widget(block, area);
    let mut y = 0;
    for &field in editor.lines() {
        if y >= inner.height {
            break;
        }
        let row = Rect::new(inner.x, inner.y + y, inner.width, 1);
        let line = plan_line(theme, editor, field, focused, inner.width as usize);
        frame.render_widget(line, row);
        y += 1;
    }
    // With more room the marked line says how it is written, and what is wrong with it in full.
    let Some(rest) = inner.height.checked_sub(y + 1).filter(|rest| *rest > 0) else {
        return;
    };
    let (text, role) = match editor.error(editor.marked) {
        Some(why) => (why.to_owned(), Role::Bad),
        None => (editor.marked.form().to_owned(), Role::Quiet),
    };
    for (i, line) in wrapped(&text, inner.width as usize - 2)
        .into_iter()
        .take(rest as usize)
        .enumerate()
    {
        let row = Rect::new(inner.x + 1, inner.y + y + 1 + i as u16, inner.width - 1, 1);
        frame.render_widget(Line::styled(line, theme.style(role)), row);
    }
}

fn plan_line(
    theme: Theme,
    editor: &PlanEditor,
    field: Field,
    focused: bool,
    width: usize,
) -> Line<'static> {
    let marked = focused && editor.marked == field;
    let room = width.saturating_sub(LABEL + 2);
    let mark = if marked { "▸" } else { " " };
    let name = Span::styled(
        format!("{mark}{:<LABEL$}", field.label()),
        theme.style(Role::Quiet),
    );
    let value = match editor.error(field) {
        Some(why) => Span::styled(clipped(&format!("! {why}"), room), theme.style(Role::Bad)),
        None => Span::raw(clipped(editor.text(field), room)),
    };
    let line = Line::from(vec![name, value]);
    if marked {
        line.style(theme.style(Role::Marked))
    } else {
        line
    }
}

/// What Enter would do.
fn outlook(plan: &PlanEditor) -> String {
    match plan.plan() {
        Some(plan) => {
            let runs = plan.runs().len();
            let plural = if runs == 1 { "" } else { "s" };
            let most = runs as f64 * plan.budget.run_seconds;
            format!(
                "{runs} run{plural}, at most {} of sampling and the builds",
                clock(most)
            )
        }
        None => "the plan has a line that cannot be run, marked with !".to_owned(),
    }
}

fn progress(state: &State, frame: &mut Frame, area: Rect) {
    let rows = [0, 1].map(|y| Rect::new(area.x + 1, area.y + y, area.width.saturating_sub(2), 1));
    let width = rows[0].width as usize;
    let (first, second) = if state.sweep.phase == Phase::Idle {
        (
            Line::from(format!("Ready: {}.", outlook(&state.plan))),
            Line::styled(
                "Press Enter to run it. Space changes the marked line, ? shows all keys.",
                state.theme.style(Role::Quiet),
            ),
        )
    } else {
        (sweep_bar(state, width), now(state, width))
    };
    frame.render_widget(first, rows[0]);
    frame.render_widget(second, rows[1]);
}

/// `████░░░░ 45 %  12 of 44 runs  0:41, about 0:52 left`
fn sweep_bar(state: &State, width: usize) -> Line<'static> {
    let sweep = &state.sweep;
    let (done, failed) = sweep.runs.finished();
    let elapsed = sweep.ended.unwrap_or(state.clock) - sweep.began;
    let mut text = format!(
        " {:.0} %  {done} of {} runs",
        (sweep.done * 100.0).floor(),
        sweep.runs.rows.len()
    );
    if failed > 0 {
        text = format!("{text}, {failed} failed");
    }
    let time = match (sweep.phase, sweep.seconds_left) {
        (Phase::Running, Some(left)) => format!("{}, about {} left", clock(elapsed), clock(left)),
        (Phase::Running, None) => format!("{}, preparing", clock(elapsed)),
        (Phase::Paused, _) => "PAUSED: p goes on".to_owned(),
        (Phase::Stopping, _) => "ends its sample".to_owned(),
        (Phase::Stopped, _) => format!("stopped after {}", clock(elapsed)),
        _ => format!("complete in {}", clock(elapsed)),
    };
    text = format!("{text}  {time}");
    bar(state.theme, sweep.done, text, width)
}

/// A bar of the share that is done, and a text behind it.
pub(super) fn bar(theme: Theme, done: f64, text: String, width: usize) -> Line<'static> {
    let room = width.saturating_sub(text.chars().count()).min(40);
    let full = ((done * room as f64).round() as usize).min(room);
    Line::from(vec![
        Span::styled("█".repeat(full), theme.style(Role::Focus)),
        Span::styled("░".repeat(room - full), theme.style(Role::Quiet)),
        Span::raw(text),
    ])
}

/// What is being measured now and what it gives; afterwards where the report is.
fn now(state: &State, width: usize) -> Line<'static> {
    let runs = &state.sweep.runs;
    let text = match runs.current.and_then(|at| runs.rows.get(at)) {
        Some(row) => live(row, width),
        None if state.sweep.kept.writing => "writing the report and its plots ...".to_owned(),
        None => match (&state.sweep.kept.unsaved, &state.sweep.kept.bundle) {
            (Some(why), _) => format!("NOT SAVED: {why}"),
            (None, Some(path)) => format!("report: {}", path.display()),
            (None, None) => "preparing scenes and rays ...".to_owned(),
        },
    };
    let role = if state.sweep.kept.unsaved.is_some() {
        Role::Bad
    } else {
        Role::Text
    };
    Line::styled(clipped(&text, width), state.theme.style(role))
}

/// As many parts as fit whole.
fn live(row: &RunRow, width: usize) -> String {
    let mut parts = vec![format!("now {}", row.accel)];
    if row.run.n.is_some() || row.auto {
        parts[0] = format!("{} n={}", parts[0], row.n_text().replace("auto ", "auto="));
    }
    if let Some(speed) = row.run.mrays_per_s.samples.last() {
        parts.push(format!("{} Mrays/s", figure(*speed)));
    }
    if row.is_built() {
        if let Some(work) = &row.run.per_ray {
            parts.push(format!("{} cells/ray", figure(work.steps.mean)));
            parts.push(format!("{} tests/ray", figure(work.tests.mean)));
        }
    } else {
        parts.push(row.status.symbol().1.to_owned());
    }
    let run = &row.run;
    parts.push(format!("({} · {} · {})", run.scene, row.kernel, run.rays));
    let mut text = parts.remove(0);
    for part in parts {
        if text.chars().count() + 2 + part.chars().count() <= width {
            text = format!("{text}  {part}");
        }
    }
    text
}

fn chart(state: &State, frame: &mut Frame, area: Rect) {
    let built = state.sweep.runs.built();
    let panels = panels(&built);
    // The chart shows what the mark in the table belongs to, and so follows it.
    let marked = state
        .table
        .marked_row(&state.sweep.runs.rows)
        .map(|row| PanelKey::of(&row.run));
    let key = marked
        .filter(|key| panels.contains(key))
        .or_else(|| panels.first().cloned());
    let title = match (&key, panels.len()) {
        (Some(key), 2..) => format!("speed: {} · {} · {}", key.scene, key.kernel, key.rays),
        _ => "speed over n".to_owned(),
    };
    let block = panel(state.theme, clipped(&title, area.width as usize - 6), false);
    let inner = block.inner(area);
    frame.render_widget(block, area);
    let Some(key) = key else {
        let text = if state.sweep.is_running() {
            "The first curve appears with the first samples."
        } else {
            "Nothing measured yet: Enter runs the plan."
        };
        return lines(state.theme, text, frame, inner);
    };
    let lines = series(&built, &key, Quantity::Speed);
    Chart {
        quantity: Quantity::Speed,
        lines: &lines,
        theme: state.theme,
    }
    .draw(frame, inner);
}

/// A text in the first rows of an area.
pub(super) fn lines(theme: Theme, text: &str, frame: &mut Frame, area: Rect) {
    let width = (area.width as usize).saturating_sub(2);
    for (y, line) in wrapped(text, width)
        .into_iter()
        .take(area.height as usize)
        .enumerate()
    {
        let row = Rect::new(area.x + 1, area.y + y as u16, area.width - 1, 1);
        frame.render_widget(Line::styled(line, theme.style(Role::Quiet)), row);
    }
}

fn runs(state: &State, frame: &mut Frame, area: Rect) {
    let rows = &state.sweep.runs.rows;
    let focused = state.panel == Panel::Runs;
    if rows.is_empty() {
        let block = panel(state.theme, "runs", focused);
        let inner = block.inner(area);
        frame.render_widget(block, area);
        let text = match state.sweep.phase {
            Phase::Idle => {
                "Nothing measured yet. A run is one scene, accelerator, n, kernel and ray set: its speed, \
                 the work of a ray, build time, memory, and whether its answers are right."
            }
            _ => "Preparing.",
        };
        return lines(state.theme, text, frame, inner);
    }
    table::draw(
        state.theme,
        "runs",
        rows,
        &state.table,
        focused,
        frame,
        area,
    );
}
