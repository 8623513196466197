//! A scene somewhere else and of another size: what distance from the origin and units do to a method.
//!
//! A scene is scaled about the world's origin, as if its unit were another one, and moved after that. (About its own
//! centre, a scene that lies elsewhere would shrink into a single `f32`.)

use std::fmt;
use std::sync::Arc;

use crate::geometry::{DVec3, Ray, Vec3};
use crate::scene::{Camera, Mesh, MeshError, Scene};
use crate::trace::{self, RayError, RaySet};

/// Where a scene is judged, and how large.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// How far it is moved along each axis, after it was scaled: finite, at least 0.
    pub offset: f64,
    /// Factor about the world's origin: finite, above 0.
    pub scale: f64,
}

impl Place {
    /// The scene's own.
    pub const ITS_OWN: Self = Self {
        offset: 0.0,
        scale: 1.0,
    };

    fn point(self, p: Vec3) -> Vec3 {
        (p.as_dvec3() * self.scale + DVec3::splat(self.offset)).as_vec3()
    }
}

impl fmt::Display for Place {
    /// `in its place`, `moved by 1e4`, `scaled by 1e-30 and moved by 1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.scale == 1.0, self.offset == 0.0) {
            (true, true) => f.write_str("in its place"),
            (true, false) => write!(f, "moved by {:e}", self.offset),
            (false, true) => write!(f, "scaled by {:e}", self.scale),
            (false, false) => write!(
                f,
                "scaled by {:e} and moved by {:e}",
                self.scale, self.offset
            ),
        }
    }
}

/// `scene` at `place`, with its camera and lights: each coordinate rounded to `f32` once.
///
/// # Errors
/// A coordinate leaves the range of `f32`.
pub fn scene(scene: &Scene, place: Place) -> Result<Scene, MeshError> {
    let mut moved = scene.clone();
    if place == Place::ITS_OWN {
        return Ok(moved);
    }
    let vertices = scene.mesh.vertices().iter().map(|v| place.point(*v));
    let triangles = scene.mesh.triangles().to_vec();
    moved.mesh = Arc::new(Mesh::new(vertices.collect(), triangles)?);
    moved.camera = Camera {
        eye: place.point(scene.camera.eye),
        at: place.point(scene.camera.at),
        ..scene.camera
    };
    for light in &mut moved.lights {
        light.position = place.point(light.position);
    }
    Ok(moved)
}

/// The ray set `spec` of a scene that [`scene`] put at `place`: made there, so that aimed rays aim at what the moved
/// mesh really is; rays of a file are scaled and moved as vertices are.
///
/// # Errors
/// Those of [`trace::ray_set`].
pub fn rays(
    moved: &Scene,
    place: Place,
    spec: &str,
    count: usize,
    seed: u64,
) -> Result<RaySet, RayError> {
    let mut set = trace::ray_set(moved, spec, count, seed)?;
    if place != Place::ITS_OWN && spec.starts_with("file:") {
        let scaled = |t: f32| (f64::from(t) * place.scale) as f32;
        for ray in &mut set.rays {
            ray.origin = place.point(ray.origin);
            (ray.t_min, ray.t_max) = (scaled(ray.t_min), scaled(ray.t_max));
        }
        set.rays.retain(Ray::is_valid);
    }
    Ok(set)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAR: Place = Place {
        offset: 1e4,
        scale: 1.0,
    };

    #[test]
    fn everything_moves_and_nowhere_is_where_it_was() {
        let still = crate::scene::load("one").unwrap();
        let moved = scene(&still, FAR).unwrap();
        let pairs = still.mesh.vertices().iter().zip(moved.mesh.vertices());
        for (a, b) in pairs.chain([(&still.camera.eye, &moved.camera.eye)]) {
            assert_eq!((a.as_dvec3() + DVec3::splat(1e4)).as_vec3(), *b);
        }
        assert_eq!(*scene(&still, Place::ITS_OWN).unwrap().mesh, *still.mesh);
        let offset = 1e39;
        assert!(scene(&still, Place { offset, ..FAR }).is_err());
    }

    #[test]
    fn a_scene_of_another_unit_is_the_same_scene_for_powers_of_two() {
        let still = crate::scene::load("shells:1,2").unwrap();
        let scale = 2_f64.powi(-80);
        let small = scene(&still, Place { offset: 0.0, scale }).unwrap();
        for (a, b) in still.mesh.vertices().iter().zip(small.mesh.vertices()) {
            assert_eq!(*a, *b * 2_f32.powi(80));
        }
        let scale = 1e39;
        assert!(scene(&still, Place { offset: 0.0, scale }).is_err());
    }

    #[test]
    fn aimed_rays_aim_at_the_moved_mesh_and_rays_of_a_file_move_with_it() {
        let still = crate::scene::load("one").unwrap();
        let moved = scene(&still, FAR).unwrap();
        let far = rays(&moved, FAR, "edge", 100, 1).unwrap();
        assert!(far.rays.iter().all(|r| r.at(1.0).max_element() > 9e3));
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.rays");
        let ray = Ray {
            t_max: 8.0,
            ..Ray::new(Vec3::ONE, Vec3::X)
        };
        trace::files::write_rays(&path, &[ray]).unwrap();
        let spec = format!("file:{}", path.display());
        let place = Place { scale: 0.5, ..FAR };
        let set = rays(&moved, place, &spec, 1, 1).unwrap();
        assert_eq!(set.rays[0].origin, Vec3::splat(10_000.5));
        assert_eq!((set.rays[0].dir, set.rays[0].t_max), (Vec3::X, 4.0));
    }
}
