//! Spheres of triangles: an icosahedron whose triangles are cut in four, again and again.

use std::collections::HashMap;

use crate::geometry::DVec3;

/// A unit sphere around the origin, closed, normals outwards: 20·4^level triangles over 10·4^level + 2 points.
pub struct Icosphere {
    /// Points of the sphere.
    pub points: Vec<DVec3>,
    /// Indices into `points`.
    pub triangles: Vec<[u32; 3]>,
}

/// Triangles of an icosphere.
pub const fn triangles(level: u32) -> u64 {
    20 << (2 * level)
}

impl Icosphere {
    /// The sphere of `level` cuts.
    pub fn new(level: u32) -> Self {
        let mut sphere = Self::icosahedron();
        for _ in 0..level {
            sphere = sphere.cut();
        }
        sphere
    }

    fn icosahedron() -> Self {
        let golden = (1.0 + 5.0_f64.sqrt()) * 0.5;
        // The corners of three golden rectangles, in the planes xy, yz and zx.
        let mut points = Vec::with_capacity(12);
        for (a, b) in [
            (-1.0, golden),
            (1.0, golden),
            (-1.0, -golden),
            (1.0, -golden),
        ] {
            points.extend([
                DVec3::new(a, b, 0.0),
                DVec3::new(0.0, a, b),
                DVec3::new(b, 0.0, a),
            ]);
        }
        // Three corners at the least distance, 2, from each other make a triangle.
        let near = |a: usize, b: usize| (points[a] - points[b]).length_squared() < 4.5;
        let mut triangles = Vec::with_capacity(20);
        for a in 0..12 {
            for b in a + 1..12 {
                for c in b + 1..12 {
                    if near(a, b) && near(b, c) && near(c, a) {
                        let outwards = points[a].dot(points[b].cross(points[c])) > 0.0;
                        let (b, c) = if outwards { (b, c) } else { (c, b) };
                        triangles.push([a as u32, b as u32, c as u32]);
                    }
                }
            }
        }
        let points = points.into_iter().map(DVec3::normalize).collect();
        Self { points, triangles }
    }

    /// Cuts each triangle at the middles of its sides.
    fn cut(&self) -> Self {
        let mut points = self.points.clone();
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let sum = self.points[a as usize] + self.points[b as usize];
                points.push(sum.normalize());
                points.len() as u32 - 1
            })
        };
        let mut triangles = Vec::with_capacity(4 * self.triangles.len());
        for &[a, b, c] in &self.triangles {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        Self { points, triangles }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec3;
    use crate::scene::Mesh;
    use crate::scene::family::closed;

    #[test]
    fn icospheres_are_closed_and_round_with_normals_outwards() {
        for level in 0..4 {
            let sphere = Icosphere::new(level);
            assert_eq!(sphere.triangles.len() as u64, triangles(level));
            assert_eq!(sphere.points.len(), 10 * 4_usize.pow(level) + 2);
            assert!(
                sphere
                    .points
                    .iter()
                    .all(|p| (p.length() - 1.0).abs() < 1e-15)
            );
            for t in &sphere.triangles {
                let [a, b, c] = t.map(|i| sphere.points[i as usize]);
                assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
            }
            let points: Vec<Vec3> = sphere.points.iter().map(|p| p.as_vec3()).collect();
            assert!(closed(&Mesh::new(points, sphere.triangles).unwrap()));
        }
    }
}
