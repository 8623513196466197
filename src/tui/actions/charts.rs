//! Actions on the charts.

use super::lines;
use crate::report::series::{Quantity, panels};
use crate::tui::keymap::Action;
use crate::tui::state::{ChartLine, Screen, Source, State};
use crate::tui::update::Effect;

pub(super) fn apply(state: &mut State, action: Action) -> Vec<Effect> {
    match action {
        Action::Left => turn(state, -1),
        Action::Right => turn(state, 1),
        Action::Back => state.screen = Screen::Sweep,
        _ => {
            if let Some(lines) = lines(action) {
                let last = ChartLine::ALL.len() - 1;
                let at = ChartLine::ALL
                    .iter()
                    .position(|&l| l == state.charts.marked);
                let to = at.unwrap_or(0).saturating_add_signed(lines).min(last);
                state.charts.marked = ChartLine::ALL[to];
            }
        }
    }
    Vec::new()
}

/// Turns the value of the marked line.
fn turn(state: &mut State, steps: isize) {
    let round = |at: usize, len: usize| (at as isize + steps).rem_euclid(len as isize) as usize;
    match state.charts.marked {
        ChartLine::Quantity => {
            let all = Quantity::ALL;
            let at = all.iter().position(|&q| q == state.charts.quantity);
            state.charts.quantity = all[round(at.unwrap_or(0), all.len())];
        }
        ChartLine::Panel => {
            let panels = panels(&state.charted().built()).len();
            if panels > 1 {
                state.charts.panel = round(state.charts.panel.min(panels - 1), panels);
            } else {
                state.say("There is only one group of runs to chart.");
            }
        }
        ChartLine::Source if state.reports.opened.is_some() => {
            state.charts.panel = 0;
            state.charts.source = match state.charts.source {
                Source::Live => Source::Opened,
                Source::Opened => Source::Live,
            };
        }
        ChartLine::Source => {
            let number = Screen::Reports.number();
            state.say(format!("No report is open; screen {number} opens one."));
        }
    }
}
