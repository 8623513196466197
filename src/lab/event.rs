//! What a running sweep tells its sink.

use super::{RunConfig, RunRecord};

/// What a running sweep tells.
#[derive(Debug, Clone)]
pub enum Event {
    /// The runs that will be made, those already finished left out.
    Started {
        /// Their ids and configurations, in plan order.
        runs: Vec<(String, RunConfig)>,
    },
    /// A structure is being built.
    Building {
        /// The run.
        id: String,
    },
    /// A structure stands; its counted pass is done.
    Built {
        /// The record so far: no speeds yet.
        record: Box<RunRecord>,
    },
    /// A sample was taken.
    Sampled {
        /// The run.
        id: String,
        /// Speed in millions of rays a second.
        mrays_per_s: f64,
        /// Share of the sweep that is done, 0 to 1.
        done: f64,
        /// Estimated seconds to the end.
        seconds_left: f64,
    },
    /// A run is complete.
    Finished {
        /// Everything measured.
        record: Box<RunRecord>,
    },
    /// A run could not be made; the sweep goes on.
    Failed {
        /// The run.
        id: String,
        /// Why, one sentence.
        why: String,
    },
    /// The sweep has ended, complete or stopped.
    Ended {
        /// Whether it was stopped.
        stopped: bool,
    },
}
