//! The references of a node and how they are divided between its children.
//!
//! ```text
//!   references of a node          spare room of the same size
//!   | . . . . . . . . . . |  -->  | first side . . > < . second side |     then the two change roles
//! ```
//!
//! The first side is moved to the begin of the spare room and the second to its end, each in its order. Where room is left
//! between them, for references that spatial splits add, both sides get a share.

use std::ops::Range;

use glam::{BVec4A, Vec4};
use rayon::prelude::*;

use super::super::parallel;
use super::bins::{Grid, Histogram, Split};
use super::loops::{Loops, Partition};
use super::reference::{Bounds, Extent, Reference};

/// Above this many references, threads share the work on a single node, in chunks of [`CHUNK`].
const SHARED: usize = 4 * CHUNK;

/// References of a chunk: large beside a histogram, small beside a mesh.
pub(super) const CHUNK: usize = 16_384;

/// References that say how large the boxes of a node's references are.
const SAMPLE: usize = 128;

/// Runs `work` on `references`, chunk by chunk where they are many, and joins what comes back; `join` must not depend on
/// the order.
pub(super) fn chunked<T: Send>(
    references: &[Reference],
    work: impl Fn(&[Reference]) -> T + Sync,
    join: impl Fn(T, T) -> T,
) -> T {
    if references.len() >= SHARED {
        let parts = parallel::chunks(references, CHUNK, &work);
        if let Some(joined) = parts.into_iter().reduce(join) {
            return joined;
        }
    }
    work(references)
}

/// The boxes of `references` and of their centroids.
pub(super) fn extent(references: &[Reference]) -> Extent {
    let serial = |chunk: &[Reference]| chunk.iter().fold(Extent::EMPTY, Extent::grown);
    chunked(references, serial, Extent::union)
}

/// The references of a node in their room, and as much room beside it.
pub(super) struct Task<'a> {
    references: &'a mut [Reference],
    spare: &'a mut [Reference],
    filled: Range<usize>,
    pub extent: Extent,
}

/// An object split, and the histograms of the chunks where threads share the node.
pub(super) struct Choice {
    pub split: Split,
    grid: Grid,
    parts: Vec<Histogram>,
}

impl<'a> Task<'a> {
    /// The first `count` of `references`; the rest is room.
    pub fn new(references: &'a mut [Reference], spare: &'a mut [Reference], count: usize) -> Self {
        Self {
            extent: extent(&references[..count]),
            references,
            spare,
            filled: 0..count,
        }
    }

    pub fn references(&self) -> &[Reference] {
        &self.references[self.filled.clone()]
    }

    pub fn len(&self) -> usize {
        self.filled.len()
    }

    /// How many references may be added.
    pub fn room(&self) -> usize {
        self.references.len() - self.len()
    }

    /// The best object split; `None` where no bins separate the centroids.
    pub fn choose(&self, loops: Loops) -> Option<Choice> {
        let references = self.references();
        let grid = Grid::new(&self.extent.centroids, references.len());
        let mut parts = Vec::new();
        let histogram = if references.len() < SHARED {
            (loops.histogram)(references, &grid)
        } else {
            parts = parallel::chunks(references, CHUNK, |chunk| (loops.histogram)(chunk, &grid));
            let mut joined = Histogram::EMPTY;
            for part in &parts {
                joined.join(part);
            }
            joined
        };
        let split = histogram.best(&grid, &self.extent.bounds)?;
        Some(Choice { split, grid, parts })
    }

    /// Both sides of an object split.
    pub fn divided(self, loops: Loops, choice: &Choice) -> [Self; 2] {
        let Choice { split, grid, parts } = choice;
        let count = self.len() - split.count;
        let room = self.spare.len() - count;
        let (first, second) = self.spare.split_at_mut(room);
        let task = Partition {
            references: &self.references[self.filled.clone()],
            sides: [&mut first[..split.count], second],
            grid,
            axis: split.axis,
            bin: split.bin,
        };
        let centroids = if parts.is_empty() {
            (loops.partition)(task)
        } else {
            partition_shared(loops, task, parts)
        };
        let extents = [0, 1].map(|side| Extent {
            bounds: split.sides[side],
            centroids: centroids[side],
        });
        self.moved([split.count, count], extents)
    }

    /// The references and the spare room, for a division that moves the first side to the begin of the spare room and the
    /// second to its end, and then calls [`Task::moved`].
    pub fn parts(&mut self) -> (&[Reference], &mut [Reference]) {
        (&self.references[self.filled.clone()], self.spare)
    }

    /// The two sides after they were moved to the begin and to the end of the spare room.
    pub fn moved(self, [a, b]: [usize; 2], extents: [Extent; 2]) -> [Self; 2] {
        let room = self.spare.len() - a - b;
        let mut middle = a;
        if room > 0 {
            // What has large boxes is where spatial splits can save most. A few references say how large they are.
            let area = |references: &[Reference]| -> f64 {
                let each = references.len().div_ceil(SAMPLE).max(1);
                let scale = self.extent.bounds.scale();
                let areas = references.iter().step_by(each);
                let sum: f64 = areas.map(|r| f64::from(r.bounds().half_area(scale))).sum();
                sum * each as f64
            };
            let [first, second] = [&self.spare[..a], &self.spare[a + room..]].map(area);
            let share = first / (first + second);
            // A share that is no number gives zero.
            middle += ((room as f64 * share) as usize).min(room);
        }
        let filled = [0..a, a + room - middle..self.spare.len() - middle];
        Self::pair([self.spare, self.references], middle, filled, extents)
    }

    /// Halves by index.
    pub fn halved(self) -> [Self; 2] {
        let middle = self.filled.start + self.len() / 2;
        let sides = [self.filled.start..middle, middle..self.filled.end];
        let extents = sides.clone().map(|side| extent(&self.references[side]));
        let filled = [self.filled.start..middle, 0..self.filled.end - middle];
        Self::pair([self.references, self.spare], middle, filled, extents)
    }

    /// Two tasks that share the rooms of one at `middle`.
    fn pair(
        [references, spare]: [&'a mut [Reference]; 2],
        middle: usize,
        [a_filled, b_filled]: [Range<usize>; 2],
        [a_extent, b_extent]: [Extent; 2],
    ) -> [Self; 2] {
        let (a, b) = references.split_at_mut(middle);
        let (a_spare, b_spare) = spare.split_at_mut(middle);
        let side = |references, spare, filled, extent| Self {
            references,
            spare,
            filled,
            extent,
        };
        [
            side(a, a_spare, a_filled, a_extent),
            side(b, b_spare, b_filled, b_extent),
        ]
    }
}

/// Moves `references` to both sides, in their order, and returns the boxes of the centroids of each.
#[inline(always)]
pub(super) fn partition(task: Partition) -> [Bounds; 2] {
    match task.axis {
        0 => partition_along::<0>(task),
        1 => partition_along::<1>(task),
        _ => partition_along::<2>(task),
    }
}

#[inline(always)]
fn partition_along<const AXIS: usize>(task: Partition) -> [Bounds; 2] {
    let Partition {
        references,
        sides: [first, second],
        grid,
        bin,
        ..
    } = task;
    let mut beyond_count = 0;
    let mut centroids = Centroids::EMPTY;
    for (i, reference) in references.iter().enumerate() {
        let centroid = reference.centroid();
        let beyond = grid.is_beyond::<AXIS>(centroid, bin);
        centroids.add(centroid, beyond);
        // To both, without a branch that could be mispredicted; what is on the wrong side is overwritten by the next.
        if let Some(slot) = first.get_mut(i - beyond_count) {
            *slot = *reference;
        }
        if let Some(slot) = second.get_mut(beyond_count) {
            *slot = *reference;
        }
        beyond_count += beyond.bitmask() as usize & 1;
    }
    centroids.0
}

/// The boxes of the centroids on both sides of a split.
#[derive(Clone, Copy)]
struct Centroids([Bounds; 2]);

impl Centroids {
    const EMPTY: Self = Self([Bounds::EMPTY; 2]);

    /// Adds to one side without a branch: for the other side the centroid lies at infinity.
    #[inline(always)]
    fn add(&mut self, centroid: Vec4, beyond: BVec4A) {
        let [first, second] = &mut self.0;
        let a = Vec4::select(beyond, Vec4::INFINITY, Vec4::ZERO);
        let b = Vec4::select(beyond, Vec4::ZERO, Vec4::INFINITY);
        first.min = first.min.min(centroid + a);
        first.max = first.max.max(centroid - a);
        second.min = second.min.min(centroid + b);
        second.max = second.max.max(centroid - b);
    }
}

/// As [`partition`], chunk by chunk; `parts` are their histograms, which say where each chunk's references go.
fn partition_shared(loops: Loops, task: Partition, parts: &[Histogram]) -> [Bounds; 2] {
    let Partition {
        references,
        sides: [mut first, mut second],
        grid,
        axis,
        bin,
    } = task;
    let mut chunks = Vec::with_capacity(parts.len());
    for (references, part) in references.chunks(CHUNK).zip(parts) {
        let below = part.below(axis, bin);
        let (a, a_rest) = std::mem::take(&mut first).split_at_mut(below);
        let (b, b_rest) = std::mem::take(&mut second).split_at_mut(references.len() - below);
        (first, second) = (a_rest, b_rest);
        chunks.push(Partition {
            references,
            sides: [a, b],
            grid,
            axis,
            bin,
        });
    }
    let union = |[a, b]: [Bounds; 2], [c, d]: [Bounds; 2]| [a.union(c), b.union(d)];
    chunks
        .into_par_iter()
        .map(loops.partition)
        .reduce(|| [Bounds::EMPTY; 2], union)
}
