//! Batches: the threads of the current rayon pool take a ray set from its front, a batch at a time, until nothing is left.
//!
//! ```text
//! rays, answers: │ batch │ batch │ batch │ batch │ bat │ ba │ b │ b │
//! thread 1         ━━━━━━━         ━━━━━━━━━━━━━━━       ━━━━━━
//! thread 2                 ━━━━━━━                 ━━━━━━      ━━━━━
//! ```
//!
//! Answers land at their ray's index, so they do not depend on the number of threads. Towards the end batches become smaller,
//! so that nobody waits long for the last one. Cut into halves and quarters by rayon's iterators instead, with batches of one
//! size, two threads gave 1.85 to 1.90 times one thread's speed on fifty to eighty thousand bounce rays (plant, armadillo); so
//! taken 1.98. On half a million rays both give the same (`bvh-wide`, the upper tenth of samples, four processes each in turn).

use std::mem;
use std::sync::{Mutex, PoisonError};

use crate::accel::{Accelerator, Counts};
use crate::geometry::{Hit, Ray};

/// Rays of a batch: four tiles of 32 × 32 pixels, long enough (half a millisecond) that neither handing it to a thread costs
/// anything nor a structure's finding out which way of tracing suits it; with a quarter as many random rays are a tenth
/// slower in `bvh-wide`.
pub const BATCH: usize = 4096;

/// Rays of the last batches. Between 256 and 1024 it makes no difference.
const LAST: usize = 512;

/// Rays of the smallest batches that few rays are shared out in: a packet.
const PACKET: usize = 16;

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
    let mut counts = vec![Counts::default(); rays.len()];
    each(
        rays,
        (&mut hits[..], &mut counts[..]),
        |rays, (hits, counts)| {
            accel.closest_counted(rays, hits, counts);
        },
    );
    (hits, counts)
}

/// As [`occluded`], with the work of each ray.
#[must_use]
pub fn occluded_counted(accel: &dyn Accelerator, rays: &[Ray]) -> (Vec<bool>, Vec<Counts>) {
    let mut blocked = vec![false; rays.len()];
    let mut counts = vec![Counts::default(); rays.len()];
    each(
        rays,
        (&mut blocked[..], &mut counts[..]),
        |rays, (blocked, counts)| {
            accel.occluded_counted(rays, blocked, counts);
        },
    );
    (blocked, counts)
}

/// Calls `trace` for each batch, on all threads of the pool. With one thread rayon is not involved at all.
fn each<R: Room>(rays: &[Ray], answers: R, trace: impl Fn(&[Ray], R) + Sync) {
    let threads = rayon::current_num_threads();
    let rest = Mutex::new(Rest::new(rays, answers, threads));
    let take = || rest.lock().unwrap_or_else(PoisonError::into_inner).next();
    let work = || {
        while let Some((rays, answers)) = take() {
            trace(rays, answers);
        }
    };
    if threads == 1 {
        work();
    } else {
        // A thread that is busy elsewhere need not come.
        rayon::scope(|scope| {
            for _ in 1..threads {
                scope.spawn(|_| work());
            }
            work();
        });
    }
}

/// Room for answers, one for each ray: a slice, or several side by side.
trait Room: Send + Default {
    /// Those of the first `count` rays, and the others.
    fn split(self, count: usize) -> (Self, Self);
}

impl<T: Send> Room for &mut [T] {
    fn split(self, count: usize) -> (Self, Self) {
        self.split_at_mut(count)
    }
}

impl<A: Room, B: Room> Room for (A, B) {
    fn split(self, count: usize) -> (Self, Self) {
        let (first, rest) = (self.0.split(count), self.1.split(count));
        ((first.0, rest.0), (first.1, rest.1))
    }
}

/// What no thread has taken yet. An iterator over batches.
struct Rest<'a, R> {
    rays: &'a [Ray],
    answers: R,
    threads: usize,
    /// Rays of the smallest batch.
    least: usize,
}

impl<'a, R> Rest<'a, R> {
    fn new(rays: &'a [Ray], answers: R, threads: usize) -> Self {
        Self {
            rays,
            answers,
            threads,
            least: match threads {
                1 => BATCH,
                _ => (rays.len() / (4 * threads)).clamp(PACKET, LAST),
            },
        }
    }
}

impl<'a, R: Room> Iterator for Rest<'a, R> {
    type Item = (&'a [Ray], R);

    /// About a third of a thread's share of what is left: a power of two, so that tiles of a picture stay whole.
    fn next(&mut self) -> Option<Self::Item> {
        if self.rays.is_empty() {
            return None;
        }
        let share = (self.rays.len() / (2 * self.threads)).clamp(self.least, BATCH);
        let count = (1 << share.ilog2()).min(self.rays.len());
        let (rays, rest) = self.rays.split_at(count);
        let (answers, others) = mem::take(&mut self.answers).split(count);
        self.rays = rest;
        self.answers = others;
        Some((rays, answers))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::{Duration, Instant};

    use glam::Vec3;

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

    /// Rays of each batch that `threads` take of `count`.
    fn batches(count: usize, threads: usize) -> Vec<usize> {
        let rays = vec![Ray::new(Vec3::ZERO, Vec3::X); count];
        let mut answers = vec![0; count];
        let rest = Rest::new(&rays, &mut answers[..], threads);
        let batches = rest.map(|(rays, answers)| {
            assert_eq!(rays.len(), answers.len());
            rays.len()
        });
        batches.collect()
    }

    #[test]
    fn batches_become_smaller_and_are_all_rays() {
        for (count, threads) in [(100_000, 2), (99_999, 16), (5000, 3), (200, 64), (17, 2)] {
            let batches = batches(count, threads);
            assert_eq!(batches.iter().sum::<usize>(), count);
            assert!(batches.is_sorted_by(|a, b| a >= b), "{batches:?}");
            let (_, whole) = batches.split_last().unwrap();
            let whole_packets = |rays: &usize| rays.is_power_of_two() && *rays >= PACKET;
            assert!(whole.iter().all(whole_packets), "{batches:?}");
        }
        let many = batches(100_000, 2);
        assert_eq!(many[0], BATCH);
        assert_eq!(many[many.len() - 2], LAST);
        assert_eq!(batches(10_000, 1), [4096, 4096, 1808]);
    }

    #[test]
    fn few_rays_are_shared_among_all_threads() {
        assert!(batches(200, 2).len() >= 4);
        assert_eq!(batches(200, 64)[0], PACKET);
        assert!(batches(0, 4).is_empty());
    }

    #[test]
    fn all_threads_take_batches_at_once() {
        const THREADS: usize = 3;
        let rays = vec![Ray::new(Vec3::ZERO, Vec3::X); 100];
        let mut takers = vec![None; 100];
        let begun = AtomicUsize::new(0);
        let patience = Instant::now() + Duration::from_mins(1);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(THREADS);
        pool.build().unwrap().install(|| {
            each(&rays, &mut takers[..], |_, takers| {
                begun.fetch_add(1, Ordering::Relaxed);
                while begun.load(Ordering::Relaxed) < THREADS && Instant::now() < patience {
                    std::thread::yield_now();
                }
                takers.fill(rayon::current_thread_index());
            });
        });
        let takers: BTreeSet<_> = takers.into_iter().map(Option::unwrap).collect();
        assert_eq!(takers.len(), THREADS);
    }

    #[test]
    fn no_rays_are_no_answers() {
        let brute = fixture::brute(&fixture::empty());
        assert!(closest(&*brute, &[]).is_empty());
        assert!(occluded_counted(&*brute, &[]).1.is_empty());
    }
}
