//! Reports: the schema, the journal, exports and plots.

mod model;

pub use model::{Provenance, Report, Run, SceneFacts};
