//! How many colours a terminal shows, and how that is found out: from what was asked for, then from the environment,
//! never by asking the terminal.
//!
//! **Source:** no-color.org; bixense.com/clicolors; the `FORCE_COLOR` levels of Node.js; the `COLORTERM` convention.

use crate::registry::ChoiceError;

/// How many colours are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ColorMode {
    /// 24 bits a colour.
    #[default]
    True,
    /// The fixed 240 entries 16–255 of the 256-colour palette; the first sixteen differ from terminal to terminal.
    Ansi256,
    /// The sixteen named colours.
    Ansi16,
    /// None: no escape code at all.
    None,
}

/// A row of the colour registry.
#[derive(Debug, Clone, Copy)]
pub struct ColorModeEntry {
    /// Name on the command line.
    pub name: &'static str,
    /// One sentence.
    pub about: &'static str,
    /// The mode; `None` for `auto`.
    pub mode: Option<ColorMode>,
}

/// All colour modes, in the order in which they are listed.
pub const COLOR_MODES: &[ColorModeEntry] = &[
    ColorModeEntry {
        name: "auto",
        about: "What the environment says: NO_COLOR, FORCE_COLOR, CLICOLOR, COLORTERM, TERM.",
        mode: None,
    },
    ColorModeEntry {
        name: "true",
        about: "24 bits a colour.",
        mode: Some(ColorMode::True),
    },
    ColorModeEntry {
        name: "256",
        about: "The fixed entries 16-255 of the 256-colour palette.",
        mode: Some(ColorMode::Ansi256),
    },
    ColorModeEntry {
        name: "16",
        about: "The sixteen named colours, as the terminal shows them.",
        mode: Some(ColorMode::Ansi16),
    },
    ColorModeEntry {
        name: "none",
        about: "No colour and no escape code; characters stand for brightness.",
        mode: Some(ColorMode::None),
    },
];

/// Beginnings of `TERM`, and what such terminals show. The first match counts.
const TERMS: &[(&str, ColorMode)] = &[
    ("dumb", ColorMode::None),
    ("vt", ColorMode::None),
    ("alacritty", ColorMode::True),
    ("contour", ColorMode::True),
    ("foot", ColorMode::True),
    ("ghostty", ColorMode::True),
    ("rio", ColorMode::True),
    ("wezterm", ColorMode::True),
    ("xterm-ghostty", ColorMode::True),
    ("xterm-kitty", ColorMode::True),
];

/// Values of `TERM_PROGRAM`, which some terminals set beside a `TERM` that says less.
const PROGRAMS: &[(&str, ColorMode)] = &[
    ("Apple_Terminal", ColorMode::Ansi256),
    ("ghostty", ColorMode::True),
    ("iTerm.app", ColorMode::True),
    ("vscode", ColorMode::True),
    ("WezTerm", ColorMode::True),
];

impl ColorMode {
    /// Reads `auto` (as `None`), `true`, `256`, `16` or `none`.
    ///
    /// # Errors
    /// Any other word; the message names the nearest.
    pub fn parse(name: &str) -> Result<Option<Self>, ChoiceError> {
        match COLOR_MODES.iter().find(|row| row.name == name) {
            Some(row) => Ok(row.mode),
            None => Err(ChoiceError::unknown(
                "color mode",
                name,
                COLOR_MODES.iter().map(|row| row.name),
            )),
        }
    }

    /// The mode for an output: what was `asked` for by flag or configuration, else what the variables of the
    /// environment say that `env` looks up; `terminal` says whether the output is one.
    ///
    /// In this order: `asked`, `NO_COLOR`, `FORCE_COLOR` and `CLICOLOR_FORCE`, not a terminal, `CLICOLOR`, `COLORTERM`,
    /// `TERM_PROGRAM`, `TERM`. A variable that is set but empty is as good as not set, except `FORCE_COLOR`.
    #[must_use]
    pub fn detect(
        asked: Option<Self>,
        terminal: bool,
        env: impl Fn(&str) -> Option<String>,
    ) -> Self {
        if let Some(asked) = asked {
            return asked;
        }
        let set = |name: &str| env(name).filter(|value| !value.is_empty());
        if set("NO_COLOR").is_some() {
            return Self::None;
        }
        let shown = shown_by_terminal(&set);
        match env("FORCE_COLOR").as_deref() {
            Some("0" | "false") => return Self::None,
            Some("2") => return Self::Ansi256,
            Some("3") => return Self::True,
            // Asked for colour without a number: what the terminal shows, and at least the sixteen.
            Some(_) => return shown.unwrap_or(Self::Ansi16).at_least_16(),
            None => {}
        }
        if set("CLICOLOR_FORCE").is_some_and(|value| value != "0") {
            return shown.unwrap_or(Self::Ansi16).at_least_16();
        }
        if !terminal || set("CLICOLOR").as_deref() == Some("0") {
            return Self::None;
        }
        // A terminal that says nothing: on Windows none does, and all of them show everything.
        shown.unwrap_or(if cfg!(windows) {
            Self::True
        } else {
            Self::None
        })
    }

    fn at_least_16(self) -> Self {
        if self == Self::None {
            Self::Ansi16
        } else {
            self
        }
    }
}

/// What `COLORTERM`, `TERM_PROGRAM` and `TERM` say; `None` where none is set.
fn shown_by_terminal(set: &impl Fn(&str) -> Option<String>) -> Option<ColorMode> {
    let term = set("TERM");
    let table = term.as_deref().and_then(|term| {
        (TERMS.iter()).find_map(|(start, mode)| term.starts_with(start).then_some(*mode))
    });
    if table == Some(ColorMode::None) {
        return table;
    }
    if matches!(set("COLORTERM").as_deref(), Some("truecolor" | "24bit")) {
        return Some(ColorMode::True);
    }
    let program = set("TERM_PROGRAM").and_then(|program| {
        (PROGRAMS.iter()).find_map(|(name, mode)| (*name == program).then_some(*mode))
    });
    program.or(table).or_else(|| {
        term.map(|term| {
            if term.ends_with("-direct") || term.ends_with("-truecolor") {
                ColorMode::True
            } else if term.contains("256color") {
                ColorMode::Ansi256
            } else {
                ColorMode::Ansi16
            }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is detected on a terminal with these variables.
    fn on_terminal(variables: &[(&str, &str)]) -> ColorMode {
        ColorMode::detect(None, true, lookup(variables))
    }

    fn lookup(variables: &[(&str, &str)]) -> impl Fn(&str) -> Option<String> {
        move |name| {
            let found = variables.iter().find(|(key, _)| *key == name);
            found.map(|(_, value)| (*value).to_owned())
        }
    }

    #[test]
    fn the_term_table_is_asked_last() {
        let cases = [
            ("xterm-256color", ColorMode::Ansi256),
            ("screen", ColorMode::Ansi16),
            ("tmux-256color", ColorMode::Ansi256),
            ("xterm", ColorMode::Ansi16),
            ("linux", ColorMode::Ansi16),
            ("xterm-direct", ColorMode::True),
            ("xterm-kitty", ColorMode::True),
            ("alacritty", ColorMode::True),
            ("vt100", ColorMode::None),
            ("dumb", ColorMode::None),
        ];
        for (term, mode) in cases {
            assert_eq!(on_terminal(&[("TERM", term)]), mode, "{term}");
        }
    }

    #[test]
    fn colorterm_and_the_program_know_more_than_term() {
        let term = ("TERM", "xterm-256color");
        assert_eq!(
            on_terminal(&[term, ("COLORTERM", "truecolor")]),
            ColorMode::True
        );
        assert_eq!(
            on_terminal(&[term, ("COLORTERM", "24bit")]),
            ColorMode::True
        );
        assert_eq!(on_terminal(&[term, ("COLORTERM", "1")]), ColorMode::Ansi256);
        assert_eq!(
            on_terminal(&[term, ("TERM_PROGRAM", "vscode")]),
            ColorMode::True
        );
        assert_eq!(
            on_terminal(&[("TERM", "dumb"), ("COLORTERM", "truecolor")]),
            ColorMode::None
        );
    }

    #[test]
    fn no_color_beats_everything_but_what_was_asked_for() {
        let variables = [
            ("NO_COLOR", "1"),
            ("FORCE_COLOR", "3"),
            ("COLORTERM", "truecolor"),
            ("TERM", "xterm-256color"),
        ];
        assert_eq!(on_terminal(&variables), ColorMode::None);
        let asked = ColorMode::detect(Some(ColorMode::True), false, lookup(&variables));
        assert_eq!(asked, ColorMode::True);
        // An empty value is not a wish.
        assert_eq!(
            on_terminal(&[("NO_COLOR", ""), ("TERM", "xterm")]),
            ColorMode::Ansi16
        );
    }

    #[test]
    fn force_color_gives_colour_where_nothing_else_does() {
        let piped = |variables: &[(&str, &str)]| ColorMode::detect(None, false, lookup(variables));
        let term = ("TERM", "xterm-256color");
        assert_eq!(piped(&[term]), ColorMode::None);
        assert_eq!(piped(&[term, ("FORCE_COLOR", "")]), ColorMode::Ansi256);
        assert_eq!(piped(&[("FORCE_COLOR", "1")]), ColorMode::Ansi16);
        assert_eq!(piped(&[term, ("FORCE_COLOR", "3")]), ColorMode::True);
        assert_eq!(piped(&[term, ("CLICOLOR_FORCE", "1")]), ColorMode::Ansi256);
        assert_eq!(piped(&[term, ("CLICOLOR_FORCE", "0")]), ColorMode::None);
        assert_eq!(on_terminal(&[term, ("FORCE_COLOR", "0")]), ColorMode::None);
        assert_eq!(on_terminal(&[term, ("CLICOLOR", "0")]), ColorMode::None);
    }

    #[test]
    fn every_name_is_read_and_a_misspelt_one_is_answered() {
        for row in COLOR_MODES {
            assert_eq!(ColorMode::parse(row.name).unwrap(), row.mode);
        }
        assert!(
            ColorMode::parse("ture")
                .unwrap_err()
                .to_string()
                .contains("true")
        );
    }
}
