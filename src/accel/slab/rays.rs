//! Sixteen rays, a lane each, against one box.
//!
//! The rays come from one octant, so that the near planes of a box are the same for all. The formulas are those of
//! [`super::wide`], with rays in lanes in place of axes. One ray more stands for all: it tells of eight boxes at once which
//! of them none can meet.
//!
//! ```text
//!    o -.__                 least and greatest origin, fastest and slowest direction along an axis:
//!    o ----=>  |  box  |    the hull meets the near planes first with the former of each, the far ones last
//!    o -'"                  with the latter
//! ```

use crate::geometry::lanes::{Lane, LaneMask, RayLanes};

use super::wide::{FAR, Scene, is_plain, moved, padded, share};
use super::{CONE, WideCorners, WideSlabRay};

/// The rays. What is computed of one that is not plain means nothing.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct SlabRays<L> {
    /// Of each axis for the near and the far planes.
    inverse: [[L; 2]; 3],
    offset: [[L; 2]; 3],
    /// Which side they come from: 1 where their directions are negative.
    near: [usize; 3],
    t_min: L,
    /// A bit for each that is plain.
    pub plain: u32,
    /// Meets every box that a plain one meets.
    pub hull: WideSlabRay,
}

impl<L: Lane<1>> SlabRays<L> {
    /// The rays, all with direction signs `near`.
    #[inline(always)]
    pub fn new(rays: &RayLanes<L>, near: [usize; 3], scene: &Scene) -> Self {
        let (origin, dir, t_min) = (&rays.lines.origin, &rays.lines.dir, rays.t_min);
        let shortest = dir.x.abs().min(dir.y.abs()).min(dir.z.abs());
        let longest = dir.largest();
        let is_plain = is_plain([shortest, longest], origin.largest(), t_min, scene);
        let width = longest * L::splat(CONE);
        let (x, x_offset) = Self::axis(origin.x, dir.x, width);
        let (y, y_offset) = Self::axis(origin.y, dir.y, width);
        let (z, z_offset) = Self::axis(origin.z, dir.z, width);
        let (inverse, origins) = ([x, y, z], [origin.x, origin.y, origin.z]);
        Self {
            inverse,
            offset: [x_offset, y_offset, z_offset],
            near,
            t_min,
            plain: is_plain.bits(),
            hull: Self::hull(origins, inverse, near, is_plain),
        }
    }

    /// A ray that meets each box no later and leaves it no earlier than any of the `plain` ones.
    ///
    /// Nothing lies behind a plain ray, so where a plane is behind the hull it may be as far behind as it likes.
    #[inline(always)]
    fn hull(
        origins: [L; 3],
        inverse: [[L; 2]; 3],
        near_sides: [usize; 3],
        plain: L::Mask,
    ) -> WideSlabRay {
        let least = |x| L::select(plain, x, L::splat(f32::INFINITY)).least();
        let greatest = |x| L::select(plain, x, L::splat(f32::NEG_INFINITY)).greatest();
        let mut hull = WideSlabRay {
            near: near_sides,
            ..WideSlabRay::NONE
        };
        for (axis, origin) in origins.into_iter().enumerate() {
            let [near, far] = inverse[axis];
            let (least_origin, greatest_origin) = (least(origin), greatest(origin));
            let ((first, near), (last, far)) = if near_sides[axis] == 0 {
                (
                    (greatest_origin, least(near)),
                    (least_origin, greatest(far)),
                )
            } else {
                (
                    (least_origin, greatest(near)),
                    (greatest_origin, least(far)),
                )
            };
            hull.inverse[axis] = near;
            hull.inverse[FAR + axis] = far;
            hull.offset[axis] = padded(first * near, -1.0);
            hull.offset[FAR + axis] = padded(last * far, 1.0);
        }
        hull
    }

    /// Inverses and offsets of one axis, for near planes and far ones.
    #[inline(always)]
    fn axis(origin: L, dir: L, width: L) -> ([L; 2], [L; 2]) {
        let inverse = L::splat(1.0) / dir;
        let (share, one) = (share(inverse, width), L::splat(1.0));
        let near = moved(inverse, share, -one);
        let far = moved(inverse, share, one + L::splat(2.0) * share);
        let offsets = [padded(origin * near, -one), padded(origin * far, one)];
        ([near, far], offsets)
    }

    /// Where the rays enter and leave a child's box, each until its limit; it is missed if the first is greater than the
    /// second.
    #[inline(always)]
    pub fn clip(&self, boxes: &WideCorners, child: usize, limits: L) -> (L, L) {
        let near = self.meet(boxes, child, 0, 0);
        let entry = self
            .meet(boxes, child, 1, 0)
            .max(self.meet(boxes, child, 2, 0));
        let far = self.meet(boxes, child, 0, 1);
        let exit = self
            .meet(boxes, child, 1, 1)
            .min(self.meet(boxes, child, 2, 1));
        (entry.max(near.max(self.t_min)), exit.min(far.min(limits)))
    }

    /// Where they meet the plane on one side of an axis (0: near).
    #[inline(always)]
    fn meet(&self, boxes: &WideCorners, child: usize, axis: usize, side: usize) -> L {
        let plane = L::splat(boxes[axis][(self.near[axis] ^ side) & 1][child & 7]);
        plane.mul_sub_freely(self.inverse[axis][side], self.offset[axis][side])
    }

    /// One of the rays.
    #[inline(always)]
    pub fn ray(&self, lane: usize) -> WideSlabRay {
        let (mut inverse, mut offset) = ([0.0; 8], [0.0; 8]);
        for axis in 0..3 {
            for side in 0..2 {
                inverse[side * FAR + axis] = self.inverse[axis][side].get(lane);
                offset[side * FAR + axis] = self.offset[axis][side].get(lane);
            }
        }
        WideSlabRay {
            inverse,
            offset,
            near: self.near,
            t_min: self.t_min.get(lane),
        }
    }
}
