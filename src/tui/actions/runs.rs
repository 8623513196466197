//! Actions on the table of runs.

use super::{focus, lines};
use crate::tui::keymap::Action;
use crate::tui::overlay::{Overlay, Purpose, TextField};
use crate::tui::screens::details;
use crate::tui::state::{Panel, State};
use crate::tui::update::Effect;

pub(super) fn apply(state: &mut State, action: Action) -> Vec<Effect> {
    match action {
        Action::Open => match state.table.marked_row(&state.sweep.runs.rows) {
            Some(row) => {
                let facts = Box::new(details::facts(row));
                state.overlays.push(Overlay::Details(facts, 0));
            }
            None => state.say("There is no run to show yet."),
        },
        Action::Sort => {
            state.table.sort_by_next();
            let sentence = format!("Sorted by {}.", state.table.sort.sort_name());
            state.say(sentence);
        }
        Action::Filter => {
            let text = state.table.filter.clone();
            let field = TextField::new(Purpose::RunsFilter, &text);
            state.overlays.push(Overlay::Text(field));
        }
        Action::Left => state.table.scroll(-1),
        Action::Right => state.table.scroll(1),
        Action::Back if !state.table.filter.is_empty() => state.table.filter.clear(),
        Action::Back => focus(state, Panel::Plan),
        _ => {
            if let Some(lines) = lines(action) {
                let moved = state.table.step(&state.sweep.runs.rows, lines);
                // One line above the first is the plan.
                if !moved && action == Action::Up {
                    focus(state, Panel::Plan);
                }
            }
        }
    }
    Vec::new()
}
