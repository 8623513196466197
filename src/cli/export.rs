//! `raylab report`: plots and tables from a report.

use crate::report::{self, ExportError, Report, ReportError};

use super::args::ReportArgs;
use super::{Failure, print};

/// Writes each format and prints the files written, one a line.
pub fn run(args: &ReportArgs) -> Result<(), Failure> {
    let report = Report::read(&args.report)?;
    for format in args.format.split(',').map(str::trim) {
        for path in report::export(&report, format, &args.out)? {
            print(&format!("{}\n", path.display()))?;
        }
    }
    Ok(())
}

impl From<ExportError> for Failure {
    fn from(error: ExportError) -> Self {
        match error {
            ExportError::Format(error) => error.into(),
            _ => Self::Failed(error.to_string()),
        }
    }
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        let text = error.to_string();
        match error {
            ReportError::File { action: "read", .. }
            | ReportError::NotJson { .. }
            | ReportError::Truncated { .. }
            | ReportError::Foreign { .. }
            | ReportError::Journal { .. }
            | ReportError::NoBundle { .. } => Self::BadInput(text),
            ReportError::File { .. } => Self::Failed(text),
            ReportError::Exists { .. } | ReportError::OtherExperiment { .. } => Self::Usage(text),
        }
    }
}
