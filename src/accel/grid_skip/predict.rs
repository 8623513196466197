//! What `grid-skip` will take, and the n that is best, before it is built.
//!
//! References are the uniform grid's (see the model of `grid`). Speed has no closed form, since leaps depend on where
//! the empty space is.

use crate::scene::Mesh;

use super::super::grid::Settings;
use super::super::grid::density::ByDensity;
use super::super::grid::predict::Model;
use super::bricks::Bricks;
use super::cells;
use super::crowding;
use super::distances::OCTANTS;

/// Cells a triangle of the best grid: from 0.5 to 4 on scanned, architectural and procedural meshes of 16 to 900 thousand
/// triangles, primary and bounce rays. Meshes whose triangles crowd in few places want more: see `crowding`.
const DENSITY: f64 = 1.5;

/// How much an n costs that is twice or half the best, on the same meshes.
const TWICE: f64 = 0.15;

/// Bytes of a reference: in the lists from which blocks are made, and the span of a cell with its place on the curve while
/// cells are sorted.
pub(super) const REFERENCE_BYTES: u64 = 4 + 8 + 12;

/// Bytes of a grid of these cells with so many references, without the triangles; the greatest number where that is more.
pub(super) fn bytes(dims: [u32; 3], references: u64) -> u64 {
    let listed = dims
        .iter()
        .fold(1_u64, |cells, &n| cells.saturating_mul(u64::from(n)));
    let offsets = listed.saturating_add(1).saturating_mul(4);
    let cells = Bricks::new(dims).count();
    cells
        .saturating_mul(OCTANTS as u64)
        .saturating_add(cells::bytes(cells))
        .saturating_add(offsets)
        .saturating_add(references.saturating_mul(REFERENCE_BYTES))
}

/// Predicts for one mesh.
pub(super) struct Predictor {
    pub model: Model,
    /// Cells a triangle of the best grid.
    density: f64,
}

impl Predictor {
    /// Sums over the triangles of `mesh`: for all but the best n.
    pub fn new(mesh: &Mesh, settings: Settings) -> Self {
        Self {
            model: Model::new(mesh, settings),
            density: DENSITY,
        }
    }

    /// Looks where the triangles of `mesh` crowd as well, for the best n: as much work as a fifth of a build.
    pub fn looking(mesh: &Mesh, settings: Settings) -> Self {
        let even = Self::new(mesh, settings);
        let (first, largest) = (even.best().0, even.largest_n(even.model.auto_bytes()));
        Self {
            density: crowding::density(mesh, first, largest, &|n| even.model.dims(n)),
            ..even
        }
    }
}

impl ByDensity for Predictor {
    const TWICE: f64 = TWICE;

    fn model(&self) -> &Model {
        &self.model
    }

    fn density(&self) -> f64 {
        self.density
    }

    fn bytes(&self, n: u32) -> u64 {
        bytes(self.model.dims(n), self.model.references(n).ceil() as u64)
    }
}
