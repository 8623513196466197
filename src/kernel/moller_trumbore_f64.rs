//! Möller and Trumbore's test in `f64`: every lane is widened, the answer is narrowed.
//!
//! Products of three differences of `f32` neither overflow nor underflow in `f64`, so nothing vanishes at any scale.
//!
//! **Source:** T. Möller and B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", JGT 2(1), 1997.
//! **Differs:** no epsilon on the determinant; corners are stored in `f32`, as they come, and widened at each test.

use crate::geometry::lanes::{Lane, LaneMask, LaneRay, LaneVec3};
use crate::geometry::{DVec3, Ray, Vec3};
use crate::registry::Params;

use super::known::{self, cross, dot, minus};
use super::{Corners, Kernel, KernelEntry, LaneHit};

/// The kernel `moller-trumbore-f64`.
#[derive(Debug, Clone, Copy)]
pub struct MollerTrumboreF64;

impl MollerTrumboreF64 {
    pub(super) const ENTRY: KernelEntry = KernelEntry {
        name: "moller-trumbore-f64",
        about: "Cramer's rule in f64: what more bits cure, and what they do not.",
        paper: "Möller and Trumbore 1997, Fast, Minimum Storage Ray/Triangle Intersection",
        watertight: false,
        control: false,
        bytes_per_triangle: 36,
        operations: "27 multiplications, 24 additions, 1 division, all in f64",
        known_failures: "leaks through shared vertices, and rarely edges, where even f64 rounds; `raylab accuracy` measures how often",
        params: &[],
    };

    pub(super) fn from_params(_: &Params) -> Self {
        Self
    }
}

/// The rays of a packet; a power of two.
const MOST_LANES: usize = 16;

/// Whether the ray hits, and t, u and v.
#[inline(always)]
fn test(origin: DVec3, dir: DVec3, [a, b, c]: [DVec3; 3]) -> (bool, [f64; 3]) {
    let (e1, e2) = (b - a, c - a);
    let p = dir.cross(e2);
    let det = e1.dot(p);
    let inv_det = 1.0 / det;
    let s = origin - a;
    let u = s.dot(p) * inv_det;
    let q = s.cross(e1);
    let v = dir.dot(q) * inv_det;
    // One branch at the end, so that lanes can run side by side. A zero determinant makes u and v infinite or NaN.
    let hit = (det != 0.0) & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0);
    (hit, [e2.dot(q) * inv_det, u, v])
}

/// The vector in a lane.
#[inline(always)]
fn widened<const W: usize, L: Lane<W>>(v: LaneVec3<L>, lane: usize) -> DVec3 {
    let [x, y, z] = [v.x, v.y, v.z].map(|x| f64::from(x.get(lane)));
    DVec3 { x, y, z }
}

impl Kernel for MollerTrumboreF64 {
    type Packed<const W: usize> = Corners<W>;
    type Prepared<const W: usize, L: Lane<W>> = LaneRay<L>;

    fn pack<const W: usize>(&self, corners: impl Fn(usize) -> [Vec3; 3]) -> Corners<W> {
        Corners::with_area(corners)
    }

    #[inline(always)]
    fn lane(block: &Corners<8>, lane: usize) -> Corners<1> {
        block.lane(lane)
    }

    const PACKETS: bool = true;

    #[inline(always)]
    fn corners<L: Lane<8>>(block: &Corners<8>) -> [LaneVec3<L>; 3] {
        block.load()
    }

    #[inline(always)]
    fn prepare<const W: usize, L: Lane<W>>(&self, _: &Ray, rays: &LaneRay<L>) -> LaneRay<L> {
        *rays
    }

    #[inline(always)]
    fn intersect<const W: usize, L: Lane<W>>(
        &self,
        ray: &LaneRay<L>,
        tri: &Corners<W>,
    ) -> Option<LaneHit<W, L>> {
        let corners: [LaneVec3<L>; 3] = tri.load();
        // Hit or not, t, u and v: a number a lane of a block or packet.
        let mut answers = [[0.0_f32; MOST_LANES]; 4];
        for lane in 0..L::N {
            let corners = corners.map(|v| widened::<W, L>(v, lane));
            let (hit, [t, u, v]) = test(
                widened::<W, L>(ray.origin, lane),
                widened::<W, L>(ray.dir, lane),
                corners,
            );
            let answer = [f64::from(u8::from(hit)), t, u, v];
            for (row, x) in answers.iter_mut().zip(answer) {
                row[lane] = x as f32;
            }
        }
        let [hit, t, u, v] = answers.map(|row| L::from_fn(|lane| row[lane & (MOST_LANES - 1)]));
        let mask = hit.gt(L::splat(0.0));
        mask.any().then_some(LaneHit { mask, t, u, v })
    }

    fn t_error(&self, ray: &Ray, corners: &[Vec3; 3], _: f32) -> f32 {
        let [a, b, c] = corners.map(known::vector::<53>);
        let (e1, e2) = (minus(b, a), minus(c, a));
        let (origin, dir) = (known::vector(ray.origin), known::vector(ray.dir));
        let inv_det = known::Known::of(1.0) / dot(e1, cross(dir, e2));
        let numerator = dot(e2, cross(minus(origin, a), e1));
        (numerator * inv_det).stored().bound()
    }
}
