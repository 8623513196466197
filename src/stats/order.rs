//! Order statistics: median, percentiles, median absolute deviation.

/// The value in the middle, the mean of the two in the middle for an even number; `None` of nothing.
#[must_use]
pub fn median(values: &[f64]) -> Option<f64> {
    percentile(values, 50.0)
}

/// The `p`-th percentile (0 to 100, clamped), linearly interpolated between the neighbouring order statistics; `None`
/// of nothing.
///
/// Of `m` sorted values x₀ … it is x at position (m − 1)·p/100, so 0 gives the least and 100 the greatest value.
///
/// **Source:** definition 7 of R. Hyndman and Y. Fan, "Sample Quantiles in Statistical Packages", 1996; the one of
/// numpy and R.
#[must_use]
pub fn percentile(values: &[f64], p: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    percentile_of_sorted(&sorted, p)
}

/// As [`percentile`], of values in ascending order.
pub(super) fn percentile_of_sorted(sorted: &[f64], p: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let position = last as f64 * (p.clamp(0.0, 100.0) / 100.0);
    let below = position.floor() as usize;
    let above = (below + 1).min(last);
    let (a, b) = (sorted[below], sorted[above]);
    Some(a + (b - a) * (position - below as f64))
}

/// The median absolute deviation from the median: half of the values lie within it; `None` of nothing.
///
/// Not scaled; for normally distributed values, 1.4826 times it estimates the standard deviation.
#[must_use]
pub fn mad(values: &[f64]) -> Option<f64> {
    let centre = median(values)?;
    let deviations: Vec<f64> = values.iter().map(|x| (x - centre).abs()).collect();
    median(&deviations)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle_or_the_mean_of_the_two_in_the_middle() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[7.0]), Some(7.0));
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0, 3.0, 2.0]), Some(2.5));
    }

    #[test]
    fn percentiles_are_those_of_numpy() {
        // numpy.percentile([15, 20, 35, 40, 50], [0, 5, 30, 40, 99, 100])
        let values = [50.0, 15.0, 40.0, 20.0, 35.0];
        for (p, expected) in [
            (0.0, 15.0),
            (5.0, 16.0),
            (30.0, 23.0),
            (40.0, 29.0),
            (99.0, 49.6),
            (100.0, 50.0),
        ] {
            let got = percentile(&values, p).unwrap();
            assert!((got - expected).abs() < 1e-12, "{p}: {got}");
        }
        assert_eq!(percentile(&values, 120.0), Some(50.0));
        assert_eq!(percentile(&[], 50.0), None);
    }

    #[test]
    fn one_wild_value_does_not_move_the_deviation() {
        assert_eq!(mad(&[1.0, 1.0, 2.0, 2.0, 4.0, 6.0, 9.0]), Some(1.0));
        assert_eq!(mad(&[1.0, 1.0, 2.0, 2.0, 4.0, 6.0, 9e9]), Some(1.0));
        assert_eq!(mad(&[5.0]), Some(0.0));
        assert_eq!(mad(&[]), None);
    }
}
