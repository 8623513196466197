//! `bounce`: one diffuse reflection of each primary ray that hits: cosine-weighted around the triangle's normal, on the
//! side that the primary ray came from, started as [`SurfacePoint`] says.

use crate::accel;
use crate::geometry::Ray;
use crate::kernel;
use crate::scene::Scene;

use super::sample::{cosine_direction, generator};
use super::{Query, RayError, RaySetEntry, Rays, SurfacePoint, closest, primary};

pub(super) const ENTRY: RaySetEntry = RaySetEntry {
    name: "bounce",
    about: "One diffuse reflection of each primary ray that hits: cosine-weighted around the normal.",
    query: Query::Closest,
    argument: "",
    params: &[],
    make: |request| {
        let points = first_points(request.scene, request.count)?;
        let mut random = generator(request.seed, 2);
        let rays: Vec<Ray> = points
            .iter()
            .map(|point| point.ray_along(cosine_direction(&mut random, point.normal)))
            .collect();
        let warnings = none_hit("bounce", rays.is_empty());
        Ok(Rays { rays, warnings })
    },
};

/// A warning where no primary ray hits.
pub(super) fn none_hit(name: &str, empty: bool) -> Vec<String> {
    if empty {
        vec![format!(
            "no primary ray hits the scene, so '{name}' has no rays"
        )]
    } else {
        Vec::new()
    }
}

/// Where the rays of the camera's picture of at most `count` pixels meet the scene, in the picture's tile order.
///
/// The hits are those of the kernel `woop`; misses and triangles without area are left out.
///
/// # Errors
/// The structure that finds them was not built.
pub(super) fn first_points(scene: &Scene, count: usize) -> Result<Vec<SurfacePoint>, RayError> {
    let (width, height) = primary::picture_size(count);
    let mut rays = primary::rays(&scene.camera, width, height);
    rays.retain(Ray::is_valid);
    let kernel = kernel::parse("woop").or_else(|_| kernel::parse(kernel::KERNELS[0].name));
    let accel = accel::parse("bvh").or_else(|_| accel::parse("brute"));
    let (kernel, accel) = (kernel?, accel?);
    let structure = accel::build(&scene.mesh, &accel, None, &kernel, u64::MAX)?;
    let hits = closest(&*structure, &rays);
    Ok(rays
        .iter()
        .zip(&hits)
        .filter_map(|(ray, hit)| SurfacePoint::new(&scene.mesh, ray, hit))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::super::{fixture, ray_set};
    use super::*;

    #[test]
    fn bounces_in_a_closed_room_all_hit() {
        let scene = fixture::room();
        let rays = ray_set(&scene, "bounce", 3000, 1).unwrap().rays;
        let hits = closest(&*fixture::brute(&scene), &rays);
        let hit = hits.iter().filter(|h| h.is_hit()).count();
        assert!(hit * 100 > rays.len() * 99, "{hit} of {}", rays.len());
    }

    #[test]
    fn bounces_go_to_the_side_that_the_camera_is_on() {
        let scene = fixture::floor_and_ceiling();
        let eye = scene.camera.eye.y;
        for ray in ray_set(&scene, "bounce", 500, 1).unwrap().rays {
            assert!((ray.dir.y > 0.0) == (eye > ray.origin.y));
        }
    }
}
