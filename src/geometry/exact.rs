//! Exact integers of a fixed greatest size: enough for every determinant of `f32` coordinates, without allocation.
//!
//! A finite `f32` is an integer times a power of two. Once all inputs are written in one unit, sums and products are
//! integers, and signs and comparisons are exact.
//!
//! ```text
//! one coordinate, in units of 2^-149:     277 bits
//! a difference of two:                    278 bits
//! a determinant of three such vectors:    3·278 + 3 = 837 bits
//! a product of two determinants:          1,674 bits <= 27 limbs
//! ```
//!
//! Nearly all inputs are of one magnitude and need a fraction of that; [`span`] tells, and [`WideInt`] has the size that
//! is asked for.
//!
//! **Source:** schoolbook arithmetic, e.g. D. Knuth, "The Art of Computer Programming" vol. 2, §4.3.1.
//! **Differs:** sign and magnitude in a fixed array with a length, since nearly all values use one to three limbs.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

/// Limbs of 64 bits: 27 by the count above, and one for the carry of a sum.
const LIMBS: usize = 28;

/// An exact integer of any determinant of `f32`, and of the product of two: 1,792 bits.
pub type ExactInt = WideInt<LIMBS>;

/// An exact integer of at most `N` limbs of 64 bits. A result that would be larger is a broken invariant of the caller
/// and panics.
#[derive(Debug, Clone, Copy)]
pub struct WideInt<const N: usize> {
    negative: bool,
    /// Limbs in use; the highest of them is not 0, and zero has none.
    len: usize,
    /// Least significant first; 0 beyond `len`.
    limbs: [u64; N],
}

/// A finite `f32` as `mantissa · 2^exponent` with an odd mantissa; zero is `(0, 0)`.
///
/// The sign is left out. NaN and infinities give meaningless numbers.
#[must_use]
pub fn decompose(x: f32) -> (u32, i32) {
    let bits = x.to_bits();
    let (biased, fraction) = (bits >> 23 & 0xff, bits & 0x7f_ffff);
    let (mantissa, exponent) = match biased {
        0 => (fraction, -149),
        _ => (fraction | 0x80_0000, biased as i32 - 150),
    };
    match mantissa {
        0 => (0, 0),
        m => (
            m >> m.trailing_zeros(),
            exponent + m.trailing_zeros() as i32,
        ),
    }
}

/// The greatest exponent `e` such that all of `xs` are whole multiples of `2^e`; 0 where all are zero.
pub fn common_exponent(xs: impl IntoIterator<Item = f32>) -> i32 {
    xs.into_iter()
        .filter(|&x| x != 0.0)
        .map(|x| decompose(x).1)
        .min()
        .unwrap_or(0)
}

/// Bits from the highest of any of `xs` to the common exponent of all: how wide their integers are. 0 where all are
/// zero.
pub fn span(xs: impl IntoIterator<Item = f32>) -> u32 {
    let (mut low, mut high) = (i32::MAX, i32::MIN);
    for x in xs.into_iter().filter(|&x| x != 0.0) {
        let (mantissa, exponent) = decompose(x);
        low = low.min(exponent);
        high = high.max(exponent + 32 - mantissa.leading_zeros() as i32);
    }
    if low > high { 0 } else { (high - low) as u32 }
}

impl<const N: usize> WideInt<N> {
    /// 0.
    pub const ZERO: Self = Self {
        negative: false,
        len: 0,
        limbs: [0; N],
    };

    /// `x / 2^unit`, which must be whole: `unit` at most the exponent of `x`.
    #[must_use]
    pub fn of(x: f32, unit: i32) -> Self {
        let (mantissa, exponent) = decompose(x);
        let mut int = Self::ZERO;
        if mantissa != 0 {
            int.limbs[0] = u64::from(mantissa);
            int.len = 1;
            int.negative = x < 0.0;
            int = int.shifted((exponent - unit) as u32);
        }
        int
    }

    /// `self · 2^bits`.
    #[must_use]
    pub fn shifted(self, bits: u32) -> Self {
        if self.len == 0 {
            return self;
        }
        let (whole, part) = ((bits / 64) as usize, bits % 64);
        let mut out = Self {
            negative: self.negative,
            ..Self::ZERO
        };
        for i in 0..self.len {
            let wide = u128::from(self.limbs[i]) << part;
            out.limbs[i + whole] |= wide as u64;
            let carry = (wide >> 64) as u64;
            if carry != 0 {
                out.limbs[i + whole + 1] = carry;
            }
        }
        out.trimmed((self.len + whole + 1).min(N))
    }

    /// -1, 0 or 1.
    #[must_use]
    pub fn signum(&self) -> i32 {
        match (self.len, self.negative) {
            (0, _) => 0,
            (_, false) => 1,
            (_, true) => -1,
        }
    }

    /// `self` as `m · 2^e` with 2^63 <= |m| < 2^64 or m = 0, rounded in the last place.
    #[must_use]
    pub fn to_scaled_f64(&self) -> (f64, i32) {
        if self.len == 0 {
            return (0.0, 0);
        }
        let top = self.limbs[self.len - 1];
        let below = if self.len > 1 {
            self.limbs[self.len - 2]
        } else {
            0
        };
        let wide = u128::from(top) << 64 | u128::from(below);
        let lead = wide.leading_zeros();
        // The low 64 bits of what is left matter only beyond the precision of f64.
        let mantissa = (wide << lead >> 64) as u64 as f64;
        let exponent = 64 * (self.len as i32 - 1) - lead as i32;
        (if self.negative { -mantissa } else { mantissa }, exponent)
    }

    /// Sets the length, leaving out zeros at the top of the first `len` limbs.
    fn trimmed(mut self, len: usize) -> Self {
        self.len = (0..len)
            .rev()
            .find(|&i| self.limbs[i] != 0)
            .map_or(0, |i| i + 1);
        self.negative &= self.len != 0;
        self
    }

    fn compare_magnitude(&self, other: &Self) -> Ordering {
        self.len.cmp(&other.len).then_with(|| {
            let (a, b) = (&self.limbs[..self.len], &other.limbs[..self.len]);
            a.iter().rev().cmp(b.iter().rev())
        })
    }

    fn add_magnitude(&self, other: &Self) -> Self {
        let len = self.len.max(other.len);
        let mut out = Self::ZERO;
        let mut carry = 0;
        for i in 0..len {
            let sum = u128::from(self.limbs[i]) + u128::from(other.limbs[i]) + carry;
            out.limbs[i] = sum as u64;
            carry = sum >> 64;
        }
        if carry != 0 {
            out.limbs[len] = 1;
        }
        out.trimmed((len + 1).min(N))
    }

    /// `|self| − |other|`, where the first is not less.
    fn sub_magnitude(&self, other: &Self) -> Self {
        let mut out = Self::ZERO;
        let mut borrow = false;
        for i in 0..self.len {
            let (difference, b1) = self.limbs[i].overflowing_sub(other.limbs[i]);
            let (difference, b2) = difference.overflowing_sub(u64::from(borrow));
            out.limbs[i] = difference;
            borrow = b1 | b2;
        }
        out.trimmed(self.len)
    }
}

impl<const N: usize> From<i128> for WideInt<N> {
    /// `N` is at least 2.
    fn from(x: i128) -> Self {
        let magnitude = x.unsigned_abs();
        let mut int = Self::ZERO;
        int.limbs[0] = magnitude as u64;
        int.limbs[1] = (magnitude >> 64) as u64;
        int.negative = x < 0;
        int.trimmed(2)
    }
}

impl<const N: usize> Neg for WideInt<N> {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            negative: !self.negative && self.len != 0,
            ..self
        }
    }
}

impl<const N: usize> Add for WideInt<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (sum, negative) = if self.negative == other.negative {
            (self.add_magnitude(&other), self.negative)
        } else if self.compare_magnitude(&other) == Ordering::Less {
            (other.sub_magnitude(&self), other.negative)
        } else {
            (self.sub_magnitude(&other), self.negative)
        };
        Self {
            negative: negative && sum.len != 0,
            ..sum
        }
    }
}

impl<const N: usize> Sub for WideInt<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<const N: usize> Mul for WideInt<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let mut out = Self::ZERO;
        for (i, &a) in self.limbs[..self.len].iter().enumerate() {
            let mut carry = 0;
            for (j, &b) in other.limbs[..other.len].iter().enumerate() {
                let sum = u128::from(a) * u128::from(b) + u128::from(out.limbs[i + j]) + carry;
                out.limbs[i + j] = sum as u64;
                carry = sum >> 64;
            }
            if carry != 0 {
                out.limbs[i + other.len] = carry as u64;
            }
        }
        out.negative = self.negative != other.negative;
        out.trimmed((self.len + other.len).min(N))
    }
}

impl<const N: usize> PartialEq for WideInt<N> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<const N: usize> Eq for WideInt<N> {}

impl<const N: usize> PartialOrd for WideInt<N> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<const N: usize> Ord for WideInt<N> {
    fn cmp(&self, other: &Self) -> Ordering {
        match (self.signum(), other.signum()) {
            (1, 1) => self.compare_magnitude(other),
            (-1, -1) => other.compare_magnitude(self),
            (a, b) => a.cmp(&b),
        }
    }
}

/// A vector of exact integers of any size that a determinant of `f32` needs.
pub type ExactVec3 = [ExactInt; 3];

/// Exact integers, of whatever size.
pub trait Integer:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// `x / 2^unit`, which must be whole: `unit` at most the exponent of `x`.
    fn of(x: f32, unit: i32) -> Self;
    /// -1, 0 or 1.
    fn sign(self) -> i32;
}

impl<const N: usize> Integer for WideInt<N> {
    fn of(x: f32, unit: i32) -> Self {
        Self::of(x, unit)
    }
    fn sign(self) -> i32 {
        self.signum()
    }
}

/// Determinants of numbers that span at most [`SMALL_SPAN`] bits fit.
impl Integer for i128 {
    fn of(x: f32, unit: i32) -> Self {
        let (mantissa, exponent) = decompose(x);
        if mantissa == 0 {
            return 0;
        }
        let magnitude = Self::from(mantissa) << (exponent - unit);
        if x < 0.0 { -magnitude } else { magnitude }
    }
    fn sign(self) -> i32 {
        self.signum() as i32
    }
}

/// Bits that numbers may span for the determinants of their differences to fit 128: 3·(40 + 1) + 3.
pub const SMALL_SPAN: u32 = 40;

/// `a − b`.
#[must_use]
pub fn minus<T: Integer>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

/// The determinant of three vectors, a·(b × c).
#[must_use]
pub fn det<T: Integer>(a: &[T; 3], b: &[T; 3], c: &[T; 3]) -> T {
    a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigInt;
    use num_bigint::Sign;
    use proptest::prelude::*;

    fn big(x: &ExactInt) -> BigInt {
        let bytes: Vec<u8> = x.limbs.iter().flat_map(|l| l.to_le_bytes()).collect();
        let sign = if x.negative { Sign::Minus } else { Sign::Plus };
        BigInt::from_bytes_le(sign, &bytes)
    }

    fn finite() -> impl Strategy<Value = f32> {
        prop_oneof![
            any::<u32>().prop_map(f32::from_bits),
            -1e3f32..1e3,
            Just(0.0),
            Just(-0.0),
            Just(f32::MAX),
            Just(-f32::MAX),
            Just(1e-45),
        ]
        .prop_filter("finite", |x| x.is_finite())
    }

    #[test]
    fn a_number_is_its_mantissa_times_its_power_of_two() {
        assert_eq!(decompose(1.0), (1, 0));
        assert_eq!(decompose(-6.0), (3, 1));
        assert_eq!(decompose(1e-45), (1, -149));
        assert_eq!(decompose(f32::MAX), ((1 << 24) - 1, 104));
        assert_eq!(common_exponent([0.5, 4.0, 0.0]), -1);
    }

    #[test]
    fn the_span_is_that_of_the_widest_integer() {
        assert_eq!(span([1.0, -6.0, 0.0]), 3);
        assert_eq!(span([0.0, -0.0]), 0);
        assert_eq!(span([f32::MAX, 1e-45]), 277);
        assert_eq!(span([1.0, 1.0 + f32::EPSILON]), 24);
    }

    #[test]
    fn small_integers_say_what_wide_ones_say() {
        let mut bits = 1_u32;
        let mut number = || {
            bits = bits.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            // 24 bits of mantissa, and exponents 16 apart: 40 bits.
            let x = f32::from_bits((bits >> 9) | 0x3f80_0000);
            x * f32::from(1_u16 << (bits & 15)) * if bits & 16 == 0 { 1.0 } else { -1.0 }
        };
        for _ in 0..1000 {
            let rows = [0; 9].map(|_| number());
            let unit = common_exponent(rows);
            assert!(span(rows) <= SMALL_SPAN);
            let small = rows.map(|x| <i128 as Integer>::of(x, unit));
            let wide = rows.map(|x| ExactInt::of(x, unit));
            let vector = |i: usize| [small[3 * i], small[3 * i + 1], small[3 * i + 2]];
            let wide_vector = |i: usize| [wide[3 * i], wide[3 * i + 1], wide[3 * i + 2]];
            let d = det(&minus(&vector(0), &vector(1)), &vector(1), &vector(2));
            let w = det(
                &minus(&wide_vector(0), &wide_vector(1)),
                &wide_vector(1),
                &wide_vector(2),
            );
            assert_eq!(ExactInt::from(d), w);
            assert_eq!(d.sign(), w.sign());
        }
    }

    #[test]
    fn the_largest_determinants_can_be_multiplied() {
        let (huge, tiny) = (ExactInt::of(f32::MAX, -149), ExactInt::of(1e-45, -149));
        let difference = huge - -huge - tiny;
        let v = [difference, -difference, difference];
        let w = [difference, difference, -difference];
        let u = [-difference, difference, difference];
        let d = det(&v, &w, &u);
        assert_eq!(big(&(d * d)), big(&d) * big(&d));
        assert!(d.signum() != 0);
    }

    proptest! {
        #[test]
        fn arithmetic_agrees_with_a_big_integer_library(xs in prop::array::uniform9(finite())) {
            let x = xs.map(|x| ExactInt::of(x, -149));
            let y = x.map(|x| big(&x));
            let (a, b, c) = ([x[0], x[1], x[2]], [x[3], x[4], x[5]], [x[6], x[7], x[8]]);
            let exact = det(&a, &b, &c);
            let slow = &y[0] * (&y[4] * &y[8] - &y[5] * &y[7])
                + &y[1] * (&y[5] * &y[6] - &y[3] * &y[8])
                + &y[2] * (&y[3] * &y[7] - &y[4] * &y[6]);
            prop_assert_eq!(big(&exact), slow);
            for i in 0..8 {
                prop_assert_eq!(x[i].cmp(&x[i + 1]), y[i].cmp(&y[i + 1]));
                prop_assert_eq!(big(&(x[i] - x[i + 1])), &y[i] - &y[i + 1]);
            }
        }

        #[test]
        fn a_number_survives_the_way_to_an_integer_and_back(x in finite()) {
            let (mantissa, exponent) = ExactInt::of(x, -149).to_scaled_f64();
            prop_assert_eq!(mantissa * 2f64.powi(exponent - 149), f64::from(x));
        }
    }
}
