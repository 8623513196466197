//! Rendering: rays through pixels in tiles, in whole passes from coarse to fine.

use std::ops::AddAssign;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::accel::Accelerator;
use crate::geometry::Ray;
use crate::scene::{Camera, Scene};

use super::channel::{Channel, Painter};
use super::image::{Image, to_srgb};
use super::legend::Legend;

/// Pixels along a tile's side: 256 rays are enough work to share out, and few enough to be cancelled soon.
const TILE: u32 = 16;

/// What is to be seen, from where, through which structure, and how large.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// Triangles, materials, lights.
    pub scene: &'a Scene,
    /// Where the picture is taken from.
    pub camera: &'a Camera,
    /// What finds the hits; built over the scene's mesh.
    pub accel: &'a dyn Accelerator,
    /// What the picture shows.
    pub channel: &'a Channel,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// How finely a picture is sampled: one ray for every `step · step` pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pass {
    /// Side of the square of pixels that share a ray; 1 is the full resolution.
    pub step: u32,
}

impl Pass {
    /// One ray a pixel.
    pub const FULL: Self = Self { step: 1 };
}

/// The passes of a live picture, coarse to fine: the first costs a sixteenth of the last.
pub const PASSES: [Pass; 3] = [Pass { step: 4 }, Pass { step: 2 }, Pass::FULL];

/// Rays that were traced, by what they were for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the eye through pixels.
    pub primary: u64,
    /// Of these, rays that hit a triangle.
    pub hits: u64,
    /// From surfaces towards lights.
    pub shadow: u64,
    /// From mirrors and glass, on the side that is seen.
    pub reflected: u64,
    /// Into glass and out of it.
    pub refracted: u64,
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.primary += other.primary;
        self.hits += other.hits;
        self.shadow += other.shadow;
        self.reflected += other.reflected;
        self.refracted += other.refracted;
    }
}

impl RayCounts {
    /// All rays.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.primary + self.shadow + self.reflected + self.refracted
    }
}

/// How a picture came about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RenderStats {
    /// Rays that were traced.
    pub rays: RayCounts,
    /// What the scene was found to need, e.g. `Lambert, head light; no shadows needed; no mirror, no glass; 1.0 rays a
    /// pixel`.
    pub found: String,
}

/// A picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Rendered {
    /// The pixels, always of the view's full size.
    pub image: Image,
    /// What the colours mean, where they stand for numbers.
    pub legend: Option<Legend>,
    /// How it came about.
    pub stats: RenderStats,
}

/// Renders one ray a pixel, in the rayon pool that this is called in. The same view gives the same bytes, whatever the
/// number of threads. A view without pixels gives an empty image.
#[must_use]
pub fn render(view: &View) -> Rendered {
    paint(view, Pass::FULL, &|| false).unwrap_or_else(|| Rendered {
        // Nothing cancels here; an empty image says so without a panic.
        image: Image::filled(0, 0, [0; 3]),
        legend: None,
        stats: RenderStats {
            rays: RayCounts::default(),
            found: String::new(),
        },
    })
}

impl View<'_> {
    /// Renders one pass, in the rayon pool that this is called in; `None` when `cancel` was set before its end.
    ///
    /// `cancel` is looked at before each tile. The image has the view's full size, whatever the pass.
    #[must_use]
    pub fn pass(&self, pass: Pass, cancel: &AtomicBool) -> Option<Rendered> {
        paint(self, pass, &|| cancel.load(Ordering::Relaxed))
    }
}

/// Paints a whole pass, unless `cancelled` says so before one of its tiles.
fn paint(view: &View, pass: Pass, cancelled: &(dyn Fn() -> bool + Sync)) -> Option<Rendered> {
    let grid = PixelGrid::new(view, pass);
    let (pixels, legend, rays, found) = match (view.channel.paint)(view) {
        Painter::Colours { tile, found } => {
            let (pixels, rays) = grid.tiles(cancelled, &tile)?;
            (pixels, None, rays, found)
        }
        Painter::Numbers { tile, ramp } => {
            let (numbers, rays) = grid.tiles(cancelled, &tile)?;
            let legend = Legend::of(ramp, &numbers);
            let background = to_srgb(view.scene.background);
            let colour = |number: &f32| match &legend {
                Some(legend) if !number.is_nan() => legend.colour(*number),
                _ => background,
            };
            let pixels = numbers.iter().map(colour).collect();
            (pixels, legend, rays, ramp.title.to_owned())
        }
    };
    let per_pixel = rays.total() as f64 / (rays.primary as f64).max(1.0);
    Some(Rendered {
        image: grid.enlarged(&pixels),
        legend,
        stats: RenderStats {
            rays,
            found: format!("{found}; {per_pixel:.1} rays a pixel"),
        },
    })
}

/// The rays of a pass: one for each square of `step · step` pixels, those at the right and lower edge cut off.
struct PixelGrid<'a> {
    view: &'a View<'a>,
    step: u32,
    columns: u32,
    rows: u32,
}

impl<'a> PixelGrid<'a> {
    fn new(view: &'a View<'a>, pass: Pass) -> Self {
        let step = pass.step.max(1);
        Self {
            view,
            step,
            columns: view.width.div_ceil(step),
            rows: view.height.div_ceil(step),
        }
    }

    /// The ray through the middle of a square.
    fn ray(&self, column: u32, row: u32) -> Ray {
        let middle = |i: u32| (i as f32 + 0.5) * self.step as f32;
        let View { width, height, .. } = *self.view;
        self.view
            .camera
            .ray(middle(column), middle(row), width, height)
    }

    /// Columns and rows of a tile.
    fn tile(&self, index: u32) -> [std::ops::Range<u32>; 2] {
        let across = self.columns.div_ceil(TILE);
        let range = |tile: u32, end: u32| tile * TILE..((tile + 1) * TILE).min(end);
        [
            range(index % across, self.columns),
            range(index / across, self.rows),
        ]
    }

    /// What `paint` gives for all squares, row by row; `None` when cancelled.
    fn tiles<T: Copy + Default + Send>(
        &self,
        cancelled: &(dyn Fn() -> bool + Sync),
        paint: &(dyn Fn(&[Ray], &mut RayCounts) -> Vec<T> + Sync),
    ) -> Option<(Vec<T>, RayCounts)> {
        let count = self.columns.div_ceil(TILE) * self.rows.div_ceil(TILE);
        let painted: Option<Vec<(Vec<T>, RayCounts)>> = (0..count)
            .into_par_iter()
            .map(|index| {
                if cancelled() {
                    return None;
                }
                let [columns, rows] = self.tile(index);
                let rays: Vec<Ray> = rows
                    .flat_map(|row| columns.clone().map(move |column| (column, row)))
                    .map(|(column, row)| self.ray(column, row))
                    .collect();
                let mut counts = RayCounts::default();
                let values = paint(&rays, &mut counts);
                Some((values, counts))
            })
            .collect();
        let mut all = vec![T::default(); self.columns as usize * self.rows as usize];
        let mut rays = RayCounts::default();
        for (index, (values, counts)) in painted?.into_iter().enumerate() {
            rays += counts;
            let [columns, rows] = self.tile(index as u32);
            let width = columns.len();
            for (row, values) in rows.zip(values.chunks(width)) {
                let start = row as usize * self.columns as usize + columns.start as usize;
                all[start..start + width].copy_from_slice(values);
            }
        }
        Some((all, rays))
    }

    /// The picture in full size, each square of one colour.
    fn enlarged(&self, colours: &[[u8; 3]]) -> Image {
        let View { width, height, .. } = *self.view;
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            let start = (y / self.step) as usize * self.columns as usize;
            pixels.extend((0..width).map(|x| colours[start + (x / self.step) as usize]));
        }
        Image {
            width,
            height,
            pixels,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel;
    use crate::geometry::Vec3;
    use crate::kernel;
    use crate::scene;
    use crate::scene::{Light, Material};
    use crate::shade::{CHANNELS, channel};

    /// The teapot at a coarse tessellation, with a light and some colour.
    fn lit_teapot() -> Scene {
        let mut scene = scene::load("teapot:2").unwrap();
        let bounds = scene.mesh.bounds();
        scene.lights = vec![Light {
            position: bounds.max + bounds.extent(),
            intensity: Vec3::splat(10.0),
        }];
        scene.materials = vec![Material {
            diffuse: Vec3::new(0.7, 0.3, 0.2),
            specular: Vec3::splat(0.4),
            illum: 2,
            ..Material::default()
        }];
        scene
    }

    fn brute(scene: &Scene) -> Box<dyn Accelerator> {
        let accel = accel::parse("brute").unwrap();
        let kernel = kernel::parse("moller-trumbore").unwrap();
        accel::build(&scene.mesh, &accel, None, &kernel, u64::MAX).unwrap()
    }

    fn view<'a>(scene: &'a Scene, accel: &'a dyn Accelerator, name: &str) -> View<'a> {
        View {
            scene,
            camera: &scene.camera,
            accel,
            channel: channel(name).unwrap(),
            width: 50,
            height: 37,
        }
    }

    fn on_threads(threads: usize, view: &View) -> Rendered {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| render(view))
    }

    #[test]
    fn every_channel_gives_the_same_bytes_on_any_number_of_threads() {
        let scene = lit_teapot();
        let accel = brute(&scene);
        for row in CHANNELS {
            let view = view(&scene, &*accel, row.name);
            let one = on_threads(1, &view);
            assert_eq!(one.image.pixels.len(), 50 * 37);
            assert_eq!(one, on_threads(3, &view), "{}", row.name);
        }
    }

    #[test]
    fn the_last_pass_is_the_full_picture_and_coarser_ones_repeat_their_pixels() {
        let scene = lit_teapot();
        let accel = brute(&scene);
        let view = view(&scene, &*accel, "id");
        let never = AtomicBool::new(false);
        let [coarse, _, fine] = PASSES.map(|pass| view.pass(pass, &never).unwrap());
        assert_eq!(fine, render(&view));
        assert_eq!((coarse.image.width, coarse.image.height), (50, 37));
        assert_eq!(coarse.stats.rays.primary, 13 * 10);
        assert_eq!(coarse.image.pixel(48, 36), coarse.image.pixel(49, 36));
        assert_eq!(coarse.image.pixel(4, 4), coarse.image.pixel(7, 7));
    }

    #[test]
    fn a_cancelled_pass_gives_no_picture() {
        let scene = lit_teapot();
        let accel = brute(&scene);
        let view = view(&scene, &*accel, "color");
        assert!(view.pass(Pass::FULL, &AtomicBool::new(true)).is_none());
    }

    #[test]
    fn a_view_without_pixels_gives_an_empty_image() {
        let scene = lit_teapot();
        let accel = brute(&scene);
        for row in CHANNELS {
            let view = View {
                width: 0,
                ..view(&scene, &*accel, row.name)
            };
            assert!(render(&view).image.pixels.is_empty());
        }
    }

    #[test]
    fn shadow_rays_are_traced_only_where_there_are_lights() {
        let mut scene = lit_teapot();
        let accel = brute(&scene);
        let lit = render(&view(&scene, &*accel, "color")).stats;
        assert!(lit.rays.shadow > 0 && lit.rays.shadow <= lit.rays.hits);
        assert!(
            lit.found.starts_with("Blinn-Phong, 1 light"),
            "{}",
            lit.found
        );
        scene.lights.clear();
        let bare = render(&view(&scene, &*accel, "color")).stats;
        assert_eq!(bare.rays.shadow, 0);
        assert_eq!(
            bare.found,
            "Lambert, head light; no shadows needed; no mirror, no glass; 1.0 rays a pixel"
        );
    }

    /// A floor under a small roof: the light above leaves the roof's shadow on the floor, and nowhere else.
    #[test]
    fn a_roof_casts_its_shadow_on_the_floor_and_the_floor_none_on_itself() {
        let quad =
            |y: f32, r: f32| [(-r, -r), (r, -r), (r, r), (-r, r)].map(|(x, z)| Vec3::new(x, y, z));
        let vertices: Vec<Vec3> = [quad(0.0, 8.0), quad(2.0, 1.0)].concat();
        let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        let mut scene = scene::load("one").unwrap();
        scene.mesh = scene::Mesh::new(vertices, triangles).unwrap().into();
        scene.material_of = vec![0; 4];
        scene.lights = vec![Light {
            position: Vec3::Y * 4.0,
            intensity: Vec3::splat(16.0),
        }];
        scene.camera = Camera {
            eye: Vec3::new(0.0, 1.0, 6.0),
            at: Vec3::new(0.0, 0.0, 0.0),
            up: Vec3::Y,
            fov_deg: 60.0,
        };
        let accel = brute(&scene);
        let image = render(&view(&scene, &*accel, "color")).image;
        // The shadow reaches from -2 to 2; the middle of the picture looks at the origin.
        let brightness = |x: u32, y: u32| i32::from(image.pixel(x, y)[0]);
        assert!(brightness(25, 18) < 110, "{}", brightness(25, 18));
        assert!(brightness(25, 30) > 150, "{}", brightness(25, 30));
        // Where nothing shades it, neighbours on the floor differ little: no speckles of self-shadow.
        for x in 1..50 {
            assert!((brightness(x, 34) - brightness(x - 1, 34)).abs() < 8, "{x}");
        }
    }

    #[test]
    fn near_is_bright_and_far_is_dark_and_the_legend_says_how_far() {
        let scene = lit_teapot();
        let accel = brute(&scene);
        let picture = render(&view(&scene, &*accel, "depth"));
        let legend = picture.legend.unwrap();
        let distance = (scene.camera.eye - scene.mesh.bounds().centre()).length();
        assert!(legend.min < distance && distance < legend.max * 1.5);
        assert!(legend.colour(legend.min)[0] > legend.colour(legend.max)[0]);
    }

    #[test]
    fn brute_force_tests_every_triangle_for_every_pixel() {
        let scene = lit_teapot();
        let accel = brute(&scene);
        let tests = render(&view(&scene, &*accel, "tests")).legend.unwrap();
        let all = scene.mesh.len() as f32;
        assert_eq!((tests.min, tests.max), (all, all));
        let cells = render(&view(&scene, &*accel, "cells")).legend.unwrap();
        assert_eq!((cells.min, cells.max), (1.0, 1.0));
    }
}
