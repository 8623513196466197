//! Reports: the schema, the journal, exports and plots.

mod csv;
mod export;
#[cfg(test)]
pub(crate) mod fixture;
mod html;
mod markdown;
mod model;
pub mod plot;
pub mod series;
mod table;

pub use export::{ExportError, FORMATS, FormatEntry, export};
pub use model::{Accuracy, AccuracyBounds, Provenance, Report, Run, SceneFacts, UlpSpread};
