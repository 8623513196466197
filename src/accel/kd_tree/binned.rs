//! The sweep over bins: parts are counted where they begin and where they end, and the planes between bins are tried. Around
//! the best of them the exact places of parts are tried, and so are the planes that cut off the space outside all parts.

use crate::geometry::{Aabb, Vec3};

use super::super::parallel;
use super::super::plane_tree::{Part, Plane};
use super::cost::Splits;
use super::sweep::{Events, Priced, cheaper};

/// Bins an axis.
const BINS: usize = 32;

/// Parts that one thread counts at a time.
const CHUNK: usize = 1 << 13;

/// What falls into the bins.
#[derive(Clone)]
struct Counts {
    starts: [[u32; BINS]; 3],
    ends: [[u32; BINS]; 3],
    /// The box of the parts.
    bounds: Aabb,
}

/// Bins of equal width across a cell.
struct Bins {
    start: Vec3,
    width: Vec3,
    inverse: Vec3,
}

impl Bins {
    fn new(cell: &Aabb) -> Self {
        let width = cell.extent() / BINS as f32;
        Self {
            start: cell.min,
            width,
            inverse: 1.0 / width,
        }
    }

    /// The bins of a point. The conversion saturates, and turns NaN into 0.
    #[inline(always)]
    fn of(&self, point: Vec3) -> [usize; 3] {
        let [x, y, z] = ((point - self.start) * self.inverse).to_array();
        [x, y, z].map(|p| (p as usize).min(BINS - 1))
    }

    /// The plane before `bin`.
    fn plane(&self, axis: usize, bin: usize) -> f32 {
        self.start[axis] + self.width[axis] * bin as f32
    }
}

impl Counts {
    const NONE: Self = Self {
        starts: [[0; BINS]; 3],
        ends: [[0; BINS]; 3],
        bounds: Aabb::EMPTY,
    };

    fn of(parts: &[Part], bins: &Bins) -> Self {
        let mut counts = Self::NONE;
        for part in parts {
            let (first, last) = (bins.of(part.bounds.min), bins.of(part.bounds.max));
            for axis in 0..3 {
                counts.starts[axis][first[axis]] += 1;
                counts.ends[axis][last[axis]] += 1;
            }
            counts.bounds = counts.bounds.union(part.bounds);
        }
        counts
    }

    fn joined(mut self, other: &Self) -> Self {
        let add = |mine: &mut [[u32; BINS]; 3], theirs: &[[u32; BINS]; 3]| {
            let theirs = theirs.as_flattened();
            for (mine, theirs) in mine.as_flattened_mut().iter_mut().zip(theirs) {
                *mine += theirs;
            }
        };
        add(&mut self.starts, &other.starts);
        add(&mut self.ends, &other.ends);
        self.bounds = self.bounds.union(other.bounds);
        self
    }

    /// The cheapest plane between two bins along `axis`, and its bin.
    fn best_along(&self, bins: &Bins, cell: &Aabb, axis: usize) -> Option<(Priced, usize)> {
        let splits = Splits::new(cell, axis)?;
        let mut best: Option<(Priced, usize)> = None;
        let parts = self.ends[axis].iter().sum::<u32>();
        let (mut below, mut above) = (0, parts);
        for bin in 1..BINS {
            below += self.starts[axis][bin - 1];
            above -= self.ends[axis][bin - 1];
            let place = bins.plane(axis, bin);
            // A plane that all parts cross divides nothing.
            if !splits.is_inside(place) || below.min(above) == parts {
                continue;
            }
            let cost = splits.cost(place, below as usize, above as usize);
            if best.is_none_or(|(b, _)| cost < b.cost) {
                let plane = Plane {
                    axis,
                    place,
                    planar_below: true,
                };
                best = Some((Priced { plane, cost }, bin));
            }
        }
        best
    }

    /// The cheapest plane that cuts off the space outside all parts.
    fn best_empty(&self, cell: &Aabb, parts: usize) -> Option<Priced> {
        (0..3).fold(None, |best, axis| {
            let Some(splits) = Splits::new(cell, axis) else {
                return best;
            };
            let priced = |place: f32, below: usize, above: usize| {
                splits.is_inside(place).then(|| Priced {
                    plane: Plane {
                        axis,
                        place,
                        // What lies in the plane is on the side of the others.
                        planar_below: above == 0,
                    },
                    cost: splits.cost(place, below, above),
                })
            };
            let best = cheaper(best, priced(self.bounds.min[axis], 0, parts));
            cheaper(best, priced(self.bounds.max[axis], parts, 0))
        })
    }
}

/// The cheapest of the planes that are tried, the first of equals; `None` where none is strictly inside the cell or that has
/// no area.
pub(super) fn best(cell: &Aabb, parts: &[Part]) -> Option<Priced> {
    let bins = Bins::new(cell);
    let counts = if parts.len() >= 2 * CHUNK {
        let count = |chunk: &[Part]| Counts::of(chunk, &bins);
        let counts = parallel::chunks(parts, CHUNK, count);
        let join = |a: Counts, b: &Counts| a.joined(b);
        counts.iter().fold(Counts::NONE, join)
    } else {
        Counts::of(parts, &bins)
    };
    let mut between: Option<(Priced, usize)> = None;
    for axis in 0..3 {
        if let Some(found) = counts.best_along(&bins, cell, axis)
            && between.is_none_or(|(b, _)| found.0.cost < b.cost)
        {
            between = Some(found);
        }
    }
    let mut best = counts.best_empty(cell, parts.len());
    if let Some((priced, bin)) = between {
        let axis = priced.plane.axis;
        let around = bins.plane(axis, bin - 1)..=bins.plane(axis, bin + 1);
        best = cheaper(best, Some(priced));
        best = cheaper(best, Events::best_within(parts, cell, axis, &around));
    }
    best
}
