//! Convex cells, of which the surface is what matters. All of it only steers the choice of planes: it may be off by rounding.

use crate::geometry::{Aabb, DVec3, Vec3};

/// A convex polyhedron, by its faces.
#[derive(Debug, Clone)]
pub(super) struct Polytope {
    faces: Vec<Vec<DVec3>>,
    pub area: f64,
}

/// The area of a convex polygon.
fn area(face: &[DVec3]) -> f64 {
    let Some((first, rest)) = face.split_first() else {
        return 0.0;
    };
    let triangles = rest.windows(2);
    0.5 * triangles
        .map(|pair| (pair[0] - first).cross(pair[1] - first))
        .sum::<DVec3>()
        .length()
}

/// Orders the vertices of a convex polygon across `normal`.
fn ordered(mut vertices: Vec<DVec3>, normal: DVec3) -> Vec<DVec3> {
    let centre = vertices.iter().copied().sum::<DVec3>() / vertices.len().max(1) as f64;
    let across = normal.any_orthogonal_vector();
    let up = normal.cross(across);
    let angle = |v: &DVec3| (*v - centre).dot(up).atan2((*v - centre).dot(across));
    vertices.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    vertices
}

impl Polytope {
    fn new(faces: Vec<Vec<DVec3>>) -> Self {
        let area = faces.iter().map(|face| area(face)).sum();
        Self { faces, area }
    }

    pub fn of_box(bounds: &Aabb) -> Self {
        let corners = bounds.corners().map(Vec3::as_dvec3);
        let faces = [
            [0, 2, 6, 4],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 3, 7, 6],
            [0, 1, 3, 2],
            [4, 5, 7, 6],
        ];
        Self::new(
            faces
                .iter()
                .map(|face| face.iter().map(|&i: &usize| corners[i]).collect())
                .collect(),
        )
    }

    /// What is below and above the plane across `normal` where `height` is 0.
    pub fn cut(&self, normal: DVec3, height: impl Fn(DVec3) -> f64) -> [Self; 2] {
        let mut sides = [Vec::with_capacity(8), Vec::with_capacity(8)];
        let mut rim = Vec::with_capacity(8);
        for face in &self.faces {
            let mut parts = [Vec::new(), Vec::new()];
            let Some(mut from) = face.last().copied() else {
                continue;
            };
            let mut from_height = height(from);
            for &to in face {
                let to_height = height(to);
                if (from_height < 0.0) != (to_height < 0.0) {
                    let crossing = from + (to - from) * (from_height / (from_height - to_height));
                    rim.push(crossing);
                    parts[0].push(crossing);
                    parts[1].push(crossing);
                }
                parts[usize::from(to_height >= 0.0)].push(to);
                (from, from_height) = (to, to_height);
            }
            for (side, part) in sides.iter_mut().zip(parts) {
                if part.len() > 2 {
                    side.push(part);
                }
            }
        }
        if rim.len() > 2 {
            let cap = ordered(rim, normal);
            sides[0].push(cap.clone());
            sides[1].push(cap);
        }
        sides.map(Self::new)
    }

    /// Its box within `bounds`, a little larger than it is.
    pub fn bounds(&self, bounds: &Aabb) -> Aabb {
        let vertices = self.faces.iter().flatten();
        let own = Aabb::of_points(vertices.map(|v| v.as_vec3()));
        let own = Aabb {
            min: own.min - own.min.abs() * f32::EPSILON,
            max: own.max + own.max.abs() * f32::EPSILON,
        };
        let within = own.intersection(*bounds);
        if within.is_empty() { *bounds } else { within }
    }
}
