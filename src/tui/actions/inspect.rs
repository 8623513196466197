//! Actions on the inspected ray.

use super::lines;
use crate::preview::pixel_size;
use crate::tui::inspect::{Aim, Side, Source, Subject};
use crate::tui::keymap::Action;
use crate::tui::layout;
use crate::tui::overlay::Overlay;
use crate::tui::screens::steps;
use crate::tui::state::{Screen, State};
use crate::tui::update::Effect;

/// What a key zooms by.
const ZOOM: f64 = 1.5;

pub(super) fn apply(state: &mut State, action: Action) -> Vec<Effect> {
    let inspect = &mut state.inspect;
    match action {
        Action::Open => match steps::facts(inspect) {
            Some(facts) => state.overlays.push(Overlay::Details(Box::new(facts), 0)),
            None => state.say("There is no step to show."),
        },
        Action::Left => inspect.focus = 0,
        Action::Right => inspect.focus = 1,
        Action::Plane => inspect.step_plane(),
        Action::ZoomIn => zoom(state, ZOOM),
        Action::ZoomOut => zoom(state, 1.0 / ZOOM),
        Action::NextAccel => inspect.step_accel(1),
        Action::PreviousAccel => inspect.step_accel(-1),
        Action::NextKernel => inspect.step_kernel(),
        Action::Finer | Action::Coarser => step_n(state, action),
        Action::Back => state.screen = state.before_inspect,
        _ => {
            if let Some(lines) = lines(action) {
                inspect.step(lines);
            }
        }
    }
    Vec::new()
}

fn zoom(state: &mut State, factor: f64) {
    if !state.inspect.step_zoom(factor) {
        let text = if factor < 1.0 {
            "The whole way is shown."
        } else {
            "No closer: t has no more digits."
        };
        state.say(text);
    }
}

fn step_n(state: &mut State, action: Action) {
    let inspect = &mut state.inspect;
    let changed = inspect.step_n(if action == Action::Finer { 1 } else { -1 });
    let side = &inspect.sides[inspect.focus];
    if !side.has_n() {
        let name = side.accel.name.clone();
        state.say(format!(
            "{name} has no grid; a chooses another accelerator."
        ));
    } else if !changed {
        state.say("No further: n goes from 1 to 512, and auto.");
    }
}

/// Opens the inspector on a ray, in an accelerator, from the screen that is shown.
pub(super) fn open(state: &mut State, subject: Subject, side: Side) {
    state.before_inspect = state.screen;
    state.screen = Screen::Inspect;
    state.expanded = false;
    state.inspect.open(subject, side);
}

/// Opens the ray through a cell of the picture.
pub(super) fn open_cell(state: &mut State, cell: (u16, u16)) {
    let Some(cells) = layout::picture_cells(state) else {
        return;
    };
    let (subject, side) = through(state, cell, cells);
    open(state, subject, side);
}

/// Where no ray was chosen: the one through the middle of the picture.
pub(in crate::tui) fn open_middle(state: &mut State) {
    // A picture of any size has the same middle.
    let (subject, side) = through(state, (40, 20), (80, 40));
    state.inspect.open(subject, side);
}

/// The ray through the pixel in the middle of a cell, with what the picture is seen through.
fn through(state: &State, cell: (u16, u16), cells: (u16, u16)) -> (Subject, Side) {
    let wish = &state.picture.wish;
    let (width, height) = pixel_size(cells.0, cells.1, &wish.symbols);
    let pixel = |at: u16, cells: u16, pixels: u32| {
        let middle = (f64::from(at) + 0.5) * f64::from(pixels) / f64::from(cells.max(1));
        (middle as u32).min(pixels.saturating_sub(1))
    };
    let (x, y) = (
        pixel(cell.0, cells.0, width),
        pixel(cell.1, cells.1, height),
    );
    let subject = Subject {
        source: Source::Spec(wish.scene.clone(), wish.place),
        aim: Aim::Point {
            orbit: wish.orbit,
            at: (x as f32 + 0.5, y as f32 + 0.5),
            size: (width, height),
        },
        origin: format!("pixel {x},{y} of {width}x{height}"),
        kernel: wish.kernel.clone(),
    };
    let side = Side {
        accel: wish.accel.clone(),
        n: wish.n,
    };
    (subject, side)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::fixture;
    use crate::tui::keymap::Key;
    use crate::tui::update::{Event, update};
    use crossterm::event::KeyCode;

    fn press(state: &mut State, code: KeyCode) -> Vec<Effect> {
        update(state, Event::Key(Key::code(code).event()))
    }

    #[test]
    fn a_cursor_in_the_picture_opens_the_ray_under_it_and_escape_leads_back() {
        let mut state = fixture::sized(80, 24);
        state.screen = Screen::Preview;
        press(&mut state, KeyCode::Enter);
        press(&mut state, KeyCode::Right);
        press(&mut state, KeyCode::Up);
        let effects = press(&mut state, KeyCode::Enter);
        assert_eq!(state.screen, Screen::Inspect);
        let Some(Effect::Inspect(request)) = effects.last() else {
            panic!("{effects:?}");
        };
        let (columns, rows) = (80 - 29 - 2, 24 - 3 - 2);
        let (width, height) = pixel_size(columns, rows, &state.picture.wish.symbols);
        let Aim::Point { at, size, .. } = request.subject.aim else {
            panic!("{request:?}");
        };
        assert_eq!(size, (width, height));
        let cell = (
            at.0 * f32::from(columns) / width as f32,
            at.1 * f32::from(rows) / height as f32,
        );
        assert_eq!(
            (cell.0 as u16, cell.1 as u16),
            (columns / 2 + 1, rows / 2 - 1)
        );
        press(&mut state, KeyCode::Esc);
        assert_eq!(state.screen, Screen::Preview);
        press(&mut state, KeyCode::Esc);
        assert_eq!(state.picture.cursor, None);
    }

    #[test]
    fn without_a_chosen_ray_the_screen_shows_the_middle_of_the_picture() {
        let mut state = fixture::sized(80, 24);
        let effects = update(&mut state, Event::Key(Key::char('3').event()));
        let Some(Effect::Inspect(request)) = effects.last() else {
            panic!("{effects:?}");
        };
        let Aim::Point { at, size, .. } = request.subject.aim else {
            panic!("{request:?}");
        };
        let off = |at: f32, size: u32| (at / size as f32 - 0.5).abs();
        assert!(off(at.0, size.0) < 0.02 && off(at.1, size.1) < 0.02);
    }

    #[test]
    fn the_ray_is_asked_for_once_and_again_when_an_accelerator_changes() {
        let mut state = fixture::sized(80, 24);
        update(&mut state, Event::Key(Key::char('3').event()));
        assert!(update(&mut state, Event::Clock(1.0)).is_empty());
        let effects = update(&mut state, Event::Key(Key::char('a').event()));
        assert!(matches!(effects.last(), Some(Effect::Inspect(r)) if r.serial == 2));
    }

    #[test]
    fn walking_one_side_takes_the_other_to_the_same_place_along_the_ray() {
        let mut state = fixture::inspected();
        state.inspect.focus = 1;
        let mut seen = Vec::new();
        for _ in 0..40 {
            press(&mut state, KeyCode::Down);
            let [bvh, grid] = [0, 1].map(|side| {
                let inspection = &state.inspect.examined(side).unwrap().inspection;
                inspection.steps[state.inspect.marked[side]].entry
            });
            assert!(bvh <= grid);
            seen.push(state.inspect.marked[0]);
        }
        seen.dedup();
        assert!(seen.len() > 1, "{seen:?}");
    }
}
