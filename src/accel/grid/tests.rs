//! The grid as a whole: answers against brute force, the walk against the cells, the predictor against counts.

use std::sync::Arc;

use proptest::prelude::*;

use super::super::testbed::{self, Dice, assert_agrees_at, mesh, nasty, rays, soup, sphere};
use super::super::{Counts, build as build_any, parse};
use super::*;
use crate::geometry::lanes::Portable;
use crate::geometry::{Aabb, DVec3, Hit, Vec3};
use crate::kernel;

fn settings(text: &str) -> Settings {
    Settings::read(&parse(text).unwrap().params)
}

/// Lists of `mesh` at `n`, whatever memory they take.
fn lists(mesh: &Mesh, text: &str, n: u32) -> (Lattice, Lists) {
    let settings = settings(text);
    let lattice = Lattice::new(mesh.bounds(), Model::new(mesh, settings).dims(n));
    let lists = match settings.overlap {
        OverlapTest::Three => Lists::build::<ThreeTest>(&lattice, mesh, u64::MAX),
        OverlapTest::Separating => Lists::build::<Separating>(&lattice, mesh, u64::MAX),
        OverlapTest::SingleSeparating => Lists::build::<SingleSeparating>(&lattice, mesh, u64::MAX),
        OverlapTest::Boxes => Lists::build::<Boxes>(&lattice, mesh, u64::MAX),
    };
    (lattice, lists.unwrap())
}

/// Squares of two triangles in the plane z = 0, on a lattice of whole numbers.
fn plane(n: i32) -> Vec<[Vec3; 3]> {
    (0..n * n)
        .flat_map(|k| {
            let corner = Vec3::new((k % n) as f32, (k / n) as f32, 0.0);
            let [x, xy, y] = [Vec3::X, Vec3::X + Vec3::Y, Vec3::Y].map(|d| corner + d);
            [[corner, x, xy], [corner, xy, y]]
        })
        .collect()
}

/// Long thin triangles, most of them diagonal.
fn needles(count: u32) -> Vec<[Vec3; 3]> {
    let mut dice = Dice::new(5);
    (0..count)
        .map(|_| {
            let start = dice.vector();
            let along = Vec3::splat(0.8) + 0.1 * dice.vector();
            [
                start,
                start + along,
                start + along * 0.5 + 1e-3 * dice.vector(),
            ]
        })
        .collect()
}

/// A random line through the box, uniform in the measure of lines: a point of the surface and a cosine-weighted
/// direction inwards.
fn random_line(bounds: Aabb, dice: &mut Dice) -> Ray {
    let extent = bounds.extent();
    let faces = [
        extent.y * extent.z,
        extent.z * extent.x,
        extent.x * extent.y,
    ];
    let mut pick = (dice.signed() * 0.5 + 0.5) * faces.iter().sum::<f32>();
    let axis = faces
        .iter()
        .position(|face| {
            pick -= face;
            pick < 0.0
        })
        .unwrap_or(2);
    let upper = dice.below(2) == 1;
    let mut origin = bounds.centre() + extent * 0.5 * dice.vector();
    origin[axis] = if upper {
        bounds.max[axis]
    } else {
        bounds.min[axis]
    };
    let disc = loop {
        let point = [dice.signed(), dice.signed()];
        if point[0] * point[0] + point[1] * point[1] < 1.0 {
            break point;
        }
    };
    let mut dir = Vec3::ZERO;
    dir[(axis + 1) % 3] = disc[0];
    dir[(axis + 2) % 3] = disc[1];
    dir[axis] =
        (1.0 - disc[0] * disc[0] - disc[1] * disc[1]).sqrt() * if upper { -1.0 } else { 1.0 };
    Ray::new(origin, dir)
}

/// Notes the cells of a ray and counts its tests; never stops.
#[derive(Default)]
struct Trail {
    cells: Vec<u64>,
    spans: Vec<[f64; 2]>,
    tests: u64,
}

impl Visitor for Trail {
    const WATCHED: bool = true;
    fn step(&mut self, place: u64, leaf: bool, _references: u32, entry: f64, exit: f64) {
        assert!(leaf);
        self.cells.push(place);
        self.spans.push([entry, exit]);
    }
    fn test(&mut self, _prim: u32) -> bool {
        self.tests += 1;
        false
    }
    fn t_limit(&self) -> f32 {
        f32::INFINITY
    }
}

fn trail<M: Mailbox>(grid: &Grid<M>, ray: &Ray) -> Trail {
    let mut trail = Trail::default();
    grid.traverse::<Portable, _>(ray, &mut M::default(), &mut trail);
    trail
}

/// A grid without triangles over a box: for walks.
fn cells_of(bounds: Aabb, dims: [u32; 3]) -> Grid<Forgetful> {
    let lattice = Lattice::new(bounds, dims);
    Grid {
        lists: Lists {
            offsets: vec![0; lattice.len() as usize + 1],
            prims: Vec::new(),
        },
        lattice,
        mailbox: PhantomData,
    }
}

#[test]
fn nasty_meshes_are_answered_as_by_brute_force_at_every_resolution() {
    for (name, mesh) in nasty() {
        let rays = rays(&mesh, 400, 7);
        let resolutions: &[u32] = if name == "twins" {
            &[1, 8]
        } else {
            &[1, 2, 16, 45]
        };
        for &n in resolutions {
            assert_agrees_at(
                &format!("{name} at {n}"),
                &mesh,
                ("grid", Some(n)),
                &rays,
                0,
            );
        }
        assert_agrees_at(name, &mesh, ("grid", None), &rays, 0);
    }
}

#[test]
fn every_parameter_is_answered_as_by_brute_force() {
    for accel in [
        "grid:overlap=sat",
        "grid:overlap=bbox",
        "grid:mailbox=off",
        "grid:shape=cubic",
        "grid:overlap=bbox:shape=cubic:mailbox=off",
    ] {
        for (name, mesh) in nasty() {
            if name != "twins" {
                let rays = rays(&mesh, 500, 8);
                assert_agrees_at(name, &mesh, (accel, Some(13)), &rays, 0);
            }
        }
    }
}

#[test]
fn a_flat_scene_at_the_greatest_n_is_answered_as_by_brute_force() {
    let mesh = mesh(&plane(12));
    let rays = rays(&mesh, 3000, 3);
    assert_agrees_at("plane", &mesh, ("grid", Some(MAX_N)), &rays, 0);
    let (lattice, _) = lists(&mesh, "grid", MAX_N);
    assert_eq!(lattice.dims, [MAX_N, MAX_N, 1]);
}

#[test]
fn meshes_of_denormal_and_of_great_size_are_valid_and_answered() {
    // Products of lengths leave the range of `f32` kernels: what they miss, brute force misses too.
    for scale in [1e-44_f32, 1e-30, 1e-12, 1e12, 1e30] {
        let soup = soup(60, 0.5, 4);
        let scaled: Vec<_> = soup.iter().map(|t| t.map(|p| p * scale)).collect();
        let rays: Vec<Ray> = rays(&mesh(&soup), 300, 5)
            .iter()
            .map(|ray| Ray {
                origin: ray.origin * scale,
                ..*ray
            })
            .collect();
        let mesh = mesh(&scaled);
        assert_agrees_at(&format!("{scale:e}"), &mesh, ("grid", Some(9)), &rays, 0);
    }
}

#[test]
fn the_triangle_of_the_reference_is_listed_in_the_flat_cell() {
    // Cells of 1/8: the triangle (0,0,0) (1,0,0) (1,1,0) covers [.5, .625] x [.25, .375] x {0}.
    let mesh = mesh(&[[Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y]]);
    for overlap in ["three-test", "sat", "bbox"] {
        let (lattice, lists) = lists(&mesh, &format!("grid:overlap={overlap}"), 8);
        assert_eq!(lists.of(lattice.index([4, 2, 0]) as usize), [0]);
        let beyond = lists.of(lattice.index([2, 4, 0]) as usize);
        assert_eq!(beyond.is_empty(), overlap != "bbox");
    }
}

#[test]
fn three_tests_and_separating_axes_list_the_same_and_boxes_list_more() {
    for (name, mesh) in nasty() {
        let of = |overlap: &str| lists(&mesh, &format!("grid:overlap={overlap}"), 16).1;
        let (three, sat, boxes) = (of("three-test"), of("sat"), of("bbox"));
        assert_eq!(three, sat, "{name}");
        assert!(boxes.prims.len() >= sat.prims.len(), "{name}");
        for cell in 0..sat.offsets.len() - 1 {
            let all = boxes.of(cell);
            assert!(sat.of(cell).iter().all(|prim| all.contains(prim)), "{name}");
        }
    }
}

#[test]
fn lists_are_the_same_whatever_the_thread_count() {
    let mesh = mesh(&soup(9000, 0.1, 10));
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| lists(&mesh, "grid", 40).1)
    };
    assert_eq!(build(1), build(5));
}

#[test]
fn a_missing_reference_is_found_by_validation() {
    let mesh = mesh(&sphere(12));
    let (lattice, mut lists) = lists(&mesh, "grid", 10);
    assert_eq!(validate::check(&lattice, &lists, &mesh), Ok(()));
    // The triangle that its cell alone lists leaves for another cell's list.
    let cell = (0..1000).find(|&c| !lists.of(c).is_empty()).unwrap();
    for offset in &mut lists.offsets[1..=cell + 1] {
        *offset = 0;
    }
    lists.prims.remove(0);
    for offset in &mut lists.offsets[cell + 1..] {
        *offset -= u32::from(*offset > 0);
    }
    let broken = validate::check(&lattice, &lists, &mesh).unwrap_err();
    assert!(
        broken.contains("not listed") || broken.contains("ascend"),
        "{broken}"
    );
}

#[test]
fn no_cell_is_skipped_at_any_resolution() {
    let mut dice = Dice::new(1);
    let unit = Aabb {
        min: -Vec3::ONE,
        max: Vec3::ONE,
    };
    let far = Aabb {
        min: Vec3::splat(1e6),
        max: Vec3::splat(1e6 + 2.0),
    };
    let long = Aabb {
        min: Vec3::splat(-1e-3),
        max: Vec3::new(1e3, 1.0, 1e-3),
    };
    for (bounds, dims) in [
        (unit, [1; 3]),
        (unit, [7, 1, 130]),
        (unit, [256; 3]),
        (far, [200, 2, 200]),
        (long, [1024, 3, 5]),
    ] {
        let grid = cells_of(bounds, dims);
        for _ in 0..80 {
            let half = bounds.extent() * 0.5;
            let target = bounds.centre() + half * dice.vector();
            let origin = bounds.centre() + half * 3.0 * dice.vector();
            let ray = Ray::new(origin, target - origin);
            let trail = trail(&grid, &ray);
            assert!(trail.cells.len() <= dims.iter().sum::<u32>() as usize);
            let spans = &trail.spans;
            assert!(
                spans.windows(2).all(|pair| pair[0][1] == pair[1][0]),
                "a gap"
            );
            for k in 0..1000 {
                let t = f64::from(k) * 0.002;
                let point = ray.origin.as_dvec3() + t * ray.dir.as_dvec3();
                if let Some(cell) = cell_around(&grid.lattice, point) {
                    assert!(
                        trail.cells.contains(&cell),
                        "{ray:?} skips cell {cell} at {t}"
                    );
                }
            }
        }
    }
}

/// The one cell that holds `point`; none where it is outside or too near to a plane to tell.
fn cell_around(lattice: &Lattice, point: DVec3) -> Option<u64> {
    let mut cell = [0; 3];
    for a in 0..3 {
        let margin = lattice.pad + lattice.size[a] * 1e-9;
        cell[a] = (0..lattice.dims[a]).find(|&i| {
            lattice.plane(a, i) + margin < point[a] && point[a] < lattice.plane(a, i + 1) - margin
        })?;
    }
    Some(u64::from(lattice.index(cell)))
}

#[test]
fn rays_in_cell_planes_edges_and_corners_stay_in_cells_that_touch_them() {
    let grid = cells_of(
        Aabb {
            min: Vec3::ZERO,
            max: Vec3::splat(8.0),
        },
        [8; 3],
    );
    for zero in [0.0, -0.0] {
        let along = Vec3::new(1.0, zero, zero);
        // In a plane, on an edge, in a face of the box, on an edge of the box; forwards and backwards, from outside,
        // from a face and from inside.
        for (y, z) in [
            (3.0, 2.5),
            (3.0, 5.0),
            (0.0, 2.5),
            (8.0, 2.5),
            (8.0, 8.0),
            (0.0, 0.0),
        ] {
            for (x, steps) in [(-1.0, 8), (0.0, 8), (3.0, 5), (2.5, 6), (8.0, 1)] {
                let forward = trail(&grid, &Ray::new(Vec3::new(x, y, z), along))
                    .cells
                    .len();
                assert_eq!(forward, steps, "from {x}, {y}, {z}");
                let mirrored = Ray::new(Vec3::new(8.0 - x, y, z), -along);
                assert_eq!(trail(&grid, &mirrored).cells.len(), steps);
            }
            assert!(
                trail(&grid, &Ray::new(Vec3::new(9.0, y, z), along))
                    .cells
                    .is_empty()
            );
        }
    }
    let diagonal = trail(&grid, &Ray::new(Vec3::splat(-1.0), Vec3::ONE));
    assert_eq!(diagonal.cells.first(), Some(&0));
    assert_eq!(diagonal.cells.last(), Some(&511));
    for i in 0..8 {
        assert!(diagonal.cells.contains(&(i * 73)));
    }
}

#[test]
fn the_interval_of_the_ray_bounds_the_walk() {
    let grid = cells_of(
        Aabb {
            min: Vec3::ZERO,
            max: Vec3::splat(8.0),
        },
        [8; 3],
    );
    let from = |t_min, t_max| {
        let ray = Ray {
            t_min,
            t_max,
            ..Ray::new(Vec3::new(-1.0, 0.5, 0.5), Vec3::X)
        };
        trail(&grid, &ray).cells
    };
    assert_eq!(from(3.5, f32::INFINITY), [2, 3, 4, 5, 6, 7]);
    assert_eq!(from(f32::NEG_INFINITY, f32::INFINITY).len(), 8);
    assert!(
        from(0.0, 0.5).is_empty(),
        "the interval ends before the box"
    );
    assert!(
        from(9.5, f32::INFINITY).is_empty(),
        "the interval begins behind the box"
    );
    assert!(from(2.0, 1.0).is_empty());
}

#[test]
fn rays_from_very_far_meet_the_cells_on_their_way() {
    let bounds = Aabb {
        min: Vec3::ZERO,
        max: Vec3::splat(64.0),
    };
    let grid = cells_of(bounds, [64; 3]);
    let dir = Vec3::new(3.0, 5.0, 7.0);
    for exponent in [4, 10, 24, 40, 55] {
        // All numbers are exact: the line runs through the origin.
        let trail = trail(&grid, &Ray::new(-dir * 2_f32.powi(exponent), dir));
        for k in 0..900 {
            let point = dir.as_dvec3() * (f64::from(k) * 0.01);
            if let Some(cell) = cell_around(&grid.lattice, point) {
                assert!(trail.cells.contains(&cell), "2^{exponent}: {point}");
            }
        }
    }
}

/// Counts of all rays, summed.
fn counts(mesh: &Arc<Mesh>, accel: &str, n: u32, rays: &[Ray]) -> Counts {
    let grid = testbed::built_at(mesh, accel, Some(n), "moller-trumbore");
    let mut hits = vec![Hit::MISS; rays.len()];
    let mut counts = vec![Counts::default(); rays.len()];
    grid.closest_counted(rays, &mut hits, &mut counts);
    counts.iter().fold(Counts::default(), |sum, c| Counts {
        steps: sum.steps + c.steps,
        empty_steps: sum.empty_steps + c.empty_steps,
        tests: sum.tests + c.tests,
        duplicate_tests: sum.duplicate_tests + c.duplicate_tests,
    })
}

#[test]
fn mailboxes_leave_almost_no_duplicate_test() {
    let mesh = mesh(&soup(2000, 0.3, 12));
    let rays = rays(&mesh, 1000, 13);
    let (on, off) = (
        counts(&mesh, "grid", 24, &rays),
        counts(&mesh, "grid:mailbox=off", 24, &rays),
    );
    assert!(off.duplicate_tests > off.tests / 3);
    // Hash collisions only.
    assert!(on.duplicate_tests * 100 < on.tests, "{on:?}");
    assert_eq!(on.steps, off.steps);
    assert_eq!(
        on.tests - on.duplicate_tests,
        off.tests - off.duplicate_tests
    );
}

#[test]
fn a_walk_ends_behind_the_nearest_hit() {
    let mesh = mesh(&sphere(24));
    let ray = [Ray::new(Vec3::new(-3.0, 0.01, 0.02), Vec3::X)];
    // The near side is met in one of the first cells of 32.
    assert!(counts(&mesh, "grid", 32, &ray).steps <= 3);
}

#[test]
fn grids_beyond_the_memory_limit_are_refused_with_the_largest_n_that_fits() {
    let mesh = mesh(&soup(1000, 0.1, 3));
    let choice = parse("grid").unwrap();
    let kernel = kernel::parse("moller-trumbore").unwrap();
    let build = |n, limit| build_any(&mesh, &choice, Some(n), &kernel, limit).err();
    let Some(BuildError::TooLarge {
        predicted_bytes,
        largest_n,
        limit_bytes,
        ..
    }) = build(512, 1 << 20)
    else {
        panic!("not refused");
    };
    assert!(predicted_bytes > 4 * 512_u64.pow(3) && limit_bytes == 1 << 20);
    assert!((50..64).contains(&largest_n), "{largest_n}");
    assert_eq!(build(largest_n, 1 << 20), None);
    assert!(build(largest_n + 1, 1 << 20).is_some());
    assert!(build(MAX_N + 1, u64::MAX).is_some());
    assert!(build(u32::MAX, u64::MAX).is_some());
    assert_eq!(
        build(0, 1 << 20),
        None,
        "0 is taken for 1; who reads n refuses it"
    );
}

/// Asserts that what is predicted of `mesh` at `n` is within `tolerance` of what random lines count.
fn assert_predicted(name: &str, mesh: &Arc<Mesh>, text: &str, n: u32, tolerance: [f64; 3]) {
    let settings = settings(text);
    let (lattice, lists) = lists(mesh, text, n);
    let references = lists.prims.len() as f64;
    let mut dice = Dice::new(17);
    let lines: Vec<Ray> = (0..3000)
        .map(|_| random_line(mesh.bounds(), &mut dice))
        .collect();
    let [steps, tests] = if settings.mailbox {
        tally(
            &Grid::<Hashed> {
                lattice,
                lists,
                mailbox: PhantomData,
            },
            &lines,
        )
    } else {
        tally(
            &Grid::<Forgetful> {
                lattice,
                lists,
                mailbox: PhantomData,
            },
            &lines,
        )
    };
    let predicted = Model::new(mesh, settings).predict(n);
    for (what, predicted, counted, tolerance) in [
        ("references", predicted.references, references, tolerance[0]),
        ("steps", predicted.steps, steps, tolerance[1]),
        ("tests", predicted.tests, tests, tolerance[2]),
    ] {
        let off = predicted / counted - 1.0;
        assert!(
            off.abs() < tolerance,
            "{name} {text} {n}: {what} {predicted} for {counted}, off by {off:.4}"
        );
    }
}

/// Mean steps and tests of a line.
fn tally<M: Mailbox>(grid: &Grid<M>, lines: &[Ray]) -> [f64; 2] {
    let trails = lines.iter().map(|line| trail(grid, line));
    let [steps, tests] = trails.fold([0, 0], |[steps, tests], trail| {
        [steps + trail.cells.len() as u64, tests + trail.tests]
    });
    [steps, tests].map(|sum| sum as f64 / lines.len() as f64)
}

#[test]
fn predictions_meet_the_counts_of_random_lines() {
    let flat: Vec<_> = soup(3000, 0.2, 9)
        .iter()
        .map(|t| t.map(|p| Vec3::new(p.x, 3.0 * p.y, 0.0)))
        .collect();
    let slab: Vec<_> = soup(3000, 0.2, 9)
        .iter()
        .map(|t| t.map(|p| p * Vec3::new(2.0, 1.0, 0.3)))
        .collect();
    // Turned, because triangles with corners on cell planes are listed on both sides: no model of random planes.
    let turn = glam::Quat::from_scaled_axis(Vec3::new(0.3, 0.5, 0.7));
    let turned_sphere = sphere(40).iter().map(|t| t.map(|p| turn * p)).collect();
    for (name, triangles) in [
        ("sphere", turned_sphere),
        ("soup", soup(4000, 0.1, 2)),
        ("large soup", soup(400, 0.7, 3)),
        ("needles", needles(1000)),
        ("slab", slab),
        ("flat", flat),
    ] {
        let mesh = mesh(&triangles);
        for n in [16, 50] {
            for (text, tolerance) in [
                ("grid", [0.03, 0.02, 0.05]),
                ("grid:mailbox=off", [0.03, 0.02, 0.03]),
                ("grid:shape=cubic:mailbox=off", [0.03, 0.02, 0.03]),
                ("grid:overlap=bbox:mailbox=off", [0.04, 0.02, 0.04]),
            ] {
                assert_predicted(name, &mesh, text, n, tolerance);
            }
        }
    }
}

#[test]
fn the_best_n_is_the_least_of_the_model_and_auto_takes_the_coarsest_as_good() {
    for (name, mesh) in nasty() {
        for text in ["grid", "grid:mailbox=off:shape=cubic"] {
            let model = Model::new(&mesh, settings(text));
            let (best, [first, last]) = model.best();
            assert!(first <= best && best <= last && last <= MAX_N, "{name}");
            assert!(
                (1..=model.largest_auto_n()).all(|n| model.cost(best) <= model.cost(n)),
                "{name}"
            );
            assert!(
                (first..=last).all(|n| model.cost(n) <= 1.05 * model.cost(best)),
                "{name}"
            );
            let (auto, plateau) = model.auto();
            assert_eq!(plateau, [first, last], "{name}");
            let is_as_good = |n: u32| model.cost(n) <= 1.02 * model.cost(best);
            assert!((auto..=best).all(is_as_good), "{name}");
            assert!(auto == 1 || !is_as_good(auto - 1), "{name}");
        }
    }
}

#[test]
fn the_best_n_of_a_cube_is_the_root_of_the_published_cubic() {
    // n³ = c·(W·n + 2N), with W the sum of extents of all axes in a unit cube.
    let mesh = mesh(&soup(20_000, 0.02, 6));
    let model = Model::new(&mesh, settings("grid:mailbox=off"));
    let side = mesh.bounds().extent().x;
    let extents: f32 = (0..mesh.len() as u32)
        .map(|prim| mesh.triangle_bounds(prim).extent().element_sum())
        .sum();
    let (w, n) = (f64::from(extents / side), mesh.len() as f64);
    let c = model.cost(1) - model.steps(1);
    let c = c / model.tests(1);
    let root = (1..1000)
        .map(f64::from)
        .find(|x| x.powi(3) - c * (w * x + 2.0 * n) > 0.0)
        .unwrap();
    let (best, _) = model.best();
    assert!(
        (f64::from(best) / root - 1.0).abs() < 0.03,
        "{best} for {root}"
    );
}

#[test]
fn empty_and_point_meshes_have_finite_predictions() {
    for triangles in [vec![], vec![[Vec3::ONE; 3]]] {
        let mesh = mesh(&triangles);
        for n in [1, 7, MAX_N] {
            let predicted = Model::new(&mesh, settings("grid")).predict(n);
            assert!(predicted.steps == 1.0 && predicted.tests.is_finite());
            assert_eq!(predicted.references, mesh.len() as f64);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_soup_in_any_grid_is_answered_as_by_brute_force(
        count in 0_u32..100,
        size in prop_oneof![Just(0.0_f32), 1e-4_f32..2.0],
        n in 1_u32..50,
        accel in prop_oneof![Just("grid"), Just("grid:overlap=sat:mailbox=off"), Just("grid:overlap=bbox:shape=cubic")],
        snap in prop_oneof![Just(0.0_f32), Just(4.0), Just(8.0)],
        seed in any::<u64>(),
    ) {
        // Snapped to a coarse raster: vertices, edges and whole triangles lie on cell planes, and many are degenerate.
        let place = |p: Vec3| if snap > 0.0 { (p * snap).round() / snap } else { p };
        let triangles: Vec<_> = soup(count, size, seed).iter().map(|t| t.map(place)).collect();
        let mesh = mesh(&triangles);
        assert_agrees_at("soup", &mesh, (accel, Some(n)), &rays(&mesh, 150, seed ^ 1), 0);
    }
}
