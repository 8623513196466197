//! What lies over a screen.

use ratatui::Frame;
use ratatui::layout::{Position, Rect};
use ratatui::text::{Line, Span};
use ratatui::widgets::Clear;

use super::details;
use crate::tui::layout;
use crate::tui::overlay::{Overlay, Pick, Purpose, TextField};
use crate::tui::state::State;
use crate::tui::theme::Role;
use crate::tui::view::{clipped, panel, wrapped};

/// Draws an overlay over `body`.
pub fn draw(state: &State, overlay: &Overlay, frame: &mut Frame, body: Rect) {
    let area = layout::overlay(overlay, body);
    let title = match overlay {
        Overlay::Pick(pick) => format!(
            "{}: Space takes or leaves, Enter is done",
            pick.field.label()
        ),
        Overlay::Text(field) => match field.purpose {
            Purpose::Line(line) => {
                format!("{}: Enter is done, Esc leaves it as it was", line.label())
            }
            _ => "show only what contains: Enter is done, Esc cancels".to_owned(),
        },
        Overlay::Details(facts, _) => format!("{}: Esc closes", facts.title),
        Overlay::Quit(_) => "quit?".to_owned(),
    };
    frame.render_widget(Clear, area);
    let block = panel(state.theme, clipped(&title, area.width as usize - 4), true);
    let inner = block.inner(area);
    frame.render_widget(block, area);
    match overlay {
        Overlay::Pick(list) => pick(state, list, frame, inner),
        Overlay::Text(field) => text(state, field, frame, inner),
        Overlay::Details(facts, first) => {
            let lines = details::text(facts, inner.width as usize);
            let last = lines.len().saturating_sub(inner.height as usize);
            let styled = lines.into_iter().skip((*first).min(last)).map(|line| {
                let bad = line.contains("WRONG") || line.contains(" failed: ");
                let role = if bad { Role::Bad } else { Role::Text };
                Line::styled(line, state.theme.style(role))
            });
            rows(styled, frame, inner);
        }
        Overlay::Quit(reason) => {
            let mut lines: Vec<Line> = wrapped(reason, inner.width as usize - 2)
                .into_iter()
                .map(|line| Line::from(format!(" {line}")))
                .collect();
            lines.push(Line::default());
            lines.push(Line::from(vec![
                Span::styled(" y", state.theme.style(Role::Key)),
                Span::raw(" quits   "),
                Span::styled("n", state.theme.style(Role::Key)),
                Span::raw(" goes on"),
            ]));
            rows(lines.into_iter(), frame, inner);
        }
    }
}

fn rows<'a>(lines: impl Iterator<Item = Line<'a>>, frame: &mut Frame, area: Rect) {
    for (y, line) in lines.take(area.height as usize).enumerate() {
        frame.render_widget(line, Rect::new(area.x, area.y + y as u16, area.width, 1));
    }
}

/// Rows below the choices: an empty one, two for the marked choice, one for a hint.
const FOOT: u16 = 4;

fn pick(state: &State, pick: &Pick, frame: &mut Frame, area: Rect) {
    let shown = pick.shown();
    let marked = pick.marked.min(shown.len().saturating_sub(1));
    let width = area.width as usize;
    // The last rows tell the marked choice in full, and the filter or how to type what the list lacks.
    let room = area.height.saturating_sub(FOOT) as usize;
    let names = pick
        .items
        .iter()
        .map(|item| item.name.chars().count())
        .max()
        .unwrap_or(0)
        .min(24);
    let first = (marked + 1).saturating_sub(room);
    let lines = shown
        .iter()
        .enumerate()
        .skip(first)
        .take(room)
        .map(|(i, &at)| {
            let item = &pick.items[at];
            let mark = if i == marked { "▸" } else { " " };
            let taken = if item.taken { "[x]" } else { "[ ]" };
            let text = format!(
                "{mark}{taken} {:<names$}  {}",
                clipped(&item.name, names),
                item.about
            );
            let role = if i == marked {
                Role::Marked
            } else {
                Role::Text
            };
            Line::styled(clipped(&text, width), state.theme.style(role))
        });
    rows(lines, frame, area);
    let about = shown
        .get(marked)
        .map_or("", |&at| pick.items[at].about.as_str());
    let foot = Rect::new(
        area.x,
        area.bottom().saturating_sub(FOOT - 1),
        area.width,
        FOOT - 2,
    );
    let about = wrapped(about, width - 2).into_iter();
    rows(
        about.map(|line| Line::from(format!(" {line}"))),
        frame,
        foot,
    );
    let hint = if pick.filter.is_empty() {
        format!("t types: {}", pick.field.form())
    } else {
        format!(
            "filter '{}': {} of {}",
            pick.filter,
            shown.len(),
            pick.items.len()
        )
    };
    let last = Rect::new(area.x, area.bottom().saturating_sub(1), area.width, 1);
    frame.render_widget(
        Line::styled(
            clipped(&format!(" {hint}"), width),
            state.theme.style(Role::Quiet),
        ),
        last,
    );
}

fn text(state: &State, field: &TextField, frame: &mut Frame, area: Rect) {
    let width = area.width as usize - 2;
    let (shown, cursor) = field.input.window(width);
    let mut lines = vec![Line::from(format!(" {shown}"))];
    let (hint, role) = match (&field.error, field.purpose) {
        (Some(why), _) => (format!("! {why}"), Role::Bad),
        (None, Purpose::Line(line)) => (line.form().to_owned(), Role::Quiet),
        (None, _) => ("words in any order, e.g. grid n=32".to_owned(), Role::Quiet),
    };
    lines.extend(
        wrapped(&hint, width)
            .into_iter()
            .map(|line| Line::styled(format!(" {line}"), state.theme.style(role))),
    );
    rows(lines.into_iter(), frame, area);
    frame.set_cursor_position(Position::new(area.x + 1 + cursor as u16, area.y));
}
