//! What `grid-2level` will take, and the coarse n that is best, before it is built.

use crate::registry::Params;
use crate::scene::Mesh;

use super::super::grid::Settings;
use super::super::grid::density::ByDensity;
use super::super::grid::predict::Model;
use super::super::share::Span;
use super::Inner;

/// Coarse cells a triangle of the best grid. Kalojanov, Billeter and Slusallek 2011 take the same.
const COARSE_DENSITY: f64 = 0.125;

/// How much an n costs that is twice or half the best.
const TWICE: f64 = 0.3;

/// Bytes of this many coarse cells with their offsets in the lists; the greatest number where that is more.
pub(super) fn coarse_bytes(cells: u64) -> u64 {
    let each = (size_of::<Inner>() + size_of::<u32>()) as u64;
    cells.saturating_add(1).saturating_mul(each)
}

/// Predicts for one mesh.
pub(super) struct Predictor {
    pub model: Model,
    /// Fine cells a reference.
    pub density: f64,
}

impl Predictor {
    /// Sums over the triangles of `mesh`.
    pub fn new(mesh: &Mesh, params: &Params) -> Self {
        Self {
            model: Model::new(mesh, Settings::read(params)),
            density: params.number("density").unwrap_or(1.0),
        }
    }
}

impl ByDensity for Predictor {
    const TWICE: f64 = TWICE;

    fn model(&self) -> &Model {
        &self.model
    }

    fn density(&self) -> f64 {
        COARSE_DENSITY
    }

    fn bytes(&self, n: u32) -> u64 {
        // Rounded to whole cells an axis, fine grids of few cells have up to twice as many as asked for.
        let each = 4.0 + 2.0 * self.density * size_of::<Span>() as f64;
        let fine = (self.model.references(n) * each).ceil() as u64;
        coarse_bytes(self.model.cells(n)).saturating_add(fine)
    }
}
