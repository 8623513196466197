//! Whether boxes together contain a triangle: what is outside of one must be inside of the others.

use crate::geometry::{Aabb, DVec3, Vec3};

/// What computed corners of pieces may be off by, relative to the largest coordinate: a few roundings in `f64`.
const ERROR: f64 = 64.0 * f64::EPSILON;

/// Whether every point of a triangle lies in one of `boxes`, up to the rounding of `f64`.
pub(super) fn is_covered(corners: &[Vec3; 3], boxes: &[Aabb]) -> bool {
    let size = Aabb::of_points(*corners).max_abs();
    let polygon = corners.map(Vec3::as_dvec3);
    inside(&polygon, boxes, ERROR * f64::from(size))
}

fn inside(polygon: &[DVec3], boxes: &[Aabb], error: f64) -> bool {
    let Some((first, others)) = boxes.split_first() else {
        return false;
    };
    let mut rest = polygon.to_vec();
    for axis in 0..3 {
        for (sign, plane) in [(1.0, first.max[axis]), (-1.0, first.min[axis])] {
            let beyond = |v: &DVec3| sign * (v[axis] - f64::from(plane));
            // What is outside by rounding only counts as inside.
            if rest.iter().any(|v| beyond(v) > error) {
                let outside = cut(&rest, beyond);
                if !inside(&outside, others, error) {
                    return false;
                }
                rest = cut(&rest, |v| -beyond(v));
            }
            if rest.is_empty() {
                return true;
            }
        }
    }
    true
}

/// The part of a convex polygon where `side` is not negative.
fn cut(polygon: &[DVec3], side: impl Fn(&DVec3) -> f64) -> Vec<DVec3> {
    let mut part = Vec::with_capacity(polygon.len() + 1);
    for (i, to) in polygon.iter().enumerate() {
        let from = polygon[(i + polygon.len() - 1) % polygon.len()];
        let (a, b) = (side(&from), side(to));
        if (a < 0.0) != (b < 0.0) {
            part.push(from + (*to - from) * (a / (a - b)));
        }
        if b >= 0.0 {
            part.push(*to);
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxes(xs: &[[f32; 2]]) -> Vec<Aabb> {
        let aabb = |&[from, to]: &[f32; 2]| {
            Aabb::of_points([Vec3::new(from, 0.0, 0.0), Vec3::new(to, 1.0, 1.0)])
        };
        xs.iter().map(aabb).collect()
    }

    #[test]
    fn boxes_cover_a_triangle_together_or_not_at_all() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::new(1.0 / 3.0, 1.0, 0.7)];
        let covered = |xs: &[[f32; 2]]| is_covered(&corners, &boxes(xs));
        assert!(covered(&[[0.0, 1.0]]));
        assert!(covered(&[[0.4, 1.0], [0.0, 0.4]]));
        assert!(covered(&[[0.7, 1.0], [0.0, 0.3], [0.2, 0.8]]));
        assert!(!covered(&[[0.4, 1.0]]));
        assert!(!covered(&[[0.4, 1.0], [0.0, 0.399]]));
        assert!(!covered(&[]));
    }

    #[test]
    fn flat_triangles_are_covered_by_flat_boxes() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let mut flat = boxes(&[[0.0, 0.5], [0.5, 1.0]]);
        for aabb in &mut flat {
            aabb.max.z = 0.0;
        }
        assert!(is_covered(&corners, &flat));
    }
}
