//! `lattice:N`: N³ unit cubes side by side, their faces in whole-numbered planes.
//!
//! A grid of N cells an axis has every triangle in cell faces. Rays through edges, vertices and along cell planes, with
//! direction components ±0, meet 0·∞ in slab tests and grid walks. Neighbouring cubes keep their own faces, so inner
//! faces lie double, with opposite normals.

use super::{Draft, draft::matte};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Scene, SceneEntry, SceneError, Sizes};

/// The family's row.
pub const ROW: SceneEntry = SceneEntry {
    name: "lattice",
    about: "Cubes whose faces lie exactly in cell planes, which tests ties, leaks and 0 times infinity.",
    size: "N",
    params: &[ParamSpec {
        name: "N",
        about: "Cubes along each axis.",
        kind: ParamKind::Int { min: 1, max: 1000 },
        default: "8",
    }],
    example: "lattice:2",
    blind: false,
    triangles: |sizes| 12 * u64::from(sizes.int(0)).pow(3),
    build,
};

fn build(sizes: &Sizes) -> Result<Scene, SceneError> {
    let n = sizes.int(0);
    let mut draft = Draft::new(Vec3::Z);
    let side = n + 1;
    for i in 0..side * side * side {
        let (x, y, z) = (i % side, i / side % side, i / side / side);
        draft.vertex(DVec3::new(f64::from(x), f64::from(y), f64::from(z)));
    }
    for i in 0..n * n * n {
        let (x, y, z) = (i % n, i / n % n, i / n / n);
        let corner = |k: u32| {
            let (dx, dy, dz) = (k & 1, k >> 1 & 1, k >> 2);
            (z + dz) * side * side + (y + dy) * side + x + dx
        };
        draft.cuboid(std::array::from_fn(|k| corner(k as u32)));
    }
    draft.paint(matte("lattice", 0.5, 0.6, 0.72));
    draft.finish()
}

#[cfg(test)]
mod tests {
    use crate::geometry::Vec3;
    use crate::scene::family::closed;
    use crate::scene::load;

    #[test]
    fn a_lattice_of_n_has_twelve_triangles_a_cube_at_whole_coordinates() {
        let mesh = load("lattice:3").unwrap().mesh;
        assert_eq!(mesh.len(), 12 * 27);
        assert_eq!(mesh.bounds().extent(), Vec3::splat(3.0));
        assert!(mesh.vertices().iter().all(|v| v.fract() == Vec3::ZERO));
    }

    #[test]
    fn a_cube_is_closed_with_normals_outwards() {
        let mesh = load("lattice:1").unwrap().mesh;
        assert!(closed(&mesh));
        for prim in 0..12 {
            let [a, b, c] = mesh.corners(prim);
            assert!((b - a).cross(c - a).dot(a + b + c - Vec3::splat(1.5)) > 0.0);
        }
    }
}
