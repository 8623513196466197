//! Rays in the form that a test reads.

use crate::geometry::Vec3;
use crate::geometry::lanes::{Lane, LaneRay, LaneVec3};

/// A ray prepared for lanes `L`, of which the form with one lane is `One`.
pub trait PreparedRay<const W: usize, L: Lane<W>, One>: Copy {
    /// Whether to prepare a ray again costs no more than to keep what was prepared.
    const CHEAP: bool = false;

    /// The same ray in every lane.
    fn spread(one: &One) -> Self;
}

impl<const W: usize, L: Lane<W>> PreparedRay<W, L, LaneRay<f32>> for LaneRay<L> {
    const CHEAP: bool = true;

    #[inline(always)]
    fn spread(one: &LaneRay<f32>) -> Self {
        Self {
            origin: spread(one.origin),
            dir: spread(one.dir),
        }
    }
}

/// A vector in every lane.
#[inline(always)]
pub(super) fn spread<const W: usize, L: Lane<W>>(v: LaneVec3<f32>) -> LaneVec3<L> {
    LaneVec3::splat(Vec3::new(v.x, v.y, v.z))
}
