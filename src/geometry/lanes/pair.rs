//! Sixteen lanes as two of eight: the rays of a packet where no register holds sixteen.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::{Lane, LaneMask};

/// The first eight and the last eight of sixteen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair<T>(pub(super) T, pub(super) T);

macro_rules! operators {
    ($($trait:ident $method:ident),*) => {$(
        impl<T: $trait<Output = T>> $trait for Pair<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    )*};
}

operators!(Add add, Sub sub, Mul mul, Div div, BitAnd bitand, BitOr bitor);

impl<T: Neg<Output = T>> Neg for Pair<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl<T: Not<Output = T>> Not for Pair<T> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0, !self.1)
    }
}

impl<M: LaneMask> LaneMask for Pair<M> {
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.bits() | self.1.bits() << 8
    }
}

impl<L: Lane<8>> Lane<1> for Pair<L> {
    type Mask = Pair<L::Mask>;

    const N: usize = 16;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self(L::splat(x), L::splat(x))
    }
    #[inline(always)]
    fn load(xs: &[f32; 1]) -> Self {
        Self::splat(xs[0])
    }
    #[inline(always)]
    fn from_fn(mut number: impl FnMut(usize) -> f32) -> Self {
        let first = L::from_fn(&mut number);
        Self(first, L::from_fn(|lane| number(lane + 8)))
    }
    #[inline(always)]
    fn get(self, lane: usize) -> f32 {
        if lane < 8 {
            self.0.get(lane)
        } else {
            self.1.get(lane - 8)
        }
    }
    #[inline(always)]
    fn write(self, room: &mut [f32]) {
        let (first, second) = room.split_at_mut(8);
        self.0.write(first);
        self.1.write(second);
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(
            self.0.mul_add(factor.0, term.0),
            self.1.mul_add(factor.1, term.1),
        )
    }
    #[inline(always)]
    fn mul_sub_freely(self, factor: Self, term: Self) -> Self {
        Self(
            self.0.mul_sub_freely(factor.0, term.0),
            self.1.mul_sub_freely(factor.1, term.1),
        )
    }
    #[inline(always)]
    fn mul_add_freely(self, factor: Self, term: Self) -> Self {
        Self(
            self.0.mul_add_freely(factor.0, term.0),
            self.1.mul_add_freely(factor.1, term.1),
        )
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self {
        Self(L::select(mask.0, a.0, b.0), L::select(mask.1, a.1, b.1))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        Pair(self.0.lt(other.0), self.1.lt(other.1))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        Pair(self.0.le(other.0), self.1.le(other.1))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Self::Mask {
        Pair(self.0.eq(other.0), self.1.eq(other.1))
    }
    #[inline(always)]
    fn same_bits(self, other: Self) -> Self::Mask {
        Pair(self.0.same_bits(other.0), self.1.same_bits(other.1))
    }
}
