//! `soup:N[,s]`: N random triangles in the unit cube, of edge s·N^(−1/3).
//!
//! Up to s = 0.5 the uniform grid's best case; at s = 8 every cell holds nearly everything.

use super::{Draft, Random, draft::matte, exact};
use crate::geometry::Vec3;
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Scene, SceneEntry, SceneError, Sizes};

/// The family's row.
pub const ROW: SceneEntry = SceneEntry {
    name: "soup",
    about: "Random triangles in a cube, from a grid's best case (s up to 0.5) to overlap everywhere (s = 8).",
    size: "N[,s]",
    params: &[
        ParamSpec {
            name: "N",
            about: "Triangles.",
            kind: ParamKind::Int {
                min: 1,
                max: 20_000_000,
            },
            default: "10000",
        },
        ParamSpec {
            name: "s",
            about: "Size of a triangle in mean distances between triangles.",
            kind: ParamKind::Float {
                min: 0.001,
                max: 1000.0,
            },
            default: "1",
        },
    ],
    example: "soup:1000,0.5",
    blind: false,
    triangles: |sizes| u64::from(sizes.int(0)),
    build,
};

fn build(sizes: &Sizes) -> Result<Scene, SceneError> {
    let (n, s) = (sizes.int(0), sizes.float(1));
    let mut draft = Draft::new(Vec3::Y);
    let mut random = Random::new(1);
    let edge = s / exact::root(f64::from(n), 3);
    draft.vertices.reserve(3 * n as usize);
    for _ in 0..n {
        let centre = random.cube(0.0, 1.0);
        let corners = [(); 3].map(|()| centre + random.cube(-0.5, 0.5) * edge);
        draft.triangle(corners);
    }
    draft.paint(matte("soup", 0.55, 0.62, 0.70));
    draft.finish()
}

#[cfg(test)]
mod tests {
    use crate::scene::load;

    #[test]
    fn triangles_stay_within_their_size_of_the_cube() {
        let scene = load("soup:1000,2").unwrap();
        assert_eq!(scene.mesh.len(), 1000);
        // Edge 2·1000^(−1/3) = 0.2, half of it on either side.
        let bounds = scene.mesh.bounds();
        assert!(bounds.min.min_element() >= -0.1001 && bounds.max.max_element() <= 1.1001);
        assert!(bounds.extent().min_element() > 0.9);
    }

    #[test]
    fn a_soup_is_the_same_each_time() {
        assert_eq!(
            load("soup:50").unwrap().mesh,
            load("soup:50,1").unwrap().mesh
        );
    }
}
