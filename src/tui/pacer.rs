//! When the screen is drawn: at once after a key; on its own at most so often, and seldom while a sample is timed.

use std::time::{Duration, Instant};

/// Shortest time between two frames that no key asked for.
const IDLE: Duration = Duration::from_millis(33);

/// The same while a sweep runs: four frames a second.
const MEASURING: Duration = Duration::from_millis(250);

/// Decides when to draw.
#[derive(Debug)]
pub(super) struct Pacer {
    last: Option<Instant>,
    stale: bool,
    urgent: bool,
}

impl Pacer {
    /// Nothing has been drawn.
    pub(super) fn new() -> Self {
        Self {
            last: None,
            stale: true,
            urgent: true,
        }
    }

    /// Something on the screen has changed.
    pub(super) fn stale(&mut self) {
        self.stale = true;
    }

    /// A key was pressed: its effect is to be seen at once.
    pub(super) fn urgent(&mut self) {
        self.stale = true;
        self.urgent = true;
    }

    /// How long to wait until the next frame is due; `None` where nothing has changed.
    pub(super) fn wait(&self, now: Instant, measuring: bool) -> Option<Duration> {
        if !self.stale {
            return None;
        }
        let gap = if measuring { MEASURING } else { IDLE };
        match self.last {
            Some(last) if !self.urgent => Some((last + gap).saturating_duration_since(now)),
            _ => Some(Duration::ZERO),
        }
    }

    /// A frame was drawn.
    pub(super) fn drawn(&mut self, now: Instant) {
        self.last = Some(now);
        self.stale = false;
        self.urgent = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_answered_at_once_and_news_wait_their_turn() {
        let start = Instant::now();
        let mut pacer = Pacer::new();
        assert_eq!(pacer.wait(start, true), Some(Duration::ZERO));
        pacer.drawn(start);
        assert_eq!(pacer.wait(start, true), None);
        pacer.stale();
        assert_eq!(pacer.wait(start, true), Some(MEASURING));
        assert_eq!(pacer.wait(start, false), Some(IDLE));
        pacer.urgent();
        assert_eq!(pacer.wait(start, true), Some(Duration::ZERO));
    }

    #[test]
    fn while_measuring_there_are_at_most_four_frames_a_second() {
        let start = Instant::now();
        let mut pacer = Pacer::new();
        let mut frames = 0;
        for ms in 0..1000 {
            let now = start + Duration::from_millis(ms);
            pacer.stale();
            if pacer.wait(now, true) == Some(Duration::ZERO) {
                pacer.drawn(now);
                frames += 1;
            }
        }
        assert_eq!(frames, 4);
    }
}
