//! The kd-tree as a whole.

use proptest::prelude::*;

use super::super::stack::MAX_DEPTH;
use super::super::testbed::{
    assert_agrees, assert_agrees_on_nasty, assert_same_on_threads, built, geometric, mesh, rays,
    soup, sphere,
};
use super::super::{Structure, StructureStats};
use super::*;

fn tree(mesh: &Mesh) -> (PlaneTree, Vec<u32>) {
    let (tree, slots) = build(mesh, &Params::defaults(ENTRY.params));
    tree.validate(mesh, &slots).expect("valid");
    (tree, slots)
}

fn stats(mesh: &Mesh) -> StructureStats {
    tree(mesh).0.stats()
}

#[test]
fn nasty_meshes_are_answered_as_by_brute_force() {
    assert_agrees_on_nasty("kd-tree");
    assert_agrees_on_nasty("kd-tree:clip=off");
}

#[test]
fn one_thread_and_many_build_the_same_tree() {
    let mesh = mesh(&soup(20_000, 0.05, 10));
    assert_same_on_threads(|| tree(&mesh));
}

#[test]
fn identical_triangles_end_in_one_leaf_at_once() {
    let twin = soup(1, 1.0, 3)[0];
    let stats = stats(&mesh(&vec![twin; 10_000]));
    assert_eq!((stats.depth, stats.references), (0, 10_000));
}

#[test]
fn the_depth_stays_bounded_where_planes_peel_off_one_triangle_at_a_time() {
    let stats = stats(&mesh(&geometric(-120..149).repeat(20)));
    assert!(
        stats.depth > 20 && stats.depth <= MAX_DEPTH as u32,
        "{stats:?}"
    );
}

#[test]
fn clipping_saves_references() {
    let mesh = mesh(&soup(2000, 0.3, 5));
    let references = |accel| built(&mesh, accel, "moller-trumbore").stats().references;
    assert!(references("kd-tree") < references("kd-tree:clip=off"));
}

#[test]
fn nodes_and_references_grow_in_proportion_to_the_triangles() {
    let per_triangle = |n: u32| {
        let mesh = mesh(&sphere(n));
        let stats = stats(&mesh);
        (stats.cells + stats.references) as f64 / mesh.len() as f64
    };
    let (small, large) = (per_triangle(10), per_triangle(80));
    assert!(large < 2.0 * small, "{small} and {large} a triangle");
}

#[test]
fn empty_space_is_cut_off() {
    assert!(stats(&mesh(&sphere(32))).empty_cells > 50);
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
        assert_agrees("soup", &mesh, "kd-tree", &rays(&mesh, 200, seed ^ 1));
    }
}
