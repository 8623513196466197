//! Which rays of a set are measured and which are checked, where all would take too long.
//!
//! The choice never looks at a clock: it follows from counted work at a nominal speed, so that counters and checksums
//! of a run are the same on every machine and in every repetition.

use rand_core::Rng;
use rand_pcg::Pcg32;

use crate::accel::Accelerator;
use crate::geometry::Ray;
use crate::trace::Query;

use super::Budget;
use super::answers::Answers;

/// Steps and tests a second that the choice reckons with: the order of a scalar test on one core (5 ns).
const WORK_PER_SECOND: f64 = 2e8;

/// Fewest rays that a figure rests on.
const FEWEST: usize = 64;

/// One index of each of `count` equal stretches of `total` rays, at random within its stretch, ascending. All of them
/// where `count` is not less than `total`.
pub(super) fn stratified(total: usize, count: usize, seed: u64) -> Vec<usize> {
    if count >= total {
        return (0..total).collect();
    }
    let mut random = Pcg32::new(seed, 7);
    (0..count)
        .map(|k| {
            let from = k * total / count;
            let length = (k + 1) * total / count - from;
            from + ((u64::from(random.next_u32()) * length as u64) >> 32) as usize
        })
        .collect()
}

/// How many of `rays` are traced in a sample: as many as take the share of the budget that a sample has; all, where these are
/// fewer or the budget asks for whole sets.
pub(super) fn measured(
    accel: &dyn Accelerator,
    query: Query,
    rays: &[Ray],
    budget: &Budget,
    seed: u64,
) -> usize {
    if budget.whole_sets {
        return rays.len();
    }
    let probe: Vec<Ray> = stratified(rays.len(), FEWEST, seed)
        .into_iter()
        .map(|i| rays[i])
        .collect();
    let (_, counts) = Answers::counted(accel, query, &probe);
    let work: u64 = counts.iter().map(|c| c.steps + c.tests).sum();
    let seconds_a_ray = work as f64 / probe.len().max(1) as f64 / WORK_PER_SECOND;
    let seconds_a_sample = budget.run_seconds / budget.min_samples as f64;
    let fit = (seconds_a_sample / seconds_a_ray) as usize;
    fit.max(FEWEST).min(rays.len())
}

/// How many of `total` rays are checked against brute force over `triangles`: as many as the budget names, as long as
/// brute force needs no more than eight runs' time for them.
pub(super) fn checked(total: usize, triangles: usize, budget: &Budget) -> usize {
    let affordable = 8.0 * budget.run_seconds * WORK_PER_SECOND / triangles.max(1) as f64;
    budget
        .checked_rays
        .min((affordable as usize).max(FEWEST))
        .min(total)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_subset_has_one_ray_of_every_stretch() {
        let chosen = stratified(1003, 10, 5);
        assert_eq!(chosen.len(), 10);
        for (k, i) in chosen.iter().enumerate() {
            assert!(*i >= k * 1003 / 10 && *i < (k + 1) * 1003 / 10);
        }
        assert_eq!(chosen, stratified(1003, 10, 5));
        assert_ne!(chosen, stratified(1003, 10, 6));
    }

    #[test]
    fn a_subset_of_all_is_all() {
        assert_eq!(stratified(3, 3, 1), [0, 1, 2]);
        assert_eq!(stratified(3, 9, 1), [0, 1, 2]);
        assert!(stratified(0, 9, 1).is_empty());
    }

    #[test]
    fn checks_stay_affordable_on_large_scenes() {
        let budget = Budget::quick();
        assert_eq!(checked(10_000, 1000, &budget), budget.checked_rays);
        assert_eq!(checked(100, 1000, &budget), 100);
        assert!(checked(10_000, 4_000_000, &budget) < budget.checked_rays);
        assert_eq!(checked(10_000, usize::MAX, &budget), FEWEST);
    }
}
