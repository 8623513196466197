//! Triangles as their corners: what kernels keep that precompute nothing.

use crate::geometry::Vec3;
use crate::geometry::lanes::{Lane, LaneVec3};

/// The corners of `W` triangles by axis: x, y and z of all corners, a row of lanes each.
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
        let mut rows = [[[0.0; W]; 3]; 3];
        // A loop that is compiled into its caller, as that of `super::rows_of`.
        for lane in 0..W {
            for (i, corner) in corners(lane).into_iter().enumerate() {
                for (rows, x) in rows.iter_mut().zip(corner.to_array()) {
                    rows[i][lane] = x;
                }
            }
        }
        Self(rows)
    }

    /// The three corners.
    #[inline(always)]
    pub(super) fn load<L: Lane<W>>(&self) -> [LaneVec3<L>; 3] {
        // No closure: it would be compiled for no instruction set.
        [self.corner(0), self.corner(1), self.corner(2)]
    }

    #[inline(always)]
    fn corner<L: Lane<W>>(&self, i: usize) -> LaneVec3<L> {
        let [x, y, z] = &self.0;
        LaneVec3 {
            x: L::load(&x[i]),
            y: L::load(&y[i]),
            z: L::load(&z[i]),
        }
    }

    /// The triangle in a lane.
    #[inline(always)]
    pub(super) fn triangle(&self, lane: usize) -> [Vec3; 3] {
        let [x, y, z] = &self.0;
        [
            Vec3::new(x[0][lane], y[0][lane], z[0][lane]),
            Vec3::new(x[1][lane], y[1][lane], z[1][lane]),
            Vec3::new(x[2][lane], y[2][lane], z[2][lane]),
        ]
    }
}

impl Corners<8> {
    /// One triangle of a block.
    #[inline(always)]
    pub(super) fn lane(&self, lane: usize) -> Corners<1> {
        let [x, y, z] = &self.0;
        Corners([
            super::lane_of(x, lane),
            super::lane_of(y, lane),
            super::lane_of(z, lane),
        ])
    }
}
