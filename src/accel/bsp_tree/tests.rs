//! The tree of planes in any direction as a whole.

use proptest::prelude::*;

use super::super::stack::MAX_DEPTH;
use super::super::testbed::{
    assert_agrees, assert_agrees_on_nasty, assert_agrees_with, assert_same_on_threads, built,
    geometric, mesh, rays, soup, sphere,
};
use super::super::{Counts, Structure, StructureStats};
use super::*;
use crate::geometry::Hit;

fn tree(mesh: &Mesh) -> (PlaneTree, Vec<u32>) {
    let (tree, slots) = build(mesh, u64::MAX).expect("no limit");
    tree.validate(mesh, &slots).expect("valid");
    (tree, slots)
}

fn stats(mesh: &Mesh) -> StructureStats {
    tree(mesh).0.stats()
}

#[test]
fn nasty_meshes_are_answered_as_by_brute_force() {
    assert_agrees_on_nasty("bsp-tree");
}

#[test]
fn one_thread_and_many_build_the_same_tree() {
    let mesh = mesh(&soup(3000, 0.1, 10));
    assert_same_on_threads(|| tree(&mesh));
}

#[test]
fn a_convex_body_is_cut_off_by_the_planes_of_its_faces() {
    let mesh = mesh(&sphere(8));
    let tested = |accel: &str| {
        let accelerator = built(&mesh, accel, "woop");
        let rays = rays(&mesh, 1000, 4);
        let mut hits = vec![Hit::MISS; rays.len()];
        let mut counts = vec![Counts::default(); rays.len()];
        accelerator.closest_counted(&rays, &mut hits, &mut counts);
        counts.iter().map(|count| count.tests).sum::<u64>()
    };
    assert!(tested("bsp-tree") < tested("kd-tree"));
}

#[test]
fn identical_triangles_are_not_cut_without_end() {
    let twin = soup(1, 1.0, 3)[0];
    let stats = stats(&mesh(&vec![twin; 2000]));
    assert!(stats.references <= 32_000, "{stats:?}");
}

#[test]
fn the_depth_stays_bounded_where_planes_peel_off_one_triangle_at_a_time() {
    let stats = stats(&mesh(&geometric(-120..149).repeat(20)));
    assert!(stats.depth <= MAX_DEPTH as u32, "{stats:?}");
}

#[test]
fn a_build_that_grows_beyond_its_limit_is_given_up_with_a_remedy() {
    let mesh = mesh(&soup(3000, 0.3, 5));
    let accel = built(&mesh, "bsp-tree", "woop");
    let least = mesh.len().div_ceil(LANES) as u64 * BLOCK_BYTES;
    // The limit is one of what is built, and not only of what the triangles take.
    assert!(accel.memory_bytes() > 3 * least);
    for (limit_bytes, fits) in [
        (accel.memory_bytes() * 2, true),
        (accel.memory_bytes() / 2, false),
        (least, false),
        (least - 1, false),
        (0, false),
    ] {
        let refused = BuildError::Outgrown {
            accel: "bsp-tree",
            limit_bytes,
        };
        let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        for threads in [1, 5] {
            let built = pool(threads)
                .expect("a pool")
                .install(|| build(&mesh, limit_bytes));
            assert_eq!(built.as_ref().err(), (!fits).then_some(&refused));
        }
    }
    let refused = BuildError::Outgrown {
        accel: "bsp-tree",
        limit_bytes: 5 << 20,
    };
    assert_eq!(
        refused.to_string(),
        "bsp-tree over this scene takes more than the limit of 5 MB; choose a structure that lists each triangle once, \
         e.g. bvh-wide"
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
        let rays = rays(&mesh, 200, seed ^ 1);
        assert_agrees("soup", &mesh, "bsp-tree", &rays);
        assert_agrees_with("exact", "soup", &mesh, ("bsp-tree", None), &rays, 0);
    }
}
