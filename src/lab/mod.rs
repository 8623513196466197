//! Experiments: from a plan to raw samples. Nothing here writes files, prints, or draws; what happens is told to a
//! sink as [`Event`]s.
//!
//! ```text
//! Plan ──runs──▶ RunConfig … ──sweep──▶ Event … ──▶ RunRecord: raw samples, counts, checks
//!                                 ▲
//!                              Control: stop, pause, "I disturbed you"
//! ```
//!
//! **How it measures.** A sample traces the whole ray set, again and again for at least 20 ms, by methods whose counters
//! are compiled out. Work is counted in a pass of its own; its answers must be those of the timed passes. Samples of all
//! runs on the same rays of a scene are interleaved in seeded random order, whatever their kernels and threads, until the
//! bootstrap interval of a run's median is narrow enough or its time is spent; the record says which. One pass before the
//! first sample warms caches and is not kept; all samples are. Before several threads are timed, builds too, all of them work for
//! 50 ms, so that their cores are awake.
//!
//! **Known biases.** Runs are interleaved, so each sample starts with the caches full of another structure: at 20 ms
//! a sample that costs a few tenths of a percent. Repeated passes find a small ray set in the cache. The nominal cost that
//! decides whether a run takes a subset of the rays ignores how fast the machine is; runs that are cut differently are not to
//! be compared, and a budget may ask for whole sets instead.

mod accuracy;
mod answers;
mod control;
mod error;
mod estimate;
mod event;
mod inspect;
mod judge;
mod live;
mod machine;
mod plan;
mod record;
mod resolutions;
mod sampling;
mod speed;
mod spread;
pub mod stability;
mod subset;
mod sweep;

pub use accuracy::{
    Accuracy, AccuracyBounds, AccuracyEvent, AccuracyPlan, AccuracyRecord, ErrorSpread, Fallbacks,
    Judging, Place, PlacedRun, Rate, SelfHits, StartRule, accuracy, accuracy_from, first_wrong,
    placed, placed_rays,
};
pub use control::Control;
pub use error::LabError;
pub use event::Event;
pub use inspect::{InspectedHit, InspectedRay, InspectedTruth, Inspection, Step, Subject, inspect};
pub use machine::{cores, warm_up};
pub use plan::{Budget, MAX_THREADS, Plan, RunConfig};
pub use record::{Checksum, PerRay, RunRecord, Spread, StopReason};
pub use resolutions::{NRule, parse_n_list};
pub use speed::speed;
pub use sweep::{Done, sweep, sweep_from};
