//! Rays and hits, in the layout of the `.rays` files.

use super::Vec3;

/// A ray: the points `origin + t·dir` with `t` in the closed interval `[t_min, t_max]`.
///
/// `dir` need not be unit length; `t` counts lengths of `dir`. Memory layout is that of a `.rays` record: eight `f32`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Where `t` is 0.
    pub origin: Vec3,
    /// Least accepted `t`, inclusive.
    pub t_min: f32,
    /// Direction and unit of `t`.
    pub dir: Vec3,
    /// Greatest accepted `t`, inclusive; may be infinite.
    pub t_max: f32,
}

impl Ray {
    /// The ray from `origin` along `dir` with `t` from 0 to infinity.
    #[must_use]
    pub const fn new(origin: Vec3, dir: Vec3) -> Self {
        Self {
            origin,
            t_min: 0.0,
            dir,
            t_max: f32::INFINITY,
        }
    }

    /// The point at `t`.
    #[must_use]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.dir * t
    }

    /// Whether origin and direction are finite, the direction is not zero, and neither bound is NaN.
    ///
    /// Ray sets hold only valid rays, so nothing below checks again.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.origin.is_finite()
            && self.dir.is_finite()
            && self.dir != Vec3::ZERO
            && !self.t_min.is_nan()
            && !self.t_max.is_nan()
    }
}

/// What a closest-hit query found: a triangle and where, or [`Hit::MISS`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Hit {
    /// Ray parameter of the hit; infinite for a miss.
    pub t: f32,
    /// Barycentric weight of vertex 1.
    pub u: f32,
    /// Barycentric weight of vertex 2.
    pub v: f32,
    /// Triangle index in file order; [`Hit::NO_PRIM`] for a miss.
    pub prim: u32,
}

/// What code that reads and writes them by registers relies on.
const _: () = assert!(size_of::<Ray>() == 32 && size_of::<Hit>() == 16);

impl Hit {
    /// The triangle index that says "none".
    pub const NO_PRIM: u32 = u32::MAX;

    /// No triangle within the ray's interval.
    pub const MISS: Self = Self {
        t: f32::INFINITY,
        u: 0.0,
        v: 0.0,
        prim: Self::NO_PRIM,
    };

    /// Whether a triangle was hit.
    #[must_use]
    pub fn is_hit(&self) -> bool {
        self.prim != Self::NO_PRIM
    }

    /// Whether both name the same triangle at the same `t`, bit for bit. All misses are equal.
    #[must_use]
    pub fn same_answer(&self, other: &Self) -> bool {
        self.prim == other.prim && (!self.is_hit() || self.t.to_bits() == other.t.to_bits())
    }
}
