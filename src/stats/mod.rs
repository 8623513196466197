//! Statistics over plain slices: what raw samples say.

use serde::{Deserialize, Serialize};

/// Median, 95 % bootstrap interval and the raw samples they come from.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Median of the samples.
    pub median: f64,
    /// Lower end of the interval of the median.
    pub lo: f64,
    /// Upper end of the interval of the median.
    pub hi: f64,
    /// Raw samples in the order in which they were taken.
    pub samples: Vec<f64>,
}
