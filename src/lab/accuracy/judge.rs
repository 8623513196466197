//! What a method's answers are worth by the truth.
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
//! A neighbour that shares a corner with a triangle of the tie set may be seen at a slope, where a rounding error across
//! the ray is a longer way along it: for it, |t − t*|·|d| is multiplied by the sine of the angle between ray and plane.
//! The tolerance knows nothing of the method.
//!
//! **Errors**, over right hits. Of t: |t − t*| in units of the last place of t*, the distance of neighbouring `f32` around
//! it; half an ulp is the best that a rounded t can be. Of the point: the distance of o + t·d, computed in `f32` as a
//! renderer does, from the plane of the triangle, as a share of the diagonal of the scene's box. Of the barycentric
//! weights: the greater of |u − u*| and |v − v*|. Both true values are computed in `f64`, which for weights of triangles
//! thinner than 1 : 10⁸ as the ray sees them is itself no better than an `f32`.

use std::sync::Arc;

use rayon::prelude::*;

use crate::accel::Accelerator;
use crate::geometry::{DVec3, Hit, Ray, Vec3};
use crate::oracle::Oracle;
use crate::scene::Mesh;
use crate::stats::{Histogram, upper95};
use crate::trace::BATCH;

use super::truth::{self, Truth, TruthBatch};
use super::{Accuracy, AccuracyBounds, ErrorSpread, Place};

/// Unit roundoff of `f32`.
const U: f64 = 1.0 / (1 << 24) as f64;

/// Roundings within which two hits are the same point.
const SAME_POINT: f64 = 64.0 * U;

/// What the oracle says of a list of rays, and how large the mesh is.
#[derive(Debug)]
pub(in crate::lab) struct Truths {
    /// One for each [`BATCH`] rays.
    batches: Vec<TruthBatch>,
    mesh: Arc<Mesh>,
    /// Largest absolute coordinate of the mesh.
    extent: f64,
    /// Diagonal of the mesh's box.
    diagonal: f64,
}

impl Truths {
    /// Asks the oracle of `mesh`, in the current rayon pool.
    pub fn new(oracle: &Oracle, mesh: &Arc<Mesh>, rays: &[Ray]) -> Self {
        let bounds = mesh.bounds();
        Self {
            batches: truth::batches(oracle, rays),
            mesh: Arc::clone(mesh),
            extent: f64::from(bounds.max_abs()),
            diagonal: (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length(),
        }
    }

    /// Asks `accel` both queries about all rays, batch by batch in the current rayon pool, and counts what the answers
    /// are worth. Nothing is kept of an answer once it is judged.
    pub(super) fn judge(&self, accel: &dyn Accelerator, rays: &[Ray], place: Place) -> Accuracy {
        let batches = rays.par_chunks(BATCH).zip(&self.batches).with_max_len(1);
        let tally = batches.fold(Tally::default, |mut tally, (rays, truths)| {
            let mut hits = vec![Hit::MISS; rays.len()];
            let mut blocked = vec![false; rays.len()];
            accel.closest(rays, &mut hits);
            accel.occluded(rays, &mut blocked);
            self.tally(&mut tally, truths, rays, &hits, &blocked);
            tally
        });
        tally
            .reduce(Tally::default, |one, other| one.joined(&other))
            .accuracy(place)
    }

    /// How many of the answers to all rays are wrong decisions: leaks, phantoms and wrong surfaces.
    pub fn wrong(&self, rays: &[Ray], hits: &[Hit]) -> u64 {
        let wrong = |(i, (ray, hit)): &(usize, (&Ray, &Hit))| {
            let worth = self.worth_of(*i, ray, hit);
            matches!(worth, Worth::Leak | Worth::Phantom | Worth::WrongSurface)
        };
        rays.iter().zip(hits).enumerate().filter(wrong).count() as u64
    }

    /// What the answer to ray `i` of the list is worth.
    pub fn worth_of(&self, i: usize, ray: &Ray, hit: &Hit) -> Worth {
        let batch = &self.batches[i / BATCH];
        self.worth(batch, &batch.truths[i % BATCH], ray, hit)
    }

    /// Whether ray `i` and its answer both hit, but not in the same point within rounding, whichever triangle is named.
    pub fn astray(&self, i: usize, ray: &Ray, hit: &Hit) -> bool {
        let truth = &self.batches[i / BATCH].truths[i % BATCH];
        let off = (f64::from(hit.t) - truth.t).abs();
        // Both are false for NaN, which is astray.
        let near = off <= ulp(truth.t) || self.same_point(ray, truth.t, hit.t, 1.0);
        truth.is_hit() && hit.is_hit() && !near
    }

    fn tally(
        &self,
        tally: &mut Tally,
        truths: &TruthBatch,
        rays: &[Ray],
        hits: &[Hit],
        blocked: &[bool],
    ) {
        tally.rays += rays.len() as u64;
        let answers = hits.iter().zip(blocked);
        for ((truth, ray), (hit, blocked)) in truths.truths.iter().zip(rays).zip(answers) {
            tally.ties += u64::from(truth.is_tie());
            tally.occlusion_disagreements += u64::from(hit.is_hit() != *blocked);
            match self.worth(truths, truth, ray, hit) {
                Worth::Right => self.add_errors(tally, truth, ray, hit),
                Worth::RightMiss => {}
                Worth::Leak => tally.leaks += 1,
                Worth::Phantom => tally.phantoms += 1,
                Worth::WrongSurface => tally.wrong_surface += 1,
                Worth::NeighbourSwap => tally.neighbour_swaps += 1,
            }
        }
    }

    fn worth(&self, truths: &TruthBatch, truth: &Truth, ray: &Ray, hit: &Hit) -> Worth {
        match (truth.is_hit(), hit.is_hit()) {
            (false, false) => Worth::RightMiss,
            (false, true) => Worth::Phantom,
            (true, false) => Worth::Leak,
            (true, true) if truths.allows(truth, hit.prim) => Worth::Right,
            (true, true) if self.same_point(ray, truth.t, hit.t, 1.0) => Worth::NeighbourSwap,
            (true, true) if self.beside(truths, truth, ray, hit) => Worth::NeighbourSwap,
            (true, true) => Worth::WrongSurface,
        }
    }

    /// Whether `hit` names a neighbour of a triangle of the tie set that the ray passes within rounding.
    fn beside(&self, truths: &TruthBatch, truth: &Truth, ray: &Ray, hit: &Hit) -> bool {
        let corners = self.mesh.corners(hit.prim);
        let touches = |prim: u32| self.mesh.corners(prim).iter().any(|c| corners.contains(c));
        let dir = ray.dir.as_dvec3();
        let sine = normal(&corners).dot(dir).abs() / dir.length();
        truths.tie_set(truth).any(touches) && self.same_point(ray, truth.t, hit.t, sine)
    }

    /// Whether the points at `exact` and at `t` are the same within rounding, where what lies between them counts
    /// `share` of its length.
    fn same_point(&self, ray: &Ray, exact: f64, t: f32, share: f64) -> bool {
        let off = (f64::from(t) - exact).abs() * share;
        let length = ray.dir.as_dvec3().length();
        let coordinates = self.extent.max(f64::from(ray.origin.abs().max_element()));
        off * length <= SAME_POINT * (coordinates + exact.abs() * length)
    }

    /// Counts the errors of a right hit.
    fn add_errors(&self, tally: &mut Tally, truth: &Truth, ray: &Ray, hit: &Hit) {
        let corners = self.mesh.corners(hit.prim);
        // JSON has no infinity; an error that is none or no number is as wrong as a number can say.
        let counted = |error: f64| if error < f64::MAX { error } else { f64::MAX };
        let off = (f64::from(hit.t) - truth.t).abs();
        tally.t_ulp.add(counted(off / ulp(truth.t)));
        let distance = distance_to_plane(ray.at(hit.t), &corners);
        tally.plane.add(counted(distance / self.diagonal));
        let [u, v] = weights(ray, &corners);
        let off = [(hit.u, u), (hit.v, v)].map(|(found, exact)| (f64::from(found) - exact).abs());
        tally.barycentric.add(counted(off[0]).max(counted(off[1])));
    }
}

/// What an answer is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::lab) enum Worth {
    /// A triangle of the tie set, at whatever t.
    Right,
    /// Nothing is hit, and the method says so.
    RightMiss,
    /// See the table above, as the rest.
    Leak,
    Phantom,
    WrongSurface,
    NeighbourSwap,
}

/// Counts of what answers are worth.
#[derive(Debug, Default)]
struct Tally {
    rays: u64,
    leaks: u64,
    phantoms: u64,
    wrong_surface: u64,
    neighbour_swaps: u64,
    occlusion_disagreements: u64,
    ties: u64,
    t_ulp: Histogram,
    plane: Histogram,
    barycentric: Histogram,
}

impl Tally {
    fn joined(mut self, other: &Self) -> Self {
        self.rays += other.rays;
        self.leaks += other.leaks;
        self.phantoms += other.phantoms;
        self.wrong_surface += other.wrong_surface;
        self.neighbour_swaps += other.neighbour_swaps;
        self.occlusion_disagreements += other.occlusion_disagreements;
        self.ties += other.ties;
        self.t_ulp.merge(&other.t_ulp);
        self.plane.merge(&other.plane);
        self.barycentric.merge(&other.barycentric);
        self
    }

    fn accuracy(&self, place: Place) -> Accuracy {
        let bound = |seen| upper95(seen, self.rays);
        Accuracy {
            offset: place.offset,
            scale: place.scale,
            rays: self.rays,
            leaks: self.leaks,
            phantoms: self.phantoms,
            wrong_surface: self.wrong_surface,
            neighbour_swaps: self.neighbour_swaps,
            occlusion_disagreements: self.occlusion_disagreements,
            ties: self.ties,
            t_ulp: ErrorSpread::of(&self.t_ulp),
            plane: Some(ErrorSpread::of(&self.plane)),
            barycentric: Some(ErrorSpread::of(&self.barycentric)),
            upper95: AccuracyBounds {
                leaks: bound(self.leaks),
                phantoms: bound(self.phantoms),
                wrong_surface: bound(self.wrong_surface),
                neighbour_swaps: bound(self.neighbour_swaps),
                occlusion_disagreements: bound(self.occlusion_disagreements),
            },
            ..Accuracy::default()
        }
    }
}

/// Distance of `point` from the plane of a triangle with area, in `f64`.
fn distance_to_plane(point: Vec3, corners: &[Vec3; 3]) -> f64 {
    (point.as_dvec3() - corners[0].as_dvec3())
        .dot(normal(corners))
        .abs()
}

/// The unit normal in `f64`; zero where there is no area.
fn normal(corners: &[Vec3; 3]) -> DVec3 {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let (e1, e2) = (b - a, c - a);
    // Scaled: products of tiny edges would vanish, and their square.
    (e1 / e1.length())
        .cross(e2 / e2.length())
        .normalize_or_zero()
}

/// Barycentric weights of vertices 1 and 2 where the ray's line crosses the triangle's plane, in `f64`.
fn weights(ray: &Ray, corners: &[Vec3; 3]) -> [f64; 2] {
    let dir = ray.dir.as_dvec3();
    let [a, b, c] = corners.map(|v| v.as_dvec3() - ray.origin.as_dvec3());
    // Each from the edge opposite its vertex, so that a point on an edge has a weight of 0 without cancellation.
    let [wa, wb, wc] = [(b, c), (c, a), (a, b)].map(|(p, q)| dir.dot(p.cross(q)));
    let sum = wa + wb + wc;
    [wb / sum, wc / sum]
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
    use super::*;

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
        let mut tally = Tally::default();
        let truths = Truths::new(&oracle, &mesh, &rays);
        if let [batch] = truths.batches.as_slice() {
            truths.tally(&mut tally, batch, &rays, &hits, &blocked);
        }
        tally.accuracy(Place::ITS_OWN)
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
        assert_eq!(found.ties, 2);
        assert_eq!(found.wrong(), 3);
        assert!(found.upper95.leaks > 1.0 / 8.0 && found.upper95.leaks < 0.6);
    }

    #[test]
    fn the_same_surface_ends_at_64_roundings() {
        // M = 9 from the mesh, |t*|·|d| = 1: the tolerance is 640 u.
        let tolerance = (640.0 * U) as f32;
        let swap = judged(&[(through(0.5), hit(2, 1.0 + 0.99 * tolerance), true)]);
        let wrong = judged(&[(through(0.5), hit(2, 1.0 + 1.01 * tolerance), true)]);
        assert_eq!((swap.neighbour_swaps, swap.wrong_surface), (1, 0));
        assert_eq!((wrong.neighbour_swaps, wrong.wrong_surface), (0, 1));
    }

    #[test]
    fn a_neighbour_seen_at_a_slope_is_beside_and_a_stranger_at_the_same_t_is_not() {
        // The ray comes in at a slope of 1/1000 and is off by 1e-5 across, so by 1e-2 along.
        let ray = Ray::new(Vec3::new(0.5, -1.0, 1e-3), Vec3::new(0.0, 1.0, -1e-3));
        let off = 1.0 + 1e-2;
        let found = judged(&[(ray, hit(0, off), true), (ray, hit(2, off), true)]);
        assert_eq!((found.neighbour_swaps, found.wrong_surface), (1, 1));
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
    fn errors_of_points_and_weights_are_those_of_a_shifted_answer() {
        // The box of the setting has a diagonal of √(18² + 18² + 1).
        let diagonal = 649_f64.sqrt();
        let exact = Hit {
            u: 0.5,
            v: 0.25,
            ..hit(1, 1.0)
        };
        let shifted = Hit {
            t: 1.25,
            u: 0.53125,
            ..exact
        };
        let ray = Ray::new(Vec3::new(0.25, 0.25, -1.0), Vec3::Z);
        let found = judged(&[(ray, exact, true), (ray, shifted, true)]);
        let plane = found.plane.unwrap();
        assert!((plane.max - 0.25 / diagonal).abs() < 1e-12 && plane.p50 == 0.0);
        assert_eq!(found.barycentric.unwrap().max, 0.03125);
        let broken = Hit {
            t: f32::NAN,
            u: f32::NAN,
            ..exact
        };
        let found = judged(&[(ray, broken, true)]);
        assert_eq!(found.barycentric.unwrap().max, f64::MAX);
    }

    #[test]
    fn no_rays_are_no_errors_and_prove_nothing() {
        let none = judged(&[]);
        assert_eq!((none.rays, none.wrong()), (0, 0));
        assert_eq!(none.upper95.phantoms, 1.0);
    }
}
