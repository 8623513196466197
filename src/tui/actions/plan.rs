//! Actions on the plan.

use super::{focus, lines};
use crate::tui::keymap::Action;
use crate::tui::overlay::{Overlay, Pick, Purpose, TextField};
use crate::tui::plan_editor::Field;
use crate::tui::runner::Work;
use crate::tui::state::{Panel, Screen, Source, State, Sweep};
use crate::tui::table_view::TableView;
use crate::tui::update::Effect;

pub(super) fn apply(state: &mut State, action: Action) -> Vec<Effect> {
    let editor = state.editor();
    match action {
        Action::Run => return run(state),
        Action::Edit if editor.marked.is_list() => {
            let pick = Pick::new(editor, editor.marked);
            state.overlays.push(Overlay::Pick(pick));
        }
        Action::Edit | Action::Type => type_line(state, editor.marked),
        Action::Back if state.situation().measured => focus(state, Panel::Runs),
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
    let editor = state.editor();
    let mut input = TextField::new(Purpose::Line(field), editor.text(field));
    input.error = editor.error(field).map(str::to_owned);
    state.overlays.push(Overlay::Text(input));
}

/// Moves the mark; one line below the last are the runs.
fn step(state: &mut State, lines: isize) {
    let moved = state.editor_mut().step(lines);
    if !moved && lines > 0 && state.situation().measured {
        focus(state, Panel::Runs);
    }
}

/// Runs the plan of the screen that is shown.
fn run(state: &mut State) -> Vec<Effect> {
    if let Some(experiment) = state.running() {
        let (name, number) = (experiment.name(), experiment.screen().number());
        state.say(format!(
            "{name} is running on screen {number}: p pauses it, x stops it."
        ));
        return Vec::new();
    }
    if state.sweep.kept.writing || state.pareto.kept.writing {
        state.say("The last report is still being written; a moment.");
        return Vec::new();
    }
    if let Some((field, why)) = state.editor().first_error() {
        let why = format!("{}: {why}", field.label());
        state.editor_mut().marked = field;
        state.warn(why);
        return Vec::new();
    }
    match state.screen {
        Screen::Pareto => judge(state),
        Screen::Stability => try_all(state),
        _ => sweep(state),
    }
}

fn judge(state: &mut State) -> Vec<Effect> {
    let Some(plan) = state.pareto.plan.accuracy_plan() else {
        return Vec::new();
    };
    state.pareto.begin(&plan, state.clock);
    vec![Effect::Start(Box::new(Work::Accuracy(plan)))]
}

fn try_all(state: &mut State) -> Vec<Effect> {
    let Some(plan) = state.stability.plan.stability_plan() else {
        return Vec::new();
    };
    state.stability.begin(&plan, state.clock);
    vec![Effect::TryAll(Box::new(plan))]
}

fn sweep(state: &mut State) -> Vec<Effect> {
    let Some(plan) = state.plan.plan() else {
        return Vec::new();
    };
    state.sweep = Sweep::beginning(state.clock);
    state.held.clear();
    state.table = TableView::default();
    state.charts.source = Source::Live;
    state.charts.panel = 0;
    focus(state, Panel::Runs);
    vec![Effect::Start(Box::new(Work::Sweep(plan)))]
}
