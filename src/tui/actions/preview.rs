//! Actions on the picture.

use crate::tui::keymap::Action;
use crate::tui::picture::Orbit;
use crate::tui::state::{Screen, State};
use crate::tui::update::Effect;

/// Radians a key turns: a full turn has 36 of them.
const TURN: f32 = std::f32::consts::TAU / 36.0;

/// The distance a key zooms by.
const ZOOM: f32 = 1.15;

/// Nearest and farthest distance over the camera's own: beyond it nothing is left to see.
const ZOOM_RANGE: (f32, f32) = (0.05, 20.0);

/// Least and greatest tilt; further on, the camera stands at a pole anyway.
const TILT: f32 = std::f32::consts::PI;

pub(super) fn apply(state: &mut State, action: Action) -> Vec<Effect> {
    let wish = &mut state.picture.wish;
    let orbit = &mut wish.orbit;
    match action {
        Action::Left => orbit.azimuth -= TURN,
        Action::Right => orbit.azimuth += TURN,
        Action::Up => orbit.elevation = (orbit.elevation + TURN).min(TILT),
        Action::Down => orbit.elevation = (orbit.elevation - TURN).max(-TILT),
        Action::PageUp => orbit.zoom = (orbit.zoom / ZOOM).max(ZOOM_RANGE.0),
        Action::PageDown => orbit.zoom = (orbit.zoom * ZOOM).min(ZOOM_RANGE.1),
        Action::First => *orbit = Orbit::HOME,
        Action::NextAccel => wish.step_accel(1),
        Action::PreviousAccel => wish.step_accel(-1),
        Action::NextKernel => wish.step_kernel(),
        Action::Finer | Action::Coarser => step_n(state, action),
        Action::Back => state.screen = Screen::Sweep,
        _ => {}
    }
    Vec::new()
}

fn step_n(state: &mut State, action: Action) {
    let wish = &mut state.picture.wish;
    let changed = wish.step_n(if action == Action::Finer { 1 } else { -1 });
    let has_n = wish.has_n();
    let name = wish.accel.name.clone();
    if !has_n {
        state.say(format!(
            "{name} has no grid; a chooses another accelerator."
        ));
    } else if !changed {
        state.say("No further: n goes from 1 to 512, and auto.");
    }
}
