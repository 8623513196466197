//! The grid as a whole: answers against brute force, one by one and side by side, and that the checks find what is wrong.

use std::sync::Arc;

use proptest::prelude::*;

use super::super::testbed::{
    assert_agrees, assert_agrees_at, assert_agrees_with, built_at, mesh, nasty, pencil, ray_count,
    rays, soup, sphere,
};
use super::super::{build_for, parse};
use super::*;
use crate::geometry::Hit;
use crate::geometry::lanes::InstructionSet;
use crate::kernel;

#[test]
fn nasty_meshes_are_answered_as_by_brute_force() {
    for (name, mesh) in nasty() {
        let rays = rays(&mesh, ray_count(&mesh), 7);
        assert_agrees(name, &mesh, "grid-skip", &rays);
        // Ten thousand equal triangles would be listed by every cell of a plane.
        let fine: &[u32] = if name == "twins" { &[] } else { &[33, 100] };
        for &n in [1, 2, 7].iter().chain(fine) {
            assert_agrees_at(name, &mesh, ("grid-skip", Some(n)), &rays, 0);
        }
        assert_agrees_at(name, &mesh, ("grid-skip:overlap=bbox", Some(9)), &rays, 0);
    }
}

#[test]
fn the_finest_grid_and_a_slim_one_are_answered_as_by_brute_force() {
    // Along x the errors of the walk, in cells, are the greatest that there are.
    let slim = |t: [Vec3; 3]| t.map(|p| p * Vec3::new(1.0, 0.02, 0.02));
    let mesh = mesh(&soup(300, 0.05, 5).into_iter().map(slim).collect::<Vec<_>>());
    let rays = rays(&mesh, 4000, 6);
    assert_agrees_at("slim", &mesh, ("grid-skip", Some(1024)), &rays, 0);
    let pencil = pencil(&mesh, 4000, 6);
    assert_agrees_at("slim", &mesh, ("grid-skip", Some(1024)), &pencil, 0);
}

#[test]
fn packets_are_answered_as_by_brute_force() {
    for (name, mesh) in nasty() {
        for seed in 1..4 {
            let rays = pencil(&mesh, ray_count(&mesh), seed);
            // See above for the twins.
            let fine: &[u32] = if name == "twins" { &[] } else { &[33, 100] };
            for n in [1, 7].iter().chain(fine) {
                for kernel in ["moller-trumbore", "woop"] {
                    assert_agrees_with(kernel, name, &mesh, ("grid-skip", Some(*n)), &rays, 0);
                }
            }
        }
    }
}

/// What a build needs.
fn request<'a>(
    mesh: &'a Arc<Mesh>,
    accel: &'a crate::registry::Choice,
    n: u32,
) -> BuildRequest<'a> {
    BuildRequest {
        mesh,
        kernel: accel,
        params: &accel.params,
        n: Some(n),
        memory_limit: u64::MAX,
        set: InstructionSet::Portable,
    }
}

/// The grid over `mesh` at resolution `n`.
pub(super) fn grid_of(mesh: &Arc<Mesh>, n: u32) -> GridSkip {
    let accel = parse("grid-skip").unwrap();
    GridSkip::new(&request(mesh, &accel, n)).unwrap().0
}

#[test]
fn a_distance_one_too_great_is_found_in_every_direction() {
    let (mesh, accel) = (mesh(&sphere(8)), parse("grid-skip").unwrap());
    let (mut grid, slots) = GridSkip::new(&request(&mesh, &accel, 9)).unwrap();
    grid.validate(&mesh, &slots).unwrap();
    let cells = grid.bricks.len();
    for octant in 0..OCTANTS {
        // From the middle on, so that there is something ahead.
        let place = (octant * cells + cells / 2..(octant + 1) * cells)
            .find(|&place| (1..5).contains(&grid.distances[place]))
            .unwrap();
        grid.distances[place] += 1;
        let broken = grid.validate(&mesh, &slots).unwrap_err();
        assert!(broken.contains("too far"), "{broken}");
        grid.distances[place] -= 1;
    }
    let listed = grid.distances.iter().position(|&d| d == 0).unwrap();
    grid.distances[listed] = 1;
    let broken = grid.validate(&mesh, &slots).unwrap_err();
    assert!(broken.contains("against its bit"), "{broken}");
}

#[test]
fn distances_one_too_great_lose_hits() {
    let mesh = mesh(&soup(300, 0.1, 4));
    let (accel, kernel) = (parse("grid-skip").unwrap(), kernel::parse("woop").unwrap());
    let request = BuildRequest {
        kernel: &kernel,
        ..request(&mesh, &accel, 24)
    };
    let rays = rays(&mesh, 500, 2);
    let hits = |more: u8| {
        let (mut grid, slots) = GridSkip::new(&request).unwrap();
        for distance in grid.distances.iter_mut().filter(|distance| **distance > 0) {
            *distance = distance.saturating_add(more);
        }
        let mut hits = vec![Hit::MISS; rays.len()];
        let accel = finish_in_order(grid, &slots, &request).unwrap();
        accel.closest(&rays, &mut hits);
        hits.iter().filter(|hit| hit.is_hit()).count()
    };
    assert!(hits(1) < hits(0));
}

#[test]
fn a_cell_with_the_blocks_of_another_is_found() {
    let (mesh, accel) = (mesh(&sphere(8)), parse("grid-skip").unwrap());
    let (mut grid, slots) = GridSkip::new(&request(&mesh, &accel, 9)).unwrap();
    let last = grid.cells.spans.len() - 1;
    grid.cells.spans[0] = grid.cells.spans[last];
    let broken = grid.validate(&mesh, &slots).unwrap_err();
    assert!(broken.contains("not listed"), "{broken}");
    grid.cells.spans[0].first = u32::MAX;
    let broken = grid.validate(&mesh, &slots).unwrap_err();
    assert!(broken.contains("blocks"), "{broken}");
}

#[test]
fn a_grid_is_the_same_whatever_the_number_of_threads() {
    let (mesh, accel) = (mesh(&soup(6000, 0.1, 8)), parse("grid-skip").unwrap());
    let built = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let grid = pool
            .unwrap()
            .install(|| GridSkip::new(&request(&mesh, &accel, 40)));
        let (grid, slots) = grid.unwrap();
        (grid.distances, grid.cells.spans, grid.filled, slots)
    };
    assert!(built(1) == built(3));
}

#[test]
fn a_grid_beyond_the_limit_is_refused_with_one_that_fits() {
    let mesh = mesh(&sphere(16));
    let accel = parse("grid-skip").unwrap();
    let limited = |n: u32, memory_limit: u64| {
        GridSkip::new(&BuildRequest {
            memory_limit,
            ..request(&mesh, &accel, n)
        })
        .map(|(grid, _)| grid)
    };
    let Err(BuildError::TooLarge { largest_n, .. }) = limited(1024, 4 << 20) else {
        panic!("a billion cells do not fit into 4 MB");
    };
    assert!((20..80).contains(&largest_n), "{largest_n}");
    assert!(limited(largest_n + 1, 4 << 20).is_err());
    assert!(limited(largest_n, 4 << 20).is_ok());
    assert!(limited(MAX_N + 1, u64::MAX).is_err());
}

#[test]
fn batches_of_any_length_are_answered_ray_by_ray() {
    let mesh = mesh(&soup(400, 0.3, 9));
    let accel = built_at(&mesh, "grid-skip", Some(12), "woop");
    let rays = rays(&mesh, 200, 3);
    let alone: Vec<Hit> = rays
        .iter()
        .map(|ray| {
            let mut hit = [Hit::MISS];
            accel.closest(std::slice::from_ref(ray), &mut hit);
            hit[0]
        })
        .collect();
    for count in [0, 1, 2, 15, 16, 17, 31, 100, rays.len()] {
        let mut hits = vec![Hit::MISS; count];
        accel.closest(&rays[..count], &mut hits);
        assert!(
            hits.iter().zip(&alone).all(|(a, b)| a.same_answer(b)),
            "{count}"
        );
    }
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    let small = nasty().into_iter().filter(|(_, mesh)| mesh.len() < 3000);
    for (name, mesh) in small {
        let rays = rays(&mesh, 300, 9);
        let of = |set: InstructionSet| {
            let (accel, kernel) = (parse("grid-skip").unwrap(), kernel::parse("woop").unwrap());
            let accel = build_for(set, &mesh, &accel, Some(20), &kernel, u64::MAX).unwrap();
            let (mut hits, mut blocked) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
            accel.closest(&rays, &mut hits);
            accel.occluded(&rays, &mut blocked);
            let bits = |h: &Hit| [h.prim, h.t.to_bits(), h.u.to_bits(), h.v.to_bits()];
            (hits.iter().map(bits).collect::<Vec<_>>(), blocked)
        };
        let plain = of(InstructionSet::Portable);
        for set in InstructionSet::ALL.into_iter().filter(|s| s.is_available()) {
            assert!(of(set) == plain, "{name}, {set}");
        }
    }
}

#[test]
fn a_ray_is_in_the_box_of_each_place_from_its_entry_to_its_exit() {
    let mesh = mesh(&sphere(16));
    let accel = built_at(&mesh, "grid-skip", Some(31), "woop");
    for ray in rays(&mesh, 300, 3) {
        let visits = accel.inspect(&ray).visits;
        for pair in visits.windows(2) {
            assert_eq!(pair[0].exit, pair[1].entry);
        }
        for visit in visits {
            let bounds = visit.bounds.unwrap();
            for t in [visit.entry, visit.exit] {
                let at = ray.origin.as_dvec3() + ray.dir.as_dvec3() * t;
                let beyond = (bounds.min.as_dvec3() - at).max(at - bounds.max.as_dvec3());
                assert!(beyond.max_element() < 1e-5, "{beyond}, {visit:?}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn any_soup_is_answered_as_by_brute_force(
        count in 0_u32..120,
        size in prop_oneof![Just(0.0_f32), 1e-4_f32..2.0],
        n in 1_u32..80,
        seed in any::<u64>(),
    ) {
        let mesh = mesh(&soup(count, size, seed));
        let rays = rays(&mesh, 300, seed ^ 1);
        assert_agrees_at("soup", &mesh, ("grid-skip", Some(n)), &rays, 0);
        assert_agrees_at("soup", &mesh, ("grid-skip:shape=n3", Some(n)), &rays, 0);
        let pencil = pencil(&mesh, 300, seed ^ 2);
        assert_agrees_at("soup", &mesh, ("grid-skip", Some(n)), &pencil, 0);
    }
}
