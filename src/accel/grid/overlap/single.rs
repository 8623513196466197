//! The mistake of `grid-f32-overlap`: separating axes in `f32`, around the centre of the cell and with half extents.
//!
//! Centre and half extent are rounded apart, so a corner exactly on a cell plane can lie outside of both cells; nothing
//! is padded.
//!
//! **Source:** T. Akenine-Möller, "Fast 3D Triangle-Box Overlap Testing", JGT 6(1), 2001, as printed.

use crate::geometry::{DVec3, Vec3};

use super::Overlap;

/// A triangle in `f32`.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct SingleSeparating {
    corners: [Vec3; 3],
}

impl Overlap for SingleSeparating {
    fn new(corners: [DVec3; 3]) -> Self {
        Self {
            corners: corners.map(|p| p.as_vec3()),
        }
    }

    fn touches(&self, centre: DVec3, half: DVec3) -> bool {
        let (centre, half) = (centre.as_vec3(), half.as_vec3());
        let [a, b, c] = self.corners.map(|p| p - centre);
        let edges = [b - a, c - b, a - c];
        let separates = |axis: Vec3| {
            let along = [a, b, c].map(|p| p.dot(axis));
            let radius = half.dot(axis.abs());
            let least = along[0].min(along[1]).min(along[2]);
            let most = along[0].max(along[1]).max(along[2]);
            least > radius || most < -radius
        };
        let units = [Vec3::X, Vec3::Y, Vec3::Z];
        let crosses = edges.iter().flat_map(|e| units.map(|u| u.cross(*e)));
        let normal = edges[0].cross(edges[1]);
        !units
            .into_iter()
            .chain([normal])
            .chain(crosses)
            .any(separates)
    }
}
