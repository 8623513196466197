//! Eight lanes in plain Rust: arrays and loops of fixed length, which the compiler turns into vector instructions where
//! the target has them, and which are right everywhere.
//!
//! ```text
//! F32x8   [ x0 | x1 | x2 | x3 | x4 | x5 | x6 | x7 ]   32 bytes, aligned
//! Mask8   [ !0 |  0 | !0 | ...                    ]   all bits set where true
//! ```
//!
//! **Source:** the shape of the `wide` crate's portable types. **Differs:** only what kernels use.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::{Lane, LaneMask};

/// Eight `f32`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(32))]
pub struct F32x8([f32; 8]);

/// Eight truth values, each all ones or all zeros.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C, align(32))]
pub struct Mask8([u32; 8]);

#[inline(always)]
fn each(a: F32x8, b: F32x8, op: impl Fn(f32, f32) -> f32) -> F32x8 {
    F32x8(std::array::from_fn(|i| op(a.0[i], b.0[i])))
}

#[inline(always)]
fn compare(a: F32x8, b: F32x8, op: impl Fn(f32, f32) -> bool) -> Mask8 {
    Mask8(std::array::from_fn(|i| {
        if op(a.0[i], b.0[i]) { u32::MAX } else { 0 }
    }))
}

macro_rules! operators {
    ($($trait:ident $method:ident $op:tt),*) => {$(
        impl $trait for F32x8 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                each(self, other, |a, b| a $op b)
            }
        }
    )*};
}

operators!(Add add +, Sub sub -, Mul mul *, Div div /);

impl Neg for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(Neg::neg))
    }
}

impl BitAnd for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] & other.0[i]))
    }
}

impl BitOr for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] | other.0[i]))
    }
}

impl Not for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(self.0.map(Not::not))
    }
}

impl LaneMask for Mask8 {
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0
            .iter()
            .enumerate()
            .fold(0, |bits, (lane, mask)| bits | (mask & 1) << lane)
    }

    #[inline(always)]
    fn any(self) -> bool {
        self.0.iter().fold(0, |any, mask| any | mask) != 0
    }
}

impl Lane<8> for F32x8 {
    type Mask = Mask8;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; 8])
    }
    #[inline(always)]
    fn load(xs: &[f32; 8]) -> Self {
        Self(*xs)
    }
    #[inline(always)]
    fn to_array(self) -> [f32; 8] {
        self.0
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f32::sqrt))
    }
    #[inline(always)]
    fn select(mask: Mask8, a: Self, b: Self) -> Self {
        Self(std::array::from_fn(|i| {
            if mask.0[i] != 0 { a.0[i] } else { b.0[i] }
        }))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        compare(self, other, |a, b| a < b)
    }
    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        compare(self, other, |a, b| a <= b)
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Mask8 {
        compare(self, other, |a, b| a == b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn eight() -> impl Strategy<Value = [f32; 8]> {
        let number = prop_oneof![
            any::<u32>().prop_map(f32::from_bits),
            (-2i32..=2).prop_map(|i| i as f32),
        ];
        prop::array::uniform8(number)
    }

    /// Equal bits, or both NaN: which NaN comes out is not specified.
    fn same(a: f32, b: f32) -> bool {
        a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
    }

    proptest! {
        #[test]
        fn each_lane_computes_what_one_number_does(xs in eight(), ys in eight()) {
            let (a, b) = (F32x8::load(&xs), F32x8::load(&ys));
            let lanes = [a + b, a - b, a * b, a / b, -a, a.abs(), a.sqrt()].map(F32x8::to_array);
            let masks = [a.lt(b), a.le(b), Lane::eq(a, b), a.gt(b), a.ge(b), !a.lt(b)].map(Mask8::bits);
            let chosen = F32x8::select(a.lt(b), a, b).to_array();
            for i in 0..8 {
                let (x, y) = (xs[i], ys[i]);
                let ones = [x + y, x - y, x * y, x / y, -x, x.abs(), x.sqrt()];
                for (lane, one) in lanes.iter().zip(ones) {
                    prop_assert!(same(lane[i], one), "{} {one}", lane[i]);
                }
                let truths = [x < y, x <= y, x == y, x > y, x >= y, !Lane::lt(x, y)];
                for (bits, truth) in masks.iter().zip(truths) {
                    prop_assert_eq!(bits >> i & 1 == 1, truth);
                }
                let wanted = if x < y { x } else { y };
                prop_assert!(same(chosen[i], wanted));
            }
            prop_assert_eq!(a.lt(b).any(), (0..8).any(|i| xs[i] < ys[i]));
            prop_assert_eq!((a.lt(b) & b.lt(a)).bits(), 0);
            prop_assert_eq!((a.lt(b) | a.ge(b)).bits(), Lane::eq(a, a).bits() & Lane::eq(b, b).bits());
        }
    }
}
