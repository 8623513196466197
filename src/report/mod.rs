//! Reports: the schema, the journal, exports and plots.

mod bundle;
mod csv;
mod error;
mod export;
#[cfg(test)]
pub(crate) mod fixture;
mod html;
mod journal;
pub mod judged;
mod markdown;
mod model;
mod peers;
pub mod plot;
mod provenance;
mod read;
mod run;
pub mod scaling;
pub mod series;
pub mod stability;
mod table;

pub use crate::lab::{
    Accuracy, AccuracyBounds, ErrorSpread, Fallbacks, Place, Rate, SelfHits, StartRule,
};
pub use bundle::Bundle;
pub use error::ReportError;
pub use export::{ExportError, FORMATS, FormatEntry, export};
pub use model::{Places, Provenance, Report, Run, SceneFacts};
pub use peers::{page as peers_page, structures as structures_page};
pub use read::{SCHEMA_JSON, replace};
