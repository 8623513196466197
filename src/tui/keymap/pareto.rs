//! Keys of the Pareto screen: the methods, and a configuration that was opened.

use super::Action as A;
use super::Place as P;
use super::{Binding, ENTER, ESC, Key, LEFT, RIGHT, pause, row, stop};

/// The chart with its list, and one configuration.
pub const TABLE: &[Binding] = &[
    row(
        ENTER,
        A::Open,
        &[P::Points],
        "open the configuration: its figures and its picture",
    )
    .hint("Enter", "open"),
    row(
        ENTER,
        A::Aim,
        &[P::Configuration],
        "put a cursor into the picture, to inspect the ray under it",
    )
    .hint("Enter", "aim"),
    row(
        &[Key::char('i')],
        A::Inspect,
        &[P::Configuration],
        "inspect the first ray of its set that it decides wrongly",
    )
    .hint("i", "inspect a wrong ray"),
    pause(&[P::Points]),
    stop(&[P::Points]),
    row(LEFT, A::Left, &[P::Points], "previous offset or scale").hint("←→", "offset"),
    row(RIGHT, A::Right, &[P::Points], "next offset or scale"),
    row(
        &[Key::char(']')],
        A::NextScene,
        &[P::Points],
        "next scene and ray set",
    )
    .hint("]", "scene, rays"),
    row(
        &[Key::char('[')],
        A::PreviousScene,
        &[P::Points],
        "previous scene and ray set",
    ),
    row(
        &[Key::char('s')],
        A::Sort,
        &[P::Points],
        "sort by speed, wrong decisions or name",
    )
    .hint("s", "sort"),
    row(ESC, A::Back, &[P::Points], "to the plan").hint("Esc", "plan"),
    row(ESC, A::Back, &[P::Configuration], "back to the chart").hint("Esc", "chart"),
];
