//! What the oracle says of each ray, and what a method's answer to it is worth.
//!
//! | word | the oracle | the method |
//! |---|---|---|
//! | right | hits | names a triangle of the tie set, at whatever t; the error of t is reported apart |
//! | leak | hits | misses |
//! | phantom | misses | hits |
//! | neighbour swap | hits | names a triangle outside the tie set, on the same surface: harmless |
//! | wrong surface | hits | names a triangle outside the tie set, elsewhere |
//!
//! **Same surface.** A method that decides a shared edge the other way names the neighbour, where the ray passes its
//! rim within a rounding error. So *same surface* means that both hits are the same point within rounding:
//! |t − t*|·|d| <= 64 u (M + |t*|·|d|), with t* the exact t, d the direction, u = 2⁻²⁴, and M the largest absolute
//! coordinate of the mesh and of the ray's origin. 64 u is ten times what the sum of a handful of roundings can be, and
//! far below the distance of surfaces that a scene keeps apart; surfaces nearer to each other than that count as one.
//! The tolerance knows neither the method nor the triangles' neighbourhood, and shared edges seen at slopes below
//! 1/64 can be called wrong surfaces.
//!
//! **Error of t.** Over right hits, |t − t*| in units of the last place of t*: the distance of neighbouring `f32` around
//! it. Half an ulp is the best that a rounded t can be.

use rayon::prelude::*;

use crate::geometry::{Hit, Ray};
use crate::oracle::Oracle;
use crate::scene::Mesh;
use crate::stats::upper95;

use super::{Accuracy, AccuracyBounds, UlpSpread};

/// Unit roundoff of `f32`.
const U: f64 = 1.0 / (1 << 24) as f64;

/// Roundings within which two hits are the same point.
const SAME_POINT: f64 = 64.0 * U;

/// The truth of one ray, kept small: a set may have millions.
#[derive(Debug, Clone)]
enum Truth {
    Miss,
    Hit {
        t: f64,
        first: u32,
        /// The rest of the tie set, ascending; mostly none, which takes no memory elsewhere.
        others: Box<[u32]>,
    },
}

/// What the oracle says of a list of rays.
#[derive(Debug)]
pub(in crate::lab) struct Truths {
    truths: Vec<Truth>,
    /// Largest absolute coordinate of the mesh.
    extent: f64,
}

/// What an answer is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::lab) enum Worth {
    /// Right; the error of t in ulp.
    Right(f64),
    /// Nothing is hit, and the method says so.
    RightMiss,
    /// See the table above, as the rest.
    Leak,
    Phantom,
    WrongSurface,
    NeighbourSwap,
}

impl Truths {
    /// Asks the oracle, in the current rayon pool.
    pub fn new(oracle: &Oracle, mesh: &Mesh, rays: &[Ray]) -> Self {
        let truth = |ray: &Ray| {
            let truth = oracle.truth(ray);
            match (truth.t, truth.tie_set.as_slice()) {
                (Some(t), [first, others @ ..]) => Truth::Hit {
                    t: t.to_f64(),
                    first: *first,
                    others: others.into(),
                },
                _ => Truth::Miss,
            }
        };
        Self {
            truths: rays.par_iter().map(truth).collect(),
            extent: f64::from(mesh.bounds().max_abs()),
        }
    }

    /// Counts what the answers to both queries about the same rays are worth.
    pub fn judge(&self, rays: &[Ray], hits: &[Hit], blocked: &[bool], offset: f64) -> Accuracy {
        let mut found = Accuracy {
            offset,
            rays: rays.len() as u64,
            ..Accuracy::default()
        };
        let mut errors = Vec::new();
        for ((truth, ray), (hit, blocked)) in
            self.truths.iter().zip(rays).zip(hits.iter().zip(blocked))
        {
            found.occlusion_disagreements += u64::from(hit.is_hit() != *blocked);
            match self.worth(truth, ray, hit) {
                Worth::Right(ulp) => errors.push(ulp),
                Worth::RightMiss => {}
                Worth::Leak => found.leaks += 1,
                Worth::Phantom => found.phantoms += 1,
                Worth::WrongSurface => found.wrong_surface += 1,
                Worth::NeighbourSwap => found.neighbour_swaps += 1,
            }
        }
        let bound = |seen| upper95(seen, found.rays);
        found.upper95 = AccuracyBounds {
            leaks: bound(found.leaks),
            phantoms: bound(found.phantoms),
            wrong_surface: bound(found.wrong_surface),
            neighbour_swaps: bound(found.neighbour_swaps),
            occlusion_disagreements: bound(found.occlusion_disagreements),
        };
        found.t_ulp = UlpSpread::of(errors);
        found
    }

    /// What the answer to ray `i` of the list is worth.
    pub fn worth_of(&self, i: usize, ray: &Ray, hit: &Hit) -> Worth {
        self.worth(&self.truths[i], ray, hit)
    }

    /// Whether ray `i` and its answer both hit, but not in the same point within rounding, whichever triangle is named.
    pub fn astray(&self, i: usize, ray: &Ray, hit: &Hit) -> bool {
        match &self.truths[i] {
            Truth::Hit { t, .. } if hit.is_hit() => {
                let off = (f64::from(hit.t) - t).abs();
                // Both are false for NaN, which is astray.
                !(off <= ulp(*t) || self.same_point(ray, *t, off))
            }
            _ => false,
        }
    }

    fn worth(&self, truth: &Truth, ray: &Ray, hit: &Hit) -> Worth {
        match (truth, hit.is_hit()) {
            (Truth::Miss, false) => Worth::RightMiss,
            (Truth::Miss, true) => Worth::Phantom,
            (Truth::Hit { .. }, false) => Worth::Leak,
            (Truth::Hit { t, first, others }, true) => {
                // JSON has no infinity; an infinite t is as wrong as a number can say.
                let off = (f64::from(hit.t) - t).abs().min(f64::MAX);
                if hit.prim == *first || others.binary_search(&hit.prim).is_ok() {
                    Worth::Right((off / ulp(*t)).min(f64::MAX))
                } else if self.same_point(ray, *t, off) {
                    Worth::NeighbourSwap
                } else {
                    Worth::WrongSurface
                }
            }
        }
    }

    /// Whether hits at `t` and `off` beside it are the same point within rounding.
    fn same_point(&self, ray: &Ray, t: f64, off: f64) -> bool {
        let length = ray.dir.as_dvec3().length();
        let coordinates = self.extent.max(f64::from(ray.origin.abs().max_element()));
        off * length <= SAME_POINT * (coordinates + t.abs() * length)
    }
}

/// The distance of neighbouring `f32` around `t`.
fn ulp(t: f64) -> f64 {
    let near = (t.abs() as f32).min(f32::MAX);
    // The exponent of a subnormal number and of 0 is that of the least normal one.
    let exponent = (near.to_bits() >> 23).max(1) as i32 - 127;
    2f64.powi(exponent - 23)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::Vec3;

    /// Two triangles that share an edge at x = 0 in the plane z = 0, and one behind them at z = 1.
    fn setting() -> (Arc<Mesh>, Oracle) {
        let vertices = vec![
            -Vec3::X,
            Vec3::X,
            Vec3::Y,
            -Vec3::Y,
            Vec3::new(-9.0, -9.0, 1.0),
            Vec3::new(9.0, -9.0, 1.0),
            Vec3::new(0.0, 9.0, 1.0),
        ];
        let triangles = vec![[0, 2, 3], [1, 2, 3], [4, 5, 6]];
        let mesh = Arc::new(Mesh::new(vertices, triangles).unwrap());
        let oracle = Oracle::new(&mesh);
        (mesh, oracle)
    }

    fn through(x: f32) -> Ray {
        Ray::new(Vec3::new(x, 0.0, -1.0), Vec3::Z)
    }

    fn hit(prim: u32, t: f32) -> Hit {
        Hit {
            t,
            prim,
            ..Hit::MISS
        }
    }

    fn judged(answers: &[(Ray, Hit, bool)]) -> Accuracy {
        let (mesh, oracle) = setting();
        let rays: Vec<Ray> = answers.iter().map(|a| a.0).collect();
        let hits: Vec<Hit> = answers.iter().map(|a| a.1).collect();
        let blocked: Vec<bool> = answers.iter().map(|a| a.2).collect();
        Truths::new(&oracle, &mesh, &rays).judge(&rays, &hits, &blocked, 0.0)
    }

    #[test]
    fn each_kind_of_answer_is_counted_as_what_it_is() {
        let inside = through(0.5);
        let far = through(100.0);
        let found = judged(&[
            (inside, hit(1, 1.0), true),
            (inside, Hit::MISS, true),
            (far, hit(2, 2.0), true),
            (far, Hit::MISS, false),
            (inside, hit(2, 2.0), true),
            (inside, hit(0, 1.0_f32.next_up()), true),
            // On the shared edge both are right.
            (through(0.0), hit(0, 1.0), true),
            (through(0.0), hit(1, 1.0), true),
        ]);
        let counts = [
            found.rays,
            found.leaks,
            found.phantoms,
            found.wrong_surface,
            found.neighbour_swaps,
            found.occlusion_disagreements,
        ];
        assert_eq!(counts, [8, 1, 1, 1, 1, 1]);
        assert_eq!(found.wrong(), 3);
        assert!(found.upper95.leaks > 1.0 / 8.0 && found.upper95.leaks < 0.6);
    }

    #[test]
    fn the_same_surface_ends_at_64_roundings() {
        // M = 9 from the mesh, |t*|·|d| = 1: the tolerance is 640 u.
        let tolerance = (640.0 * U) as f32;
        let swap = judged(&[(through(0.5), hit(0, 1.0 + 0.99 * tolerance), true)]);
        let wrong = judged(&[(through(0.5), hit(0, 1.0 + 1.01 * tolerance), true)]);
        assert_eq!((swap.neighbour_swaps, swap.wrong_surface), (1, 0));
        assert_eq!((wrong.neighbour_swaps, wrong.wrong_surface), (0, 1));
    }

    #[test]
    fn errors_of_t_are_in_units_of_its_last_place() {
        let off = |t: f32| judged(&[(through(0.5), hit(1, t), true)]).t_ulp.max;
        assert_eq!(off(1.0), 0.0);
        assert_eq!(off(1.0_f32.next_up()), 1.0);
        assert_eq!(off(1.0_f32.next_down()), 0.5);
        assert!(off(f32::INFINITY).is_finite());
        assert_eq!(ulp(0.0), f64::from(f32::from_bits(1)));
        assert_eq!(ulp(1e300), 2f64.powi(104));
    }

    #[test]
    fn no_rays_are_no_errors_and_prove_nothing() {
        let none = judged(&[]);
        assert_eq!((none.rays, none.wrong()), (0, 0));
        assert_eq!(none.upper95.phantoms, 1.0);
    }
}
