//! Histograms of centroids along the three axes, and the split that they say is cheapest.
//!
//! ```text
//!   references:   ▬ ▬▬   ▬▬▬  ▬      ▬▬ ▬
//!   bins:       |  3 |  3 |  1 |    |  3 |     each with a count and the box of what falls into it
//!                         ^ a split lies between two bins
//! ```
//!
//! **Source:** I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007.
//! **Differs:** few references get few bins; areas are relative to the node's box.

use glam::{BVec4A, Vec4, Vec4Swizzles};

use crate::geometry::lanes::Lane;

use super::reference::{Bounds, Hull, Reference};

/// Most bins an axis. More gains less than 1 % of SAH cost (Wald 2007, figure 5).
const BINS: usize = 16;

/// Added to a number from 0 to below 16, it brings the whole part of that into the highest four bits of the mantissa.
const WHOLE: f32 = 16.0;

/// Bits of the mantissa below those four.
const PART: u32 = 19;

/// Which bins references fall into.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    start: Vec4,
    scale: Vec4,
    bins: usize,
}

impl Grid {
    /// Bins for `count` references whose centroids lie in `centroids`.
    pub fn new(centroids: &Bounds, count: usize) -> Self {
        let bins = BINS.min(4 + count / 8);
        let extent = centroids.extent();
        let scale = Vec4::splat(bins as f32 * 0.999_99) / extent;
        // All centroids of an axis without extent fall into bin 0; so does NaN.
        let scale = Vec4::select(scale.cmplt(Vec4::splat(f32::MAX)), scale, Vec4::ZERO);
        Self {
            start: centroids.min,
            scale,
            bins,
        }
    }

    /// The bins of a centroid along x, y and z: monotone in each.
    #[inline(always)]
    pub fn of(&self, centroid: Vec4) -> [usize; 3] {
        let [x, y, z, _] = self.place(centroid).to_array();
        let whole = |place: f32| (place.to_bits() >> PART) as usize % BINS;
        [whole(x), whole(y), whole(z)]
    }

    /// In all lanes whether a centroid falls into `bin` of `AXIS` or beyond it.
    #[inline(always)]
    pub fn is_beyond<const AXIS: usize>(&self, centroid: Vec4, bin: usize) -> BVec4A {
        let place = self.place(centroid);
        let along = match AXIS {
            0 => place.xxxx(),
            1 => place.yyyy(),
            _ => place.zzzz(),
        };
        along.cmpge(Vec4::splat(bin as f32 + WHOLE))
    }

    /// Where a centroid lies among the bins, above [`WHOLE`]. None lies below the first or reaches beyond the last: the
    /// least centroid is where the first begins, and the last is wider by more than what rounding adds.
    #[inline(always)]
    fn place(&self, centroid: Vec4) -> Vec4 {
        (centroid - self.start) * self.scale + WHOLE
    }
}

/// A split of a node: what falls into bins below `bin` goes to the first side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Split {
    pub axis: usize,
    pub bin: usize,
    /// Half areas times references of both sides, in units of [`Bounds::scale`] of the node.
    pub cost: f32,
    /// References of the first side.
    pub count: usize,
    /// The boxes of both sides.
    pub sides: [Bounds; 2],
}

/// How many references with what boxes fall into each bin of each axis.
#[derive(Debug, Clone)]
pub(super) struct Histogram {
    boxes: [[Hull; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl Histogram {
    pub const EMPTY: Self = Self {
        boxes: [[Hull::EMPTY; BINS]; 3],
        counts: [[0; BINS]; 3],
    };

    /// The histogram of `references`.
    #[inline(always)]
    pub fn of<L: Lane<8>>(references: &[Reference], grid: &Grid) -> Self {
        let mut histogram = Self::EMPTY;
        for reference in references {
            histogram.add::<L>(reference, grid);
        }
        histogram
    }

    #[inline(always)]
    fn add<L: Lane<8>>(&mut self, reference: &Reference, grid: &Grid) {
        let bins = grid.of(reference.centroid());
        let lanes = L::load(&reference.hull().0);
        for (axis, bin) in bins.into_iter().enumerate() {
            let bin = bin % BINS;
            self.boxes[axis][bin].grow(lanes);
            self.counts[axis][bin] += 1;
        }
    }

    /// Adds what is in `other`. The sum does not depend on the order in which histograms are joined.
    pub fn join(&mut self, other: &Self) {
        for axis in 0..3 {
            for bin in 0..BINS {
                let mine = &mut self.boxes[axis][bin];
                *mine = mine.union(&other.boxes[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
    }

    /// How many references fall below `bin` of `axis`.
    pub fn below(&self, axis: usize, bin: usize) -> usize {
        self.counts[axis][..bin].iter().map(|&c| c as usize).sum()
    }

    /// The cheapest split with something on both sides, the first of equals; `None` where no bins separate the
    /// references. `bounds`: of the node.
    pub fn best(&self, grid: &Grid, bounds: &Bounds) -> Option<Split> {
        let scale = bounds.scale();
        let mut best = (f32::INFINITY, 0, 0);
        for axis in 0..3 {
            let (boxes, counts) = (&self.boxes[axis], &self.counts[axis]);
            // Costs of the second side, swept from the last bin; then of the first, from bin 0.
            let mut second = [0.0; BINS];
            let (mut side, mut count) = (Hull::EMPTY, 0);
            for bin in (1..grid.bins).rev() {
                side = side.union(&boxes[bin]);
                count += counts[bin];
                // A side without references must not win.
                second[bin] = if count == 0 {
                    f32::INFINITY
                } else {
                    side.half_area(scale) * count as f32
                };
            }
            let (mut side, mut count) = (Hull::EMPTY, 0);
            for bin in 1..grid.bins {
                side = side.union(&boxes[bin - 1]);
                count += counts[bin - 1];
                // NaN, which does not win, where the first side is empty.
                let cost = side.half_area(scale) * count as f32 + second[bin];
                if cost < best.0 {
                    best = (cost, axis, bin);
                }
            }
        }
        let (cost, axis, bin) = best;
        (cost < f32::INFINITY).then(|| {
            let side = |bins: &[Hull]| {
                let union = bins.iter().fold(Hull::EMPTY, |side, bin| side.union(bin));
                union.bounds()
            };
            let (first, second) = self.boxes[axis].split_at(bin);
            Split {
                axis,
                bin,
                cost,
                count: self.below(axis, bin),
                sides: [side(first), side(second)],
            }
        })
    }
}
