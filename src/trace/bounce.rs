//! `bounce`: one diffuse reflection of each primary ray that hits: cosine-weighted around the triangle's normal, on the
//! side that the primary ray came from.

use crate::geometry::Ray;

use super::first_hit::first_hits;
use super::sample::{cosine_direction, generator};
use super::{Query, RaySetEntry, Rays};

pub(super) const ENTRY: RaySetEntry = RaySetEntry {
    name: "bounce",
    about: "One diffuse reflection of each primary ray that hits: cosine-weighted around the normal.",
    query: Query::Closest,
    argument: "",
    params: &[],
    make: |request| {
        let hits = first_hits(request.scene, request.count)?;
        let mut random = generator(request.seed, 2);
        let rays: Vec<Ray> = hits
            .iter()
            .map(|hit| {
                let normal = hit.normal.as_dvec3();
                hit.ray_along(cosine_direction(&mut random, normal).as_vec3())
            })
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

#[cfg(test)]
mod tests {
    use super::super::{closest, fixture, ray_set};

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
