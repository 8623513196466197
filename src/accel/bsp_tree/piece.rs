//! The piece of a triangle inside a convex cell.

use crate::geometry::{Aabb, DVec3, Vec3};
use crate::scene::Mesh;

use super::super::clip::{rounded_down, rounded_up};
use super::super::plane_tree::{Oblique, Part, Plane, Reach, halves};
use super::Scale;

/// Most vertices of a piece; where a cut would give more it is not made, which loses nothing.
const MOST: usize = 10;

/// A convex polygon.
#[derive(Debug, Clone, Copy)]
pub(super) struct Polygon {
    vertices: [DVec3; MOST],
    len: usize,
}

impl Polygon {
    fn triangle(corners: &[Vec3; 3]) -> Self {
        let mut vertices = [DVec3::ZERO; MOST];
        for (vertex, corner) in vertices.iter_mut().zip(corners) {
            *vertex = corner.as_dvec3();
        }
        Self { vertices, len: 3 }
    }

    fn vertices(&self) -> &[DVec3] {
        &self.vertices[..self.len]
    }

    /// The part where `height` is not above 0; `None` where there is none.
    fn below(&self, height: impl Fn(DVec3) -> f64) -> Option<Self> {
        let mut part = Self {
            vertices: [DVec3::ZERO; MOST],
            len: 0,
        };
        let mut from = *self.vertices().last()?;
        let mut from_height = height(from);
        for &to in self.vertices() {
            let to_height = height(to);
            let mut push = |vertex: DVec3| {
                let room = part.vertices.get_mut(part.len)?;
                *room = vertex;
                part.len += 1;
                Some(())
            };
            let crosses = (from_height > 0.0) != (to_height > 0.0);
            let crossing = || from + (to - from) * (from_height / (from_height - to_height));
            if (crosses && push(crossing()).is_none()) || (to_height <= 0.0 && push(to).is_none()) {
                return Some(*self);
            }
            (from, from_height) = (to, to_height);
        }
        (part.len > 0).then_some(part)
    }
}

/// The piece of a triangle inside a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    /// Its triangle, and a box that contains it.
    pub part: Part,
    polygon: Polygon,
}

/// On which sides of an oblique plane a piece lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Below,
    Above,
    Both,
    /// Within the tolerance.
    Planar,
}

impl Piece {
    /// The piece of `part` inside its cell, which is a box.
    pub fn of(mesh: &Mesh, part: &Part, scale: &Scale) -> Self {
        let mut polygon = Polygon::triangle(&mesh.corners(part.prim));
        let (least, greatest) = (part.bounds.min.as_dvec3(), part.bounds.max.as_dvec3());
        for axis in 0..3 {
            let above = |v: DVec3| v[axis] - greatest[axis] - scale.rounding;
            let under = |v: DVec3| least[axis] - v[axis] - scale.rounding;
            polygon = polygon.below(above).unwrap_or(polygon);
            polygon = polygon.below(under).unwrap_or(polygon);
        }
        Self {
            part: *part,
            polygon,
        }
    }

    /// Its side of `plane`.
    #[inline]
    pub fn side(&self, plane: &Oblique, tolerance: f64) -> Side {
        let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
        for vertex in self.polygon.vertices() {
            let height = plane.height(*vertex);
            least = least.min(height);
            greatest = greatest.max(height);
        }
        match (greatest <= tolerance, least >= -tolerance) {
            (true, true) => Side::Planar,
            (true, false) => Side::Below,
            (false, true) => Side::Above,
            (false, false) => Side::Both,
        }
    }

    /// What it has below and above an oblique plane. `planar_below`: where it belongs if it lies in it.
    pub fn cut(&self, plane: &Oblique, planar_below: bool, scale: &Scale) -> [Option<Self>; 2] {
        let below = match self.side(plane, scale.tolerance) {
            Side::Planar => planar_below,
            Side::Below => true,
            Side::Above => false,
            Side::Both => {
                let rounding = scale.rounding * plane.reach();
                let below = self.polygon.below(|v| plane.height(v) - rounding);
                let above = self.polygon.below(|v| -plane.height(v) - rounding);
                return [below, above]
                    .map(|polygon| Some(self.with(polygon?, &self.part.bounds, scale)));
            }
        };
        [below, !below].map(|is_here| is_here.then_some(*self))
    }

    /// What it has below and above an axis-parallel plane.
    pub fn cut_across(&self, plane: &Plane, scale: &Scale) -> [Option<Self>; 2] {
        let (axis, place) = (plane.axis, f64::from(plane.place));
        match plane.reach(&self.part) {
            Reach::Below => [Some(*self), None],
            Reach::Above => [None, Some(*self)],
            Reach::Both => {
                let [lower, upper] = halves(&self.part.bounds, axis, plane.place);
                let below = self.polygon.below(|v| v[axis] - place - scale.rounding);
                let above = self.polygon.below(|v| place - v[axis] - scale.rounding);
                [
                    below.map(|polygon| self.with(polygon, &lower, scale)),
                    above.map(|polygon| self.with(polygon, &upper, scale)),
                ]
            }
        }
    }

    /// The piece that is left with this polygon, within `bounds`.
    fn with(&self, polygon: Polygon, bounds: &Aabb, scale: &Scale) -> Self {
        let vertices = polygon.vertices();
        let first = vertices.first().copied().unwrap_or(DVec3::ZERO);
        let (least, greatest) = vertices
            .iter()
            .fold((first, first), |(least, greatest), v| {
                (least.min(*v), greatest.max(*v))
            });
        let mut within = *bounds;
        for axis in 0..3 {
            let least = rounded_down(least[axis] - scale.rounding);
            let greatest = rounded_up(greatest[axis] + scale.rounding);
            within.min[axis] = within.min[axis].max(least);
            within.max[axis] = within.max[axis].min(greatest);
        }
        Self {
            part: Part {
                // What is off by more than the rounding cannot be; kept as it was, it would not be lost.
                bounds: if within.is_empty() { *bounds } else { within },
                prim: self.part.prim,
            },
            polygon,
        }
    }
}
