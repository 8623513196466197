//! Percentiles of millions of values in little memory: values are counted by their leading bits.
//!
//! ```text
//!   sign exponent mantissa
//!   0    ...      ffffffff|rest      counted by exponent and eight bits: neighbours are 0.4 % apart
//! ```

use std::collections::BTreeMap;

/// Bits of the mantissa that are not told apart.
const DROPPED: u32 = 44;

/// Counts of values that are at least 0.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Histogram {
    counts: BTreeMap<u32, u64>,
    count: u64,
    max: f64,
}

impl Histogram {
    /// Counts a value: at least 0, not NaN.
    pub fn add(&mut self, value: f64) {
        *self
            .counts
            .entry((value.to_bits() >> DROPPED) as u32)
            .or_default() += 1;
        self.count += 1;
        self.max = self.max.max(value);
    }

    /// Counts what `other` counted; the order in which counts are joined does not matter.
    pub fn merge(&mut self, other: &Self) {
        for (key, count) in &other.counts {
            *self.counts.entry(*key).or_default() += count;
        }
        self.count += other.count;
        self.max = self.max.max(other.max);
    }

    /// How many values were counted.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The greatest value, exactly; 0 where there are none.
    #[must_use]
    pub fn max(&self) -> f64 {
        self.max
    }

    /// The `percent`-th percentile (1 to 100) by nearest rank, rounded down to eight bits of mantissa: at most 0.4 % too
    /// low. 0 where there are none.
    #[must_use]
    pub fn percentile(&self, percent: u64) -> f64 {
        let rank = (self.count * percent).div_ceil(100);
        let mut seen = 0;
        for (key, count) in &self.counts {
            seen += count;
            if seen >= rank {
                return f64::from_bits(u64::from(*key) << DROPPED);
            }
        }
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: impl IntoIterator<Item = f64>) -> Histogram {
        let mut histogram = Histogram::default();
        for value in values {
            histogram.add(value);
        }
        histogram
    }

    #[test]
    fn percentiles_are_within_their_resolution_and_the_greatest_is_exact() {
        let histogram = of((1..=1000).map(f64::from));
        for (percent, exact) in [(1, 10.0), (50, 500.0), (99, 990.0)] {
            let found = histogram.percentile(percent);
            assert!(found <= exact && found > exact * 0.996, "{found} {exact}");
        }
        assert_eq!((histogram.max(), histogram.count()), (1000.0, 1000));
    }

    #[test]
    fn small_halves_and_zeros_are_exact() {
        assert_eq!(of([0.0, 0.5, 7.5]).percentile(50), 0.5);
        assert_eq!(of([0.0, 0.0, 7.5]).percentile(50), 0.0);
        assert_eq!(of([]).percentile(50), 0.0);
    }

    #[test]
    fn joined_counts_are_those_of_all_values() {
        let (mut a, b) = (of([1.0, 2.0]), of([3.0, 1e300, 2.0]));
        a.merge(&b);
        assert_eq!(a, of([1.0, 2.0, 3.0, 1e300, 2.0]));
    }
}
