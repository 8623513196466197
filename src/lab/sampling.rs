//! When sampling of a run stops, and what its samples give away about the measurement.

use rand_core::Rng;
use rand_pcg::Pcg32;

use crate::stats::{self, Summary};

use super::{Budget, StopReason};

/// Puts the runs of a round into a random order (Fisher and Yates), those with fewer threads first.
pub(super) fn order_round<T>(runs: &mut [T], random: &mut Pcg32, threads: impl Fn(&T) -> usize) {
    for i in (1..runs.len()).rev() {
        let pick = (u64::from(random.next_u32()) * (i as u64 + 1)) >> 32;
        runs.swap(i, pick as usize);
    }
    runs.sort_by_key(threads);
}

/// How much longer than its budget a run may be sampled to get its fewest samples.
const PATIENCE: f64 = 4.0;

/// Whether a run with these speeds, which took `seconds`, is sampled enough.
pub(super) fn stop_reason(
    speeds: &[f64],
    seconds: f64,
    budget: &Budget,
    seed: u64,
) -> Option<StopReason> {
    let late = seconds >= budget.run_seconds;
    if speeds.len() < budget.min_samples {
        return (seconds >= PATIENCE * budget.run_seconds).then_some(StopReason::Time);
    }
    if Summary::of(speeds, seed).relative_half_width() <= budget.relative_half_width {
        Some(StopReason::Interval)
    } else if late {
        Some(StopReason::Time)
    } else {
        (speeds.len() >= budget.max_samples).then_some(StopReason::Samples)
    }
}

/// What a reader of the speeds should know, one sentence each.
pub(super) fn warnings(speeds: &[f64]) -> Vec<String> {
    let mut warnings = Vec::new();
    if speeds.len() < 3 {
        warnings.push(format!(
            "only {} samples fitted into the time: the interval says little",
            speeds.len()
        ));
        return warnings;
    }
    if let Some(share) = slow_first(speeds) {
        warnings.push(format!(
            "the first sample was {:.0} % slower than the median of the others",
            100.0 * share
        ));
    }
    if let Some(change) = drift(speeds) {
        warnings.push(format!(
            "the speed drifted: the second half of the samples is {:+.0} % off the first",
            100.0 * change
        ));
    }
    warnings
}

/// By how much the first sample lags behind the median of the others, where that is more than 10 % and more than four
/// times what these usually deviate.
fn slow_first(speeds: &[f64]) -> Option<f64> {
    let (first, rest) = speeds.split_first()?;
    let (usual, deviation) = (stats::median(rest)?, stats::mad(rest)?);
    let lag = usual - first;
    (lag > 0.1 * usual && lag > 4.0 * deviation).then(|| lag / usual)
}

/// By how much the median of the second half differs from that of the first, where that is more than 5 % and more than
/// three standard errors. Fewer than six samples show no drift.
fn drift(speeds: &[f64]) -> Option<f64> {
    if speeds.len() < 6 {
        return None;
    }
    let (early, late) = speeds.split_at(speeds.len() / 2);
    let (before, after) = (stats::median(early)?, stats::median(late)?);
    let spread = stats::mad(early)?.max(stats::mad(late)?);
    // 1.4826 turns the deviation into a standard one; 1.2533 is the median's loss against the mean; two halves.
    let error = 1.4826 * 1.2533 * spread * (2.0 / early.len() as f64).sqrt();
    let change = after - before;
    (change.abs() > 0.05 * before && change.abs() > 3.0 * error).then(|| change / before)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BUDGET: Budget = Budget {
        sample_seconds: 0.02,
        min_samples: 5,
        max_samples: 9,
        relative_half_width: 0.05,
        run_seconds: 1.0,
        checked_rays: 1,
        whole_sets: false,
    };

    fn stop(speeds: &[f64], seconds: f64) -> Option<StopReason> {
        stop_reason(speeds, seconds, &BUDGET, 1)
    }

    #[test]
    fn a_round_has_every_run_in_an_order_of_its_own_and_fewer_threads_first() {
        let mut random = Pcg32::new(1, 1);
        let runs: Vec<(usize, usize)> = (0..60).map(|i| (1 + i % 2, i)).collect();
        let mut rounds = [runs.clone(), runs.clone()];
        for round in &mut rounds {
            order_round(round, &mut random, |run| run.0);
            assert!(round.is_sorted_by_key(|run| run.0));
            assert!(!round[..30].is_sorted() && !round[30..].is_sorted());
            let mut all = round.clone();
            all.sort_by_key(|run| run.1);
            assert_eq!(all, runs);
        }
        assert_ne!(rounds[0], rounds[1]);
    }

    #[test]
    fn sampling_goes_on_until_the_fewest_samples() {
        assert_eq!(stop(&[1.0; 4], 0.1), None);
        assert_eq!(stop(&[1.0; 4], 2.0), None);
        assert_eq!(stop(&[1.0; 1], 4.0), Some(StopReason::Time));
    }

    #[test]
    fn sampling_stops_at_the_interval_the_time_or_the_most_samples() {
        assert_eq!(stop(&[1.0; 5], 0.1), Some(StopReason::Interval));
        let wide = [1.0, 2.0, 1.0, 2.0, 1.0, 2.0, 1.0, 2.0, 1.0];
        assert_eq!(stop(&wide[..6], 0.1), None);
        assert_eq!(stop(&wide[..6], 1.0), Some(StopReason::Time));
        assert_eq!(stop(&wide, 0.1), Some(StopReason::Samples));
    }

    #[test]
    fn steady_samples_give_nothing_away() {
        let steady = [1.00, 1.01, 0.99, 1.00, 1.02, 0.98, 1.00, 1.01];
        assert!(warnings(&steady).is_empty());
    }

    #[test]
    fn a_slow_first_sample_is_told() {
        let told = warnings(&[0.5, 1.0, 1.01, 0.99, 1.0]);
        assert_eq!(told.len(), 1);
        assert!(told[0].contains("first sample was 50 % slower"), "{told:?}");
    }

    #[test]
    fn a_drift_is_told_and_noise_is_not() {
        let told = warnings(&[1.0, 1.01, 1.0, 0.99, 0.8, 0.81, 0.8, 0.79]);
        assert!(told.len() == 1 && told[0].contains("-20 %"), "{told:?}");
        let noise = [1.0, 1.4, 0.7, 1.2, 0.8, 1.3, 0.9, 1.1];
        assert!(warnings(&noise).is_empty());
    }

    #[test]
    fn very_few_samples_are_told() {
        assert!(warnings(&[1.0])[0].contains("only 1 samples"));
    }
}
