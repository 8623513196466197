//! One ray and one triangle, judged exactly.
//!
//! ```text
//! p_i = v_i - o           s_i = det(d, p_i, p_(i+1)): on which side of edge i the ray's line passes
//! hit: all s_i >= 0 or all <= 0, not all 0;   t = det(p_0, e_1, e_2) / det(d, e_1, e_2)
//! ```
//!
//! A filter in `f64` decides nearly all cases. It cannot overflow or underflow: products of three differences of finite
//! `f32` lie between 2⁻⁴⁴⁷ and 2³⁹⁰. What it cannot decide is decided on integers.
//!
//! **Source:** J. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997,
//! for the filter. **Differs:** differences are rounded too, which the bound counts; the fallback is on integers, as
//! expansions underflow for tiny numbers.

use std::cmp::Ordering;

use crate::geometry::exact::{self, ExactInt, WideInt};
use crate::geometry::{DVec3, Ray, Vec3};

/// Seven or eight roundings of `f64`, (8 + ε)·2⁻⁵³, with room for the rounding of the permanent itself.
const FILTER: f64 = 9.5 * 1.110_223_024_625_156_5e-16;

/// The exact `t` at which a ray crosses a triangle's plane: a quotient of two integers, made only when it is needed.
#[derive(Debug, Clone, Copy)]
pub struct ExactT {
    approximate: f64,
    /// Bound on the error of `approximate`; may be infinite.
    error: f64,
    ray: Ray,
    corners: [Vec3; 3],
}

/// A determinant in `f64` and a bound on its error.
#[derive(Clone, Copy)]
struct Filtered {
    value: f64,
    error: f64,
}

impl Filtered {
    fn det(a: DVec3, b: DVec3, c: DVec3) -> Self {
        let value = a.dot(b.cross(c));
        let (a, b, c) = (a.abs(), b.abs(), c.abs());
        let permanent = a.x * (b.y * c.z + b.z * c.y)
            + a.y * (b.z * c.x + b.x * c.z)
            + a.z * (b.x * c.y + b.y * c.x);
        Self {
            value,
            error: FILTER * permanent,
        }
    }

    /// The sign, or `None` where the error could change it.
    fn sign(self) -> Option<i32> {
        if self.error == 0.0 {
            // Every product has a factor 0.
            Some(0)
        } else if self.value.abs() > self.error {
            Some(if self.value > 0.0 { 1 } else { -1 })
        } else {
            None
        }
    }
}

/// Where `ray` hits the triangle with these corners; `None` for a miss, in the plane, or outside `[t_min, t_max]`.
///
/// Both ends of the interval belong to it, and so do the triangle's edges and vertices. A triangle without area is
/// never hit. Exact for all finite numbers.
#[must_use]
pub fn judge_triangle(ray: &Ray, corners: &[Vec3; 3]) -> Option<ExactT> {
    if !line_meets(ray, corners) {
        return None;
    }
    let t = ExactT::new(ray, corners);
    (t.cmp_f32(ray.t_min) != Ordering::Less && t.cmp_f32(ray.t_max) != Ordering::Greater)
        .then_some(t)
}

/// Whether the ray's whole line meets the triangle in one point.
fn line_meets(ray: &Ray, corners: &[Vec3; 3]) -> bool {
    let dir = ray.dir.as_dvec3();
    let p = corners.map(|v| v.as_dvec3() - ray.origin.as_dvec3());
    let signs = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| Filtered::det(dir, p[i], p[j]).sign());
    // A pair of opposite signs is a miss, whatever the third.
    if signs.contains(&Some(1)) && signs.contains(&Some(-1)) {
        return false;
    }
    let signs = if signs.contains(&None) {
        exact_signs(ray, corners, signs)
    } else {
        signs.map(Option::unwrap_or_default)
    };
    // All 0: the ray lies in the plane, or the triangle has no area.
    signs != [0; 3] && !(signs.contains(&1) && signs.contains(&-1))
}

/// Limbs that hold a product of two determinants of coordinates that span at most [`NARROW_SPAN`] bits, as nearly all
/// do: 6·(80 + 1) + 8 bits.
const NARROW: usize = 8;
const NARROW_SPAN: u32 = 80;
/// Limbs that hold it for any.
const WIDE: usize = 28;

/// Bits that the coordinates of ray and corners span.
fn span(ray: &Ray, corners: &[Vec3; 3]) -> u32 {
    let vectors = [ray.origin, ray.dir, corners[0], corners[1], corners[2]];
    exact::span(vectors.iter().flat_map(Vec3::to_array))
}

/// Replaces unknown signs by exact ones.
#[cold]
fn exact_signs(ray: &Ray, corners: &[Vec3; 3], signs: [Option<i32>; 3]) -> [i32; 3] {
    if span(ray, corners) <= NARROW_SPAN {
        signs_on_integers::<NARROW>(ray, corners, signs)
    } else {
        signs_on_integers::<WIDE>(ray, corners, signs)
    }
}

fn signs_on_integers<const N: usize>(
    ray: &Ray,
    corners: &[Vec3; 3],
    signs: [Option<i32>; 3],
) -> [i32; 3] {
    let (dir, p) = integers::<N>(ray, corners);
    [(0, 1), (1, 2), (2, 0)]
        .map(|(i, j)| signs[i].unwrap_or_else(|| exact::det(&dir, &p[i], &p[j]).signum()))
}

type Vector<const N: usize> = [WideInt<N>; 3];

/// Direction, and corners relative to the origin, in the coarsest common unit.
fn integers<const N: usize>(ray: &Ray, corners: &[Vec3; 3]) -> (Vector<N>, [Vector<N>; 3]) {
    let vectors = [ray.origin, ray.dir, corners[0], corners[1], corners[2]];
    let unit = exact::common_exponent(vectors.iter().flat_map(Vec3::to_array));
    let of = |v: Vec3| v.to_array().map(|x| WideInt::of(x, unit));
    let origin = of(ray.origin);
    (of(ray.dir), corners.map(|v| exact::minus(&of(v), &origin)))
}

impl ExactT {
    /// Of a line that meets the triangle in one point.
    fn new(ray: &Ray, corners: &[Vec3; 3]) -> Self {
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let (e1, e2) = (b - a, c - a);
        let numerator = Filtered::det(a - ray.origin.as_dvec3(), e1, e2);
        let denominator = Filtered::det(ray.dir.as_dvec3(), e1, e2);
        let approximate = numerator.value / denominator.value;
        let rest = denominator.value.abs() - denominator.error;
        // t̂ − N/D = (N̂ − N + t̂·(D − D̂)) / D, and |D| is at least `rest`. FILTER has room for the bound's rounding.
        let carried = (numerator.error + approximate.abs() * denominator.error) / rest;
        let known = rest > denominator.error && approximate.is_finite();
        Self {
            approximate: if known { approximate } else { 0.0 },
            error: if known {
                carried * (1.0 + 1e-12) + FILTER * approximate.abs()
            } else {
                f64::INFINITY
            },
            ray: *ray,
            corners: *corners,
        }
    }

    /// Bounds on `t`: not above it, and not below it.
    #[must_use]
    pub fn bounds(&self) -> (f64, f64) {
        (
            (self.approximate - self.error).next_down(),
            (self.approximate + self.error).next_up(),
        )
    }

    /// `t` to about 50 bits.
    #[must_use]
    pub fn to_f64(&self) -> f64 {
        // 2^-50 of t: far below an ulp of f32.
        if self.error <= 8.9e-16 * self.approximate.abs() {
            return self.approximate;
        }
        if self.is_narrow() {
            quotient(self.fraction::<NARROW>())
        } else {
            quotient(self.fraction::<WIDE>())
        }
    }

    fn is_narrow(&self) -> bool {
        span(&self.ray, &self.corners) <= NARROW_SPAN
    }

    /// Numerator and denominator, the latter positive.
    fn fraction<const N: usize>(&self) -> (WideInt<N>, WideInt<N>) {
        let (dir, [a, b, c]) = integers(&self.ray, &self.corners);
        let (e1, e2) = (exact::minus(&b, &a), exact::minus(&c, &a));
        let (n, d) = (exact::det(&a, &e1, &e2), exact::det(&dir, &e1, &e2));
        if d.signum() < 0 { (-n, -d) } else { (n, d) }
    }

    /// Compares `t` with a bound of a ray's interval, which may be infinite.
    #[must_use]
    pub fn cmp_f32(&self, bound: f32) -> Ordering {
        let (lo, hi) = self.bounds();
        if f64::from(bound) < lo || bound == f32::NEG_INFINITY {
            return Ordering::Greater;
        }
        if f64::from(bound) > hi || bound == f32::INFINITY {
            return Ordering::Less;
        }
        let (n, d) = self.fraction::<WIDE>();
        let unit = exact::decompose(bound).1;
        // Both sides times 2^-unit where that is a whole number.
        let below = unit.min(0);
        n.shifted(-below as u32)
            .cmp(&(ExactInt::of(bound, below) * d))
    }
}

/// `n / d` to about 50 bits.
fn quotient<const N: usize>((n, d): (WideInt<N>, WideInt<N>)) -> f64 {
    let ((n, en), (d, ed)) = (n.to_scaled_f64(), d.to_scaled_f64());
    n / d * 2f64.powi(en - ed)
}

/// Compares two fractions with positive denominators.
fn compare<const N: usize>(
    (n1, d1): (WideInt<N>, WideInt<N>),
    (n2, d2): (WideInt<N>, WideInt<N>),
) -> Ordering {
    (n1 * d2).cmp(&(n2 * d1))
}

impl PartialEq for ExactT {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for ExactT {}

impl PartialOrd for ExactT {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for ExactT {
    /// Exact: by the bounds where they are apart, else by cross-multiplication.
    fn cmp(&self, other: &Self) -> Ordering {
        let (a, b) = (self.bounds(), other.bounds());
        if a.1 < b.0 {
            return Ordering::Less;
        }
        if a.0 > b.1 {
            return Ordering::Greater;
        }
        let is_copy = self.corners.iter().all(|v| other.corners.contains(v));
        if self.ray == other.ray && is_copy {
            return Ordering::Equal;
        }
        if self.is_narrow() && other.is_narrow() {
            compare(self.fraction::<NARROW>(), other.fraction())
        } else {
            compare(self.fraction::<WIDE>(), other.fraction())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::slow;
    use num_rational::BigRational;
    use proptest::prelude::*;

    fn ray(origin: [f32; 3], dir: [f32; 3]) -> Ray {
        Ray::new(Vec3::from(origin), Vec3::from(dir))
    }

    const FLAT: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

    #[test]
    fn edges_and_vertices_belong_to_the_triangle() {
        for target in [[0.5, 0.0], [0.5, 0.5], [0.0, 0.25], [0.0, 0.0], [1.0, 0.0]] {
            let aimed = ray([target[0], target[1], -2.0], [0.0, 0.0, 1.0]);
            assert_eq!(judge_triangle(&aimed, &FLAT).unwrap().to_f64(), 2.0);
        }
        let beside = ray([0.5, 0.5f32.next_up(), -2.0], [0.0, 0.0, 1.0]);
        assert!(judge_triangle(&beside, &FLAT).is_none());
    }

    #[test]
    fn rays_in_the_plane_and_triangles_without_area_are_misses() {
        assert!(judge_triangle(&ray([-1.0, 0.2, 0.0], [1.0, 0.0, 0.0]), &FLAT).is_none());
        let line = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0];
        assert!(judge_triangle(&ray([1.0, 0.0, -1.0], [0.0, 0.0, 1.0]), &line).is_none());
        let point = [Vec3::ONE; 3];
        assert!(judge_triangle(&ray([1.0, 1.0, 0.0], [0.0, 0.0, 1.0]), &point).is_none());
    }

    #[test]
    fn both_ends_of_the_interval_belong_to_it() {
        let aimed = ray([0.2, 0.2, -3.0], [0.0, 0.0, 1.0]);
        let within = |t_min, t_max| {
            judge_triangle(
                &Ray {
                    t_min,
                    t_max,
                    ..aimed
                },
                &FLAT,
            )
            .is_some()
        };
        assert!(within(3.0, 3.0));
        assert!(!within(3f32.next_up(), 4.0));
        assert!(!within(0.0, 3f32.next_down()));
    }

    #[test]
    fn a_third_is_between_its_two_neighbours_in_f32() {
        let aimed = ray([0.2, 0.2, -1.0], [0.0, 0.0, 3.0]);
        let third = judge_triangle(&aimed, &FLAT).unwrap();
        let near = 1.0f32 / 3.0;
        assert!(f64::from(near) > 1.0 / 3.0);
        assert_eq!(third.cmp_f32(near), Ordering::Less);
        assert_eq!(third.cmp_f32(near.next_down()), Ordering::Greater);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]

        #[test]
        fn the_judgement_agrees_with_big_rationals((ray, mesh) in slow::settings(1)) {
            let exact = judge_triangle(&ray, &mesh[0]);
            let slow = slow::judge_triangle(&ray, &mesh[0]);
            prop_assert_eq!(exact.is_some(), slow.is_some());
            if let (Some(exact), Some(slow)) = (exact, slow) {
                let (lo, hi) = exact.bounds();
                prop_assert!(BigRational::from_float(lo).is_none_or(|lo| lo <= slow));
                prop_assert!(BigRational::from_float(hi).is_none_or(|hi| slow <= hi));
                let off = BigRational::from_float(exact.to_f64()).unwrap() - &slow;
                let room = &slow * BigRational::from_float(1e-14).unwrap();
                prop_assert!(off.clone() * off <= room.clone() * room, "{} {}", exact.to_f64(), slow);
            }
        }

        #[test]
        fn comparisons_agree_with_big_rationals((ray, mesh) in slow::settings(4)) {
            let exact: Vec<_> = mesh.iter().filter_map(|c| judge_triangle(&ray, c)).collect();
            let slow: Vec<_> = mesh.iter().filter_map(|c| slow::judge_triangle(&ray, c)).collect();
            for i in 0..exact.len() {
                for j in 0..exact.len() {
                    prop_assert_eq!(exact[i].cmp(&exact[j]), slow[i].cmp(&slow[j]));
                }
            }
        }
    }
}
