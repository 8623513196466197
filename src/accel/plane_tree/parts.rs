//! The parts of triangles in a cell, and their way to the sides of an axis-parallel plane.

use crate::geometry::Aabb;
use crate::scene::Mesh;

use super::super::clip::clipped_halves;
use super::super::parallel::{self, MANY};
use super::node::halves;

/// The part of a triangle inside a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Part {
    /// Contains the part; within the cell.
    pub bounds: Aabb,
    pub prim: u32,
}

impl Part {
    /// Where the part begins and ends along `axis`.
    #[inline(always)]
    pub fn interval(&self, axis: usize) -> (f32, f32) {
        (self.bounds.min[axis], self.bounds.max[axis])
    }
}

/// All triangles, whole.
pub(in super::super) fn parts(mesh: &Mesh) -> Vec<Part> {
    parallel::map(mesh.len(), MANY, |i| {
        let prim = i as u32;
        Part {
            prim,
            bounds: mesh.triangle_bounds(prim),
        }
    })
}

/// A plane across a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Plane {
    pub axis: usize,
    pub place: f32,
    /// Whether parts in the plane belong to the side below it.
    pub planar_below: bool,
}

/// On which sides of a plane a part lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Reach {
    Below,
    Above,
    Both,
}

impl Plane {
    /// What only touches the plane is on its own side alone: the plane belongs to the closed cells of both sides, and
    /// rays that meet it there visit both.
    #[inline(always)]
    pub fn reach(&self, part: &Part) -> Reach {
        let (start, end) = part.interval(self.axis);
        if start == end && start == self.place {
            if self.planar_below {
                Reach::Below
            } else {
                Reach::Above
            }
        } else if end <= self.place {
            Reach::Below
        } else if start >= self.place {
            Reach::Above
        } else {
            Reach::Both
        }
    }
}

impl Reach {
    /// Whether it is below, and whether it is above.
    pub fn sides(self) -> [bool; 2] {
        [self != Self::Above, self != Self::Below]
    }
}

/// Divides parts.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Splitter<'a> {
    pub mesh: &'a Mesh,
    /// Whether parts are clipped to their cells.
    pub clip: bool,
}

impl Splitter<'_> {
    /// What `part` has on the sides below and above `plane`.
    #[inline(always)]
    pub fn sides(&self, part: &Part, plane: &Plane) -> [Option<Part>; 2] {
        match plane.reach(part) {
            Reach::Below => [Some(*part), None],
            Reach::Above => [None, Some(*part)],
            Reach::Both => self.cut(part, plane),
        }
    }

    /// What a part that reaches through `plane` has on both sides.
    fn cut(&self, part: &Part, plane: &Plane) -> [Option<Part>; 2] {
        let (axis, place) = (plane.axis, plane.place);
        let sides = if self.clip {
            clipped_halves(&self.mesh.corners(part.prim), &part.bounds, axis, place)
        } else {
            halves(&part.bounds, axis, place).map(Some)
        };
        sides.map(|bounds| bounds.map(|bounds| Part { bounds, ..*part }))
    }
}
