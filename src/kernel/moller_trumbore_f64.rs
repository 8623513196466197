//! Möller and Trumbore's test in `f64`: every lane is widened, the answer is narrowed.
//!
//! Products of three differences of `f32` neither overflow nor underflow in `f64`, so nothing vanishes at any scale.
//!
//! Eight lanes at a time are plain arrays of `f64`, without branches, so that the compiler can make vectors of them.
//!
//! **Source:** T. Möller and B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", JGT 2(1), 1997.
//! **Differs:** no epsilon on the determinant; corners are stored in `f32`, as they come, and widened at each test.

use std::ops::{Add, Mul, Sub};

use crate::geometry::lanes::{Lane, LaneMask, LaneRay, LaneVec3};
use crate::geometry::{Ray, Vec3};
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

/// `N` numbers in plain Rust, which the compiler turns into vector instructions where the target has them.
#[derive(Clone, Copy)]
struct Wide<const N: usize>([f64; N]);

macro_rules! operators {
    ($($trait:ident $method:ident),*) => {$(
        impl<const N: usize> $trait for Wide<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for (x, y) in self.0.iter_mut().zip(other.0) {
                    *x = (*x).$method(y);
                }
                self
            }
        }
    )*};
}

operators!(Add add, Sub sub, Mul mul);

/// A vector a lane.
#[derive(Clone, Copy)]
struct WideVec3<const N: usize>([Wide<N>; 3]);

impl<const N: usize> WideVec3<N> {
    /// Rows of numbers, widened.
    #[inline(always)]
    fn of(rows: &[[f32; N]; 3]) -> Self {
        let mut wide = [Wide([0.0; N]); 3];
        for (wide, row) in wide.iter_mut().zip(rows) {
            for (x, y) in wide.0.iter_mut().zip(row) {
                *x = f64::from(*y);
            }
        }
        Self(wide)
    }

    #[inline(always)]
    fn minus(self, o: Self) -> Self {
        let ([ax, ay, az], [bx, by, bz]) = (self.0, o.0);
        Self([ax - bx, ay - by, az - bz])
    }

    #[inline(always)]
    fn cross(self, o: Self) -> Self {
        let ([ax, ay, az], [bx, by, bz]) = (self.0, o.0);
        Self([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
    }

    #[inline(always)]
    fn dot(self, o: Self) -> Wide<N> {
        let ([ax, ay, az], [bx, by, bz]) = (self.0, o.0);
        ax * bx + ay * by + az * bz
    }
}

/// Rows of 1 for a hit and 0 for a miss, t, u and v.
#[inline(always)]
fn test<const N: usize>(
    origin: &[[f32; N]; 3],
    dir: &[[f32; N]; 3],
    corners: [&[[f32; N]; 3]; 3],
) -> [[f32; N]; 4] {
    let [corner_a, corner_b, corner_c] = corners;
    let (a, dir) = (WideVec3::of(corner_a), WideVec3::of(dir));
    let e1 = WideVec3::of(corner_b).minus(a);
    let e2 = WideVec3::of(corner_c).minus(a);
    let p = dir.cross(e2);
    let det = e1.dot(p);
    let s = WideVec3::of(origin).minus(a);
    let q = s.cross(e1);
    let (t, u, v) = (e2.dot(q), s.dot(p), dir.dot(q));
    let [mut hits, mut ts, mut us, mut vs] = [[0.0; N]; 4];
    for lane in 0..N {
        let inv_det = 1.0 / det.0[lane];
        let (u, v) = (u.0[lane] * inv_det, v.0[lane] * inv_det);
        // A zero determinant makes u and v infinite or NaN. No branches: the lanes run side by side.
        let not_parallel = u32::from(det.0[lane] != 0.0);
        let inside = u32::from(u >= 0.0) & u32::from(v >= 0.0) & u32::from(u + v <= 1.0);
        let hit = not_parallel & inside == 1;
        hits[lane] = if hit { 1.0 } else { 0.0 };
        ts[lane] = (t.0[lane] * inv_det) as f32;
        us[lane] = u as f32;
        vs[lane] = v as f32;
    }
    [hits, ts, us, vs]
}

/// The rows of vectors in lanes from `first` on; those after the last lane repeat it.
#[inline(always)]
fn rows_of<const W: usize, const N: usize, L: Lane<W>>(
    v: LaneVec3<L>,
    first: usize,
) -> [[f32; N]; 3] {
    let [mut xs, mut ys, mut zs] = [[0.0; N]; 3];
    for lane in 0..N {
        let from = (first + lane).min(L::N - 1);
        xs[lane] = v.x.get(from);
        ys[lane] = v.y.get(from);
        zs[lane] = v.z.get(from);
    }
    [xs, ys, zs]
}

/// Tests `N` lanes from `first` on and writes their answers.
#[inline(always)]
fn test_from<const W: usize, const N: usize, L: Lane<W>>(
    ray: &LaneRay<L>,
    tri: &Corners<W>,
    first: usize,
    answers: &mut [[f32; MOST_LANES]; 4],
) {
    let origin = rows_of::<W, N, L>(ray.origin, first);
    let dir = rows_of::<W, N, L>(ray.dir, first);
    let [a, b, c]: [LaneVec3<L>; 3] = tri.load();
    let (a, b, c) = (
        rows_of::<W, N, L>(a, first),
        rows_of::<W, N, L>(b, first),
        rows_of::<W, N, L>(c, first),
    );
    let answer = test(&origin, &dir, [&a, &b, &c]);
    for (all, some) in answers.iter_mut().zip(&answer) {
        all[first..first + N].copy_from_slice(some);
    }
}

/// The rays of a packet; a power of two.
const MOST_LANES: usize = 16;

impl Kernel for MollerTrumboreF64 {
    type Packed<const W: usize> = Corners<W>;
    type Prepared<const W: usize, L: Lane<W>> = LaneRay<L>;
    type Rest<const W: usize, L: Lane<W>> = ();

    fn pack<const W: usize>(&self, corners: impl Fn(usize) -> [Vec3; 3]) -> Corners<W> {
        Corners::with_area(corners)
    }

    #[inline(always)]
    fn lane(block: &Corners<8>, lane: usize) -> Corners<1> {
        block.lane(lane)
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
        let mut answers = [[0.0_f32; MOST_LANES]; 4];
        if L::N == 1 {
            test_from::<W, 1, L>(ray, tri, 0, &mut answers);
        } else {
            for first in (0..L::N).step_by(8) {
                test_from::<W, 8, L>(ray, tri, first, &mut answers);
            }
        }
        let [hits, ts, us, vs] = &answers;
        let hit = L::from_fn(|lane| hits[lane & (MOST_LANES - 1)]);
        let t = L::from_fn(|lane| ts[lane & (MOST_LANES - 1)]);
        let u = L::from_fn(|lane| us[lane & (MOST_LANES - 1)]);
        let v = L::from_fn(|lane| vs[lane & (MOST_LANES - 1)]);
        let mask = hit.gt(L::splat(0.0));
        mask.any().then_some(LaneHit::new(mask, t, u, v))
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
