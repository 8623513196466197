//! Vectors, boxes, rays and lanes: the lowest room, which knows of nothing above it.
//!
//! Vectors are glam's: [`Vec3`] in `f32` for what is stored, [`DVec3`] in `f64` where a computation needs it.

mod aabb;
pub mod exact;
pub mod lanes;
mod ray;
mod surface;

pub use aabb::Aabb;
pub use glam::{DVec2, DVec3, Vec3};
pub use ray::{Hit, Ray};
pub use surface::{SurfacePoint, unit_normal};

/// Bound on the relative error of `n` chained `f32` operations: n·u / (1 − n·u) with u = 2⁻²⁴.
///
/// Source: Higham, "Accuracy and Stability of Numerical Algorithms", §3.1.
#[must_use]
pub const fn gamma(n: u32) -> f32 {
    let nu = n as f32 * (f32::EPSILON * 0.5);
    nu / (1.0 - nu)
}

/// The component of `v` on `axis` (0, 1, 2 for x, y, z).
#[must_use]
#[inline(always)]
pub fn axis(v: Vec3, axis: usize) -> f32 {
    v.to_array()[axis]
}
