//! Actions on the stability map.

use super::{focus, lines};
use crate::lab::NRule;
use crate::lab::stability::Reproducer;
use crate::tui::inspect::{Aim, Made, Side, Source, Subject};
use crate::tui::keymap::Action;
use crate::tui::stability::{Reproduced, Wanted};
use crate::tui::state::{Panel, State};
use crate::tui::update::Effect;
use std::sync::Arc;

pub(super) fn apply(state: &mut State, action: Action) -> Vec<Effect> {
    let map = &mut state.stability;
    match action {
        Action::Open => return wanted(state, false),
        Action::Export => return wanted(state, true),
        Action::NextFault | Action::PreviousFault => {
            if !map.seek(if action == Action::NextFault { 1 } else { -1 }) {
                state.say("No cell of this map fails.");
            }
        }
        Action::Turn => map.turn(),
        Action::NextAccel => map.step_accel(1),
        Action::PreviousAccel => map.step_accel(-1),
        Action::NextKernel => map.step_kernel(),
        Action::Left => {
            map.step(0, -1);
        }
        Action::Right => {
            map.step(0, 1);
        }
        Action::Back => focus(state, Panel::Plan),
        _ => {
            if let Some(lines) = lines(action) {
                let moved = map.step(lines, 0);
                // One line above the first is the plan.
                if !moved && action == Action::Up {
                    focus(state, Panel::Plan);
                }
            }
        }
    }
    Vec::new()
}

/// Asks for the failure of the marked cell to be made again.
fn wanted(state: &mut State, export: bool) -> Vec<Effect> {
    let Some(cell) = state.stability.marked() else {
        state.say("This cell is not tried, or not yet.");
        return Vec::new();
    };
    if cell.witness.is_none() {
        state.say("Nothing was wrong here; n goes to the next cell that fails.");
        return Vec::new();
    }
    let wanted = Wanted {
        cell: cell.clone(),
        seed: state.stability.seed,
        export,
    };
    state.say("Looking for the least scene that still fails ...");
    vec![Effect::Reproduce(Box::new(wanted))]
}

/// Takes in a failure that was made again.
pub(in crate::tui) fn reproduced(state: &mut State, news: Reproduced) {
    match news {
        Reproduced::Found(least) => {
            state.notice = None;
            inspect(state, *least);
        }
        Reproduced::Written(said) => state.say(said),
        Reproduced::Failed(why) => state.warn(why),
    }
}

/// Opens the inspector on the ray, in the accelerator that fails.
fn inspect(state: &mut State, least: Reproducer) {
    let Some(ray) = least.rays.first() else {
        return state.warn("There is no ray that fails on its own.");
    };
    let at = match least.rung.as_str() {
        "" => String::new(),
        rung => format!(" at {rung}"),
    };
    let subject = Subject {
        source: Source::Made(Made {
            name: format!("{}{at}", least.case),
            mesh: Arc::clone(&least.mesh),
        }),
        aim: Aim::Ray(*ray),
        origin: format!(
            "{}, {} triangles are enough",
            least.fault.name(),
            least.mesh.len()
        ),
        kernel: least.kernel,
    };
    let side = Side {
        accel: least.accel,
        n: NRule::Fixed(least.n),
    };
    super::inspect::open(state, subject, side);
}
