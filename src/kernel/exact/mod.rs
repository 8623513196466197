//! The kernel that is never wrong: what it says is true of the given `f32` numbers, edges, ties and ends of the interval
//! included.
//!
//! ```text
//! f32 lanes   sheared edge functions, each against one bound on their errors      decides nearly all tests
//!    | cannot tell
//! f64         the same without a division, each edge function with its own bound  [sides]
//!    | cannot tell
//! integers    the sign itself                                                     [sides]
//! ```
//!
//! A hit's `t` is a quotient of two determinants in `f64`, or of two integers where `f64` does not suffice:
//! always one of the two `f32` next to the true one. Where two hits, or a hit and an end of the interval, are too near
//! for their `f32` to tell, the quotients are compared by cross-multiplication.
//!
//! **The bound of the filter.** With u = 2⁻²⁴, the sheared coordinates X, Y of the corners and their depths Z, as in
//! the kernel `woop`: the shear is at most 1, so each sheared coordinate is off by at most 2u·|X| + 4u·|Z| (a difference; a
//! difference, a quotient and a product; a difference), and an edge function, two products of these and a difference, by
//!
//! ```text
//! u·(3·T² + 8·Z·(T + d))     T = max|X| + max|Y|,  Z = max|Z|,  d = 4u·Z
//! ```
//!
//! All corners are within `reach` of corner 0, so T and Z are taken from it alone: T + d <= S = |x0| + |y0| + reach +
//! 16u·|z0| and Z <= |z0| + S/2, and the bound is 8u·S·(S + |z0|), widened by a thousandth for its own rounding and by
//! 2⁻¹⁰⁰ for all that can underflow. Numbers that could overflow make it infinite or NaN, and then nothing is decided.
//!
//! **Source:** the shear and edge functions are those of S. Woop, C. Benthin and I. Wald, "Watertight Ray/Triangle
//! Intersection", 2013; filters before exact arithmetic: J. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and
//! Fast Robust Geometric Predicates", 1997. **Differs:** one bound for all three edge functions of a triangle, from numbers
//! that are there anyway, so that the filter costs no more than the test it guards.

use crate::geometry::lanes::{Lane, LaneMask, LaneRay, LaneVec3, Ones};
use crate::geometry::{Hit, Ray, Vec3};
use crate::registry::Params;
use crate::scene::Mesh;

use super::prepared::PreparedRay;
use super::shear::{self, Edge};
use super::woop::Woop;
use super::{Corners, Kernel, KernelEntry, LaneHit};

mod crossing;
mod sides;

use crossing::Crossing;

/// The kernel `exact`.
#[derive(Debug, Clone, Copy)]
pub struct Exact;

/// Its name.
pub const NAME: &str = "exact";

impl Exact {
    pub(super) const ENTRY: KernelEntry = KernelEntry {
        name: NAME,
        about: "Never wrong: filters in f32 and f64 with proven bounds decide nearly every test, integers the rest.",
        paper: "Shewchuk 1997, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates",
        watertight: true,
        control: false,
        bytes_per_triangle: 40,
        operations: "15 multiplications, 22 additions, 7 comparisons; for hits 19 multiplications, 15 additions, 2 divisions more, nearly all in f64",
        known_failures: "none: hits, ties and the ends of the interval are decided exactly; t is rounded to one of the two f32 beside the true one",
        params: &[],
    };

    pub(super) fn from_params(_: &Params) -> Self {
        Self
    }
}

/// What decides a test of a ray's line against a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// The filter in `f32`.
    F32,
    /// The filter in `f64`.
    F64,
    /// Integers.
    Integers,
}

/// What [`Exact`] needs to decide on a valid ray and a triangle: for rates, counted apart from the tests themselves.
#[must_use]
pub fn stage(ray: &Ray, corners: &[Vec3; 3]) -> Stage {
    let prepared: Prepared<f32, bool> = Exact.prepare(ray, &LaneRay::splat(ray));
    let filtered = filter(&prepared, &Exact.pack::<1>(|_| *corners));
    if filtered.miss | filtered.hit {
        Stage::F32
    } else if sides::Sides::new(ray.origin, ray.dir, corners).are_known() {
        Stage::F64
    } else {
        Stage::Integers
    }
}

/// Corners, and how far the others lie from corner 0.
#[derive(Debug, Clone, Copy)]
pub struct Packed<const W: usize> {
    corners: Corners<W>,
    /// At least |e|₁ + |e|∞ of both edges at corner 0; infinite beyond [`RANGE`], where the filter must not decide;
    /// negative infinity without area, where it decides on a miss.
    reach: [f32; W],
}

/// The frame of the filter, and the rays themselves.
#[derive(Debug, Clone, Copy)]
pub struct Prepared<L, M> {
    /// Its origin's z is NaN beyond [`RANGE`].
    frame: shear::Prepared<L, M>,
    rays: LaneRay<L>,
}

impl<const W: usize, L: Lane<W>> PreparedRay<W, L, Prepared<f32, bool>> for Prepared<L, L::Mask> {
    #[inline(always)]
    fn spread(one: &Prepared<f32, bool>) -> Self {
        Self {
            frame: shear::Prepared::spread(&one.frame),
            rays: LaneRay::spread(&one.rays),
        }
    }
}

/// Coordinates up to this cannot overflow in the filter.
const RANGE: f32 = 1e18;

/// 16u.
const DEPTH: f32 = 1.0 / 1_048_576.0;
/// 8u, and a thousandth of it.
const RELATIVE: f32 = (1.0 + 1.0 / 1024.0) / 2_097_152.0;
/// 2⁻¹⁰⁰.
const LEAST: f32 = 7.888_609e-31;

/// The most lanes: the rays of a packet.
const MOST_LANES: usize = 16;

/// See [`Packed::reach`].
fn reach(corners: &[Vec3; 3]) -> f32 {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let (e1, e2) = (b - a, c - a);
    if corners.iter().any(|v| v.abs().max_element() > RANGE) {
        return f32::INFINITY;
    }
    if e1.cross(e2) == crate::geometry::DVec3::ZERO && crossing::without_area(corners) {
        return f32::NEG_INFINITY;
    }
    let [l1, l2] = [e1, e2].map(|e| e.abs().element_sum() + e.abs().max_element());
    // Far more than the roundings of f64, and up to the next f32.
    ((l1.max(l2) * (1.0 + 1e-12)) as f32).next_up()
}

/// What the filter says.
struct Filtered<L, M> {
    /// Surely missed.
    miss: M,
    /// Surely hit, unless missed.
    hit: M,
    /// The edge functions U, V and W.
    edges: [L; 3],
}

/// Decides what can be decided in `f32`.
#[inline(always)]
fn filter<const W: usize, L: Lane<W>>(
    ray: &Prepared<L, L::Mask>,
    tri: &Packed<W>,
) -> Filtered<L, L::Mask> {
    let [a, b, c] = shear::sheared(&ray.frame, &tri.corners);
    let u = Woop::<false>::edge(c.x, b.y, c.y, b.x);
    let v = Woop::<false>::edge(a.x, c.y, a.y, c.x);
    let w = Woop::<false>::edge(b.x, a.y, b.y, a.x);
    let depth = a.z.abs();
    let size = a.x.abs() + a.y.abs() + L::load(&tri.reach) + depth * L::splat(DEPTH);
    let bound = size * (size.abs() + depth) * L::splat(RELATIVE) + L::splat(LEAST);
    // NaN in one edge function alone comes of an overflow, which makes the bound infinite: then no comparison holds.
    let (most, least) = (u.max(v).max(w), u.min(v).min(w));
    Filtered {
        miss: most.gt(bound) & least.lt(-bound),
        hit: least.gt(bound) | most.lt(-bound),
        edges: [u, v, w],
    }
}

/// The line of the ray in `lane`.
#[inline(always)]
fn line<const W: usize, L: Lane<W>>(rays: &LaneRay<L>, lane: usize) -> (Vec3, Vec3) {
    // Lanes of triangles all have the same ray.
    let lane = if L::N == W { 0 } else { lane };
    let (o, d) = (rays.origin, rays.dir);
    (
        Vec3::new(o.x.get(lane), o.y.get(lane), o.z.get(lane)),
        Vec3::new(d.x.get(lane), d.y.get(lane), d.z.get(lane)),
    )
}

impl<const W: usize> Packed<W> {
    /// The triangle that is tested in `lane`.
    #[inline(always)]
    fn triangle(&self, lane: usize) -> [Vec3; 3] {
        // The rays of a packet all have the same triangle.
        self.corners.triangle(lane.min(W - 1))
    }
}

/// The answer where the filter could not tell the lanes of `unsure`.
#[cold]
#[inline(never)]
fn settled<const W: usize, L: Lane<W>>(
    ray: &Prepared<L, L::Mask>,
    tri: &Packed<W>,
    filtered: &Filtered<L, L::Mask>,
    sure: u32,
    unsure: u32,
) -> Option<LaneHit<W, L>> {
    let [u, v, w] = filtered.edges;
    // Hit or not, t, u and v.
    let mut answers = [[0.0_f32; MOST_LANES]; 4];
    let mut any = false;
    for lane in 0..L::N {
        let weights = if sure >> lane & 1 == 1 {
            let inverse = 1.0 / (u.get(lane) + v.get(lane) + w.get(lane));
            Some([v.get(lane) * inverse, w.get(lane) * inverse])
        } else if unsure >> lane & 1 == 1 {
            let (origin, dir) = line::<W, L>(&ray.rays, lane);
            sides::weights(origin, dir, &tri.triangle(lane))
        } else {
            None
        };
        if let Some([weight_1, weight_2]) = weights {
            let (origin, dir) = line::<W, L>(&ray.rays, lane);
            let t = crossing::time(origin, dir, &tri.triangle(lane));
            for (row, x) in answers.iter_mut().zip([1.0, t, weight_1, weight_2]) {
                row[lane] = x;
            }
            any = true;
        }
    }
    let [hit, t, u, v] = answers.map(|row| L::from_fn(|lane| row[lane & (MOST_LANES - 1)]));
    any.then(|| LaneHit::new(hit.gt(L::splat(0.0)), t, u, v))
}

impl Kernel for Exact {
    type Packed<const W: usize> = Packed<W>;
    type Prepared<const W: usize, L: Lane<W>> = Prepared<L, L::Mask>;
    type Rest<const W: usize, L: Lane<W>> = ();

    const EXACT_T: bool = true;

    fn pack<const W: usize>(&self, corners: impl Fn(usize) -> [Vec3; 3]) -> Packed<W> {
        Packed {
            reach: std::array::from_fn(|lane| reach(&corners(lane))),
            corners: Corners::of(corners),
        }
    }

    #[inline(always)]
    fn lane(block: &Packed<8>, lane: usize) -> Packed<1> {
        Packed {
            corners: block.corners.lane(lane),
            reach: [block.reach[lane & 7]],
        }
    }

    const PACKETS: bool = true;

    #[inline(always)]
    fn corners<L: Lane<8>>(block: &Packed<8>) -> [LaneVec3<L>; 3] {
        block.corners.load()
    }

    #[inline(always)]
    fn prepare<const W: usize, L: Lane<W>>(
        &self,
        lead: &Ray,
        rays: &LaneRay<L>,
    ) -> Prepared<L, L::Mask> {
        let mut frame = shear::prepare(lead, rays);
        let origin = rays.origin;
        let far = origin.x.abs().max(origin.y.abs()).max(origin.z.abs());
        frame.origin.z = L::select(far.gt(L::splat(RANGE)), L::splat(f32::NAN), frame.origin.z);
        Prepared { frame, rays: *rays }
    }

    #[inline(always)]
    fn intersect<const W: usize, L: Lane<W>>(
        &self,
        ray: &Prepared<L, L::Mask>,
        tri: &Packed<W>,
    ) -> Option<LaneHit<W, L>> {
        let filtered = filter(ray, tri);
        let all = (1_u32 << L::N) - 1;
        let left = !filtered.miss.bits() & all;
        if left == 0 {
            return None;
        }
        let sure = filtered.hit.bits() & left;
        if sure != left {
            return settled(ray, tri, &filtered, sure, left & !sure);
        }
        let [u, v, w] = filtered.edges;
        let inverse = L::splat(1.0) / (u + v + w);
        let mut t = [f32::NAN; MOST_LANES];
        for lane in Ones(sure) {
            let (origin, dir) = line::<W, L>(&ray.rays, lane);
            t[lane & (MOST_LANES - 1)] = crossing::time(origin, dir, &tri.triangle(lane));
        }
        Some(LaneHit::new(
            filtered.hit & !filtered.miss,
            L::from_fn(|lane| t[lane & (MOST_LANES - 1)]),
            v * inverse,
            w * inverse,
        ))
    }

    #[inline(always)]
    fn t_error_bound<const W: usize, L: Lane<W>>(
        _: &Prepared<L, L::Mask>,
        _: &Packed<W>,
        hit: &LaneHit<W, L>,
    ) -> L {
        hit.t.abs() * L::splat(3.0 * f32::EPSILON) + L::splat(8.0 * f32::from_bits(1))
    }

    fn t_error(&self, _: &Ray, _: &[Vec3; 3], t: f32) -> f32 {
        // Two ulps: the true t is less than one away, and the sum is rounded.
        t.abs() * (2.0 * f32::EPSILON) + 4.0 * f32::from_bits(1)
    }

    #[inline(always)]
    fn within(&self, mesh: &Mesh, ray: &Ray, hit: &Hit) -> bool {
        // The true t lies between the f32 below and the one above.
        if hit.t.next_down() > ray.t_min && hit.t.next_up() < ray.t_max {
            return true;
        }
        Crossing::new(mesh, ray, hit).is_within(ray)
    }

    #[inline(always)]
    fn nearer(&self, mesh: &Mesh, ray: &Ray, new: &Hit, best: &Hit) -> bool {
        if !best.is_hit() || new.t.next_up() < best.t.next_down() {
            return true;
        }
        if new.t.next_down() > best.t.next_up() {
            return false;
        }
        let order = Crossing::new(mesh, ray, new).compare(&Crossing::new(mesh, ray, best));
        order.is_lt() || (order.is_eq() && new.prim < best.prim)
    }
}
