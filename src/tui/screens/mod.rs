//! The screens, one file each, and what several of them draw.

use ratatui::Frame;
use ratatui::layout::Rect;

use super::state::{Screen, State};

mod axis;
pub mod chart;
pub mod charts;
pub mod configuration;
pub mod details;
pub mod help;
pub mod inspect;
pub mod overlays;
pub mod pareto;
mod pareto_chart;
pub mod preview;
pub mod reports;
pub mod slice;
pub mod stability;
pub mod steps;
mod strokes;
pub mod sweep;
pub mod table;

/// Draws the body of the screen that is shown.
pub fn body(state: &State, frame: &mut Frame, area: Rect) {
    match state.screen {
        Screen::Sweep => sweep::draw(state, frame, area),
        Screen::Preview => preview::draw(state, frame, area),
        Screen::Inspect => inspect::draw(state, frame, area),
        Screen::Charts => charts::draw(state, frame, area),
        Screen::Pareto => pareto::draw(state, frame, area),
        Screen::Stability => stability::draw(state, frame, area),
        Screen::Reports => reports::draw(state, frame, area),
        Screen::Help => help::draw(state, frame, area),
    }
}
