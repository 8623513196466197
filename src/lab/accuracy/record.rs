//! What is found of a kernel on some rays.

use serde::{Deserialize, Serialize};

use crate::stats::{Histogram, upper95};

use super::StartRule;

/// How often a kernel was wrong on some rays, and by how much, by the oracle; `judge` beside this file defines each
/// word, `probe` those of the last three fields.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// How far scene and rays were moved from their place, along each axis.
    #[serde(default)]
    pub offset: f64,
    /// How much larger than itself the scene was, before it was moved.
    #[serde(default = "one")]
    pub scale: f64,
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
    /// Rays whose nearest hit lies in several triangles: exactly on an edge or vertex. No error; what was asked.
    #[serde(default)]
    pub ties: u64,
    /// Error of t over right hits, in units of the last place.
    pub t_ulp: ErrorSpread,
    /// Distance of the point origin + t·direction, in `f32`, from the true plane over right hits, as a share of the
    /// diagonal of the scene's box.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<ErrorSpread>,
    /// Error of the barycentric weights over right hits, the greater of both.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub barycentric: Option<ErrorSpread>,
    /// Upper 95 % bounds of the rates (Clopper and Pearson, one-sided; at most 3 / rays where none was seen).
    pub upper95: AccuracyBounds,
    /// Secondary rays that meet the triangle they leave, by the rule that places their start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_hits: Option<[SelfHits; StartRule::ALL.len()]>,
    /// Rays that are decided otherwise where each triangle names its corners from the next one on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vertex_rotation: Option<Rate>,
    /// Rays that are decided otherwise in an equal scene elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub translation: Option<Rate>,
    /// How often tests of the kernel `exact` needed more than `f32`; absent for other kernels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fallbacks: Option<Fallbacks>,
}

fn one() -> f64 {
    1.0
}

impl Default for Accuracy {
    /// Nothing judged, in the scene's own place and size.
    fn default() -> Self {
        Self {
            offset: 0.0,
            scale: 1.0,
            rays: 0,
            leaks: 0,
            phantoms: 0,
            wrong_surface: 0,
            neighbour_swaps: 0,
            occlusion_disagreements: 0,
            ties: 0,
            t_ulp: ErrorSpread::default(),
            plane: None,
            barycentric: None,
            upper95: AccuracyBounds::default(),
            self_hits: None,
            vertex_rotation: None,
            translation: None,
            fallbacks: None,
        }
    }
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

/// How often something was seen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Rate {
    /// Of how many rays.
    pub rays: u64,
    /// On how many of them.
    pub seen: u64,
    /// Upper 95 % bound of the rate, 0 to 1.
    pub upper95: f64,
}

impl Rate {
    /// `seen` of `rays`, with the bound.
    #[must_use]
    pub fn of(seen: u64, rays: u64) -> Self {
        Self {
            rays,
            seen,
            upper95: upper95(seen, rays),
        }
    }

    /// The share itself, 0 to 1; 0 where there were no rays.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.seen as f64 / self.rays.max(1) as f64
    }
}

/// How many tests of the kernel `exact` its filter in `f32` could not decide.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Fallbacks {
    /// Tests of a sample of the rays, in the default accelerator.
    pub tests: u64,
    /// Of these, decided in `f64`.
    pub f64: u64,
    /// Of these, decided on integers.
    pub integers: u64,
}

/// How often secondary rays met the triangle that they left.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SelfHits {
    /// How their starts were placed.
    pub rule: StartRule,
    /// How often.
    #[serde(flatten)]
    pub rate: Rate,
}

/// Percentiles of an error.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ErrorSpread {
    /// Median; this and the next at most 0.4 % too low.
    pub p50: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Greatest.
    pub max: f64,
}

impl ErrorSpread {
    /// Of what was counted; zero where nothing was.
    #[must_use]
    pub fn of(errors: &Histogram) -> Self {
        Self {
            p50: errors.percentile(50),
            p99: errors.percentile(99),
            max: errors.max(),
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
