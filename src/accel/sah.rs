//! The surface area heuristic: a region is met by a random line with a probability in proportion to its surface.
//!
//! **Source:** J. D. `MacDonald` and K. S. Booth, "Heuristics for Ray Tracing using Space Subdivision", 1990.
//! **Differs:** areas in `f64`, so that no finite mesh overflows them.

use crate::geometry::Aabb;

/// Half the surface of `aabb`; zero for the empty box.
#[inline]
pub(super) fn half_area(aabb: &Aabb) -> f64 {
    let e = (aabb.max.as_dvec3() - aabb.min.as_dvec3()).max(glam::DVec3::ZERO);
    e.x * e.y + e.y * e.z + e.z * e.x
}

/// What a step and a test cost, in any unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Costs {
    /// Visiting an interior node.
    pub step: f64,
    /// Testing one triangle.
    pub test: f64,
}
