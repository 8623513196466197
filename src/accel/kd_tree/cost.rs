//! What cells cost, and what they would cost if they were split.

use crate::geometry::Aabb;

use super::super::plane_tree::Plane;
use super::super::plane_tree::cost::{STEP, expected};
use super::super::sah::half_area;

/// A split that cuts off empty space costs this part of what it would (Wald and Havran, §3.3).
const EMPTY_BONUS: f64 = 0.8;

/// The part of a cell's extent that must be empty for the bonus. Without this a leaf of four triangles around a vertex
/// is trimmed by ever thinner slivers, since the bonus alone pays for each of them.
const LEAST_EMPTY: f64 = 0.1;

/// The cost of splits of a cell across an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Splits {
    start: f64,
    end: f64,
    /// Half the area of the cell's faces across the axis, and half the length of their edges, in areas of the cell.
    face: f64,
    rim: f64,
    /// What must be empty for the bonus.
    least_empty: f64,
}

impl Splits {
    /// `None` where the cell has no area.
    pub fn new(cell: &Aabb, axis: usize) -> Option<Self> {
        let area = half_area(cell);
        let extent = |axis: usize| f64::from(cell.max[axis]) - f64::from(cell.min[axis]);
        let (u, v) = (extent((axis + 1) % 3), extent((axis + 2) % 3));
        (area > 0.0).then(|| Self {
            start: f64::from(cell.min[axis]),
            end: f64::from(cell.max[axis]),
            face: u * v / area,
            rim: (u + v) / area,
            least_empty: LEAST_EMPTY * extent(axis),
        })
    }

    /// Whether a plane at `place` is strictly inside the cell.
    pub fn is_inside(&self, place: f32) -> bool {
        let place = f64::from(place);
        place > self.start && place < self.end
    }

    /// The chance that a line through the cell meets the side below `place`, and the side above it.
    pub fn chances(&self, place: f32) -> [f64; 2] {
        let place = f64::from(place);
        [place - self.start, self.end - place].map(|extent| self.face + extent * self.rim)
    }

    /// What the cell costs if it is split at `place` into sides with so many parts.
    pub fn cost(&self, place: f32, below: usize, above: usize) -> f64 {
        let chances = self.chances(place);
        let place = f64::from(place);
        let is_empty = (below == 0 && place - self.start >= self.least_empty)
            || (above == 0 && self.end - place >= self.least_empty);
        let bonus = if is_empty { EMPTY_BONUS } else { 1.0 };
        bonus * (STEP + chances[0] * expected(below) + chances[1] * expected(above))
    }
}

/// What a cell costs that `plane` splits into sides of these costs.
pub(super) fn split(cell: &Aabb, plane: &Plane, sides: [f64; 2]) -> f64 {
    // A cell without area is not split.
    let chances = Splits::new(cell, plane.axis).map_or([1.0; 2], |s| s.chances(plane.place));
    STEP + chances[0] * sides[0] + chances[1] * sides[1]
}
