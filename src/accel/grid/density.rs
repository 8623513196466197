//! The best n of a grid whose speed has no closed form: the one with a certain number of cells a triangle.

use crate::accel::{MAX_N, Prediction};

use super::predict::{Model, least};

/// What such a grid tells of itself.
pub(in super::super) trait ByDensity {
    /// How much an n costs that is twice or half the best.
    const TWICE: f64;

    /// The uniform grid's model of the mesh.
    fn model(&self) -> &Model;

    /// Cells a triangle of the best grid.
    fn density(&self) -> f64;

    /// Bytes at `n`, without the triangles.
    fn bytes(&self, n: u32) -> u64;

    /// The greatest n up to [`MAX_N`] whose grid takes at most `bytes`; 0 if not even one cell fits.
    fn largest_n(&self, bytes: u64) -> u32 {
        let fits = |n: &u32| self.bytes(*n) <= bytes;
        (1..=MAX_N).rev().find(fits).unwrap_or(0)
    }

    /// Cost of a ray at `n`, in units of the best: a parabola over the logarithm of the density.
    fn cost(&self, n: u32) -> f64 {
        let density = self.model().cells(n) as f64 / self.model().triangles().max(1.0);
        let octaves = (density / self.density()).log2() / 3.0;
        1.0 + Self::TWICE * octaves * octaves
    }

    /// The n that costs least, and its plateau.
    fn best(&self) -> (u32, [u32; 2]) {
        let largest = self.largest_n(self.model().auto_bytes()).max(1);
        let costs: Vec<f64> = (1..=largest).map(|n| self.cost(n)).collect();
        least(&costs)
    }

    /// All that is predicted at `n`.
    fn predict(&self, n: u32) -> Prediction {
        let (best, plateau) = self.best();
        Prediction {
            n: best,
            plateau,
            ..self.model().predict(n)
        }
    }
}
