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

/// Least size of a component that a cone around a direction, `longest` of which is the longest, does not turn round.
#[inline(always)]
fn thin(longest: f32) -> f32 {
    2.0 * CONE * longest
}

/// The sizes of the components of the rays of `bundle` by the signs of the first: the nearer to 0 first. Those that are not
/// greater than [`thin`] belong to rays that run along the axis in both directions, or nearly across it.
#[inline(always)]
fn sizes<R: Lane<1>>(bundle: &Bundle<R>) -> (Vec3, [Vec3; 2]) {
    let sign = Vec3::ONE.copysign(bundle.rays[0].dir);
    let [least, greatest] = bundle.interval;
    let (a, b) = (least * sign, greatest * sign);
    (sign, [a.min(b), a.max(b)])
}

/// Whether the rays of `bundle` share their origin, nothing lies behind it, and nothing can overflow or underflow on its way
/// to a `t`.
#[inline(always)]
fn are_trusted<R: Lane<1>>(bundle: &Bundle<R>, reach: f32) -> bool {
    let [shortest, longest] = bundle.longest;
    let lead = &bundle.rays[0];
    bundle.share_origin
        && bundle.t_min >= 0.0
        && is_trusted(lead, shortest, reach)
        && is_trusted(lead, longest, reach)
}

impl Pencil {
    /// Of the rays of `bundle`; `None` where their directions differ in a sign or a ray is not plain.
    #[inline(always)]
    pub fn new<R: Lane<1>>(bundle: &Bundle<R>, scene: &Aabb) -> Option<Self> {
        let lead = &bundle.rays[0];
        let (sign, [small, large]) = sizes(bundle);
        let [shortest, longest] = bundle.longest;
        // What a rounding of the width leaves, for every ray of the bundle.
        let is_plain = small.min_element() > thin(longest);
        if !is_plain || !are_trusted(bundle, reach(lead, scene)) {
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
            t_min: bundle.t_min,
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
    axes: [Axis<L>; 3],
    t_min: L,
}

/// The rays of a packet along one axis.
#[derive(Debug, Clone, Copy)]
struct Axis<L> {
    /// Whether they run in both directions: then [`Axis::near`] holds the reciprocals of the fastest in either, and none
    /// leaves.
    ///
    /// ```text
    ///      |  o  |      a slab that lies on one side of the origin is entered by the fastest ray to that side; those that run
    ///      | /|\ |      the other way, or nearly across the axis, never meet it, and never leave one around the origin
    /// ```
    both: bool,
    /// Which side they come from: 1 where their directions are negative.
    side: usize,
    /// Where they begin; where they run in both directions, as far towards the slab as one that is called parallel may be.
    origin: [L; 2],
    /// Least and greatest reciprocals.
    near: [L; 2],
    far: [L; 2],
}

impl<L: Lane<8>> Axis<L> {
    /// Of rays with components from `small` to `large` in the direction of `sign`; `narrow` and `wide` are the least and the
    /// greatest width of their cones.
    #[inline(always)]
    fn new(
        origin: f32,
        sign: f32,
        [small, large]: [f32; 2],
        [narrow, wide]: [f32; 2],
        reach: f32,
    ) -> Self {
        let both = small <= 2.0 * wide;
        let (origins, near, far) = if both {
            let (down, up) = (small.min(0.0) - wide, large.max(0.0) + wide);
            let (up, down) = if sign < 0.0 { (-down, -up) } else { (up, down) };
            // See `Slab::new`: of a component up to twice its cone's width.
            let pad = 5.0 * CONE * reach;
            (
                [origin + pad, origin - pad],
                [1.0 / up, 1.0 / down],
                [0.0; 2],
            )
        } else {
            let bounds = |a: f32, b: f32| [(sign / a).min(sign / b), (sign / a).max(sign / b)];
            (
                [origin; 2],
                bounds(large + wide, small + narrow),
                bounds(large - narrow, small - wide),
            )
        };
        let splat = |[a, b]: [f32; 2]| [L::splat(a), L::splat(b)];
        Self {
            both,
            side: usize::from(sign < 0.0),
            origin: splat(origins),
            near: splat(near),
            far: splat(far),
        }
    }

    /// Earliest entry into a slab over all rays.
    #[inline(always)]
    fn enter(&self, slab: &[[f32; 8]; 2]) -> L {
        if self.both {
            let above = (L::load(&slab[0]) - self.origin[0]) * self.near[0];
            let below = (L::load(&slab[1]) - self.origin[1]) * self.near[1];
            return above.max(below);
        }
        let way = L::load(&slab[self.side & 1]) - self.origin[0];
        (way * self.near[0]).min(way * self.near[1])
    }

    /// Latest exit from it over all rays, if not later than `last`.
    #[inline(always)]
    fn leave(&self, slab: &[[f32; 8]; 2], last: L) -> L {
        if self.both {
            return last;
        }
        let way = L::load(&slab[self.side & 1 ^ 1]) - self.origin[0];
        (way * self.far[0]).max(way * self.far[1])
    }
}

impl<L: Lane<8>> PacketSlabs<L> {
    /// Of the rays of `bundle`; `None` where one is not plain.
    #[inline(always)]
    pub fn new<R: Lane<1>>(bundle: &Bundle<R>, scene: &Aabb) -> Option<Self> {
        let lead = &bundle.rays[0];
        let reach = reach(lead, scene);
        if !are_trusted(bundle, reach) {
            return None;
        }
        let (sign, [small, large]) = sizes(bundle);
        let widths = bundle.longest.map(|longest| CONE * longest);
        let origin = lead.origin;
        Some(Self {
            axes: [
                Axis::new(origin.x, sign.x, [small.x, large.x], widths, reach),
                Axis::new(origin.y, sign.y, [small.y, large.y], widths, reach),
                Axis::new(origin.z, sign.z, [small.z, large.z], widths, reach),
            ],
            t_min: L::splat(bundle.t_min),
        })
    }
}

impl<L: Lane<8>> Clip<L> for PacketSlabs<L> {
    #[inline(always)]
    fn clip(&self, boxes: &WideCorners, limit: f32) -> (L, L) {
        let [x, y, z] = &self.axes;
        let last = L::splat(limit.min(f32::MAX));
        let entry = y.enter(&boxes[1]).max(z.enter(&boxes[2]));
        let exit = y.leave(&boxes[1], last).min(z.leave(&boxes[2], last));
        (
            entry.max(x.enter(&boxes[0]).max(self.t_min)),
            exit.min(x.leave(&boxes[0], last).min(last)),
        )
    }
}
