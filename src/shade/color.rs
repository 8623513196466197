//! The channel `color`: the scene's materials in its light.
//!
//! ```text
//!   eye ──> closest hits ──> surfaces ──> for each light that can matter: shadow rays ──> light ──> sRGB
//! ```
//!
//! Without lights it is Lambert with a head light: the eye sees no shadow of a light that it carries, so no further ray
//! is traced. With lights, a shadow ray goes out only where its light faces the side that is seen and the material
//! reflects some of it.

use crate::accel::Accelerator;
use crate::geometry::{Hit, Ray, SurfacePoint, Vec3};
use crate::scene::Scene;

use super::channel::{Channel, Painter};
use super::image::to_srgb;
use super::light::{Exposure, Surface, head_light, incoming};
use super::model::Model;
use super::normal::facing_normal;
use super::render::RayCounts;

pub(super) const CHANNEL: Channel = Channel {
    name: "color",
    about: "The scene's materials in its light, with no more model than they need.",
    paint: |view| {
        let shader = Shader {
            scene: view.scene,
            accel: view.accel,
            exposure: Exposure::of(view.scene),
        };
        Painter::Colours {
            tile: Box::new(move |rays, counts| shader.tile(rays, counts)),
            found: Model::of(view.scene).describe(),
        }
    },
};

/// Colours rays.
struct Shader<'a> {
    scene: &'a Scene,
    accel: &'a dyn Accelerator,
    exposure: Exposure,
}

/// Light that reaches the eye unless something stands in the way of its shadow ray.
struct Shadowed {
    /// Index of the pixel in its tile.
    pixel: usize,
    /// Linear RGB.
    light: Vec3,
}

impl Shader<'_> {
    /// The colour of each ray's pixel.
    fn tile(&self, rays: &[Ray], counts: &mut RayCounts) -> Vec<[u8; 3]> {
        let mut hits = vec![Hit::MISS; rays.len()];
        self.accel.closest(rays, &mut hits);
        counts.primary += rays.len() as u64;

        // What each pixel gets by itself, and the shadow rays that decide about the rest.
        let mut light = vec![Vec3::ZERO; rays.len()];
        let mut shadows = Vec::new();
        let mut shadow_rays = Vec::new();
        for (pixel, (ray, hit)) in rays.iter().zip(&hits).enumerate() {
            if hit.is_hit() {
                counts.hits += 1;
                light[pixel] = self.surface_light(ray, hit, &mut |ray, light| {
                    shadows.push(Shadowed { pixel, light });
                    shadow_rays.push(ray);
                });
            }
        }
        let mut blocked = vec![false; shadow_rays.len()];
        self.accel.occluded(&shadow_rays, &mut blocked);
        counts.shadow += shadow_rays.len() as u64;
        for (shadow, _) in (shadows.iter().zip(&blocked)).filter(|(_, blocked)| !**blocked) {
            light[shadow.pixel] += shadow.light;
        }

        let colour = |(hit, &light): (&Hit, &Vec3)| {
            to_srgb(if hit.is_hit() {
                self.exposure.brightness(light)
            } else {
                self.scene.background
            })
        };
        hits.iter().zip(&light).map(colour).collect()
    }

    /// What a hit sends to the eye whatever the shadows: its own light, the head light, the fill. Light that a shadow
    /// may take goes to `shadowed`, with the ray that decides.
    fn surface_light(&self, ray: &Ray, hit: &Hit, shadowed: &mut impl FnMut(Ray, Vec3)) -> Vec3 {
        let mesh = &self.scene.mesh;
        let point = SurfacePoint::of(&mesh.corners(hit.prim), hit.u, hit.v);
        let surface = Surface {
            material: self.scene.material(hit.prim),
            position: point.position,
            normal: facing_normal(mesh, hit.prim, ray.dir),
            to_eye: -ray.dir.normalize_or_zero(),
        };
        let own = surface.material.emission;
        // MTL's model 0 is the diffuse colour, whatever the light.
        if surface.material.illum == 0 && !self.scene.lights.is_empty() {
            return own + surface.material.diffuse / self.exposure.scale;
        }
        if self.scene.lights.is_empty() {
            return own + head_light(&surface);
        }
        for light in &self.scene.lights {
            if let Some(incoming) = incoming(&surface, light) {
                let origin = point.start(surface.normal, incoming.towards);
                let ray = Ray {
                    origin,
                    t_min: 0.0,
                    dir: light.position - origin,
                    // Up to the light, not into what it hangs from.
                    t_max: 1.0_f32.next_down(),
                };
                if ray.is_valid() {
                    shadowed(ray, incoming.reflected);
                }
            }
        }
        own + (surface.material.diffuse * 0.4 + head_light(&surface) * 0.6) * self.exposure.fill
    }
}
