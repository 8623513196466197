//! `offset:X[,s]` and `outlier:X`: what distance does to a teapot.
//!
//! At 1e6 from the origin neighbouring `f32` are 0.0625 apart, so that much of a pot of length 1 collapses; scaled by
//! 1e-6 or 1e6, absolute tolerances fail. A single triangle far away ruins a uniform grid over the box of both.

use super::{Draft, draft::matte, teapot};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Camera, Scene, SceneEntry, SceneError, Sizes};

/// A pot far from the origin.
pub const OFFSET: SceneEntry = SceneEntry {
    name: "offset",
    about: "A teapot far from the origin, where rounding swallows its detail.",
    size: "X[,s]",
    params: &[
        ParamSpec {
            name: "X",
            about: "Distance from the origin along each axis.",
            kind: ParamKind::Float {
                min: -1e9,
                max: 1e9,
            },
            default: "1000000",
        },
        ParamSpec {
            name: "s",
            about: "Length of the pot.",
            kind: ParamKind::Float {
                min: 1e-30,
                max: 1e9,
            },
            default: "1",
        },
    ],
    example: "offset:1000",
    blind: false,
    triangles: |_| 16_256,
    build: offset,
};

/// A pot and one far triangle.
pub const OUTLIER: SceneEntry = SceneEntry {
    name: "outlier",
    about: "A teapot and one stray triangle far away, which ruins a uniform grid.",
    size: "X",
    params: &[ParamSpec {
        name: "X",
        about: "Distance of the triangle.",
        kind: ParamKind::Float { min: 1.0, max: 1e9 },
        default: "10000",
    }],
    example: "outlier:100",
    blind: false,
    triangles: |_| 65_281,
    build: outlier,
};

fn offset(sizes: &Sizes) -> Result<Scene, SceneError> {
    let (offset, scale) = (DVec3::splat(sizes.float(0)), sizes.float(1));
    let mut draft = Draft::new(Vec3::Z);
    let (points, triangles) = teapot::unit_pot(16);
    for point in points {
        draft.vertex(point * scale + offset);
    }
    draft.triangles = triangles;
    draft.paint(teapot::glaze());
    let place = |p: DVec3| (p * scale + offset).as_vec3();
    draft.camera = Some(Camera {
        eye: place(EYE),
        at: place(AT),
        up: Vec3::Z,
        fov_deg: 34.0,
    });
    draft.finish()
}

fn outlier(sizes: &Sizes) -> Result<Scene, SceneError> {
    let mut draft = Draft::new(Vec3::Z);
    let (points, triangles) = teapot::unit_pot(32);
    for point in points {
        draft.vertex(point);
    }
    draft.triangles = triangles;
    draft.paint(teapot::glaze());
    let far = DVec3::X * sizes.float(0);
    draft.triangle([far, far + DVec3::Y, far + DVec3::Z]);
    draft.paint(matte("stray", 0.7, 0.2, 0.2));
    draft.camera = Some(Camera {
        eye: EYE.as_vec3(),
        at: AT.as_vec3(),
        up: Vec3::Z,
        fov_deg: 34.0,
    });
    draft.finish()
}

/// The view of a pot of length 1.
const EYE: DVec3 = DVec3::new(0.56, -1.34, 0.81);
const AT: DVec3 = DVec3::new(0.0, 0.0, 0.23);

#[cfg(test)]
mod tests {
    use crate::geometry::Vec3;
    use crate::scene::load;

    #[test]
    fn the_pot_has_length_one_wherever_it_is_and_collapses_far_out() {
        let near = load("offset:0").unwrap().mesh;
        assert_eq!((near.len(), near.degenerate()), (16_256, 0));
        assert!((near.bounds().extent().x - 1.0).abs() < 1e-6);
        let far = load("offset:1e6").unwrap().mesh;
        assert_eq!(far.len(), 16_256);
        assert!(far.degenerate() > 10_000);
        assert!(
            (far.bounds().centre() - Vec3::splat(1e6))
                .abs()
                .max_element()
                < 1.0
        );
        let small = load("offset:0,1e-6").unwrap().mesh;
        assert!((small.bounds().extent().x - 1e-6).abs() < 1e-12);
    }

    #[test]
    fn one_triangle_stretches_the_box() {
        let mesh = load("outlier:5000").unwrap().mesh;
        assert_eq!(mesh.len(), 65_281);
        assert_eq!(mesh.bounds().max.x, 5000.0);
        assert_eq!(mesh.triangle_bounds(65_280).min.x, 5000.0);
    }
}
