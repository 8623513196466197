//! What is counted of the rays on which a kernel was judged.

use serde::{Deserialize, Serialize};

/// How often a kernel was wrong on some rays, by the oracle; `judge` beside this file defines each word.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// How far scene and rays were moved from their place, along each axis.
    #[serde(default)]
    pub offset: f64,
    /// Rays that were judged.
    pub rays: u64,
    /// The ray hits, the method misses.
    pub leaks: u64,
    /// The method hits, the ray misses.
    pub phantoms: u64,
    /// Another triangle than any nearest one, at another t.
    pub wrong_surface: u64,
    /// Another triangle than any nearest one, on the same surface.
    pub neighbour_swaps: u64,
    /// The closest-hit query hits and the occlusion query does not, or the other way round.
    #[serde(default)]
    pub occlusion_disagreements: u64,
    /// Error of t over right hits, in units of the last place.
    pub t_ulp: UlpSpread,
    /// Upper 95 % bounds of the rates (Clopper and Pearson, one-sided; at most 3 / rays where none was seen).
    pub upper95: AccuracyBounds,
}

impl Accuracy {
    /// Wrong decisions: leaks, phantoms and wrong surfaces. Neighbour swaps are harmless and apart.
    #[must_use]
    pub fn wrong(&self) -> u64 {
        self.leaks + self.phantoms + self.wrong_surface
    }

    /// Share of wrong decisions, 0 to 1; 0 where there were no rays.
    #[must_use]
    pub fn wrong_rate(&self) -> f64 {
        self.wrong() as f64 / self.rays.max(1) as f64
    }
}

/// Percentiles of an error in units of the last place.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct UlpSpread {
    /// Median.
    pub p50: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Greatest.
    pub max: f64,
}

impl UlpSpread {
    /// Of finite errors, by nearest rank, so that a percentile is an error that occurs; zero where there are none.
    #[must_use]
    pub fn of(mut errors: Vec<f64>) -> Self {
        errors.sort_unstable_by(f64::total_cmp);
        let Some(&max) = errors.last() else {
            return Self::default();
        };
        let rank = |percent: usize| errors[(errors.len() * percent).div_ceil(100) - 1];
        Self {
            p50: rank(50),
            p99: rank(99),
            max,
        }
    }
}

/// Upper bounds of rates, 0 to 1.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct AccuracyBounds {
    /// Of leaks.
    pub leaks: f64,
    /// Of phantoms.
    pub phantoms: f64,
    /// Of wrong surfaces.
    pub wrong_surface: f64,
    /// Of neighbour swaps.
    pub neighbour_swaps: f64,
    /// Of disagreements between closest hit and occlusion.
    #[serde(default)]
    pub occlusion_disagreements: f64,
}
