//! How much of a sweep is done, and how long the rest will take.

use super::Budget;

/// The share of a run's time that preparing it takes, as a rule.
const PREPARATION: f64 = 0.3;

/// What is known of the time that a sweep takes.
pub(super) struct Estimate {
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
            total,
            prepared: 0,
            preparing: 0.0,
            complete: 0,
            sampling: 0.0,
            most_a_run: budget.run_seconds,
            told: 0.0,
        }
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
    pub fn tell(&mut self, spent: &[f64]) -> (f64, f64) {
        (self.share(spent), self.seconds_left(spent))
    }

    /// Share of the runs that is done, a run in progress by the time that it has spent. Never falls.
    fn share(&mut self, spent: &[f64]) -> f64 {
        let sampled: f64 = spent.iter().map(|s| (s / self.most_a_run).min(1.0)).sum();
        let sampled = sampled + self.complete as f64;
        let prepared = self.prepared as f64;
        let share = PREPARATION * prepared + (1.0 - PREPARATION) * sampled;
        let share = if self.complete == self.total {
            1.0
        } else {
            share / self.total as f64
        };
        self.told = self.told.max(share.min(1.0));
        self.told
    }

    /// Runs ahead take as long as those behind did on average; before there are any, half of what they may take, or as
    /// long as those in progress already took.
    fn seconds_left(&self, spent: &[f64]) -> f64 {
        let mean = |sum: f64, count: usize, guess: f64| {
            if count == 0 {
                guess
            } else {
                sum / count as f64
            }
        };
        let guess = mean(spent.iter().sum(), spent.len(), 0.0).max(0.5 * self.most_a_run);
        let a_run = mean(self.sampling, self.complete, guess);
        let a_preparation = mean(self.preparing, self.prepared, 0.1 * self.most_a_run);
        let ahead = self.total.saturating_sub(self.prepared) as f64;
        let in_progress: f64 = spent.iter().map(|s| (a_run - s).max(0.0)).sum();
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
        assert_eq!(estimate.seconds_left(&[]), 6.0 * 3.0);
        estimate.prepared(1.0);
        assert_eq!(estimate.seconds_left(&[0.5]), 5.0 * 3.0 + 1.5);
        assert_eq!(estimate.seconds_left(&[9.0]), 5.0 * 3.0);
    }

    #[test]
    fn the_first_runs_are_expected_to_take_what_they_may() {
        let mut estimate = estimate(2);
        estimate.prepared(1.0);
        let half = 0.5 * Budget::quick().run_seconds;
        assert_eq!(estimate.seconds_left(&[0.0]), 1.0 + 2.0 * half);
    }

    #[test]
    fn nothing_is_left_at_the_end() {
        let mut estimate = estimate(1);
        estimate.prepared(1.0);
        estimate.complete(1.0);
        assert_eq!(estimate.tell(&[]), (1.0, 0.0));
    }

    #[test]
    fn the_share_rises_with_preparations_samples_and_ends() {
        let mut estimate = estimate(2);
        let whole = Budget::quick().run_seconds;
        let mut shares = vec![estimate.share(&[])];
        estimate.prepared(1.0);
        shares.push(estimate.share(&[0.0]));
        shares.push(estimate.share(&[whole / 2.0]));
        estimate.complete(whole / 2.0);
        shares.push(estimate.share(&[]));
        estimate.prepared(1.0);
        shares.push(estimate.share(&[0.0]));
        estimate.complete(whole);
        shares.push(estimate.share(&[]));
        assert!(
            shares.windows(2).all(|pair| pair[0] < pair[1]),
            "{shares:?}"
        );
        assert_eq!((shares[0], shares[3], shares[5]), (0.0, 0.5, 1.0));
    }

    #[test]
    fn the_share_never_falls() {
        let mut estimate = estimate(4);
        estimate.prepared(1.0);
        let share = estimate.share(&[0.1]);
        assert_eq!(estimate.share(&[]), share);
    }
}
