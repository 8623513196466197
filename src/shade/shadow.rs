//! Shadow rays: whether light reaches a surface, and how much of it where glass stands in the way.

use crate::accel::Accelerator;
use crate::geometry::{Hit, Ray, SurfacePoint, Vec3, unit_normal};
use crate::scene::{Light, Scene};

use super::light::Surface;
use super::render::RayCounts;
use super::scatter::transmits;

/// Light that reaches a pixel unless something stands in the way of its ray.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shadow {
    /// Index of the pixel in its tile.
    pub pixel: usize,
    /// Linear RGB, as it reaches the pixel.
    pub light: Vec3,
    /// From the surface to the light.
    pub ray: Ray,
}

/// Most panes of glass between a surface and a light; behind more of them it is dark.
const MOST_PANES: usize = 16;

/// The ray from `surface` to `light`, which lies in the direction `towards`.
pub(super) fn ray(surface: &Surface, light: &Light, towards: Vec3) -> Ray {
    to_light(surface.point.start(surface.normal, towards), light.position)
}

/// The ray from `origin` up to a light, not into what it hangs from.
fn to_light(origin: Vec3, light: Vec3) -> Ray {
    Ray {
        origin,
        t_min: 0.0,
        dir: light - origin,
        t_max: 1.0_f32.next_down(),
    }
}

/// Adds the light of those `shadows` that nothing stands in the way of to `light`, pixel by pixel in their order.
///
/// `through`: whether glass may stand in the way, which dims light by its filter. Without glass both give the same.
pub(super) fn cast(
    scene: &Scene,
    accel: &dyn Accelerator,
    mut shadows: Vec<Shadow>,
    through: bool,
    light: &mut [Vec3],
    counts: &mut RayCounts,
) {
    // A light in the very point of a surface has no direction.
    shadows.retain(|shadow| shadow.ray.is_valid());
    counts.shadow += shadows.len() as u64;
    let rays: Vec<Ray> = shadows.iter().map(|shadow| shadow.ray).collect();
    let arriving = if through {
        let mut filters = vec![Vec3::ONE; rays.len()];
        filter(scene, accel, &rays, &mut filters, counts);
        filters
    } else {
        let mut blocked = vec![false; rays.len()];
        accel.occluded(&rays, &mut blocked);
        let share = |blocked| if blocked { Vec3::ZERO } else { Vec3::ONE };
        blocked.into_iter().map(share).collect()
    };
    for (shadow, share) in shadows.iter().zip(arriving) {
        light[shadow.pixel] += shadow.light * share;
    }
}

/// Sets each ray's filter to what all panes of glass on its way let through; black where something opaque stands.
fn filter(
    scene: &Scene,
    accel: &dyn Accelerator,
    rays: &[Ray],
    filters: &mut [Vec3],
    counts: &mut RayCounts,
) {
    let mut open: Vec<(usize, Ray)> = rays.iter().copied().enumerate().collect();
    for pane in 0..=MOST_PANES {
        if open.is_empty() {
            return;
        }
        counts.shadow += if pane > 0 { open.len() as u64 } else { 0 };
        let batch: Vec<Ray> = open.iter().map(|(_, ray)| *ray).collect();
        let mut hits = vec![Hit::MISS; batch.len()];
        accel.closest(&batch, &mut hits);
        let mut further = Vec::new();
        for ((index, ray), hit) in open.into_iter().zip(hits) {
            if !hit.is_hit() {
                continue;
            }
            let material = scene.material(hit.prim);
            let beyond = beyond(scene, &ray, &hit);
            if transmits(material) && pane < MOST_PANES && beyond.is_valid() {
                filters[index] *= material.transmission;
                further.push((index, beyond));
            } else {
                filters[index] = Vec3::ZERO;
            }
        }
        open = further;
    }
}

/// The rest of `ray` behind the triangle that it hits.
fn beyond(scene: &Scene, ray: &Ray, hit: &Hit) -> Ray {
    let corners = scene.mesh.corners(hit.prim);
    let normal = unit_normal(&corners).unwrap_or(ray.dir);
    let origin = SurfacePoint::of(&corners, hit.u, hit.v).start(normal, ray.dir);
    to_light(origin, ray.origin + ray.dir)
}
