//! The help screen: the keymap, as it is.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use crate::tui::keymap::{self, Binding, EVERYWHERE, Place};
use crate::tui::layout;
use crate::tui::state::State;
use crate::tui::theme::{Role, Theme};
use crate::tui::view::{panel, wrapped};

/// Columns of the keys.
const KEYS: usize = 18;

/// What raylab is, in the first lines of help.
const ABOUT: &str = "raylab measures, for your mesh on your machine, which acceleration structure, grid resolution n and \
     intersection method to use. A sweep runs every combination of its plan; the picture shows the scene through any of \
     them; reports lie in the results directory.";

/// Draws the screen.
pub fn draw(state: &State, frame: &mut Frame, area: Rect) {
    let block = panel(
        state.theme,
        "help: ↑↓ PgUp PgDn scroll, Esc goes back",
        true,
    );
    let inner = block.inner(area);
    frame.render_widget(block, area);
    let lines = text(state.theme, inner.width as usize);
    let last = lines.len().saturating_sub(inner.height as usize);
    let first = state.help_line.min(last);
    for (y, line) in lines
        .into_iter()
        .skip(first)
        .take(inner.height as usize)
        .enumerate()
    {
        frame.render_widget(line, Rect::new(inner.x, inner.y + y as u16, inner.width, 1));
    }
}

/// The greatest first line that still fills the screen.
#[must_use]
pub fn last_line(state: &State) -> usize {
    let (width, height) = state.size;
    let body = layout::parts(Rect::new(0, 0, width, height)).body;
    text(state.theme, (body.width as usize).saturating_sub(2))
        .len()
        .saturating_sub((body.height as usize).saturating_sub(2))
}

fn text(theme: Theme, width: usize) -> Vec<Line<'static>> {
    let mut lines: Vec<Line> = wrapped(ABOUT, width.saturating_sub(2))
        .into_iter()
        .map(|line| Line::from(format!(" {line}")))
        .collect();
    section(theme, "Everywhere", EVERYWHERE.iter(), width, &mut lines);
    let special = keymap::TABLES.iter().filter(|table| **table != EVERYWHERE);
    for place in Place::ALL {
        let rows = special.clone().copied().flatten();
        let rows = rows.filter(|row| row.places.contains(&place));
        section(theme, place.title(), rows, width, &mut lines);
    }
    lines
}

fn section<'a>(
    theme: Theme,
    title: &'static str,
    rows: impl Iterator<Item = &'a Binding>,
    width: usize,
    lines: &mut Vec<Line<'static>>,
) {
    let mut rows = rows.peekable();
    if rows.peek().is_none() {
        return;
    }
    lines.push(Line::default());
    lines.push(Line::styled(format!(" {title}"), theme.style(Role::Title)));
    for row in rows {
        let names: Vec<String> = row.keys.iter().map(|key| key.name()).collect();
        let mut names = format!("{:<KEYS$}", names.join(" "));
        for part in wrapped(row.help, width.saturating_sub(KEYS + 5)) {
            lines.push(Line::from(vec![
                Span::styled(format!("   {names}"), theme.style(Role::Key)),
                Span::raw(part),
            ]));
            names = " ".repeat(KEYS);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::ColorMode;

    #[test]
    fn every_row_of_the_keymap_is_in_the_help() {
        let text: Vec<String> = text(Theme::new(ColorMode::None), 200)
            .iter()
            .map(ToString::to_string)
            .collect();
        for row in keymap::rows() {
            assert!(
                text.iter()
                    .any(|line| line.contains(row.help) && line.contains(&row.keys[0].name())),
                "{}",
                row.help
            );
        }
    }
}
