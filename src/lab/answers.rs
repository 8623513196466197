//! The answers of one query over a list of rays, whichever query it is.

use std::time::Instant;

use crate::accel::{Accelerator, Counts};
use crate::geometry::{Hit, Ray};
use crate::oracle::{Oracle, Verdict, arbitrate, arbitrate_occluded};
use crate::trace::{self, Query};

use super::Checksum;

/// One answer a ray.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Answers {
    /// Of closest-hit queries.
    Hits(Vec<Hit>),
    /// Of occlusion queries.
    Blocked(Vec<bool>),
}

impl Answers {
    /// Room for the answers of `count` rays; all miss.
    pub fn room(query: Query, count: usize) -> Self {
        match query {
            Query::Closest => Self::Hits(vec![Hit::MISS; count]),
            Query::Occluded => Self::Blocked(vec![false; count]),
        }
    }

    /// The answers of `accel`, by the uncounted methods.
    pub fn of(accel: &dyn Accelerator, query: Query, rays: &[Ray]) -> Self {
        let mut answers = Self::room(query, rays.len());
        answers.trace(accel, rays);
        answers
    }

    /// Traces `rays`, as many as there is room for, by the uncounted methods: this is what is timed.
    pub fn trace(&mut self, accel: &dyn Accelerator, rays: &[Ray]) {
        match self {
            Self::Hits(hits) => trace::closest_into(accel, rays, hits),
            Self::Blocked(blocked) => trace::occluded_into(accel, rays, blocked),
        }
    }

    /// Traces `rays` again and again for at least `seconds`, at least once; returns the speed in millions of rays a second
    /// and the seconds that it took. This is how every sample is timed.
    pub fn time(&mut self, accel: &dyn Accelerator, rays: &[Ray], seconds: f64) -> (f64, f64) {
        let start = Instant::now();
        let mut passes = 0_u64;
        loop {
            self.trace(accel, rays);
            passes += 1;
            let took = start.elapsed().as_secs_f64();
            if took >= seconds {
                // A clock that did not move: the finest step that it could have made.
                let took = took.max(1e-9);
                return (passes as f64 * rays.len() as f64 / took * 1e-6, took);
            }
        }
    }

    /// The answers of `accel` with the work of each ray.
    pub fn counted(accel: &dyn Accelerator, query: Query, rays: &[Ray]) -> (Self, Vec<Counts>) {
        match query {
            Query::Closest => {
                let (hits, counts) = trace::closest_counted(accel, rays);
                (Self::Hits(hits), counts)
            }
            Query::Occluded => {
                let (blocked, counts) = trace::occluded_counted(accel, rays);
                (Self::Blocked(blocked), counts)
            }
        }
    }

    /// The answers of the rays with these indices.
    pub fn pick(&self, indices: &[usize]) -> Self {
        match self {
            Self::Hits(hits) => Self::Hits(indices.iter().map(|i| hits[*i]).collect()),
            Self::Blocked(blocked) => Self::Blocked(indices.iter().map(|i| blocked[*i]).collect()),
        }
    }

    /// Indices of the rays that two lists of answers to one query answer differently.
    pub fn differences(&self, other: &Self) -> Vec<usize> {
        fn differing<T>(a: &[T], b: &[T], same: impl Fn(&T, &T) -> bool) -> Vec<usize> {
            let pairs = a.iter().zip(b).enumerate();
            pairs
                .filter_map(|(i, (a, b))| (!same(a, b)).then_some(i))
                .collect()
        }
        match (self, other) {
            (Self::Hits(a), Self::Hits(b)) => differing(a, b, Hit::same_answer),
            (Self::Blocked(a), Self::Blocked(b)) => differing(a, b, bool::eq),
            _ => Vec::new(),
        }
    }

    /// Judges the answers of an accelerator against these of brute force with the same kernel, ray by ray.
    pub fn judge(&self, oracle: &Oracle, rays: &[Ray], others: &Self) -> Findings {
        let mut findings = Findings::default();
        for i in self.differences(others) {
            let verdict = match (self, others) {
                (Self::Hits(brute), Self::Hits(other)) => {
                    arbitrate(oracle, &rays[i], &brute[i], &other[i])
                }
                (Self::Blocked(brute), Self::Blocked(other)) => {
                    arbitrate_occluded(oracle, &rays[i], brute[i], other[i])
                }
                _ => Verdict::Same,
            };
            findings.add(verdict);
        }
        findings
    }

    /// What identifies these answers.
    pub fn checksum(&self) -> Checksum {
        let mut sum = Checksum::default();
        match self {
            Self::Hits(hits) => {
                for hit in hits.iter().filter(|h| h.is_hit()) {
                    sum.hits += 1;
                    sum.id_sum = (sum.id_sum + u64::from(hit.prim)) % (1 << 53);
                    // JSON has no infinity.
                    if hit.t.is_finite() {
                        sum.t_sum += f64::from(hit.t);
                    }
                }
            }
            Self::Blocked(blocked) => sum.hits = blocked.iter().filter(|b| **b).count() as u64,
        }
        sum
    }
}

/// How often answers were judged wrong.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Findings {
    /// Rays on which the kernel errs and the answers differ.
    pub kernel_errors: u64,
    /// Rays on which brute force is right and the accelerator differs.
    pub broken: u64,
}

impl Findings {
    /// Counts one verdict.
    pub fn add(&mut self, verdict: Verdict) {
        match verdict {
            Verdict::Same => {}
            Verdict::KernelError => self.kernel_errors += 1,
            Verdict::Broken => self.broken += 1,
        }
    }

    /// Adds others.
    pub fn merge(&mut self, other: Self) {
        self.kernel_errors += other.kernel_errors;
        self.broken += other.broken;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::Vec3;
    use crate::scene::Mesh;

    fn hit(prim: u32, t: f32) -> Hit {
        Hit {
            t,
            prim,
            ..Hit::MISS
        }
    }

    #[test]
    fn checksums_add_up_what_was_hit() {
        let hits = Answers::Hits(vec![
            hit(3, 0.5),
            Hit::MISS,
            hit(4, 0.25),
            hit(1, f32::INFINITY),
        ]);
        let sum = hits.checksum();
        assert_eq!((sum.hits, sum.id_sum, sum.t_sum), (3, 8, 0.75));
        assert_eq!(Answers::Blocked(vec![true, false, true]).checksum().hits, 2);
    }

    #[test]
    fn answers_differ_where_a_triangle_or_a_bit_of_t_does() {
        let a = Answers::Hits(vec![hit(1, 1.0), hit(1, 1.0), hit(1, 1.0), Hit::MISS]);
        let b = Answers::Hits(vec![
            hit(1, 1.0),
            hit(2, 1.0),
            hit(1, 1.000_000_1),
            Hit::MISS,
        ]);
        assert_eq!(a.differences(&b), [1, 2]);
        assert_eq!(a.pick(&[3, 1]), Answers::Hits(vec![Hit::MISS, hit(1, 1.0)]));
    }

    #[test]
    fn a_wrong_accelerator_is_told_from_a_wrong_kernel() {
        let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = Arc::new(Mesh::new(vertices, vec![[0, 1, 2]]).unwrap());
        let oracle = Oracle::new(&mesh);
        let through = Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z);
        let beside = Ray::new(Vec3::new(2.0, 2.0, 1.0), Vec3::NEG_Z);
        let rays = [through, beside, through];
        // Brute force is right on the first ray and sees a phantom on the second.
        let brute = Answers::Hits(vec![hit(0, 1.0), hit(0, 1.0), hit(0, 1.0)]);
        let other = Answers::Hits(vec![Hit::MISS, Hit::MISS, hit(0, 1.0)]);
        let expected = Findings {
            kernel_errors: 1,
            broken: 1,
        };
        assert_eq!(brute.judge(&oracle, &rays, &other), expected);
        let brute = Answers::Blocked(vec![true, true, true]);
        let other = Answers::Blocked(vec![false, false, true]);
        assert_eq!(brute.judge(&oracle, &rays, &other), expected);
    }
}
