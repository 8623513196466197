//! Keys that mean the same on all screens: moving in lists, going from screen to screen, leaving.

use crossterm::event::KeyCode;

use super::Action as A;
use super::Place as P;
use super::{Binding, DOWN, ESC, FIRST, Key, LAST, PAGE_DOWN, PAGE_UP, Place, UP, row};

const WORKPLACES: &[Place] = &[
    P::Plan,
    P::Runs,
    P::Preview,
    P::Inspect,
    P::Charts,
    P::OtherPlan,
    P::Points,
    P::Map,
    P::Reports,
];
const PANELS: &[Place] = &[
    P::Plan,
    P::Runs,
    P::Preview,
    P::Inspect,
    P::Charts,
    P::OtherPlan,
    P::Points,
    P::Configuration,
    P::Map,
    P::Reports,
];
const SCREENS: &[Place] = &[
    P::Plan,
    P::Runs,
    P::Preview,
    P::Aim,
    P::Inspect,
    P::Charts,
    P::OtherPlan,
    P::Points,
    P::Configuration,
    P::Map,
    P::Reports,
    P::Help,
];
const LISTS: &[Place] = &[
    P::Plan,
    P::Runs,
    P::Inspect,
    P::Charts,
    P::OtherPlan,
    P::Points,
    P::Map,
    P::Reports,
    P::Help,
    P::Pick,
    P::Details,
];

/// Lists, screens, the program.
pub const TABLE: &[Binding] = &[
    row(UP, A::Up, LISTS, "one line up").hint("↑↓", "line"),
    row(DOWN, A::Down, LISTS, "one line down"),
    row(FIRST, A::First, LISTS, "to the first line"),
    row(LAST, A::Last, LISTS, "to the last line"),
    row(PAGE_UP, A::PageUp, LISTS, "a page up"),
    row(PAGE_DOWN, A::PageDown, LISTS, "a page down"),
    row(
        &[Key::char('w')],
        A::Write,
        WORKPLACES,
        "write the report with its plots now",
    ),
    row(
        &[Key::char('e')],
        A::Expand,
        PANELS,
        "give the focused panel the whole screen, or take it back",
    )
    .hint("e", "expand"),
    row(
        &[Key::char('f')],
        A::Freeze,
        WORKPLACES,
        "hold the display still; measuring goes on",
    ),
    row(ESC, A::Back, &[P::Help], "back"),
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
    row(&[Key::char('3')], A::Screen(3), SCREENS, "Inspect"),
    row(&[Key::char('4')], A::Screen(4), SCREENS, "Charts"),
    row(&[Key::char('5')], A::Screen(5), SCREENS, "Pareto"),
    row(&[Key::char('6')], A::Screen(6), SCREENS, "Stability"),
    row(&[Key::char('7')], A::Screen(7), SCREENS, "Reports"),
    row(&[Key::char('8')], A::Screen(8), SCREENS, "Help"),
    row(&[Key::char('?')], A::Help, SCREENS, "all keys").hint("?", "help"),
    row(
        &[Key::char('q')],
        A::Quit,
        SCREENS,
        "quit; asks while something is measured",
    )
    .hint("q", "quit"),
    row(
        &[Key::ctrl('c')],
        A::Quit,
        &Place::ALL,
        "quit, from anywhere; twice: without asking",
    ),
    row(
        &[Key::ctrl('z')],
        A::Suspend,
        &Place::ALL,
        "suspend; `fg` in the shell goes on",
    ),
    row(
        &[Key::ctrl('l')],
        A::Repaint,
        &Place::ALL,
        "draw the whole screen again",
    ),
];
