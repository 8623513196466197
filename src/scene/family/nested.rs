//! `shells:K` and `matryoshka:K`: surfaces within surfaces around one centre.
//!
//! Shells cut a window into the picture of depth: a ray through the middle meets 2K layers. Of the boxes, all parts
//! have the same centre, so no split plane between centroids separates anything.

use super::{Draft, Icosphere, draft::matte, icosphere};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Scene, SceneEntry, SceneError, Sizes};

/// Spheres within spheres.
pub const SHELLS: SceneEntry = SceneEntry {
    name: "shells",
    about: "Spheres within spheres, so that every ray meets all layers.",
    size: "K[,L]",
    params: &[
        ParamSpec {
            name: "K",
            about: "Spheres, each of 0.93 of the radius of the one around it.",
            kind: ParamKind::Int { min: 1, max: 3900 },
            default: "16",
        },
        ParamSpec {
            name: "L",
            about: "How often every sphere is cut; 4 where it is left out.",
            kind: ParamKind::Int { min: 0, max: 4 },
            default: "",
        },
    ],
    example: "shells:2",
    blind: false,
    triangles: |sizes| icosphere::triangles(level(sizes)) * u64::from(sizes.int(0)),
    build: shells,
};

/// Boxes within boxes.
pub const MATRYOSHKA: SceneEntry = SceneEntry {
    name: "matryoshka",
    about: "Boxes within boxes, whose equal centroids leave a builder nothing to split.",
    size: "K",
    params: &[ParamSpec {
        name: "K",
        about: "Boxes.",
        kind: ParamKind::Int {
            min: 1,
            max: 1_600_000,
        },
        default: "1000",
    }],
    example: "matryoshka:5",
    blind: false,
    triangles: |sizes| 12 * u64::from(sizes.int(0)),
    build: matryoshka,
};

/// Cuts of every sphere: 4 make 5,120 triangles, 3 make 1,280.
fn level(sizes: &Sizes) -> u32 {
    sizes.optional(1).map_or(4, |l| l as u32)
}

fn shells(sizes: &Sizes) -> Result<Scene, SceneError> {
    let mut draft = Draft::new(Vec3::Z);
    let unit = Icosphere::new(level(sizes));
    let mut radius = 1.0;
    for _ in 0..sizes.int(0) {
        draft.sphere(&unit, DVec3::ZERO, radius);
        radius *= 0.93;
    }
    draft.paint(matte("shells", 0.55, 0.62, 0.66));
    draft.finish()
}

fn matryoshka(sizes: &Sizes) -> Result<Scene, SceneError> {
    let mut draft = Draft::new(Vec3::Z);
    let n = sizes.int(0);
    for i in (1..=n).rev() {
        let half = f64::from(i) / f64::from(n);
        let corners = std::array::from_fn(|k| {
            let side = |bit: usize| if k >> bit & 1 == 0 { -half } else { half };
            draft.vertex(DVec3::new(side(0), side(1), side(2)))
        });
        draft.cuboid(corners);
    }
    draft.paint(matte("boxes", 0.66, 0.50, 0.44));
    draft.finish()
}

#[cfg(test)]
mod tests {
    use crate::scene::family::closed;
    use crate::scene::load;

    #[test]
    fn shells_are_closed_and_shrink() {
        let mesh = load("shells:3").unwrap().mesh;
        assert_eq!(mesh.len(), 3 * 5_120);
        assert!(closed(&mesh));
        assert!((mesh.corners(2 * 5_120)[0].length() - 0.93 * 0.93).abs() < 1e-6);
    }

    #[test]
    fn boxes_are_closed_and_share_their_centre() {
        let mesh = load("matryoshka:50").unwrap().mesh;
        assert_eq!(mesh.len(), 600);
        assert!(closed(&mesh));
        assert_eq!(mesh.bounds().centre(), crate::geometry::Vec3::ZERO);
    }
}
