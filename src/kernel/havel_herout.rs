//! Havel and Herout's test: three stored planes, through the triangle and across it along two of its edges, evaluated
//! without a division until a hit is certain.
//!
//! ```text
//! n0 = e1 x e2         det = n0·dir,  t' = d0 - n0·origin        t = t' / det
//! n1 = e2 x n0 / n0²   p' = det·origin + t'·dir                  u = (p'·n1 + det·d1) / det
//! n2 = n0 x e1 / n0²                                             v = (p'·n2 + det·d2) / det
//! ```
//!
//! **Source:** J. Havel and A. Herout, "Yet Faster Ray-Triangle Intersection (Using SSE4)", IEEE TVCG 16(3), 2010.
//! **Differs:** precomputed in `f64`, stored in `f32`; where the paper compares sign bits, the determinant's sign is taken
//! out of all three numbers first.

use crate::geometry::lanes::{Lane, LaneMask, LaneRay, LaneVec3};
use crate::geometry::{DVec3, Ray, Vec3};
use crate::registry::Params;

use super::known::{self, Known, cross, dot, minus};
use super::{Kernel, KernelEntry, LaneHit};

/// The kernel `havel-herout`.
#[derive(Debug, Clone, Copy)]
pub struct HavelHerout;

impl HavelHerout {
    pub(super) const ENTRY: KernelEntry = KernelEntry {
        name: "havel-herout",
        about: "Three stored planes, no division before a hit is certain.",
        paper: "Havel and Herout 2010, Yet Faster Ray-Triangle Intersection (Using SSE4)",
        watertight: false,
        control: false,
        bytes_per_triangle: 48,
        operations: "20 multiplications, 15 additions, 1 division (hit only)",
        known_failures: "leaks through shared edges and vertices, the more the farther the mesh is from the world's origin, where t errs too: the stored planes hold the distance; triangles below about 1e-19 in size vanish; `raylab accuracy` measures how often",
        params: &[],
    };

    pub(super) fn from_params(_: &Params) -> Self {
        Self
    }
}

/// The planes n0, n1 and n2: a normal and a term each.
#[derive(Debug, Clone, Copy)]
pub struct Packed<const W: usize> {
    planes: [[[f32; W]; 4]; 3],
}

/// The planes of one triangle; zero for one without area, which makes every determinant 0.
fn planes(corners: [Vec3; 3]) -> [[f32; 4]; 3] {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let (e1, e2) = (b - a, c - a);
    let n0 = e1.cross(e2);
    if n0 == DVec3::ZERO {
        return [[0.0; 4]; 3];
    }
    let square = n0.length_squared();
    let (n1, n2) = (e2.cross(n0) / square, n0.cross(e1) / square);
    [(n0, n0.dot(a)), (n1, -n1.dot(a)), (n2, -n2.dot(a))]
        .map(|(n, d)| [n.x, n.y, n.z, d].map(|x| x as f32))
}

/// The normals of a plane of each triangle.
#[inline(always)]
fn normal<const W: usize, L: Lane<W>>(plane: &[[f32; W]; 4]) -> LaneVec3<L> {
    LaneVec3 {
        x: L::load(&plane[0]),
        y: L::load(&plane[1]),
        z: L::load(&plane[2]),
    }
}

impl Kernel for HavelHerout {
    type Packed<const W: usize> = Packed<W>;
    type Prepared<const W: usize, L: Lane<W>> = LaneRay<L>;
    type Rest<const W: usize, L: Lane<W>> = ();

    fn pack<const W: usize>(&self, corners: impl Fn(usize) -> [Vec3; 3]) -> Packed<W> {
        let made: [_; W] = std::array::from_fn(|lane| planes(corners(lane)));
        Packed {
            planes: [0, 1, 2].map(|plane| {
                [0, 1, 2, 3].map(|i| std::array::from_fn(|lane| made[lane][plane][i]))
            }),
        }
    }

    #[inline(always)]
    fn lane(block: &Packed<8>, lane: usize) -> Packed<1> {
        Packed {
            planes: [0, 1, 2].map(|i| super::lane_of(&block.planes[i], lane)),
        }
    }

    #[inline(always)]
    fn prepare<const W: usize, L: Lane<W>>(&self, _: &Ray, rays: &LaneRay<L>) -> LaneRay<L> {
        *rays
    }

    #[inline(always)]
    fn intersect<const W: usize, L: Lane<W>>(
        &self,
        ray: &LaneRay<L>,
        tri: &Packed<W>,
    ) -> Option<LaneHit<W, L>> {
        let zero = L::splat(0.0);
        let [plane, across_v, across_u] = &tri.planes;
        let n0 = normal(plane);
        let det = ray.dir.dot(n0);
        let above = L::load(&plane[3]) - ray.origin.dot(n0);
        let point = ray.origin.scaled(det).add_scaled(ray.dir, above);
        let u = point.dot(normal(across_v)) + det * L::load(&across_v[3]);
        let v = point.dot(normal(across_u)) + det * L::load(&across_u[3]);
        let negative = det.lt(zero);
        let (u, v) = (L::select(negative, -u, u), L::select(negative, -v, v));
        let most = det.abs();
        let mask = u.ge(zero) & v.ge(zero) & (u + v).le(most) & most.gt(zero);
        if !mask.any() {
            return None;
        }
        Some(LaneHit::new(mask, above / det, u / most, v / most))
    }

    fn t_error(&self, ray: &Ray, corners: &[Vec3; 3], _: f32) -> f32 {
        let [a, b, c] = corners.map(known::vector::<53>);
        let n0 = cross(minus(b, a), minus(c, a));
        let d0 = dot(n0, a).stored();
        let n0 = n0.map(Known::stored);
        let above = d0 - dot(known::vector(ray.origin), n0);
        (above / dot(known::vector(ray.dir), n0)).bound()
    }
}
