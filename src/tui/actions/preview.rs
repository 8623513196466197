//! Actions on the picture.

use crate::tui::keymap::{Action, Place};
use crate::tui::layout;
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

/// Rows that a page moves the cursor by.
const FAR: i32 = 5;

pub(super) fn apply(state: &mut State, place: Place, action: Action) -> Vec<Effect> {
    if place == Place::Aim {
        cursor(state, action);
        return Vec::new();
    }
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
        Action::Aim => aim(state),
        Action::Back => state.screen = Screen::Sweep,
        _ => {}
    }
    Vec::new()
}

/// Puts the cursor into the picture.
pub(super) fn aim(state: &mut State) {
    state.picture.cursor = Some(state.picture.cursor.unwrap_or_else(|| middle(state)));
}

/// The cell in the middle of the picture.
fn middle(state: &State) -> (u16, u16) {
    layout::picture_cells(state).map_or((0, 0), |(columns, rows)| (columns / 2, rows / 2))
}

fn cursor(state: &mut State, action: Action) {
    let Some((columns, rows)) = layout::picture_cells(state) else {
        return;
    };
    // The picture may have become smaller.
    let (x, y) = state.picture.cursor.unwrap_or_else(|| middle(state));
    let (mut x, mut y) = (i32::from(x), i32::from(y));
    match action {
        Action::Open => return super::inspect::open_cell(state, (x as u16, y as u16)),
        Action::Back => {
            state.picture.cursor = None;
            return;
        }
        Action::First => (x, y) = (i32::from(columns) / 2, i32::from(rows) / 2),
        Action::Left => x -= 1,
        Action::Right => x += 1,
        Action::Up => y -= 1,
        Action::Down => y += 1,
        Action::PageUp => y -= FAR,
        Action::PageDown => y += FAR,
        _ => {}
    }
    let within = |at: i32, cells: u16| at.clamp(0, i32::from(cells) - 1) as u16;
    state.picture.cursor = Some((within(x, columns), within(y, rows)));
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
