//! The screen as a picture of the state: the same state always gives the same screen.

use ratatui::Frame;
use ratatui::layout::{Alignment, Rect};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, BorderType, Paragraph, Wrap};

use super::keymap::{self, Place};
use super::layout;
use super::screens;
use super::state::{Phase, Screen, State};
use super::theme::{Role, Theme};

/// Draws the whole screen.
pub fn view(state: &State, frame: &mut Frame) {
    let area = frame.area();
    if area.width < layout::LEAST.0 || area.height < layout::LEAST.1 {
        return too_small(frame, area);
    }
    let parts = layout::parts(area);
    header(state, frame, parts.header);
    screens::body(state, frame, parts.body);
    notice(state, frame, parts.notice);
    frame.render_widget(Line::from(footer(state, parts.footer.width)), parts.footer);
    for overlay in &state.overlays {
        screens::overlays::draw(state, overlay, frame, parts.body);
    }
}

fn too_small(frame: &mut Frame, area: Rect) {
    let (columns, rows) = layout::LEAST;
    let text = format!(
        "This terminal has {}x{} cells; raylab needs {columns}x{rows}. Please enlarge it, or press q to quit.",
        area.width, area.height
    );
    frame.render_widget(Paragraph::new(text).wrap(Wrap { trim: true }), area);
}

fn header(state: &State, frame: &mut Frame, area: Rect) {
    let theme = state.theme;
    let (text, role) = status(state);
    let status = Line::from(Span::styled(format!("{text} "), theme.style(role)));
    let room = (area.width as usize).saturating_sub(status.width() + 1);
    let mut names = Line::default();
    for tabs in [Tabs::Roomy, Tabs::Tight, Tabs::Numbers] {
        names = tabs.line(state);
        if names.width() <= room {
            break;
        }
    }
    frame.render_widget(names, area);
    frame.render_widget(status.alignment(Alignment::Right), area);
}

/// How the screens are named in the header, by what fits.
#[derive(Clone, Copy, PartialEq)]
enum Tabs {
    /// The program's name, and each with space around.
    Roomy,
    /// Without either.
    Tight,
    /// Only the one that is shown has its name.
    Numbers,
}

impl Tabs {
    fn line(self, state: &State) -> Line<'static> {
        let theme = state.theme;
        let mut spans = Vec::new();
        if self == Self::Roomy {
            spans.push(Span::styled(" raylab ", theme.style(Role::Title)));
        }
        for screen in Screen::ALL {
            let shown = screen == state.screen;
            let (number, title) = (screen.number(), screen.title());
            let key = if shown { Role::Marked } else { Role::Key };
            let name = if shown { Role::Marked } else { Role::Text };
            match self {
                Self::Roomy => {
                    spans.push(Span::raw(" "));
                    spans.push(Span::styled(format!(" {number}"), theme.style(key)));
                    spans.push(Span::styled(format!(" {title} "), theme.style(name)));
                }
                Self::Numbers if !shown => {
                    spans.push(Span::styled(format!(" {number}"), theme.style(key)));
                }
                Self::Tight | Self::Numbers => {
                    let gap = if number == 1 { "" } else { " " };
                    spans.push(Span::raw(gap));
                    spans.push(Span::styled(number.to_string(), theme.style(key)));
                    spans.push(Span::styled(title, theme.style(name)));
                }
            }
        }
        Line::from(spans)
    }
}

/// What the sweep is doing, in a word or two.
fn status(state: &State) -> (String, Role) {
    let percent = format!("{:.0} %", (state.sweep.done * 100.0).floor());
    if state.frozen {
        return (format!("FROZEN {percent}"), Role::Warning);
    }
    match state.sweep.phase {
        Phase::Idle => ("ready".to_owned(), Role::Quiet),
        Phase::Running => (format!("running {percent}"), Role::Good),
        Phase::Paused => (format!("PAUSED {percent}"), Role::Warning),
        Phase::Stopping => ("stopping".to_owned(), Role::Warning),
        _ if state.sweep.kept.writing => ("writing".to_owned(), Role::Good),
        Phase::Complete => ("complete".to_owned(), Role::Good),
        Phase::Stopped => (format!("stopped {percent}"), Role::Warning),
    }
}

fn notice(state: &State, frame: &mut Frame, area: Rect) {
    if let Some(notice) = &state.notice {
        let role = if notice.bad { Role::Bad } else { Role::Text };
        let mark = if notice.bad { " ! " } else { " " };
        let text = clipped(&format!("{mark}{}", notice.text), area.width as usize);
        frame.render_widget(Line::styled(text, state.theme.style(role)), area);
    }
}

/// The hints of the place that has the keys: as many as fit whole; the ways out always.
fn footer(state: &State, width: u16) -> Vec<Span<'static>> {
    let place = state.place();
    let all: Vec<_> = keymap::hints(place, state.situation()).collect();
    let is_overlay = matches!(place, Place::Pick | Place::Text | Place::Details);
    let always: &[&str] = if is_overlay {
        &["Esc"]
    } else {
        &["Tab", "?", "q"]
    };
    let is_last = |key: &str| always.contains(&key);
    let size = |hint: &(&str, &str)| hint.0.chars().count() + hint.1.chars().count() + 3;
    let mut room = (width as usize)
        .saturating_sub(all.iter().filter(|h| is_last(h.0)).map(size).sum::<usize>());
    let mut spans = Vec::new();
    for hint in &all {
        if !is_last(hint.0) {
            // The first that does not fit ends the row: what follows is less useful.
            match room.checked_sub(size(hint)) {
                Some(rest) => room = rest,
                None => continue,
            }
        }
        spans.push(Span::styled(
            format!(" {}", hint.0),
            state.theme.style(Role::Key),
        ));
        spans.push(Span::raw(format!(" {} ", hint.1)));
    }
    spans
}

/// A frame with a title; the focused one has a thick frame as well as a colour.
#[must_use]
pub fn panel(theme: Theme, title: impl Into<String>, focused: bool) -> Block<'static> {
    let (role, border) = if focused {
        (Role::Focus, BorderType::Thick)
    } else {
        (Role::Quiet, BorderType::Plain)
    };
    Block::bordered()
        .border_type(border)
        .border_style(theme.style(role))
        .title(Span::styled(
            format!(" {} ", title.into()),
            theme.style(Role::Title),
        ))
}

/// `text` in at most `width` columns; what is cut off is marked with `…`.
#[must_use]
pub fn clipped(text: &str, width: usize) -> String {
    if text.chars().count() <= width {
        return text.to_owned();
    }
    let mut short: String = text.chars().take(width.saturating_sub(1)).collect();
    if width > 0 {
        short.push('…');
    }
    short
}

/// `text` broken into lines of at most `width` columns, at spaces where there are any.
#[must_use]
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let width = width.max(1);
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => {
                let letters: Vec<char> = word.chars().collect();
                lines.extend(letters.chunks(width).map(|part| part.iter().collect()));
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_texts_end_in_an_ellipsis_and_short_ones_stay() {
        assert_eq!(clipped("grid", 4), "grid");
        assert_eq!(clipped("kd-tree", 4), "kd-…");
        assert_eq!(clipped("kd-tree", 0), "");
    }

    #[test]
    fn lines_break_at_spaces_and_long_words_anywhere() {
        assert_eq!(wrapped("a bc def", 4), ["a bc", "def"]);
        assert_eq!(wrapped("abcdefg h", 3), ["abc", "def", "g h"]);
        assert!(wrapped("", 3).is_empty());
    }
}
