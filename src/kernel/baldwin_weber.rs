//! Baldwin and Weber's test: an affine transformation, stored for each triangle, takes the world to a frame in which the
//! triangle is (0,0,0), (1,0,0), (0,1,0) and the plane z = 0.
//!
//! ```text
//!        z |  / dir'               rows of the transformation: u, v, z
//!          | /                     t = -z(origin) / z(dir)
//!          |/_______ u             u = u(origin + t·dir),  v likewise
//!         /
//!      v /
//! ```
//!
//! The third axis is free; it is chosen so that one column of the rows u and v is zero and the row z has a 1 there: that
//! of the normal's largest component.
//!
//! **Source:** D. Baldwin and M. Weber, "Fast Ray-Triangle Intersections by Coordinate Transformation", JCGT 5(3), 2016.
//! **Differs:** the paper's form that keeps all three rows, 48 bytes, since lanes with different columns cannot branch;
//! precomputed in `f64`, stored in `f32`.

use crate::geometry::lanes::{Lane, LaneMask, LaneRay, LaneVec3};
use crate::geometry::{DVec3, Ray, Vec3};
use crate::registry::Params;

use super::known::{self, Known, cross, dot, minus};
use super::{Kernel, KernelEntry, LaneHit};

/// The kernel `baldwin-weber`.
#[derive(Debug, Clone, Copy)]
pub struct BaldwinWeber;

impl BaldwinWeber {
    pub(super) const ENTRY: KernelEntry = KernelEntry {
        name: "baldwin-weber",
        about: "A stored transformation of the world into each triangle's frame; few operations, many bytes.",
        paper: "Baldwin and Weber 2016, Fast Ray-Triangle Intersections by Coordinate Transformation",
        watertight: false,
        control: false,
        bytes_per_triangle: 48,
        operations: "15 multiplications, 15 additions, 1 division",
        known_failures: "leaks through shared edges and vertices, the more the farther the mesh is from the world's origin, where t errs too: the stored transformation holds the distance; triangles below about 1e-38 in size vanish; `raylab accuracy` measures how often",
        params: &[],
    };

    pub(super) fn from_params(_: &Params) -> Self {
        Self
    }
}

/// The rows u, v and z: three factors and a term.
#[derive(Debug, Clone, Copy)]
pub struct Packed<const W: usize> {
    rows: [[[f32; W]; 4]; 3],
}

/// The transformation of one triangle; zero for one without area, which makes every ray parallel.
fn transformation(corners: [Vec3; 3]) -> [[f32; 4]; 3] {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let (e1, e2) = (b - a, c - a);
    let normal = e1.cross(e2);
    if normal == DVec3::ZERO {
        return [[0.0; 4]; 3];
    }
    let free = normal.abs().max_position();
    let mut axis = DVec3::ZERO;
    axis[free] = 1.0 / normal[free];
    // Of (p - a) x e2 and e1 x (p - a) the component along the free axis, as factors of p - a.
    [e2.cross(axis), axis.cross(e1), normal / normal[free]].map(|row| {
        let term = -row.dot(a);
        [row.x, row.y, row.z, term].map(|x| x as f32)
    })
}

/// The linear part of a row, applied.
#[inline(always)]
fn linear<const W: usize, L: Lane<W>>(row: &[[f32; W]; 4], v: LaneVec3<L>) -> L {
    v.dot(LaneVec3 {
        x: L::load(&row[0]),
        y: L::load(&row[1]),
        z: L::load(&row[2]),
    })
}

impl Kernel for BaldwinWeber {
    type Packed<const W: usize> = Packed<W>;
    type Prepared<const W: usize, L: Lane<W>> = LaneRay<L>;
    type Rest<const W: usize, L: Lane<W>> = ();

    fn pack<const W: usize>(&self, corners: impl Fn(usize) -> [Vec3; 3]) -> Packed<W> {
        let made: [_; W] = std::array::from_fn(|lane| transformation(corners(lane)));
        Packed {
            rows: [0, 1, 2]
                .map(|row| [0, 1, 2, 3].map(|i| std::array::from_fn(|lane| made[lane][row][i]))),
        }
    }

    #[inline(always)]
    fn lane(block: &Packed<8>, lane: usize) -> Packed<1> {
        Packed {
            rows: [0, 1, 2].map(|i| super::lane_of(&block.rows[i], lane)),
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
        let [row_u, row_v, row_z] = &tri.rows;
        let slope = linear(row_z, ray.dir);
        let t = -((linear(row_z, ray.origin) + L::load(&row_z[3])) / slope);
        let point = ray.origin.add_scaled(ray.dir, t);
        let u = linear(row_u, point) + L::load(&row_u[3]);
        let v = linear(row_v, point) + L::load(&row_v[3]);
        // NaN, from rows that overflowed too, does not pass.
        let mask = !slope.eq(zero) & u.ge(zero) & v.ge(zero) & (u + v).le(L::splat(1.0));
        if !mask.any() {
            return None;
        }
        Some(LaneHit::new(mask, t, u, v))
    }

    fn t_error(&self, ray: &Ray, corners: &[Vec3; 3], _: f32) -> f32 {
        let [a, b, c] = corners.map(known::vector::<53>);
        let normal = cross(minus(b, a), minus(c, a));
        let [p, q, r] = corners.map(Vec3::as_dvec3);
        let free = (q - p).cross(r - p).abs().max_position();
        let row = normal.map(|x| x / normal[free]);
        let term = -dot(row, a);
        let row = row.map(Known::stored);
        let above = dot(known::vector(ray.origin), row) + term.stored();
        (above / dot(known::vector(ray.dir), row)).bound()
    }
}
