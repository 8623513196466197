//! The part of a triangle inside a box, and its box: what makes splits "perfect".
//!
//! Computed in `f64` against a box that is larger by more than the rounding errors, and rounded outward to `f32`, so
//! that the part never loses a point of the exact triangle. What is flat stays exactly flat.
//!
//! **Source:** I. Sutherland and G. Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974.

use crate::geometry::{Aabb, DVec3, Vec3};

/// Six cuts each add less than 8u of the largest coordinate to the error of a vertex; u = 2⁻⁵³.
const PAD: f64 = 64.0 * 0.5 * f64::EPSILON;

/// A convex polygon; a triangle cut by six planes has at most nine vertices.
#[derive(Debug, Clone, Copy)]
struct Polygon {
    vertices: [DVec3; 9],
    len: usize,
}

impl Polygon {
    fn vertices(&self) -> &[DVec3] {
        &self.vertices[..self.len]
    }

    fn push(&mut self, vertex: DVec3) {
        // Rounding cannot give a convex polygon more vertices than cuts, since each cut keeps one run of them.
        if self.len < self.vertices.len() {
            self.vertices[self.len] = vertex;
            self.len += 1;
        }
    }

    /// The triangle, cut to what is within `pad` of the closed `cell`.
    fn within(corners: &[Vec3; 3], cell: &Aabb, pad: f64) -> Self {
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let whole = Aabb::of_points(*corners);
        let mut part = Self {
            vertices: [a, b, c, a, a, a, a, a, a],
            len: 3,
        };
        for axis in 0..3 {
            if whole.max[axis] > cell.max[axis] {
                part.cut(axis, 1.0, f64::from(cell.max[axis]) + pad);
            }
            if whole.min[axis] < cell.min[axis] {
                part.cut(axis, -1.0, f64::from(cell.min[axis]) - pad);
            }
        }
        part
    }

    /// Leaves the part where `sign · x[axis] ≤ sign · plane`.
    fn cut(&mut self, axis: usize, sign: f64, plane: f64) {
        let depth = |v: DVec3| sign * (plane - v[axis]);
        if self.vertices().iter().all(|&v| depth(v) >= 0.0) {
            return;
        }
        let whole = *self;
        self.len = 0;
        let Some(&last) = whole.vertices().last() else {
            return;
        };
        let mut from = last;
        for &to in whole.vertices() {
            let (a, b) = (depth(from), depth(to));
            if (a < 0.0) != (b < 0.0) {
                // Equal coordinates stay exactly equal: their difference is zero.
                let mut crossing = from + (to - from) * (a / (a - b));
                crossing[axis] = plane;
                self.push(crossing);
            }
            if b >= 0.0 {
                self.push(to);
            }
            from = to;
        }
    }

    /// The box of the polygon within `cell`, as far out as it can be by `pad`; `None` where there is nothing.
    fn bounds(&self, corners: &[Vec3; 3], cell: &Aabb, pad: f64) -> Option<Aabb> {
        let [a, b, c] = corners;
        let (mut min, mut max) = (*self.vertices().first()?, self.vertices[0]);
        for &v in self.vertices() {
            (min, max) = (min.min(v), max.max(v));
        }
        let mut bounds = *cell;
        for axis in 0..3 {
            let flat = a[axis] == b[axis] && b[axis] == c[axis];
            let pad = if flat { 0.0 } else { pad };
            bounds.min[axis] = cell.min[axis].max(rounded_down(min[axis] - pad));
            bounds.max[axis] = cell.max[axis].min(rounded_up(max[axis] + pad));
            // A part within the pad outside the cell is taken as lying on its face.
            bounds.min[axis] = bounds.min[axis].min(cell.max[axis]);
            bounds.max[axis] = bounds.max[axis].max(cell.min[axis]);
        }
        Some(bounds)
    }
}

/// More than the errors of a clip.
fn pad(corners: &[Vec3; 3], cell: &Aabb) -> f64 {
    let size = Aabb::of_points(*corners).max_abs().max(cell.max_abs());
    PAD * f64::from(size)
}

/// The box of the part of a triangle inside the closed `cell`; `None` where nothing is inside.
///
/// Contains every point that the exact triangle and the exact cell share, lies within `cell`, and is larger than the
/// exact box by no more than a rounding to `f32`. `None` only if they are disjoint.
pub(super) fn clipped_bounds(corners: &[Vec3; 3], cell: &Aabb) -> Option<Aabb> {
    let pad = pad(corners, cell);
    Polygon::within(corners, cell, pad).bounds(corners, cell, pad)
}

/// As [`clipped_bounds`], for the halves of `cell` below and above the plane inside it where `axis` is `place`.
pub(super) fn clipped_halves(
    corners: &[Vec3; 3],
    cell: &Aabb,
    axis: usize,
    place: f32,
) -> [Option<Aabb>; 2] {
    let pad = pad(corners, cell);
    let whole = Polygon::within(corners, cell, pad);
    let (mut lower, mut upper) = (whole, whole);
    lower.cut(axis, 1.0, f64::from(place) + pad);
    upper.cut(axis, -1.0, f64::from(place) - pad);
    let (mut below, mut above) = (*cell, *cell);
    below.max[axis] = place;
    above.min[axis] = place;
    [
        lower.bounds(corners, &below, pad),
        upper.bounds(corners, &above, pad),
    ]
}

/// The greatest `f32` that is not above `x`.
pub(super) fn rounded_down(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) > x {
        nearest.next_down()
    } else {
        nearest
    }
}

/// The least `f32` that is not below `x`.
pub(super) fn rounded_up(x: f64) -> f32 {
    -rounded_down(-x)
}

#[cfg(test)]
mod tests {
    use super::super::testbed::Dice;
    use super::*;

    fn unit() -> Aabb {
        Aabb::of_points([Vec3::ZERO, Vec3::ONE])
    }

    #[test]
    fn a_triangle_inside_keeps_its_box() {
        let corners = [
            Vec3::splat(0.25),
            Vec3::splat(0.5),
            Vec3::new(0.25, 0.75, 0.5),
        ];
        let bounds = clipped_bounds(&corners, &unit()).expect("inside");
        let exact = Aabb::of_points(corners);
        assert_eq!(bounds.union(exact), bounds);
        assert!((bounds.extent() - exact.extent()).max_element() < 1e-6);
    }

    #[test]
    fn a_triangle_whose_box_overlaps_but_which_passes_a_corner_is_outside() {
        let corners = [
            Vec3::new(1.5, 0.9, 0.5),
            Vec3::new(0.9, 1.5, 0.5),
            Vec3::new(1.5, 1.5, 0.5),
        ];
        assert_eq!(clipped_bounds(&corners, &unit()), None);
    }

    #[test]
    fn a_triangle_that_touches_a_corner_an_edge_or_a_face_is_inside() {
        let touching = [
            [Vec3::ONE, Vec3::splat(2.0), Vec3::new(2.0, 3.0, 1.5)],
            [
                Vec3::new(1.5, 0.5, 0.5),
                Vec3::new(0.5, 1.5, 0.5),
                Vec3::new(2.0, 2.0, 0.5),
            ],
            [
                Vec3::new(-1.0, 0.5, 1.0),
                Vec3::new(2.0, 0.5, 1.0),
                Vec3::new(0.0, 9.0, 1.0),
            ],
        ];
        for corners in touching {
            assert!(clipped_bounds(&corners, &unit()).is_some(), "{corners:?}");
        }
    }

    #[test]
    fn what_is_flat_stays_flat() {
        let z = 1.0 / 3.0;
        let corners = [
            Vec3::new(-5.0, -3.0, z),
            Vec3::new(7.0, -2.0, z),
            Vec3::new(0.1, 8.0, z),
        ];
        let bounds = clipped_bounds(&corners, &unit()).expect("crosses");
        assert_eq!((bounds.min.z, bounds.max.z), (z, z));
    }

    #[test]
    fn no_point_of_a_triangle_inside_a_cell_is_lost() {
        let mut dice = Dice::new(1);
        let mut inside = 0;
        for _ in 0..20_000 {
            let offset = [0.0, 1000.0][dice.below(2) as usize];
            let corners = [0; 3].map(|_| dice.vector() + offset);
            let middle = corners[0].midpoint(corners[dice.below(3) as usize]);
            let cell = Aabb::of_points([middle, middle + 0.5 * dice.vector()]);
            let bounds = clipped_bounds(&corners, &cell);
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            for _ in 0..20 {
                let (u, v) = (
                    f64::from(dice.signed().abs()),
                    f64::from(dice.signed().abs()),
                );
                let (u, v) = if u + v > 1.0 {
                    (1.0 - u, 1.0 - v)
                } else {
                    (u, v)
                };
                let point = a + (b - a) * u + (c - a) * v;
                let within = |aabb: &Aabb| {
                    point.cmpge(aabb.min.as_dvec3()).all() && point.cmple(aabb.max.as_dvec3()).all()
                };
                if within(&cell) {
                    inside += 1;
                    assert!(
                        bounds.is_some_and(|bounds| within(&bounds)),
                        "{corners:?} {cell:?}"
                    );
                }
            }
        }
        assert!(inside > 5000, "{inside}");
    }
}
