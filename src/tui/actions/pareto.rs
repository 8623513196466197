//! Actions on the judged methods.

use super::lines;
use crate::tui::inspect::{Aim, Side, Source, Subject};
use crate::tui::keymap::{Action, Place};
use crate::tui::pareto::Point;
use crate::tui::picture::Orbit;
use crate::tui::state::{Panel, Screen, State};
use crate::tui::update::Effect;

pub(super) fn apply(state: &mut State, place: Place, action: Action) -> Vec<Effect> {
    if place == Place::Configuration {
        return configuration(state, action);
    }
    match action {
        Action::Open => open(state),
        Action::Sort => {
            let marked = marked(state).map(|point| point.run.id);
            state.pareto.sort_by_next();
            // The mark stays on its method.
            if let Some(shown) = state.pareto.shown(state.judged()) {
                let at = shown
                    .points
                    .iter()
                    .position(|p| Some(&p.run.id) == marked.as_ref());
                state.pareto.marked = at.unwrap_or(0);
            }
            let sentence = format!("Sorted by {}.", state.pareto.order.name());
            state.say(sentence);
        }
        Action::Left => turn(state, 0, -1),
        Action::Right => turn(state, 0, 1),
        Action::PreviousScene => turn(state, -1, 0),
        Action::NextScene => turn(state, 1, 0),
        Action::Back => state.pareto.panel = Panel::Plan,
        _ => {
            if let Some(lines) = lines(action) {
                step(state, action, lines);
            }
        }
    }
    Vec::new()
}

/// The marked point.
fn marked(state: &State) -> Option<Point> {
    let shown = state.pareto.shown(state.judged())?;
    let at = state.pareto.marked.min(shown.points.len().checked_sub(1)?);
    shown.points.into_iter().nth(at)
}

fn step(state: &mut State, action: Action, lines: isize) {
    let count = state
        .pareto
        .shown(state.judged())
        .map_or(0, |shown| shown.points.len());
    let last = count.saturating_sub(1);
    let from = state.pareto.marked.min(last);
    let to = from.saturating_add_signed(lines).min(last);
    state.pareto.marked = to;
    // One line above the first is the plan.
    if to == from && action == Action::Up {
        state.pareto.panel = Panel::Plan;
    }
}

/// Another course, or another place of the one that is shown; the mark stays on its method.
fn turn(state: &mut State, courses: isize, places: isize) {
    let Some(shown) = state.pareto.shown(state.judged()) else {
        return state.say("Nothing is judged yet; Enter on the plan runs it.");
    };
    let label = marked(state).map(|point| point.judged.label);
    let round = |(at, of): (usize, usize), steps: isize| {
        (at as isize - 1 + steps).rem_euclid(of as isize) as usize
    };
    state.pareto.course = round(shown.at[0], courses);
    state.pareto.place = if courses == 0 {
        round(shown.at[1], places)
    } else {
        0
    };
    let of = if courses == 0 {
        shown.at[1].1
    } else {
        shown.at[0].1
    };
    if of == 1 {
        let what = if courses == 0 {
            "There is only one offset here; the plan has a line for more."
        } else {
            "There is only one scene and ray set here; the plan has lines for more."
        };
        state.say(what);
    }
    if let Some(shown) = state.pareto.shown(state.judged()) {
        let at = shown
            .points
            .iter()
            .position(|p| Some(&p.judged.label) == label.as_ref());
        state.pareto.marked = at.unwrap_or(state.pareto.marked);
    }
}

/// Opens the marked configuration; the picture shows the scene through it.
fn open(state: &mut State) {
    let Some(point) = marked(state) else {
        return state.say("There is no method to open yet.");
    };
    let wish = &mut state.picture.wish;
    let run = &point.run;
    if wish.scene != run.scene {
        run.scene.clone_into(&mut wish.scene);
        wish.orbit = Orbit::HOME;
    }
    wish.place = point.place();
    (wish.accel, wish.n, wish.kernel) = point.configuration();
    state.picture.cursor = None;
    state.pareto.opened = Some(Box::new(point));
}

fn configuration(state: &mut State, action: Action) -> Vec<Effect> {
    match action {
        Action::Aim => super::preview::aim(state),
        Action::Inspect => inspect(state),
        Action::Back => {
            state.pareto.opened = None;
            state.picture.cursor = None;
        }
        _ => {}
    }
    Vec::new()
}

/// Opens the inspector on the first ray of the set that the method decides wrongly.
fn inspect(state: &mut State) {
    let Some(point) = state.pareto.opened.clone() else {
        return;
    };
    if point.judged.accuracy.wrong() == 0 {
        return state.say(
            "It decided every ray of the set right; Enter aims at a ray of the picture instead.",
        );
    }
    let Some((count, seed)) = state.judged_by().map(|plan| (plan.ray_count, plan.seed)) else {
        return;
    };
    let (accel, n, kernel) = point.configuration();
    let run = &point.run;
    let subject = Subject {
        source: Source::Spec(run.scene.clone(), point.place()),
        aim: Aim::Wrong {
            rays: run.rays.clone(),
            count,
            seed,
        },
        origin: format!("the first of the {} rays that is decided wrongly", run.rays),
        kernel,
    };
    super::inspect::open(state, subject, Side { accel, n });
    debug_assert_eq!(state.screen, Screen::Inspect);
}
