//! Scenes of files that are built into the program, so that it runs from anywhere.
//!
//! Where they come from, and under which licences: `scenes/README.md`.

use std::io;
use std::path::Path;
use std::sync::Arc;

use super::family::{Icosphere, icosphere};
use super::{Camera, Light, Mesh, Scene, SceneEntry, SceneError, Sizes, obj};
use crate::geometry::{DVec3, Vec3};

/// The rows of all bundled files but the teapot, which is a family.
pub const CORNELL: SceneEntry = SceneEntry {
    about: "The measured Cornell box with a mirror and a glass sphere, for reflection, refraction and shadows.",
    triangles: |_| 12 + 2 * icosphere::triangles(SPHERE_LEVEL),
    build: cornell,
    ..row("cornell")
};

/// A carved rocking horse.
pub const CABALLITO: SceneEntry = SceneEntry {
    about: "A rocking horse, a closed and smoothly curved mesh of even density, as many scanned models are.",
    triangles: |_| 13_956,
    build: caballito,
    ..row("caballito")
};

/// A spiral staircase.
pub const STAIRCASE: SceneEntry = SceneEntry {
    about: "A spiral staircase, whose long thin triangles and concave polygons fill their boxes badly.",
    triangles: |_| 14_656,
    build: staircase,
    ..row("staircase")
};

/// A potted plant.
pub const PLANT: SceneEntry = SceneEntry {
    about: "A potted plant of many slender leaves, uneven in density and deep in overlap.",
    triangles: |_| 63_428,
    build: plant,
    ..row("plant")
};

/// What rows of files have in common.
const fn row(name: &'static str) -> SceneEntry {
    SceneEntry {
        name,
        about: "",
        size: "",
        params: &[],
        example: name,
        blind: false,
        triangles: |_| 0,
        build: caballito,
    }
}

/// Cuts of the spheres in the Cornell box: 5,120 triangles each.
const SPHERE_LEVEL: u32 = 4;

/// Reads a bundled OBJ with its one MTL.
fn read(name: &str, obj: &[u8], mtl: &'static [u8], camera: Camera) -> Result<Scene, SceneError> {
    let library = |_: &str| -> io::Result<Vec<u8>> { Ok(mtl.to_vec()) };
    let mut scene = obj::read(obj, Path::new(name), &library)?;
    scene.camera = camera;
    Ok(scene)
}

fn caballito(_: &Sizes) -> Result<Scene, SceneError> {
    read(
        "caballito.obj",
        include_bytes!("../../scenes/caballito/caballito.obj"),
        include_bytes!("../../scenes/caballito/caballito.mtl"),
        view([24.5, 25.5, -19.0], [0.42, 0.26, 1.0], 112.0),
    )
}

/// A view of `at` from the given direction and distance.
fn view(at: [f32; 3], from: [f32; 3], distance: f32) -> Camera {
    let at = Vec3::from_array(at);
    Camera {
        eye: at + Vec3::from_array(from).normalize() * distance,
        at,
        up: Vec3::Y,
        fov_deg: 38.0,
    }
}

fn staircase(_: &Sizes) -> Result<Scene, SceneError> {
    read(
        "spiralStaircase.obj",
        include_bytes!("../../scenes/staircase/spiralStaircase.obj"),
        include_bytes!("../../scenes/staircase/spiralStaircase.mtl"),
        view([6.5, 176.0, -8.0], [0.75, 0.3, 0.9], 600.0),
    )
}

fn plant(_: &Sizes) -> Result<Scene, SceneError> {
    read(
        "decorativePlant.obj",
        include_bytes!("../../scenes/plant/decorativePlant.obj"),
        include_bytes!("../../scenes/plant/decorativePlant.mtl"),
        view([1.5, 156.0, 0.5], [0.4, 0.32, 1.0], 183.0),
    )
}

/// The measured room and its camera, with two spheres of radius 90 in place of the blocks.
///
/// **Source:** "Cornell Box Data", Cornell University Program of Computer Graphics; colours and radiance as renderers
/// commonly take them from the measured spectra.
///
/// **Differs:** the light hangs 0.5 below the ceiling, with which the published one coincides, and a point light
/// below its middle stands for it.
fn cornell(_: &Sizes) -> Result<Scene, SceneError> {
    let camera = Camera {
        eye: Vec3::new(278.0, 273.0, -800.0),
        at: Vec3::new(278.0, 273.0, 0.0),
        up: Vec3::Y,
        // Focal length 0.035, film 0.025.
        fov_deg: 39.3,
    };
    let mut scene = read(
        "cornell.obj",
        include_bytes!("../../scenes/cornell/cornell.obj"),
        include_bytes!("../../scenes/cornell/cornell.mtl"),
        camera,
    )?;
    let unit = Icosphere::new(SPHERE_LEVEL);
    let mut vertices = scene.mesh.vertices().to_vec();
    let mut triangles = scene.mesh.triangles().to_vec();
    let places = [
        ("mirror", DVec3::new(388.0, 90.0, 368.0)),
        ("glass", DVec3::new(172.0, 90.0, 190.0)),
    ];
    for (material, centre) in places {
        let first = vertices.len() as u32;
        vertices.extend(unit.points.iter().map(|&p| (centre + p * 90.0).as_vec3()));
        triangles.extend(unit.triangles.iter().map(|t| t.map(|i| i + first)));
        let material = scene.materials.iter().position(|m| m.name == material);
        let material = material.unwrap_or(scene.materials.len() - 1) as u32;
        scene.material_of.resize(triangles.len(), material);
    }
    scene.mesh = Arc::new(Mesh::new(vertices, triangles)?);
    // Radiance (18.4, 14, 6.75) times the panel's area, 130 by 105: its intensity straight down.
    scene.lights.push(Light {
        position: Vec3::new(278.0, 547.8, 279.5),
        intensity: Vec3::new(18.4, 14.0, 6.75) * (130.0 * 105.0),
    });
    scene.background = Vec3::ZERO;
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::family::closed;
    use crate::scene::load;

    #[test]
    fn bundled_files_load_without_warnings_and_with_all_their_materials() {
        for (name, used) in [
            ("cornell", 6),
            ("caballito", 5),
            ("staircase", 3),
            ("plant", 5),
        ] {
            let scene = load(name).unwrap();
            // The staircase's makers left faces that lie on a line.
            assert!(scene.warnings.is_empty() || name == "staircase", "{name}");
            let mut materials = scene.material_of.clone();
            materials.sort_unstable();
            materials.dedup();
            assert_eq!(materials.len(), used, "{name}");
        }
    }

    #[test]
    fn the_horse_is_closed_once_its_vertices_are_welded() {
        assert!(closed(&load("caballito").unwrap().mesh));
    }

    #[test]
    fn the_box_has_a_mirror_a_glass_and_a_light_within_it() {
        let scene = load("cornell").unwrap();
        let material = |name: &str| scene.materials.iter().find(|m| m.name == name).unwrap();
        assert_eq!(material("mirror").illum, 5);
        assert_eq!(
            (material("glass").illum, material("glass").refraction_index),
            (7, 1.5)
        );
        assert_eq!(material("light").emission, Vec3::new(18.4, 14.0, 6.75));
        let bounds = scene.mesh.bounds();
        let position = scene.lights[0].position;
        assert!(bounds.min.cmplt(position).all() && position.cmplt(bounds.max).all());
    }
}
