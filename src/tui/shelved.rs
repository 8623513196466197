//! Bundles on the disk as the reports screen shows them, and the one that is open.

use std::path::PathBuf;

use super::runs::Runs;
use super::table_view::TableView;
use crate::report::Report;

/// A bundle in the results directory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BundleRow {
    /// Its directory.
    pub path: PathBuf,
    /// Its name: the directory's.
    pub name: String,
    /// Start, RFC 3339; empty where unknown.
    pub date: String,
    /// Runs in the report or, where there is none yet, in the journal.
    pub runs: usize,
    /// What a reader should know, e.g. that the sweep was not finished.
    pub note: String,
}

/// An opened report.
#[derive(Debug, Clone, PartialEq)]
pub struct Opened {
    /// The name of its bundle.
    pub name: String,
    /// The report.
    pub report: Report,
    /// Its runs.
    pub runs: Runs,
    /// How their table is looked at.
    pub table: TableView,
}

impl Opened {
    /// A report that was read from the bundle `name`.
    #[must_use]
    pub fn new(name: String, report: Report) -> Self {
        Self {
            name,
            runs: Runs::reported(&report.runs),
            report,
            table: TableView::default(),
        }
    }
}

/// The reports screen.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reports {
    /// Bundles, newest first; `None` until the directory was read.
    pub bundles: Option<Vec<BundleRow>>,
    /// Why they could not be listed.
    pub error: Option<String>,
    /// Only bundles that contain this.
    pub filter: String,
    /// The marked line among those shown.
    pub marked: usize,
    /// The opened report; the keys go to its table while it is shown.
    pub opened: Option<Opened>,
}

impl Reports {
    /// The bundles that are shown.
    pub fn shown(&self) -> impl Iterator<Item = &BundleRow> {
        let filter = self.filter.to_lowercase();
        self.bundles
            .iter()
            .flatten()
            .filter(move |b| b.name.to_lowercase().contains(&filter))
    }
}
