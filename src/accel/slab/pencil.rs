//! The slabs of rays from one point: bounds that hold for each of them.

use crate::geometry::lanes::Lane;
use crate::geometry::{Aabb, Vec3};

use super::super::packet::Bundle;
use super::{CONE, Clip, WideCorners, is_trusted, reach};

/// The slabs of rays from one octant with a common origin, plane by plane.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Pencil {
    axes: [Axis<f32>; 3],
    /// Where the rays begin.
    pub origin: Vec3,
    /// Least and greatest components of the directions.
    pub dirs: [Vec3; 2],
    /// The greatest component of all.
    pub longest: f32,
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

/// The rays of `bundle` along each axis; `None` where one is not plain.
#[inline(always)]
fn axes<R: Lane<1>, const W: usize, L: Lane<W>>(
    bundle: &Bundle<R>,
    scene: &Aabb,
) -> Option<[Axis<L>; 3]> {
    let lead = &bundle.rays[0];
    let reach = reach(lead, scene);
    if !are_trusted(bundle, reach) {
        return None;
    }
    let (origin, (sign, [small, large])) = (lead.origin, sizes(bundle));
    let longest = bundle.longest;
    Some([
        Axis::new(origin.x, sign.x, [small.x, large.x], longest, reach),
        Axis::new(origin.y, sign.y, [small.y, large.y], longest, reach),
        Axis::new(origin.z, sign.z, [small.z, large.z], longest, reach),
    ])
}

impl Pencil {
    /// Of the rays of `bundle`; `None` where their directions differ in a sign or a ray is not plain.
    #[inline(always)]
    pub fn new<R: Lane<1>>(bundle: &Bundle<R>, scene: &Aabb) -> Option<Self> {
        let axes: [Axis<f32>; 3] = axes(bundle, scene)?;
        let [x, y, z] = &axes;
        (!(x.both | y.both | z.both)).then_some(Self {
            near: [x.side as u32, y.side as u32, z.side as u32],
            axes,
            origin: bundle.rays[0].origin,
            dirs: bundle.interval,
            longest: bundle.longest[1],
            t_min: bundle.t_min,
        })
    }

    /// Earliest `t` beyond the plane where `axis` is `plane` over all rays.
    #[inline(always)]
    pub fn enter(&self, axis: usize, plane: f32) -> f32 {
        self.axes[axis].earliest(plane)
    }

    /// Latest `t` before it over all rays.
    #[inline(always)]
    pub fn leave(&self, axis: usize, plane: f32) -> f32 {
        self.axes[axis].latest(plane)
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
    /// Reciprocals of the fastest and of the slowest, each the bound of what a ray's own may be.
    near: [L; 2],
    far: [L; 2],
}

impl<L> Axis<L> {
    /// Of rays with components from `small` to `large` in the direction of `sign`, whose longest components are from
    /// `shortest` to `longest`.
    #[inline(always)]
    fn new<const W: usize>(
        origin: f32,
        sign: f32,
        [small, large]: [f32; 2],
        [shortest, longest]: [f32; 2],
        reach: f32,
    ) -> Self
    where
        L: Lane<W>,
    {
        let (narrow, wide) = (CONE * shortest, CONE * longest);
        // The width is rounded, for every ray of the bundle.
        let both = small <= thin(longest);
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
            // Each ray's own lie between: every step of the way to them is monotone.
            (
                [origin; 2],
                [sign / (large + wide), sign / (small + narrow)],
                [sign / (large - narrow), sign / (small - wide)],
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

    /// Earliest `t` beyond a plane over all rays, if they run in one direction.
    #[inline(always)]
    fn earliest<const W: usize>(&self, plane: L) -> L
    where
        L: Lane<W>,
    {
        let way = plane - self.origin[0];
        (way * self.near[0]).min(way * self.near[1])
    }

    /// Latest `t` before it.
    #[inline(always)]
    fn latest<const W: usize>(&self, plane: L) -> L
    where
        L: Lane<W>,
    {
        let way = plane - self.origin[0];
        (way * self.far[0]).max(way * self.far[1])
    }
}

impl<L: Lane<8>> Axis<L> {
    /// Earliest entry into a slab over all rays.
    #[inline(always)]
    fn enter(&self, slab: &[[f32; 8]; 2]) -> L {
        if self.both {
            let above = (L::load(&slab[0]) - self.origin[0]) * self.near[0];
            let below = (L::load(&slab[1]) - self.origin[1]) * self.near[1];
            return above.max(below);
        }
        self.earliest(L::load(&slab[self.side & 1]))
    }

    /// Latest exit from it over all rays, if not later than `last`.
    #[inline(always)]
    fn leave(&self, slab: &[[f32; 8]; 2], last: L) -> L {
        if self.both {
            return last;
        }
        self.latest(L::load(&slab[self.side & 1 ^ 1]))
    }
}

impl<L: Lane<8>> PacketSlabs<L> {
    /// Of the rays of `bundle`; `None` where one is not plain.
    #[inline(always)]
    pub fn new<R: Lane<1>>(bundle: &Bundle<R>, scene: &Aabb) -> Option<Self> {
        Some(Self {
            axes: axes(bundle, scene)?,
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
