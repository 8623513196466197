//! Reports: the schema, the journal, exports and plots.

#[cfg(test)]
pub(crate) mod fixture;
mod model;
pub mod series;

pub use model::{Accuracy, AccuracyBounds, Provenance, Report, Run, SceneFacts, UlpSpread};
