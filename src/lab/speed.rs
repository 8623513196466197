//! The speed of one structure on one list of rays, measured on its own.

use crate::accel::Accelerator;
use crate::geometry::Ray;
use crate::stats::Summary;
use crate::trace::Query;

use super::Budget;
use super::answers::Answers;
use super::sampling::stop_reason;

/// Millions of rays a second of `accel` on `rays`, in the rayon pool that this is called in.
///
/// As in a sweep: a sample is the whole list, traced as often as a sample needs to be long enough, after one warm-up
/// pass that does not count; nothing is interleaved, since there is nothing to compare with. No rays give no samples.
#[must_use]
pub fn speed(
    accel: &dyn Accelerator,
    rays: &[Ray],
    query: Query,
    budget: &Budget,
    seed: u64,
) -> Summary {
    if rays.is_empty() {
        return Summary::default();
    }
    let mut answers = Answers::room(query, rays.len());
    let _warm_up = answers.time(accel, rays, 0.0);
    let mut speeds = Vec::new();
    let mut spent = 0.0;
    while stop_reason(&speeds, spent, budget, seed).is_none() {
        let (speed, took) = answers.time(accel, rays, budget.sample_seconds);
        speeds.push(speed);
        spent += took;
    }
    Summary::of(&speeds, seed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel;
    use crate::kernel;
    use crate::scene;
    use crate::trace;

    #[test]
    fn a_speed_has_as_many_samples_as_the_budget_asks_for_and_none_without_rays() {
        let scene = scene::load("one").unwrap();
        let brute = accel::parse("brute").unwrap();
        let kernel = kernel::parse("woop").unwrap();
        let built = accel::build(&scene.mesh, &brute, None, &kernel, u64::MAX).unwrap();
        let rays = trace::ray_set(&scene, "primary", 64, 1).unwrap();
        let budget = Budget {
            sample_seconds: 1e-4,
            ..Budget::quick()
        };
        let speed = speed(built.as_ref(), &rays.rays, rays.query, &budget, 1);
        assert!((budget.min_samples..=budget.max_samples).contains(&speed.samples.len()));
        assert!(speed.lo <= speed.median && speed.median <= speed.hi && speed.lo > 0.0);
        let none = super::speed(built.as_ref(), &[], rays.query, &budget, 1);
        assert!(none.samples.is_empty());
    }
}
