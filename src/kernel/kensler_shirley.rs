//! Kensler and Shirley's test: signed volumes of three tetrahedra, in the arrangement that a search over equivalent
//! formulas found to be the fastest.
//!
//! ```text
//! n = (v0 - v2) x (v1 - v0)        volumes, each divided by the one that is n·dir:
//! s = (v0 - origin) / (n·dir)      t = n·s,  beta = (dir x s)·(v0 - v2),  gamma = (dir x s)·(v1 - v0)
//! ```
//!
//! **Source:** A. Kensler and P. Shirley, "Optimizing Ray-Triangle Intersection via Automated Search", IEEE Symposium on
//! Interactive Ray Tracing 2006.
//! **Differs:** a triangle without area is made one point when it is packed.

use crate::geometry::lanes::{Lane, LaneMask, LaneRay, LaneVec3};
use crate::geometry::{Ray, Vec3};
use crate::registry::Params;

use super::known::{self, Known, cross, dot, minus};
use super::{Corners, Kernel, KernelEntry, LaneHit};

/// The kernel `kensler-shirley`.
#[derive(Debug, Clone, Copy)]
pub struct KenslerShirley;

impl KenslerShirley {
    pub(super) const ENTRY: KernelEntry = KernelEntry {
        name: "kensler-shirley",
        about: "Signed volumes, arranged by a search for the fewest operations.",
        paper: "Kensler and Shirley 2006, Optimizing Ray-Triangle Intersection via Automated Search",
        watertight: false,
        control: false,
        bytes_per_triangle: 36,
        operations: "27 multiplications, 24 additions, 1 division",
        known_failures: "leaks through shared edges and vertices; `raylab accuracy` measures how often",
        params: &[],
    };

    pub(super) fn from_params(_: &Params) -> Self {
        Self
    }
}

impl Kernel for KenslerShirley {
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
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let [a, b, c] = tri.load();
        let (e0, e1) = (b.minus(a), a.minus(c));
        let normal = e1.cross(e0);
        let inverse = one / normal.dot(ray.dir);
        let s = a.minus(ray.origin).scaled(inverse);
        let across: LaneVec3<L> = ray.dir.cross(s);
        let (u, v) = (across.dot(e1), across.dot(e0));
        // A ray parallel to the plane makes the inverse infinite, and infinite or NaN weights do not pass.
        let mask = u.ge(zero) & v.ge(zero) & (u + v).le(one);
        if !mask.any() {
            return None;
        }
        Some(LaneHit::new(mask, normal.dot(s), u, v))
    }

    fn t_error(&self, ray: &Ray, corners: &[Vec3; 3], _: f32) -> f32 {
        let [a, b, c] = corners.map(known::vector);
        let normal = cross(minus(a, c), minus(b, a));
        let inverse = Known::of(1.0) / dot(normal, known::vector(ray.dir));
        let s = minus(a, known::vector(ray.origin)).map(|x| x * inverse);
        dot(normal, s).bound()
    }
}
