//! Keys of the reports screen.

use super::Action as A;
use super::Place as P;
use super::{Binding, ENTER, ESC, Key, LEFT, RIGHT, pause, row, stop};

/// The list of bundles, and the runs of the opened one.
pub const TABLE: &[Binding] = &[
    row(ENTER, A::Open, &[P::Reports], "open the report").hint("Enter", "open"),
    pause(&[P::Reports]),
    stop(&[P::Reports]),
    row(
        &[Key::char('s')],
        A::Sort,
        &[P::Reports],
        "sort by the next column",
    )
    .hint("s", "sort"),
    row(
        &[Key::char('/')],
        A::Filter,
        &[P::Reports],
        "show only lines that contain a text",
    )
    .hint("/", "filter"),
    row(LEFT, A::Left, &[P::Reports], "columns to the left"),
    row(RIGHT, A::Right, &[P::Reports], "columns to the right"),
    row(ESC, A::Back, &[P::Reports], "back"),
];
