//! How far something measured in the background is: the same for every experiment beside the sweep.

use super::state::Phase;

/// How far an experiment is.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    /// Where it stands.
    pub phase: Phase,
    /// Share that is done, 0 to 1.
    pub done: f64,
    /// What it is doing; empty when it does nothing.
    pub doing: String,
    /// When it began, by the state's clock.
    pub began: f64,
    /// When it ended.
    pub ended: Option<f64>,
}

impl Progress {
    /// Nothing has been run yet.
    #[must_use]
    pub fn idle() -> Self {
        Self {
            phase: Phase::Idle,
            done: 0.0,
            doing: String::new(),
            began: 0.0,
            ended: None,
        }
    }

    /// It begins now.
    #[must_use]
    pub fn beginning(clock: f64) -> Self {
        Self {
            phase: Phase::Running,
            began: clock,
            ..Self::idle()
        }
    }

    /// It has ended now.
    pub fn end(&mut self, stopped: bool, clock: f64) {
        self.phase = if stopped {
            Phase::Stopped
        } else {
            Phase::Complete
        };
        self.ended = Some(clock);
        self.doing.clear();
        if !stopped {
            self.done = 1.0;
        }
    }

    /// Whether it is under way, paused ones included.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.phase.is_running()
    }

    /// Seconds that it has taken so far.
    #[must_use]
    pub fn seconds(&self, clock: f64) -> f64 {
        self.ended.unwrap_or(clock) - self.began
    }

    /// Seconds to the end, if the rest takes as long as what is done; `None` while too little is.
    #[must_use]
    pub fn seconds_left(&self, clock: f64) -> Option<f64> {
        (self.done >= 0.01).then(|| self.seconds(clock) * (1.0 / self.done - 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_is_expected_to_take_as_long_as_what_is_done() {
        let mut progress = Progress::beginning(10.0);
        assert_eq!(progress.seconds_left(12.0), None);
        progress.done = 0.25;
        assert_eq!(progress.seconds_left(14.0), Some(12.0));
        progress.end(false, 20.0);
        assert_eq!((progress.seconds(99.0), progress.done), (10.0, 1.0));
        assert!(!progress.is_running());
    }
}
