//! The octree as a whole.

use proptest::prelude::*;

use super::super::stack::MAX_DEPTH;
use super::super::testbed::{
    assert_agrees, assert_agrees_on_nasty, assert_same_on_threads, geometric, mesh, rays, soup,
    sphere,
};
use super::super::{Structure, StructureStats};
use super::*;

fn tree(mesh: &Mesh) -> (PlaneTree, Vec<u32>) {
    let (tree, slots) = build(mesh);
    tree.validate(mesh, &slots).expect("valid");
    (tree, slots)
}

fn stats(mesh: &Mesh) -> StructureStats {
    tree(mesh).0.stats()
}

#[test]
fn nasty_meshes_are_answered_as_by_brute_force() {
    assert_agrees_on_nasty("octree");
}

#[test]
fn one_thread_and_many_build_the_same_tree() {
    let mesh = mesh(&soup(20_000, 0.05, 10));
    assert_same_on_threads(|| tree(&mesh));
}

#[test]
fn a_node_has_eight_children() {
    let stats = stats(&mesh(&sphere(64)));
    // Each node but the root is one of eight.
    assert_eq!((stats.cells - 1) % 8, 0);
    assert!(stats.depth >= 3, "{stats:?}");
}

#[test]
fn a_flat_scene_is_divided_into_quarters() {
    let triangles: Vec<_> = sphere(32)
        .into_iter()
        .map(|corners| {
            corners.map(|mut p| {
                p.y = 0.25;
                p
            })
        })
        .collect();
    let stats = stats(&mesh(&triangles));
    assert_eq!((stats.cells - 1) % 4, 0);
    assert!(stats.depth >= 2, "{stats:?}");
}

#[test]
fn identical_triangles_are_not_divided_without_end() {
    let twin = soup(1, 1.0, 3)[0];
    let stats = stats(&mesh(&vec![twin; 1000]));
    assert!(stats.references <= 64_000, "{stats:?}");
}

#[test]
fn the_depth_stays_bounded_where_triangles_gather_in_a_corner() {
    let stats = stats(&mesh(&geometric(-120..149).repeat(20)));
    assert!(
        stats.depth > 5 && 3 * stats.depth <= MAX_DEPTH as u32,
        "{stats:?}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn any_soup_is_answered_as_by_brute_force(
        count in 0_u32..120,
        size in prop_oneof![Just(0.0_f32), 1e-4_f32..2.0],
        seed in any::<u64>(),
    ) {
        let mesh = mesh(&soup(count, size, seed));
        assert_agrees("soup", &mesh, "octree", &rays(&mesh, 200, seed ^ 1));
    }
}
