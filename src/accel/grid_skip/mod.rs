//! A uniform grid whose rays leap over empty space: each empty cell knows how large a cube ahead of it is empty too.
//!
//! ```text
//!   +---+---+---+---+---+---+---+      bricks      where in memory a cell is
//!   |   |   |   |   |   | # | # |      distances   per direction, how far a ray may leap
//!   +---+---+---+---+---+---+---+      cells       which cells list triangles, and in which blocks
//!   | o===========>---->|>#>|   |      crowded     which blocks of a cell with many a ray meets
//!   +---+---+---+---+---+---+---+      walk        the ways of several rays at once, one step
//!   |   |   |   |   |   |   |   |      lanes       many rays of a batch side by side
//!   |   |   |   |   |   |   |   |      slices      rays from one origin together
//!   +---+---+---+---+---+---+---+      predict     what it will take, and the best n; crowding: where triangles crowd
//!   +---+---+---+---+---+---+---+
//! ```
//!
//! Where cells are and which triangles they list is the uniform grid's (see `grid`), and so is the rule when to stop. A
//! cell's triangles are tested as one or few blocks, which neighbours share (see `share`), along a Z-order curve; triangles
//! in several blocks are tested again, which costs less than to remember them.
//!
//! **Source:** D. Cohen and Z. Sheffer, "Proximity clouds: an acceleration technique for 3D grid traversal", The Visual
//! Computer 11, 1994; G. M. Morton, "A Computer Oriented Geodetic Data Base and a New Technique in File Sequencing", IBM
//! 1966, for the curve; each part names its own.

use rayon::prelude::*;

use crate::geometry::lanes::Isa;
use crate::geometry::{Aabb, Ray, Vec3};
use crate::scene::Mesh;

use super::grid::Settings;
use super::grid::density::ByDensity;
use super::grid::lattice::Lattice;
use super::grid::lists::Lists;
use super::packets;
use super::parallel;
use super::share::{Shared, Span};
use super::slab::{Clip, WideSlabRay};
use super::traced::finish_in_order;
use super::{
    AcceleratorEntry, Blocks, BuildError, BuildRequest, MAX_N, PlaceKind, Rays, Resolution,
    Structure, StructureStats, Visitor,
};

mod bricks;
mod cells;
mod crowded;
mod crowding;
mod distances;
mod lanes;
mod predict;
mod slices;
#[cfg(test)]
mod tests;
mod validate;
mod walk;

use bricks::Bricks;
use cells::Cells;
use crowded::Crowded;
use distances::OCTANTS;
use predict::Predictor;
use walk::Ways;

pub(super) const ENTRY: AcceleratorEntry = AcceleratorEntry {
    name: "grid-skip",
    about: "Uniform grid whose empty cells know how far ahead there is nothing, and triangles in blocks of eight.",
    paper: "Cohen and Sheffer 1994, Proximity clouds; Es and İşler 2007",
    params: &[Settings::OVERLAP, Settings::CUBIC_SHAPE],
    control: false,
    resolution: Some(Resolution {
        auto: |mesh, params| Predictor::looking(mesh, Settings::read(params)).best().0,
        predict: |mesh, params, n| Predictor::looking(mesh, Settings::read(params)).predict(n),
    }),
    peer: None,
    build: |request| {
        let (grid, slots) = GridSkip::new(request)?;
        finish_in_order(grid, &slots, request)
    },
};

/// The structure `grid-skip`.
#[derive(Debug)]
struct GridSkip {
    lattice: Lattice,
    bricks: Bricks,
    /// Cells along each axis.
    dims: [f32; 3],
    /// See `distances`.
    distances: Vec<u8>,
    cells: Cells,
    /// Triangles in each block; the rest of its lanes repeat the last.
    filled: Vec<u8>,
    crowded: Crowded,
}

impl GridSkip {
    /// Builds the grid, and the triangles of its blocks.
    ///
    /// # Errors
    /// It would take more memory than allowed, by prediction before anything is allocated, or by count while the
    /// references are found and before they are packed.
    fn new(request: &BuildRequest) -> Result<(Self, Vec<u32>), BuildError> {
        let settings = Settings::read(request.params);
        let n = request.n.unwrap_or(1).max(1);
        let mesh: &Mesh = request.mesh;
        let predictor = Predictor::new(mesh, settings);
        let limit = request.memory_limit;
        let refuse = |predicted_bytes, largest_n| BuildError::TooLarge {
            accel: ENTRY.name,
            n,
            predicted_bytes,
            limit_bytes: limit,
            largest_n,
        };
        let largest_n = || predictor.largest_n(limit);
        if n > MAX_N || predictor.bytes(n) > limit {
            return Err(refuse(predictor.bytes(n), largest_n()));
        }
        let mut lattice = Lattice::new(mesh.bounds(), predictor.model.dims(n));
        lattice.pad *= walk::PAD;
        let most = limit.saturating_sub(predict::bytes(lattice.dims, 0)) / predict::REFERENCE_BYTES;
        // A model that was too low for this mesh was so by an unknown factor: half the resolution is a safe advice.
        let less = || (n / 2).min(largest_n());
        let Some(lists) = settings.lists(&lattice, mesh, most) else {
            return Err(refuse(limit.saturating_add(1), less()));
        };
        let bricks = Bricks::new(lattice.dims);
        let listed = |brick: usize| {
            let row = |(bit, cell, count): (usize, [u32; 3], u32)| {
                let first = lattice.index(cell) as usize;
                let offsets = lists.offsets[first..=first + count as usize].windows(2);
                offsets.enumerate().fold(0, |bits, (k, offsets)| {
                    bits | u64::from(offsets[0] != offsets[1]) << (bit + k)
                })
            };
            bricks.rows(brick).map(row).fold(0, |bits, row| bits | row)
        };
        let mut cells = Cells::new(bricks.len() / bricks::BRICK, listed);
        let (shared, first) = share(mesh, &lattice, &bricks, &lists, &mut cells);
        drop(lists);
        let crowded = Crowded::new(mesh, first, &shared.slots);
        let bytes =
            predict::bytes(lattice.dims, 0) + cells.bytes() + shared.bytes() + crowded.bytes();
        if bytes > limit {
            return Err(refuse(bytes, less()));
        }
        let grid = Self {
            dims: lattice.dims.map(|n| n as f32),
            distances: distances::distances(&cells, &bricks, lattice.dims),
            lattice,
            bricks,
            cells,
            filled: shared.filled,
            crowded,
        };
        Ok((grid, shared.slots))
    }

    /// Where the distances of a direction begin.
    #[inline(always)]
    fn direction(&self, octant: usize) -> usize {
        octant * (self.distances.len() / OCTANTS)
    }

    /// Tests the blocks of a cell that `ray` may meet; true when the query is finished.
    #[inline(always)]
    fn test<I: Isa, V: Visitor>(&self, span: Span, ray: &Ray, visitor: &mut V) -> bool {
        let scene = self.crowded.scene();
        self.test_met::<I, _, _>(span, || WideSlabRay::new::<I::X8>(ray, scene), visitor)
    }

    /// As [`GridSkip::test`], of the ray or rays that `slabs` gives.
    #[inline(always)]
    fn test_met<I: Isa, C: Clip<I::X8>, V: Visitor>(
        &self,
        span: Span,
        slabs: impl Fn() -> C,
        visitor: &mut V,
    ) -> bool {
        if self.crowded.holds(span) {
            return self.crowded.test::<I, _, V>(span, slabs, visitor);
        }
        for block in span.blocks() {
            if visitor.test(block) {
                return true;
            }
        }
        false
    }
}

/// Listed cells that one task puts into blocks. Blocks are not shared beyond, so that they do not depend on the threads.
const CHUNK: usize = 4096;

/// Puts all that `lists` has into blocks, and the spans into `cells`; returns the first block of a crowded cell as well.
fn share(
    mesh: &Mesh,
    lattice: &Lattice,
    bricks: &Bricks,
    lists: &Lists,
    cells: &mut Cells,
) -> (Shared, u32) {
    let mut listed = Vec::with_capacity(cells.spans.len());
    cells.each_listed(0..bricks.len(), |place| {
        let at = bricks.cell(place).unwrap_or_default();
        listed.push((along_curve(at), listed.len() as u32, lattice.index(at)));
    });
    listed.par_sort_unstable();
    let put = |cells: &[(u32, u32, u32)]| {
        let (mut few, mut many) = (Shared::default(), Shared::default());
        let lists = cells
            .iter()
            .map(|(_, rank, cell)| (*rank, lists.of(*cell as usize)));
        few.put(lists.clone().filter(|(_, list)| !crowded::is_crowd(list)));
        for (rank, list) in lists.filter(|(_, list)| crowded::is_crowd(list)) {
            let list = crowded::clustered(mesh, list);
            many.put(std::iter::once((rank, list.as_slice())));
        }
        (few, many)
    };
    let parts = parallel::chunks(&listed, CHUNK, put);
    let (mut all, mut crowded) = (Shared::default(), Shared::default());
    for (few, many) in parts {
        all.append(few, 0);
        crowded.append(many, 0);
    }
    let first = all.filled.len() as u32;
    all.append(crowded, 0);
    for (rank, span) in std::mem::take(&mut all.spans) {
        cells.spans[rank as usize] = span;
    }
    (all, first)
}

/// The place of a cell on the curve: the bits of its numbers in turn, ten of each.
fn along_curve(cell: [u32; 3]) -> u32 {
    let spread = |i: u32| (0..10).fold(0, |bits, bit| bits | (i >> bit & 1) << (3 * bit));
    spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}

impl Structure for GridSkip {
    type Items = Blocks;
    type Scratch = ();

    fn leaf(&self) -> PlaceKind {
        PlaceKind::Cell
    }

    fn scratch(&self) {}

    #[inline(always)]
    fn traverse<I: Isa, V: Visitor>(&self, ray: &Ray, (): &mut (), visitor: &mut V) {
        let mut way = Ways::<1>::none();
        let Some((frame, octant)) = way.put(0, &self.lattice, &self.bricks, ray) else {
            return;
        };
        way.stop[0] = frame.stop(visitor.t_limit());
        let direction = self.direction(octant);
        let mut tested = u32::MAX;
        loop {
            let (cell, begin) = (way.cell[0] as usize, way.exit[0]);
            let leap = self.distances[direction + cell];
            way.leap[0] = i32::from(leap);
            let span = if leap == 0 {
                self.cells.span(cell)
            } else {
                Span::default()
            };
            let done = way.advance(self.dims, &self.bricks) != 0;
            if V::WATCHED {
                let place = (direction + cell) as u64;
                let references = span.references(&self.filled);
                let (entry, exit) = (frame.t(begin), frame.t(way.exit[0]));
                visitor.step(place, true, references, entry, exit);
            }
            if span.first != tested && span.count > 0 {
                tested = span.first;
                if self.test::<I, V>(span, ray, visitor) {
                    return;
                }
                way.stop[0] = frame.stop(visitor.t_limit());
                if way.exit[0] >= way.stop[0] {
                    return;
                }
            } else if done {
                return;
            }
        }
    }

    #[inline(always)]
    fn trace<'a, R: Rays<'a>>(&self, batch: &mut R, (): &mut ()) {
        let all = 0..batch.rays().len();
        if !R::Isa::SIXTEEN {
            packets::alone(self, batch, all, &mut ());
        } else if R::WAYS && R::Visitor::ORDERED && packets::share_origin(batch.rays()) {
            packets::trace(self, batch, &mut (), true);
        } else {
            lanes::trace(self, batch, all);
        }
    }

    fn place_bounds(&self, place: u64) -> Option<Aabb> {
        let leap = *self.distances.get(place as usize)?;
        let cell = self.bricks.cell(place as usize % self.bricks.len())?;
        let octant = place as usize / self.bricks.len();
        // The empty cube, or the one cell, within the grid.
        let more = u32::from(leap.max(1)) - 1;
        let down = |a: usize| octant >> a & 1 == 1;
        let first = |a: usize| cell[a] - if down(a) { more.min(cell[a]) } else { 0 };
        let last = |a: usize| {
            let ahead = self.lattice.dims[a] - 1 - cell[a];
            cell[a] + if down(a) { 0 } else { more.min(ahead) }
        };
        let corner = |number: &dyn Fn(usize) -> u32| {
            Vec3::from_array([0, 1, 2].map(|a| self.lattice.plane(a, number(a)) as f32))
        };
        Some(Aabb {
            min: corner(&first),
            max: corner(&|a| last(a) + 1),
        })
    }

    fn stats(&self) -> StructureStats {
        let spans = &self.cells.spans;
        StructureStats {
            cells: self.lattice.len(),
            empty_cells: self.lattice.len() - spans.len() as u64,
            references: self.filled.iter().map(|count| u64::from(*count)).sum(),
            depth: 0,
            longest_list: spans
                .iter()
                .map(|span| span.references(&self.filled))
                .max()
                .unwrap_or(0),
            dims: Some(self.lattice.dims),
        }
    }

    fn memory_bytes(&self) -> u64 {
        (self.distances.len() + self.filled.len()) as u64
            + self.cells.bytes()
            + self.crowded.bytes()
    }

    fn validate(&self, mesh: &Mesh, lanes: &[u32]) -> Result<(), String> {
        validate::check(self, mesh, lanes)
    }
}
