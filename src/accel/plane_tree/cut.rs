//! Where rays cross planes, never too late into a side and never too early out of one.
//!
//! At axis-parallel planes these are the slab test's own numbers. At oblique ones everything is computed in `f64`, of which
//! the rounding is lost in the pads: that of the plane, and the cone that the slab test makes of a ray.

use crate::geometry::{Aabb, DVec3, Ray, Vec3};

use super::super::slab::{CONE, Pencil, SlabRay, corners};
use super::node::Oblique;

/// The latest `t` on the side that is met first, the earliest `t` on the other, and which one is met first: 1 for the side
/// above. `NaN` constrains nothing.
pub(super) type Crossing = (f32, f32, u32);

/// A ray, or a packet of them, against planes.
pub(super) trait Cut {
    /// The interval within the closed box and before `limit`; empty where the first is greater than the second.
    fn interval(&self, bounds: &Aabb, limit: f32) -> (f32, f32);
    /// The crossing of the plane where `axis` is `place`.
    fn axis(&self, axis: usize, place: f32) -> Crossing;
    /// The crossing of an oblique plane.
    fn oblique(&self, plane: &Oblique) -> Crossing;
}

/// One ray.
pub(super) struct RayCut {
    slabs: SlabRay,
    origin: DVec3,
    dir: DVec3,
    /// Whether it begins behind its origin.
    behind: bool,
    /// Half-width of its cone a unit of `t`.
    width: f64,
}

impl RayCut {
    pub fn new(ray: &Ray, scene: &Aabb) -> Self {
        Self {
            slabs: SlabRay::new(ray, scene),
            origin: ray.origin.as_dvec3(),
            dir: ray.dir.as_dvec3(),
            behind: ray.t_min < 0.0,
            width: f64::from(CONE) * f64::from(ray.dir.abs().max_element()),
        }
    }
}

impl Cut for RayCut {
    #[inline(always)]
    fn interval(&self, bounds: &Aabb, limit: f32) -> (f32, f32) {
        self.slabs.clip(&corners(*bounds), limit)
    }

    #[inline(always)]
    fn axis(&self, axis: usize, place: f32) -> Crossing {
        self.slabs.crossing(axis, place)
    }

    #[inline(always)]
    fn oblique(&self, plane: &Oblique) -> Crossing {
        let (height, rise) = (plane.height(self.origin), plane.normal.dot(self.dir));
        crossing(plane, height, rise, self.width, self.behind)
    }
}

/// Of a ray that begins at `height` above a plane and rises by `rise` a unit of `t`; its cone widens by `width`.
///
/// ```text
///   near side touched:   height − t·fall + pad + |t|·width ≥ 0        fall = |rise|, heights counted towards
///   far side touched:    height − t·fall − pad − |t|·width ≤ 0        the side that the ray comes from
/// ```
#[inline(always)]
fn crossing(plane: &Oblique, height: f64, rise: f64, width: f64, behind: bool) -> Crossing {
    let near = u32::from(rise < 0.0);
    let (height, fall) = if rise < 0.0 {
        (height, -rise)
    } else {
        (-height, rise)
    };
    let width = width * plane.reach();
    let (last, first) = (height + plane.pad, height - plane.pad);
    // Behind the origin the cone widens the other way.
    let along = |height: f64, later: bool| {
        let width = if (height > 0.0) == later {
            -width
        } else {
            width
        };
        height / (fall + width)
    };
    if fall <= 2.0 * width {
        // As good as parallel to the plane: the near side is left nowhere, and the far side entered if it is touched.
        let first = if first > 0.0 && !behind {
            (first / (fall + width)) as f32
        } else {
            f32::NEG_INFINITY
        };
        return (f32::INFINITY, first, near);
    }
    (along(last, true) as f32, along(first, false) as f32, near)
}

/// A packet: bounds on what each of its rays would compute.
pub(super) struct PacketCut {
    pencil: Pencil,
    dirs: [DVec3; 2],
    width: f64,
}

impl PacketCut {
    pub fn new(pencil: Pencil) -> Self {
        Self {
            dirs: pencil.dirs.map(Vec3::as_dvec3),
            width: f64::from(CONE) * f64::from(pencil.longest),
            pencil,
        }
    }
}

impl Cut for PacketCut {
    #[inline(always)]
    fn interval(&self, bounds: &Aabb, limit: f32) -> (f32, f32) {
        let (mut entry, mut exit) = (self.pencil.t_min, limit.min(f32::MAX));
        let [min, max] = corners(*bounds);
        for axis in 0..3 {
            let first = if self.pencil.near[axis] == 0 {
                min
            } else {
                max
            };
            let last = if self.pencil.near[axis] == 0 {
                max
            } else {
                min
            };
            entry = entry.max(self.pencil.enter(axis, first[axis]));
            exit = exit.min(self.pencil.leave(axis, last[axis]));
        }
        (entry, exit)
    }

    #[inline(always)]
    fn axis(&self, axis: usize, place: f32) -> Crossing {
        let pencil = &self.pencil;
        (
            pencil.leave(axis, place),
            pencil.enter(axis, place),
            pencil.near[axis],
        )
    }

    #[inline(always)]
    fn oblique(&self, plane: &Oblique) -> Crossing {
        let height = plane.height(self.pencil.origin.as_dvec3());
        let [a, b] = self.dirs.map(|dir| plane.normal * dir);
        let (least, greatest) = (a.min(b).element_sum(), a.max(b).element_sum());
        if least < 0.0 && greatest >= 0.0 {
            // Rays of both kinds: both sides, that of the origin first.
            return (f32::INFINITY, f32::NEG_INFINITY, u32::from(height > 0.0));
        }
        let (a, b) = (
            crossing(plane, height, least, self.width, false),
            crossing(plane, height, greatest, self.width, false),
        );
        (a.0.max(b.0), a.1.min(b.1), a.2)
    }
}
