//! Which cells does a triangle touch? Three tests of a triangle against a closed box, all in `f64`.
//!
//! The builder gives them a cell grown by the pad (see [`Lattice::pad`](super::lattice::Lattice::pad)), which is far
//! larger than what they err, so each holds for every triangle that exactly touches the cell itself. Given pad 0 and
//! coordinates whose products `f64` holds exactly, [`ThreeTest`] and [`Separating`] are exact.

use crate::geometry::DVec3;

#[cfg(test)]
mod exact;
mod separating;
mod single;
mod three_test;

pub(super) use separating::Separating;
pub(super) use single::SingleSeparating;
pub(super) use three_test::ThreeTest;

/// A triangle prepared for being tested against boxes.
pub(in crate::accel) trait Overlap: Copy {
    /// Prepares the triangle with these corners.
    fn new(corners: [DVec3; 3]) -> Self;

    /// Whether the triangle touches the closed box around `centre` with these half edge lengths.
    ///
    /// The caller has found that the triangle's own box does.
    fn touches(&self, centre: DVec3, half: DVec3) -> bool;
}

/// `overlap=bbox`: a triangle is taken for its box.
#[derive(Debug, Clone, Copy)]
pub(in crate::accel) struct Boxes;

impl Overlap for Boxes {
    fn new(_: [DVec3; 3]) -> Self {
        Self
    }

    #[inline(always)]
    fn touches(&self, _: DVec3, _: DVec3) -> bool {
        true
    }
}
