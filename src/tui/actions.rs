//! What actions do: those that mean the same everywhere here, the others a file for each place.

mod charts;
mod inspect;
mod overlays;
mod pareto;
mod plan;
mod preview;
mod reports;
mod runs;
mod stability;

use super::keymap::{Action, Place};
use super::state::{Experiment, Panel, Phase, Screen, State};
use super::update::{Effect, quit};
use crate::lab;

pub(super) use inspect::open_middle;
pub(super) use overlays::typed;
pub(super) use stability::reproduced;

/// How many lines a page has, whatever the screen's size.
const PAGE: isize = 10;

/// Performs `action` in `place`.
pub(super) fn apply(state: &mut State, place: Place, action: Action) -> Vec<Effect> {
    match action {
        Action::Quit => quit(state),
        Action::Suspend => vec![Effect::Suspend],
        Action::Repaint => vec![Effect::Repaint],
        _ => match place {
            Place::Pick | Place::Text | Place::Details | Place::Confirm => {
                overlays::apply(state, place, action)
            }
            _ => screen(state, place, action),
        },
    }
}

/// What means the same on every screen; the rest goes to the place.
fn screen(state: &mut State, place: Place, action: Action) -> Vec<Effect> {
    match action {
        Action::Help => show(state, Screen::Help),
        Action::NextScreen => show(state, state.screen.turned(1)),
        Action::PreviousScreen => show(state, state.screen.turned(-1)),
        Action::Screen(number) => {
            let at = usize::from(number).saturating_sub(1);
            Screen::ALL
                .get(at)
                .map_or_else(Vec::new, |&s| show(state, s))
        }
        Action::Pause => pause(state),
        Action::Stop => stop(state),
        Action::Write => write(state),
        Action::Expand => {
            state.expanded = !state.expanded;
            Vec::new()
        }
        Action::Freeze => freeze(state),
        Action::MoreSamples => samples(state, 2.0),
        Action::FewerSamples => samples(state, 0.5),
        Action::Channel => {
            state.picture.wish.step_channel();
            let channel = state.picture.wish.channel;
            state.say(format!("Picture: {} - {}", channel.name, channel.about));
            Vec::new()
        }
        Action::Symbols => {
            state.picture.wish.step_symbols();
            let symbols = state.picture.wish.symbols;
            state.say(format!("Symbols: {} - {}", symbols.name, symbols.about));
            Vec::new()
        }
        Action::NextScene | Action::PreviousScene => {
            let steps = if action == Action::NextScene { 1 } else { -1 };
            let plan = state.plan.items(super::plan_editor::Field::Scenes);
            state.picture.wish.step_scene(&plan, steps);
            Vec::new()
        }
        Action::Back if state.expanded => {
            state.expanded = false;
            Vec::new()
        }
        _ => match place {
            Place::Plan | Place::OtherPlan => plan::apply(state, action),
            Place::Points | Place::Configuration => pareto::apply(state, place, action),
            Place::Map => stability::apply(state, action),
            Place::Runs => runs::apply(state, action),
            Place::Preview | Place::Aim => preview::apply(state, place, action),
            Place::Inspect => inspect::apply(state, action),
            Place::Charts => charts::apply(state, action),
            Place::Reports => reports::apply(state, action),
            _ => help(state, action),
        },
    }
}

/// Lines that `action` moves a list by; `None` for actions that are no moves. The ends are beyond every list.
fn lines(action: Action) -> Option<isize> {
    match action {
        Action::Up => Some(-1),
        Action::Down => Some(1),
        Action::PageUp => Some(-PAGE),
        Action::PageDown => Some(PAGE),
        Action::First => Some(isize::MIN / 2),
        Action::Last => Some(isize::MAX / 2),
        _ => None,
    }
}

fn show(state: &mut State, screen: Screen) -> Vec<Effect> {
    if screen == Screen::Help && state.screen != Screen::Help {
        state.before_help = state.screen;
        state.help_line = 0;
    }
    if screen != state.screen {
        state.expanded = false;
    }
    state.screen = screen;
    if screen == Screen::Reports {
        vec![Effect::List]
    } else {
        Vec::new()
    }
}

fn help(state: &mut State, action: Action) -> Vec<Effect> {
    if action == Action::Back {
        return show(state, state.before_help);
    }
    if let Some(lines) = lines(action) {
        let last = super::screens::help::last_line(state);
        state.help_line = state
            .help_line
            .min(last)
            .saturating_add_signed(lines)
            .min(last);
    }
    Vec::new()
}

fn pause(state: &mut State) -> Vec<Effect> {
    match state.phase_mut() {
        Some(phase @ Phase::Running) => {
            *phase = Phase::Paused;
            vec![Effect::Pause(true)]
        }
        Some(phase @ Phase::Paused) => {
            *phase = Phase::Running;
            vec![Effect::Pause(false)]
        }
        _ => {
            state.say("Nothing is being measured. On screen 1, Enter starts a sweep.");
            Vec::new()
        }
    }
}

fn stop(state: &mut State) -> Vec<Effect> {
    match state.phase_mut() {
        Some(phase @ (Phase::Running | Phase::Paused)) => {
            *phase = Phase::Stopping;
            state.say("Stopping after what is in work; what is finished is kept.");
            vec![Effect::Stop]
        }
        Some(_) => {
            state.say("Already stopping.");
            Vec::new()
        }
        None => {
            state.say("Nothing is being measured.");
            Vec::new()
        }
    }
}

fn write(state: &mut State) -> Vec<Effect> {
    let (of, measured) = match state.screen {
        Screen::Pareto => (Experiment::Accuracy, !state.pareto.runs.is_empty()),
        _ => (Experiment::Sweep, state.sweep.runs.finished().0 > 0),
    };
    if !measured {
        state.say("There is no finished run to write yet.");
        return Vec::new();
    }
    state.say("Writing the report ...");
    if let Some(kept) = state.kept_mut(of) {
        kept.writing = true;
    }
    vec![Effect::Write(of)]
}

fn freeze(state: &mut State) -> Vec<Effect> {
    state.frozen = !state.frozen;
    for event in std::mem::take(&mut state.held) {
        if let lab::Event::Sampled {
            done, seconds_left, ..
        } = &event
            && state.sweep.is_running()
        {
            state.sweep.done = done.clamp(0.0, 1.0);
            state.sweep.seconds_left = Some(*seconds_left);
        }
        state.sweep.runs.take(&event);
    }
    state.stability.catch_up();
    state.pareto.catch_up(state.clock);
    Vec::new()
}

fn samples(state: &mut State, factor: f64) -> Vec<Effect> {
    state.plan.scale_samples(factor);
    let text = state.plan.text(super::plan_editor::Field::Samples);
    let when = if state.sweep.is_running() {
        "from the next sweep on"
    } else {
        "Enter runs the plan"
    };
    let sentence = format!("{text} samples a run; {when}.");
    state.say(sentence);
    Vec::new()
}

/// Moves the keys to a panel of the screen that is shown.
fn focus(state: &mut State, panel: Panel) {
    match state.screen {
        Screen::Pareto => state.pareto.panel = panel,
        Screen::Stability => state.stability.panel = panel,
        _ => state.panel = panel,
    }
}
