//! The inner loops of the builds, compiled for the instruction set of the processor.
//!
//! The rest of the builds calls them by pointers, so that only they are compiled once a set. All sets give the same bits.
//!
//! **What was learned**, on a processor with AVX-512 at 3.2 GHz, one thread:
//! - A reference in the histogram took 5.3 ns and takes 3.8: its bins need six instructions less, see [`Grid`], and a box
//!   grows by one minimum of eight lanes, see [`Hull`](super::reference::Hull), which alone gained nothing. A second
//!   histogram for every other reference, so that neighbours need not wait for each other, paid before and now makes the
//!   tree 4 % slower to build.
//! - `Vec4::from_array` takes four numbers one by one: four instructions instead of one where they come from memory.
//! - A reference takes 4.3 ns to be moved; half of the instructions grow the boxes of centroids. It is written to both
//!   sides: to choose one by its index costs as much.
//! - Room for twice as many nodes as references, which leaves of eight use a fifth of, cost 4 to 8 % of the build, most of it
//!   to clear pages.
//! - Clearing and reading pages for the first time takes a tenth of the build; with small pages the whole takes 10 %
//!   longer.

use crate::geometry::lanes::{InstructionSet, Isa, Task};

use super::bins::{Grid, Histogram};
use super::partition::partition;
use super::reference::{Bounds, Reference};

/// The loops.
#[derive(Debug, Clone, Copy)]
pub(super) struct Loops {
    /// As [`Histogram::of`].
    pub histogram: fn(&[Reference], &Grid) -> Histogram,
    /// As [`partition`].
    pub partition: fn(Partition) -> [Bounds; 2],
}

impl Loops {
    /// Those for the best set that this processor has. All sets give the same bits.
    pub fn best() -> Self {
        Self::of(InstructionSet::best())
    }

    fn of(set: InstructionSet) -> Self {
        set.run(Find)
    }
}

struct Find;

impl Task for Find {
    type Out = Loops;

    #[inline(always)]
    fn run<I: Isa>(self) -> Loops {
        Loops {
            histogram: histogram::<I>,
            partition: partitioned::<I>,
        }
    }
}

fn histogram<I: Isa>(references: &[Reference], grid: &Grid) -> Histogram {
    I::enter(Count { references, grid })
}

struct Count<'a> {
    references: &'a [Reference],
    grid: &'a Grid,
}

impl Task for Count<'_> {
    type Out = Histogram;

    #[inline(always)]
    fn run<I: Isa>(self) -> Histogram {
        Histogram::of::<I::X8>(self.references, self.grid)
    }
}

fn partitioned<I: Isa>(task: Partition) -> [Bounds; 2] {
    I::enter(task)
}

/// What [`partition`] takes.
pub(super) struct Partition<'a> {
    pub references: &'a [Reference],
    /// Room for exactly those of each side.
    pub sides: [&'a mut [Reference]; 2],
    pub grid: &'a Grid,
    pub axis: usize,
    pub bin: usize,
}

impl Task for Partition<'_> {
    type Out = [Bounds; 2];

    #[inline(always)]
    fn run<I: Isa>(self) -> [Bounds; 2] {
        partition(self)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::testbed::{mesh, soup};
    use super::super::binned;
    use super::super::partition::extent;
    use super::*;

    #[test]
    fn every_instruction_set_splits_alike_and_moves_what_the_histogram_counted() {
        for count in [2, 33, 200, 4001] {
            let mesh = mesh(&soup(count, 0.1, u64::from(count)));
            let references = binned::references(&mesh);
            let extent = extent(&references);
            let grid = Grid::new(&extent.centroids, references.len());
            let of = |set| {
                let loops = Loops::of(set);
                let histogram = (loops.histogram)(&references, &grid);
                let split = histogram.best(&grid, &extent.bounds).expect("apart");
                let mut to = vec![Reference::NONE; references.len()];
                let (first, second) = to.split_at_mut(split.count);
                let centroids = (loops.partition)(Partition {
                    references: &references,
                    sides: [first, second],
                    grid: &grid,
                    axis: split.axis,
                    bin: split.bin,
                });
                let prims: Vec<u32> = to.iter().map(Reference::prim).collect();
                for (at, reference) in to.iter().enumerate() {
                    let is_beyond = grid.of(reference.centroid())[split.axis] >= split.bin;
                    assert_eq!(is_beyond, at >= split.count);
                }
                (prims, format!("{split:?} {centroids:?}"))
            };
            let plain = of(InstructionSet::Portable);
            for set in InstructionSet::ALL.into_iter().filter(|s| s.is_available()) {
                assert_eq!(of(set), plain, "{set}");
            }
        }
    }
}
