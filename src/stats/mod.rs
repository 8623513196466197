//! Statistics over plain slices: what raw samples say.
//!
//! Medians rather than means, because a sample that another program disturbed lies far off; intervals by the bootstrap,
//! because times are not normally distributed. Everything is deterministic: the bootstrap draws from a seeded PCG.

mod bootstrap;
mod histogram;
mod line;
mod order;
mod proportion;

use serde::{Deserialize, Serialize};

pub use bootstrap::{Interval, median_interval, ratio_interval};
pub use histogram::Histogram;
pub use line::Line;
pub use order::{mad, median, percentile};
pub use proportion::upper95;

/// Median, 95 % bootstrap interval and the raw samples they come from.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Median of the samples.
    pub median: f64,
    /// Lower end of the interval of the median.
    pub lo: f64,
    /// Upper end of the interval of the median.
    pub hi: f64,
    /// Raw samples in the order in which they were taken.
    pub samples: Vec<f64>,
}

impl Summary {
    /// Summarises finite samples; all figures are 0 where there are none. The same samples and seed give the same
    /// summary.
    #[must_use]
    pub fn of(samples: &[f64], seed: u64) -> Self {
        let interval = median_interval(samples, seed).unwrap_or_default();
        Self {
            median: interval.median,
            lo: interval.lo,
            hi: interval.hi,
            samples: samples.to_vec(),
        }
    }

    /// Half the interval's width as a share of the median; infinite below three samples, whose interval says nothing,
    /// and for a median of 0.
    #[must_use]
    pub fn relative_half_width(&self) -> f64 {
        let interval = Interval {
            median: self.median,
            lo: self.lo,
            hi: self.hi,
        };
        if self.samples.len() < 3 {
            f64::INFINITY
        } else {
            interval.relative_half_width()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_of_nothing_is_zero_and_knows_that_it_says_nothing() {
        let none = Summary::of(&[], 1);
        assert_eq!(none, Summary::default());
        assert_eq!(none.relative_half_width(), f64::INFINITY);
    }

    #[test]
    fn a_summary_keeps_the_samples_in_their_order() {
        let summary = Summary::of(&[3.0, 1.0, 2.0], 1);
        assert_eq!(summary.samples, [3.0, 1.0, 2.0]);
        assert_eq!((summary.median, summary.lo, summary.hi), (2.0, 1.0, 3.0));
        assert_eq!(summary.relative_half_width(), 0.5);
    }

    #[test]
    fn two_samples_never_look_precise() {
        assert_eq!(
            Summary::of(&[1.0, 1.0], 1).relative_half_width(),
            f64::INFINITY
        );
        assert_eq!(Summary::of(&[1.0; 3], 1).relative_half_width(), 0.0);
    }
}
