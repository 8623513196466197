//! Running error analysis: a formula evaluated in `f64` that carries, beside each number, a bound on what the same formula
//! has lost in `f32` by then.
//!
//! A kernel's bound on `t` is its own formula once more over [`Known`], operation by operation; what it precomputed in
//! `f64` is `Known<53>` until it is [`Known::stored`].
//!
//! ```text
//! value ------|------------|----> the exact number and the one that the kernel has
//!       <---- error ---->          are both within `error` of `value`, and of one another
//! ```
//!
//! **Source:** N. Higham, "Accuracy and Stability of Numerical Algorithms", §3.3. **Differs:** absolute bounds, as sums
//! cancel; underflow is counted; a number beyond [`HUGE`], which could have overflowed, has an infinite bound.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::geometry::Vec3;

use super::error::{HUGE, TINY, gamma, round_up};

/// A number that was computed with `BITS` bits, 24 or 53.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known<const BITS: u32> {
    value: f64,
    error: f64,
}

/// A vector of them.
pub(super) type KnownVec3<const BITS: u32> = [Known<BITS>; 3];

/// The unit roundoff.
const fn unit(bits: u32) -> f64 {
    1.0 / (1_u64 << bits) as f64
}

impl<const BITS: u32> Known<BITS> {
    /// A number without an error.
    pub fn of(x: f32) -> Self {
        Self {
            value: f64::from(x),
            error: 0.0,
        }
    }

    /// `value` with a bound that was found otherwise.
    pub fn with_error(value: f64, error: f64) -> Self {
        Self { value, error }
    }

    /// The result of an operation whose operands' errors move it by at most `carried`, rounded.
    fn rounded(value: f64, carried: f64) -> Self {
        // `value` itself is off by `carried`, and what was rounded by as much the other way.
        let most = value.abs() + 2.0 * carried;
        // Products of a few differences of `f32` neither overflow nor underflow in `f64`.
        let error = if BITS >= 53 {
            carried + unit(BITS) * most
        } else if most <= HUGE {
            carried + unit(BITS) * most + TINY
        } else {
            f64::INFINITY
        };
        Self { value, error }
    }
}

impl Known<53> {
    /// Rounded to `f32`, as a kernel stores it.
    pub fn stored(self) -> Known<24> {
        Known::rounded(self.value, self.error)
    }
}

impl Known<24> {
    /// The bound on this number, a `t`, with room for rounding `t + bound`; infinite where nothing is known.
    pub fn bound(self) -> f32 {
        round_up(self.error + gamma(1) * (self.value.abs() + self.error))
    }
}

impl<const BITS: u32> Add for Known<BITS> {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self::rounded(self.value + o.value, self.error + o.error)
    }
}

impl<const BITS: u32> Neg for Known<BITS> {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            ..self
        }
    }
}

impl<const BITS: u32> Sub for Known<BITS> {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl<const BITS: u32> Mul for Known<BITS> {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        // The exact factors are at most |value| + error.
        let (a, b) = (self.value.abs(), o.value.abs());
        let carried = a * o.error + b * self.error + 3.0 * self.error * o.error;
        Self::rounded(self.value * o.value, carried)
    }
}

impl<const BITS: u32> Div for Known<BITS> {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        // Neither the exact divisor nor the one that was used is nearer to 0.
        let least = o.value.abs() - 2.0 * o.error;
        if least.is_nan() || least <= 0.0 {
            return Self::with_error(0.0, f64::INFINITY);
        }
        let quotient = (self.value.abs() + self.error) / least;
        let carried = (self.error + quotient * o.error) / least;
        Self::rounded(self.value / o.value, carried)
    }
}

/// A vector without errors.
pub(super) fn vector<const BITS: u32>(v: Vec3) -> KnownVec3<BITS> {
    v.to_array().map(Known::of)
}

/// `a − b`.
pub(super) fn minus<const BITS: u32>(a: KnownVec3<BITS>, b: KnownVec3<BITS>) -> KnownVec3<BITS> {
    [0, 1, 2].map(|i| a[i] - b[i])
}

/// `a × b`.
pub(super) fn cross<const BITS: u32>(a: KnownVec3<BITS>, b: KnownVec3<BITS>) -> KnownVec3<BITS> {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i] * b[j] - a[j] * b[i])
}

/// `a·b`, summed as the lanes sum.
pub(super) fn dot<const BITS: u32>(a: KnownVec3<BITS>, b: KnownVec3<BITS>) -> Known<BITS> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The unit normal of a triangle, made in `f64`; NaN for one without area.
pub(super) fn unit_normal(corners: &[Vec3; 3]) -> KnownVec3<53> {
    let [a, b, c] = corners.map(vector::<53>);
    let normal = cross(minus(b, a), minus(c, a));
    let square = dot(normal, normal);
    let length = square.value.sqrt();
    // The difference of two roots is that of their squares over their sum.
    let inverse = Known::of(1.0) / Known::rounded(length, square.error / length);
    normal.map(|x| x * inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use proptest::prelude::*;

    fn rational(x: f64) -> BigRational {
        BigRational::from_float(x).unwrap()
    }

    /// Whether both the exact number and that of the kernel are within the bound.
    fn holds(known: Known<24>, exact: &BigRational, computed: f32) -> bool {
        if !known.error.is_finite() {
            return true;
        }
        // The bound's own rounding, for which its users leave room.
        let room = rational(known.error * (1.0 + 1e-6));
        let within = |x: &BigRational| {
            let off = x - rational(known.value);
            off <= room && -off <= room
        };
        within(exact) && computed.is_finite() && within(&rational(f64::from(computed)))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]

        #[test]
        fn the_exact_and_the_computed_number_are_within_the_bound(
            xs in prop::array::uniform6(prop_oneof![
                -1f32..1.0,
                (-3i32..=3).prop_map(|i| i as f32),
                any::<u32>().prop_map(f32::from_bits).prop_filter("finite", |x| x.is_finite()),
                -1e-38f32..1e-38,
            ])
        ) {
            let known = xs.map(Known::<24>::of);
            let exact = xs.map(|x| rational(f64::from(x)));
            let sum = known[0] * known[1] - known[2] * known[3];
            let exact_sum = &exact[0] * &exact[1] - &exact[2] * &exact[3];
            let computed_sum = xs[0] * xs[1] - xs[2] * xs[3];
            prop_assert!(holds(sum, &exact_sum, computed_sum));
            let divisor = known[4] + known[5] * known[0];
            let exact_divisor = &exact[4] + &exact[5] * &exact[0];
            let computed_divisor = xs[4] + xs[5] * xs[0];
            prop_assert!(holds(divisor, &exact_divisor, computed_divisor));
            let quotient = sum / divisor;
            if quotient.error.is_finite() {
                prop_assert!(holds(quotient, &(exact_sum / exact_divisor), computed_sum / computed_divisor));
            }
        }
    }
}
