//! `tetra:N`: Sierpinski's tetrahedron: four half-size copies at the corners, N − 1 times.
//!
//! **Source:** Haines, "Standard Procedural Databases" (1987), `tetra`.

use super::{Draft, draft::matte};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Camera, Scene, SceneEntry, SceneError, Sizes};

/// The family's row.
pub const ROW: SceneEntry = SceneEntry {
    name: "tetra",
    about: "Sierpinski's tetrahedron, empty space at all scales and faces that touch in one plane.",
    size: "N",
    params: &[ParamSpec {
        name: "N",
        about: "Generations; the scene has 4 to the power of N triangles.",
        kind: ParamKind::Int { min: 1, max: 12 },
        default: "7",
    }],
    example: "tetra:4",
    blind: false,
    triangles: |sizes| 4_u64.pow(sizes.int(0)),
    build,
};

fn build(sizes: &Sizes) -> Result<Scene, SceneError> {
    let mut draft = Draft::new(Vec3::Z);
    // Every second corner of a cube, turned to stand on a face.
    let (s, h) = (0.75_f64.sqrt(), (2.0_f64 / 3.0).sqrt());
    let corners = [
        DVec3::new(-0.5, -s / 3.0, 0.0),
        DVec3::new(0.5, -s / 3.0, 0.0),
        DVec3::new(0.0, s * 2.0 / 3.0, 0.0),
        DVec3::new(0.0, 0.0, h),
    ];
    tetrahedra(&mut draft, corners, sizes.int(0) - 1);
    draft.paint(matte("tetra", 0.66, 0.52, 0.36));
    draft.camera = Some(Camera {
        eye: Vec3::new(0.55, -1.6, 0.85),
        at: Vec3::new(0.0, 0.0, 0.34),
        up: Vec3::Z,
        fov_deg: 38.0,
    });
    draft.finish()
}

fn tetrahedra(draft: &mut Draft, corners: [DVec3; 4], generations: u32) {
    if generations == 0 {
        let [a, b, c, d] = corners.map(|p| draft.vertex(p));
        draft
            .triangles
            .extend([[a, c, b], [a, b, d], [b, c, d], [c, a, d]]);
        return;
    }
    for corner in corners {
        let half = corners.map(|p| (p + corner) * 0.5);
        tetrahedra(draft, half, generations - 1);
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::family::closed;
    use crate::scene::load;

    #[test]
    fn each_generation_has_four_times_the_triangles_and_is_closed() {
        for n in 1..5 {
            let mesh = load(&format!("tetra:{n}")).unwrap().mesh;
            assert_eq!(mesh.len(), 4_usize.pow(n));
            assert!(closed(&mesh));
        }
    }
}
