//! How much of a sweep is done, and how long the rest will take.

use std::time::Instant;

use super::Budget;

/// What is known of the time that a sweep takes.
pub(super) struct Estimate {
    start: Instant,
    /// Seconds that the sweep was paused.
    paused: f64,
    total: usize,
    prepared: usize,
    /// Seconds that preparing took so far: builds, counted passes, checks.
    preparing: f64,
    complete: usize,
    /// Seconds that the samples of complete runs took.
    sampling: f64,
    /// Seconds of samples that a run takes at most.
    most_a_run: f64,
    /// The greatest share told so far: it never falls.
    told: f64,
}

impl Estimate {
    /// Begins with `total` runs ahead.
    pub fn new(total: usize, budget: &Budget) -> Self {
        Self {
            start: Instant::now(),
            paused: 0.0,
            total,
            prepared: 0,
            preparing: 0.0,
            complete: 0,
            sampling: 0.0,
            most_a_run: budget.run_seconds,
            told: 0.0,
        }
    }

    /// The sweep waited.
    pub fn waited(&mut self, seconds: f64) {
        self.paused += seconds;
    }

    /// A run was prepared, or failed.
    pub fn prepared(&mut self, seconds: f64) {
        self.prepared += 1;
        self.preparing += seconds;
    }

    /// A run is complete after `seconds` of samples; 0 for one that failed.
    pub fn complete(&mut self, seconds: f64) {
        self.complete += 1;
        self.sampling += seconds;
    }

    /// Share done, 0 to 1, and seconds left; `spent` are the seconds of samples of each run in progress.
    pub fn tell(&mut self, spent: impl Iterator<Item = f64>) -> (f64, f64) {
        let elapsed = (self.start.elapsed().as_secs_f64() - self.paused).max(0.0);
        let left = self.seconds_left(spent);
        if left > 0.0 {
            self.told = self.told.max(elapsed / (elapsed + left));
        } else {
            self.told = 1.0;
        }
        (self.told, left)
    }

    /// Runs ahead take as long as those behind did on average; before there are any, half of what they may take.
    fn seconds_left(&self, spent: impl Iterator<Item = f64>) -> f64 {
        let mean = |sum: f64, count: usize, guess: f64| {
            if count == 0 {
                guess
            } else {
                sum / count as f64
            }
        };
        let a_run = mean(self.sampling, self.complete, 0.5 * self.most_a_run);
        let a_preparation = mean(self.preparing, self.prepared, 0.1 * self.most_a_run);
        let ahead = self.total.saturating_sub(self.prepared) as f64;
        let in_progress: f64 = spent.map(|s| (a_run - s).max(0.0)).sum();
        ahead * (a_preparation + a_run) + in_progress
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(total: usize) -> Estimate {
        Estimate::new(total, &Budget::quick())
    }

    #[test]
    fn runs_ahead_take_as_long_as_those_behind() {
        let mut estimate = estimate(10);
        for _ in 0..4 {
            estimate.prepared(1.0);
            estimate.complete(2.0);
        }
        assert_eq!(estimate.seconds_left([].into_iter()), 6.0 * 3.0);
        estimate.prepared(1.0);
        assert_eq!(estimate.seconds_left([0.5].into_iter()), 5.0 * 3.0 + 1.5);
        assert_eq!(estimate.seconds_left([9.0].into_iter()), 5.0 * 3.0);
    }

    #[test]
    fn nothing_is_left_at_the_end() {
        let mut estimate = estimate(1);
        estimate.prepared(1.0);
        estimate.complete(1.0);
        assert_eq!(estimate.tell([].into_iter()), (1.0, 0.0));
    }

    #[test]
    fn the_share_never_falls() {
        let mut estimate = estimate(100);
        estimate.start -= std::time::Duration::from_secs(10);
        let (early, _) = estimate.tell([].into_iter());
        estimate.prepared(1e6);
        let (late, left) = estimate.tell([].into_iter());
        assert!(early > 0.0 && late == early && left > 1e6);
    }
}
