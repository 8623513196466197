//! Meshes and rays on which structures are known to fail, for the unit tests of every structure.

use std::sync::Arc;

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

use crate::geometry::{Hit, Ray, Vec3};
use crate::kernel;
use crate::scene::Mesh;

use super::{Accelerator, Counts};

/// A seeded source of numbers.
pub struct Dice(Pcg32);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Self(Pcg32::seed_from_u64(seed))
    }

    pub fn below(&mut self, n: u32) -> u32 {
        self.0.next_u32() % n
    }

    /// Uniform in -1..1, with 24 bits.
    pub fn signed(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// A mesh of triangles given by corners.
pub fn mesh(triangles: &[[Vec3; 3]]) -> Arc<Mesh> {
    let vertices = triangles.iter().flatten().copied().collect();
    let indices = (0..triangles.len() as u32)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    Arc::new(Mesh::new(vertices, indices).expect("finite"))
}

/// Random triangles of size `size` in the cube from -1 to 1.
pub fn soup(count: u32, size: f32, seed: u64) -> Vec<[Vec3; 3]> {
    let mut dice = Dice::new(seed);
    (0..count)
        .map(|_| {
            let centre = dice.vector();
            [0; 3].map(|_| centre + size * dice.vector())
        })
        .collect()
}

/// A sphere of `2·n·n` triangles with shared vertices, the closed mesh of these tests.
pub fn sphere(n: u32) -> Vec<[Vec3; 3]> {
    let point = |i: u32, j: u32| {
        // The poles are points: a circle of radius 1e-7 would make triangles without area.
        if i.is_multiple_of(n) {
            return if i == 0 { Vec3::Y } else { -Vec3::Y };
        }
        let (polar, around) = (
            std::f32::consts::PI * i as f32 / n as f32,
            std::f32::consts::TAU * (j % n) as f32 / n as f32,
        );
        Vec3::new(
            polar.sin() * around.cos(),
            polar.cos(),
            polar.sin() * around.sin(),
        )
    };
    (0..n * n)
        .flat_map(|k| {
            let (i, j) = (k / n, k % n);
            let [a, b, c, d] = [
                point(i, j),
                point(i + 1, j),
                point(i + 1, j + 1),
                point(i, j + 1),
            ];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// Squares of two triangles on the planes of a lattice: everything is parallel to an axis.
fn lattice(n: i32) -> Vec<[Vec3; 3]> {
    let mut triangles = Vec::new();
    for cell in 0..n * n * n {
        let corner = Vec3::new(
            (cell % n) as f32,
            (cell / n % n) as f32,
            (cell / n / n) as f32,
        );
        for [u, v] in [[Vec3::X, Vec3::Y], [Vec3::Y, Vec3::Z], [Vec3::Z, Vec3::X]] {
            triangles.push([corner, corner + u, corner + u + v]);
            triangles.push([corner, corner + u + v, corner + v]);
        }
    }
    triangles
}

/// A triangle of size 2⁻ⁱ for each of `octaves`, towards a corner: splits that halve space peel off one at a time.
pub fn geometric(octaves: std::ops::Range<i32>) -> Vec<[Vec3; 3]> {
    octaves
        .map(|i| {
            let x = 0.5_f32.powi(i);
            [
                Vec3::new(x, 0.0, 0.0),
                Vec3::new(x, x, 0.0),
                Vec3::new(x, 0.0, x),
            ]
        })
        .collect()
}

/// Meshes by name, each of them a known trap.
pub fn nasty() -> Vec<(&'static str, Arc<Mesh>)> {
    let flat: Vec<_> = lattice(4)
        .into_iter()
        .filter(|t| t.iter().all(|p| p.z == 0.0))
        .collect();
    let mut giant = soup(200, 0.05, 1);
    giant.push([
        Vec3::new(-500.0, -400.0, -0.3),
        Vec3::new(700.0, -300.0, 0.1),
        Vec3::new(0.0, 900.0, 0.2),
    ]);
    let mut dice = Dice::new(2);
    let concentric: Vec<_> = (0..300)
        .map(|_| {
            let arm = dice.vector();
            // The box is that of `arm` and `-arm`, whatever the third corner.
            [arm, -arm, arm * dice.vector()]
        })
        .collect();
    let needles: Vec<_> = (0..300)
        .map(|_| {
            let (start, along) = (dice.vector(), dice.vector());
            [
                start,
                start + along,
                start + along * 0.5 + dice.vector() * 1e-3,
            ]
        })
        .collect();
    let twin = [
        Vec3::new(-0.5, -0.5, 0.25),
        Vec3::new(0.5, -0.5, 0.25),
        Vec3::new(0.0, 0.5, 0.25),
    ];
    let far: Vec<_> = sphere(12)
        .iter()
        .map(|t| t.map(|p| p * 16.0 + Vec3::splat(1e6)))
        .collect();
    let points = vec![[Vec3::ONE; 3]; 50];
    vec![
        ("empty", mesh(&[])),
        ("one", mesh(&[[Vec3::ZERO, Vec3::X, Vec3::Y]])),
        ("soup", mesh(&soup(500, 0.2, 3))),
        ("sphere", mesh(&sphere(16))),
        ("flat", mesh(&flat)),
        ("lattice", mesh(&lattice(4))),
        ("giant", mesh(&giant)),
        ("concentric", mesh(&concentric)),
        ("needles", mesh(&needles)),
        // Products of three such coordinates are still normal numbers.
        ("geometric", mesh(&geometric(0..40))),
        ("twins", mesh(&vec![twin; 10_000])),
        ("far", mesh(&far)),
        ("points", mesh(&points)),
    ]
}

/// That `accel`, without a resolution, answers as brute force does on [`nasty`] meshes: rays of all kinds, with a kernel and
/// with `exact`, and rays from one origin, which may go together.
pub fn assert_agrees_on_nasty(accel: &str) {
    for (name, mesh) in nasty() {
        let rays = rays(&mesh, ray_count(&mesh), 7);
        assert_agrees(name, &mesh, accel, &rays);
        assert_agrees_with("exact", name, &mesh, (accel, None), &rays, 0);
        for seed in 0..4 {
            let pencil = pencil(&mesh, ray_count(&mesh), seed);
            assert_agrees(name, &mesh, accel, &pencil);
        }
    }
}

/// That `build` gives the same on one thread and on five.
pub fn assert_same_on_threads<T: PartialEq + Send>(build: impl Fn() -> T + Sync) {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().expect("a pool").install(&build)
    };
    assert!(on(1) == on(5));
}

/// As many rays as brute force can trace through `mesh` in a unit test.
pub fn ray_count(mesh: &Mesh) -> u32 {
    (1_000_000 / (mesh.len() as u32 + 1)).clamp(200, 2000)
}

/// Rays at `mesh`: across it, from inside it, axis-parallel with zeros of both signs, aimed at vertices and edge
/// middles, along edges and in the planes of triangles, and with short intervals.
pub fn rays(mesh: &Mesh, count: u32, seed: u64) -> Vec<Ray> {
    let mut dice = Dice::new(seed);
    let bounds = if mesh.is_empty() {
        crate::geometry::Aabb::of_points([-Vec3::ONE, Vec3::ONE])
    } else {
        mesh.bounds()
    };
    let (centre, half) = (bounds.centre(), bounds.extent() * 0.5);
    let radius = half.max_element().max(1.0);
    let mut rays = Vec::new();
    for i in 0..count {
        let inside = centre + half * dice.vector();
        let outside = centre + 2.0 * radius * dice.vector();
        let corners = if mesh.is_empty() {
            [inside, outside, centre]
        } else {
            mesh.corners(dice.below(mesh.len() as u32))
        };
        let zero = if dice.below(2) == 0 { 0.0 } else { -0.0 };
        let axis = dice.below(3) as usize;
        let mut along = [zero; 3];
        along[axis] = if dice.below(2) == 0 { 1.0 } else { -1.0 };
        let along = Vec3::from(along);
        let mut ray = match i % 8 {
            0 => Ray::new(outside, inside - outside),
            1 => Ray::new(inside, dice.vector()),
            2 => Ray::new(corners[0] - along * radius, along),
            3 => Ray::new(outside, corners[0] - outside),
            4 => Ray::new(outside, (corners[0] + corners[1]) * 0.5 - outside),
            5 => Ray::new(
                corners[2] - along * radius + half * (dice.signed() * 0.1),
                along,
            ),
            6 => Ray::new(corners[0], corners[1] - corners[0]),
            _ => Ray::new(corners[1], dice.vector()),
        };
        if dice.below(4) == 0 {
            ray.t_max = dice.signed().abs();
        }
        if dice.below(8) == 0 {
            ray.t_min = ray.t_max.min(1.0) * 0.25;
        }
        if ray.is_valid() {
            rays.push(ray);
        }
    }
    rays
}

/// Rays at `mesh` from one origin, as those of a picture: runs of 64, some narrow and some wide, aimed at corners too.
pub fn pencil(mesh: &Mesh, count: u32, seed: u64) -> Vec<Ray> {
    let mut dice = Dice::new(seed);
    let bounds = if mesh.is_empty() {
        crate::geometry::Aabb::of_points([-Vec3::ONE, Vec3::ONE])
    } else {
        mesh.bounds()
    };
    let (centre, half) = (bounds.centre(), bounds.extent() * 0.5);
    let radius = half.max_element().max(1.0);
    let origin = centre + 2.0 * radius * dice.vector();
    let (mut target, mut spread) = (centre, radius);
    let mut rays = Vec::new();
    while (rays.len() as u32) < count {
        if rays.len().is_multiple_of(64) {
            target = centre + half * dice.vector();
            spread = [0.0, 1e-3, 0.03, 0.3][dice.below(4) as usize] * radius;
        }
        let aim = if dice.below(4) == 0 && !mesh.is_empty() && spread > 0.1 * radius {
            mesh.corners(dice.below(mesh.len() as u32))[0]
        } else {
            target + spread * dice.vector()
        };
        let ray = Ray::new(origin, aim - origin);
        if ray.is_valid() {
            rays.push(ray);
        }
    }
    rays
}

/// Builds `accel` (`name:key=value…`) over `mesh` for `kernel`, at the predicted n where it has one.
pub fn built(mesh: &Arc<Mesh>, accel: &str, kernel: &str) -> Box<dyn Accelerator> {
    built_at(mesh, accel, None, kernel)
}

/// As [`built`], at resolution `n`.
pub fn built_at(
    mesh: &Arc<Mesh>,
    accel: &str,
    n: Option<u32>,
    kernel: &str,
) -> Box<dyn Accelerator> {
    super::build(
        mesh,
        &super::parse(accel).expect("known"),
        n,
        &kernel::parse(kernel).expect("known"),
        u64::MAX,
    )
    .expect("built")
}

/// Asserts that `accel` is valid and answers every ray as brute force does, whichever way it is asked. No exceptions:
/// these kernels do not err by more than the pads, not even at edges.
pub fn assert_agrees(name: &str, mesh: &Arc<Mesh>, accel: &str, rays: &[Ray]) {
    for kernel in ["moller-trumbore", "woop"] {
        assert_agrees_with(kernel, name, mesh, (accel, None), rays, 0);
    }
}

/// As [`assert_agrees`] for `moller-trumbore`, with a resolution; `excused` rays may differ where brute force itself errs.
pub fn assert_agrees_at(
    name: &str,
    mesh: &Arc<Mesh>,
    accel: (&str, Option<u32>),
    rays: &[Ray],
    excused: usize,
) {
    assert_agrees_with("moller-trumbore", name, mesh, accel, rays, excused);
}

/// As [`assert_agrees_at`], for any kernel.
pub fn assert_agrees_with(
    kernel: &str,
    name: &str,
    mesh: &Arc<Mesh>,
    (accel, n): (&str, Option<u32>),
    rays: &[Ray],
    excused: usize,
) {
    let brute = built(mesh, "brute", kernel);
    let accel = built_at(mesh, accel, n, kernel);
    accel
        .validate()
        .unwrap_or_else(|broken| panic!("{name}: {broken}"));
    let mut expected = vec![Hit::MISS; rays.len()];
    let mut hits = expected.clone();
    let mut counted = expected.clone();
    let mut counts = vec![Counts::default(); rays.len()];
    let mut blocked = vec![false; rays.len()];
    brute.closest(rays, &mut expected);
    accel.closest(rays, &mut hits);
    accel.closest_counted(rays, &mut counted, &mut counts);
    accel.occluded(rays, &mut blocked);
    let mut errors = 0;
    for (i, ray) in rays.iter().enumerate() {
        if !hits[i].same_answer(&expected[i]) {
            let story = format!(
                "{name}, {kernel}, ray {i} {ray:?}: {:?} for {:?}",
                hits[i], expected[i]
            );
            assert!(!is_right(mesh, ray, &expected[i]), "{story}");
            errors += 1;
            assert!(errors <= excused, "{errors} errors of the kernel; {story}");
        }
        assert!(
            counted[i].same_answer(&hits[i]),
            "{name}, ray {i}: counted differs"
        );
        assert_eq!(
            blocked[i],
            hits[i].is_hit(),
            "{name}, ray {i}: occlusion differs"
        );
    }
}

/// Whether `hit` is right when evaluated in `f64`: nothing is nearer, and it is where it says.
fn is_right(mesh: &Mesh, ray: &Ray, hit: &Hit) -> bool {
    let (mut nearest, mut own) = (f64::INFINITY, f64::INFINITY);
    for prim in 0..mesh.len() as u32 {
        if let Some(t) = exact_t(mesh, ray, prim) {
            nearest = nearest.min(t);
            if prim == hit.prim {
                own = t;
            }
        }
    }
    let near = |a: f64, b: f64| a == b || (a - b).abs() <= 1e-5 * a.abs().max(b.abs());
    near(own, nearest) && near(f64::from(hit.t), own)
}

fn exact_t(mesh: &Mesh, ray: &Ray, prim: u32) -> Option<f64> {
    let [a, b, c] = mesh.corners(prim).map(Vec3::as_dvec3);
    let (origin, dir) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
    let (e1, e2, s) = (b - a, c - a, origin - a);
    let (p, q) = (dir.cross(e2), s.cross(e1));
    let det = e1.dot(p);
    let (u, v, t) = (s.dot(p) / det, dir.dot(q) / det, e2.dot(q) / det);
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    (inside && t >= f64::from(ray.t_min) && t <= f64::from(ray.t_max)).then_some(t)
}
