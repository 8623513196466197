//! Actions on the plan.

use super::{focus, lines};
use crate::tui::keymap::Action;
use crate::tui::overlay::{Overlay, Pick, Purpose, TextField};
use crate::tui::plan_editor::Field;
use crate::tui::state::{Panel, Source, State, Sweep};
use crate::tui::table_view::TableView;
use crate::tui::update::Effect;

pub(super) fn apply(state: &mut State, action: Action) -> Vec<Effect> {
    match action {
        Action::Run => return run(state),
        Action::Edit if state.plan.marked.is_list() => {
            let pick = Pick::new(&state.plan, state.plan.marked);
            state.overlays.push(Overlay::Pick(pick));
        }
        Action::Edit | Action::Type => type_line(state, state.plan.marked),
        Action::Back if !state.sweep.runs.rows.is_empty() => focus(state, Panel::Runs),
        _ => {
            if let Some(lines) = lines(action) {
                step(state, lines);
            }
        }
    }
    Vec::new()
}

/// Opens the text field of a line.
pub(super) fn type_line(state: &mut State, field: Field) {
    let text = state.plan.text(field).to_owned();
    let mut input = TextField::new(Purpose::Line(field), &text);
    input.error = state.plan.error(field).map(str::to_owned);
    state.overlays.push(Overlay::Text(input));
}

/// Moves the mark; one line below the last are the runs.
fn step(state: &mut State, lines: isize) {
    let last = Field::ALL.len() - 1;
    let at = Field::ALL
        .iter()
        .position(|&f| f == state.plan.marked)
        .unwrap_or(0);
    if at == last && lines > 0 && !state.sweep.runs.rows.is_empty() {
        focus(state, Panel::Runs);
        return;
    }
    state.plan.marked = Field::ALL[at.saturating_add_signed(lines).min(last)];
}

fn run(state: &mut State) -> Vec<Effect> {
    if state.sweep.is_running() {
        state.say("A sweep is running: p pauses it, x stops it.");
        return Vec::new();
    }
    if state.sweep.writing {
        state.say("The last report is still being written; a moment.");
        return Vec::new();
    }
    if let Some((field, why)) = state.plan.first_error() {
        let why = format!("{}: {why}", field.label());
        state.plan.marked = field;
        state.warn(why);
        return Vec::new();
    }
    let Some(plan) = state.plan.plan() else {
        return Vec::new();
    };
    state.sweep = Sweep::beginning(state.clock);
    state.held.clear();
    state.table = TableView::default();
    state.charts.source = Source::Live;
    state.charts.panel = 0;
    focus(state, Panel::Runs);
    vec![Effect::Start(Box::new(plan))]
}
