//! Both levels as a whole: answers against brute force, and that the checks find what is missing.

use proptest::prelude::*;

use super::super::testbed::{
    assert_agrees, assert_agrees_at, built_at, mesh, nasty, ray_count, rays, soup, sphere,
};
use super::super::{BuildRequest, parse};
use super::*;
use crate::geometry::lanes::InstructionSet;
use crate::kernel;

#[test]
fn nasty_meshes_are_answered_as_by_brute_force() {
    for (name, mesh) in nasty() {
        let rays = rays(&mesh, ray_count(&mesh), 7);
        assert_agrees(name, &mesh, "grid-2level", &rays);
        for accel in [
            "grid-2level:density=8",
            "grid-2level:density=0.3",
            "grid-2level:overlap=bbox",
        ] {
            // Ten thousand equal triangles would be listed by every cell of a plane.
            let fine = if name == "twins" { 2 } else { 9 };
            for n in [1, fine] {
                assert_agrees_at(name, &mesh, (accel, Some(n)), &rays, 0);
            }
        }
    }
}

/// The structure over `triangles` at `n`, and the triangles of its lanes.
fn structure(triangles: &[[Vec3; 3]], n: u32) -> (std::sync::Arc<Mesh>, Grid2Level, Vec<u32>) {
    let mesh = mesh(triangles);
    let kernel = kernel::parse("woop").unwrap();
    let (grid, slots) = build::build(&BuildRequest {
        mesh: &mesh,
        kernel: &kernel,
        params: &parse(ENTRY.name).unwrap().params,
        n: Some(n),
        memory_limit: u64::MAX,
        set: InstructionSet::Portable,
    })
    .unwrap();
    (mesh, grid, slots)
}

#[test]
fn a_cell_that_lost_its_triangles_is_found() {
    let (mesh, mut grid, slots) = structure(&sphere(12), 4);
    validate::check(&grid, &mesh, &slots).unwrap();
    let lost = grid.spans.iter().rposition(|span| span.count > 0).unwrap();
    let span = std::mem::take(&mut grid.spans[lost]);
    let broken = validate::check(&grid, &mesh, &slots).unwrap_err();
    assert!(broken.contains("not listed"), "{broken}");
    grid.spans[lost] = span;
    grid.inner[3].first += 1;
    let broken = validate::check(&grid, &mesh, &slots).unwrap_err();
    assert!(broken.contains("coarse cell"), "{broken}");
}

#[test]
fn fine_grids_are_as_fine_as_their_cells_are_full() {
    assert_eq!(fine_dims([1.0; 3], 1, 1.0), [1; 3]);
    assert_eq!(fine_dims([1.0; 3], 64, 1.0), [4; 3]);
    assert_eq!(fine_dims([2.0, 1.0, 1.0], 16, 1.0), [4, 2, 2]);
    assert_eq!(fine_dims([1.0, 1.0, 0.0], 16, 1.0), [4, 4, 1]);
    assert_eq!(fine_dims([0.0; 3], 9, 1.0), [1; 3]);
    assert_eq!(fine_dims([1.0; 3], usize::MAX, 64.0), [MOST as u8; 3]);
}

#[test]
fn a_place_is_known_by_its_box_and_boxes_of_a_cell_lie_in_it() {
    let mesh = mesh(&sphere(16));
    let accel = built_at(&mesh, "grid-2level", Some(5), "woop");
    for ray in rays(&mesh, 50, 3) {
        let mut around = Aabb::EMPTY;
        for visit in accel.inspect(&ray).visits {
            let bounds = visit.bounds.unwrap();
            if visit.place & FINE == 0 {
                around = bounds;
            } else {
                assert!(bounds.min.cmpge(around.min).all() && bounds.max.cmple(around.max).all());
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
        n in 1_u32..12,
        seed in any::<u64>(),
    ) {
        let mesh = mesh(&soup(count, size, seed));
        let rays = rays(&mesh, 300, seed ^ 1);
        assert_agrees_at("soup", &mesh, ("grid-2level", Some(n)), &rays, 0);
        assert_agrees_at("soup", &mesh, ("grid-2level:shape=n3", Some(n)), &rays, 0);
    }
}
