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

    const N: usize = 8;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; 8])
    }
    #[inline(always)]
    fn load(xs: &[f32; 8]) -> Self {
        Self(*xs)
    }
    #[inline(always)]
    fn from_fn(number: impl FnMut(usize) -> f32) -> Self {
        Self(std::array::from_fn(number))
    }
    #[inline(always)]
    fn get(self, lane: usize) -> f32 {
        self.0[lane & 7]
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        each(self, other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        each(self, other, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(std::array::from_fn(|i| {
            self.0[i].mul_add(factor.0[i], term.0[i])
        }))
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
    #[inline(always)]
    fn same_bits(self, other: Self) -> Mask8 {
        compare(self, other, |a, b| a.to_bits() == b.to_bits())
    }
}
