//! What can be wrong with reports and bundles.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Why a report or bundle cannot be read or written.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ReportError {
    /// The system refuses.
    #[error("cannot {action} {}: {why}; check the path, its permissions and the space left", path.display())]
    File {
        /// "read", "write", "make".
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        why: String,
    },
    /// Not JSON at all.
    #[error("{} is not JSON: {why}; is it a report.json?", path.display())]
    NotJson {
        /// The file.
        path: PathBuf,
        /// What is wrong where.
        why: String,
    },
    /// It ends in the middle.
    #[error("{} ends in the middle of line {line}: it was cut off; copy it again, or --resume its bundle", path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
        /// The last line.
        line: usize,
    },
    /// JSON, but of something else.
    #[error("{} is not a raylab report: {why}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What tells.
        why: String,
    },
    /// A line of a journal that is no run.
    #[error("{}:{line} is not a finished run: {why}; remove that line to resume without it", path.display())]
    Journal {
        /// The journal.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong with it.
        why: String,
    },
    /// There is a bundle already.
    #[error("{} already holds a bundle; go on with it by --resume, or name another folder", dir.display())]
    Exists {
        /// The folder.
        dir: PathBuf,
    },
    /// There is none.
    #[error("{} holds no bundle: it has no report.json; name a folder that a sweep wrote", dir.display())]
    NoBundle {
        /// The folder.
        dir: PathBuf,
    },
    /// A bundle of another experiment.
    #[error("{} was written by `raylab {made_by}`; go on with it by `raylab {made_by} --resume`", dir.display())]
    OtherExperiment {
        /// The folder.
        dir: PathBuf,
        /// The command that wrote it.
        made_by: &'static str,
    },
}

impl ReportError {
    /// The error of a file operation.
    pub(super) fn file(action: &'static str, path: &Path, why: &io::Error) -> Self {
        Self::File {
            action,
            path: path.to_owned(),
            why: why.to_string(),
        }
    }
}
