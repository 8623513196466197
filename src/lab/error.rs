//! Why a sweep cannot be made at all. A run that fails is no error: the sweep tells of it and goes on.

use thiserror::Error;

use crate::registry::ChoiceError;
use crate::scene::SceneError;
use crate::trace::RayError;

/// Why a plan cannot be carried out.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum LabError {
    /// An item of a list of resolutions that is none.
    #[error(
        "'{item}' is not a grid resolution: {why}; write e.g. '1..256', '8..64:8', '8,16,auto'"
    )]
    Resolution {
        /// What was written.
        item: String,
        /// What is wrong with it.
        why: String,
    },
    /// A list of the plan is empty.
    #[error("the plan names no {what}; name at least one")]
    Nothing {
        /// What is missing.
        what: &'static str,
    },
    /// A distance that a scene cannot be moved by.
    #[error("a scene cannot be moved by {0}; an offset is a finite number, at least 0")]
    Offset(String),
    /// A factor that a scene cannot be scaled by.
    #[error("a scene cannot be scaled by {0}; a scale is a finite number above 0")]
    Scale(String),
    /// A thread count that makes no sense.
    #[error("{0} threads were asked for; ask for 1 to {max}", max = super::MAX_THREADS)]
    Threads(usize),
    /// A budget that never ends or never begins.
    #[error("the budget's {what} is {value}; it must be {expected}")]
    Budget {
        /// The figure.
        what: &'static str,
        /// Its value.
        value: String,
        /// What it must be.
        expected: &'static str,
    },
    /// The system gives no threads.
    #[error("the system gives no {threads} threads: {why}; ask for fewer")]
    Pool {
        /// How many were asked for.
        threads: usize,
        /// What the system says.
        why: String,
    },
    /// A peer whose library is not on this machine.
    #[error("{0}")]
    Unavailable(String),
    /// A scene cannot be loaded.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Rays cannot be made.
    #[error(transparent)]
    Rays(#[from] RayError),
    /// An unknown accelerator or kernel.
    #[error(transparent)]
    Choice(#[from] ChoiceError),
}
