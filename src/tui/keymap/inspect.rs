//! Keys of the inspect screen; those that choose accelerator, grid and kernel are the picture's.

use super::Action as A;
use super::Place as P;
use super::{Binding, ENTER, ESC, Key, LEFT, RIGHT, pause, row, stop};

/// The steps of a ray and the slice through them.
pub const TABLE: &[Binding] = &[
    row(
        ENTER,
        A::Open,
        &[P::Inspect],
        "show everything known of the marked step",
    )
    .hint("Enter", "step"),
    row(
        LEFT,
        A::Left,
        &[P::Inspect],
        "to the accelerator at the left",
    )
    .hint("←→", "side"),
    row(
        RIGHT,
        A::Right,
        &[P::Inspect],
        "to the accelerator at the right",
    ),
    row(
        &[Key::char('v')],
        A::Plane,
        &[P::Inspect],
        "cut the scene by another plane through the ray",
    )
    .hint("v", "plane"),
    row(
        &[Key::char('+'), Key::char('=')],
        A::ZoomIn,
        &[P::Inspect],
        "look closer at the marked step",
    )
    .hint("+-", "zoom"),
    row(
        &[Key::char('-')],
        A::ZoomOut,
        &[P::Inspect],
        "look at more of the way",
    ),
    pause(&[P::Inspect]),
    stop(&[P::Inspect]),
    row(
        ESC,
        A::Back,
        &[P::Inspect],
        "back to where the ray was chosen",
    )
    .hint("Esc", "back"),
];
