//! The terminal lab: pure state, update, view.
//!
//! ```text
//!  input thread ---keys-----.                        .--> terminal (one write a frame)
//!  runner thread --lab------+--> update(state, event)-+--> view(state, frame)
//!  picture thread -passes---'         |
//!        ^                         effects
//!        '----- app: performs them --'
//! ```
//!
//! [`update`](update::update) and [`view`](view::view) are pure; `app` owns the terminal, the threads and the channel
//! between them. The UI thread does no heavy work: a key is answered at once, also while every core is busy measuring.
//! While a sample is being timed the screen redraws on its own at most four times a second and no picture is rendered;
//! what a key costs is told to the sweep, which takes the sample again.
//!
//! To add a key: a row in the tables of [`keymap`]. To add a screen: a file in `screens`, a row in [`state::Screen`].

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::lab::Plan;
use crate::preview::ColorMode;

mod actions;
mod app;
mod cuts;
mod desk;
mod examiner;
pub mod experiment;
pub mod figures;
mod input;
pub mod inspect;
pub mod keymap;
pub mod keys;
pub mod layout;
pub mod overlay;
mod pacer;
pub mod pareto;
pub mod picture;
pub mod plan_editor;
pub mod plan_field;
pub mod plan_text;
pub mod progress;
pub mod runner;
pub mod runs;
pub mod screen;
pub mod screens;
mod shelf;
pub mod shelved;
mod signals;
pub mod slice;
pub mod stability;
pub mod state;
mod steering;
mod studio;
pub mod table_view;
pub mod text_input;
pub mod theme;
mod trials;
mod tty;
pub mod update;
pub mod view;

#[cfg(test)]
mod fixture;
#[cfg(test)]
mod key_tests;
#[cfg(test)]
mod screen_tests;

/// How the lab opens.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Scene specs of the plan; where there are none, those of the default plan.
    pub scenes: Vec<String>,
    /// Where bundles are written and listed.
    pub results: PathBuf,
    /// Colours; `None`: what the environment says of the terminal.
    pub colors: Option<ColorMode>,
    /// Threads of the plan; `None`: as many as the machine has.
    pub threads: Option<usize>,
    /// Seed of the plan; `None`: that of the default plan.
    pub seed: Option<u64>,
}

impl Default for Options {
    /// The default plan, bundles in `results`.
    fn default() -> Self {
        Self {
            scenes: Vec::new(),
            results: PathBuf::from("results"),
            colors: None,
            threads: None,
            seed: None,
        }
    }
}

impl Options {
    /// The plan that the lab opens with.
    #[must_use]
    pub fn plan(&self) -> Plan {
        let mut plan = Plan::default();
        if !self.scenes.is_empty() {
            plan.scenes.clone_from(&self.scenes);
        }
        if let Some(threads) = self.threads {
            plan.threads = vec![threads];
        }
        if let Some(seed) = self.seed {
            plan.seed = seed;
        }
        plan
    }
}

/// Why the lab ended other than by being quit. The terminal is restored.
#[derive(Debug, Error)]
pub enum TuiError {
    /// Standard input or output is no terminal.
    #[error(
        "there is no terminal to open the lab in; use a command such as `raylab sweep` or `raylab render`, see `raylab --help`"
    )]
    NoTerminal,
    /// The terminal refuses, or is gone.
    #[error(
        "the terminal cannot be used: {0}; try another terminal, or a command such as `raylab sweep`"
    )]
    Terminal(#[from] io::Error),
    /// A signal asked for the end; finished runs are kept.
    #[error("ended by signal {signal}; finished runs are kept")]
    Ended {
        /// Its number.
        signal: i32,
    },
}

/// Opens the lab in the terminal and returns when it is quit. The terminal is restored in every case.
///
/// A scene that cannot be loaded is no error here: the plan says what is wrong with it.
///
/// # Errors
/// There is no terminal, it refuses, or a signal ended the lab.
pub fn run(options: &Options) -> Result<(), TuiError> {
    let colors = ColorMode::detect(options.colors, true, |name| std::env::var(name).ok());
    // Before the terminal is claimed: a signal that came in between would end the program with the terminal taken.
    let signals = signals::Signals::register()?;
    let mut tty = tty::Tty::claim()?;
    app::run(
        &options.plan(),
        options.results.clone(),
        colors,
        signals,
        &mut tty,
    )
}
