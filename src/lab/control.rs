//! How a running sweep is steered from other threads.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

/// How often a paused experiment looks whether it may go on.
const PAUSE: Duration = Duration::from_millis(20);

/// How others steer a running sweep, and say that they disturb it.
#[derive(Debug, Default)]
pub struct Control {
    stop: AtomicBool,
    paused: AtomicBool,
    waiting: AtomicBool,
    sampling: AtomicBool,
    disturbances: AtomicU64,
}

impl Control {
    /// Asks the sweep to end after the sample in progress.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }
    /// Whether it was asked to end.
    pub fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
    /// Asks the sweep to wait before the next sample, or to go on.
    pub fn pause(&self, paused: bool) {
        self.paused.store(paused, Ordering::Relaxed);
    }
    /// Whether it was asked to wait.
    pub fn paused(&self) -> bool {
        self.paused.load(Ordering::Relaxed)
    }
    /// Whether it waits right now: nothing is built, counted or timed.
    pub fn waiting(&self) -> bool {
        self.waiting.load(Ordering::Relaxed)
    }
    /// Waits while it is asked to, and says so meanwhile; whether to go on, or to end. To be asked by the experiment where
    /// nothing is being timed.
    pub fn may_go_on(&self) -> bool {
        while self.paused() && !self.stopped() {
            self.set_waiting(true);
            std::thread::sleep(PAUSE);
        }
        self.set_waiting(false);
        !self.stopped()
    }
    /// Said by the sweep when it begins and ends to wait.
    pub fn set_waiting(&self, waiting: bool) {
        self.waiting.store(waiting, Ordering::Relaxed);
    }
    /// Whether a sample is being timed right now.
    pub fn sampling(&self) -> bool {
        self.sampling.load(Ordering::Relaxed)
    }
    /// Said by the sweep before and after each sample.
    pub fn set_sampling(&self, sampling: bool) {
        self.sampling.store(sampling, Ordering::Relaxed);
    }
    /// Says that something took time from the sample in progress: the sweep takes that sample again.
    pub fn disturb(&self) {
        self.disturbances.fetch_add(1, Ordering::Relaxed);
    }
    /// How often the sweep was disturbed.
    pub fn disturbances(&self) -> u64 {
        self.disturbances.load(Ordering::Relaxed)
    }
}
