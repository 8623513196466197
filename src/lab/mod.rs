//! Experiments: from a plan to raw samples. Nothing here writes files, prints, or draws; what happens is told to a
//! sink as [`Event`]s.

mod control;
mod event;
mod plan;
mod record;

pub use control::Control;
pub use event::Event;
pub use plan::{Budget, NRule, Plan, RunConfig};
pub use record::{Checksum, PerRay, RunRecord, Spread, StopReason};
