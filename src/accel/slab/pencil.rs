//! The slabs of rays from one point: bounds that hold for each of them.

use crate::geometry::lanes::Lane;
use crate::geometry::{Aabb, Vec3};

use super::super::packet::Bundle;
use super::{CONE, Clip, WideCorners, is_trusted, reach};

/// What the slabs of rays with a common origin have in common: bounds on the reciprocals of their directions.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Pencil {
    /// Where the rays begin.
    pub origin: Vec3,
    /// Least and greatest components of the directions.
    pub dirs: [Vec3; 2],
    /// The greatest component of all.
    pub longest: f32,
    near_inverse: [Vec3; 2],
    far_inverse: [Vec3; 2],
    /// Which side the rays come from along each axis: 1 where their directions are negative.
    pub near: [u32; 3],
    /// Least of the rays.
    pub t_min: f32,
}

impl Pencil {
    /// Of the rays of `bundle`; `None` where their directions differ in a sign or a ray is not plain.
    #[inline(always)]
    pub fn new<R: Lane<1>>(bundle: &Bundle<R>, scene: &Aabb) -> Option<Self> {
        let lead = &bundle.rays[0];
        let reach = reach(lead, scene);
        let sign = Vec3::ONE.copysign(lead.dir);
        // Components by size, where all signs agree: the nearer to 0 first.
        let [least, greatest] = bundle.interval;
        let (small, large) = (
            (least * sign).min(greatest * sign),
            (least * sign).max(greatest * sign),
        );
        let [shortest, longest] = bundle.longest;
        // What a rounding of the width leaves, for every ray of the bundle.
        let is_plain = small.min_element() > 2.0 * CONE * longest
            && is_trusted(lead, shortest, reach)
            && is_trusted(lead, longest, reach);
        let mut t_min = f32::INFINITY;
        for ray in bundle.rays {
            t_min = if ray.t_min < t_min { ray.t_min } else { t_min };
        }
        if !is_plain || t_min < 0.0 {
            return None;
        }
        // Each ray's own lie between: every step of the way to them is monotone.
        let (narrow, wide) = (CONE * shortest, CONE * longest);
        let near = [
            (large + wide).recip() * sign,
            (small + narrow).recip() * sign,
        ];
        let far = [
            (large - narrow).recip() * sign,
            (small - wide).recip() * sign,
        ];
        Some(Self {
            origin: lead.origin,
            dirs: bundle.interval,
            longest,
            near_inverse: near,
            far_inverse: far,
            near: [
                u32::from(sign.x < 0.0),
                u32::from(sign.y < 0.0),
                u32::from(sign.z < 0.0),
            ],
            t_min,
        })
    }

    /// Earliest `t` beyond the plane where `axis` is `plane` over all rays.
    #[inline(always)]
    pub fn enter(&self, axis: usize, plane: f32) -> f32 {
        let way = plane - self.origin[axis];
        (way * self.near_inverse[0][axis]).min(way * self.near_inverse[1][axis])
    }

    /// Latest `t` before it over all rays.
    #[inline(always)]
    pub fn leave(&self, axis: usize, plane: f32) -> f32 {
        let way = plane - self.origin[axis];
        (way * self.far_inverse[0][axis]).max(way * self.far_inverse[1][axis])
    }
}

/// The slabs of rays with a common origin: an interval that encloses what a [`SlabRay`] computes for each of them.
///
/// Rounding is monotone, so a box that one of the rays meets by that test is met by this one.
///
/// [`SlabRay`]: super::SlabRay
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct PacketSlabs<L> {
    origin: [L; 3],
    /// Least and greatest reciprocals.
    near_inverse: [[L; 2]; 3],
    far_inverse: [[L; 2]; 3],
    near: [usize; 3],
    t_min: L,
}

impl<L: Lane<8>> PacketSlabs<L> {
    /// As [`Pencil::new`], in lanes.
    #[inline(always)]
    pub fn new<R: Lane<1>>(bundle: &Bundle<R>, scene: &Aabb) -> Option<Self> {
        let pencil = Pencil::new(bundle, scene)?;
        let origin = pencil.origin;
        Some(Self {
            origin: [L::splat(origin.x), L::splat(origin.y), L::splat(origin.z)],
            near_inverse: Self::bounds(pencil.near_inverse),
            far_inverse: Self::bounds(pencil.far_inverse),
            near: [
                pencil.near[0] as usize,
                pencil.near[1] as usize,
                pencil.near[2] as usize,
            ],
            t_min: L::splat(pencil.t_min),
        })
    }

    #[inline(always)]
    fn bounds([a, b]: [Vec3; 2]) -> [[L; 2]; 3] {
        let (least, greatest) = (a.min(b), a.max(b));
        [
            [L::splat(least.x), L::splat(greatest.x)],
            [L::splat(least.y), L::splat(greatest.y)],
            [L::splat(least.z), L::splat(greatest.z)],
        ]
    }

    /// Earliest entry into the near side of a slab over all rays.
    #[inline(always)]
    fn enter(&self, boxes: &WideCorners, axis: usize) -> L {
        let plane = L::load(&boxes[axis][self.near[axis]]) - self.origin[axis];
        let [least, greatest] = self.near_inverse[axis];
        (plane * least).min(plane * greatest)
    }

    /// Latest exit from the far side of a slab over all rays.
    #[inline(always)]
    fn leave(&self, boxes: &WideCorners, axis: usize) -> L {
        let plane = L::load(&boxes[axis][self.near[axis] ^ 1]) - self.origin[axis];
        let [least, greatest] = self.far_inverse[axis];
        (plane * least).max(plane * greatest)
    }
}

impl<L: Lane<8>> Clip<L> for PacketSlabs<L> {
    #[inline(always)]
    fn clip(&self, boxes: &WideCorners, limit: f32) -> (L, L) {
        let entry = self.enter(boxes, 1).max(self.enter(boxes, 2));
        let exit = self.leave(boxes, 1).min(self.leave(boxes, 2));
        let last = L::splat(limit.min(f32::MAX));
        (
            entry.max(self.enter(boxes, 0).max(self.t_min)),
            exit.min(self.leave(boxes, 0).min(last)),
        )
    }
}
