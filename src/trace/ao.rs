//! `ao`: ambient occlusion: from each first hit one cosine-weighted ray, which ends after a quarter of the box's diagonal.

use crate::geometry::Ray;

use super::bounce::none_hit;
use super::edge::diagonal;
use super::first_hit::first_hits;
use super::sample::{cosine_direction, generator};
use super::{Query, RaySetEntry, Rays};

pub(super) const ENTRY: RaySetEntry = RaySetEntry {
    name: "ao",
    about: "Ambient occlusion: short cosine-weighted rays from where primary rays hit, asked for occlusion.",
    query: Query::Occluded,
    argument: "",
    params: &[],
    make: |request| {
        let hits = first_hits(request.scene, request.count)?;
        let mut random = generator(request.seed, 6);
        let t_max = (REACH * diagonal(&request.scene.mesh)) as f32;
        let rays: Vec<Ray> = hits
            .iter()
            .map(|hit| Ray {
                t_max,
                ..hit.ray_along(cosine_direction(&mut random, hit.normal.as_dvec3()).as_vec3())
            })
            .collect();
        let warnings = none_hit("ao", rays.is_empty());
        Ok(Rays { rays, warnings })
    },
};

/// How far a ray reaches, as a share of the box's diagonal: creases and contacts, not the far wall.
const REACH: f64 = 0.25;

#[cfg(test)]
mod tests {
    use super::super::{Query, fixture, occluded, ray_set};

    #[test]
    fn rays_are_short_and_only_some_are_blocked() {
        let scene = fixture::room();
        let set = ray_set(&scene, "ao", 3000, 1).unwrap();
        assert_eq!(set.query, Query::Occluded);
        let reach = 0.25 * 12_f32.sqrt();
        assert!(set.rays.iter().all(|r| (r.t_max - reach).abs() < 1e-5));
        let blocked = occluded(&*fixture::brute(&scene), &set.rays);
        let share = blocked.iter().filter(|b| **b).count() as f64 / set.rays.len() as f64;
        assert!((0.02..0.9).contains(&share), "{share}");
    }
}
