//! `needles:N`: N triangles 0.8 long and 1e-4 wide, all nearly along the diagonal of the unit cube.
//!
//! Their boxes are large and nearly empty, and overlap: a tree must look into many, a grid's lists grow with n³.

use super::{Draft, Random, draft::matte};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Camera, Scene, SceneEntry, SceneError, Sizes};

/// The family's row.
pub const ROW: SceneEntry = SceneEntry {
    name: "needles",
    about: "Diagonal needles in nearly empty boxes, which make trees overlap and grid lists explode.",
    size: "N",
    params: &[ParamSpec {
        name: "N",
        about: "Triangles.",
        kind: ParamKind::Int {
            min: 1,
            max: 20_000_000,
        },
        default: "10000",
    }],
    example: "needles:1000",
    blind: false,
    triangles: |sizes| u64::from(sizes.int(0)),
    build,
};

const LENGTH: f64 = 0.8;
const NOISE: f64 = 0.02;
const WIDTH: f64 = 1e-4;

fn build(sizes: &Sizes) -> Result<Scene, SceneError> {
    let mut draft = Draft::new(Vec3::Y);
    let mut random = Random::new(1);
    let along = DVec3::splat(LENGTH / 3.0_f64.sqrt());
    for _ in 0..sizes.int(0) {
        let p = random.cube(0.0, 1.0);
        let q = p + along + random.cube(-NOISE, NOISE);
        // Somewhere across the needle.
        let across = (q - p).cross(random.cube(-1.0, 1.0)).normalize_or(DVec3::X);
        draft.triangle([p, q, p + across * WIDTH]);
    }
    draft.paint(matte("needles", 0.62, 0.64, 0.68));
    draft.camera = Some(Camera {
        eye: Vec3::new(2.9, 1.4, 1.2),
        at: Vec3::splat(0.73),
        up: Vec3::Y,
        fov_deg: 38.0,
    });
    draft.finish()
}

#[cfg(test)]
mod tests {
    use crate::scene::load;

    #[test]
    fn needles_are_long_and_thin() {
        let mesh = load("needles:200").unwrap().mesh;
        for prim in 0..200 {
            let [a, b, c] = mesh.corners(prim);
            assert!(((b - a).length() - 0.8).abs() < 0.04);
            assert!((c - a).length() < 1.2e-4 && (c - a).length() > 0.8e-4);
        }
    }
}
