//! Triangles as their corners: what kernels keep that precompute nothing.

use crate::geometry::Vec3;
use crate::geometry::lanes::{Lane, LaneVec3};

/// The corners of `W` triangles: corner, axis, lane.
#[derive(Debug, Clone, Copy)]
pub struct Corners<const W: usize>(pub(super) [[[f32; W]; 3]; 3]);

impl<const W: usize> Corners<W> {
    /// Those that `corners(lane)` gives; a triangle without area is made one point, where every test misses it.
    pub(super) fn with_area(corners: impl Fn(usize) -> [Vec3; 3]) -> Self {
        Self::of(|lane| super::with_area(corners(lane)))
    }

    /// Those that `corners(lane)` gives, as they are.
    pub(super) fn of(corners: impl Fn(usize) -> [Vec3; 3]) -> Self {
        let corners: [_; W] = std::array::from_fn(corners);
        Self(std::array::from_fn(|i| {
            super::rows(|lane| corners[lane][i])
        }))
    }

    /// The three corners, each in all lanes.
    #[inline(always)]
    pub(super) fn load<L: Lane<W>>(&self) -> [LaneVec3<L>; 3] {
        // No closure: it would be compiled for no instruction set.
        [
            LaneVec3::load(&self.0[0]),
            LaneVec3::load(&self.0[1]),
            LaneVec3::load(&self.0[2]),
        ]
    }
}

impl Corners<8> {
    /// One triangle of a block.
    #[inline(always)]
    pub(super) fn lane(&self, lane: usize) -> Corners<1> {
        Corners([0, 1, 2].map(|i| super::lane_of(&self.0[i], lane)))
    }
}
