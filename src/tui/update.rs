//! What happens to the state: events in, effects out. Nothing here draws, waits, or touches a file.

use std::path::PathBuf;

use crossterm::event::KeyEvent;

use super::actions;
use super::inspect::{self, InspectNews};
use super::keymap::{self, Key, Place};
use super::layout;
use super::overlay::Overlay;
use super::picture::{PictureNews, Request};
use super::state::{BundleRow, Opened, Phase, Screen, State};
use crate::lab::{self, Plan};
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
    /// The bundle of the running sweep was made there.
    BundleMade(PathBuf),
    /// The bundle is complete, with report and plots.
    BundleWritten(PathBuf),
    /// What is measured cannot be written; why.
    BundleFailed(String),
    /// The sweep could not begin, or broke off; why.
    SweepFailed(String),
    /// The sweep has ended; its report is being written.
    Writing,
    /// The picture thread tells something.
    Picture(PictureNews),
    /// The examiner tells something.
    Inspect(InspectNews),
    /// The bundles in the results directory, or why there is no list.
    Listed(Result<Vec<BundleRow>, String>),
    /// A report was read, with the name of its bundle; or why not.
    Read(Result<(String, Box<Report>), String>),
}

/// What is to be done outside the state.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// Perform a sweep.
    Start(Box<Plan>),
    /// Let the sweep wait, or go on.
    Pause(bool),
    /// End the sweep.
    Stop,
    /// Write report and plots of what is measured so far.
    Write,
    /// Show a picture.
    Render(Box<Request>),
    /// Follow a ray.
    Inspect(Box<inspect::Request>),
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
        Event::BundleMade(path) => {
            state.sweep.bundle = Some(path);
            Vec::new()
        }
        Event::BundleWritten(path) => {
            state.sweep.writing = false;
            state.sweep.unsaved = None;
            state.say(format!("Report and plots are in {}.", path.display()));
            state.sweep.bundle = Some(path);
            vec![Effect::List]
        }
        Event::BundleFailed(why) => {
            state.sweep.writing = false;
            state.sweep.unsaved = Some(why.clone());
            state.warn(why);
            Vec::new()
        }
        Event::SweepFailed(why) => {
            state.sweep.writing = false;
            state.sweep.phase = if state.sweep.runs.rows.is_empty() {
                Phase::Idle
            } else {
                Phase::Stopped
            };
            state.sweep.ended = Some(state.clock);
            state.warn(why);
            Vec::new()
        }
        Event::Writing => {
            state.sweep.writing = state.sweep.bundle.is_some() && state.sweep.unsaved.is_none();
            Vec::new()
        }
        Event::Picture(news) => {
            state.picture.take(news);
            Vec::new()
        }
        Event::Inspect(news) => {
            state.inspect.take(news);
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
    let reason = if state.sweep.is_running() {
        Some("A sweep is running. Its finished runs are kept; the rest is not measured.".to_owned())
    } else {
        state
            .sweep
            .unsaved
            .as_ref()
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
