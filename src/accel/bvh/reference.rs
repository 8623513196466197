//! What the builds sort: a triangle's box and its index, in 32 bytes that two vector registers hold.

use glam::Vec4;

use crate::geometry::Aabb;

/// A box whose corners are vectors of four lanes; the fourth means nothing here.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    pub min: Vec4,
    pub max: Vec4,
}

impl Bounds {
    /// Growing it by a box gives that box.
    pub const EMPTY: Self = Self {
        min: Vec4::INFINITY,
        max: Vec4::NEG_INFINITY,
    };

    #[inline(always)]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    #[inline(always)]
    pub fn grown(self, point: Vec4) -> Self {
        Self {
            min: self.min.min(point),
            max: self.max.max(point),
        }
    }

    #[inline(always)]
    pub fn extent(&self) -> Vec4 {
        self.max - self.min
    }

    /// Half the surface in units of the square of 1 / `scale`; zero for the empty box.
    #[inline(always)]
    pub fn half_area(&self, scale: f32) -> f32 {
        let e = (self.extent() * scale).max(Vec4::ZERO).to_array();
        e[0] * (e[1] + e[2]) + e[1] * e[2]
    }

    /// A power of two that brings the longest edge near 1, so that areas in `f32` neither overflow nor vanish.
    #[inline(always)]
    pub fn scale(&self) -> f32 {
        let exponent = self.extent().truncate().max_element().to_bits() >> 23;
        // Exponents of normal numbers run from 1 to 254, and 127 means 1.
        f32::from_bits((254 - exponent.clamp(1, 253)) << 23)
    }

    #[inline(always)]
    pub fn aabb(&self) -> Aabb {
        Aabb {
            min: self.min.truncate(),
            max: self.max.truncate(),
        }
    }
}

impl From<Aabb> for Bounds {
    #[inline(always)]
    fn from(aabb: Aabb) -> Self {
        Self {
            min: aabb.min.extend(0.0),
            max: aabb.max.extend(0.0),
        }
    }
}

/// A reference to a triangle: the box of its part, and its index.
///
/// The fourth lanes hold the two halves of the index as whole numbers: what its bits would be as a number is often
/// subnormal, and arithmetic on such a lane costs a hundred cycles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reference(Bounds);

impl Reference {
    pub const NONE: Self = Self(Bounds::EMPTY);

    #[inline(always)]
    pub fn new(aabb: Aabb, prim: u32) -> Self {
        Self(Bounds {
            min: aabb.min.extend((prim & 0xFFFF) as f32),
            max: aabb.max.extend((prim >> 16) as f32),
        })
    }

    #[inline(always)]
    pub fn prim(&self) -> u32 {
        self.0.min.w as u32 | (self.0.max.w as u32) << 16
    }

    /// The box; its fourth lanes mean nothing.
    #[inline(always)]
    pub fn bounds(&self) -> Bounds {
        self.0
    }

    /// Half the middle of the box, so that no difference of two overflows.
    #[inline(always)]
    pub fn centroid(&self) -> Vec4 {
        self.0.min * 0.25 + self.0.max * 0.25
    }
}

/// The boxes of references and of their centroids.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    pub bounds: Bounds,
    pub centroids: Bounds,
}

impl Extent {
    pub const EMPTY: Self = Self {
        bounds: Bounds::EMPTY,
        centroids: Bounds::EMPTY,
    };

    #[inline(always)]
    pub fn grown(self, reference: &Reference) -> Self {
        Self {
            bounds: self.bounds.union(reference.bounds()),
            centroids: self.centroids.grown(reference.centroid()),
        }
    }

    pub fn union(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            centroids: self.centroids.union(other.centroids),
        }
    }
}
