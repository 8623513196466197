//! The first ray of a list that a method decides wrongly: to be inspected.

use std::sync::Arc;

use crate::accel::Accelerator;
use crate::geometry::{Hit, Ray};
use crate::oracle::Oracle;
use crate::scene::Mesh;
use crate::trace::BATCH;

use super::judge::{Truths, Worth};

/// The index of the first of `rays` that `accel` decides wrongly, by the oracle of its mesh: a leak, a phantom or another
/// surface. `None` where it decides all right, or when `given_up` said so first.
pub fn first_wrong(
    mesh: &Arc<Mesh>,
    oracle: &Oracle,
    accel: &dyn Accelerator,
    rays: &[Ray],
    given_up: impl Fn() -> bool,
) -> Option<usize> {
    for (batch, rays) in rays.chunks(BATCH).enumerate() {
        if given_up() {
            return None;
        }
        let truths = Truths::new(oracle, mesh, rays);
        let mut hits = vec![Hit::MISS; rays.len()];
        accel.closest(rays, &mut hits);
        let wrong = |i: &usize| {
            let worth = truths.worth_of(*i, &rays[*i], &hits[*i]);
            matches!(worth, Worth::Leak | Worth::Phantom | Worth::WrongSurface)
        };
        if let Some(i) = (0..rays.len()).find(wrong) {
            return Some(batch * BATCH + i);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel;
    use crate::geometry::Vec3;
    use crate::kernel;

    #[test]
    fn the_first_leak_is_found_behind_rays_that_are_decided_right() {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = Arc::new(Mesh::new(corners, vec![[0, 1, 2]]).unwrap());
        let oracle = Oracle::new(&mesh);
        let brute = accel::parse("brute").unwrap();
        let through = |x: f32| Ray::new(Vec3::new(x, 0.25, 1.0), Vec3::NEG_Z);
        let mut rays = vec![through(0.25); BATCH + 3];
        let found = |kernel: &str, rays: &[Ray], given_up: bool| {
            let kernel = kernel::parse(kernel).unwrap();
            let built = accel::build(&mesh, &brute, None, &kernel, u64::MAX).unwrap();
            first_wrong(&mesh, &oracle, built.as_ref(), rays, || given_up)
        };
        assert_eq!(found("woop", &rays, false), None);
        // An absolute epsilon takes a small determinant for none: the ray slips through.
        rays.push(Ray::new(Vec3::new(0.25, 0.25, 1e-9), Vec3::NEG_Z * 1e-9));
        assert_eq!(found("moller-trumbore-eps", &rays, false), Some(BATCH + 3));
        assert_eq!(found("moller-trumbore-eps", &rays, true), None);
    }
}
