//! Rays that leave a triangle must not hit it again, whatever its scale and place.

use proptest::prelude::*;
use raylab::geometry::lanes::LaneMask;
use raylab::geometry::lanes::LaneRay;
use raylab::geometry::{Ray, SurfacePoint, Vec3, unit_normal};
use raylab::kernel::{self, Kernel, KernelUser};

/// Whether `ray` hits the triangle.
struct SelfHit {
    ray: Ray,
    corners: [Vec3; 3],
}

impl KernelUser for SelfHit {
    type Out = bool;
    fn with<K: Kernel>(self, kernel: K) -> bool {
        let triangle = kernel.pack::<1>(|_| self.corners);
        let prepared = kernel.prepare::<1, f32>(&self.ray, &LaneRay::splat(&self.ray));
        kernel
            .intersect(&prepared, &triangle)
            .is_some_and(|hit| hit.mask.any() && hit.t >= 0.0)
    }
}

fn vector() -> impl Strategy<Value = Vec3> {
    [-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0].prop_map(Vec3::from_array)
}

/// Height over the longest edge: what the stated bound asks for.
fn thickness(corners: &[Vec3; 3]) -> f32 {
    let [a, b, c] = *corners;
    let longest = [b - a, c - b, a - c]
        .map(Vec3::length_squared)
        .into_iter()
        .fold(0.0, f32::max);
    (b - a).cross(c - a).length() / longest
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 50_000, max_global_rejects: 50_000, ..ProptestConfig::default() })]

    #[test]
    fn a_ray_that_leaves_a_triangle_does_not_hit_it_again(
        unit in [vector(), vector(), vector()],
        dir in vector(),
        u in 0.0_f32..1.0,
        v in 0.0_f32..1.0,
        exponent in -20..20,
        offset in prop_oneof![Just(0.0_f32), Just(1e3), Just(1e6)],
    ) {
        let corners = unit.map(|c| (c + offset) * 2.0_f32.powi(exponent));
        prop_assume!(thickness(&unit) > 1.0 / 16.0 && thickness(&corners) > 1.0 / 16.0);
        let dir = dir.normalize_or(Vec3::X);
        if let Some(normal) = unit_normal(&corners) {
            let origin = SurfacePoint::of(&corners, u, v * (1.0 - u)).start(normal, dir);
            // The kernels that are recommended for rendering; the sheet's own are known to err far off.
            for name in ["moller-trumbore", "woop", "pbrt", "exact"] {
                let Ok(choice) = kernel::parse(name) else { continue };
                let ray = Ray::new(origin, dir);
                let hit = kernel::dispatch(&choice, SelfHit { ray, corners });
                prop_assert_eq!(hit, Ok(false), "{}", name);
            }
        }
    }
}
