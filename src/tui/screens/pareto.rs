//! The Pareto screen: the plan, speed against wrong decisions, the methods as a list; and a configuration that was opened.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use super::pareto_chart::ParetoChart;
use super::{configuration, sweep};
use crate::tui::figures::{clock, figure};
use crate::tui::layout;
use crate::tui::pareto::{Point, Shown};
use crate::tui::state::{Panel, Phase, Screen, Source, State};
use crate::tui::theme::{Role, Theme};
use crate::tui::view::{clipped, panel};

/// Draws the screen.
pub fn draw(state: &State, frame: &mut Frame, area: Rect) {
    let pareto = &state.pareto;
    if let Some(point) = &pareto.opened {
        return configuration::draw(state, point, frame, area);
    }
    let parts = layout::pareto(state, area);
    if !parts.plan.is_empty() {
        let focused = pareto.panel == Panel::Plan;
        let title = match (focused, pareto.progress.is_running()) {
            (true, false) => "to be judged: Enter runs it, Space changes a line",
            _ => "to be judged",
        };
        sweep::plan(state.theme, &pareto.plan, title, focused, frame, parts.plan);
    }
    progress(state, frame, parts.progress);
    let shown = pareto.shown(state.judged());
    choices(state, shown.as_ref(), frame, parts.choices);
    if !parts.chart.is_empty() {
        chart(state, shown.as_ref(), frame, parts.chart);
    }
    if !parts.list.is_empty() {
        list(state, shown.as_ref(), frame, parts.list);
    }
}

/// How far the experiment is, and what it does now.
fn progress(state: &State, frame: &mut Frame, area: Rect) {
    let progress = &state.pareto.progress;
    let rows = [0, 1].map(|y| Rect::new(area.x + 1, area.y + y, area.width.saturating_sub(2), 1));
    let width = rows[0].width as usize;
    let quiet = state.theme.style(Role::Quiet);
    if progress.phase == Phase::Idle {
        let runs = state
            .pareto
            .plan
            .accuracy_plan()
            .map(|plan| plan.runs().len());
        let ready = match runs {
            Some(runs) => {
                format!("Ready: {runs} methods and places, judged by the exact oracle and timed.")
            }
            None => "The plan has a line that cannot be run, marked with !.".to_owned(),
        };
        frame.render_widget(Line::from(clipped(&ready, width)), rows[0]);
        let hint = "Press Enter to run it. The chart grows as methods are finished.";
        frame.render_widget(Line::styled(clipped(hint, width), quiet), rows[1]);
        return;
    }
    let seconds = progress.seconds(state.clock);
    let time = match (progress.phase, progress.seconds_left(state.clock)) {
        (Phase::Running, Some(left)) => format!("{}, about {} left", clock(seconds), clock(left)),
        (Phase::Running, None) => format!("{}, preparing", clock(seconds)),
        (Phase::Paused, _) => "PAUSED: p goes on".to_owned(),
        (Phase::Stopping, _) => "ends what it is at".to_owned(),
        (Phase::Stopped, _) => format!("stopped after {}", clock(seconds)),
        _ => format!("complete in {}", clock(seconds)),
    };
    let judged = state.pareto.runs.len();
    let failed = match state.pareto.failed.len() {
        0 => String::new(),
        count => format!(", {count} not made"),
    };
    let text = format!(
        " {:.0} %  {judged} judged{failed}  {time}",
        (progress.done * 100.0).floor()
    );
    frame.render_widget(sweep::bar(state.theme, progress.done, text, width), rows[0]);
    let (now, role) = now(state);
    frame.render_widget(
        Line::styled(clipped(&now, width), state.theme.style(role)),
        rows[1],
    );
}

/// What is done now; afterwards what went wrong, or where the report is.
fn now(state: &State) -> (String, Role) {
    let pareto = &state.pareto;
    if pareto.progress.is_running() {
        return (format!("now {}", pareto.progress.doing), Role::Text);
    }
    match (
        &pareto.kept.unsaved,
        pareto.failed.last(),
        &pareto.kept.bundle,
    ) {
        (Some(why), ..) => (format!("NOT SAVED: {why}"), Role::Bad),
        (None, Some(why), _) => (format!("! {why}"), Role::Bad),
        (None, None, _) if pareto.kept.writing => (
            "writing the report and its plots ...".to_owned(),
            Role::Text,
        ),
        (None, None, Some(path)) => (format!("report: {}", path.display()), Role::Text),
        (None, None, None) => (String::new(), Role::Text),
    }
}

/// Which scene and rays, and which place, with the keys that change them.
fn choices(state: &State, shown: Option<&Shown>, frame: &mut Frame, area: Rect) {
    let Some(shown) = shown else {
        return;
    };
    let theme = state.theme;
    let from = match state.pareto.source {
        Source::Live => String::new(),
        Source::Opened => match &state.reports.opened {
            Some(opened) => format!(", report {}", opened.name),
            None => String::new(),
        },
    };
    let lines = [
        (format!("{}{from}", shown.course), shown.at[0], "[ ]"),
        (shown.place.to_string(), shown.at[1], "←→"),
    ];
    for ((text, (at, of), key), y) in lines.into_iter().zip(0..area.height) {
        let mut spans = Vec::new();
        if of > 1 {
            spans.push(Span::styled(format!(" {key} "), theme.style(Role::Key)));
        } else {
            spans.push(Span::raw(" "));
        }
        let many = if of > 1 {
            format!("  ({at} of {of})")
        } else {
            String::new()
        };
        let room = (area.width as usize).saturating_sub(6);
        spans.push(Span::raw(clipped(&format!("{text}{many}"), room)));
        frame.render_widget(
            Line::from(spans),
            Rect::new(area.x, area.y + y, area.width, 1),
        );
    }
}

fn chart(state: &State, shown: Option<&Shown>, frame: &mut Frame, area: Rect) {
    let focused = state.pareto.panel == Panel::Runs;
    let block = panel(
        state.theme,
        "wrong decisions over speed: right and low is best",
        focused,
    );
    let inner = block.inner(area);
    frame.render_widget(block, area);
    match shown {
        Some(shown) if !shown.points.is_empty() => ParetoChart {
            points: &shown.points,
            marked: state.pareto.marked.min(shown.points.len() - 1),
            theme: state.theme,
        }
        .draw(frame, inner),
        _ => sweep::lines(state.theme, &nothing(state), frame, inner),
    }
}

fn nothing(state: &State) -> String {
    if state.pareto.progress.is_running() {
        return "The first point appears with the first method that is judged and timed."
            .to_owned();
    }
    let reports = Screen::Reports.number();
    format!(
        "Nothing judged yet. Enter runs the plan: each method's answers are compared with exact arithmetic, and its speed \
         is measured. Leaks, phantoms and wrong surfaces count as wrong. Screen {reports} opens a report that has such runs."
    )
}

/// Columns from which the list tells what kind of wrong, and the errors of t.
const WIDE: usize = 92;

fn list(state: &State, shown: Option<&Shown>, frame: &mut Frame, area: Rect) {
    let focused = state.pareto.panel == Panel::Runs;
    let title = format!("methods by {}", state.pareto.order.name());
    let block = panel(state.theme, title, focused);
    let inner = block.inner(area);
    frame.render_widget(block, area);
    let points = shown.map_or(&[][..], |shown| &shown.points);
    if points.is_empty() || inner.height < 2 {
        return;
    }
    let width = inner.width as usize;
    let names = points
        .iter()
        .map(|p| p.judged.label.chars().count())
        .max()
        .unwrap_or(0);
    let others = if width >= WIDE { 64 } else { 27 };
    let names = names.min(width.saturating_sub(others + 5)).max(8);
    let row = |y: usize| Rect::new(inner.x, inner.y + y as u16, inner.width, 1);
    let head = clipped(&heading(names, width), width);
    frame.render_widget(Line::styled(head, state.theme.style(Role::Title)), row(0));
    let room = inner.height as usize - 1;
    let marked = state.pareto.marked.min(points.len() - 1);
    let first = (marked + 1).saturating_sub(room);
    for (i, point) in points.iter().enumerate().skip(first).take(room) {
        let line = list_row(state.theme, point, i == marked, names, width);
        frame.render_widget(line, row(i - first + 1));
    }
}

fn heading(names: usize, width: usize) -> String {
    let start = format!(
        "    {:<names$} {:>8} {:>9} {:>7}",
        "method", "Mrays/s", "wrong", ""
    );
    if width < WIDE {
        return start;
    }
    format!(
        "{start} {:>7} {:>8} {:>7} {:>7} {:>8}",
        "leaks", "phantoms", "surface", "swaps", "t ulp 99"
    )
}

fn list_row(
    theme: Theme,
    point: &Point,
    marked: bool,
    names: usize,
    width: usize,
) -> Line<'static> {
    let judged = &point.judged;
    let accuracy = &judged.accuracy;
    let wrong = if accuracy.wrong() == 0 {
        format!("<={:.0e}", judged.bound)
    } else {
        format!("{:.1e}", accuracy.wrong_rate())
    };
    let front = if judged.front { "front" } else { "" };
    let mark = if marked { "▸" } else { " " };
    let mut text = format!(
        " {:<names$} {:>8} {wrong:>9} {front:>7}",
        clipped(&judged.label, names),
        figure(judged.speed[0]),
    );
    if width >= WIDE {
        text = format!(
            "{text} {:>7} {:>8} {:>7} {:>7} {:>8}",
            accuracy.leaks,
            accuracy.phantoms,
            accuracy.wrong_surface,
            accuracy.neighbour_swaps,
            figure(accuracy.t_ulp.p99)
        );
    }
    let text = clipped(&text, width.saturating_sub(3));
    let look = if judged.front {
        theme.style(Role::Line(point.look))
    } else {
        theme.style(Role::Quiet)
    };
    let line = Line::from(vec![
        Span::raw(format!("{mark} ")),
        Span::styled(theme.marker(point.look), look),
        Span::raw(text),
    ]);
    if marked {
        line.style(theme.style(Role::Marked))
    } else {
        line
    }
}
