//! The keymap: tables that drive dispatch, the help screen and the hints in the footer; one table a screen.
//!
//! A row says which keys do what in which places. What is not in a table does nothing (text fields take every other
//! character). Within a place no key has two meanings; a test holds the tables to that.

use crossterm::event::KeyCode;

mod action;
mod charts;
mod everywhere;
mod inspect;
mod overlays;
mod pareto;
mod preview;
mod reports;
mod stability;
mod sweep;

pub use super::keys::{Key, Place};
pub use action::Action;
pub use everywhere::TABLE as EVERYWHERE;

/// When the footer shows a row's hint. The key works always.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// Always.
    Always,
    /// While a sweep runs.
    Running,
    /// While none runs.
    Idle,
    /// Once there are runs.
    Measured,
}

/// What the hints depend on beside the place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Situation {
    /// A sweep is under way.
    pub running: bool,
    /// There are runs.
    pub measured: bool,
}

impl When {
    fn holds(self, now: Situation) -> bool {
        match self {
            Self::Always => true,
            Self::Running => now.running,
            Self::Idle => !now.running,
            Self::Measured => now.measured,
        }
    }
}

/// A row of the keymap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Binding {
    /// Keys, the one that hints name first.
    pub keys: &'static [Key],
    /// What they do.
    pub action: Action,
    /// Where.
    pub places: &'static [Place],
    /// What it does, for the help screen.
    pub help: &'static str,
    /// Its key and word in the footer; empty where the footer leaves it out.
    pub hint: (&'static str, &'static str),
    /// When the footer shows it.
    pub when: When,
}

const fn row(
    keys: &'static [Key],
    action: Action,
    places: &'static [Place],
    help: &'static str,
) -> Binding {
    Binding {
        keys,
        action,
        places,
        help,
        hint: ("", ""),
        when: When::Always,
    }
}

impl Binding {
    const fn hint(mut self, key: &'static str, word: &'static str) -> Self {
        self.hint = (key, word);
        self
    }

    const fn when(mut self, when: When) -> Self {
        self.when = when;
        self
    }
}

/// Lets what is being measured wait, or go on.
const fn pause(places: &'static [Place]) -> Binding {
    let help = "pause what is being measured, or go on";
    row(PAUSE, Action::Pause, places, help)
        .hint("p", "pause")
        .when(When::Running)
}

/// Ends what is being measured.
const fn stop(places: &'static [Place]) -> Binding {
    let help = "stop what is being measured; what is finished stays";
    row(STOP, Action::Stop, places, help)
        .hint("x", "stop")
        .when(When::Running)
}

const UP: &[Key] = &[Key::code(KeyCode::Up), Key::char('k')];
const DOWN: &[Key] = &[Key::code(KeyCode::Down), Key::char('j')];
const LEFT: &[Key] = &[Key::code(KeyCode::Left), Key::char('h')];
const RIGHT: &[Key] = &[Key::code(KeyCode::Right), Key::char('l')];
const FIRST: &[Key] = &[Key::char('g'), Key::code(KeyCode::Home)];
const LAST: &[Key] = &[Key::char('G'), Key::code(KeyCode::End)];
const PAGE_UP: &[Key] = &[Key::code(KeyCode::PageUp)];
const PAGE_DOWN: &[Key] = &[Key::code(KeyCode::PageDown)];
const ENTER: &[Key] = &[Key::code(KeyCode::Enter)];
const ESC: &[Key] = &[Key::code(KeyCode::Esc)];
const PAUSE: &[Key] = &[Key::char('p')];
const STOP: &[Key] = &[Key::char('x')];
const SPACE: &[Key] = &[Key::char(' ')];

/// All tables. Within each what a place is for comes first; hints appear in the footer in this order.
pub const TABLES: &[&[Binding]] = &[
    overlays::TABLE,
    sweep::TABLE,
    inspect::TABLE,
    preview::TABLE,
    charts::TABLE,
    pareto::TABLE,
    stability::TABLE,
    reports::TABLE,
    everywhere::TABLE,
];

/// All rows.
pub fn rows() -> impl Iterator<Item = &'static Binding> {
    TABLES.iter().copied().flatten()
}

/// What `key` does in `place`; `None` where it does nothing.
#[must_use]
pub fn find(place: Place, key: Key) -> Option<Action> {
    rows()
        .find(|row| row.places.contains(&place) && row.keys.contains(&key))
        .map(|row| row.action)
}

/// The hints of `place`, as (key, word), most useful first.
pub fn hints(place: Place, now: Situation) -> impl Iterator<Item = (&'static str, &'static str)> {
    rows()
        .filter(move |row| {
            row.places.contains(&place) && !row.hint.0.is_empty() && row.when.holds(now)
        })
        .map(|row| row.hint)
}

#[cfg(test)]
mod tests {
    use std::collections::{HashMap, HashSet};

    use super::Action as A;
    use super::*;

    #[test]
    fn no_key_has_two_meanings_in_one_place() {
        let mut meanings: HashMap<(Place, Key), Action> = HashMap::new();
        for row in rows() {
            for (&place, &key) in row
                .places
                .iter()
                .flat_map(|p| row.keys.iter().map(move |k| (p, k)))
            {
                if let Some(other) = meanings.insert((place, key), row.action) {
                    panic!(
                        "{} in {place:?}: {other:?} and {:?}",
                        key.name(),
                        row.action
                    );
                }
            }
        }
    }

    #[test]
    fn every_row_can_be_reached_by_each_of_its_keys() {
        for row in rows() {
            assert!(!row.keys.is_empty() && !row.places.is_empty());
            for &place in row.places {
                for &key in row.keys {
                    assert_eq!(find(place, key), Some(row.action), "{place:?} {key:?}");
                }
            }
        }
    }

    #[test]
    fn help_texts_say_something_and_hints_name_a_key_of_their_row() {
        for row in rows() {
            assert!(!row.help.is_empty(), "{:?}", row.action);
            let (key, word) = row.hint;
            assert_eq!(key.is_empty(), word.is_empty(), "{:?}", row.action);
            if !key.is_empty() {
                assert!(
                    key.contains(&row.keys[0].name())
                        || row.keys.iter().any(|k| key.contains(&k.name())),
                    "{key} is no key of {:?}",
                    row.action
                );
            }
        }
    }

    #[test]
    fn the_keys_of_the_contract_are_there() {
        let places: HashSet<Place> = Place::ALL.into_iter().collect();
        for (key, action) in [
            (Key::char('q'), A::Quit),
            (Key::ctrl('c'), A::Quit),
            (Key::char('?'), A::Help),
            (Key::code(KeyCode::Tab), A::NextScreen),
            (Key::code(KeyCode::BackTab), A::PreviousScreen),
            (Key::char('g'), A::First),
            (Key::char('G'), A::Last),
            (Key::char('h'), A::Left),
            (Key::char('j'), A::Down),
            (Key::char('k'), A::Up),
            (Key::char('l'), A::Right),
            (Key::char('/'), A::Filter),
            (Key::char('s'), A::Sort),
            (Key::code(KeyCode::Enter), A::Run),
            (Key::code(KeyCode::Enter), A::Open),
            (Key::char('p'), A::Pause),
            (Key::char('x'), A::Stop),
            (Key::char('+'), A::MoreSamples),
            (Key::char('w'), A::Write),
            (Key::char('e'), A::Expand),
            (Key::char('c'), A::Channel),
            (Key::char('b'), A::Symbols),
            (Key::char('f'), A::Freeze),
            (Key::code(KeyCode::Esc), A::Back),
            (Key::ctrl('z'), A::Suspend),
        ] {
            assert!(
                places.iter().any(|&p| find(p, key) == Some(action)),
                "{} is not {action:?} anywhere",
                key.name()
            );
        }
    }
}
