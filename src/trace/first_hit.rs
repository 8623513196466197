//! Where secondary rays start: the points at which the camera's rays meet the scene.
//!
//! Starts keep the distance from the surface that [`SurfacePoint`] derives from an error bound; shadow rays keep a
//! distance from their target, too.

use crate::accel;
use crate::geometry::{Hit, Ray, SurfacePoint, Vec3, gamma, unit_normal};
use crate::kernel;
use crate::scene::{Mesh, Scene};

use super::{RayError, closest, primary};

/// A point where a ray met a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FirstHit {
    point: SurfacePoint,
    /// Unit normal of the triangle, on the side that the ray came from.
    pub normal: Vec3,
}

impl FirstHit {
    /// The point that `hit` of `ray` names; `None` for a miss and for a triangle without area, which has no normal.
    pub fn new(mesh: &Mesh, ray: &Ray, hit: &Hit) -> Option<Self> {
        if !hit.is_hit() {
            return None;
        }
        let corners = mesh.corners(hit.prim);
        let normal = unit_normal(&corners)?;
        // In f64: the product of a tiny direction would vanish in f32.
        let behind = normal.as_dvec3().dot(ray.dir.as_dvec3()) > 0.0;
        Some(Self {
            point: SurfacePoint::of(&corners, hit.u, hit.v),
            normal: if behind { -normal } else { normal },
        })
    }

    /// The ray that leaves the surface along `dir`, without an end.
    pub fn ray_along(&self, dir: Vec3) -> Ray {
        Ray::new(self.point.start(self.normal, dir), dir)
    }

    /// The ray from the surface to `target` with `t` from 0 to almost 1: it ends before `target` by the bound within
    /// which that point is known, so what `target` lies on does not block it. `None` where nothing is left between.
    pub fn ray_to(&self, target: Vec3) -> Option<Ray> {
        let origin = self.point.start(self.normal, target - self.point.position);
        let dir = target - origin;
        let length = dir.as_dvec3().length();
        // γ(7) of the coordinates: the target, rounded, and the kernel's view of what it lies on. γ(16) of the
        // distance: what a kernel rounds in t.
        let error = target.as_dvec3().abs().element_sum() * f64::from(gamma(7))
            + length * f64::from(gamma(16));
        let t_max = (1.0 - error / length) as f32;
        // A NaN (no distance at all) is no ray either.
        (t_max > 0.0).then_some(Ray {
            t_max,
            ..Ray::new(origin, dir)
        })
    }
}

/// Where the rays of the camera's picture of at most `count` pixels meet the scene, in the picture's tile order.
///
/// The hits are those of the kernel `woop`; misses and triangles without area are left out.
///
/// # Errors
/// The structure that finds them was not built.
pub(super) fn first_hits(scene: &Scene, count: usize) -> Result<Vec<FirstHit>, RayError> {
    let (width, height) = primary::picture_size(count);
    let mut rays = primary::rays(&scene.camera, width, height);
    rays.retain(Ray::is_valid);
    let kernel = kernel::parse("woop")?;
    let accel = accel::parse("bvh").or_else(|_| accel::parse("brute"))?;
    let structure = accel::build(&scene.mesh, &accel, None, &kernel, u64::MAX)?;
    let hits = closest(&*structure, &rays);
    Ok(rays
        .iter()
        .zip(&hits)
        .filter_map(|(ray, hit)| FirstHit::new(&scene.mesh, ray, hit))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::super::sample::cosine_direction;
    use super::super::sample::generator;
    use super::super::{fixture, ray_set};
    use super::*;

    #[test]
    fn no_ray_meets_the_triangle_that_it_starts_from_at_any_offset_of_the_scene() {
        for offset in [0.0, 1e2, 1e4, 1e6] {
            let scene = fixture::moved(&fixture::room(), Vec3::new(offset, -offset, offset));
            let brute = fixture::brute(&scene);
            let rays = ray_set(&scene, "random", 4000, 1).unwrap().rays;
            let hits = closest(&*brute, &rays);
            let mut random = generator(9, 9);
            let mut checked = 0;
            for (ray, hit) in rays.iter().zip(&hits) {
                let Some(point) = FirstHit::new(&scene.mesh, ray, hit) else {
                    continue;
                };
                let dir = cosine_direction(&mut random, point.normal.as_dvec3()).as_vec3();
                for away in [point.ray_along(dir), point.ray_along(-dir)] {
                    let again = closest(&*brute, &[away])[0];
                    assert_ne!(again.prim, hit.prim, "offset {offset}: {away:?} {again:?}");
                }
                checked += 1;
            }
            assert!(checked > 1000);
        }
    }

    #[test]
    fn a_ray_to_a_point_on_a_surface_is_not_blocked_by_that_surface() {
        for offset in [0.0, 1e2, 1e4] {
            let scene = fixture::moved(&fixture::floor_and_ceiling(), Vec3::splat(offset));
            let brute = fixture::brute(&scene);
            let rays = ray_set(&scene, "primary", 300, 1).unwrap().rays;
            let lamp = scene.mesh.triangle_bounds(2).centre();
            let mut checked = 0;
            for (ray, hit) in rays.iter().zip(closest(&*brute, &rays)) {
                if hit.prim > 1 {
                    continue;
                }
                let point = FirstHit::new(&scene.mesh, ray, &hit).unwrap();
                let to_lamp = point.ray_to(lamp).unwrap();
                assert!(!closest(&*brute, &[to_lamp])[0].is_hit(), "offset {offset}");
                checked += 1;
            }
            assert!(checked > 50, "{checked}");
        }
    }

    #[test]
    fn misses_and_triangles_without_area_have_no_point() {
        let scene = fixture::degenerate();
        let ray = Ray::new(Vec3::NEG_Z, Vec3::Z);
        assert_eq!(FirstHit::new(&scene.mesh, &ray, &Hit::MISS), None);
        let hit = Hit {
            t: 1.0,
            u: 0.2,
            v: 0.2,
            prim: 0,
        };
        assert_eq!(FirstHit::new(&scene.mesh, &ray, &hit), None);
    }
}
