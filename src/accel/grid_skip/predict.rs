//! What `grid-skip` will take, and the n that is best, before it is built.
//!
//! References are the uniform grid's (see the model of `grid`). Speed has no closed form, since leaps depend on where
//! the empty space is.

use crate::accel::{MAX_N, Prediction};
use crate::scene::Mesh;

use super::super::grid::Settings;
use super::super::grid::predict::{Model, least};
use super::cells;
use super::distances::OCTANTS;

/// Cells a triangle of the best grid: from 0.5 to 4 on scanned, architectural and procedural meshes of 16 to 900 thousand
/// triangles, primary and bounce rays. Meshes that repeat themselves on many scales want more.
const DENSITY: f64 = 1.5;

/// How much an n costs that is twice or half the best, on the same meshes.
const TWICE: f64 = 0.15;

/// Bytes of a reference: in the lists from which blocks are made, and the span of a cell with its place on the curve while
/// cells are sorted.
pub(super) const REFERENCE_BYTES: u64 = 4 + 8 + 12;

/// Bytes of a grid with this many cells and references, without the triangles; the greatest number where that is more.
pub(super) fn bytes(cells: u64, references: u64) -> u64 {
    let offsets = cells.saturating_add(1).saturating_mul(4);
    cells
        .saturating_mul(OCTANTS as u64)
        .saturating_add(cells::bytes(cells))
        .saturating_add(offsets)
        .saturating_add(references.saturating_mul(REFERENCE_BYTES))
}

/// Predicts for one mesh.
pub(super) struct Predictor {
    pub model: Model,
}

impl Predictor {
    /// Sums over the triangles of `mesh`.
    pub fn new(mesh: &Mesh, settings: Settings) -> Self {
        Self {
            model: Model::new(mesh, settings),
        }
    }

    /// Bytes at `n`, without the triangles.
    pub fn bytes(&self, n: u32) -> u64 {
        bytes(self.model.cells(n), self.model.references(n).ceil() as u64)
    }

    /// The greatest n up to [`MAX_N`] whose grid takes at most `bytes`; 0 if not even one cell fits.
    pub fn largest_n(&self, bytes: u64) -> u32 {
        let fits = |n: &u32| self.bytes(*n) <= bytes;
        (1..=MAX_N).rev().find(fits).unwrap_or(0)
    }

    /// Cost of a ray at `n`, in units of the best: a parabola over the logarithm of the density.
    fn cost(&self, n: u32) -> f64 {
        let density = self.model.cells(n) as f64 / self.model.triangles().max(1.0);
        let octaves = (density / DENSITY).log2() / 3.0;
        1.0 + TWICE * octaves * octaves
    }

    /// The n that costs least, and its plateau.
    pub fn best(&self) -> (u32, [u32; 2]) {
        let largest = self.largest_n(self.model.auto_bytes()).max(1);
        let costs: Vec<f64> = (1..=largest).map(|n| self.cost(n)).collect();
        least(&costs)
    }

    /// All that is predicted at `n`.
    pub fn predict(&self, n: u32) -> Prediction {
        let (best, plateau) = self.best();
        Prediction {
            n: best,
            plateau,
            ..self.model.predict(n)
        }
    }
}
