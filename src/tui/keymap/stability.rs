//! Keys of the stability screen's map.

use super::Action as A;
use super::Place as P;
use super::{Binding, ENTER, ESC, Key, LEFT, RIGHT, pause, row, stop};

/// The map.
pub const TABLE: &[Binding] = &[
    row(
        ENTER,
        A::Open,
        &[P::Map],
        "inspect the least scene and ray on which the marked cell fails",
    )
    .hint("Enter", "inspect"),
    pause(&[P::Map]),
    stop(&[P::Map]),
    row(
        &[Key::char('n')],
        A::NextFault,
        &[P::Map],
        "to the next cell that is not ok",
    )
    .hint("n/N", "next fault"),
    row(
        &[Key::char('N')],
        A::PreviousFault,
        &[P::Map],
        "to the previous cell that is not ok",
    ),
    row(
        &[Key::char('v')],
        A::Turn,
        &[P::Map],
        "the other map: kernels in an accelerator, or accelerators with a kernel",
    )
    .hint("v", "other map"),
    row(
        &[Key::char('o')],
        A::Export,
        &[P::Map],
        "write the least scene and ray on which the marked cell fails, as OBJ and .rays",
    )
    .hint("o", "export"),
    row(
        &[Key::char('a')],
        A::NextAccel,
        &[P::Map],
        "kernels in the next accelerator",
    )
    .hint("a", "accel"),
    row(
        &[Key::char('A')],
        A::PreviousAccel,
        &[P::Map],
        "kernels in the previous accelerator",
    ),
    row(
        &[Key::char('m')],
        A::NextKernel,
        &[P::Map],
        "accelerators with the next kernel",
    )
    .hint("m", "kernel"),
    row(LEFT, A::Left, &[P::Map], "one case to the left").hint("←→", "case"),
    row(RIGHT, A::Right, &[P::Map], "one case to the right"),
    row(ESC, A::Back, &[P::Map], "to the plan").hint("Esc", "plan"),
];
