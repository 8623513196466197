//! The keymap: one table that drives dispatch, the help screen and the hints in the footer.
//!
//! A row says which keys do what in which places. What is not in the table does nothing (text fields take every other
//! character). Within a place no key has two meanings; a test holds the table to that.

use crossterm::event::KeyCode;

pub use super::keys::{Key, Place};

/// What a key does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Action {
    /// Leave the program.
    Quit,
    /// Show the keys.
    Help,
    /// Go to the next screen.
    NextScreen,
    /// Go to the previous screen.
    PreviousScreen,
    /// Go to the screen of that number, from 1.
    Screen(u8),
    /// Hand the terminal back to the shell until resumed.
    Suspend,
    /// Draw the whole screen again.
    Repaint,
    /// Leave what lies on top, or go back.
    Back,
    /// One up.
    Up,
    /// One down.
    Down,
    /// One to the left.
    Left,
    /// One to the right.
    Right,
    /// To the first.
    First,
    /// To the last.
    Last,
    /// A page up, or nearer.
    PageUp,
    /// A page down, or farther.
    PageDown,
    /// Run the plan.
    Run,
    /// Open what is marked.
    Open,
    /// Change the marked line of the plan.
    Edit,
    /// Change the marked line of the plan as text.
    Type,
    /// Take or leave the marked choice.
    Toggle,
    /// Take all choices, or none.
    ToggleAll,
    /// More samples a run.
    MoreSamples,
    /// Fewer samples a run.
    FewerSamples,
    /// Wait, or go on.
    Pause,
    /// End the sweep.
    Stop,
    /// Write the report now.
    Write,
    /// Sort by the next column.
    Sort,
    /// Show only what contains a text.
    Filter,
    /// Give the focused panel the whole screen.
    Expand,
    /// Hold the display still.
    Freeze,
    /// The next channel of the picture.
    Channel,
    /// The next kind of symbols.
    Symbols,
    /// The next accelerator.
    NextAccel,
    /// The previous accelerator.
    PreviousAccel,
    /// A finer grid.
    Finer,
    /// A coarser grid.
    Coarser,
    /// The next kernel.
    NextKernel,
    /// The next scene.
    NextScene,
    /// The previous scene.
    PreviousScene,
    /// Accept what was typed, or answer yes.
    Accept,
    /// Erase the character before the cursor.
    Erase,
    /// Erase the whole text.
    Clear,
    /// Answer no.
    Refuse,
}

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
#[derive(Debug, Clone, Copy)]
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

use Action as A;
use Place as P;

const SCREENS: &[Place] = &[P::Plan, P::Runs, P::Preview, P::Charts, P::Reports, P::Help];
const OVERLAYS: &[Place] = &[P::Pick, P::Details];
const EVERYWHERE: &[Place] = &Place::ALL;
const WORKPLACES: &[Place] = &[P::Plan, P::Runs, P::Preview, P::Charts, P::Reports];
const LISTS: &[Place] = &[
    P::Plan,
    P::Runs,
    P::Charts,
    P::Reports,
    P::Help,
    P::Pick,
    P::Details,
];

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
const SPACE: &[Key] = &[Key::char(' ')];

/// The table. Hints appear in the footer in this order.
pub const KEYMAP: &[Binding] = &[
    // What a place is for comes first, for it comes first in the footer.
    row(ENTER, A::Run, &[P::Plan], "run the plan")
        .hint("Enter", "run")
        .when(When::Idle),
    row(
        ENTER,
        A::Open,
        &[P::Runs],
        "show everything known of the run",
    )
    .hint("Enter", "details"),
    row(ENTER, A::Open, &[P::Reports], "open the report").hint("Enter", "open"),
    row(
        ENTER,
        A::Accept,
        &[P::Pick, P::Text],
        "take over what you chose or typed",
    )
    .hint("Enter", "done"),
    row(
        &[Key::char('y'), Key::code(KeyCode::Enter)],
        A::Accept,
        &[P::Confirm],
        "yes",
    )
    .hint("y", "yes"),
    row(
        &[Key::char('n'), Key::code(KeyCode::Esc), Key::char('q')],
        A::Refuse,
        &[P::Confirm],
        "no",
    )
    .hint("n", "no"),
    row(
        SPACE,
        A::Edit,
        &[P::Plan],
        "change the marked line: choose from a list, or type",
    )
    .hint("Space", "change"),
    row(ESC, A::Back, &[P::Plan], "to the runs")
        .hint("Esc", "runs")
        .when(When::Measured),
    row(ESC, A::Back, &[P::Runs], "to the plan").hint("Esc", "plan"),
    row(SPACE, A::Toggle, &[P::Pick], "take or leave the choice").hint("Space", "take/leave"),
    row(
        &[Key::char('a')],
        A::ToggleAll,
        &[P::Pick],
        "take all, or none",
    )
    .hint("a", "all/none"),
    row(
        &[Key::char('t')],
        A::Type,
        &[P::Plan, P::Pick],
        "type the line, e.g. a file, soup:5000 or grid:overlap=sat",
    )
    .hint("t", "type"),
    row(
        &[Key::char('p')],
        A::Pause,
        WORKPLACES,
        "pause the sweep, or go on",
    )
    .hint("p", "pause")
    .when(When::Running),
    row(
        &[Key::char('x')],
        A::Stop,
        WORKPLACES,
        "stop the sweep; what is finished stays",
    )
    .hint("x", "stop")
    .when(When::Running),
    row(
        &[Key::char('+'), Key::char('=')],
        A::MoreSamples,
        &[P::Plan, P::Runs],
        "twice the samples for every run of the plan",
    )
    .hint("+", "samples")
    .when(When::Idle),
    row(
        &[Key::char('-')],
        A::FewerSamples,
        &[P::Plan, P::Runs],
        "half the samples for every run of the plan",
    ),
    row(
        &[Key::char('s')],
        A::Sort,
        &[P::Runs, P::Reports],
        "sort by the next column",
    )
    .hint("s", "sort"),
    row(
        &[Key::char('/')],
        A::Filter,
        &[P::Runs, P::Reports, P::Pick],
        "show only lines that contain a text",
    )
    .hint("/", "filter"),
    // Preview.
    row(LEFT, A::Left, &[P::Preview], "turn the view to the left").hint("←↑↓→", "turn"),
    row(RIGHT, A::Right, &[P::Preview], "turn the view to the right"),
    row(UP, A::Up, &[P::Preview], "look from higher up"),
    row(DOWN, A::Down, &[P::Preview], "look from lower down"),
    row(
        &[Key::code(KeyCode::PageUp), Key::char('+'), Key::char('=')],
        A::PageUp,
        &[P::Preview],
        "nearer",
    )
    .hint("+-", "zoom"),
    row(
        &[Key::code(KeyCode::PageDown), Key::char('-')],
        A::PageDown,
        &[P::Preview],
        "farther",
    ),
    row(
        FIRST,
        A::First,
        &[P::Preview],
        "back to the scene's own view",
    ),
    row(
        &[Key::char('c')],
        A::Channel,
        &[P::Plan, P::Runs, P::Preview],
        "next channel: colour, triangles, depth, normals, cells visited, triangles tested",
    )
    .hint("c", "channel"),
    row(
        &[Key::char('a')],
        A::NextAccel,
        &[P::Preview],
        "next accelerator",
    )
    .hint("a", "accel"),
    row(
        &[Key::char('A')],
        A::PreviousAccel,
        &[P::Preview],
        "previous accelerator",
    ),
    row(
        &[Key::char('n')],
        A::Finer,
        &[P::Preview],
        "finer grid: the next n",
    )
    .hint("n/N", "grid"),
    row(
        &[Key::char('N')],
        A::Coarser,
        &[P::Preview],
        "coarser grid: the previous n",
    ),
    row(
        &[Key::char('m')],
        A::NextKernel,
        &[P::Preview],
        "next kernel (intersection method)",
    )
    .hint("m", "kernel"),
    row(
        &[Key::char(']')],
        A::NextScene,
        &[P::Plan, P::Runs, P::Preview],
        "next scene in the picture",
    )
    .hint("]", "scene"),
    row(
        &[Key::char('[')],
        A::PreviousScene,
        &[P::Plan, P::Runs, P::Preview],
        "previous scene in the picture",
    ),
    row(
        &[Key::char('b')],
        A::Symbols,
        &[P::Plan, P::Runs, P::Preview],
        "next kind of symbols in the picture",
    ),
    // Moving in lists.
    row(UP, A::Up, LISTS, "one line up").hint("↑↓", "line"),
    row(DOWN, A::Down, LISTS, "one line down"),
    row(
        LEFT,
        A::Left,
        &[P::Charts],
        "previous value of the marked line",
    )
    .hint("←→", "value"),
    row(
        RIGHT,
        A::Right,
        &[P::Charts],
        "next value of the marked line",
    ),
    row(LEFT, A::Left, &[P::Runs, P::Reports], "columns to the left"),
    row(
        RIGHT,
        A::Right,
        &[P::Runs, P::Reports],
        "columns to the right",
    ),
    row(FIRST, A::First, LISTS, "to the first line"),
    row(LAST, A::Last, LISTS, "to the last line"),
    row(PAGE_UP, A::PageUp, LISTS, "a page up"),
    row(PAGE_DOWN, A::PageDown, LISTS, "a page down"),
    // Text.
    row(
        &[Key::code(KeyCode::Backspace)],
        A::Erase,
        &[P::Text],
        "erase the character before the cursor",
    ),
    row(
        &[Key::ctrl('u')],
        A::Clear,
        &[P::Text],
        "erase the whole text",
    )
    .hint("Ctrl-U", "clear"),
    row(
        &[Key::code(KeyCode::Left)],
        A::Left,
        &[P::Text],
        "cursor to the left",
    ),
    row(
        &[Key::code(KeyCode::Right)],
        A::Right,
        &[P::Text],
        "cursor to the right",
    ),
    row(
        &[Key::code(KeyCode::Home)],
        A::First,
        &[P::Text],
        "cursor to the start",
    ),
    row(
        &[Key::code(KeyCode::End)],
        A::Last,
        &[P::Text],
        "cursor to the end",
    ),
    row(ESC, A::Back, &[P::Text, P::Pick], "leave it as it was").hint("Esc", "cancel"),
    // Everywhere.
    row(
        &[Key::char('w')],
        A::Write,
        WORKPLACES,
        "write the report with its plots now",
    ),
    row(
        &[Key::char('e')],
        A::Expand,
        WORKPLACES,
        "give the focused panel the whole screen, or take it back",
    )
    .hint("e", "expand"),
    row(
        &[Key::char('f')],
        A::Freeze,
        WORKPLACES,
        "hold the display still; measuring goes on",
    ),
    row(
        ESC,
        A::Back,
        &[P::Preview, P::Charts, P::Reports, P::Help],
        "back",
    ),
    row(ESC, A::Back, &[P::Details], "close").hint("Esc", "close"),
    row(
        &[Key::code(KeyCode::Tab)],
        A::NextScreen,
        SCREENS,
        "next screen",
    )
    .hint("Tab", "screen"),
    row(
        &[Key::code(KeyCode::BackTab)],
        A::PreviousScreen,
        SCREENS,
        "previous screen",
    ),
    row(&[Key::char('1')], A::Screen(1), SCREENS, "Sweep"),
    row(&[Key::char('2')], A::Screen(2), SCREENS, "Preview"),
    row(&[Key::char('3')], A::Screen(3), SCREENS, "Charts"),
    row(&[Key::char('4')], A::Screen(4), SCREENS, "Reports"),
    row(&[Key::char('5')], A::Screen(5), SCREENS, "Help"),
    row(&[Key::char('?')], A::Help, SCREENS, "all keys").hint("?", "help"),
    row(
        &[Key::char('q')],
        A::Quit,
        SCREENS,
        "quit; asks while a sweep runs",
    )
    .hint("q", "quit"),
    row(&[Key::char('q')], A::Back, OVERLAYS, "close"),
    row(
        &[Key::ctrl('c')],
        A::Quit,
        EVERYWHERE,
        "quit, from anywhere; twice: without asking",
    ),
    row(
        &[Key::ctrl('z')],
        A::Suspend,
        EVERYWHERE,
        "suspend; `fg` in the shell goes on",
    ),
    row(
        &[Key::ctrl('l')],
        A::Repaint,
        EVERYWHERE,
        "draw the whole screen again",
    ),
];

/// What `key` does in `place`; `None` where it does nothing.
#[must_use]
pub fn find(place: Place, key: Key) -> Option<Action> {
    KEYMAP
        .iter()
        .find(|row| row.places.contains(&place) && row.keys.contains(&key))
        .map(|row| row.action)
}

/// The hints of `place`, as (key, word), most useful first.
pub fn hints(place: Place, now: Situation) -> impl Iterator<Item = (&'static str, &'static str)> {
    KEYMAP
        .iter()
        .filter(move |row| {
            row.places.contains(&place) && !row.hint.0.is_empty() && row.when.holds(now)
        })
        .map(|row| row.hint)
}

#[cfg(test)]
mod tests {
    use std::collections::{HashMap, HashSet};

    use super::*;

    #[test]
    fn no_key_has_two_meanings_in_one_place() {
        let mut meanings: HashMap<(Place, Key), Action> = HashMap::new();
        for row in KEYMAP {
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
        for row in KEYMAP {
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
        for row in KEYMAP {
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
