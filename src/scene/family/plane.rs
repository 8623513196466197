//! `plane:N`: the unit square in z = 0 as N×N quadrilaterals.
//!
//! A mesh without thickness: a cell of size 0, a division by 0, an axis of one cell.

use super::{Draft, draft::matte};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Scene, SceneEntry, SceneError, Sizes};

/// The family's row.
pub const ROW: SceneEntry = SceneEntry {
    name: "plane",
    about: "A flat square without thickness, which tests cells and boxes of zero extent.",
    size: "N",
    params: &[ParamSpec {
        name: "N",
        about: "Quadrilaterals along each side.",
        kind: ParamKind::Int {
            min: 1,
            max: 1_000_000,
        },
        default: "64",
    }],
    example: "plane:4",
    blind: false,
    triangles: |sizes| 2 * u64::from(sizes.int(0)).pow(2),
    build,
};

fn build(sizes: &Sizes) -> Result<Scene, SceneError> {
    let n = sizes.int(0);
    let mut draft = Draft::new(Vec3::Z);
    let step = f64::from(n);
    for y in 0..=n {
        for x in 0..=n {
            draft.vertex(DVec3::new(f64::from(x) / step, f64::from(y) / step, 0.0));
        }
    }
    for y in 0..n {
        for x in 0..n {
            let a = y * (n + 1) + x;
            draft.quad([a, a + 1, a + n + 2, a + n + 1]);
        }
    }
    draft.paint(matte("plane", 0.6, 0.64, 0.5));
    draft.finish()
}

#[cfg(test)]
mod tests {
    use crate::geometry::Vec3;
    use crate::scene::load;

    #[test]
    fn a_plane_has_no_thickness_and_faces_upwards() {
        let mesh = load("plane:3").unwrap().mesh;
        assert_eq!(mesh.len(), 18);
        assert_eq!(mesh.bounds().extent(), Vec3::new(1.0, 1.0, 0.0));
        for prim in 0..18 {
            let [a, b, c] = mesh.corners(prim);
            assert!((b - a).cross(c - a).z > 0.0);
        }
    }
}
