//! What the two methods of the exercise sheet share: the triangle's plane in normal form, and where the ray crosses it.
//!
//! ```text
//!        n ^      e: the ray's origin, b: its direction, p1: a corner
//!          |   e
//!   p1 ----+----\---------  plane: (x - p1)·n = 0
//!                \ b        t = ((p1 - e)·n) / (b·n),  p = e + t·b
//! ```
//!
//! **Source:** the exercise sheet that raylab grew from.
//! **Differs:** the normal is computed in `f64` once and stored in `f32`, so tiny triangles keep theirs.

use crate::geometry::lanes::{Lane, LaneMask, LaneRay, LaneVec3};
use crate::geometry::{DVec3, Ray, Vec3};

use super::Corners;
use super::error::{self, HUGE, Quotient, TINY, gamma};

/// Corners, unit normal and twice the area of `W` triangles.
#[derive(Debug, Clone, Copy)]
pub struct Packed<const W: usize> {
    corners: Corners<W>,
    normal: [[f32; W]; 3],
    area: [f32; W],
}

/// Where a ray crosses the planes of `W` triangles.
pub(super) struct Crossing<L, M> {
    /// False where the ray is parallel to the plane or the triangle has no area.
    pub mask: M,
    /// Ray parameter.
    pub t: L,
    /// Vectors from the crossing to the corners.
    pub to_corners: [LaneVec3<L>; 3],
    /// Unit normals.
    pub normal: LaneVec3<L>,
    /// Twice the areas.
    pub area: L,
}

/// The normal, not of unit length, in `f64`.
fn normal_of(corners: &[Vec3; 3]) -> DVec3 {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    (b - a).cross(c - a)
}

/// Packs corners, normals and areas; a triangle without area gets a zero normal.
pub(super) fn pack<const W: usize>(corners: impl Fn(usize) -> [Vec3; 3]) -> Packed<W> {
    let normal = |lane| normal_of(&corners(lane));
    Packed {
        normal: super::rows(|lane| normal(lane).normalize_or_zero().as_vec3()),
        area: std::array::from_fn(|lane| normal(lane).length() as f32),
        corners: Corners::of(corners),
    }
}

/// One triangle of a block.
#[inline(always)]
pub(super) fn lane(block: &Packed<8>, lane: usize) -> Packed<1> {
    Packed {
        corners: block.corners.lane(lane),
        normal: super::lane_of(&block.normal, lane),
        area: [block.area[lane & 7]],
    }
}

/// Crosses the ray with the planes; `None` where it is parallel to all of them.
///
/// The crossing is compared with the corners in world space, or with `LOCAL` relative to the ray's origin.
#[inline(always)]
pub(super) fn cross<const W: usize, const LOCAL: bool, L: Lane<W>>(
    ray: &LaneRay<L>,
    tri: &Packed<W>,
) -> Option<Crossing<L, L::Mask>> {
    let normal = LaneVec3::load(&tri.normal);
    let [a, b, c] = tri.corners.load();
    let slope = ray.dir.dot(normal);
    // A zero normal, of a triangle without area, makes every ray parallel. NaN passes and gives a NaN t.
    let mask = !slope.eq(L::splat(0.0));
    if !mask.any() {
        return None;
    }
    let (t, to_corners);
    if LOCAL {
        let [a, b, c] = [
            a.minus(ray.origin),
            b.minus(ray.origin),
            c.minus(ray.origin),
        ];
        t = a.dot(normal) / slope;
        let reach = ray.dir.scaled(t);
        to_corners = [a.minus(reach), b.minus(reach), c.minus(reach)];
    } else {
        t = a.minus(ray.origin).dot(normal) / slope;
        let point = ray.origin.add_scaled(ray.dir, t);
        to_corners = [a.minus(point), b.minus(point), c.minus(point)];
    }
    Some(Crossing {
        mask,
        t,
        to_corners,
        normal,
        area: L::load(&tri.area),
    })
}

/// A bound on the error of `t`: numerator and denominator are sums of three products, of which the normal is off by half
/// an ulp and by what its own cross product lost in `f64`.
pub(super) fn t_error(ray: &Ray, corners: &[Vec3; 3], t: f32) -> f32 {
    let [a, b, c] = error::relative(corners, ray.origin);
    let dir = ray.dir.as_dvec3();
    let (e1, e2) = (b - a, c - a);
    let length = e1.cross(e2).length();
    let normal = e1.cross(e2) / length;
    // 2^-50: eight roundings of f64 in the products of an edge with an edge.
    let lost = 8.9e-16 * 2.0 * e1.length() * e2.length() / length + TINY;
    let sum = |v: DVec3| v.abs().element_sum();
    let (numerator, denominator) = (a.abs().dot(normal.abs()), dir.abs().dot(normal.abs()));
    if length.is_nan() || numerator.max(denominator) > HUGE {
        return f32::INFINITY;
    }
    Quotient {
        numerator_error: gamma(5) * numerator + lost * sum(a) + 3.0 * TINY,
        denominator: dir.dot(normal),
        denominator_error: gamma(4) * denominator + lost * sum(dir) + 3.0 * TINY,
        t: f64::from(t),
        roundings: 1,
    }
    .t_error()
}
