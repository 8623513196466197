//! Badouel's test: where the ray crosses the plane, then barycentric weights in the coordinate plane on which the
//! triangle's shadow is largest.
//!
//! ```text
//!   n ^    . p = origin + t·dir            drop the axis of n's largest component:
//!     |  .                                 (p - v0) = alpha·e1 + beta·e2  in two coordinates
//!  ---+-------- plane: n·x + d = 0
//! ```
//!
//! **Source:** D. Badouel, "An Efficient Ray-Polygon Intersection", Graphics Gems, 1990.
//! **Differs:** the weights come by Cramer's rule, where the original treats a vertical first edge apart; unit normals,
//! made in `f64`, so that tiny triangles keep theirs. The dropped axis is a number that lanes select by.

use crate::geometry::lanes::{Lane, LaneMask, LaneRay, LaneVec3};
use crate::geometry::{DVec3, Ray, Vec3};
use crate::registry::Params;

use super::known::{self, Known, dot};
use super::{Kernel, KernelEntry, LaneHit};

/// The kernel `badouel`.
#[derive(Debug, Clone, Copy)]
pub struct Badouel;

impl Badouel {
    pub(super) const ENTRY: KernelEntry = KernelEntry {
        name: "badouel",
        about: "The plane's crossing, projected along the normal's largest axis.",
        paper: "Badouel 1990, An Efficient Ray-Polygon Intersection, Graphics Gems",
        watertight: false,
        control: false,
        bytes_per_triangle: 44,
        operations: "16 multiplications, 13 additions, 2 divisions",
        known_failures: "leaks through shared edges and vertices, and t errs with the distance from the world's origin, since plane and crossing are in world space; `raylab accuracy` measures how often",
        params: &[],
    };

    pub(super) fn from_params(_: &Params) -> Self {
        Self
    }
}

/// Planes, and corner 0 and two edges in the coordinates that are kept.
#[derive(Debug, Clone, Copy)]
pub struct Packed<const W: usize> {
    normal: [[f32; W]; 3],
    d: [f32; W],
    /// 0, 1 or 2.
    dropped: [f32; W],
    v0: [[f32; W]; 2],
    e1: [[f32; W]; 2],
    e2: [[f32; W]; 2],
}

/// Two coordinates of a vector, all but the one on `dropped`.
fn kept(v: Vec3, dropped: usize) -> [f32; 2] {
    match dropped {
        0 => [v.y, v.z],
        1 => [v.x, v.z],
        _ => [v.x, v.y],
    }
}

fn normal_of(corners: &[Vec3; 3]) -> DVec3 {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    (b - a).cross(c - a)
}

impl Kernel for Badouel {
    type Packed<const W: usize> = Packed<W>;
    type Prepared<const W: usize, L: Lane<W>> = LaneRay<L>;
    type Rest<const W: usize, L: Lane<W>> = ();

    fn pack<const W: usize>(&self, corners: impl Fn(usize) -> [Vec3; 3]) -> Packed<W> {
        let normal = |lane| normal_of(&corners(lane)).normalize_or_zero();
        let dropped = |lane| normal(lane).abs().max_position();
        let pair = |vector: &dyn Fn([Vec3; 3]) -> Vec3| {
            [0, 1]
                .map(|i| std::array::from_fn(|lane| kept(vector(corners(lane)), dropped(lane))[i]))
        };
        Packed {
            normal: super::rows(|lane| normal(lane).as_vec3()),
            d: std::array::from_fn(|lane| -normal(lane).dot(corners(lane)[0].as_dvec3()) as f32),
            dropped: std::array::from_fn(|lane| dropped(lane) as f32),
            v0: pair(&|[a, _, _]| a),
            e1: pair(&|[a, b, _]| b - a),
            e2: pair(&|[a, _, c]| c - a),
        }
    }

    #[inline(always)]
    fn lane(block: &Packed<8>, lane: usize) -> Packed<1> {
        Packed {
            normal: super::lane_of(&block.normal, lane),
            d: [block.d[lane & 7]],
            dropped: [block.dropped[lane & 7]],
            v0: super::lane_of(&block.v0, lane),
            e1: super::lane_of(&block.e1, lane),
            e2: super::lane_of(&block.e2, lane),
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
        let normal = LaneVec3::load(&tri.normal);
        let slope = ray.dir.dot(normal);
        let t = -((ray.origin.dot(normal) + L::load(&tri.d)) / slope);
        let dropped = L::load(&tri.dropped);
        let (first, second) = (dropped.eq(zero), dropped.eq(L::splat(2.0)));
        let (ox, oy) = (
            L::select(first, ray.origin.y, ray.origin.x),
            L::select(second, ray.origin.y, ray.origin.z),
        );
        let (dx, dy) = (
            L::select(first, ray.dir.y, ray.dir.x),
            L::select(second, ray.dir.y, ray.dir.z),
        );
        let (x0, y0) = (L::load(&tri.v0[0]), L::load(&tri.v0[1]));
        let (x1, y1) = (L::load(&tri.e1[0]), L::load(&tri.e1[1]));
        let (x2, y2) = (L::load(&tri.e2[0]), L::load(&tri.e2[1]));
        let (x, y) = (ox + dx * t - x0, oy + dy * t - y0);
        let inverse = L::splat(1.0) / (x1 * y2 - y1 * x2);
        let u = (x * y2 - y * x2) * inverse;
        let v = (x1 * y - y1 * x) * inverse;
        // A zero normal, of a triangle without area, makes every ray parallel.
        let mask = !slope.eq(zero) & u.ge(zero) & v.ge(zero) & (u + v).le(L::splat(1.0));
        if !mask.any() {
            return None;
        }
        Some(LaneHit::new(mask, t, u, v))
    }

    fn t_error(&self, ray: &Ray, corners: &[Vec3; 3], _: f32) -> f32 {
        let normal = known::unit_normal(corners);
        let d = -dot(normal, known::vector(corners[0]));
        let normal = normal.map(Known::stored);
        let above = dot(known::vector(ray.origin), normal) + d.stored();
        (above / dot(known::vector(ray.dir), normal)).bound()
    }
}
