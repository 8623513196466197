//! What only a kernel's own answers can show: rays that leave a hit and meet its triangle again, and answers that
//! change with things that mean nothing.
//!
//! - **Self-hits.** From each hit a ray leaves to the side that the first one came from, cosine-weighted around the
//!   normal, its start placed by each [`StartRule`] in turn. It leaves a plane, so it cannot meet the same triangle
//!   again; where its nearest hit is that triangle, the start or the kernel is to blame.
//! - **Vertex rotation.** The same triangles, each named from its second corner on.
//! - **Translation.** Two scenes, equal but for a translation that `f32` carries out without rounding: the scene is
//!   moved by a power of two of at least four times its greatest coordinate, and rounded there; its equal is that scene
//!   moved back. All differences of coordinates are the same in both, so a kernel that works relative to the ray gives
//!   the same answers.
//!
//! - **Fallbacks.** Of the tests that `exact` makes: how many its filter in `f32` leaves to `f64`, and how many that leaves
//!   to integers.
//!
//! *Decided otherwise*: another triangle, or a hit instead of a miss. All of this is asked of a seeded sample of the
//! rays, in the default accelerator: an accelerator never changes a right answer, so these are figures of the kernel.

use std::sync::Arc;

use rayon::prelude::*;

use crate::accel::{self, Accelerator};
use crate::geometry::{Hit, Ray, Vec3, unit_normal};
use crate::kernel::exact::{self, Stage};
use crate::lab::subset::stratified;
use crate::registry::Choice;
use crate::scene::{Mesh, Scene};
use crate::trace::{self, BATCH, cosine_direction, generator};

use super::place;
use super::{Accuracy, Fallbacks, Place, Rate, SelfHits, StartRule};

/// Most rays that are asked: a rate of 1 in 20,000 is still seen.
const PROBED: usize = 1 << 16;

/// Most rays whose tests are looked at one by one.
const WATCHED: usize = 1 << 14;

/// Rays and scenes that all kernels of a course are probed with.
pub(super) struct Probes {
    mesh: Arc<Mesh>,
    rays: Vec<Ray>,
    /// Each triangle named from its second corner on.
    rotated: Arc<Mesh>,
    /// `None` where `f32` does not carry the translation out without rounding.
    twins: Option<[Twin; 2]>,
    seed: u64,
}

/// One of two scenes that are equal but for a translation.
struct Twin {
    mesh: Arc<Mesh>,
    rays: Vec<Ray>,
}

/// What the probes of a kernel found.
#[derive(Debug, Clone, Copy)]
pub(super) struct Probed {
    self_hits: [SelfHits; StartRule::ALL.len()],
    vertex_rotation: Rate,
    translation: Option<Rate>,
    fallbacks: Option<Fallbacks>,
}

impl Probed {
    /// Adds what was found to the figures of a run.
    pub fn enter(&self, accuracy: &mut Accuracy) {
        accuracy.self_hits = Some(self.self_hits);
        accuracy.vertex_rotation = Some(self.vertex_rotation);
        accuracy.translation = self.translation;
        accuracy.fallbacks = self.fallbacks;
    }
}

impl Probes {
    /// Picks the rays and makes the scenes.
    pub fn new(scene: &Scene, spec: &str, rays: &[Ray], seed: u64) -> Self {
        let picked = stratified(rays.len(), PROBED, seed);
        let rotated = |&[a, b, c]: &[u32; 3]| [b, c, a];
        let triangles = scene.mesh.triangles().iter().map(rotated).collect();
        // The vertices are those of a mesh already.
        let rotated = Mesh::new(scene.mesh.vertices().to_vec(), triangles);
        Self {
            mesh: Arc::clone(&scene.mesh),
            rays: picked.into_iter().map(|i| rays[i]).collect(),
            rotated: rotated.map_or_else(|_| Arc::clone(&scene.mesh), Arc::new),
            twins: twins(scene, spec, rays, seed),
            seed,
        }
    }

    /// Probes a kernel, in the current rayon pool.
    ///
    /// # Errors
    /// The kernel is not known.
    pub fn probe(&self, kernel: &Choice) -> Result<Probed, String> {
        let hits_of = |mesh: &Arc<Mesh>, rays: &[Ray]| {
            let built = structure(mesh, kernel)?;
            Ok::<_, String>(trace::closest(&*built, rays))
        };
        let built = structure(&self.mesh, kernel)?;
        let hits = trace::closest(&*built, &self.rays);
        let otherwise = changed(&hits, &hits_of(&self.rotated, &self.rays)?);
        let translation = match &self.twins {
            Some([there, back]) => Some(changed(
                &hits_of(&there.mesh, &there.rays)?,
                &hits_of(&back.mesh, &back.rays)?,
            )),
            None => None,
        };
        Ok(Probed {
            self_hits: StartRule::ALL.map(|rule| SelfHits {
                rule,
                rate: self.self_hits(&*built, &hits, rule),
            }),
            vertex_rotation: otherwise,
            translation,
            fallbacks: (kernel.name == exact::NAME).then(|| self.fallbacks(&*built)),
        })
    }

    fn fallbacks(&self, built: &dyn Accelerator) -> Fallbacks {
        let every = self.rays.len().div_ceil(WATCHED).max(1);
        let of_ray = |ray: &Ray| {
            let visits = built.inspect(ray).visits;
            let tests = visits.iter().flat_map(|visit| &visit.tests);
            tests.fold(Fallbacks::default(), |sum, test| {
                let stage = exact::stage(ray, &self.mesh.corners(test.prim));
                Fallbacks {
                    tests: sum.tests + 1,
                    f64: sum.f64 + u64::from(stage == Stage::F64),
                    integers: sum.integers + u64::from(stage == Stage::Integers),
                }
            })
        };
        let rays = self.rays.par_iter().step_by(every).filter(|r| r.is_valid());
        rays.map(of_ray)
            .reduce(Fallbacks::default, |a, b| Fallbacks {
                tests: a.tests + b.tests,
                f64: a.f64 + b.f64,
                integers: a.integers + b.integers,
            })
    }

    fn self_hits(&self, built: &dyn Accelerator, hits: &[Hit], rule: StartRule) -> Rate {
        let batches = self.rays.par_chunks(BATCH).zip(hits.par_chunks(BATCH));
        let of_batch = |(batch, (rays, hits)): (usize, (&[Ray], &[Hit]))| {
            // The same directions for every rule and kernel.
            let mut random = generator(self.seed, 1000 + batch as u64);
            let mut leaving = Vec::with_capacity(rays.len());
            let mut left = Vec::with_capacity(rays.len());
            for (ray, hit) in rays.iter().zip(hits).filter(|(_, hit)| hit.is_hit()) {
                let corners = self.mesh.corners(hit.prim);
                let Some(normal) = unit_normal(&corners) else {
                    continue;
                };
                let normal = facing(normal, ray);
                let dir = cosine_direction(&mut random, normal.as_dvec3()).as_vec3();
                let next = rule.leave(ray, hit, &corners, normal, dir);
                if next.is_valid() {
                    leaving.push(next);
                    left.push(hit.prim);
                }
            }
            let mut again = vec![Hit::MISS; leaving.len()];
            built.closest(&leaving, &mut again);
            let seen = again.iter().zip(&left).filter(|(a, l)| a.prim == **l);
            (seen.count() as u64, leaving.len() as u64)
        };
        let sums = batches.enumerate().with_max_len(1).map(of_batch);
        let (seen, rays) = sums.reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        Rate::of(seen, rays)
    }
}

/// `normal` or its opposite: the one on the side that `ray` came from.
fn facing(normal: Vec3, ray: &Ray) -> Vec3 {
    // In f64: the product of a tiny direction would vanish in f32.
    if normal.as_dvec3().dot(ray.dir.as_dvec3()) > 0.0 {
        -normal
    } else {
        normal
    }
}

fn structure(mesh: &Arc<Mesh>, kernel: &Choice) -> Result<Box<dyn Accelerator>, String> {
    let build = || accel::build(mesh, &accel::parse(accel::DEFAULT)?, None, kernel, u64::MAX);
    build().map_err(|why| why.to_string())
}

/// How many rays two lists of answers decide otherwise.
fn changed(a: &[Hit], b: &[Hit]) -> Rate {
    let otherwise = a.iter().zip(b).filter(|(a, b)| a.prim != b.prim);
    Rate::of(otherwise.count() as u64, a.len() as u64)
}

/// `scene` moved and rounded, and that moved back without rounding; rays are made at the former.
fn twins(scene: &Scene, spec: &str, rays: &[Ray], seed: u64) -> Option<[Twin; 2]> {
    let most = rays.iter().map(|ray| ray.origin.abs().max_element());
    let most = most.fold(scene.mesh.bounds().max_abs(), f32::max);
    if most == 0.0 || !most.is_finite() {
        return None;
    }
    let exponent = f64::from(most).log2().ceil() as i32 + 2;
    let by = 2_f64.powi(exponent);
    let there = Place {
        offset: by,
        scale: 1.0,
    };
    let moved = place::scene(scene, there).ok()?;
    let set = place::rays(&moved, there, spec, PROBED.min(rays.len()), seed).ok()?;
    let back = |p: Vec3| {
        let exact = p.as_dvec3() - by;
        (exact.as_vec3().as_dvec3() == exact).then(|| exact.as_vec3())
    };
    let vertices = moved.mesh.vertices().iter().map(|v| back(*v));
    let vertices: Vec<Vec3> = vertices.collect::<Option<_>>()?;
    let mesh = Mesh::new(vertices, moved.mesh.triangles().to_vec()).ok()?;
    let pairs = set.rays.iter().filter_map(|ray| {
        let origin = back(ray.origin)?;
        Some((*ray, Ray { origin, ..*ray }))
    });
    let (of_moved, of_back): (Vec<Ray>, Vec<Ray>) = pairs.unzip();
    Some([
        Twin {
            mesh: moved.mesh,
            rays: of_moved,
        },
        Twin {
            mesh: Arc::new(mesh),
            rays: of_back,
        },
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel;

    fn probed(offset: f64, kernel: &str) -> Probed {
        let sphere = crate::scene::load("shells:1,3").unwrap();
        let at = Place { offset, scale: 1.0 };
        let scene = place::scene(&sphere, at).unwrap();
        let rays = place::rays(&scene, at, "edge", 4000, 1).unwrap().rays;
        let probes = Probes::new(&scene, "edge", &rays, 1);
        probes.probe(&kernel::parse(kernel).unwrap()).unwrap()
    }

    fn seen(found: &Probed, rule: StartRule) -> f64 {
        let of_rule = found.self_hits.iter().find(|s| s.rule == rule).unwrap();
        assert!(of_rule.rate.rays > 3000);
        of_rule.rate.share()
    }

    #[test]
    fn a_naive_start_meets_its_own_triangle_and_a_bounded_one_does_not() {
        let near = probed(0.0, "woop");
        assert!(seen(&near, StartRule::Naive) > 0.1);
        assert_eq!(seen(&near, StartRule::Normal), 0.0);
        let far = probed(1e5, "woop");
        // A fixed length is lost in the rounding of large coordinates.
        assert!(seen(&far, StartRule::Normal) > 0.1 && seen(&far, StartRule::TMin) > 0.1);
        for rule in [StartRule::Integer, StartRule::ErrorBound] {
            assert_eq!(
                (seen(&near, rule), seen(&far, rule)),
                (0.0, 0.0),
                "{rule:?}"
            );
        }
    }

    #[test]
    fn rays_exactly_through_edges_are_decided_on_integers_and_others_are_not() {
        assert!(probed(0.0, "woop").fallbacks.is_none());
        let share = |offset| {
            let Fallbacks {
                tests,
                f64,
                integers,
            } = probed(offset, "exact").fallbacks.unwrap();
            assert!(tests > 4000);
            [f64, integers].map(|count| count as f64 / tests as f64)
        };
        let ([near_f64, near_integers], [_, far_integers]) = (share(0.0), share(1e5));
        // Beside the edges first; far away corners and origins are on one raster, and rays pass exactly through edges.
        assert!(
            near_f64 > 0.1 && near_integers < 0.05,
            "{near_f64}, {near_integers}"
        );
        assert!(far_integers > 0.08, "{far_integers}");
    }

    #[test]
    fn a_kernel_that_works_relative_to_the_ray_does_not_feel_a_translation() {
        let woop = probed(0.0, "woop").translation.unwrap();
        assert_eq!((woop.seen, woop.rays), (0, 4000));
        let sheet = probed(0.0, "sheet-signed").translation.unwrap();
        assert!(sheet.seen > 0 && sheet.rays == 4000);
    }

    #[test]
    fn both_twins_hold_the_same_differences() {
        let scene = crate::scene::load("teapot:3").unwrap();
        let rays = trace::ray_set(&scene, "random", 500, 1).unwrap().rays;
        let [there, back] = twins(&scene, "random", &rays, 1).unwrap();
        let by = there.mesh.vertices()[0] - back.mesh.vertices()[0];
        assert_eq!(by, Vec3::splat(by.x));
        let points = |twin: &Twin| {
            let origins = twin.rays.iter().map(|r| r.origin);
            twin.mesh
                .vertices()
                .iter()
                .copied()
                .chain(origins)
                .collect::<Vec<_>>()
        };
        for (a, b) in points(&there).into_iter().zip(points(&back)) {
            assert_eq!(a.as_dvec3() - b.as_dvec3(), by.as_dvec3());
        }
    }
}
