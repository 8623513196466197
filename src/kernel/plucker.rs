//! The Plücker test: on which side of each edge the ray's line passes, by the permuted inner product of the two lines,
//! with a tolerance of one unit in the last place.
//!
//! ```text
//!        v2           side of edge (p, q):  ((q - p) x (q + p))·dir,  corners relative to the origin
//!       /| \          inside: no side below -eps, or none above eps;  eps = ulp·|sum of the three|
//!      / x  \
//!    v0 ---- v1
//! ```
//!
//! **Source:** T. Davidovič, T. Engelhardt, I. Georgiev, P. Slusallek and C. Dachsbacher, "3D Rasterization: A Bridge
//! between Rasterization and Ray Tracing", Graphics Interface 2012, for the sides; the tolerance is that of Embree's
//! robust mode. **Differs:** a triangle without area is made one point when it is packed; weights are not clamped, so at
//! a rim they may be below 0 by the tolerance.

use crate::geometry::lanes::{Lane, LaneMask, LaneRay, LaneVec3};
use crate::geometry::{Ray, Vec3};
use crate::registry::Params;

use super::known::{self, cross, dot, minus};
use super::{Corners, Kernel, KernelEntry, LaneHit};

/// The kernel `plucker`.
#[derive(Debug, Clone, Copy)]
pub struct Plucker;

impl Plucker {
    pub(super) const ENTRY: KernelEntry = KernelEntry {
        name: "plucker",
        about: "The side of each edge that the ray passes, with a tolerance of one ulp, as in Embree's robust mode.",
        paper: "Davidovič et al. 2012, 3D Rasterization: A Bridge between Rasterization and Ray Tracing",
        watertight: false,
        control: false,
        bytes_per_triangle: 36,
        operations: "40 multiplications, 50 additions, 1 division (hit only)",
        known_failures: "the tolerance makes leaks rare, not impossible: rays aimed at vertices can slip through; phantoms within the tolerance of a rim; triangles below about 1e-13 in size vanish",
        params: &[],
    };

    pub(super) fn from_params(_: &Params) -> Self {
        Self
    }
}

/// On which side of the edge from `p` to `q` the ray passes.
#[inline(always)]
fn side<const W: usize, L: Lane<W>>(dir: LaneVec3<L>, p: LaneVec3<L>, q: LaneVec3<L>) -> L {
    q.minus(p).cross(q.plus(p)).dot(dir)
}

impl Kernel for Plucker {
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
        let zero = L::splat(0.0);
        let [a, b, c]: [LaneVec3<L>; 3] = tri.load();
        let (a, b, c) = (
            a.minus(ray.origin),
            b.minus(ray.origin),
            c.minus(ray.origin),
        );
        // Each side stands opposite the corner whose weight it is.
        let (u, v, w) = (
            side(ray.dir, c, a),
            side(ray.dir, a, b),
            side(ray.dir, b, c),
        );
        let sum = u + v + w;
        let eps = sum.abs() * L::splat(f32::EPSILON);
        let within = (u.ge(-eps) & v.ge(-eps) & w.ge(-eps)) | (u.le(eps) & v.le(eps) & w.le(eps));
        let normal = b.minus(a).cross(c.minus(a));
        let slope = normal.dot(ray.dir);
        let mask = within & !sum.eq(zero) & !slope.eq(zero);
        if !mask.any() {
            return None;
        }
        Some(LaneHit::new(mask, a.dot(normal) / slope, u / sum, v / sum))
    }

    fn t_error(&self, ray: &Ray, corners: &[Vec3; 3], _: f32) -> f32 {
        let origin = known::vector(ray.origin);
        let [a, b, c] = corners.map(|v| minus(known::vector(v), origin));
        let normal = cross(minus(b, a), minus(c, a));
        (dot(a, normal) / dot(normal, known::vector(ray.dir))).bound()
    }
}
