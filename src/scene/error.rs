//! Why a spec is no scene.

use std::path::PathBuf;

use thiserror::Error;

use super::MeshError;
use crate::registry::ChoiceError;

/// Why a spec could not be loaded.
///
/// Two kinds: what was *written* is wrong ([`SceneError::is_usage`]), or the *file* it names is.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SceneError {
    /// No scene of that name.
    #[error(transparent)]
    Choice(#[from] ChoiceError),
    /// A size that the family does not take.
    #[error("in '{spec}': {error}")]
    Size {
        /// What was written.
        spec: String,
        /// What is wrong with it.
        error: ChoiceError,
    },
    /// More sizes than the family takes.
    #[error("'{spec}' has too many sizes; write {form}")]
    TooManySizes {
        /// What was written.
        spec: String,
        /// How the family is written.
        form: String,
    },
    /// The scene would have more triangles than raylab builds.
    #[error(
        "'{spec}' would have {triangles} triangles, more than the limit of {limit}; choose a smaller size"
    )]
    TooLarge {
        /// What was written.
        spec: String,
        /// Triangles it would have.
        triangles: u64,
        /// The most that are built.
        limit: u64,
    },
    /// A file that cannot be opened or read.
    #[error("cannot read '{}': {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said, and what to do.
        reason: String,
    },
    /// A file that is not an OBJ mesh as a whole.
    #[error("'{}' {reason}", path.display())]
    NotAMesh {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, and what to do.
        reason: String,
    },
    /// A line of a file that does not say what it must.
    #[error("{}:{line}: {reason}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// What is wrong with it.
        reason: String,
    },
    /// Vertices and triangles that are no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl SceneError {
    /// Whether the spec itself is wrong (exit code 2) rather than the file that it names (exit code 5).
    #[must_use]
    pub fn is_usage(&self) -> bool {
        matches!(
            self,
            Self::Choice(_) | Self::Size { .. } | Self::TooManySizes { .. } | Self::TooLarge { .. }
        )
    }
}
