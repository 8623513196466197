//! What happens to the state: events in, effects out. Nothing here draws, waits, or touches a file.

use std::path::PathBuf;

use crossterm::event::KeyEvent;

use super::actions;
use super::inspect::{self, InspectNews};
use super::keymap::{self, Key, Place};
use super::layout;
use super::overlay::Overlay;
use super::picture::{PictureNews, Request};
use super::runner::{Keeping, Work};
use super::stability::{Reproduced, Wanted};
use super::state::{BundleRow, Experiment, Opened, Phase, Screen, State};
use crate::lab::stability::{StabilityEvent, StabilityPlan};
use crate::lab::{self, AccuracyEvent};
use crate::report::Report;

/// What can happen.
#[derive(Debug, Clone)]
pub enum Event {
    /// A key was pressed.
    Key(KeyEvent),
    /// A text was pasted.
    Paste(String),
    /// The terminal has another size: columns and rows.
    Resize(u16, u16),
    /// So many seconds have passed since the start.
    Clock(f64),
    /// The running sweep tells something.
    Lab(lab::Event),
    /// Methods that are being judged: something is told.
    Judged(AccuracyEvent),
    /// What becomes of what an experiment measures.
    Kept(Experiment, Keeping),
    /// The picture thread tells something.
    Picture(PictureNews),
    /// The examiner tells something.
    Inspect(InspectNews),
    /// The running stability suite tells something.
    Trial(StabilityEvent),
    /// It has ended, stopped or complete; or why it broke off.
    TrialsEnded(Result<bool, String>),
    /// A failure was made again, or could not be.
    Reproduced(Reproduced),
    /// The bundles in the results directory, or why there is no list.
    Listed(Result<Vec<BundleRow>, String>),
    /// A report was read, with the name of its bundle; or why not.
    Read(Result<(String, Box<Report>), String>),
}

/// What is to be done outside the state.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// Measure something.
    Start(Box<Work>),
    /// Let the sweep wait, or go on.
    Pause(bool),
    /// End the sweep.
    Stop,
    /// Write report and plots of what an experiment has measured so far.
    Write(Experiment),
    /// Show a picture.
    Render(Box<Request>),
    /// Follow a ray.
    Inspect(Box<inspect::Request>),
    /// Run the stability suite.
    TryAll(Box<StabilityPlan>),
    /// Make a failure again.
    Reproduce(Box<Wanted>),
    /// List the bundles.
    List,
    /// Read the report of a bundle.
    Read(PathBuf),
    /// Hand the terminal back to the shell until resumed.
    Suspend,
    /// Draw the whole screen again.
    Repaint,
    /// End the program.
    Quit,
}

/// Takes in an event; returns what is to be done.
pub fn update(state: &mut State, event: Event) -> Vec<Effect> {
    let mut effects = match event {
        Event::Key(key) => key_pressed(state, &key),
        Event::Paste(text) => {
            if state.place() == Place::Text {
                text.chars().for_each(|c| actions::typed(state, c));
            }
            Vec::new()
        }
        Event::Resize(columns, rows) => {
            state.size = (columns, rows);
            Vec::new()
        }
        Event::Clock(seconds) => {
            state.clock = seconds;
            Vec::new()
        }
        Event::Lab(event) => {
            lab_told(state, event);
            Vec::new()
        }
        Event::Judged(event) => {
            state.pareto.take(event, state.frozen, state.clock);
            Vec::new()
        }
        Event::Kept(of, keeping) => kept(state, of, keeping),
        Event::Picture(news) => {
            state.picture.take(news);
            Vec::new()
        }
        Event::Inspect(news) => {
            state.inspect.take(news);
            Vec::new()
        }
        Event::Trial(event) => {
            state.stability.take(event, state.frozen);
            Vec::new()
        }
        Event::TrialsEnded(ended) => {
            trials_ended(state, ended);
            Vec::new()
        }
        Event::Reproduced(news) => {
            actions::reproduced(state, news);
            Vec::new()
        }
        Event::Listed(result) => {
            listed(state, result);
            Vec::new()
        }
        Event::Read(result) => {
            match result {
                Ok((name, report)) => {
                    let number = Screen::Charts.number();
                    state.say(format!(
                        "Opened {name}: its curves are on screen {number}, Charts."
                    ));
                    state.reports.opened = Some(Opened::new(name, *report));
                    state.charts.source = super::state::Source::Opened;
                    state.charts.panel = 0;
                    state.pareto.look_at(state.reports.opened.as_ref());
                }
                Err(why) => state.warn(why),
            }
            Vec::new()
        }
    };
    if let Some(request) = layout::picture_cells(state).and_then(|cells| state.picture.ask(cells)) {
        effects.push(Effect::Render(Box::new(request)));
    }
    if state.screen == Screen::Inspect {
        if state.inspect.subject.is_none() {
            actions::open_middle(state);
        }
        if let Some(request) = state.inspect.ask() {
            effects.push(Effect::Inspect(Box::new(request)));
        }
    }
    effects
}

fn key_pressed(state: &mut State, event: &KeyEvent) -> Vec<Effect> {
    let Some(key) = Key::of(event) else {
        return Vec::new();
    };
    let place = state.place();
    match keymap::find(place, key) {
        Some(action) => {
            // A sentence has been read once the next key is pressed.
            state.notice = None;
            actions::apply(state, place, action)
        }
        None if place == Place::Text && !key.ctrl => {
            if let crossterm::event::KeyCode::Char(c) = key.code {
                actions::typed(state, c);
            }
            Vec::new()
        }
        None => Vec::new(),
    }
}

fn lab_told(state: &mut State, event: lab::Event) {
    let sweep = &mut state.sweep;
    match &event {
        lab::Event::Sampled {
            done, seconds_left, ..
        } if !state.frozen => {
            sweep.done = done.clamp(0.0, 1.0);
            sweep.seconds_left = Some(*seconds_left);
        }
        lab::Event::Ended { stopped } => {
            sweep.phase = if *stopped {
                Phase::Stopped
            } else {
                Phase::Complete
            };
            sweep.ended = Some(state.clock);
            sweep.seconds_left = None;
            if !stopped {
                sweep.done = 1.0;
            }
        }
        _ => {}
    }
    if state.frozen {
        state.held.push(event);
    } else {
        sweep.runs.take(&event);
    }
}

/// What becomes of what an experiment measures.
fn kept(state: &mut State, of: Experiment, keeping: Keeping) -> Vec<Effect> {
    let clock = state.clock;
    let Some(kept) = state.kept_mut(of) else {
        return Vec::new();
    };
    match keeping {
        Keeping::Made(dir) => kept.bundle = Some(dir),
        Keeping::Writing => kept.writing = kept.bundle.is_some() && kept.unsaved.is_none(),
        Keeping::Written(dir) => {
            (kept.writing, kept.unsaved) = (false, None);
            let said = format!("Report and plots are in {}.", dir.display());
            kept.bundle = Some(dir);
            state.say(said);
            return vec![Effect::List];
        }
        Keeping::Failed(why) => {
            (kept.writing, kept.unsaved) = (false, Some(why.clone()));
            state.warn(why);
        }
        Keeping::Broken(why) => {
            kept.writing = false;
            if of == Experiment::Accuracy {
                state.pareto.progress.end(true, clock);
            } else {
                state.sweep.phase = if state.sweep.runs.rows.is_empty() {
                    Phase::Idle
                } else {
                    Phase::Stopped
                };
                state.sweep.ended = Some(clock);
            }
            state.warn(why);
        }
    }
    Vec::new()
}

fn trials_ended(state: &mut State, ended: Result<bool, String>) {
    let clock = state.clock;
    match ended {
        Ok(stopped) => state.stability.progress.end(stopped, clock),
        Err(why) => {
            state.stability.progress.end(true, clock);
            state.stability.error = Some(why.clone());
            state.warn(why);
        }
    }
}

fn listed(state: &mut State, result: Result<Vec<BundleRow>, String>) {
    match result {
        Ok(bundles) => {
            state.reports.bundles = Some(bundles);
            state.reports.error = None;
        }
        Err(why) => state.reports.error = Some(why),
    }
    let last = state.reports.shown().count().saturating_sub(1);
    state.reports.marked = state.reports.marked.min(last);
}

/// Asks whether to quit, where something would be lost; otherwise quits.
pub(super) fn quit(state: &mut State) -> Vec<Effect> {
    let reason = if let Some(experiment) = state.running() {
        let name = experiment.name();
        let kept = match experiment {
            Experiment::Sweep => "Its finished runs are kept; the rest is not measured.",
            Experiment::Accuracy => "What is judged so far is kept.",
            Experiment::Stability => "Its map is lost.",
        };
        Some(format!("{name} is running. {kept}"))
    } else {
        let kept = [&state.sweep.kept, &state.pareto.kept];
        let mut unsaved = kept.into_iter().filter_map(|kept| kept.unsaved.as_ref());
        unsaved
            .next()
            .map(|why| format!("Not everything measured is saved: {why}"))
    };
    let asked = matches!(state.overlays.last(), Some(Overlay::Quit(_)));
    match reason {
        Some(reason) if !asked => {
            state.overlays.push(Overlay::Quit(reason));
            Vec::new()
        }
        _ => {
            state.quitting = true;
            vec![Effect::Quit]
        }
    }
}
