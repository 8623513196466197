//! Where secondary rays start: a hit point with the bound within which it is known.
//!
//! ```text
//!          origin ●───▶ dir        moved along the normal by the bound, then rounded away from the surface
//!                 │ offset
//!   ──────────────●─────────────   hit point, computed in f64 from the barycentric weights
//! ```
//!
//! **Source:** Pharr, Jakob and Humphreys, "Physically Based Rendering" 4th ed., §6.8.6 "Robust spawned ray origins":
//! the offset follows from an error bound, never from a fixed epsilon.
//! **Differs:** the point is computed in f64 and each component is rounded away from the surface, so the position itself
//! has no error; the bound covers what an f32 kernel commits when it meets the same triangle again: γ(7) of the
//! coordinates (methods that work in world space) and γ(16) of the longest edge (methods relative to the origin).

use crate::geometry::{DVec3, Hit, Ray, Vec3, gamma};
use crate::scene::Mesh;

/// A point on a triangle, and how far from it a ray must start not to meet that triangle again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// The point.
    pub position: DVec3,
    /// Unit normal of the triangle, on the side that the ray came from.
    pub normal: DVec3,
    /// Distance along the normal beyond which a kernel in f32 sees a point on the right side.
    pub offset: f64,
}

impl SurfacePoint {
    /// The point that `hit` of `ray` names; `None` for a miss and for a triangle without area, which has no normal.
    #[must_use]
    pub fn new(mesh: &Mesh, ray: &Ray, hit: &Hit) -> Option<Self> {
        if !hit.is_hit() {
            return None;
        }
        let [a, b, c] = mesh.corners(hit.prim).map(Vec3::as_dvec3);
        let (u, v) = (f64::from(hit.u), f64::from(hit.v));
        let cross = (b - a).cross(c - a);
        // The length, scaled first: squares of the smallest f32 areas vanish even in f64.
        let scale = cross.abs().max_element();
        let unit = (cross / scale).try_normalize()?;
        let normal = if unit.dot(ray.dir.as_dvec3()) > 0.0 {
            -unit
        } else {
            unit
        };
        let weighted = a.abs() * (1.0 - u - v).abs() + b.abs() * u.abs() + c.abs() * v.abs();
        let edge = [b - a, c - b, a - c]
            .iter()
            .fold(0.0_f64, |longest, e| longest.max(e.abs().max_element()));
        Some(Self {
            position: a * (1.0 - u - v) + b * u + c * v,
            normal,
            offset: normal.abs().dot(weighted) * f64::from(gamma(7)) + edge * f64::from(gamma(16)),
        })
    }

    /// The origin of a ray that leaves the surface along `dir`: the point, moved to the side of `dir`.
    #[must_use]
    pub fn leave(&self, dir: DVec3) -> Vec3 {
        let side = if self.normal.dot(dir) < 0.0 {
            -self.normal
        } else {
            self.normal
        };
        let moved = self.position + side * self.offset;
        Vec3::from_array(std::array::from_fn(|axis| {
            round_towards(moved[axis], side[axis])
        }))
    }

    /// The ray that leaves the surface along `dir`, without an end.
    #[must_use]
    pub fn ray_along(&self, dir: DVec3) -> Ray {
        Ray::new(self.leave(dir), dir.as_vec3())
    }

    /// The ray from the surface to `target` with `t` from 0 to almost 1: it ends before `target` by the bound within
    /// which that point is known, so what `target` lies on does not block it. `None` where nothing is left between.
    #[must_use]
    pub fn ray_to(&self, target: Vec3) -> Option<Ray> {
        let origin = self.leave(target.as_dvec3() - self.position);
        let dir = target - origin;
        let length = dir.as_dvec3().length();
        let error = target.as_dvec3().abs().element_sum() * f64::from(gamma(7))
            + length * f64::from(gamma(16));
        let t_max = round_towards(1.0 - error / length, -1.0);
        // A NaN (no distance at all) is no ray either.
        (t_max > 0.0).then_some(Ray {
            t_max,
            ..Ray::new(origin, dir)
        })
    }
}

/// The nearest f32 to `x`, or its neighbour where that lies on the wrong side of `x`: never below for a positive
/// `sign`, never above for a negative one.
fn round_towards(x: f64, sign: f64) -> f32 {
    let nearest = x as f32;
    if sign > 0.0 && f64::from(nearest) < x {
        nearest.next_up()
    } else if sign < 0.0 && f64::from(nearest) > x {
        nearest.next_down()
    } else {
        nearest
    }
}

#[cfg(test)]
mod tests {
    use super::super::{closest, fixture, ray_set};
    use super::*;

    #[test]
    fn rounding_goes_the_way_it_is_told() {
        let third = 1.0 / 3.0;
        assert!(f64::from(round_towards(third, 1.0)) > third);
        assert!(f64::from(round_towards(third, -1.0)) < third);
        assert_eq!(round_towards(0.5, 1.0), 0.5);
    }

    #[test]
    fn no_ray_meets_the_triangle_that_it_starts_from_at_any_offset_of_the_scene() {
        for offset in [0.0, 1e2, 1e4, 1e6] {
            let scene = fixture::moved(&fixture::room(), Vec3::new(offset, -offset, offset));
            let brute = fixture::brute(&scene);
            let rays = ray_set(&scene, "random", 4000, 1).unwrap().rays;
            let hits = closest(&*brute, &rays);
            let mut random = super::super::sample::generator(9, 9);
            let mut checked = 0;
            for (ray, hit) in rays.iter().zip(&hits) {
                let Some(point) = SurfacePoint::new(&scene.mesh, ray, hit) else {
                    continue;
                };
                let dir = super::super::sample::cosine_direction(&mut random, point.normal);
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
                let point = SurfacePoint::new(&scene.mesh, ray, &hit).unwrap();
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
        assert_eq!(SurfacePoint::new(&scene.mesh, &ray, &Hit::MISS), None);
        let hit = Hit {
            t: 1.0,
            u: 0.2,
            v: 0.2,
            prim: 0,
        };
        assert_eq!(SurfacePoint::new(&scene.mesh, &ray, &hit), None);
    }
}
