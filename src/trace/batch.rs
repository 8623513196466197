//! Batches: a ray set is cut into slices of at most [`BATCH`] rays, which the threads of the current rayon pool take in turn.
//!
//! Answers land at their ray's index, so they do not depend on the number of threads. Each batch can be taken by any thread:
//! left to itself rayon cuts a set in four for two threads, and the one whose rays are cheap, where a picture is empty, waits
//! for the other (primary rays of the Crytek Sponza: two threads gave 1.2 times one).

use rayon::prelude::*;

use crate::accel::{Accelerator, Counts};
use crate::geometry::{Hit, Ray};

/// Rays of a batch: four tiles of 32 × 32 pixels, long enough (half a millisecond) that neither handing it to a thread costs
/// anything nor a structure's finding out which way of tracing suits it; with a quarter as many random rays are a tenth
/// slower in `bvh-wide`.
pub const BATCH: usize = 4096;

/// The nearest hit of each ray.
#[must_use]
pub fn closest(accel: &dyn Accelerator, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = vec![Hit::MISS; rays.len()];
    closest_into(accel, rays, &mut hits);
    hits
}

/// As [`closest`], into `hits`, which is as long as `rays`: what timed samples call.
pub fn closest_into(accel: &dyn Accelerator, rays: &[Ray], hits: &mut [Hit]) {
    each(rays, hits, |rays, hits| accel.closest(rays, hits));
}

/// Whether anything lies within each ray's interval.
#[must_use]
pub fn occluded(accel: &dyn Accelerator, rays: &[Ray]) -> Vec<bool> {
    let mut blocked = vec![false; rays.len()];
    occluded_into(accel, rays, &mut blocked);
    blocked
}

/// As [`occluded`], into `blocked`, which is as long as `rays`: what timed samples call.
pub fn occluded_into(accel: &dyn Accelerator, rays: &[Ray], blocked: &mut [bool]) {
    each(rays, blocked, |rays, blocked| accel.occluded(rays, blocked));
}

/// As [`closest`], with the work of each ray.
#[must_use]
pub fn closest_counted(accel: &dyn Accelerator, rays: &[Ray]) -> (Vec<Hit>, Vec<Counts>) {
    let mut hits = vec![Hit::MISS; rays.len()];
    let counts = counted(rays, &mut hits, |rays, hits, counts| {
        accel.closest_counted(rays, hits, counts);
    });
    (hits, counts)
}

/// As [`occluded`], with the work of each ray.
#[must_use]
pub fn occluded_counted(accel: &dyn Accelerator, rays: &[Ray]) -> (Vec<bool>, Vec<Counts>) {
    let mut blocked = vec![false; rays.len()];
    let counts = counted(rays, &mut blocked, |rays, blocked, counts| {
        accel.occluded_counted(rays, blocked, counts);
    });
    (blocked, counts)
}

/// Calls `trace` for each batch. With one thread rayon is not involved at all.
fn each<T: Send>(rays: &[Ray], answers: &mut [T], trace: impl Fn(&[Ray], &mut [T]) + Sync) {
    if rayon::current_num_threads() == 1 {
        for (rays, answers) in rays.chunks(BATCH).zip(answers.chunks_mut(BATCH)) {
            trace(rays, answers);
        }
    } else {
        let batch = batch(rays.len(), rayon::current_num_threads());
        rays.par_chunks(batch)
            .zip(answers.par_chunks_mut(batch))
            .with_max_len(1)
            .for_each(|(rays, answers)| trace(rays, answers));
    }
}

/// Rays of a batch: fewer where there would not be four batches a thread, but whole packets of 16.
fn batch(rays: usize, threads: usize) -> usize {
    BATCH
        .min(rays.div_ceil(4 * threads).next_multiple_of(16))
        .max(16)
}

/// Calls `trace` for each batch and gives the work of each ray.
fn counted<T: Send>(
    rays: &[Ray],
    answers: &mut [T],
    trace: impl Fn(&[Ray], &mut [T], &mut [Counts]) + Sync,
) -> Vec<Counts> {
    let mut counts = vec![Counts::default(); rays.len()];
    let batch = batch(rays.len(), rayon::current_num_threads());
    rays.par_chunks(batch)
        .zip(answers.par_chunks_mut(batch))
        .zip(counts.par_chunks_mut(batch))
        .with_max_len(1)
        .for_each(|((rays, answers), counts)| trace(rays, answers, counts));
    counts
}

#[cfg(test)]
mod tests {
    use super::super::{fixture, ray_set};
    use super::*;

    #[test]
    fn answers_and_counts_do_not_depend_on_the_number_of_threads() {
        let scene = fixture::floor_and_ceiling();
        let rays = ray_set(&scene, "random", 5000, 3).unwrap().rays;
        let brute = fixture::brute(&scene);
        let trace = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| {
                (
                    closest(&*brute, &rays),
                    closest_counted(&*brute, &rays),
                    occluded(&*brute, &rays),
                    occluded_counted(&*brute, &rays),
                )
            })
        };
        let one = trace(1);
        assert_eq!(one, trace(3));
        assert_eq!(one.0, one.1.0);
        assert_eq!(one.2, one.3.0);
        assert!(
            one.0
                .iter()
                .zip(&one.2)
                .all(|(hit, blocked)| hit.is_hit() == *blocked)
        );
        assert!(one.0.iter().any(Hit::is_hit) && one.0.iter().any(|h| !h.is_hit()));
    }

    #[test]
    fn few_rays_are_shared_among_all_threads() {
        assert_eq!(batch(100_000, 2), BATCH);
        assert_eq!(batch(200, 2), 32);
        assert_eq!(batch(200, 64), 16);
        assert_eq!(batch(0, 4), 16);
    }

    #[test]
    fn no_rays_are_no_answers() {
        let brute = fixture::brute(&fixture::empty());
        assert!(closest(&*brute, &[]).is_empty());
        assert!(occluded_counted(&*brute, &[]).1.is_empty());
    }
}
