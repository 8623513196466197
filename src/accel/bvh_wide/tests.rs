//! The wide tree as a whole: answers against brute force, in every way and on every instruction set. Ways other than one ray
//! after another, and sets, are those of optimised builds.

use std::sync::Arc;

use proptest::prelude::*;

use super::super::testbed::{
    Dice, assert_agrees, built, mesh, nasty, ray_count, rays, soup, sphere,
};
use super::super::{build_for, parse};
use crate::geometry::lanes::InstructionSet;
use crate::geometry::{Aabb, Hit, Ray, Vec3};
use crate::kernel;
use crate::scene::Mesh;

/// The ways, in the words of the command line.
const WAYS: [&str; 6] = [
    "bvh-wide",
    "bvh-wide:way=single",
    "bvh-wide:way=hybrid",
    "bvh-wide:way=interleaved",
    "bvh-wide:way=mixed",
    "bvh-wide:way=packets",
];

/// Pencils of rays, each from one origin: narrow and wide ones, and a few rays that fit into none.
fn pencils(mesh: &Mesh, count: u32, seed: u64) -> Vec<Ray> {
    let mut dice = Dice::new(seed);
    let bounds = if mesh.is_empty() {
        Aabb::of_points([-Vec3::ONE, Vec3::ONE])
    } else {
        mesh.bounds()
    };
    let (centre, half) = (bounds.centre(), bounds.extent() * 0.5);
    let radius = half.max_element().max(1.0);
    let mut rays = Vec::new();
    while (rays.len() as u32) < count {
        let origin = centre + 2.0 * radius * dice.vector();
        let target = centre + half * dice.vector();
        let spread = [0.0, 1e-3, 0.1, 1.0][dice.below(4) as usize] * radius;
        for _ in 0..dice.below(150) {
            let aim = if dice.below(4) == 0 && !mesh.is_empty() {
                mesh.corners(dice.below(mesh.len() as u32))[0]
            } else {
                target + spread * dice.vector()
            };
            let mut ray = Ray::new(origin, aim - origin);
            if dice.below(8) == 0 {
                ray.t_max = dice.signed().abs();
            }
            if ray.is_valid() {
                rays.push(ray);
            }
        }
    }
    rays
}

#[test]
fn nasty_meshes_are_answered_as_by_brute_force_in_every_way() {
    for (name, mesh) in nasty() {
        let mut rays = rays(&mesh, ray_count(&mesh), 7);
        rays.extend(pencils(&mesh, ray_count(&mesh), 8));
        for accel in WAYS {
            assert_agrees(name, &mesh, accel, &rays);
        }
    }
}

#[test]
fn batches_of_any_length_are_answered_also_where_the_root_is_a_leaf() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    for mesh in [mesh(&[triangle]), mesh(&sphere(16))] {
        let mut dice = Dice::new(11);
        let rays: Vec<Ray> = (0..300)
            .map(|_| Ray::new(Vec3::Z + 1e-3 * dice.vector(), dice.vector()))
            .filter(Ray::is_valid)
            .collect();
        for count in [0, 1, 17, 31, 32, 33, 100, 127, 128, 129, rays.len()] {
            for accel in WAYS {
                assert_agrees("of some length", &mesh, accel, &rays[..count]);
            }
        }
    }
}

#[test]
fn rays_that_cannot_tell_a_box_from_an_empty_lane_are_answered_as_by_brute_force() {
    for scale in [1e-38_f32, 1e-30, 1e30] {
        let scaled = |t: &[Vec3; 3]| t.map(|corner| corner * scale);
        let mesh = mesh(&sphere(16).iter().map(scaled).collect::<Vec<_>>());
        for accel in WAYS {
            for seed in [21, 22] {
                assert_agrees("scaled", &mesh, accel, &rays(&mesh, 300, seed));
            }
        }
    }
}

#[test]
fn a_long_batch_of_which_parts_suit_groups_and_others_turns_is_answered_as_one_ray_after_another() {
    let mesh = mesh(&sphere(16));
    let mut dice = Dice::new(12);
    let mut rays = Vec::new();
    for part in 0..4 {
        // Near origins, so that groups are tried; in every other part rays go the same way for long.
        let spread = [1e-3, 3.0][part % 2];
        let way = dice.vector();
        rays.extend((0..2500).map(|_| {
            let origin = -2.0 * way + 1e-2 * dice.vector();
            Ray::new(origin, way + spread * dice.vector())
        }));
    }
    rays.retain(Ray::is_valid);
    let of = |accel| answers(InstructionSet::best(), &mesh, accel, "woop", &rays);
    let single = of("bvh-wide:way=single");
    assert!(single.1.contains(&true) && single.1.contains(&false));
    for accel in WAYS {
        assert!(of(accel) == single, "{accel}");
    }
}

/// Answers of both queries, as bits.
type Bits = (Vec<[u32; 4]>, Vec<bool>);

fn answers(set: InstructionSet, mesh: &Arc<Mesh>, accel: &str, kernel: &str, rays: &[Ray]) -> Bits {
    let (accel, kernel) = (parse(accel).unwrap(), kernel::parse(kernel).unwrap());
    let accel = build_for(set, mesh, &accel, None, &kernel, u64::MAX).unwrap();
    let (mut hits, mut blocked) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
    accel.closest(rays, &mut hits);
    accel.occluded(rays, &mut blocked);
    let bits = |h: &Hit| [h.prim, h.t.to_bits(), h.u.to_bits(), h.v.to_bits()];
    (hits.iter().map(bits).collect(), blocked)
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    // Many equal triangles would only take long.
    let small = nasty().into_iter().filter(|(_, mesh)| mesh.len() < 3000);
    for (name, mesh) in small.chain([("large", mesh(&sphere(40)))]) {
        let mut rays = rays(&mesh, 100, 9);
        rays.extend(pencils(&mesh, 300, 10));
        for accel in WAYS {
            for kernel in kernel::KERNELS {
                let of = |set| answers(set, &mesh, accel, kernel.name, &rays);
                let plain = of(InstructionSet::Portable);
                for set in InstructionSet::ALL.into_iter().filter(|s| s.is_available()) {
                    assert!(of(set) == plain, "{name}, {accel}, {}, {set}", kernel.name);
                }
            }
        }
    }
}

#[test]
fn leaves_are_filled_well_and_nodes_are_wide() {
    let mesh = mesh(&sphere(64));
    let stats = built(&mesh, "bvh-wide", "woop").stats();
    assert_eq!(stats.references, mesh.len() as u64);
    // 8,192 triangles: a leaf holds from one block on, and a node has nearly eight children.
    assert!(stats.cells < 2200, "{stats:?}");
    assert!(stats.depth <= 6, "{stats:?}");
}

#[test]
fn a_place_is_known_by_its_box() {
    let mesh = mesh(&sphere(16));
    let accel = built(&mesh, "bvh-wide", "woop");
    for ray in rays(&mesh, 50, 3) {
        for visit in accel.inspect(&ray).visits {
            assert!(visit.bounds.is_some(), "{visit:?}");
        }
    }
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
        let mut rays = rays(&mesh, 200, seed ^ 1);
        rays.extend(pencils(&mesh, 200, seed ^ 2));
        for accel in WAYS {
            assert_agrees("soup", &mesh, accel, &rays);
        }
    }
}
