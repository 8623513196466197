//! A ray against eight boxes at once.
//!
//! ```text
//! t where the ray meets a plane:  (plane - origin) · inverse  =  plane · inverse - offset,     offset = origin · inverse
//! ```
//!
//! The second form is one operation where the processor fuses it. What the offset loses by rounding is small against the
//! origin, not against `t`; so the offset is padded by it, on the side that makes the box larger.

use crate::geometry::lanes::Lane;
use crate::geometry::{Aabb, Ray, Vec3};

use super::{CONE, RANGE, SlabRay};

/// The boxes of up to eight children: for each axis the least and the greatest coordinates, a lane a child.
pub(in super::super) type WideCorners = [[[f32; 8]; 2]; 3];

/// No boxes.
pub(in super::super) const NO_BOXES: WideCorners =
    [[[f32::INFINITY; 8], [f32::NEG_INFINITY; 8]]; 3];

/// Puts a box into a lane.
pub(in super::super) fn put_box(boxes: &mut WideCorners, lane: usize, bounds: &Aabb) {
    for (axis, [least, greatest]) in boxes.iter_mut().enumerate() {
        least[lane] = bounds.min[axis];
        greatest[lane] = bounds.max[axis];
    }
}

/// The box in a lane.
pub(in super::super) fn box_in(boxes: &WideCorners, lane: usize) -> Aabb {
    let corner = |side: usize| [0, 1, 2].map(|axis: usize| boxes[axis][side][lane]);
    Aabb {
        min: corner(0).into(),
        max: corner(1).into(),
    }
}

/// What clips eight boxes at once.
pub(in super::super) trait Clip<L> {
    /// The entry into and the exit from each box, within the interval that `limit` ends; a box is missed if the first is
    /// greater than the second.
    fn clip(&self, boxes: &WideCorners, limit: f32) -> (L, L);
}

impl<L, C: Clip<L>> Clip<L> for &C {
    #[inline(always)]
    fn clip(&self, boxes: &WideCorners, limit: f32) -> (L, L) {
        (*self).clip(boxes, limit)
    }
}

/// What holds all boxes that a ray will be tested against.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scene {
    /// Its box.
    pub bounds: Aabb,
    /// The largest absolute value of a coordinate.
    pub largest: f32,
}

/// A ray prepared for boxes within one scene, eight at a time: numbers, which are spread over lanes where they are used.
#[derive(Debug, Clone, Copy)]
pub struct WideSlabRay {
    /// For the near planes of x, y and z, and from [`FAR`] on for the far ones.
    pub(super) inverse: [f32; 8],
    pub(super) offset: [f32; 8],
    /// Which side the ray comes from: 1 where its direction is negative.
    pub(super) near: [usize; 3],
    pub(super) t_min: f32,
}

/// Where what belongs to far planes begins.
pub(super) const FAR: usize = 4;

/// For near planes and far ones: which way their inverses and offsets are moved.
const MOVE: [f32; 8] = [-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0];

/// For near planes and far ones: the square of the cone's width in units of the component counts twice, or not.
const SQUARE: [f32; 8] = [0.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 2.0];

/// Pad of an offset in units of itself: 4u. Its own rounding takes one, that of the pad another, and that of the product
/// with the plane, where it is not fused, a third and what of it concerns `t` is the cone's.
const OFFSET_PAD: f32 = 2.0 * f32::EPSILON;

/// An inverse, in units of that of the longest component, beyond every inverse of an axis whose component is not thin: a
/// plane is met outside the scene, by a wide margin, unless it lies within the pad of the origin.
const THIN: f32 = 1e12;

/// How much longer a coordinate may be than a component of the direction, so that no quotient overflows.
const LENGTHS: f32 = 1e24;

impl Scene {
    /// Whose box is `bounds`.
    pub fn new(bounds: Aabb) -> Self {
        Self {
            bounds,
            largest: bounds.min.abs().max(bounds.max.abs()).max_element(),
        }
    }
}

/// Whether the formulas below hold for rays whose directions have components of these sizes at least and at most, whose
/// origins are so far along an axis at most.
#[inline(always)]
pub(super) fn is_plain<L: Lane<1>>(
    [shortest, longest]: [L; 2],
    farthest: L,
    t_min: L,
    scene: &Scene,
) -> L::Mask {
    let width = longest * L::splat(CONE);
    let room = shortest * L::splat(LENGTHS);
    shortest.gt(width + width)
        & t_min.ge(L::splat(0.0))
        & longest.lt(L::splat(RANGE))
        & longest.gt(L::splat(1.0 / RANGE))
        & farthest.lt(L::splat(RANGE))
        & farthest.lt(room)
        & L::splat(scene.largest).lt(room)
}

/// The cone's width in units of the components with these inverses: at most 1/2.
#[inline(always)]
pub(super) fn share<const W: usize, L: Lane<W>>(inverse: L, width: L) -> L {
    inverse.abs() * width
}

/// Inverses of components whose cones have a `share` of them: for `bend` = -1 not more than 1 / (d + w), and for
/// 1 + 2 · share not less than 1 / (d - w).
#[inline(always)]
pub(super) fn moved<const W: usize, L: Lane<W>>(inverse: L, share: L, bend: L) -> L {
    inverse + inverse * (share * bend)
}

/// Offsets, less for far planes, so that they are met later, and more for near ones; whatever is rounded.
#[inline(always)]
pub(super) fn padded<const W: usize, L: Lane<W>>(offset: L, movement: L) -> L {
    let pad = offset.abs() * L::splat(OFFSET_PAD) + L::splat(f32::MIN_POSITIVE);
    offset - movement * pad
}

/// Four numbers, the last of which does not matter, twice.
#[inline(always)]
fn twice<L: Lane<8>>(v: Vec3, rest: f32) -> L {
    L::load(&[v.x, v.y, v.z, rest, v.x, v.y, v.z, rest])
}

/// All eight numbers.
#[inline(always)]
fn numbers<L: Lane<8>>(lanes: L) -> [f32; 8] {
    let mut all = [0.0; 8];
    lanes.write(&mut all);
    all
}

impl WideSlabRay {
    /// A ray of which nothing is known: for a walk that tests no box.
    pub const NONE: Self = Self {
        inverse: [0.0; 8],
        offset: [0.0; 8],
        near: [0; 3],
        t_min: 0.0,
    };

    /// Prepares a valid ray.
    #[inline(always)]
    pub fn new<L: Lane<8>>(ray: &Ray, scene: &Scene) -> Self {
        let size = ray.dir.abs();
        let (longest, shortest) = (size.max_element(), size.min_element());
        let farthest = ray.origin.abs().max_element();
        let (movement, square) = (L::load(&MOVE), L::load(&SQUARE));
        let (inverse, offset, t_min) = if is_plain([shortest, longest], farthest, ray.t_min, scene)
        {
            let inverse = L::splat(1.0) / twice(ray.dir, ray.t_max);
            let share = share(inverse, L::splat(CONE * longest));
            let inverse = moved(inverse, share, movement + square * share);
            let offset = twice::<L>(ray.origin, ray.t_min) * inverse;
            (inverse, offset, ray.t_min)
        } else {
            let rare = Self::rare(ray, scene);
            (L::load(&rare.inverse), L::load(&rare.offset), rare.t_min)
        };
        let side = |d: f32| (d.to_bits() >> 31) as usize;
        Self {
            inverse: numbers(inverse),
            offset: numbers(padded(offset, movement)),
            near: [side(ray.dir.x), side(ray.dir.y), side(ray.dir.z)],
            t_min,
        }
    }

    /// By way of the [`SlabRay`], before the offsets are padded.
    #[cold]
    #[inline(never)]
    fn rare(ray: &Ray, scene: &Scene) -> Self {
        let narrow = SlabRay::new(ray, &scene.bounds);
        let longest = ray.dir.abs().max_element();
        let farthest = ray.origin.abs().max_element().max(scene.largest);
        let most = THIN / longest;
        // NaN constrains nothing.
        let fits = longest * RANGE > farthest && farthest < RANGE && most < RANGE;
        let bounded = |x: f32| if fits { x.clamp(-most, most) } else { f32::NAN };
        let (mut inverse, mut offset) = ([0.0; 8], [0.0; 8]);
        for (axis, slab) in narrow.slabs.iter().enumerate() {
            inverse[axis] = bounded(slab.near_inverse);
            inverse[FAR + axis] = bounded(slab.far_inverse);
            offset[axis] = slab.near_origin * inverse[axis];
            offset[FAR + axis] = slab.far_origin * inverse[FAR + axis];
        }
        Self {
            inverse,
            offset,
            near: narrow.slabs.map(|slab| slab.near & 1),
            t_min: narrow.t_min,
        }
    }

    /// Where the planes on one side of an axis (0: near) are met.
    #[inline(always)]
    fn meet<L: Lane<8>>(&self, boxes: &WideCorners, axis: usize, side: usize) -> L {
        let planes = L::load(&boxes[axis][(self.near[axis] ^ side) & 1]);
        let (inverse, offset) = (
            self.inverse[side * FAR + axis],
            self.offset[side * FAR + axis],
        );
        planes.mul_sub_freely(L::splat(inverse), L::splat(offset))
    }
}

impl<L: Lane<8>> Clip<L> for WideSlabRay {
    #[inline(always)]
    fn clip(&self, boxes: &WideCorners, limit: f32) -> (L, L) {
        // Of two numbers the second is taken where one is NaN, so the known ends of the interval stand last.
        let (first, last) = (L::splat(self.t_min), L::splat(limit));
        let near: L = self.meet(boxes, 0, 0);
        let entry = self.meet::<L>(boxes, 1, 0).max(self.meet(boxes, 2, 0));
        let far: L = self.meet(boxes, 0, 1);
        let exit = self.meet::<L>(boxes, 1, 1).min(self.meet(boxes, 2, 1));
        (entry.max(near.max(first)), exit.min(far.min(last)))
    }
}
