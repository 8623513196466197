//! `one` and `empty`: the smallest scenes.

use super::{Draft, draft::matte};
use crate::geometry::{DVec3, Vec3};
use crate::scene::{Scene, SceneEntry, SceneError, Sizes};

/// A single triangle.
pub const ONE: SceneEntry = SceneEntry {
    name: "one",
    about: "A single triangle, for which every structure's root is a leaf.",
    size: "",
    params: &[],
    example: "one",
    blind: false,
    triangles: |_| 1,
    build: one,
};

/// No triangle.
pub const EMPTY: SceneEntry = SceneEntry {
    name: "empty",
    about: "No triangle at all, whose box is empty and which no ray hits.",
    size: "",
    params: &[],
    example: "empty",
    blind: true,
    triangles: |_| 0,
    build: empty,
};

fn one(_: &Sizes) -> Result<Scene, SceneError> {
    let mut draft = Draft::new(Vec3::Y);
    draft.triangle([
        DVec3::new(-1.0, -0.6, 0.0),
        DVec3::new(1.0, -0.6, 0.0),
        DVec3::new(0.0, 1.0, 0.0),
    ]);
    draft.paint(matte("one", 0.75, 0.55, 0.3));
    draft.finish()
}

fn empty(_: &Sizes) -> Result<Scene, SceneError> {
    Draft::new(Vec3::Y).finish()
}
