//! `grazing`: rays that meet triangles at slopes of 1/2 down to 2⁻²⁰: where `t` and the edges are hardest to tell.
//!
//! ```text
//!   ●──__                         slope 2⁻ᵏ against the plane, k = 1 … 20 in turn
//!        ──__
//!   ═════════p═════   p: uniform in a triangle; all triangles with an area are equally likely
//! ```
//!
//! Each ray starts one diagonal of the box before its point, so outside the box.

use rand_core::Rng;
use rand_pcg::Pcg32;

use crate::geometry::{DVec3, Ray, Vec3, unit_normal};
use crate::scene::Mesh;

use super::edge::diagonal;
use super::sample::{direction, generator, unit};
use super::{Query, RaySetEntry, Rays};

pub(super) const ENTRY: RaySetEntry = RaySetEntry {
    name: "grazing",
    about: "Rays from outside that meet triangles at slopes of 1/2 down to 2^-20, in turn.",
    query: Query::Closest,
    argument: "",
    params: &[],
    make: |request| {
        let mesh = &request.scene.mesh;
        let with_area: Vec<(u32, DVec3)> = (0..mesh.len() as u32)
            .filter_map(|prim| Some((prim, unit_normal(&mesh.corners(prim))?.as_dvec3())))
            .collect();
        if with_area.is_empty() {
            return Ok(Rays {
                rays: Vec::new(),
                warnings: vec!["no triangle has an area, so 'grazing' has no rays".to_owned()],
            });
        }
        let mut random = generator(request.seed, 5);
        let rays = (0..request.count)
            .map(|i| {
                let pick = (u64::from(random.next_u32()) * with_area.len() as u64) >> 32;
                let (prim, normal) = with_area[pick as usize];
                let slope = 0.5_f64.powi(1 + (i % SLOPES) as i32);
                grazing(mesh, prim, normal, slope, &mut random)
            })
            .collect();
        Ok(Rays {
            rays,
            warnings: Vec::new(),
        })
    },
};

/// Slopes 2⁻¹ to 2⁻²⁰: below them, the rounding of an origin decides alone.
const SLOPES: usize = 20;

/// A ray at a uniform point of a triangle with this unit normal, from either side.
fn grazing(mesh: &Mesh, prim: u32, normal: DVec3, slope: f64, random: &mut Pcg32) -> Ray {
    let [a, b, c] = mesh.corners(prim).map(Vec3::as_dvec3);
    let [u, v] = [(); 2].map(|()| unit(random));
    // Points beyond the diagonal of the parallelogram are turned back into the triangle.
    let (u, v) = if u + v > 1.0 {
        (1.0 - u, 1.0 - v)
    } else {
        (u, v)
    };
    let target = a + (b - a) * u + (c - a) * v;
    let free = direction(random);
    let tangent = free - normal * free.dot(normal);
    let side = if free.dot(normal) < 0.0 {
        -normal
    } else {
        normal
    };
    let dir = (tangent.normalize_or(normal.any_orthonormal_vector()) + side * slope).normalize();
    Ray::new((target - dir * diagonal(mesh)).as_vec3(), dir.as_vec3())
}

#[cfg(test)]
mod tests {
    use super::super::{fixture, ray_set};
    use crate::geometry::{Ray, unit_normal};

    #[test]
    fn slopes_halve_from_ray_to_ray_and_begin_again_after_twenty() {
        let scene = fixture::floor_and_ceiling();
        // Both squares lie across y.
        assert_eq!(unit_normal(&scene.mesh.corners(0)).unwrap().y.abs(), 1.0);
        let rays = ray_set(&scene, "grazing", 200, 1).unwrap().rays;
        for (i, ray) in rays.iter().enumerate() {
            let flat = ray.dir.x.hypot(ray.dir.z);
            let slope = ray.dir.y.abs() / flat;
            let expected = 0.5_f32.powi(1 + (i % 20) as i32);
            assert!((slope / expected - 1.0).abs() < 1e-3, "{i}: {slope}");
        }
        assert!(rays.iter().any(|r| r.dir.y > 0.0) && rays.iter().any(|r| r.dir.y < 0.0));
    }

    #[test]
    fn every_ray_starts_outside_the_box() {
        let scene = fixture::room();
        let bounds = scene.mesh.bounds();
        let outside =
            |ray: &Ray| ray.origin.cmplt(bounds.min).any() || ray.origin.cmpgt(bounds.max).any();
        assert!(
            ray_set(&scene, "grazing", 500, 1)
                .unwrap()
                .rays
                .iter()
                .all(outside)
        );
    }

    #[test]
    fn triangles_without_area_are_left_alone() {
        let set = ray_set(&fixture::degenerate(), "grazing", 10, 1).unwrap();
        assert!(set.rays.is_empty() && set.warnings[0].contains("no triangle has an area"));
    }
}
