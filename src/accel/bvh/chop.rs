//! Planes for spatial splits: references are chopped into bins of equal width, and the plane between two bins with the
//! least cost is found.
//!
//! The boxes of chopped pieces only steer the choice, so they are computed in `f32` and may be off by its rounding;
//! what becomes a reference is clipped again, conservatively.

use std::ops::Range;

use glam::Vec4;

use crate::geometry::Vec3;
use crate::scene::Mesh;

use super::partition::{Task, chunked};
use super::reference::{Bounds, Reference};

/// Bins an axis.
const BINS: usize = 16;

/// A plane across a node.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    pub axis: usize,
    pub place: f32,
    /// Half areas times references of both sides, in units of [`Bounds::scale`] of the node.
    pub cost: f32,
    /// References on both sides, about.
    pub counts: [u32; 2],
    /// The boxes of both sides, about.
    pub sides: [Bounds; 2],
}

impl Plane {
    /// Whether the plane passes through the inside of `bounds`.
    #[inline(always)]
    pub fn cuts(&self, bounds: &Bounds) -> bool {
        bounds.min[self.axis] < self.place && self.place < bounds.max[self.axis]
    }

    /// Whether a box that is not cut lies beyond the plane. What lies in it does not.
    #[inline(always)]
    pub fn is_beyond(&self, bounds: &Bounds) -> bool {
        bounds.max[self.axis] > self.place
    }
}

/// Where a plane is looked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Search {
    /// About so many references of a node say where its plane should be.
    pub sample: usize,
    /// Only across the longest edge of the node.
    pub longest_only: bool,
}

impl Search {
    /// Everywhere.
    pub const FULL: Self = Self {
        sample: usize::MAX,
        longest_only: false,
    };

    fn axes(&self, bounds: &Bounds) -> Range<usize> {
        if !self.longest_only {
            return 0..3;
        }
        let extent = bounds.extent();
        let longer = |a: usize, b: usize| if extent[b] > extent[a] { b } else { a };
        let longest = longer(longer(0, 1), 2);
        longest..longest + 1
    }
}

/// What falls into the bins of each axis.
struct Chopped {
    bounds: [[Bounds; BINS]; 3],
    /// References that begin in a bin.
    first: [[u32; BINS]; 3],
    /// References that end in a bin.
    last: [[u32; BINS]; 3],
}

/// The plane of least cost across a node among those that cut no more references than there is room for, the first of
/// equals; `None` where there is none.
///
/// Where references are many, one of a few stands for all of them; planes that none of these lies beside are not found.
pub(super) fn best(mesh: &Mesh, task: &Task, search: Search) -> Option<Plane> {
    let bounds = &task.extent.bounds;
    let bins = Bins::new(bounds);
    let each = task.len().div_ceil(search.sample);
    let axes = search.axes(bounds);
    let work = |chunk: &[Reference]| {
        let sample = chunk.iter().step_by(each);
        Chopped::of(mesh, sample, &bins, axes.clone())
    };
    let chopped = chunked(task.references(), work, |a, b| a.joined(&b));
    chopped.best(axes, &bins, bounds, each, task.len() + task.room())
}

/// Bins of equal width.
struct Bins {
    start: Vec4,
    width: Vec4,
    inverse: Vec4,
}

impl Bins {
    fn new(bounds: &Bounds) -> Self {
        let width = bounds.extent() / BINS as f32;
        Self {
            start: bounds.min,
            width,
            inverse: 1.0 / width,
        }
    }

    /// The bins of a point. The conversion saturates, and turns NaN into 0.
    #[inline(always)]
    fn of(&self, point: Vec4) -> [usize; 3] {
        let [x, y, z, _] = ((point - self.start) * self.inverse).to_array();
        [x, y, z].map(|p| (p as usize).min(BINS - 1))
    }

    /// The plane before `bin`.
    #[inline(always)]
    fn plane(&self, axis: usize, bin: usize) -> f32 {
        self.start[axis] + self.width[axis] * bin as f32
    }
}

impl Chopped {
    fn of<'a>(
        mesh: &Mesh,
        references: impl Iterator<Item = &'a Reference>,
        bins: &Bins,
        axes: Range<usize>,
    ) -> Self {
        let mut chopped = Self {
            bounds: [[Bounds::EMPTY; BINS]; 3],
            first: [[0; BINS]; 3],
            last: [[0; BINS]; 3],
        };
        for reference in references {
            let bounds = reference.bounds();
            let (first, last) = (bins.of(bounds.min), bins.of(bounds.max));
            let corners = || {
                mesh.corners(reference.prim())
                    .map(|corner: Vec3| corner.extend(0.0))
            };
            let corners = if first == last {
                [Vec4::ZERO; 3]
            } else {
                corners()
            };
            for axis in axes.clone() {
                let (first, last) = (first[axis], last[axis]);
                chopped.first[axis][first] += 1;
                chopped.last[axis][last] += 1;
                let mut rest = bounds;
                for bin in first..last {
                    let place = bins.plane(axis, bin + 1);
                    let [before, beyond] = cut(&corners, &rest, axis, place);
                    let bin = &mut chopped.bounds[axis][bin];
                    *bin = bin.union(before);
                    rest = beyond;
                }
                let bin = &mut chopped.bounds[axis][last];
                *bin = bin.union(rest);
            }
        }
        chopped
    }

    fn joined(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            for bin in 0..BINS {
                let mine = &mut self.bounds[axis][bin];
                *mine = mine.union(other.bounds[axis][bin]);
                self.first[axis][bin] += other.first[axis][bin];
                self.last[axis][bin] += other.last[axis][bin];
            }
        }
        self
    }

    /// `each`: references for which one stands; `most`: those of both sides together.
    fn best(
        &self,
        axes: Range<usize>,
        bins: &Bins,
        bounds: &Bounds,
        each: usize,
        most: usize,
    ) -> Option<Plane> {
        let scale = bounds.scale();
        let mut best: Option<Plane> = None;
        for axis in axes {
            let mut second = [(Bounds::EMPTY, 0); BINS];
            let mut side = (Bounds::EMPTY, 0);
            for bin in (1..BINS).rev() {
                side.0 = side.0.union(self.bounds[axis][bin]);
                side.1 += self.last[axis][bin];
                second[bin] = side;
            }
            let mut side = (Bounds::EMPTY, 0);
            for (bin, &beyond) in second.iter().enumerate().skip(1) {
                side.0 = side.0.union(self.bounds[axis][bin - 1]);
                side.1 += self.first[axis][bin - 1];
                let sides = [side, beyond];
                let counts = sides.map(|(_, count)| count * each as u32);
                if counts.contains(&0) || (counts[0] + counts[1]) as usize > most {
                    continue;
                }
                let cost = |side: usize| sides[side].0.half_area(scale) * counts[side] as f32;
                let cost = cost(0) + cost(1);
                let place = bins.plane(axis, bin);
                let inside = place > bounds.min[axis] && place < bounds.max[axis];
                if inside && best.is_none_or(|b| cost < b.cost) && cost < f32::INFINITY {
                    best = Some(Plane {
                        axis,
                        place,
                        cost,
                        counts,
                        sides: sides.map(|s| s.0),
                    });
                }
            }
        }
        best
    }
}

/// The boxes of what a triangle has on both sides of a plane inside `bounds`; empty where that is nothing.
#[inline(always)]
fn cut(corners: &[Vec4; 3], bounds: &Bounds, axis: usize, place: f32) -> [Bounds; 2] {
    let (mut before, mut beyond) = (Bounds::EMPTY, Bounds::EMPTY);
    let mut from = corners[2];
    for &to in corners {
        let (a, b) = (from[axis], to[axis]);
        if b <= place {
            before = before.grown(to);
        }
        if b >= place {
            beyond = beyond.grown(to);
        }
        if (a < place && b > place) || (a > place && b < place) {
            let crossing = from + (to - from) * ((place - a) / (b - a));
            before = before.grown(crossing);
            beyond = beyond.grown(crossing);
        }
        from = to;
    }
    before.max[axis] = before.max[axis].min(place);
    beyond.min[axis] = beyond.min[axis].max(place);
    [before, beyond].map(|side| Bounds {
        min: side.min.max(bounds.min),
        max: side.max.min(bounds.max),
    })
}
