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
            corners: corners.map(DVec3::as_vec3),
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

#[cfg(test)]
mod tests {
    use super::super::Separating;
    use super::*;

    #[test]
    fn a_triangle_on_a_cell_plane_is_lost_from_both_cells_as_no_sound_test_loses_it() {
        let mut lost = [0; 2];
        for i in 1..1000_u32 {
            // The plane between two cells of a width that f32 does not hold.
            let (low, width) = (f64::from(0.1_f32), f64::from(i) * 1.37e-3);
            let plane = f64::from((low + width) as f32);
            let corners = [
                DVec3::new(plane, 0.2, 0.2),
                DVec3::new(plane, 0.8, 0.3),
                DVec3::new(plane, 0.4, 0.7),
            ];
            // The plane as f32 has been rounded, so a sound grid pads its cells; here by an ulp.
            let half = DVec3::new(width * 0.5, 0.5, 0.5);
            let centres = [low + width * 0.5, low + width * 1.5].map(|x| DVec3::new(x, 0.5, 0.5));
            let pad = DVec3::splat(plane * f64::from(f32::EPSILON));
            let single = centres.map(|c| SingleSeparating::new(corners).touches(c, half));
            let sound = centres.map(|c| Separating::new(corners).touches(c, half + pad));
            lost[0] += u32::from(single == [false; 2]);
            lost[1] += u32::from(sound == [false; 2]);
        }
        assert!(lost[0] > 20, "{lost:?}");
        assert_eq!(lost[1], 0);
    }
}
