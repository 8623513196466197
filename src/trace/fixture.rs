//! Small scenes of the tests in this room.

use std::sync::Arc;

use crate::accel::{self, Accelerator};
use crate::geometry::Vec3;
use crate::kernel;
use crate::scene::{Camera, Material, Mesh, Scene};

/// A scene of these triangles, seen from `eye`.
fn scene(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>, eye: Vec3) -> Scene {
    let material_of = vec![0; triangles.len()];
    Scene {
        name: "test".to_owned(),
        about: String::new(),
        mesh: Arc::new(Mesh::new(vertices, triangles).unwrap()),
        materials: vec![Material::default()],
        material_of,
        lights: Vec::new(),
        camera: Camera {
            eye,
            at: Vec3::ZERO,
            up: Vec3::Y,
            fov_deg: 60.0,
        },
        background: Vec3::ZERO,
        warnings: Vec::new(),
    }
}

/// A closed box with a tilted quadrilateral in it, seen from inside.
pub fn room() -> Scene {
    let corner = |i: u32| {
        let side = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        Vec3::new(side(0), side(1), side(2))
    };
    let mut vertices: Vec<Vec3> = (0..8).map(corner).collect();
    vertices.extend([
        Vec3::new(-0.3, -0.4, -0.2),
        Vec3::new(0.4, -0.3, -0.1),
        Vec3::new(0.3, 0.3, -0.3),
        Vec3::new(-0.4, 0.2, -0.4),
    ]);
    let quads = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
        [8, 9, 10, 11],
    ];
    let triangles = quads
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
        .collect();
    scene(vertices, triangles, Vec3::new(0.37, 0.21, 0.83))
}

/// Two large triangles at y = 0 (0 and 1) and two small ones at y = 1 above them (2 and 3), seen from between.
pub fn floor_and_ceiling() -> Scene {
    let square = |y: f32, size: f32| {
        [(-size, -size), (size, -size), (size, size), (-size, size)]
            .map(|(x, z)| Vec3::new(x, y, z))
    };
    let vertices = [square(0.0, 2.0), square(1.0, 1.0)].concat();
    let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    scene(vertices, triangles, Vec3::new(0.2, 0.6, 2.5))
}

/// One triangle without area.
pub fn degenerate() -> Scene {
    let vertices = vec![Vec3::ZERO, Vec3::ONE, Vec3::splat(2.0)];
    scene(vertices, vec![[0, 1, 2]], Vec3::Z)
}

/// No triangles.
pub fn empty() -> Scene {
    scene(Vec::new(), Vec::new(), Vec3::Z)
}

/// `scene`, elsewhere.
pub fn moved(scene: &Scene, by: Vec3) -> Scene {
    changed(scene, |v| v + by)
}

/// `scene`, larger.
pub fn scaled(scene: &Scene, by: f32) -> Scene {
    changed(scene, |v| v * by)
}

fn changed(scene: &Scene, change: impl Fn(Vec3) -> Vec3) -> Scene {
    let vertices = scene.mesh.vertices().iter().map(|v| change(*v)).collect();
    let triangles = scene.mesh.triangles().to_vec();
    let mut scene = scene.clone();
    scene.mesh = Arc::new(Mesh::new(vertices, triangles).unwrap());
    scene.camera.eye = change(scene.camera.eye);
    scene.camera.at = change(scene.camera.at);
    scene
}

/// Brute force over `scene` with the kernel that secondary rays are made with.
pub fn brute(scene: &Scene) -> Box<dyn Accelerator> {
    let kernel =
        kernel::parse("woop").unwrap_or_else(|_| kernel::parse("moller-trumbore").unwrap());
    let brute = accel::parse("brute").unwrap();
    accel::build(&scene.mesh, &brute, None, &kernel, u64::MAX).unwrap()
}
