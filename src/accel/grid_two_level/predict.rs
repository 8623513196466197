//! What `grid-2level` will take, and the coarse n that is best, before it is built.

use crate::accel::{MAX_N, Prediction};
use crate::registry::Params;
use crate::scene::Mesh;

use super::super::grid::Settings;
use super::super::grid::predict::{Model, least};
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

    /// Bytes at `n`, without the triangles.
    pub fn bytes(&self, n: u32) -> u64 {
        // Rounded to whole cells an axis, fine grids of few cells have up to twice as many as asked for.
        let each = 4.0 + 2.0 * self.density * size_of::<Span>() as f64;
        let fine = (self.model.references(n) * each).ceil() as u64;
        coarse_bytes(self.model.cells(n)).saturating_add(fine)
    }

    /// The greatest n up to [`MAX_N`] whose grid takes at most `bytes`; 0 if not even one cell fits.
    pub fn largest_n(&self, bytes: u64) -> u32 {
        let fits = |n: &u32| self.bytes(*n) <= bytes;
        (1..=MAX_N).rev().find(fits).unwrap_or(0)
    }

    /// Cost of a ray at `n`, in units of the best: a parabola over the logarithm of the density.
    fn cost(&self, n: u32) -> f64 {
        let density = self.model.cells(n) as f64 / self.model.triangles().max(1.0);
        let octaves = (density / COARSE_DENSITY).log2() / 3.0;
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
