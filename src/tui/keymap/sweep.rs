//! Keys of the sweep screen: the plan, the runs, and the picture beside them.

use super::Action as A;
use super::Place as P;
use super::{Binding, ENTER, ESC, Key, LEFT, RIGHT, SPACE, When, pause, row, stop};

/// The plan and the runs.
pub const TABLE: &[Binding] = &[
    row(ENTER, A::Run, &[P::Plan, P::OtherPlan], "run the plan")
        .hint("Enter", "run")
        .when(When::Idle),
    row(
        ENTER,
        A::Open,
        &[P::Runs],
        "show everything known of the run",
    )
    .hint("Enter", "details"),
    row(
        SPACE,
        A::Edit,
        &[P::Plan, P::OtherPlan],
        "change the marked line: choose from a list, or type",
    )
    .hint("Space", "change"),
    row(ESC, A::Back, &[P::Plan, P::OtherPlan], "to the results")
        .hint("Esc", "results")
        .when(When::Measured),
    row(ESC, A::Back, &[P::Runs], "to the plan").hint("Esc", "plan"),
    row(
        &[Key::char('t')],
        A::Type,
        &[P::Plan, P::OtherPlan],
        "type the line, e.g. a file, soup:5000 or grid:overlap=sat",
    )
    .hint("t", "type"),
    pause(&[P::Plan, P::OtherPlan, P::Runs]),
    stop(&[P::Plan, P::OtherPlan, P::Runs]),
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
        &[P::Runs],
        "sort by the next column",
    )
    .hint("s", "sort"),
    row(
        &[Key::char('/')],
        A::Filter,
        &[P::Runs],
        "show only lines that contain a text",
    )
    .hint("/", "filter"),
    row(LEFT, A::Left, &[P::Runs], "columns to the left"),
    row(RIGHT, A::Right, &[P::Runs], "columns to the right"),
];
