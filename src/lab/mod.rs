//! Experiments: from a plan to raw samples. Nothing here writes files, prints, or draws; what happens is told to a
//! sink as [`Event`]s.

mod control;
mod error;
mod event;
mod plan;
mod record;
mod resolutions;

pub use control::Control;
pub use error::LabError;
pub use event::Event;
pub use plan::{Budget, MAX_THREADS, NRule, Plan, RunConfig};
pub use record::{Checksum, PerRay, RunRecord, Spread, StopReason};
pub use resolutions::parse_n_list;
