//! Bootstrap intervals: the samples are drawn again and again with replacement, and the middle 95 % of the medians of
//! those draws is the interval.
//!
//! **Source:** B. Efron and R. Tibshirani, "An Introduction to the Bootstrap", 1993, ch. 13 (percentile intervals).

use rand_core::Rng;
use rand_pcg::Pcg32;
use serde::{Deserialize, Serialize};

use super::order::{median, percentile_of_sorted};

/// How often the samples are drawn again: enough that the ends of the interval move by less than 2 % of its width from
/// one seed to another.
const RESAMPLES: usize = 2000;

/// A median, or a ratio of two, with its 95 % interval.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Of the samples themselves.
    pub median: f64,
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}

impl Interval {
    /// Half the width as a share of the median; infinite for a median of 0.
    #[must_use]
    pub fn relative_half_width(&self) -> f64 {
        if self.median == 0.0 {
            f64::INFINITY
        } else {
            (self.hi - self.lo) * 0.5 / self.median.abs()
        }
    }
}

/// The median of finite `samples` with its interval; `None` of nothing.
///
/// One sample is its own interval, and below seven samples the interval is that of the least and the greatest, as the
/// bootstrap of so few is too narrow: the true median lies between the extremes of m samples with probability
/// 1 − 2^(1−m), which is 94 % for five and 97 % for six.
#[must_use]
pub fn median_interval(samples: &[f64], seed: u64) -> Option<Interval> {
    let centre = median(samples)?;
    if samples.len() < 7 {
        return Some(Interval {
            median: centre,
            lo: samples.iter().copied().fold(f64::INFINITY, f64::min),
            hi: samples.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        });
    }
    let mut draws = Draws::new(samples, seed, 1);
    Some(middle(centre, (0..RESAMPLES).map(|_| draws.median())))
}

/// The ratio of the median of `above` to that of `below`, with its interval; `None` where either is empty or the median
/// of a draw of `below` is not positive.
#[must_use]
pub fn ratio_interval(above: &[f64], below: &[f64], seed: u64) -> Option<Interval> {
    let centre = median(above)? / median(below)?;
    if below.iter().any(|x| *x <= 0.0) {
        return None;
    }
    let mut above = Draws::new(above, seed, 2);
    let mut below = Draws::new(below, seed, 3);
    Some(middle(
        centre,
        (0..RESAMPLES).map(|_| above.median() / below.median()),
    ))
}

/// The interval that holds the middle 95 % of `values`.
fn middle(centre: f64, values: impl Iterator<Item = f64>) -> Interval {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    let at = |p| percentile_of_sorted(&values, p).unwrap_or(centre);
    Interval {
        median: centre,
        lo: at(2.5),
        hi: at(97.5),
    }
}

/// Draws of samples with replacement.
struct Draws<'a> {
    samples: &'a [f64],
    drawn: Vec<f64>,
    random: Pcg32,
}

impl<'a> Draws<'a> {
    fn new(samples: &'a [f64], seed: u64, stream: u64) -> Self {
        Self {
            samples,
            drawn: vec![0.0; samples.len()],
            random: Pcg32::new(seed, stream),
        }
    }

    /// The median of one draw. There is at least one sample.
    fn median(&mut self) -> f64 {
        let count = self.samples.len();
        for slot in &mut self.drawn {
            // The high half of a product: uniform up to a bias of count / 2³², which is far below what is asked here.
            let index = (u64::from(self.random.next_u32()) * count as u64) >> 32;
            *slot = self.samples[index as usize];
        }
        let (below, upper, _) = self.drawn.select_nth_unstable_by(count / 2, f64::total_cmp);
        let upper = *upper;
        if count % 2 == 1 {
            return upper;
        }
        // Of an even number the other one in the middle is the greatest below.
        let lower = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (lower + upper) * 0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers 1 to `count` in a shuffled order.
    fn numbers(count: u32) -> Vec<f64> {
        // 37 has no divisor in common with the counts used here, so every number comes once.
        (0..count).map(|i| f64::from(i * 37 % count + 1)).collect()
    }

    #[test]
    fn the_interval_of_101_numbers_is_that_of_the_binomial_distribution() {
        // Order statistics 41 and 61 of 101 enclose the median with 95 % (binomial, exactly 95.4 %).
        let interval = median_interval(&numbers(101), 1).unwrap();
        assert_eq!(interval.median, 51.0);
        assert!((interval.lo - 41.0).abs() <= 1.0, "{interval:?}");
        assert!((interval.hi - 61.0).abs() <= 1.0, "{interval:?}");
    }

    #[test]
    fn the_interval_covers_the_true_median_about_95_times_in_100() {
        let mut random = Pcg32::new(3, 3);
        let covered = (0..400_u64)
            .filter(|seed| {
                let samples: Vec<f64> = (0..25).map(|_| f64::from(random.next_u32())).collect();
                let interval = median_interval(&samples, *seed).unwrap();
                (interval.lo..=interval.hi).contains(&f64::from(1_u32 << 31))
            })
            .count();
        assert!((365..=396).contains(&covered), "{covered} of 400");
    }

    #[test]
    fn few_samples_give_the_range() {
        let of = |samples: &[f64]| median_interval(samples, 1);
        assert_eq!(of(&[]), None);
        let one = of(&[2.0]).unwrap();
        assert_eq!((one.lo, one.hi), (2.0, 2.0));
        let five = of(&[1.0, 5.0, 2.0, 4.0, 3.0]).unwrap();
        assert_eq!((five.median, five.lo, five.hi), (3.0, 1.0, 5.0));
    }

    #[test]
    fn the_same_seed_gives_the_same_interval_and_constant_samples_a_point() {
        let samples = numbers(50);
        assert_eq!(median_interval(&samples, 4), median_interval(&samples, 4));
        assert_ne!(
            ratio_interval(&samples, &numbers(30), 4),
            ratio_interval(&samples, &numbers(30), 5)
        );
        let constant = median_interval(&[3.0; 20], 1).unwrap();
        assert_eq!((constant.lo, constant.hi), (3.0, 3.0));
        assert_eq!(constant.relative_half_width(), 0.0);
    }

    #[test]
    fn an_even_number_of_samples_has_medians_between_two() {
        let half_and_half = [1.0, 1.0, 1.0, 1.0, 3.0, 3.0, 3.0, 3.0];
        let interval = median_interval(&half_and_half, 1).unwrap();
        assert_eq!((interval.median, interval.lo, interval.hi), (2.0, 1.0, 3.0));
    }

    #[test]
    fn a_ratio_of_twice_the_samples_is_two() {
        let below = numbers(101);
        let above: Vec<f64> = below.iter().map(|x| 2.0 * x).collect();
        let ratio = ratio_interval(&above, &below, 1).unwrap();
        assert_eq!(ratio.median, 2.0);
        assert!(ratio.lo > 1.4 && ratio.lo < 1.8 && ratio.hi > 2.2 && ratio.hi < 2.9);
        assert_eq!(ratio_interval(&above, &[0.0, 1.0], 1), None);
        assert_eq!(ratio_interval(&[], &below, 1), None);
    }
}
