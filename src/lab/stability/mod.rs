//! The stability suite: where does each kernel and each accelerator break, and from which offset or scale on?
//!
//! ```text
//! case ─rung─▶ scene + rays ─oracle─▶ truths ──▶ kernel in brute force: the kernel's cell
//!                                        └─────▶ kernel in an accelerator, against brute force: the accelerator's cell
//!                                                          │
//!                    known failures (data with bounds) ────┴──▶ ok · known · gone · FAILS ──▶ Map
//! ```
//!
//! A kernel is judged by the oracle in brute force. An accelerator is judged against brute force with the same kernel,
//! where that is right: so a cell is about one of them, never about both. `rows` lists what is expected to fail, each
//! row with a bound, the first rung and a reason; more than a row states is a failure, and less is told as well.
//!
//! Everything here is the same on every machine and for every number of threads.
//!
//! To add a case: an entry in one of the files of `cases`, and its row in [`CASES`].

mod case;
mod cases;
mod dice;
mod judge;
mod known;
mod model;
mod reasons;
mod reproduce;
mod rows;
mod run;
mod shapes;

pub use case::{CaseEntry, Setting, case};
pub use cases::CASES;
pub use dice::Dice;
pub use known::{Bound, KnownFailure, known_failure};
pub use model::{Cell, Fault, Faults, Map, Rung, Verdict, Witness};
pub use reproduce::{Reproducer, reproduce};
pub use run::{StabilityEvent, StabilityPlan, stability};

/// The accelerator in which kernels are judged alone.
pub(crate) const BRUTE: &str = "brute";
