//! Keys of the charts screen.

use super::Action as A;
use super::Place as P;
use super::{Binding, ESC, LEFT, RIGHT, pause, row, stop};

/// The lines that say what is charted.
pub const TABLE: &[Binding] = &[
    pause(&[P::Charts]),
    stop(&[P::Charts]),
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
    row(ESC, A::Back, &[P::Charts], "back"),
];
