//! Colours: every colour of the screen comes from here, by what it means, and degrades with the terminal.
//!
//! Nothing depends on colour alone: what is focused is also marked, what failed also says so, and lines of a chart also
//! have markers and names. Without colour only bold, dim and reversed remain.

use ratatui::style::{Color, Modifier, Style};

use crate::preview::ColorMode;

/// What something on the screen is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Plain text.
    Text,
    /// What may be overlooked: units, frames, explanations.
    Quiet,
    /// Headings.
    Title,
    /// The frame of the focused panel.
    Focus,
    /// The marked line.
    Marked,
    /// A key in a hint.
    Key,
    /// All is well.
    Good,
    /// Mind this.
    Warning,
    /// This is wrong.
    Bad,
    /// The line of that number in a chart.
    Line(usize),
}

/// The palette of Okabe and Ito, readable with every kind of colour vision, in an order in which neighbours differ most
/// on a dark and on a light ground. (Black is left out: the ground is unknown.)
const LINES: [(u8, u8, u8); 7] = [
    (86, 180, 233),
    (230, 159, 0),
    (0, 158, 115),
    (204, 121, 167),
    (213, 94, 0),
    (0, 114, 178),
    (200, 188, 46),
];

/// The nearest of the sixteen named colours, for terminals that have no more.
const LINES_16: [Color; 7] = [
    Color::Cyan,
    Color::Yellow,
    Color::Green,
    Color::Magenta,
    Color::Red,
    Color::Blue,
    Color::LightYellow,
];

/// Markers of the lines of a chart, so that they differ without colour too.
const MARKERS: [&str; 8] = ["●", "■", "▲", "◆", "○", "□", "△", "◇"];

/// How roles look in this terminal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Theme {
    mode: ColorMode,
}

impl Theme {
    /// The theme for a terminal with these colours.
    #[must_use]
    pub fn new(mode: ColorMode) -> Self {
        Self { mode }
    }

    /// The colours it was made for.
    #[must_use]
    pub fn mode(self) -> ColorMode {
        self.mode
    }

    /// How `role` looks.
    #[must_use]
    pub fn style(self, role: Role) -> Style {
        let plain = Style::new();
        let bold = plain.add_modifier(Modifier::BOLD);
        match role {
            Role::Text => plain,
            Role::Quiet => plain.add_modifier(Modifier::DIM),
            Role::Title => bold,
            Role::Marked => bold.add_modifier(Modifier::REVERSED),
            Role::Focus | Role::Key => self.coloured(bold, Color::Cyan),
            Role::Good => self.coloured(plain, Color::Green),
            Role::Warning => self.coloured(bold, Color::Yellow),
            Role::Bad => self.coloured(bold, Color::Red),
            Role::Line(i) => plain.fg(self.line(i)),
        }
    }

    /// Colour of line `i` of a chart; `Reset` without colours.
    #[must_use]
    pub fn line(self, i: usize) -> Color {
        let (r, g, b) = LINES[i % LINES.len()];
        match self.mode {
            ColorMode::True => Color::Rgb(r, g, b),
            ColorMode::Ansi256 => Color::Indexed(cube_index(r, g, b)),
            ColorMode::Ansi16 => LINES_16[i % LINES_16.len()],
            ColorMode::None => Color::Reset,
        }
    }

    /// Colour of lines that are only the ground for others; `Reset` without colours.
    #[must_use]
    pub fn faint(self) -> Color {
        match self.mode {
            ColorMode::True => Color::Rgb(110, 110, 110),
            ColorMode::Ansi256 => Color::Indexed(242),
            ColorMode::Ansi16 => Color::DarkGray,
            ColorMode::None => Color::Reset,
        }
    }

    /// Marker of line `i` of a chart.
    #[must_use]
    pub fn marker(self, i: usize) -> &'static str {
        MARKERS[i % MARKERS.len()]
    }

    fn coloured(self, style: Style, color: Color) -> Style {
        if self.mode == ColorMode::None {
            style
        } else {
            style.fg(color)
        }
    }
}

/// The entry of the 6x6x6 cube (16..=231) nearest to a colour.
fn cube_index(r: u8, g: u8, b: u8) -> u8 {
    const LEVELS: [i32; 6] = [0, 95, 135, 175, 215, 255];
    let level = |x: u8| {
        (0..6u8)
            .min_by_key(|&i| (LEVELS[i as usize] - i32::from(x)).abs())
            .unwrap_or(0)
    };
    16 + 36 * level(r) + 6 * level(g) + level(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_colour_no_role_has_one() {
        let theme = Theme::new(ColorMode::None);
        for role in [
            Role::Text,
            Role::Quiet,
            Role::Focus,
            Role::Key,
            Role::Good,
            Role::Warning,
            Role::Bad,
            Role::Marked,
        ] {
            let style = theme.style(role);
            assert_eq!((style.fg, style.bg), (None, None), "{role:?}");
        }
        assert_eq!(theme.line(3), Color::Reset);
    }

    #[test]
    fn a_256_colour_terminal_gets_entries_of_the_cube_only() {
        for i in 0..LINES.len() {
            let Color::Indexed(entry) = Theme::new(ColorMode::Ansi256).line(i) else {
                panic!("line {i} is not indexed");
            };
            assert!((16..=231).contains(&entry));
        }
        assert_eq!(cube_index(255, 255, 255), 231);
        assert_eq!(cube_index(0, 0, 0), 16);
    }

    #[test]
    fn neighbouring_lines_differ_in_colour_and_marker() {
        let theme = Theme::new(ColorMode::True);
        for i in 0..7 {
            assert_ne!(theme.marker(i), theme.marker(i + 1));
            assert_ne!(theme.line(i), theme.line(i + 1));
        }
    }
}
