//! Lanes: a kernel's formula is written once over [`Lane`] and runs on one `f32` or on `W` of them.
//!
//! Every operation is the IEEE one, in the order written; only [`Lane::mul_add`] fuses a multiplication with an addition,
//! where a formula says so, and [`Lane::mul_sub_freely`] where it is quicker. So a formula without the latter gives the same
//! bits in every lane width and on every instruction set.
//!
//! Source: the trait follows the shape of the `Vector` trait of the memchr crate (one trait, one small type a width).
//! Differs: masks are values of their own type, so that the scalar form compiles to plain branches.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::{Ray, Vec3};

#[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
mod avx2;
#[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
mod avx512;
mod isa;
mod pair;
mod portable;
mod rows;
#[cfg(test)]
mod tests;

pub use isa::{InstructionSet, Isa, Portable, Task, prefetch};
pub use pair::Pair;
pub use portable::{F32x8, Mask8};
pub use rows::{HitLanes, RayLanes, SIXTEEN};

/// The numbers of the bits of a word that are set, the least first: of the lanes that a mask holds.
#[derive(Debug)]
pub struct Ones(pub u32);

impl Iterator for Ones {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let rest = self.0;
        self.0 &= rest.wrapping_sub(1);
        (rest != 0).then_some(rest.trailing_zeros() as usize)
    }
}

/// The truth values of `W` comparisons.
pub trait LaneMask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// Bit `i` is set where lane `i` is true.
    fn bits(self) -> u32;

    /// Whether any lane is true.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
}

/// Numbers that are computed with at once: one for each of `W` triangles or boxes, or, where `W` is 1, one for each ray of
/// a packet that meets one triangle.
pub trait Lane<const W: usize>:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The result of comparing two of these.
    type Mask: LaneMask;

    /// How many numbers it holds: `W`, or the rays of a packet.
    const N: usize;

    /// The same number in every lane.
    fn splat(x: f32) -> Self;
    /// One number a triangle; in a packet the same for every ray.
    fn load(xs: &[f32; W]) -> Self;
    /// One number a lane.
    fn from_fn(number: impl FnMut(usize) -> f32) -> Self;
    /// The number in a lane below `N`.
    fn get(self, lane: usize) -> f32;
    /// Writes all numbers to the front of `room`, which holds as many.
    #[inline(always)]
    fn write(self, room: &mut [f32]) {
        for (lane, number) in room.iter_mut().enumerate().take(Self::N) {
            *number = self.get(lane);
        }
    }
    /// `self` where it is greater, else `other`; so `other` where either is NaN.
    #[must_use]
    fn max(self, other: Self) -> Self;
    /// `self` where it is less, else `other`; so `other` where either is NaN.
    #[must_use]
    fn min(self, other: Self) -> Self;
    /// The least number; any of them where one is NaN.
    #[inline(always)]
    fn least(self) -> f32 {
        let mut least = self.get(0);
        for lane in 1..Self::N {
            let x = self.get(lane);
            least = if x < least { x } else { least };
        }
        least
    }
    /// The greatest number; any of them where one is NaN.
    #[inline(always)]
    fn greatest(self) -> f32 {
        -(-self).least()
    }
    /// `self·factor + term`, rounded once on every instruction set; [`Portable`] lanes call a function for each number.
    #[must_use]
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// `self·factor − term`, rounded once or twice, whatever is quicker here: for bounds, which need not be the same
    /// everywhere.
    #[must_use]
    #[inline(always)]
    fn mul_sub_freely(self, factor: Self, term: Self) -> Self {
        self * factor - term
    }
    /// `self·factor + term`, likewise.
    #[must_use]
    #[inline(always)]
    fn mul_add_freely(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }
    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self;
    /// Square root, correctly rounded; NaN where negative.
    #[must_use]
    fn sqrt(self) -> Self;
    /// `a` where `mask` is true, else `b`.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// `self < other`, false where either is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`, false where either is NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// `self == other`, false where either is NaN.
    fn eq(self, other: Self) -> Self::Mask;
    /// Whether the bits are the same: zeros of either sign differ, a NaN is the same as itself.
    fn same_bits(self, other: Self) -> Self::Mask;

    /// `self > other`, false where either is NaN.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
    /// `self >= other`, false where either is NaN.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }
}

impl LaneMask for bool {
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self)
    }
}

impl Lane<1> for f32 {
    type Mask = bool;

    const N: usize = 1;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        x
    }
    #[inline(always)]
    fn load(xs: &[f32; 1]) -> Self {
        xs[0]
    }
    #[inline(always)]
    fn from_fn(mut number: impl FnMut(usize) -> f32) -> Self {
        number(0)
    }
    #[inline(always)]
    fn get(self, _: usize) -> f32 {
        self
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self::mul_add(self, factor, term)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self::abs(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
    #[inline(always)]
    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn eq(self, other: Self) -> bool {
        self == other
    }
    #[inline(always)]
    fn same_bits(self, other: Self) -> bool {
        self.to_bits() == other.to_bits()
    }
}

/// Rays in lanes: the same ray in each, or the rays of a packet.
#[derive(Debug, Clone, Copy)]
pub struct LaneRay<L> {
    /// Origins.
    pub origin: LaneVec3<L>,
    /// Directions.
    pub dir: LaneVec3<L>,
}

impl<L> LaneRay<L> {
    /// The same ray in every lane.
    #[must_use]
    #[inline(always)]
    pub fn splat<const W: usize>(ray: &Ray) -> Self
    where
        L: Lane<W>,
    {
        Self {
            origin: LaneVec3::splat(ray.origin),
            dir: LaneVec3::splat(ray.dir),
        }
    }

    /// One ray a lane.
    #[must_use]
    #[inline(always)]
    pub fn of<'a, const W: usize>(ray: impl Fn(usize) -> &'a Ray) -> Self
    where
        L: Lane<W>,
    {
        Self {
            origin: LaneVec3::of(|lane| ray(lane).origin),
            dir: LaneVec3::of(|lane| ray(lane).dir),
        }
    }
}

/// A vector whose components are lanes.
#[derive(Debug, Clone, Copy)]
pub struct LaneVec3<L> {
    /// First component.
    pub x: L,
    /// Second component.
    pub y: L,
    /// Third component.
    pub z: L,
}

impl<L> LaneVec3<L> {
    /// The same vector in every lane.
    #[must_use]
    #[inline(always)]
    pub fn splat<const W: usize>(v: Vec3) -> Self
    where
        L: Lane<W>,
    {
        Self {
            x: L::splat(v.x),
            y: L::splat(v.y),
            z: L::splat(v.z),
        }
    }

    /// One vector a lane.
    #[must_use]
    #[inline(always)]
    pub fn of<const W: usize>(vector: impl Fn(usize) -> Vec3) -> Self
    where
        L: Lane<W>,
    {
        Self {
            x: L::from_fn(|lane| vector(lane).x),
            y: L::from_fn(|lane| vector(lane).y),
            z: L::from_fn(|lane| vector(lane).z),
        }
    }

    /// One vector a lane, from three rows of `W` components.
    #[must_use]
    #[inline(always)]
    pub fn load<const W: usize>(rows: &[[f32; W]; 3]) -> Self
    where
        L: Lane<W>,
    {
        Self {
            x: L::load(&rows[0]),
            y: L::load(&rows[1]),
            z: L::load(&rows[2]),
        }
    }

    /// The components in another order.
    #[must_use]
    #[inline(always)]
    pub fn permuted(self, axes: [usize; 3]) -> Self
    where
        L: Copy,
    {
        let all = [self.x, self.y, self.z];
        let [x, y, z] = axes.map(|axis| all[axis]);
        Self { x, y, z }
    }

    /// The largest absolute component, lane by lane; where one is NaN, so may this be.
    #[must_use]
    #[inline(always)]
    pub fn largest<const W: usize>(self) -> L
    where
        L: Lane<W>,
    {
        self.x.abs().max(self.y.abs()).max(self.z.abs())
    }

    /// Componentwise difference.
    #[inline(always)]
    #[must_use]
    pub fn minus<const W: usize>(self, o: Self) -> Self
    where
        L: Lane<W>,
    {
        Self {
            x: self.x - o.x,
            y: self.y - o.y,
            z: self.z - o.z,
        }
    }

    /// Componentwise sum.
    #[inline(always)]
    #[must_use]
    pub fn plus<const W: usize>(self, o: Self) -> Self
    where
        L: Lane<W>,
    {
        Self {
            x: self.x + o.x,
            y: self.y + o.y,
            z: self.z + o.z,
        }
    }

    /// `self·s`.
    #[inline(always)]
    #[must_use]
    pub fn scaled<const W: usize>(self, s: L) -> Self
    where
        L: Lane<W>,
    {
        Self {
            x: self.x * s,
            y: self.y * s,
            z: self.z * s,
        }
    }

    /// `self + o·s`.
    #[inline(always)]
    #[must_use]
    pub fn add_scaled<const W: usize>(self, o: Self, s: L) -> Self
    where
        L: Lane<W>,
    {
        Self {
            x: self.x + o.x * s,
            y: self.y + o.y * s,
            z: self.z + o.z * s,
        }
    }

    /// Cross product, each component as fl(fl(ab) − fl(cd)).
    #[inline(always)]
    #[must_use]
    pub fn cross<const W: usize>(self, o: Self) -> Self
    where
        L: Lane<W>,
    {
        Self {
            x: self.y * o.z - self.z * o.y,
            y: self.z * o.x - self.x * o.z,
            z: self.x * o.y - self.y * o.x,
        }
    }

    /// Dot product, summed as (x + y) + z.
    #[inline(always)]
    pub fn dot<const W: usize>(self, o: Self) -> L
    where
        L: Lane<W>,
    {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Euclidean length.
    #[inline(always)]
    pub fn length<const W: usize>(self) -> L
    where
        L: Lane<W>,
    {
        self.dot(self).sqrt()
    }
}
