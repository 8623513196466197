//! Two levels of grids: a coarse grid whose cells each hold a finer one, as fine as they list triangles.
//!
//! ```text
//!   +-------+-------+-------+
//!   |       |   |   |       |      coarse   n cells an axis; an empty cell holds nothing
//!   |       +---+-+-+-+     |
//!   |       |   | | | |     |      fine     a grid in a cell, cubic cells, a density of them a reference
//!   +-------+---+-+-+-+-----+
//!   |       |       |       |      blocks   what fine cells list, in blocks of eight that neighbours share
//!   +-------+-------+-------+
//! ```
//!
//! Both levels are the uniform grid's lattice, and the way through both is its walk: at each t of a coarse step the ray
//! lies in the coarse cell with its shell, and the fine walk visits all of that.
//!
//! **Source:** J. Kalojanov, M. Billeter and P. Slusallek, "Two-Level Grids for Ray Tracing on GPUs", Eurographics 2011.
//! **Differs:** n asks for the coarse resolution; where triangles cover each other, the fine grids
//! are made coarser, since cells of any size would list them all.

use crate::geometry::lanes::Isa;
use crate::geometry::{Aabb, DVec3, Ray, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::Mesh;

use super::grid::Settings;
use super::grid::density::ByDensity;
use super::grid::lattice::{Lattice, Shape};
use super::grid::walk::Walk;
use super::share::Span;
use super::traced::finish_in_order;
use super::{AcceleratorEntry, Blocks, PlaceKind, Resolution, Structure, StructureStats, Visitor};

mod build;
mod predict;
#[cfg(test)]
mod tests;
mod validate;

use predict::Predictor;

pub(super) const ENTRY: AcceleratorEntry = AcceleratorEntry {
    name: "grid-2level",
    about: "Coarse grid whose cells hold finer grids, each as fine as the cell is full.",
    paper: "Kalojanov, Billeter and Slusallek 2011, Two-Level Grids",
    params: &[Settings::OVERLAP, Settings::CUBIC_SHAPE, DENSITY],
    control: false,
    resolution: Some(Resolution {
        auto: |mesh, params| Predictor::new(mesh, params).best().0,
        predict: |mesh, params, n| Predictor::new(mesh, params).predict(n),
    }),
    peer: None,
    build: |request| {
        let (grid, slots) = build::build(request)?;
        finish_in_order(grid, &slots, request)
    },
};

/// How fine the grids in the cells are.
const DENSITY: ParamSpec = ParamSpec {
    name: "density",
    about: "Fine cells a reference of their coarse cell.",
    kind: ParamKind::Float {
        min: 0.01,
        max: 64.0,
    },
    default: "1",
};

/// Most fine cells along an axis of a coarse cell.
const MOST: u32 = 64;

/// The grid in a coarse cell.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Inner {
    /// Its first cell in the spans.
    first: u32,
    /// Cells along each axis, from 1 to [`MOST`]; 0 where the coarse cell is empty.
    dims: [u8; 3],
}

impl Inner {
    fn cells(self) -> u32 {
        self.dims.iter().map(|&n| u32::from(n)).product()
    }
}

/// The structure `grid-2level`.
#[derive(Debug)]
struct Grid2Level {
    coarse: Lattice,
    /// One a coarse cell.
    inner: Vec<Inner>,
    /// Blocks of each fine cell; of one that is empty, none.
    spans: Vec<Span>,
    /// Triangles in each block; the rest of its lanes repeat the last.
    filled: Vec<u8>,
}

/// The cells in cell `place` of `coarse`, so many along each axis: their outer planes are the coarse cell's.
fn lattice_in(coarse: &Lattice, place: u32, dims: [u8; 3]) -> Lattice {
    let [nx, ny, _] = coarse.dims;
    let cell = [place % nx, place / nx % ny, place / nx / ny];
    let (mut lo, mut hi, mut size, mut inv_size) = ([0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]);
    for a in 0..3 {
        lo[a] = coarse.plane(a, cell[a]);
        hi[a] = coarse.plane(a, cell[a] + 1);
        let cells = f64::from(dims[a]);
        size[a] = (hi[a] - lo[a]) / cells;
        inv_size[a] = if size[a] > 0.0 { size[a].recip() } else { 0.0 };
    }
    Lattice {
        lo,
        hi,
        size,
        inv_size,
        dims: dims.map(u32::from),
        pad: coarse.pad,
    }
}

/// A ray where it enters a lattice; out of line, so that it is compiled once for all kernels.
#[inline(never)]
fn enter(lattice: &Lattice, ray: &Ray) -> Option<Walk<false>> {
    Walk::new(lattice, ray)
}

impl Grid2Level {
    /// Leads `visitor` through the grid in a coarse cell; true when the query is finished.
    #[inline(always)]
    fn lead<V: Visitor>(&self, place: usize, ray: &Ray, tested: &mut u32, visitor: &mut V) -> bool {
        let inner = self.inner[place];
        let Some(mut walk) = enter(&lattice_in(&self.coarse, place as u32, inner.dims), ray) else {
            return false;
        };
        loop {
            let cell = inner.first as usize + walk.cell;
            let span = self.spans[cell];
            let exit = walk.exit();
            if V::WATCHED {
                let references = span.references(&self.filled);
                let (entry, exit) = (walk.base + walk.entry, walk.base + exit);
                visitor.step(FINE | cell as u64, true, references, entry, exit);
            }
            if span.count > 0 && span.first != *tested {
                *tested = span.first;
                for block in span.blocks() {
                    if visitor.test(block) {
                        return true;
                    }
                }
            }
            if !walk.advance(exit, visitor.t_limit()) {
                return false;
            }
        }
    }
}

/// Set in the numbers of fine cells.
const FINE: u64 = 1 << 32;

impl Structure for Grid2Level {
    type Items = Blocks;
    type Scratch = ();

    // Its walk costs far more than the calls.
    const DIRECT: bool = false;

    fn leaf(&self) -> PlaceKind {
        PlaceKind::Cell
    }

    fn scratch(&self) {}

    #[inline(always)]
    fn traverse<I: Isa, V: Visitor>(&self, ray: &Ray, (): &mut (), visitor: &mut V) {
        let Some(mut walk) = enter(&self.coarse, ray) else {
            return;
        };
        let mut tested = u32::MAX;
        loop {
            let (cell, exit) = (walk.cell, walk.exit());
            let is_empty = self.inner[cell].dims[0] == 0;
            if V::WATCHED {
                let (entry, exit) = (walk.base + walk.entry, walk.base + exit);
                visitor.step(cell as u64, is_empty, 0, entry, exit);
            }
            if !is_empty && self.lead(cell, ray, &mut tested, visitor) {
                return;
            }
            if !walk.advance(exit, visitor.t_limit()) {
                return;
            }
        }
    }

    fn place_bounds(&self, place: u64) -> Option<Aabb> {
        let (lattice, cell) = if place & FINE == 0 {
            (self.coarse, place)
        } else {
            let fine = (place & !FINE) as u32;
            let is_around =
                |inner: &Inner| (inner.first..inner.first + inner.cells()).contains(&fine);
            let coarse = self.inner.iter().position(is_around)?;
            let inner = self.inner[coarse];
            let lattice = lattice_in(&self.coarse, coarse as u32, inner.dims);
            (lattice, u64::from(fine - inner.first))
        };
        let cell = lattice.cell(cell)?;
        let corner = |end: u32| {
            let plane = |a: usize| lattice.plane(a, cell[a] + end) as f32;
            Vec3::from_array([0, 1, 2].map(plane))
        };
        Some(Aabb {
            min: corner(0),
            max: corner(1),
        })
    }

    fn stats(&self) -> StructureStats {
        let empty = |inner: &&Inner| inner.dims[0] == 0;
        let lists = || self.spans.iter().map(|span| span.references(&self.filled));
        StructureStats {
            cells: (self.inner.len() + self.spans.len()) as u64,
            empty_cells: (self.inner.iter().filter(empty).count()
                + lists().filter(|references| *references == 0).count())
                as u64,
            references: self.filled.iter().map(|count| u64::from(*count)).sum(),
            depth: 1,
            longest_list: lists().max().unwrap_or(0),
            dims: Some(self.coarse.dims),
        }
    }

    fn memory_bytes(&self) -> u64 {
        (size_of_val(self.inner.as_slice())
            + size_of_val(self.spans.as_slice())
            + self.filled.len()) as u64
    }

    fn validate(&self, mesh: &Mesh, lanes: &[u32]) -> Result<(), String> {
        validate::check(self, mesh, lanes)
    }
}

/// An axis shorter than this share of the longest has one cell.
const THIN: f64 = 1e-3;

/// Cells along each axis of the grid in a coarse cell with these edge lengths and references.
fn fine_dims(size: [f64; 3], references: usize, density: f64) -> [u8; 3] {
    let extent = DVec3::from_array(size);
    let longest = extent.max_element();
    // NaN, where all are 0, is not thick.
    let shares = size.map(|edge| edge / longest);
    let thick = shares.iter().filter(|&&share| share > THIN);
    let axes = thick.clone().count().max(1);
    let volume: f64 = thick.product();
    let n = (density * references as f64 / volume).powf(1.0 / axes as f64);
    let n = (n.round() as u32).clamp(1, MOST);
    Shape::Cubic.dims(extent, n).map(|n| n as u8)
}
