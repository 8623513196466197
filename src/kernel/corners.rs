//! Triangles as their corners: what kernels keep that precompute nothing.

use crate::geometry::Vec3;
use crate::geometry::lanes::{Lane, LaneVec3};

/// The corners of `W` triangles: x, y and z of each, a row of lanes each.
#[derive(Debug, Clone, Copy)]
pub struct Corners<const W: usize>(pub(super) [[[f32; W]; 3]; 3]);

impl<const W: usize> Corners<W> {
    /// Those that `corners(lane)` gives; a triangle without area is made one point, where every test misses it.
    pub(super) fn with_area(corners: impl Fn(usize) -> [Vec3; 3]) -> Self {
        Self::of(|lane| super::with_area(corners(lane)))
    }

    /// Those that `corners(lane)` gives; a triangle without area is made NaN: edge functions of one point are 0, which the
    /// shear takes for a ray on an edge and looks at again in `f64`, or rounding errors where they are fused.
    #[inline(always)]
    pub(super) fn with_area_or_nan(corners: impl Fn(usize) -> [Vec3; 3]) -> Self {
        Self::of(|lane| match super::with_area(corners(lane)) {
            [a, b, c] if a == b && b == c => [Vec3::NAN; 3],
            corners => corners,
        })
    }

    /// Those that `corners(lane)` gives, as they are.
    #[inline(always)]
    pub(super) fn of(corners: impl Fn(usize) -> [Vec3; 3]) -> Self {
        Self(super::rows_of(corners))
    }

    /// The three corners.
    #[inline(always)]
    pub(super) fn load<L: Lane<W>>(&self) -> [LaneVec3<L>; 3] {
        // No closure: it would be compiled for no instruction set.
        let [a, b, c] = &self.0;
        [LaneVec3::load(a), LaneVec3::load(b), LaneVec3::load(c)]
    }

    /// The triangle in a lane.
    #[inline(always)]
    pub(super) fn triangle(&self, lane: usize) -> [Vec3; 3] {
        let corner = |[x, y, z]: &[[f32; W]; 3]| Vec3::new(x[lane], y[lane], z[lane]);
        let [a, b, c] = &self.0;
        [corner(a), corner(b), corner(c)]
    }
}

impl Corners<8> {
    /// One triangle of a block.
    #[inline(always)]
    pub(super) fn lane(&self, lane: usize) -> Corners<1> {
        let [a, b, c] = &self.0;
        Corners([
            super::lane_of(a, lane),
            super::lane_of(b, lane),
            super::lane_of(c, lane),
        ])
    }
}
