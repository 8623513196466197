//! Who may make the sweep wait: its user, and a picture that a key asked for.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use crate::lab::Control;

/// How often a picture looks whether the sweep has begun to wait.
const GLANCE: Duration = Duration::from_millis(2);

#[derive(Debug, Default)]
struct Holds {
    /// The sweep that is under way.
    control: Option<Arc<Control>>,
    /// Whether it is timed, so that nothing else may work while it does.
    timed: bool,
    user: bool,
    /// Pictures and reports in work that the sweep waits for.
    others: u32,
}

impl Holds {
    fn apply(&self) {
        if let Some(control) = &self.control {
            control.pause(self.user || self.timed && self.others > 0);
        }
    }
}

/// Shared by the UI thread and the picture thread.
#[derive(Debug, Default, Clone)]
pub(super) struct Steering {
    holds: Arc<Mutex<Holds>>,
}

impl Steering {
    fn lock(&self) -> MutexGuard<'_, Holds> {
        // The fields stay meaningful whatever a panicking thread was doing.
        self.holds.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// An experiment begins; one that is not `timed` waits for its user only.
    pub(super) fn begin(&self, control: Arc<Control>, timed: bool) {
        let mut holds = self.lock();
        holds.timed = timed;
        holds.user = false;
        holds.control = Some(control);
        holds.apply();
    }

    /// The sweep has ended.
    pub(super) fn end(&self) {
        self.lock().control = None;
    }

    /// The user lets the sweep wait, or go on.
    pub(super) fn pause(&self, paused: bool) {
        let mut holds = self.lock();
        holds.user = paused;
        holds.apply();
    }

    /// Whether something is being timed now, so that other work has to wait for a gap.
    pub(super) fn is_timed(&self) -> bool {
        let holds = self.lock();
        holds.timed && holds.control.is_some()
    }

    /// Ends the sweep after the sample in progress.
    pub(super) fn stop(&self) {
        if let Some(control) = &self.lock().control {
            control.stop();
        }
    }

    /// Whether a sweep is under way.
    pub(super) fn is_running(&self) -> bool {
        self.lock().control.is_some()
    }

    /// Says that the sample in progress lost time, if there is one.
    pub(super) fn disturb(&self) {
        if let Some(control) = &self.lock().control
            && control.sampling()
        {
            control.disturb();
        }
    }

    /// Lets the sweep wait, returns once it does, and lets it go on when the answer is dropped. Where no sweep is under
    /// way that is at once. `None` when `given_up` said so first.
    pub(super) fn hold(&self, given_up: impl Fn() -> bool) -> Option<Hold<'_>> {
        {
            let mut holds = self.lock();
            holds.others += 1;
            holds.apply();
        }
        let hold = Hold { steering: self };
        loop {
            let waits = {
                let holds = self.lock();
                let waiting = holds.control.as_ref().is_none_or(|c| c.waiting());
                waiting || !holds.timed
            };
            if waits {
                return Some(hold);
            }
            if given_up() {
                return None;
            }
            thread::sleep(GLANCE);
        }
    }
}

/// The sweep waits as long as this lives.
#[derive(Debug)]
pub(super) struct Hold<'a> {
    steering: &'a Steering,
}

impl Drop for Hold<'_> {
    fn drop(&mut self) {
        let mut holds = self.steering.lock();
        holds.others = holds.others.saturating_sub(1);
        holds.apply();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_and_the_user_each_make_the_sweep_wait() {
        let steering = Steering::default();
        let control = Arc::new(Control::default());
        steering.begin(Arc::clone(&control), true);
        control.set_waiting(true);
        let hold = steering.hold(|| false);
        assert!(hold.is_some() && control.paused());
        steering.pause(true);
        drop(hold);
        assert!(control.paused());
        steering.pause(false);
        assert!(!control.paused());
    }

    #[test]
    fn a_picture_gives_up_and_lets_the_sweep_go_on() {
        let steering = Steering::default();
        let control = Arc::new(Control::default());
        steering.begin(Arc::clone(&control), true);
        assert!(steering.hold(|| true).is_none());
        assert!(!control.paused());
    }

    #[test]
    fn what_is_not_timed_waits_for_its_user_only() {
        let steering = Steering::default();
        let control = Arc::new(Control::default());
        steering.begin(Arc::clone(&control), false);
        let hold = steering.hold(|| false);
        assert!(hold.is_some() && !control.paused() && !steering.is_timed());
        steering.pause(true);
        assert!(control.paused());
    }

    #[test]
    fn without_a_sweep_nothing_is_waited_for() {
        assert!(Steering::default().hold(|| true).is_some());
    }
}
