//! `shadow`: from the point where a primary ray hits, one ray to each light.
//!
//! The picture has so many pixels that the set stays within the count. Rays to one light stand together, in the
//! picture's tile order. Both ends keep a distance that follows from an error bound. A scene without lights gets one
//! point above it, a little to the right: a head light would only find rays that are free.

use crate::geometry::{Ray, Vec3};
use crate::scene::Scene;

use super::bounce::none_hit;
use super::first_hit::first_hits;
use super::{Query, RaySetEntry, Rays};

pub(super) const ENTRY: RaySetEntry = RaySetEntry {
    name: "shadow",
    about: "From where each primary ray hits to each light, or to a point above a scene without lights.",
    query: Query::Occluded,
    argument: "",
    params: &[],
    make: |request| {
        let lights: Vec<Vec3> = request.scene.lights.iter().map(|l| l.position).collect();
        let mut warnings = Vec::new();
        let lights = if lights.is_empty() {
            warnings.push("the scene has no light: shadow rays go to a point above it".to_owned());
            vec![point_above(request.scene)]
        } else {
            lights
        };
        let hits = first_hits(request.scene, (request.count / lights.len()).max(1))?;
        let mut rays: Vec<Ray> = lights
            .iter()
            .flat_map(|light| hits.iter().filter_map(|hit| hit.ray_to(*light)))
            .collect();
        rays.truncate(request.count);
        warnings.extend(none_hit("shadow", rays.is_empty()));
        Ok(Rays { rays, warnings })
    },
};

/// A point outside the box: a diagonal above its centre and half a diagonal to the right.
fn point_above(scene: &Scene) -> Vec3 {
    let bounds = scene.mesh.bounds();
    let (right, ..) = scene.camera.frame();
    let up = scene.camera.up.try_normalize().unwrap_or(Vec3::Y);
    let diagonal = bounds.extent().as_dvec3().length() as f32;
    bounds.centre() + (up + right * 0.5) * diagonal
}

#[cfg(test)]
mod tests {
    use super::super::{fixture, occluded, ray_set};
    use super::*;
    use crate::scene::Light;

    #[test]
    fn without_a_light_the_set_says_where_its_rays_go() {
        let made = ray_set(&fixture::floor_and_ceiling(), "shadow", 500, 1).unwrap();
        assert!(made.warnings[0].contains("no light"));
        assert_eq!(made.query, Query::Occluded);
    }

    #[test]
    fn the_ceiling_keeps_light_from_above_off_the_floor_and_a_lamp_below_it_does_not() {
        let mut scene = fixture::floor_and_ceiling();
        let free = |scene: &Scene| {
            let rays = ray_set(scene, "shadow", 2000, 1).unwrap().rays;
            let blocked = occluded(&*fixture::brute(scene), &rays);
            let of_floor = rays
                .iter()
                .zip(&blocked)
                .filter(|(ray, _)| ray.origin.y < 0.5);
            let (all, free) = of_floor.fold((0, 0), |(all, free), (_, blocked)| {
                (all + 1, free + usize::from(!blocked))
            });
            assert!(all > 100);
            free as f64 / all as f64
        };
        assert!(free(&scene) < 0.9);
        scene.lights = vec![Light {
            position: Vec3::new(0.0, 0.9, 0.0),
            intensity: Vec3::ONE,
        }];
        assert_eq!(free(&scene), 1.0);
    }

    #[test]
    fn many_lights_share_the_count() {
        let mut scene = fixture::room();
        let light = |x: f32| Light {
            position: Vec3::new(x, 0.2, 0.1),
            intensity: Vec3::ONE,
        };
        scene.lights = (0..5).map(|i| light(i as f32 * 0.1)).collect();
        let rays = ray_set(&scene, "shadow", 1000, 1).unwrap().rays;
        assert!(rays.len() > 800 && rays.len() <= 1000, "{}", rays.len());
        let far = rays.iter().filter(|r| r.at(1.0).x > 0.35).count();
        assert!(far * 5 >= rays.len() - 5);
    }
}
