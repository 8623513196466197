//! Bounds on rounding errors, evaluated in `f64`, where neither they nor what they bound can overflow.
//!
//! The bounds are proven for the operations a kernel performs, underflow included: Higham's γ(n) for n chained
//! roundings, and [`TINY`] for each product that underflows. What is neglected is the rounding of the bound itself,
//! 2⁻²⁹ of it, for which [`round_up`] leaves room.
//!
//! **Source:** N. Higham, "Accuracy and Stability of Numerical Algorithms", §3.1; M. Pharr, W. Jakob and G. Humphreys,
//! "Physically Based Rendering", 4th edition, §6.8.

use crate::geometry::lanes::Lane;
use crate::geometry::{DVec3, Vec3};

/// Most that one `f32` product or quotient loses by underflow: half the least subnormal, doubled for safety.
pub(super) const TINY: f64 = 1.401_298_464_324_817e-45;

/// Where an intermediate of a kernel may be larger, nothing is known: it could have become infinite, or its reciprocal
/// subnormal.
pub(super) const HUGE: f64 = 1e37;

/// γ(n) for `f32` roundings.
pub(super) const fn gamma(n: u32) -> f64 {
    let nu = n as f64 * 5.960_464_477_539_063e-8;
    nu / (1.0 - nu)
}

/// γ(n) for bounds that are computed in `f32` themselves, by no more than 32 operations a factor.
pub(super) const fn wide_gamma(n: u32) -> f32 {
    (gamma(n) * (1.0 + 1e-5)) as f32
}

/// More than underflow takes from the sums and products of a test, whose numbers are below [`LARGE`].
pub(super) const UNDERFLOW: f32 = 1e-30;

/// Bounds that are computed in `f32` hold for numbers below this: three of them make no infinite product.
pub(super) const LARGE: f32 = 1e12;

/// Hits' quotients, as far as a bound on their error concerns them, with what they were multiplied by: the absolute value of
/// one over the determinant.
pub(super) struct QuickBound<L> {
    /// One over the determinant.
    pub inv_det: L,
    /// The error of the determinant in units of itself.
    pub det_error: L,
    /// The error of the quotient, were the determinant exact.
    pub error: L,
    /// What is off besides.
    pub besides: L,
    /// The largest of the test's numbers, or more.
    pub largest: L,
}

impl<L> QuickBound<L> {
    /// The bound; infinite where a number is too large or the determinant may be 0. No division: that of the test will do,
    /// and another would hold up what comes next.
    #[inline(always)]
    pub fn get<const W: usize>(self) -> L
    where
        L: Lane<W>,
    {
        // 1 / (1 - x) <= 1 + 2·x for x up to 1/2.
        let wider = L::splat(1.0) + (self.det_error + self.det_error);
        let bound = self.error.mul_add_freely(wider, self.besides);
        // What is no number is not less.
        let known = self.det_error.lt(L::splat(0.5))
            & self.inv_det.lt(L::splat(1.0 / UNDERFLOW))
            & self.largest.lt(L::splat(LARGE));
        L::select(known, bound, L::splat(f32::INFINITY))
    }
}

/// Sum of the absolute values of the six products in the determinant of `a`, `b` and `c`.
pub(super) fn permanent(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let [a, b, c] = [a.abs(), b.abs(), c.abs()];
    a.x * (b.y * c.z + b.z * c.y) + a.y * (b.z * c.x + b.x * c.z) + a.z * (b.x * c.y + b.y * c.x)
}

/// The corners relative to `origin`, in `f64`.
pub(super) fn relative(corners: &[Vec3; 3], origin: Vec3) -> [DVec3; 3] {
    corners.map(|v| v.as_dvec3() - origin.as_dvec3())
}

/// A numerator and a denominator that were computed with errors, and their quotient `t`.
pub(super) struct Quotient {
    /// Bound on the numerator's error.
    pub numerator_error: f64,
    /// The denominator in `f64`.
    pub denominator: f64,
    /// Bound on the error of the `f32` denominator.
    pub denominator_error: f64,
    /// The quotient that was computed.
    pub t: f64,
    /// Roundings between the two and `t`.
    pub roundings: u32,
}

impl Quotient {
    /// Bound on the error of `t`, with room for rounding `t + bound`; infinite where nothing is known.
    ///
    /// From t̂·D̂ = N̂ follows t̂ − N/D = (N̂ − N + t̂·(D − D̂)) / D.
    pub(super) fn t_error(&self) -> f32 {
        // The f64 denominator is off by far less than a millionth of the f32 one's bound.
        let denominator = self.denominator.abs() - 1e-6 * self.denominator_error;
        if denominator <= 0.0 {
            return f32::INFINITY;
        }
        let carried = (self.numerator_error + self.t.abs() * self.denominator_error) / denominator;
        // A reciprocal that is subnormal loses up to TINY, times the numerator t·D.
        let reciprocal = TINY * (1.0 + (self.t * self.denominator).abs());
        round_up(carried + gamma(self.roundings + 1) * self.t.abs() + reciprocal)
    }
}

/// The bound in `f32`, not less; NaN becomes infinity.
pub(super) fn round_up(bound: f64) -> f32 {
    if bound.is_nan() {
        return f32::INFINITY;
    }
    ((bound * (1.0 + 1e-6)) as f32).next_up()
}

#[cfg(test)]
mod tests {
    use rand_core::Rng;
    use rand_pcg::Pcg32;

    use super::*;
    use crate::geometry::Ray;
    use crate::geometry::lanes::LaneRay;
    use crate::kernel::{Kernel, KernelUser, dispatch, parse};

    /// How a kernel's quick bound compares with the one in `f64`, for hits of rays aimed into triangles.
    struct Compare {
        /// Size of the triangles, and how far away they are.
        size: f32,
        far: f32,
    }

    impl KernelUser for Compare {
        /// The ratios of both, where both are finite; how many quick bounds are not.
        type Out = (Vec<f32>, usize);

        fn with<K: Kernel>(self, kernel: K) -> Self::Out {
            let mut dice = Pcg32::new(1, 2);
            let mut number = || dice.next_u32() as f32 / u32::MAX as f32 - 0.5;
            let mut vector = || Vec3::new(number(), number(), number());
            let (mut ratios, mut unknown) = (Vec::new(), 0);
            for _ in 0..3000 {
                let at = vector() * self.far;
                let corners = [(); 3].map(|()| at + vector() * self.size);
                let inside = corners.iter().sum::<Vec3>() / 3.0;
                let origin = at + vector() * (self.far + 4.0 * self.size);
                let ray = Ray::new(origin, (inside - origin) * 1.5);
                let packed = kernel.pack::<1>(|_| corners);
                let prepared = kernel.prepare::<1, f32>(&ray, &LaneRay::splat(&ray));
                let Some(hit) = kernel.intersect(&prepared, &packed) else {
                    continue;
                };
                let quick = K::t_error_bound(&prepared, &packed, &hit);
                let sure = kernel.t_error(&ray, &corners, hit.t);
                assert!(quick >= sure, "{ray:?}, {corners:?}: {quick} < {sure}");
                if quick.is_finite() {
                    ratios.push(quick / sure);
                } else {
                    unknown += 1;
                }
            }
            ratios.sort_by(f32::total_cmp);
            (ratios, unknown)
        }
    }

    fn compared(kernel: &str, size: f32, far: f32) -> (Vec<f32>, usize) {
        dispatch(&parse(kernel).unwrap(), Compare { size, far }).unwrap()
    }

    #[test]
    fn quick_bounds_are_larger_and_not_much() {
        for kernel in ["moller-trumbore", "woop", "pbrt", "exact"] {
            let (ratios, unknown) = compared(kernel, 1.0, 10.0);
            let hits = ratios.len();
            assert!(
                hits > 1000 && unknown < hits / 50,
                "{kernel}: {hits}, {unknown}"
            );
            assert!(
                ratios[hits / 2] < 12.0,
                "{kernel}: half of the bounds are {} times as large",
                ratios[hits / 2]
            );
        }
    }

    #[test]
    fn quick_bounds_hold_or_are_infinite_at_any_size() {
        for kernel in ["moller-trumbore", "woop", "pbrt", "exact"] {
            for exponent in (-30..30).step_by(3) {
                let size = 10_f32.powi(exponent);
                for far in [size, 100.0 * size, 1.0, 1e4] {
                    // Asserts inside.
                    compared(kernel, size, far);
                }
            }
        }
    }
}
