//! What is measured in the background: where it stands, and what becomes of what it measures.

use std::path::PathBuf;

use super::runs::Runs;
use super::screen::Screen;

/// Where the sweep stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Nothing has been run yet.
    Idle,
    /// It runs.
    Running,
    /// It waits before the next sample.
    Paused,
    /// It was asked to stop and ends its sample.
    Stopping,
    /// All runs are made.
    Complete,
    /// It was stopped.
    Stopped,
}

impl Phase {
    /// Whether something is under way, paused or about to stop included.
    #[must_use]
    pub fn is_running(self) -> bool {
        matches!(self, Self::Running | Self::Paused | Self::Stopping)
    }
}

/// What is measured in the background: one at a time, for they would disturb each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Experiment {
    /// Speed over a plan.
    Sweep,
    /// Speed and wrong decisions.
    Accuracy,
    /// Where methods break.
    Stability,
}

impl Experiment {
    /// What it is called while it runs.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sweep => "A sweep",
            Self::Accuracy => "Judging accuracy",
            Self::Stability => "The stability suite",
        }
    }

    /// The screen that it is on.
    #[must_use]
    pub fn screen(self) -> Screen {
        match self {
            Self::Sweep => Screen::Sweep,
            Self::Accuracy => Screen::Pareto,
            Self::Stability => Screen::Stability,
        }
    }
}

/// The sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Where it stands.
    pub phase: Phase,
    /// Its runs.
    pub runs: Runs,
    /// Share that is done, 0 to 1.
    pub done: f64,
    /// Estimated seconds to the end, once known.
    pub seconds_left: Option<f64>,
    /// When it began, by [`super::state::State::clock`].
    pub began: f64,
    /// When it ended.
    pub ended: Option<f64>,
    /// What becomes of it.
    pub kept: Kept,
}

/// What becomes of what an experiment measures.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Kept {
    /// The bundle that it is written to.
    pub bundle: Option<PathBuf>,
    /// Whether its report and plots are being written.
    pub writing: bool,
    /// Why what was measured is not all on disk.
    pub unsaved: Option<String>,
}

impl Sweep {
    /// Nothing has been run yet.
    #[must_use]
    pub fn idle() -> Self {
        Self {
            phase: Phase::Idle,
            runs: Runs::default(),
            done: 0.0,
            seconds_left: None,
            began: 0.0,
            ended: None,
            kept: Kept::default(),
        }
    }

    /// A sweep that begins now.
    #[must_use]
    pub fn beginning(clock: f64) -> Self {
        Self {
            phase: Phase::Running,
            began: clock,
            ..Self::idle()
        }
    }

    /// Whether a sweep is under way, paused ones included.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.phase.is_running()
    }
}
