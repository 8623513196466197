//! Counts of many rays, summarised.

use crate::accel::Counts;

use super::{PerRay, Spread};

impl PerRay {
    /// Mean and percentiles of each count; all zero where there are no rays.
    #[must_use]
    pub fn of(counts: &[Counts]) -> Self {
        Self {
            steps: Spread::of(counts.iter().map(|c| c.steps)),
            empty_steps: Spread::of(counts.iter().map(|c| c.empty_steps)),
            tests: Spread::of(counts.iter().map(|c| c.tests)),
            duplicate_tests: Spread::of(counts.iter().map(|c| c.duplicate_tests)),
        }
    }
}

impl Spread {
    /// Summarises counts; zero where there are none.
    ///
    /// A percentile is the least count that at least that share of the counts does not exceed (nearest rank), so it is
    /// a count that occurs, and equal on every machine.
    #[must_use]
    pub fn of(counts: impl Iterator<Item = u64>) -> Self {
        let mut counts: Vec<u64> = counts.collect();
        counts.sort_unstable();
        let Some(max) = counts.last() else {
            return Self::default();
        };
        let rank = |percent: usize| counts[(counts.len() * percent).div_ceil(100) - 1];
        Self {
            // Summed as whole numbers: no order of threads can change it.
            mean: counts.iter().map(|c| u128::from(*c)).sum::<u128>() as f64 / counts.len() as f64,
            p50: rank(50),
            p99: rank(99),
            max: *max,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_counts_that_occur() {
        let spread = Spread::of((1..=200).rev());
        assert_eq!((spread.p50, spread.p99, spread.max), (100, 198, 200));
        assert_eq!(spread.mean, 100.5);
        let one = Spread::of([7].into_iter());
        assert_eq!((one.mean, one.p50, one.p99, one.max), (7.0, 7, 7, 7));
    }

    #[test]
    fn no_rays_are_no_work() {
        assert_eq!(PerRay::of(&[]), PerRay::default());
    }

    #[test]
    fn each_count_lands_in_its_own_spread() {
        let counts = Counts {
            steps: 4,
            empty_steps: 3,
            tests: 2,
            duplicate_tests: 1,
        };
        let work = PerRay::of(&[counts]);
        assert_eq!(
            [
                work.steps,
                work.empty_steps,
                work.tests,
                work.duplicate_tests
            ]
            .map(|s| s.max),
            [4, 3, 2, 1]
        );
    }
}
