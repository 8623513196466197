//! The channel `color`: the scene's materials in its light.
//!
//! ```text
//!   rays ──> closest hits ──> surfaces ──> own light, fill, head light ────────────────────> light of the pixel
//!     ^                         │  └─────> lights that can matter ──> shadow rays ──────────────^
//!     └── the next generation <─┘ only from mirrors and glass, while the pixel can change
//! ```
//!
//! Without lights it is Lambert with a head light: the eye sees no shadow of a light that it carries, so no further ray
//! is traced. With lights, a shadow ray goes out only where its light faces the side that is seen and the material
//! reflects some of it. Reflected and refracted rays start only at materials that mirror or transmit, and only while
//! they can change the pixel by half a step of its 256 levels.
//!
//! **Source:** Whitted, "An improved illumination model for shaded display" (1980).
//! **Differs:** a tile's rays go on together, generation by generation; shadow rays pass through glass, dimmed but not
//! bent, so glass throws no black shadow and no caustic.

use crate::accel::Accelerator;
use crate::geometry::{Hit, Ray, SurfacePoint, Vec3};
use crate::scene::Scene;

use super::channel::{Channel, Painter};
use super::image::to_srgb;
use super::light::{Exposure, Surface, head_light, incoming};
use super::model::Model;
use super::normal::facing_normal;
use super::render::RayCounts;
use super::scatter::{Way, transmits, ways};
use super::shadow::{self, Shadow};

pub(super) const CHANNEL: Channel = Channel {
    name: "color",
    about: "The scene's materials in its light, with no more model than they need.",
    paint: |view| {
        let model = Model::of(view.scene);
        let shader = Shader::new(view.scene, view.accel, model);
        Painter::Colours {
            tile: Box::new(move |rays, counts| shader.tile(rays, counts)),
            found: model.describe(),
        }
    },
};

/// Most generations of a ray: two perfect mirrors that face each other would never end.
const MOST_GENERATIONS: usize = 32;

/// A pixel that changes by less than this, of 1, shows the same byte or the next one.
const HALF_STEP: f32 = 0.5 / 256.0;

/// Colours rays.
pub(super) struct Shader<'a> {
    scene: &'a Scene,
    accel: &'a dyn Accelerator,
    model: Model,
    exposure: Exposure,
    /// Shares of light below this cannot change a pixel.
    least_share: f32,
}

/// A ray on its way from a pixel.
#[derive(Clone, Copy)]
struct Path {
    /// The ray.
    ray: Ray,
    /// Index of the pixel in its tile.
    pixel: usize,
    /// Share of what the ray sees that reaches the pixel.
    share: Vec3,
    /// Whether it runs within glass.
    inside: bool,
}

impl<'a> Shader<'a> {
    /// Prepares to colour `scene` by `model`, which covers at least what the scene needs.
    pub fn new(scene: &'a Scene, accel: &'a dyn Accelerator, model: Model) -> Self {
        let exposure = Exposure::of(scene);
        let brightest = (scene.materials.iter())
            .map(|material| material.emission.max_element() * exposure.scale)
            .fold(1.0, f32::max);
        Self {
            scene,
            accel,
            model,
            exposure,
            least_share: HALF_STEP / brightest,
        }
    }

    /// The colour of each ray's pixel.
    pub fn tile(&self, rays: &[Ray], counts: &mut RayCounts) -> Vec<[u8; 3]> {
        let path = |(pixel, &ray)| Path {
            ray,
            pixel,
            share: Vec3::ONE,
            inside: false,
        };
        counts.primary += rays.len() as u64;
        let mut light = vec![Vec3::ZERO; rays.len()];
        let mut seen = vec![false; rays.len()];
        let mut paths: Vec<Path> = rays.iter().enumerate().map(path).collect();
        for generation in 0..MOST_GENERATIONS {
            if paths.is_empty() {
                break;
            }
            let hits = self.closest(&paths);
            if generation == 0 {
                for (seen, hit) in seen.iter_mut().zip(&hits) {
                    *seen = hit.is_hit();
                    counts.hits += u64::from(hit.is_hit());
                }
            }
            paths = self.generation(&paths, &hits, &mut light, counts);
        }
        let colour = |(&seen, &light): (&bool, &Vec3)| {
            to_srgb(if seen {
                self.exposure.brightness(light)
            } else {
                self.scene.background
            })
        };
        seen.iter().zip(&light).map(colour).collect()
    }

    fn closest(&self, paths: &[Path]) -> Vec<Hit> {
        let rays: Vec<Ray> = paths.iter().map(|path| path.ray).collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        self.accel.closest(&rays, &mut hits);
        hits
    }

    /// Adds what `paths` see to the light of their pixels; returns the paths that go on.
    fn generation(
        &self,
        paths: &[Path],
        hits: &[Hit],
        light: &mut [Vec3],
        counts: &mut RayCounts,
    ) -> Vec<Path> {
        let mut shadows = Vec::new();
        let mut next = Vec::new();
        for (path, hit) in paths.iter().zip(hits) {
            if hit.is_hit() {
                let surface = Surface::at(self.scene, &path.ray, hit);
                light[path.pixel] += path.share * self.unshadowed(&surface);
                self.ask_lights(path, &surface, &mut shadows);
                if self.model.mirror || self.model.glass {
                    self.go_on(path, &surface, &mut next, counts);
                }
            } else {
                // A background is a brightness on the screen, not light: a mirror shows it as the eye does.
                light[path.pixel] += path.share * self.scene.background / self.exposure.scale;
            }
        }
        let through = self.model.glass;
        shadow::cast(self.scene, self.accel, shadows, through, light, counts);
        next
    }

    /// What a surface sends whatever the shadows: its own light, the head light, the fill.
    fn unshadowed(&self, surface: &Surface) -> Vec3 {
        let material = surface.material;
        let reflected = if self.scene.lights.is_empty() {
            head_light(surface)
        } else if material.illum == 0 {
            // MTL's model 0 is the diffuse colour, whatever the light.
            material.diffuse / self.exposure.scale
        } else {
            (material.diffuse * 0.4 + head_light(surface) * 0.6) * self.exposure.fill
        };
        material.emission + reflected
    }

    /// Sends a shadow ray to each light that can matter.
    fn ask_lights(&self, path: &Path, surface: &Surface, shadows: &mut Vec<Shadow>) {
        if surface.material.illum == 0 {
            return;
        }
        for light in &self.scene.lights {
            if let Some(incoming) = incoming(surface, light) {
                shadows.push(Shadow {
                    pixel: path.pixel,
                    light: path.share * incoming.reflected,
                    ray: shadow::ray(surface, light, incoming.towards),
                });
            }
        }
    }

    /// Sends on what the material mirrors and transmits.
    fn go_on(&self, path: &Path, surface: &Surface, next: &mut Vec<Path>, counts: &mut RayCounts) {
        let mut send = |way: Way, inside: bool, count: &mut u64| {
            let origin = surface.point.start(surface.normal, way.dir);
            let path = Path {
                ray: Ray::new(origin, way.dir),
                pixel: path.pixel,
                share: path.share * way.share,
                inside,
            };
            if path.share.max_element() >= self.least_share && path.ray.is_valid() {
                *count += 1;
                next.push(path);
            }
        };
        let glass = transmits(surface.material);
        let ways = ways(
            surface.material,
            surface.normal,
            -surface.to_eye,
            path.inside,
        );
        if let Some(way) = ways.reflected {
            send(way, path.inside, &mut counts.reflected);
        }
        if let Some(way) = ways.refracted {
            send(way, glass != path.inside, &mut counts.refracted);
        }
    }
}

impl<'a> Surface<'a> {
    /// The surface that `ray` hits.
    fn at(scene: &'a Scene, ray: &Ray, hit: &Hit) -> Self {
        let point = SurfacePoint::of(&scene.mesh.corners(hit.prim), hit.u, hit.v);
        Self {
            material: scene.material(hit.prim),
            point,
            normal: facing_normal(&scene.mesh, hit.prim, ray.dir),
            to_eye: -ray.dir.normalize_or_zero(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, Light, Material, Mesh};
    use crate::shade::{View, channel, render};

    /// A white floor at y = 0, lit from above, and an upright pane at z = 0 of `material`; the eye looks along −z.
    fn pane(material: Material) -> Scene {
        let floor = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)];
        let floor = floor.map(|(x, z)| Vec3::new(x, 0.0, z));
        let pane = [(-9.0, 0.0), (9.0, 0.0), (9.0, 9.0), (-9.0, 9.0)];
        let pane = pane.map(|(x, y)| Vec3::new(x, y, 0.0));
        let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        let mut scene = crate::scene::load("one").unwrap();
        scene.mesh = Mesh::new([floor, pane].concat(), triangles).unwrap().into();
        scene.materials = vec![Material::default(), material];
        scene.material_of = vec![0, 0, 1, 1];
        scene.lights = vec![Light {
            position: Vec3::new(0.0, 8.0, 3.0),
            intensity: Vec3::splat(64.0),
        }];
        scene.background = Vec3::ZERO;
        scene.camera = Camera {
            eye: Vec3::new(0.0, 2.0, 6.0),
            at: Vec3::new(0.0, 1.5, 0.0),
            up: Vec3::Y,
            fov_deg: 30.0,
        };
        scene
    }

    fn rendered(scene: &Scene) -> crate::shade::Rendered {
        let accel = brute(scene);
        render(&View {
            scene,
            camera: &scene.camera,
            accel: &*accel,
            channel: channel("color").unwrap(),
            width: 31,
            height: 31,
        })
    }

    fn brute(scene: &Scene) -> Box<dyn Accelerator> {
        let accel = crate::accel::parse("brute").unwrap();
        let kernel = crate::kernel::parse("moller-trumbore").unwrap();
        crate::accel::build(&scene.mesh, &accel, None, &kernel, u64::MAX).unwrap()
    }

    fn black(illum: u8, specular: f32) -> Material {
        Material {
            diffuse: Vec3::ZERO,
            specular: Vec3::splat(specular),
            shininess: 1e6,
            refraction_index: 1.0,
            illum,
            ..Material::default()
        }
    }

    #[test]
    fn a_mirror_shows_the_floor_in_front_of_it_and_a_black_wall_nothing() {
        // The lower middle of the pane, where a mirror shows the floor.
        let brightness = |material| rendered(&pane(material)).image.pixel(15, 18)[1];
        assert_eq!(brightness(black(1, 0.0)), 0);
        assert!(brightness(black(3, 1.0)) > 120);
    }

    #[test]
    fn glass_of_index_1_is_not_there() {
        let mut scene = pane(black(7, 1.0));
        let through = rendered(&scene);
        scene.mesh = Mesh::new(
            scene.mesh.vertices().to_vec(),
            scene.mesh.triangles()[..2].to_vec(),
        )
        .unwrap()
        .into();
        scene.material_of.truncate(2);
        let without = rendered(&scene);
        // The pane has its own share in the exposure, which looks at lit areas.
        let middle = |r: &crate::shade::Rendered| i32::from(r.image.pixel(15, 20)[1]);
        assert!(middle(&without) > 60);
        assert!((middle(&through) - middle(&without)).abs() < 25);
        assert!(through.stats.rays.refracted > 0);
    }

    #[test]
    fn an_opaque_scene_gives_the_identical_image_with_the_full_model() {
        for spec in ["teapot:3", "caballito"] {
            let mut scene = crate::scene::load(spec).unwrap();
            let bounds = scene.mesh.bounds();
            scene.lights = vec![Light {
                position: bounds.max + bounds.extent(),
                intensity: Vec3::splat(10.0) * bounds.extent().length_squared(),
            }];
            let accel = crate::accel::parse("bvh").unwrap();
            let kernel = crate::kernel::parse("woop").unwrap();
            let accel = crate::accel::build(&scene.mesh, &accel, None, &kernel, u64::MAX).unwrap();
            let needed = Model::of(&scene);
            assert!(!needed.mirror && !needed.glass);
            let full = Model {
                mirror: true,
                glass: true,
                ..needed
            };
            let rays: Vec<Ray> = (0..48 * 48)
                .map(|i| (i % 48, i / 48))
                .map(|(x, y)| scene.camera.ray(x as f32 + 0.5, y as f32 + 0.5, 48, 48))
                .collect();
            let image = |model| {
                let mut counts = RayCounts::default();
                let pixels = Shader::new(&scene, &*accel, model).tile(&rays, &mut counts);
                (pixels, counts)
            };
            assert_eq!(image(needed), image(full), "{spec}");
        }
    }

    #[test]
    fn two_mirrors_that_face_each_other_come_to_an_end() {
        let mut scene = pane(black(3, 1.0));
        let mut vertices = scene.mesh.vertices().to_vec();
        vertices.extend_from_within(4..8);
        for vertex in &mut vertices[8..] {
            vertex.z = 8.0;
        }
        let triangles = [scene.mesh.triangles(), &[[8, 9, 10], [8, 10, 11]]].concat();
        scene.mesh = Mesh::new(vertices, triangles).unwrap().into();
        scene.material_of = vec![0, 0, 1, 1, 1, 1];
        let rays = rendered(&scene).stats.rays;
        assert!(rays.reflected > rays.primary);
        assert!(rays.reflected <= rays.primary * MOST_GENERATIONS as u64);
    }
}
