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
//! All of it is decided once a ray; a box costs six subtractions, six multiplications and six comparisons.
//!
//! **Source:** T. Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013.
//! **Differs:** the pad lies in the reciprocals and thus also on the near side and across the ray, not only on the exit.

use crate::geometry::lanes::Lane;
use crate::geometry::{Aabb, Ray, Vec3};

use super::packet::Bundle;

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

/// The boxes of up to eight children: for each axis the least and the greatest coordinates, a lane a child.
pub(super) type WideCorners = [[[f32; 8]; 2]; 3];

/// A [`SlabRay`] in the lanes that test eight boxes at once.
#[derive(Debug, Clone, Copy)]
pub(super) struct WideSlabRay<L> {
    near_origin: [L; 3],
    far_origin: [L; 3],
    near_inverse: [L; 3],
    far_inverse: [L; 3],
    near: [usize; 3],
    t_min: L,
}

impl SlabRay {
    /// The ray in every lane.
    #[inline(always)]
    fn wide<L: Lane<8>>(&self) -> WideSlabRay<L> {
        let [x, y, z] = &self.slabs;
        WideSlabRay {
            near_origin: [x.near_origin, y.near_origin, z.near_origin].map(L::splat),
            far_origin: [x.far_origin, y.far_origin, z.far_origin].map(L::splat),
            near_inverse: [x.near_inverse, y.near_inverse, z.near_inverse].map(L::splat),
            far_inverse: [x.far_inverse, y.far_inverse, z.far_inverse].map(L::splat),
            near: [x.near & 1, y.near & 1, z.near & 1],
            t_min: L::splat(self.t_min),
        }
    }

    /// As [`SlabRay::new`], for rays that are rare.
    #[cold]
    #[inline(never)]
    fn of_rare(ray: &Ray, scene: &Aabb) -> Self {
        Self::new(ray, scene)
    }
}

impl<L: Lane<8>> WideSlabRay<L> {
    /// As [`SlabRay::new`], in lanes; the six reciprocals of a ray without thin components are one division.
    #[inline(always)]
    pub fn new(ray: &Ray, scene: &Aabb) -> Self {
        let longest = ray.dir.abs().max_element();
        let width = CONE * longest;
        let is_plain = ray.dir.abs().min_element() > 2.0 * width
            && ray.t_min >= 0.0
            && is_trusted(ray, longest, reach(ray, scene));
        if !is_plain {
            return SlabRay::of_rare(ray, scene).wide();
        }
        let sign = Vec3::ONE.copysign(ray.dir);
        let (near, far) = (ray.dir + sign * width, ray.dir - sign * width);
        let inverse =
            L::splat(1.0) / L::load(&[near.x, near.y, near.z, 1.0, far.x, far.y, far.z, 1.0]);
        let origin = [
            L::splat(ray.origin.x),
            L::splat(ray.origin.y),
            L::splat(ray.origin.z),
        ];
        Self {
            near_origin: origin,
            far_origin: origin,
            near_inverse: [
                L::splat(inverse.get(0)),
                L::splat(inverse.get(1)),
                L::splat(inverse.get(2)),
            ],
            far_inverse: [
                L::splat(inverse.get(4)),
                L::splat(inverse.get(5)),
                L::splat(inverse.get(6)),
            ],
            near: [
                usize::from(ray.dir.x < 0.0),
                usize::from(ray.dir.y < 0.0),
                usize::from(ray.dir.z < 0.0),
            ],
            t_min: L::splat(ray.t_min),
        }
    }
}

impl<L: Lane<8>> Clip<L> for WideSlabRay<L> {
    #[inline(always)]
    fn clip(&self, boxes: &WideCorners, limit: f32) -> (L, L) {
        let enter = |axis: usize| {
            let plane = L::load(&boxes[axis][self.near[axis]]);
            (plane - self.near_origin[axis]) * self.near_inverse[axis]
        };
        let leave = |axis: usize| {
            let plane = L::load(&boxes[axis][self.near[axis] ^ 1]);
            (plane - self.far_origin[axis]) * self.far_inverse[axis]
        };
        // Of two numbers the second is taken where one is NaN, so the known ends of the interval stand last.
        let entry = enter(1).max(enter(2)).max(enter(0).max(self.t_min));
        let last = L::splat(limit.min(f32::MAX));
        let exit = leave(1).min(leave(2)).min(leave(0).min(last));
        (entry, exit)
    }
}

/// The slabs of rays with a common origin: an interval that encloses what [`WideSlabRay`] computes for each of them.
///
/// Rounding is monotone, so a box that one of the rays meets by its own test is met by this one.
#[derive(Debug, Clone, Copy)]
pub(super) struct PacketSlabs<L> {
    origin: [L; 3],
    /// Least and greatest reciprocals.
    near_inverse: [[L; 2]; 3],
    far_inverse: [[L; 2]; 3],
    near: [usize; 3],
    t_min: L,
}

/// What the slabs of rays with a common origin have in common: bounds on the reciprocals of their directions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pencil {
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

/// What clips eight boxes at once.
pub(super) trait Clip<L> {
    /// The entry into and the exit from each box, within the interval that `limit` ends; a box is missed if the first is
    /// greater than the second.
    fn clip(&self, boxes: &WideCorners, limit: f32) -> (L, L);
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

#[cfg(test)]
mod tests {
    use super::super::testbed::Dice;
    use super::*;

    /// A ray and a box of whole numbers, so that all of it can be judged exactly.
    #[derive(Debug)]
    struct Case {
        origin: [i64; 3],
        dir: [i64; 3],
        least: [i64; 3],
        greatest: [i64; 3],
    }

    impl Case {
        /// Whether the ray touches the closed box grown by `grown`, by exact fractions.
        fn touches(&self, grown: i64) -> bool {
            // t in [entry, exit], each a fraction with a positive denominator.
            let mut entry = (0_i128, 1_i128);
            let mut exit: Option<(i128, i128)> = None;
            for a in 0..3 {
                let lo = i128::from(self.least[a] - grown - self.origin[a]);
                let hi = i128::from(self.greatest[a] + grown - self.origin[a]);
                let d = i128::from(self.dir[a]);
                if d == 0 {
                    if lo > 0 || hi < 0 {
                        return false;
                    }
                    continue;
                }
                let (near, far) = if d > 0 { (lo, hi) } else { (-hi, -lo) };
                let d = d.abs();
                if near * entry.1 > entry.0 * d {
                    entry = (near, d);
                }
                if exit.is_none_or(|e| far * e.1 < e.0 * d) {
                    exit = Some((far, d));
                }
            }
            exit.is_none_or(|exit| entry.0 * exit.1 <= exit.0 * entry.1)
        }

        /// What the slab test says, with everything scaled by powers of two and zeros of one sign.
        fn slab(&self, scale: f32, dir_scale: f32, zero: f32) -> bool {
            let float = |v: [i64; 3], s: f32| Vec3::from(v.map(|x| x as f32 * s));
            let signed = |x: f32| if x == 0.0 { zero } else { x };
            let dir = float(self.dir, dir_scale).to_array().map(signed);
            let ray = Ray::new(float(self.origin, scale), dir.into());
            let aabb = Aabb {
                min: float(self.least, scale),
                max: float(self.greatest, scale),
            };
            SlabRay::new(&ray, &aabb)
                .interval(&corners(aabb), f32::INFINITY)
                .is_some()
        }

        fn corner(&self, dice: &mut Dice, a: usize) -> i64 {
            [self.least[a], self.greatest[a]][dice.below(2) as usize]
        }
    }

    fn number(dice: &mut Dice, reach: u32) -> i64 {
        i64::from(dice.below(2 * reach + 1)) - i64::from(reach)
    }

    fn numbers(dice: &mut Dice, reach: u32) -> [i64; 3] {
        [0; 3].map(|_| number(dice, reach))
    }

    /// 200,000 boxes, some of them flat, each with a ray that `aim` has made from it.
    fn never_missed(seed: u64, aim: impl Fn(&mut Dice, &mut Case)) {
        let mut dice = Dice::new(seed);
        let mut touched = 0;
        for _ in 0..200_000 {
            let (a, b) = (numbers(&mut dice, 1 << 20), numbers(&mut dice, 1 << 20));
            let flat = dice.below(16);
            let mut case = Case {
                origin: numbers(&mut dice, 1 << 21),
                dir: numbers(&mut dice, 1 << 10),
                least: [0, 1, 2].map(|i: usize| a[i].min(b[i])),
                greatest: [0, 1, 2].map(|i: usize| {
                    if flat >> i & 1 == 1 {
                        a[i].min(b[i])
                    } else {
                        a[i].max(b[i])
                    }
                }),
            };
            aim(&mut dice, &mut case);
            if case.dir == [0; 3] {
                continue;
            }
            let scale = [1.0, 0.001_953_125, 65_536.0][dice.below(3) as usize];
            let dir_scale = [1.0, 0.001_953_125, 1024.0][dice.below(3) as usize];
            let zero = [0.0, -0.0][dice.below(2) as usize];
            let slab = case.slab(scale, dir_scale, zero);
            if case.touches(0) {
                touched += 1;
                assert!(slab, "missed {case:?}");
            } else if !case.touches(1 << 8) {
                // The pad is a few millionths of the way: a box that is missed by more is missed here too.
                assert!(!slab, "phantom {case:?}");
            }
        }
        assert!(touched > 1000, "only {touched} boxes were touched");
    }

    #[test]
    fn a_ray_in_a_face_plane_touches_the_box() {
        never_missed(1, |dice, case| {
            let a = dice.below(3) as usize;
            case.dir[a] = 0;
            case.origin[a] = case.corner(dice, a);
        });
    }

    #[test]
    fn a_ray_through_a_corner_touches_the_box() {
        never_missed(2, |dice, case| {
            let steps = i64::from(dice.below(1024));
            for a in 0..3 {
                case.origin[a] = case.corner(dice, a) - steps * case.dir[a];
            }
        });
    }

    #[test]
    fn axis_parallel_rays_are_judged_right() {
        never_missed(3, |dice, case| {
            let a = dice.below(3) as usize;
            case.dir = [0; 3];
            case.dir[a] = number(dice, 1 << 10);
            case.origin = [0, 1, 2].map(|i| match dice.below(3) {
                0 => case.corner(dice, i),
                1 => number(dice, 1 << 21),
                _ => i64::midpoint(case.least[i], case.greatest[i]),
            });
        });
    }

    #[test]
    fn a_nearly_axis_parallel_ray_touches_what_it_grazes() {
        never_missed(4, |dice, case| {
            let a = dice.below(3) as usize;
            case.dir = numbers(dice, 3);
            case.dir[a] = number(dice, 1 << 20);
            for i in 0..3 {
                case.origin[i] = case.corner(dice, i) - case.dir[i];
            }
        });
    }

    #[test]
    fn any_ray_is_judged_right() {
        never_missed(5, |_, _| {});
    }

    #[test]
    fn the_entry_is_never_late_and_hardly_early() {
        let mut dice = Dice::new(6);
        let aabb = Aabb {
            min: Vec3::splat(-1.5),
            max: Vec3::splat(1.5),
        };
        for _ in 0..10_000 {
            let from = Vec3::new(-2.5, dice.signed(), dice.signed());
            let ray = Ray::new(from, Vec3::new(1.0, 0.1 * dice.signed(), 0.0));
            let (entry, _) = SlabRay::new(&ray, &aabb)
                .interval(&corners(aabb), f32::INFINITY)
                .expect("aimed at it");
            assert!(entry <= 1.0 && entry > 0.999_99, "{entry}");
        }
    }

    #[test]
    fn a_negative_t_min_reaches_what_lies_behind_the_origin() {
        let aabb = Aabb {
            min: Vec3::splat(-1.0),
            max: Vec3::ONE,
        };
        let met = |ray: &Ray| {
            SlabRay::new(ray, &aabb)
                .interval(&corners(aabb), ray.t_max)
                .is_some()
        };
        for dir in [
            Vec3::X,
            Vec3::new(1.0, 1e-9, 0.3),
            Vec3::new(1.0, -0.3, -0.0),
        ] {
            let mut ray = Ray::new(Vec3::X * 3.0, dir);
            assert!(!met(&ray));
            ray.t_min = f32::NEG_INFINITY;
            assert!(met(&ray));
            ray.t_min = -2.0;
            assert!(met(&ray), "the face at t = -2 is inside the interval");
            ray.t_min = -1.9;
            assert!(!met(&ray));
        }
    }

    #[test]
    fn numbers_at_the_ends_of_the_range_miss_nothing() {
        for scale in [1e-42, 1e-38, 1e-30, 1e-20, 1e20, 1e30, 1e38] {
            for dir_scale in [1e-42, 1e-30, 1.0, 1e30, 1e38] {
                let aabb = Aabb {
                    min: Vec3::splat(-scale),
                    max: Vec3::splat(scale),
                };
                let dir = Vec3::new(0.1, -0.1, -1.0) * dir_scale;
                let ray = Ray::new(Vec3::new(0.0, 0.0, 3.0 * scale), dir);
                let met = SlabRay::new(&ray, &aabb).interval(&corners(aabb), f32::INFINITY);
                assert!(met.is_some(), "scene {scale}, direction {dir_scale}");
            }
        }
    }
}
