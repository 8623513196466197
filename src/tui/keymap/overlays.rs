//! Keys of what lies over a screen.

use crossterm::event::KeyCode;

use super::Action as A;
use super::Place as P;
use super::{Binding, ENTER, ESC, Key, SPACE, row};

/// Lists of choices, text fields, boxes of details, questions.
pub const TABLE: &[Binding] = &[
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
        &[P::Pick],
        "type the line, e.g. a file, soup:5000 or grid:overlap=sat",
    )
    .hint("t", "type"),
    row(
        &[Key::char('/')],
        A::Filter,
        &[P::Pick],
        "show only lines that contain a text",
    )
    .hint("/", "filter"),
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
    row(ESC, A::Back, &[P::Details], "close").hint("Esc", "close"),
    row(&[Key::char('q')], A::Back, &[P::Pick, P::Details], "close"),
];
