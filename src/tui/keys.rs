//! Keys, and the places where they mean something.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

/// Where the next key goes: the focused panel of a screen, or what lies over it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Place {
    /// Sweep, the plan.
    Plan,
    /// Sweep, the runs.
    Runs,
    /// Preview, the view.
    Preview,
    /// A cursor in the picture.
    Aim,
    /// Inspect.
    Inspect,
    /// Charts.
    Charts,
    /// The plan of another experiment than the sweep.
    OtherPlan,
    /// The Pareto chart and the list of methods.
    Points,
    /// A configuration that was opened there.
    Configuration,
    /// The stability map.
    Map,
    /// Reports.
    Reports,
    /// Help.
    Help,
    /// A list of choices over the plan.
    Pick,
    /// A text field.
    Text,
    /// Everything known of one run.
    Details,
    /// A question to be answered with yes or no.
    Confirm,
}

impl Place {
    /// All places, in the order in which help lists them.
    pub const ALL: [Self; 16] = [
        Self::Plan,
        Self::Pick,
        Self::Text,
        Self::Runs,
        Self::Details,
        Self::Preview,
        Self::Aim,
        Self::Inspect,
        Self::Charts,
        Self::OtherPlan,
        Self::Points,
        Self::Configuration,
        Self::Map,
        Self::Reports,
        Self::Help,
        Self::Confirm,
    ];

    /// Heading of the place in the help screen.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Plan => "Sweep: plan",
            Self::Pick => "List of choices",
            Self::Text => "Text field",
            Self::Runs => "Sweep: runs",
            Self::Details => "One run",
            Self::Preview => "Preview",
            Self::Aim => "Cursor in the picture",
            Self::Inspect => "Inspect",
            Self::Charts => "Charts",
            Self::OtherPlan => "Pareto, Stability: plan",
            Self::Points => "Pareto: methods",
            Self::Configuration => "Pareto: one configuration",
            Self::Map => "Stability: map",
            Self::Reports => "Reports",
            Self::Help => "Help",
            Self::Confirm => "Question",
        }
    }
}

/// A key as it is pressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Key {
    /// Key.
    pub code: KeyCode,
    /// Whether Ctrl is held.
    pub ctrl: bool,
}

impl Key {
    /// A character.
    #[must_use]
    pub const fn char(c: char) -> Self {
        Self::code(KeyCode::Char(c))
    }

    /// A key that is no character.
    #[must_use]
    pub const fn code(code: KeyCode) -> Self {
        Self { code, ctrl: false }
    }

    /// A character with Ctrl.
    #[must_use]
    pub const fn ctrl(c: char) -> Self {
        Self {
            code: KeyCode::Char(c),
            ctrl: true,
        }
    }

    /// The key of an event; `None` with Alt or the system key, which mean nothing here.
    #[must_use]
    pub fn of(event: &KeyEvent) -> Option<Self> {
        let foreign = KeyModifiers::ALT | KeyModifiers::SUPER | KeyModifiers::META;
        (!event.modifiers.intersects(foreign)).then(|| Self {
            code: event.code,
            ctrl: event.modifiers.contains(KeyModifiers::CONTROL),
        })
    }

    /// The event that pressing the key gives.
    #[must_use]
    pub fn event(self) -> KeyEvent {
        let modifiers = if self.ctrl {
            KeyModifiers::CONTROL
        } else {
            KeyModifiers::NONE
        };
        KeyEvent::new(self.code, modifiers)
    }

    /// How the key is written on the screen.
    #[must_use]
    pub fn name(self) -> String {
        let name = match self.code {
            KeyCode::Char(' ') => "Space".to_owned(),
            KeyCode::Char(c) if self.ctrl => c.to_ascii_uppercase().to_string(),
            KeyCode::Char(c) => c.to_string(),
            KeyCode::Enter => "Enter".to_owned(),
            KeyCode::Esc => "Esc".to_owned(),
            KeyCode::Tab => "Tab".to_owned(),
            KeyCode::BackTab => "Shift-Tab".to_owned(),
            KeyCode::Backspace => "Backspace".to_owned(),
            KeyCode::Up => "↑".to_owned(),
            KeyCode::Down => "↓".to_owned(),
            KeyCode::Left => "←".to_owned(),
            KeyCode::Right => "→".to_owned(),
            KeyCode::Home => "Home".to_owned(),
            KeyCode::End => "End".to_owned(),
            KeyCode::PageUp => "PgUp".to_owned(),
            KeyCode::PageDown => "PgDn".to_owned(),
            other => format!("{other}"),
        };
        if self.ctrl {
            format!("Ctrl-{name}")
        } else {
            name
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ctrl_is_part_of_a_key_and_shift_is_not() {
        let ctrl_c = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
        assert_eq!(Key::of(&ctrl_c), Some(Key::ctrl('c')));
        let shifted = KeyEvent::new(KeyCode::Char('G'), KeyModifiers::SHIFT);
        assert_eq!(Key::of(&shifted), Some(Key::char('G')));
        let alt = KeyEvent::new(KeyCode::Char('q'), KeyModifiers::ALT);
        assert_eq!(Key::of(&alt), None);
    }

    #[test]
    fn an_event_and_its_key_name_each_other() {
        for key in [Key::char('x'), Key::ctrl('z'), Key::code(KeyCode::BackTab)] {
            assert_eq!(Key::of(&key.event()), Some(key));
        }
        assert_eq!(Key::ctrl('z').name(), "Ctrl-Z");
        assert_eq!(Key::char(' ').name(), "Space");
    }
}
