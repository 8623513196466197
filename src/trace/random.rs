//! `random`: lines that are uniformly distributed among those that meet the scene's box.
//!
//! ```text
//!        ●  origin, outside
//!         \
//!      ┌───p──────┐   p: uniform on the box's surface
//!      │    \     │   direction: cosine-weighted inwards
//!      └─────\────┘
//! ```
//!
//! **Source:** L. Santaló, "Integral Geometry and Geometric Probability", 1976, §I.12: a line through a convex body is
//! uniform when its entry point is uniform by area and its direction cosine-weighted.
//! **Differs:** each ray starts one diagonal before its entry, so that no origin lies on a face of the box, where axis
//! parallel triangles often lie. Where the box has no area (one point, a segment, nothing), lines through a sphere
//! around it are taken.

use rand_core::Rng;
use rand_pcg::Pcg32;

use crate::geometry::{Aabb, DVec3, Ray};

use super::sample::{cosine_direction, direction, generator, unit};
use super::{Query, RaySetEntry, Rays};

pub(super) const ENTRY: RaySetEntry = RaySetEntry {
    name: "random",
    about: "Lines through the scene's box, uniformly distributed, each from outside the box.",
    query: Query::Closest,
    argument: "",
    params: &[],
    make: |request| {
        let bounds = request.scene.mesh.bounds();
        let mut random = generator(request.seed, 1);
        let rays = (0..request.count)
            .map(|_| line(&bounds, &mut random))
            .collect();
        let warnings = if bounds.is_empty() {
            vec![
                "the scene is empty: random rays go through a unit sphere at the origin".to_owned(),
            ]
        } else {
            Vec::new()
        };
        Ok(Rays { rays, warnings })
    },
};

/// A uniform line through `bounds`, as a ray that starts outside.
fn line(bounds: &Aabb, random: &mut Pcg32) -> Ray {
    let (entry, dir, size) = through_box(bounds, random).unwrap_or_else(|| around(bounds, random));
    Ray::new((entry - dir * size).as_vec3(), dir.as_vec3())
}

/// Entry point, direction and the box's diagonal; `None` where the box has no area.
fn through_box(bounds: &Aabb, random: &mut Pcg32) -> Option<(DVec3, DVec3, f64)> {
    if bounds.is_empty() {
        return None;
    }
    let min = bounds.min.as_dvec3();
    let extent = bounds.max.as_dvec3() - min;
    // Areas of the faces across x, y and z; f64 holds the squares of all f32 extents.
    let areas = DVec3::new(
        extent.y * extent.z,
        extent.z * extent.x,
        extent.x * extent.y,
    );
    let total = areas.element_sum();
    if total <= 0.0 {
        return None;
    }
    let mut pick = unit(random) * total;
    let mut axis = 0;
    // The last face with an area takes what rounding leaves over.
    while axis < 2 && (pick >= areas[axis] && areas.to_array()[axis + 1..].iter().any(|a| *a > 0.0))
    {
        pick -= areas[axis];
        axis += 1;
    }
    let upper = random.next_u32() & 1 == 1;
    let mut entry = min + extent * DVec3::from_array([(); 3].map(|()| unit(random)));
    entry[axis] = min[axis] + if upper { extent[axis] } else { 0.0 };
    let mut inwards = DVec3::ZERO;
    inwards[axis] = if upper { -1.0 } else { 1.0 };
    Some((entry, cosine_direction(random, inwards), extent.length()))
}

/// A uniform line through the sphere around a box without area.
fn around(bounds: &Aabb, random: &mut Pcg32) -> (DVec3, DVec3, f64) {
    let (centre, radius) = if bounds.is_empty() {
        (DVec3::ZERO, 1.0)
    } else {
        let half = bounds.extent().as_dvec3().length() * 0.5;
        // A single point: any size will do that survives rounding there.
        let least = f64::from(bounds.max_abs().max(1.0)) * 1e-3;
        (bounds.centre().as_dvec3(), half.max(least))
    };
    let normal = direction(random);
    let entry = centre - normal * radius;
    (entry, cosine_direction(random, normal), 2.0 * radius)
}

#[cfg(test)]
mod tests {
    use super::super::{fixture, ray_set};
    use super::*;
    use crate::geometry::Vec3;

    /// Length of the chord of `ray` in `bounds`, by clipping in f64; `None` where it misses.
    fn chord(ray: &Ray, bounds: &Aabb) -> Option<f64> {
        let (mut entry, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            let inverse = 1.0 / f64::from(ray.dir[axis]);
            let near = f64::from(bounds.min[axis] - ray.origin[axis]) * inverse;
            let far = f64::from(bounds.max[axis] - ray.origin[axis]) * inverse;
            entry = entry.max(near.min(far));
            exit = exit.min(near.max(far));
        }
        (entry <= exit && exit >= 0.0).then_some(exit - entry)
    }

    #[test]
    fn the_mean_chord_is_four_volumes_by_the_surface() {
        // Cauchy and Crofton: the mean chord of uniform lines through a convex body is 4V/S; other measures differ.
        let bounds = Aabb {
            min: Vec3::ZERO,
            max: Vec3::new(1.0, 2.0, 4.0),
        };
        let mut random = generator(5, 1);
        let chords: Vec<f64> = (0..40_000)
            .filter_map(|_| chord(&line(&bounds, &mut random), &bounds))
            .collect();
        assert!(chords.len() > 39_900, "{} lines meet the box", chords.len());
        let mean = chords.iter().sum::<f64>() / chords.len() as f64;
        assert!((mean / (4.0 * 8.0 / 28.0) - 1.0).abs() < 0.02, "{mean}");
    }

    #[test]
    fn every_line_starts_outside_the_box() {
        let scene = fixture::room();
        let bounds = scene.mesh.bounds();
        for ray in ray_set(&scene, "random", 2000, 1).unwrap().rays {
            let outside = ray.origin.cmplt(bounds.min).any() || ray.origin.cmpgt(bounds.max).any();
            assert!(outside);
        }
    }

    #[test]
    fn flat_and_point_boxes_have_lines_too() {
        let mut random = generator(5, 1);
        let flat = Aabb::of_points([Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)]);
        for _ in 0..1000 {
            let ray = line(&flat, &mut random);
            let t = -ray.origin.z / ray.dir.z;
            let p = ray.at(t);
            assert!(p.x > -1e-4 && p.x < 1.0001 && p.y > -1e-4 && p.y < 1.0001);
        }
        let point = Aabb::of_points([Vec3::splat(1e6)]);
        assert!(line(&point, &mut random).is_valid());
    }
}
