//! What the builds sort: a triangle's box and its index, in 32 bytes that two vector registers hold.

use glam::Vec4;

use crate::geometry::Aabb;
use crate::geometry::lanes::Lane;

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

/// A box as eight numbers: the least corner, and the greatest negated, so that growing it is one minimum of them all. The
/// fourth of each half means nothing here.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Hull(pub [f32; 8]);

impl Hull {
    /// Growing it by a box gives that box.
    pub const EMPTY: Self = Self([f32::INFINITY; 8]);

    #[inline(always)]
    fn new(min: Vec4, max: Vec4) -> Self {
        let mut lanes = [0.0; 8];
        min.write_to_slice(&mut lanes[..4]);
        (-max).write_to_slice(&mut lanes[4..]);
        Self(lanes)
    }

    /// The least corner, and the greatest negated.
    #[inline(always)]
    pub fn halves(&self) -> [Vec4; 2] {
        // `from_array` would take them number by number.
        let (halves, _) = self.0.as_chunks::<4>();
        [Vec4::from(halves[0]), Vec4::from(halves[1])]
    }

    #[inline(always)]
    pub fn bounds(&self) -> Bounds {
        let [min, less_max] = self.halves();
        Bounds {
            min,
            max: -less_max,
        }
    }

    #[inline(always)]
    pub fn union(&self, other: &Self) -> Self {
        let ([a, b], [c, d]) = (self.halves(), other.halves());
        Self::new(a.min(c), -b.min(d))
    }

    /// Grows by the box whose lanes these are.
    #[inline(always)]
    pub fn grow<L: Lane<8>>(&mut self, by: L) {
        L::load(&self.0).min(by).write(&mut self.0);
    }

    /// As [`Bounds::half_area`], but infinite for the empty box.
    #[inline(always)]
    pub fn half_area(&self, scale: f32) -> f32 {
        let [min, less_max] = self.halves();
        // All three edges negated: products of two are as they should be.
        let e = ((min + less_max) * scale).to_array();
        e[0] * (e[1] + e[2]) + e[1] * e[2]
    }
}

/// A reference to a triangle: the box of its part, and its index.
///
/// The fourth lanes hold the two halves of the index as whole numbers: what its bits would be as a number is often
/// subnormal, and arithmetic on such a lane costs a hundred cycles.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub(super) struct Reference(Hull);

impl Reference {
    pub const NONE: Self = Self(Hull([0.0; 8]));

    #[inline(always)]
    pub fn new(aabb: Aabb, prim: u32) -> Self {
        Self(Hull::new(
            aabb.min.extend((prim & 0xFFFF) as f32),
            aabb.max.extend(-((prim >> 16) as f32)),
        ))
    }

    #[inline(always)]
    pub fn prim(&self) -> u32 {
        self.0.0[3] as u32 | (self.0.0[7] as u32) << 16
    }

    /// The box; its fourth lanes mean nothing.
    #[inline(always)]
    pub fn bounds(&self) -> Bounds {
        self.0.bounds()
    }

    /// The box.
    #[inline(always)]
    pub fn hull(&self) -> &Hull {
        &self.0
    }

    /// Half the middle of the box, so that no difference of two overflows.
    #[inline(always)]
    pub fn centroid(&self) -> Vec4 {
        let [min, less_max] = self.0.halves();
        min * 0.25 - less_max * 0.25
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
