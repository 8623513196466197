//! `rings:N`: a pyramid of balls of rings, N layers high: in each ball six pentagons of spheres and open cylinders.
//!
//! **Source:** Haines, "Standard Procedural Databases" (1987), `rings`: the pentagons lie across the six axes through
//! opposite corners of an icosahedron.

use super::{Draft, Icosphere, draft::matte, exact};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Camera, Light, Scene, SceneEntry, SceneError, Sizes};

/// The family's row.
pub const ROW: SceneEntry = SceneEntry {
    name: "rings",
    about: "Interlocking rings of even density, a uniform grid at home.",
    size: "N",
    params: &[ParamSpec {
        name: "N",
        about: "Layers of the pyramid.",
        kind: ParamKind::Int { min: 1, max: 24 },
        default: "3",
    }],
    example: "rings:1",
    blind: false,
    triangles: |sizes| {
        let n = u64::from(sizes.int(0));
        (80 + 24) * 5 * n * (n + 1) * (2 * n + 1) + 2
    },
    build,
};

/// Corners around a cylinder.
const AROUND: u32 = 12;
/// Distance of a ring's spheres from its centre; balls stand 2 apart.
const RING: f64 = 0.72;

fn build(sizes: &Sizes) -> Result<Scene, SceneError> {
    let n = sizes.int(0);
    let mut draft = Draft::new(Vec3::Z);
    let rings = rings();
    let unit = Icosphere::new(1);
    // Layer k from the top has k × k balls.
    let mut balls = Vec::new();
    for k in 1..=n {
        for i in 0..k * k {
            let place = |i: u32| 2.0 * f64::from(i) - f64::from(k - 1);
            let height = f64::from(n - k) * 2.0_f64.sqrt();
            balls.push(DVec3::new(place(i % k), place(i / k), height));
        }
    }
    for &centre in &balls {
        for corner in rings.iter().flatten() {
            draft.sphere(&unit, centre + *corner, 0.09);
        }
    }
    draft.paint(matte("spheres", 0.72, 0.52, 0.30));
    for &centre in &balls {
        for ring in &rings {
            for i in 0..5 {
                cylinder(
                    &mut draft,
                    centre + ring[i],
                    centre + ring[(i + 1) % 5],
                    0.05,
                );
            }
        }
    }
    draft.paint(matte("cylinders", 0.42, 0.50, 0.60));
    draft.floor(2.0 * f64::from(n) + 1.0, -0.85);
    draft.paint(matte("floor", 0.45, 0.45, 0.43));
    let size = n as f32;
    draft.lights.push(Light {
        position: Vec3::new(2.5, -1.5, 4.0) * size,
        intensity: Vec3::splat(16.0 * size * size),
    });
    draft.camera = Some(Camera {
        eye: Vec3::new(1.5 * size, -3.0 * size, 1.5 * size + 0.5),
        at: Vec3::new(0.0, 0.0, 0.42 * size - 0.5),
        up: Vec3::Z,
        fov_deg: 38.0,
    });
    draft.finish()
}

/// The corners of the six rings of a ball.
fn rings() -> Vec<[DVec3; 5]> {
    let corners = Icosphere::new(0).points;
    let mut axes: Vec<DVec3> = Vec::new();
    for corner in corners {
        // One of each opposite pair.
        if axes.iter().all(|axis| axis.dot(corner) > -0.9) {
            axes.push(corner);
        }
    }
    axes.iter()
        .map(|axis| {
            let (u, v) = axis.any_orthonormal_pair();
            std::array::from_fn(|i| {
                let (cos, sin) = exact::turn(i as u32, 5);
                (u * cos + v * sin) * RING
            })
        })
        .collect()
}

/// Adds an open cylinder from `a` to `b`: 24 triangles, normals outwards.
fn cylinder(draft: &mut Draft, a: DVec3, b: DVec3, radius: f64) {
    cone(draft, [(a, radius), (b, radius)], AROUND);
}

/// Adds an open cone between two circles given by centre and radius, with `around` corners each, normals outwards.
pub(super) fn cone(draft: &mut Draft, circles: [(DVec3, f64); 2], around: u32) {
    let axis = (circles[1].0 - circles[0].0).normalize_or(DVec3::Z);
    let (u, v) = axis.any_orthonormal_pair();
    // Counter-clockwise about the axis.
    let v = if u.cross(v).dot(axis) > 0.0 { v } else { -v };
    let first = draft.vertices.len() as u32;
    for (centre, radius) in circles {
        for i in 0..around {
            let (cos, sin) = exact::turn(i, around);
            draft.vertex(centre + (u * cos + v * sin) * radius);
        }
    }
    for i in 0..around {
        let j = (i + 1) % around;
        draft.quad([first + i, first + j, first + around + j, first + around + i]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::load;

    #[test]
    fn the_pyramid_of_seven_has_the_recipes_triangles() {
        assert_eq!((ROW.triangles)(&Sizes::of([Some(7.0)])), 436_802);
        assert_eq!(load("rings:2").unwrap().mesh.len(), 104 * 150 + 2);
    }

    #[test]
    fn six_rings_lie_across_six_axes() {
        let rings = rings();
        assert_eq!(rings.len(), 6);
        for ring in &rings {
            let middle: DVec3 = ring.iter().sum();
            assert!(middle.length() < 1e-14);
        }
    }

    #[test]
    fn cylinders_face_outwards() {
        let mut draft = Draft::new(Vec3::Z);
        cylinder(&mut draft, DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0), 0.5);
        let axis = Vec3::new(1.0, 2.0, 3.0).normalize();
        for t in &draft.triangles {
            let [a, b, c] = t.map(|i| draft.vertices[i as usize]);
            let from_axis = (a + b + c) / 3.0;
            let from_axis = from_axis - axis * axis.dot(from_axis);
            assert!((b - a).cross(c - a).dot(from_axis) > 0.0);
        }
    }
}
