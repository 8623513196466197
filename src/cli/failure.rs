//! Why a command ended without success, and the exit code that says so.

use std::io;

use thiserror::Error;

use crate::accel::BuildError;
use crate::preview::PictureError;
use crate::registry::ChoiceError;
use crate::scene::SceneError;
use crate::trace::RayError;

/// A command's failure; the message is one sentence that names the thing and the remedy.
#[derive(Debug, Error)]
pub enum Failure {
    /// Exit code 1: something outside the input went wrong.
    #[error("{0}")]
    Failed(String),
    /// Exit code 2: the command line asks for something that does not exist or cannot be.
    #[error("{0}")]
    Usage(String),
    /// Exit code 4: answers differ that must be equal.
    #[error("{0}")]
    Mismatch(String),
    /// Exit code 5: a file is missing, broken or foreign.
    #[error("{0}")]
    BadInput(String),
    /// Exit code 130: the user asked to stop.
    #[error("interrupted; what was measured is kept")]
    Interrupted,
    /// Exit code 0: whoever read the output has closed it.
    #[error("output closed")]
    OutputClosed,
}

impl Failure {
    /// The process's exit code.
    #[must_use]
    pub fn code(&self) -> u8 {
        match self {
            Self::OutputClosed => 0,
            Self::Failed(_) => 1,
            Self::Usage(_) => 2,
            Self::Mismatch(_) => 4,
            Self::BadInput(_) => 5,
            Self::Interrupted => 130,
        }
    }
}

impl From<ChoiceError> for Failure {
    fn from(error: ChoiceError) -> Self {
        Self::Usage(error.to_string())
    }
}

impl From<BuildError> for Failure {
    fn from(error: BuildError) -> Self {
        match error {
            BuildError::Unavailable(why) => Self::Failed(why),
            _ => Self::Usage(error.to_string()),
        }
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::OutputClosed,
            _ => Self::Failed(format!("cannot write the output: {error}")),
        }
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        if error.is_usage() {
            Self::Usage(error.to_string())
        } else {
            Self::BadInput(error.to_string())
        }
    }
}

impl From<RayError> for Failure {
    fn from(error: RayError) -> Self {
        let text = error.to_string();
        match error {
            RayError::Unknown(_) | RayError::Argument { .. } | RayError::Count(_) => {
                Self::Usage(text)
            }
            RayError::File {
                action: "write", ..
            }
            | RayError::FirstHits(_) => Self::Failed(text),
            RayError::File { .. }
            | RayError::Truncated { .. }
            | RayError::Empty { .. }
            | RayError::Invalid { .. } => Self::BadInput(text),
        }
    }
}

impl From<PictureError> for Failure {
    fn from(error: PictureError) -> Self {
        Self::Failed(error.to_string())
    }
}
