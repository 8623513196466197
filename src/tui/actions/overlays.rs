//! Actions on what lies over a screen.

use super::{lines, plan};
use crate::tui::keymap::{Action, Place};
use crate::tui::overlay::{Overlay, Purpose, TextField};
use crate::tui::picture::Orbit;
use crate::tui::plan_editor::Field;
use crate::tui::state::State;
use crate::tui::update::Effect;

pub(super) fn apply(state: &mut State, place: Place, action: Action) -> Vec<Effect> {
    match (place, action) {
        (Place::Confirm, Action::Accept) => {
            state.quitting = true;
            return vec![Effect::Quit];
        }
        (Place::Confirm, Action::Refuse) | (Place::Details, Action::Back) => {
            state.overlays.pop();
        }
        (Place::Details, _) => {
            let last = super::super::screens::details::last_line(state);
            if let (Some(lines), Some(Overlay::Details(_, line))) =
                (lines(action), state.overlays.last_mut())
            {
                *line = (*line).min(last).saturating_add_signed(lines).min(last);
            }
        }
        (Place::Pick, _) => pick(state, action),
        (Place::Text, _) => text(state, action),
        _ => {}
    }
    Vec::new()
}

fn pick(state: &mut State, action: Action) {
    let Some(Overlay::Pick(pick)) = state.overlays.last_mut() else {
        return;
    };
    match action {
        Action::Toggle => pick.toggle(),
        Action::ToggleAll => pick.toggle_all(),
        Action::Filter => {
            let field = TextField::new(Purpose::PickFilter, &pick.filter);
            state.overlays.push(Overlay::Text(field));
        }
        Action::Accept => {
            let (field, line) = (pick.field, pick.text());
            state.overlays.pop();
            set_line(state, field, &line);
        }
        Action::Type => {
            let (field, line) = (pick.field, pick.text());
            state.overlays.pop();
            set_line(state, field, &line);
            plan::type_line(state, field);
        }
        Action::Back => {
            state.overlays.pop();
        }
        _ => {
            if let Some(lines) = lines(action) {
                pick.step(lines);
            }
        }
    }
}

/// Sets a line of the plan; the picture follows to a scene that the plan has.
fn set_line(state: &mut State, field: Field, line: &str) {
    state.editor_mut().set(field, line);
    let scenes = state.editor().items(Field::Scenes);
    let shown = scenes.contains(&state.picture.wish.scene);
    if field == Field::Scenes
        && state.editor().error(field).is_none()
        && !shown
        && let Some(first) = scenes.first()
    {
        first.clone_into(&mut state.picture.wish.scene);
        state.picture.wish.orbit = Orbit::HOME;
    }
}

fn text(state: &mut State, action: Action) {
    let Some(Overlay::Text(field)) = state.overlays.last_mut() else {
        return;
    };
    match action {
        Action::Erase => field.input.erase(),
        Action::Clear => field.input.clear(),
        Action::Left => field.input.left(),
        Action::Right => field.input.right(),
        Action::First => field.input.home(),
        Action::Last => field.input.end(),
        Action::Accept => accept(state),
        Action::Back => {
            if let Some(Overlay::Text(field)) = state.overlays.pop() {
                take_over(state, field.purpose, &field.before);
            }
            return;
        }
        _ => {}
    }
    live(state);
}

/// A character goes into the text field.
pub(in crate::tui) fn typed(state: &mut State, c: char) {
    if let Some(Overlay::Text(field)) = state.overlays.last_mut() {
        field.input.insert(c);
        live(state);
    }
}

/// Filters act, and plan lines are checked, while they are typed.
fn live(state: &mut State) {
    let Some(Overlay::Text(field)) = state.overlays.last() else {
        return;
    };
    let (purpose, text) = (field.purpose, field.input.text().to_owned());
    if let Purpose::Line(line) = purpose {
        let mut trial = state.editor().clone();
        trial.set(line, &text);
        let error = trial.error(line).map(str::to_owned);
        if let Some(Overlay::Text(field)) = state.overlays.last_mut() {
            field.error = error;
        }
    } else {
        take_over(state, purpose, &text);
    }
}

/// Takes over what was typed; a line of the plan that cannot be run stays open and says why.
fn accept(state: &mut State) {
    let Some(Overlay::Text(field)) = state.overlays.last() else {
        return;
    };
    if field.error.is_some() {
        return;
    }
    let (purpose, text) = (field.purpose, field.input.text().to_owned());
    state.overlays.pop();
    take_over(state, purpose, &text);
}

fn take_over(state: &mut State, purpose: Purpose, text: &str) {
    match purpose {
        Purpose::Line(field) => set_line(state, field, text),
        Purpose::RunsFilter => {
            text.clone_into(&mut state.table.filter);
            state.table.marked = 0;
        }
        Purpose::ReportsFilter => {
            if let Some(report) = &mut state.reports.opened {
                text.clone_into(&mut report.table.filter);
                report.table.marked = 0;
            } else {
                text.clone_into(&mut state.reports.filter);
                state.reports.marked = 0;
            }
        }
        Purpose::PickFilter => {
            if let Some(Overlay::Pick(pick)) = last_pick(&mut state.overlays) {
                text.clone_into(&mut pick.filter);
                pick.marked = 0;
            }
        }
    }
}

fn last_pick(overlays: &mut [Overlay]) -> Option<&mut Overlay> {
    overlays
        .iter_mut()
        .rev()
        .find(|overlay| matches!(overlay, Overlay::Pick(_)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::fixture;
    use crate::tui::overlay::Pick;

    #[test]
    fn a_wrong_line_stays_open_with_its_reason_until_it_is_right_or_given_up() {
        let mut state = fixture::state();
        plan::type_line(&mut state, Field::Scenes);
        "x".chars().for_each(|c| typed(&mut state, c));
        apply(&mut state, Place::Text, Action::Accept);
        let Some(Overlay::Text(field)) = state.overlays.last() else {
            panic!("closed");
        };
        assert!(field.error.is_some());
        apply(&mut state, Place::Text, Action::Erase);
        apply(&mut state, Place::Text, Action::Accept);
        assert!(state.overlays.is_empty());
        assert_eq!(state.plan.first_error(), None);
    }

    #[test]
    fn escape_brings_a_filter_back_to_what_it_was() {
        let mut state = fixture::state();
        state.table.filter = "grid".to_owned();
        let field = TextField::new(Purpose::RunsFilter, "grid");
        state.overlays.push(Overlay::Text(field));
        typed(&mut state, 'x');
        assert_eq!(state.table.filter, "gridx");
        apply(&mut state, Place::Text, Action::Back);
        assert_eq!(state.table.filter, "grid");
    }

    #[test]
    fn the_picture_follows_the_plan_to_another_scene() {
        let mut state = fixture::state();
        state
            .overlays
            .push(Overlay::Pick(Pick::new(&state.plan, Field::Scenes)));
        set_line(&mut state, Field::Scenes, "soup:10");
        assert_eq!(state.picture.wish.scene, "soup:10");
    }
}
