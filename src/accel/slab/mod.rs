//! The slab test: where a ray enters and leaves an axis-aligned box, without ever missing a box that it touches.
//!
//! ```text
//!          |  box  |        The far faces are met a little later and the near faces a little earlier than the exact
//!       .--+-------+--      ray meets them: the ray is a thin cone with its tip at the origin. Its half-width grows
//!   o==----+-------+--      by 8ε of the way, more than the test's own rounding (3 operations, 1.5ε) and what a
//!       '--+-------+--      kernel adds on a hit at the rim of a triangle.
//! ```
//!
//! A component of the direction that is as thin as the cone divides nothing: there the origin, widened by what the ray
//! and its cone can move across the scene, is compared with the slab. `0 · ∞` gives NaN, which constrains nothing.
//!
//! All of it is decided once a ray; a box costs six subtractions, six multiplications and six comparisons. [`wide`] tests
//! eight boxes at once, [`pencil`] those of many rays from one point.
//!
//! **Source:** T. Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013.
//! **Differs:** the pad lies in the reciprocals and thus also on the near side and across the ray, not only on the exit.

use crate::geometry::{Aabb, Ray};

mod pencil;
mod rays;
#[cfg(test)]
mod tests;
mod wide;

pub(super) use pencil::{PacketSlabs, Pencil};
pub(super) use rays::SlabRays;
pub(super) use wide::{Clip, NO_BOXES, Scene, WideCorners, WideSlabRay, box_in, put_box};

/// Half-width of the cone in units of the way along the ray's longest axis: 8ε = 16u. The test itself needs 4u.
pub(super) const CONE: f32 = 8.0 * f32::EPSILON;

/// Numbers beyond this (or below its inverse) could overflow (or underflow) on their way to `t`, a quotient of two of them; then no
/// face is trusted.
const RANGE: f32 = 1e18;

/// The corners of a box, least first.
pub(super) type Corners = [[f32; 3]; 2];

/// The corners of `aabb` in the form that the test reads.
pub(super) fn corners(aabb: Aabb) -> Corners {
    [aabb.min.to_array(), aabb.max.to_array()]
}

/// What a traversal asks of a prepared ray about boxes.
pub(super) trait BoxTest {
    /// Prepares a valid ray for boxes inside `scene`.
    fn new(ray: &Ray, scene: &Aabb) -> Self;

    /// The `t` at which the ray enters and leaves the box, within its least `t` and `limit`; the box is missed if the
    /// first is greater than the second.
    fn clip(&self, corners: &Corners, limit: f32) -> (f32, f32);

    /// As [`BoxTest::clip`], `None` where the box is missed.
    #[inline(always)]
    fn interval(&self, corners: &Corners, limit: f32) -> Option<(f32, f32)> {
        let (entry, exit) = self.clip(corners, limit);
        (entry <= exit).then_some((entry, exit))
    }
}

/// A ray against the planes across one axis.
#[derive(Debug, Clone, Copy)]
struct Slab {
    near_origin: f32,
    far_origin: f32,
    near_inverse: f32,
    far_inverse: f32,
    /// Which side the ray comes from: 1 where its direction is negative.
    near: usize,
}

/// A ray prepared for slab tests against boxes within one scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct SlabRay {
    slabs: [Slab; 3],
    t_min: f32,
}

/// The farthest that the ray can be from its origin along an axis while it is inside the scene.
#[inline(always)]
fn reach(ray: &Ray, scene: &Aabb) -> f32 {
    (scene.min - ray.origin)
        .abs()
        .max((scene.max - ray.origin).abs())
        .max_element()
}

/// Whether nothing can overflow or underflow on its way to `t`.
#[inline(always)]
fn is_trusted(ray: &Ray, longest: f32, reach: f32) -> bool {
    let in_range = |x: f32| x < RANGE && x > 1.0 / RANGE;
    in_range(longest) && (reach == 0.0 || in_range(reach)) && ray.origin.abs().max_element() < RANGE
}

impl SlabRay {
    /// Prepares a valid ray for boxes inside `scene`.
    #[inline]
    pub fn new(ray: &Ray, scene: &Aabb) -> Self {
        let reach = reach(ray, scene);
        let longest = ray.dir.abs().max_element();
        let trusted = is_trusted(ray, longest, reach);
        let (origin, dir) = (ray.origin.to_array(), ray.dir.to_array());
        let behind = ray.t_min < 0.0;
        Self {
            slabs: [0, 1, 2].map(|axis| {
                if trusted {
                    Slab::new(origin[axis], dir[axis], longest, reach, behind)
                } else {
                    Slab::unconstrained(dir[axis])
                }
            }),
            // Infinite t means "outside the slab" below, so the interval must not contain it.
            t_min: ray.t_min.max(-f32::MAX),
        }
    }

    /// The `t` at which the ray enters and leaves the closed box, within `t_min` and `limit`; the box is missed if the
    /// first is greater than the second. Never misses a box within the scene that the exact ray touches, and the entry
    /// is never later than the exact one.
    #[inline(always)]
    pub fn clip(&self, corners: &Corners, limit: f32) -> (f32, f32) {
        let mut entry = self.t_min;
        let mut exit = limit.min(f32::MAX);
        let mut narrow = |axis: usize| {
            let slab = &self.slabs[axis];
            let near = slab.near & 1;
            entry = slab.enter(corners[near][axis], entry);
            exit = slab.leave(corners[near ^ 1][axis], exit);
        };
        narrow(0);
        narrow(1);
        narrow(2);
        (entry, exit)
    }

    /// The ray at the plane where `axis` is `plane`: the latest `t` on the side that it comes from, the earliest `t` on the
    /// other, and which side it comes from: 1 for that of the greater coordinates. NaN constrains nothing.
    ///
    /// The ray does not touch the first side after the one, nor the second before the other. Both are touched where the
    /// plane is met, or lain in, within the pad.
    #[inline(always)]
    pub fn crossing(&self, axis: usize, plane: f32) -> (f32, f32, u32) {
        let slab = &self.slabs[axis];
        (
            (plane - slab.far_origin) * slab.far_inverse,
            (plane - slab.near_origin) * slab.near_inverse,
            slab.near as u32,
        )
    }
}

impl BoxTest for SlabRay {
    #[inline(always)]
    fn new(ray: &Ray, scene: &Aabb) -> Self {
        Self::new(ray, scene)
    }

    #[inline(always)]
    fn clip(&self, corners: &Corners, limit: f32) -> (f32, f32) {
        Self::clip(self, corners, limit)
    }
}

impl Slab {
    /// Planes that constrain nothing: every product with NaN is NaN.
    fn unconstrained(dir: f32) -> Self {
        Self {
            near_origin: 0.0,
            far_origin: 0.0,
            near_inverse: f32::NAN,
            far_inverse: f32::NAN,
            near: usize::from(dir < 0.0),
        }
    }

    /// `longest` is the longest component of the direction; see [`SlabRay::new`] for `reach`.
    #[inline(always)]
    fn new(origin: f32, dir: f32, longest: f32, reach: f32, behind: bool) -> Self {
        let sign = 1.0_f32.copysign(dir);
        let width = CONE * longest;
        let near = usize::from(sign < 0.0);
        if dir.abs() <= 2.0 * width {
            // Across the scene the ray moves by less than this pad along the axis. Where the pad is lost in rounding,
            // the next coordinate that a face can have lies beyond it.
            let pad = (0.5 * CONE + 2.0 * (dir.abs() / longest)) * reach;
            Self {
                near_origin: origin + sign * pad,
                far_origin: origin - sign * pad,
                near_inverse: sign * f32::INFINITY,
                far_inverse: sign * f32::INFINITY,
                near,
            }
        } else if behind {
            // Behind the origin the cone would be the wrong way round: pad by its greatest width instead.
            let (up, down) = (
                (origin + CONE * reach).next_up(),
                (origin - CONE * reach).next_down(),
            );
            Self {
                near_origin: if sign < 0.0 { down } else { up },
                far_origin: if sign < 0.0 { up } else { down },
                near_inverse: 1.0 / dir,
                far_inverse: 1.0 / dir,
                near,
            }
        } else {
            Self {
                near_origin: origin,
                far_origin: origin,
                near_inverse: 1.0 / (dir + sign * width),
                far_inverse: 1.0 / (dir - sign * width),
                near,
            }
        }
    }

    /// The later of `entry` and the earliest `t` beyond `plane`. Written so that NaN constrains nothing.
    #[inline(always)]
    fn enter(&self, plane: f32, entry: f32) -> f32 {
        let t = (plane - self.near_origin) * self.near_inverse;
        if t > entry { t } else { entry }
    }

    /// The earlier of `exit` and the latest `t` before `plane`. Written so that NaN constrains nothing.
    #[inline(always)]
    fn leave(&self, plane: f32, exit: f32) -> f32 {
        let t = (plane - self.far_origin) * self.far_inverse;
        if t < exit { t } else { exit }
    }
}
