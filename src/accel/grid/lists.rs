//! Compact lists: for each cell the triangles it lists, all in one array.
//!
//! ```text
//!  offsets  0 | 0 | 2 | 3 | …        cell c lists prims[offsets[c] .. offsets[c + 1]], in ascending order
//!  prims    4   9 | 4 | …
//! ```
//!
//! **Source:** A. Lagae and P. Dutré, "Compact, Fast and Robust Grids for Ray Tracing", EGSR 2008.
//! **Differs:** the counting sort runs in parallel: chunks of triangles find their cells, sort what they found by
//! *bucket* (a range of cells), and buckets are then filled one independent of another, chunk after chunk in order. So
//! the lists are the same whatever the thread count, no cell is counted with an atomic, and a bucket stays in cache.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::geometry::Vec3;
use crate::scene::Mesh;

use super::super::parallel;
use super::lattice::{Block, Lattice};
use super::overlap::Overlap;

/// Triangles that one task finds the cells of: some milliseconds of work.
const CHUNK: usize = 2048;

/// At most this many buckets, and at least this many cells in one: its offsets fill half of a 128 KiB cache.
const BUCKETS: u64 = 256;
const BUCKET_CELLS_LOG2: u32 = 14;

/// Blocks of at most this many cells are tested cell by cell; larger ones are halved where the triangle touches them.
const DIRECT_CELLS: u64 = 4;

/// The triangles that each cell lists.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::accel) struct Lists {
    pub offsets: Vec<u32>,
    pub prims: Vec<u32>,
}

impl Lists {
    /// Lists the triangles of `mesh` in the cells they touch by `T`; `None` if these are more than `most` references.
    pub fn build<T: Overlap>(lattice: &Lattice, mesh: &Mesh, most: u64) -> Option<Self> {
        let cells = lattice.len() as usize;
        let shift =
            BUCKET_CELLS_LOG2.max((cells as u64).div_ceil(BUCKETS).next_power_of_two().ilog2());
        let buckets = (cells >> shift) + 1;
        let chunks = chunks::<T>(lattice, mesh, shift, buckets, most.min(u64::from(u32::MAX)))?;

        let references: usize = chunks.iter().map(|chunk| chunk.pairs.len()).sum();
        let mut lists = Self {
            offsets: vec![0; cells + 1],
            prims: vec![0; references],
        };
        // Every bucket gets its own part of both arrays.
        let mut rest = lists.prims.as_mut_slice();
        let mut start = 0;
        let mut parts = Vec::with_capacity(buckets);
        for bucket in 0..buckets {
            let (prims, after) =
                rest.split_at_mut(chunks.iter().map(|c| c.bucket(bucket).len()).sum());
            rest = after;
            parts.push((start, prims));
            start += parts[bucket].1.len();
        }
        lists
            .offsets
            .par_chunks_mut(1 << shift)
            .zip(parts)
            .enumerate()
            .for_each(|(bucket, (offsets, (start, prims)))| {
                let of_bucket = chunks.iter().map(|chunk| chunk.bucket(bucket));
                fill(
                    offsets,
                    (bucket << shift) as u32,
                    start as u32,
                    prims,
                    of_bucket,
                );
            });
        Some(lists)
    }

    /// Lists these triangles of `mesh`, which ascend, in the cells they touch by `T`, those that reach beyond the lattice in
    /// its last cells; `None` if these are more than `most` references.
    pub fn of_some<T: Overlap>(
        lattice: &Lattice,
        mesh: &Mesh,
        some: &[u32],
        most: usize,
    ) -> Option<Self> {
        let mut found = Vec::with_capacity(2 * some.len());
        for &prim in some {
            each_cell::<T>(lattice, mesh, prim, &mut |cell| {
                found.push(Pair { cell, prim });
            });
            if found.len() > most {
                return None;
            }
        }
        let mut lists = Self {
            offsets: vec![0; lattice.len() as usize + 1],
            prims: vec![0; found.len()],
        };
        let pairs = std::iter::once(found.as_slice());
        fill(&mut lists.offsets, 0, 0, &mut lists.prims, pairs);
        Some(lists)
    }

    /// What a cell lists.
    #[inline(always)]
    pub fn of(&self, cell: usize) -> &[u32] {
        &self.prims[self.offsets[cell] as usize..self.offsets[cell + 1] as usize]
    }

    /// Bytes of both arrays.
    pub fn bytes(&self) -> u64 {
        (size_of_val(self.offsets.as_slice()) + size_of_val(self.prims.as_slice())) as u64
    }
}

/// Bytes of lists with this many cells and references; the greatest number where that is more.
pub(in crate::accel) fn bytes(cells: u64, references: u64) -> u64 {
    let entries = cells.saturating_add(1).saturating_add(references);
    entries.saturating_mul(size_of::<u32>() as u64)
}

/// A cell and a triangle it lists.
#[derive(Debug, Clone, Copy, Default)]
struct Pair {
    cell: u32,
    prim: u32,
}

/// What a chunk of triangles found, sorted by bucket and then by triangle.
struct Chunk {
    pairs: Vec<Pair>,
    /// Bucket b is `pairs[starts[b]..starts[b + 1]]`.
    starts: Vec<u32>,
}

impl Chunk {
    fn bucket(&self, bucket: usize) -> &[Pair] {
        &self.pairs[self.starts[bucket] as usize..self.starts[bucket + 1] as usize]
    }

    /// Sorts `found` by bucket, keeping the order within each.
    fn sorted(found: &[Pair], shift: u32, buckets: usize) -> Self {
        let bucket = |pair: &Pair| (pair.cell >> shift) as usize;
        let mut starts = vec![0; buckets + 1];
        for pair in found {
            starts[bucket(pair) + 1] += 1;
        }
        for b in 0..buckets {
            starts[b + 1] += starts[b];
        }
        let mut next = starts.clone();
        let mut pairs = vec![Pair::default(); found.len()];
        for pair in found {
            let place = &mut next[bucket(pair)];
            pairs[*place as usize] = *pair;
            *place += 1;
        }
        Self { pairs, starts }
    }
}

/// Finds the cells of all triangles; `None` if these are more than `most` references.
fn chunks<T: Overlap>(
    lattice: &Lattice,
    mesh: &Mesh,
    shift: u32,
    buckets: usize,
    most: u64,
) -> Option<Vec<Chunk>> {
    let total = AtomicU64::new(0);
    let chunks = parallel::ranges(mesh.len(), CHUNK, |prims| {
        let mut found = Vec::with_capacity(2 * prims.len());
        let mut told = 0;
        for prim in prims {
            let prim = prim as u32;
            each_cell::<T>(lattice, mesh, prim, &mut |cell| {
                found.push(Pair { cell, prim });
            });
            // The sum only grows, so whether it passes `most` does not depend on the threads.
            let new = (found.len() - told) as u64;
            told = found.len();
            if total.fetch_add(new, Ordering::Relaxed) + new > most {
                return None;
            }
        }
        Some(Chunk::sorted(&found, shift, buckets))
    });
    chunks.into_iter().collect()
}

/// Calls `found` with the index of every cell that triangle `prim` touches by `T`.
pub(super) fn each_cell<T: Overlap>(
    lattice: &Lattice,
    mesh: &Mesh,
    prim: u32,
    found: &mut impl FnMut(u32),
) {
    let corners = mesh.corners(prim).map(Vec3::as_dvec3);
    let [a, b, c] = corners;
    let block = lattice.block(a.min(b).min(c), a.max(b).max(c));
    if block.cells() == 1 {
        found(lattice.index(block.first));
    } else {
        touched(lattice, &T::new(corners), &block, found);
    }
}

/// Halves `block` where the triangle touches it, down to cells.
///
/// A triangle that touches a cell touches every block around it, so halving loses none; it makes the cost of a large
/// triangle grow with the cells it touches, not with those of its box.
fn touched<T: Overlap>(
    lattice: &Lattice,
    triangle: &T,
    block: &Block,
    found: &mut impl FnMut(u32),
) {
    if block.cells() > DIRECT_CELLS {
        let (centre, half) = lattice.padded(block, lattice.pad);
        if triangle.touches(centre, half) {
            for half in block.halves() {
                touched(lattice, triangle, &half, found);
            }
        }
        return;
    }
    for z in block.first[2]..=block.last[2] {
        for y in block.first[1]..=block.last[1] {
            for x in block.first[0]..=block.last[0] {
                let cell = Block {
                    first: [x, y, z],
                    last: [x, y, z],
                };
                let (centre, half) = lattice.padded(&cell, lattice.pad);
                if triangle.touches(centre, half) {
                    found(lattice.index(cell.first));
                }
            }
        }
    }
}

/// Writes the offsets and references of one bucket, whose cells begin at `first` and references at `start`.
fn fill<'a>(
    offsets: &mut [u32],
    first: u32,
    start: u32,
    prims: &mut [u32],
    chunks: impl DoubleEndedIterator<Item = &'a [Pair]> + Clone,
) {
    let place = |pair: &Pair| (pair.cell - first) as usize;
    for pair in chunks.clone().flatten() {
        offsets[place(pair)] += 1;
    }
    let mut end = start;
    for offset in offsets.iter_mut() {
        end += *offset;
        *offset = end;
    }
    // Backwards from each end, so that every offset arrives at its start and every list ascends.
    for pair in chunks.rev().flat_map(|pairs| pairs.iter().rev()) {
        let offset = &mut offsets[place(pair)];
        *offset -= 1;
        prims[(*offset - start) as usize] = pair.prim;
    }
}
