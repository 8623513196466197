//! `mountain:N`: a fractal height field over 2^N × 2^N squares with four glass spheres above it.
//!
//! **Source:** Haines, "Standard Procedural Databases" (1987), `mount`; the field by midpoint displacement (Fournier,
//! Fussell, Carpenter 1982), diamonds and squares in turns.

use super::{Draft, Icosphere, Random, draft::matte};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Camera, Light, Material, Scene, SceneEntry, SceneError, Sizes};

/// The family's row.
pub const ROW: SceneEntry = SceneEntry {
    name: "mountain",
    about: "A fractal height field in a flat box, with glass spheres that bend rays above it.",
    size: "N",
    params: &[ParamSpec {
        name: "N",
        about: "Halvings of each side.",
        kind: ParamKind::Int { min: 1, max: 12 },
        default: "7",
    }],
    example: "mountain:4",
    blind: false,
    triangles: |sizes| 2 * 4_u64.pow(sizes.int(0)) + 4 * 1_280,
    build,
};

fn build(sizes: &Sizes) -> Result<Scene, SceneError> {
    let side = (1_u32 << sizes.int(0)) + 1;
    let heights = heights(side);
    let mut draft = Draft::new(Vec3::Z);
    for y in 0..side {
        for x in 0..side {
            let place = |i: u32| f64::from(i) * 2.0 / f64::from(side - 1) - 1.0;
            let height = heights[(y * side + x) as usize];
            draft.vertex(DVec3::new(place(x), place(y), height));
        }
    }
    for y in 0..side - 1 {
        for x in 0..side - 1 {
            let a = y * side + x;
            draft.quad([a, a + 1, a + side + 1, a + side]);
        }
    }
    draft.paint(matte("rock", 0.48, 0.42, 0.34));
    let unit = Icosphere::new(3);
    for (x, y) in [(-0.4, -0.4), (0.4, -0.4), (-0.4, 0.4), (0.4, 0.4)] {
        draft.sphere(&unit, DVec3::new(x, y, 0.62), 0.2);
    }
    draft.paint(Material {
        specular: Vec3::ONE,
        shininess: 1000.0,
        refraction_index: 1.5,
        opacity: 0.1,
        illum: 7,
        ..matte("glass", 0.1, 0.1, 0.1)
    });
    draft.lights.push(Light {
        position: Vec3::new(3.0, -2.0, 3.0),
        intensity: Vec3::splat(16.0),
    });
    draft.camera = Some(Camera {
        eye: Vec3::new(1.1, -2.7, 1.55),
        at: Vec3::new(0.0, 0.0, 0.2),
        up: Vec3::Z,
        fov_deg: 40.0,
    });
    draft.finish()
}

/// Heights of a square field of `side` = 2^k + 1 points, from corners at 0.
fn heights(side: u32) -> Vec<f64> {
    let mut random = Random::new(1);
    let mut field = vec![0.0; (side * side) as usize];
    let index = |x: u32, y: u32| (y * side + x) as usize;
    let mut step = side - 1;
    let mut swing = 0.35;
    while step > 1 {
        let half = step / 2;
        // Diamonds: the middle of each square.
        for y in (half..side).step_by(step as usize) {
            for x in (half..side).step_by(step as usize) {
                let corners = [
                    (x - half, y - half),
                    (x + half, y - half),
                    (x - half, y + half),
                    (x + half, y + half),
                ];
                let mean = corners
                    .iter()
                    .map(|&(x, y)| field[index(x, y)])
                    .sum::<f64>()
                    / 4.0;
                field[index(x, y)] = mean + random.between(-swing, swing);
            }
        }
        // Squares: the middle of each side, from those of its neighbours that exist.
        for y in (0..side).step_by(half as usize) {
            let first = if (y / half).is_multiple_of(2) {
                half
            } else {
                0
            };
            for x in (first..side).step_by(step as usize) {
                let around = [
                    (x.checked_sub(half), Some(y)),
                    (Some(x + half), Some(y)),
                    (Some(x), y.checked_sub(half)),
                    (Some(x), Some(y + half)),
                ];
                let known: Vec<f64> = around
                    .iter()
                    .filter_map(|&(x, y)| Some((x?, y?)))
                    .filter(|&(x, y)| x < side && y < side)
                    .map(|(x, y)| field[index(x, y)])
                    .collect();
                let mean = known.iter().sum::<f64>() / known.len() as f64;
                field[index(x, y)] = mean + random.between(-swing, swing);
            }
        }
        step = half;
        swing *= 0.5;
    }
    field
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::load;

    #[test]
    fn the_field_rises_everywhere_but_at_its_corners_and_ever_less() {
        let field = heights(65);
        assert_eq!(
            [field[0], field[64], field[64 * 65], field[65 * 65 - 1]],
            [0.0; 4]
        );
        assert_eq!(field.iter().filter(|&&h| h == 0.0).count(), 4);
        let steps = field.windows(2).step_by(7).map(|w| (w[1] - w[0]).abs());
        assert!(steps.sum::<f64>() / 600.0 < 0.1);
    }

    #[test]
    fn a_mountain_faces_upwards() {
        let mesh = load("mountain:4").unwrap().mesh;
        assert_eq!(mesh.len(), 2 * 256 + 5_120);
        for prim in 0..512 {
            let [a, b, c] = mesh.corners(prim);
            assert!((b - a).cross(c - a).z > 0.0);
        }
    }
}
