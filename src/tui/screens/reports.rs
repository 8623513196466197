//! The reports screen: bundles on disk; the opened one with its provenance and runs.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::Line;

use super::sweep::lines;
use super::table;
use crate::report::Provenance;
use crate::tui::state::{Opened, Screen, State};
use crate::tui::theme::Role;
use crate::tui::view::{clipped, panel};

/// Draws the screen.
pub fn draw(state: &State, frame: &mut Frame, area: Rect) {
    match &state.reports.opened {
        Some(opened) => report(state, opened, frame, area),
        None => list(state, frame, area),
    }
}

fn list(state: &State, frame: &mut Frame, area: Rect) {
    let reports = &state.reports;
    let mut title = format!("reports in {}", state.results.display());
    if !reports.filter.is_empty() {
        title = format!("{title} · '{}'", reports.filter);
    }
    let block = panel(state.theme, clipped(&title, area.width as usize - 6), true);
    let inner = block.inner(area);
    frame.render_widget(block, area);
    if let Some(why) = &reports.error {
        return lines(state.theme, why, frame, inner);
    }
    let shown: Vec<_> = reports.shown().collect();
    if shown.is_empty() {
        let text = match &reports.bundles {
            None => "Reading the directory ...",
            Some(_) if !reports.filter.is_empty() => {
                "None contains the filter; / changes it, Esc clears it."
            }
            Some(_) => "No report yet. Screen 1 (press 1) runs a sweep and writes one.",
        };
        return lines(state.theme, text, frame, inner);
    }
    let names = shown
        .iter()
        .map(|b| b.name.chars().count())
        .max()
        .unwrap_or(0)
        .min(inner.width as usize / 2);
    let row = |y: usize| Rect::new(inner.x, inner.y + y as u16, inner.width, 1);
    let head = format!("  {:<names$}  {:<20}  {:>5}  note", "name", "date", "runs");
    frame.render_widget(
        Line::styled(
            clipped(&head, inner.width as usize),
            state.theme.style(Role::Title),
        ),
        row(0),
    );
    let room = inner.height as usize - 1;
    let marked = reports.marked.min(shown.len() - 1);
    let first = (marked + 1).saturating_sub(room);
    for (y, bundle) in shown.iter().enumerate().skip(first).take(room) {
        let mark = if y == marked { "▸" } else { " " };
        let text = format!(
            "{mark} {:<names$}  {:<20}  {:>5}  {}",
            clipped(&bundle.name, names),
            clipped(&bundle.date, 20),
            bundle.runs,
            bundle.note
        );
        let role = if y == marked {
            Role::Marked
        } else {
            Role::Text
        };
        frame.render_widget(
            Line::styled(
                clipped(&text, inner.width as usize),
                state.theme.style(role),
            ),
            row(y - first + 1),
        );
    }
}

/// Rows of the provenance with its frame.
const PROVENANCE: u16 = 7;

fn report(state: &State, opened: &Opened, frame: &mut Frame, area: Rect) {
    let mut table_area = area;
    if !state.expanded {
        let [top, rest] =
            Layout::vertical([Constraint::Length(PROVENANCE), Constraint::Fill(1)]).areas(area);
        let block = panel(
            state.theme,
            clipped(
                &format!(
                    "{}: Esc closes, {} shows its curves",
                    opened.name,
                    Screen::Charts.number()
                ),
                area.width as usize - 6,
            ),
            false,
        );
        let inner = block.inner(top);
        frame.render_widget(block, top);
        for (y, text) in provenance(&opened.report.provenance)
            .into_iter()
            .enumerate()
        {
            let row = Rect::new(inner.x + 1, inner.y + y as u16, inner.width - 1, 1);
            frame.render_widget(Line::from(clipped(&text, row.width as usize)), row);
        }
        table_area = rest;
    }
    if opened.runs.rows.is_empty() {
        let text = "This report has no runs: the sweep was stopped before the first was complete.";
        return lines(state.theme, text, frame, table_area);
    }
    table::draw(
        state.theme,
        "runs",
        &opened.runs.rows,
        &opened.table,
        true,
        frame,
        table_area,
    );
}

/// Where and how it was measured, in five lines.
fn provenance(p: &Provenance) -> Vec<String> {
    let known = |text: &str| {
        if text.is_empty() {
            "unknown".to_owned()
        } else {
            text.to_owned()
        }
    };
    let commit: String = p.commit.chars().take(12).collect();
    let dirty = if p.dirty { ", changed" } else { "" };
    let scenes: Vec<String> = p
        .scenes
        .iter()
        .map(|s| format!("{} ({} triangles)", s.name, s.triangles))
        .collect();
    vec![
        format!(
            "{}  raylab {} ({}{dirty}, {})",
            known(&p.date),
            p.version,
            known(&commit),
            p.profile
        ),
        format!(
            "{}, {} cores, {}",
            known(&p.cpu),
            p.cores,
            p.instruction_set
        ),
        format!("{}, load {:.2}, seed {}", known(&p.os), p.load, p.seed),
        format!("scenes: {}", known(&scenes.join(", "))),
        format!("command: {}", known(&p.command.join(" "))),
    ]
}
