//! Keys of the preview screen, and of the picture wherever it is shown.

use crossterm::event::KeyCode;

use super::Action as A;
use super::Place as P;
use super::{
    Binding, DOWN, ENTER, ESC, FIRST, Key, LEFT, PAGE_DOWN, PAGE_UP, RIGHT, UP, pause, row, stop,
};

/// The view, the structure that is looked through, the cursor in the picture.
pub const TABLE: &[Binding] = &[
    row(
        ENTER,
        A::Aim,
        &[P::Preview],
        "put a cursor into the picture, to inspect the ray under it",
    )
    .hint("Enter", "aim"),
    row(
        ENTER,
        A::Open,
        &[P::Aim],
        "inspect the ray through the cursor",
    )
    .hint("Enter", "inspect the ray"),
    row(ESC, A::Back, &[P::Aim], "take the cursor away").hint("Esc", "no cursor"),
    row(LEFT, A::Left, &[P::Aim], "cursor to the left").hint("←↑↓→", "move the cursor"),
    row(RIGHT, A::Right, &[P::Aim], "cursor to the right"),
    row(UP, A::Up, &[P::Aim], "cursor up"),
    row(DOWN, A::Down, &[P::Aim], "cursor down"),
    row(PAGE_UP, A::PageUp, &[P::Aim], "cursor far up"),
    row(PAGE_DOWN, A::PageDown, &[P::Aim], "cursor far down"),
    row(FIRST, A::First, &[P::Aim], "cursor to the middle").hint("g", "middle"),
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
    pause(&[P::Preview]),
    stop(&[P::Preview]),
    row(
        &[Key::char('c')],
        A::Channel,
        &[P::Plan, P::Runs, P::Preview, P::Configuration],
        "next channel: colour, triangles, depth, normals, cells visited, triangles tested",
    )
    .hint("c", "channel"),
    row(
        &[Key::char('a')],
        A::NextAccel,
        &[P::Preview, P::Inspect],
        "next accelerator",
    )
    .hint("a", "accel"),
    row(
        &[Key::char('A')],
        A::PreviousAccel,
        &[P::Preview, P::Inspect],
        "previous accelerator",
    ),
    row(
        &[Key::char('n')],
        A::Finer,
        &[P::Preview, P::Inspect],
        "finer grid: the next n",
    )
    .hint("n/N", "grid"),
    row(
        &[Key::char('N')],
        A::Coarser,
        &[P::Preview, P::Inspect],
        "coarser grid: the previous n",
    ),
    row(
        &[Key::char('m')],
        A::NextKernel,
        &[P::Preview, P::Inspect],
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
        &[P::Plan, P::Runs, P::Preview, P::Configuration],
        "next kind of symbols in the picture",
    ),
    row(ESC, A::Back, &[P::Preview], "back"),
];
