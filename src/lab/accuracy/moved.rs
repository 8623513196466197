//! A scene somewhere else: what distance from the origin does to a method.

use std::sync::Arc;

use crate::geometry::{DVec3, Ray, Vec3};
use crate::scene::{Camera, Mesh, MeshError, Scene};
use crate::trace::{self, RayError, RaySet};

/// `scene` moved by `offset` along each axis, with its camera and lights: each coordinate rounded to `f32` once.
///
/// # Errors
/// A coordinate leaves the range of `f32`.
pub(super) fn scene(scene: &Scene, offset: f64) -> Result<Scene, MeshError> {
    let mut moved = scene.clone();
    if offset == 0.0 {
        return Ok(moved);
    }
    let vertices = scene.mesh.vertices().iter().map(|v| point(*v, offset));
    let triangles = scene.mesh.triangles().to_vec();
    moved.mesh = Arc::new(Mesh::new(vertices.collect(), triangles)?);
    moved.camera = Camera {
        eye: point(scene.camera.eye, offset),
        at: point(scene.camera.at, offset),
        ..scene.camera
    };
    for light in &mut moved.lights {
        light.position = point(light.position, offset);
    }
    Ok(moved)
}

/// The ray set `spec` of a scene that [`scene`] moved: made there, so that aimed rays aim at what the moved mesh really
/// is; rays of a file are moved as vertices are.
///
/// # Errors
/// Those of [`trace::ray_set`].
pub(super) fn rays(
    moved: &Scene,
    offset: f64,
    spec: &str,
    count: usize,
    seed: u64,
) -> Result<RaySet, RayError> {
    let mut set = trace::ray_set(moved, spec, count, seed)?;
    if offset != 0.0 && spec.starts_with("file:") {
        for ray in &mut set.rays {
            ray.origin = point(ray.origin, offset);
        }
        set.rays.retain(Ray::is_valid);
    }
    Ok(set)
}

fn point(p: Vec3, offset: f64) -> Vec3 {
    (p.as_dvec3() + DVec3::splat(offset)).as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_moves_and_nowhere_is_where_it_was() {
        let still = crate::scene::load("one").unwrap();
        let moved = scene(&still, 1e4).unwrap();
        let pairs = still.mesh.vertices().iter().zip(moved.mesh.vertices());
        for (a, b) in pairs.chain([(&still.camera.eye, &moved.camera.eye)]) {
            assert_eq!((a.as_dvec3() + DVec3::splat(1e4)).as_vec3(), *b);
        }
        assert_eq!(*scene(&still, 0.0).unwrap().mesh, *still.mesh);
        assert!(scene(&still, 1e39).is_err());
    }

    #[test]
    fn aimed_rays_aim_at_the_moved_mesh_and_rays_of_a_file_move_with_it() {
        let still = crate::scene::load("one").unwrap();
        let moved = scene(&still, 1e4).unwrap();
        let far = rays(&moved, 1e4, "edge", 100, 1).unwrap();
        assert!(far.rays.iter().all(|r| r.at(1.0).max_element() > 9e3));
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.rays");
        trace::files::write_rays(&path, &[Ray::new(Vec3::ONE, Vec3::X)]).unwrap();
        let spec = format!("file:{}", path.display());
        let set = rays(&moved, 1e4, &spec, 1, 1).unwrap();
        assert_eq!(set.rays[0], Ray::new(Vec3::splat(10_001.0), Vec3::X));
    }
}
