//! Points on triangles: where rays that leave a surface start.
//!
//! ```text
//!        dir  /          position is rounded: the true point lies somewhere in the box `error` around it;
//!            /           `start` moves along the normal until the whole box is on one side of the plane.
//!   ---[ . ]o-----
//!      box   start
//! ```
//!
//! **Source:** Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., §6.8.6 ("Robust spawned ray origins").
//! **Differs:** the bound also holds what a kernel rounds when it places the start relative to the triangle again, so
//! that kernels which know no error bound of their own do not hit the triangle that the ray leaves.

use super::{Vec3, gamma};

/// A point on a triangle with a bound on its rounding error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// The point, rounded.
    pub position: Vec3,
    /// Bound on the distance to the true point along each axis, including what a kernel rounds in looking back.
    pub error: Vec3,
}

impl SurfacePoint {
    /// The point with barycentric weights `u` and `v` of vertices 1 and 2.
    ///
    /// Weights outside the triangle are moved into it, NaN to 0, so the point always lies on the triangle.
    #[must_use]
    pub fn of(corners: &[Vec3; 3], u: f32, v: f32) -> Self {
        // A comparison with NaN is false.
        let u = if u > 0.0 { u.min(1.0) } else { 0.0 };
        let v = if v > 0.0 { v.min(1.0 - u) } else { 0.0 };
        let parts = [corners[0] * (1.0 - u - v), corners[1] * u, corners[2] * v];
        let rounded = parts[0].abs() + parts[1].abs() + parts[2].abs();
        // A kernel looks back at the triangle over the distance to its corners, and mixes the axes in doing so: on a
        // plane like y = 0 every coordinate along y is exact, and the start must still not lie in the plane.
        let [e1, e2] = [corners[1] - corners[0], corners[2] - corners[0]];
        let seen = e1.abs().max(e2.abs()).max_element();
        Self {
            position: parts[0] + parts[1] + parts[2],
            error: rounded * gamma(7) + Vec3::splat(seen * gamma(8)),
        }
    }

    /// Where a ray along `dir` starts: on that side of the plane with unit `normal` which `dir` points to, outside the
    /// error box. For a direction within the plane that is the normal's side.
    #[must_use]
    pub fn start(&self, normal: Vec3, dir: Vec3) -> Vec3 {
        let side = if dir.dot(normal) < 0.0 {
            -normal
        } else {
            normal
        };
        let offset = side * normal.abs().dot(self.error);
        let moved = (self.position + offset).to_array();
        // The sum was rounded, perhaps back towards the plane: one step outwards undoes that.
        Vec3::from_array(std::array::from_fn(|axis| {
            let x = moved[axis];
            if offset[axis] > 0.0 {
                x.next_up()
            } else if offset[axis] < 0.0 {
                x.next_down()
            } else {
                x
            }
        }))
    }
}

/// The unit normal of a triangle, right-handed in the order of its corners; `None` where it has no area.
///
/// Computed in `f64`, so that slivers far from the origin keep a direction.
#[must_use]
pub fn unit_normal(corners: &[Vec3; 3]) -> Option<Vec3> {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    // Scaled first: the square of a cross product of tiny or huge edges leaves even the range of f64.
    let (e1, e2) = (b - a, c - a);
    let scale = e1.abs().max(e2.abs()).max_element();
    let normal = (e1 / scale).cross(e2 / scale).normalize_or_zero();
    (normal.is_finite() && normal.length_squared() > 0.0).then(|| normal.as_vec3())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_start_lies_on_the_side_that_the_direction_points_to() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|c| c + Vec3::splat(1e4));
        let point = SurfacePoint::of(&corners, 0.25, 0.25);
        assert!(point.start(Vec3::Z, Vec3::Z).z > 1e4);
        assert!(point.start(Vec3::Z, Vec3::NEG_Z).z < 1e4);
        assert!(point.start(Vec3::Z, Vec3::X).z > 1e4);
    }

    #[test]
    fn the_start_leaves_planes_whose_coordinates_are_exact() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        for (u, v) in [(0.0, 0.0), (0.25, 0.5), (1.0, 0.0)] {
            let point = SurfacePoint::of(&corners, u, v);
            assert!(point.start(Vec3::Z, Vec3::Z).z > 0.0);
            assert!(point.start(Vec3::Z, Vec3::NEG_Z).z < 0.0);
        }
    }

    #[test]
    fn weights_outside_the_triangle_are_moved_into_it() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        assert_eq!(SurfacePoint::of(&corners, 7.0, 3.0).position, Vec3::X);
        assert_eq!(SurfacePoint::of(&corners, f32::NAN, 2.0).position, Vec3::Y);
    }

    #[test]
    fn a_triangle_without_area_has_no_normal_and_tiny_or_huge_ones_have() {
        assert_eq!(unit_normal(&[Vec3::ZERO, Vec3::X, Vec3::X * 2.0]), None);
        assert_eq!(unit_normal(&[Vec3::ONE; 3]), None);
        for scale in [1e-38, 1e38] {
            let corners = [Vec3::ZERO, Vec3::X * scale, Vec3::Y * scale];
            assert_eq!(unit_normal(&corners), Some(Vec3::Z));
        }
    }
}
