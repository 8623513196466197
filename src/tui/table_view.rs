//! How a table of runs is looked at: its columns, order, filter and mark.

use std::cmp::Ordering;

use super::figures::{counted, figure, mebibytes};
use super::runs::{RunRow, Status};

/// A column of the table of runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Column {
    /// Plan order; the column itself shows how far the run is.
    Status,
    /// Scene.
    Scene,
    /// Accelerator.
    Accel,
    /// Resolution.
    N,
    /// Kernel.
    Kernel,
    /// Ray set.
    Rays,
    /// Threads.
    Threads,
    /// Speed.
    Speed,
    /// Cells or nodes a ray.
    Steps,
    /// Tests a ray.
    Tests,
    /// Build time.
    Build,
    /// Memory.
    Memory,
    /// Correctness.
    Checked,
}

impl Column {
    /// All columns from left to right.
    pub const ALL: [Self; 13] = [
        Self::Status,
        Self::Scene,
        Self::Accel,
        Self::N,
        Self::Kernel,
        Self::Rays,
        Self::Threads,
        Self::Speed,
        Self::Steps,
        Self::Tests,
        Self::Build,
        Self::Memory,
        Self::Checked,
    ];

    /// Heading.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Status => "",
            Self::Scene => "scene",
            Self::Accel => "accel",
            Self::N => "n",
            Self::Kernel => "kernel",
            Self::Rays => "rays",
            Self::Threads => "thr",
            Self::Speed => "Mrays/s",
            Self::Steps => "cells/ray",
            Self::Tests => "tests/ray",
            Self::Build => "build ms",
            Self::Memory => "MiB",
            Self::Checked => "right",
        }
    }

    /// What sorting by it is called.
    #[must_use]
    pub fn sort_name(self) -> &'static str {
        match self {
            Self::Status => "plan order",
            Self::Threads => "threads",
            Self::Memory => "memory",
            other => other.title(),
        }
    }

    /// What the cell of a run says; empty while unknown.
    #[must_use]
    pub fn cell(self, row: &RunRow) -> String {
        let built = |text: String| if row.is_built() { text } else { String::new() };
        match self {
            Self::Status => row.status.symbol().0.to_owned(),
            Self::Scene => row.run.scene.clone(),
            Self::Accel => row.accel.clone(),
            Self::N => row.n_text(),
            Self::Kernel => row.kernel.clone(),
            Self::Rays => row.run.rays.clone(),
            Self::Threads => row.run.threads.to_string(),
            Self::Speed => match &row.status {
                Status::Failed(_) => "failed".to_owned(),
                Status::Building => "building".to_owned(),
                _ => row.mrays_per_s().map_or_else(String::new, figure),
            },
            Self::Steps => built(counted(row.run.steps())),
            Self::Tests => built(counted(row.run.tests())),
            Self::Build => built(figure(row.run.build_ms.median)),
            Self::Memory => built(figure(mebibytes(row.run.memory_bytes))),
            Self::Checked => built(match (row.run.is_broken(), row.run.wrong_answers) {
                (true, _) => "WRONG".to_owned(),
                (false, Some(wrong)) if wrong > 0 => format!("{wrong} wrong"),
                (false, _) if row.run.kernel_errors > 0 => {
                    format!("yes -{}", row.run.kernel_errors)
                }
                (false, _) => "yes".to_owned(),
            }),
        }
    }

    /// Whether numbers stand in it.
    #[must_use]
    pub fn is_number(self) -> bool {
        !matches!(
            self,
            Self::Status | Self::Scene | Self::Accel | Self::Kernel | Self::Rays | Self::Checked
        )
    }

    /// How two runs stand in this column: numbers of speed from the greatest down, all else upwards; unknown last.
    fn order(self, a: &RunRow, b: &RunRow) -> Ordering {
        let number = |row: &RunRow| -> Option<f64> {
            let built = row.is_built();
            match self {
                Self::N => row.run.n.map(f64::from),
                Self::Threads => Some(row.run.threads as f64),
                Self::Speed => row.mrays_per_s().map(|x| -x),
                Self::Steps => row.run.steps().filter(|_| built),
                Self::Tests => row.run.tests().filter(|_| built),
                Self::Build => built.then_some(row.run.build_ms.median),
                Self::Memory => built.then_some(row.run.memory_bytes as f64),
                Self::Checked => built.then(|| f64::from(u8::from(row.run.valid))),
                _ => None,
            }
        };
        match self {
            Self::Status => Ordering::Equal,
            Self::Scene => a.run.scene.cmp(&b.run.scene),
            Self::Accel => a.accel.cmp(&b.accel),
            Self::Kernel => a.kernel.cmp(&b.kernel),
            Self::Rays => a.run.rays.cmp(&b.run.rays),
            _ => match (number(a), number(b)) {
                (Some(a), Some(b)) => a.total_cmp(&b),
                (a, b) => b.is_some().cmp(&a.is_some()),
            },
        }
    }
}

/// How a table of runs is looked at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TableView {
    /// Column it is sorted by.
    pub sort: Column,
    /// Only rows that contain this.
    pub filter: String,
    /// The marked line, counted among those shown.
    pub marked: usize,
    /// Columns scrolled away to the left, the status column never.
    pub scrolled: usize,
}

impl Default for TableView {
    fn default() -> Self {
        Self {
            sort: Column::Status,
            filter: String::new(),
            marked: 0,
            scrolled: 0,
        }
    }
}

impl TableView {
    /// Indices of the rows that are shown, in order.
    #[must_use]
    pub fn shown(&self, rows: &[RunRow]) -> Vec<usize> {
        let mut shown: Vec<usize> = (0..rows.len())
            .filter(|&i| rows[i].contains(&self.filter))
            .collect();
        shown.sort_by(|&a, &b| self.sort.order(&rows[a], &rows[b]));
        shown
    }

    /// The marked row; `None` where none is shown.
    #[must_use]
    pub fn marked_row<'a>(&self, rows: &'a [RunRow]) -> Option<&'a RunRow> {
        let shown = self.shown(rows);
        let last = shown.len().checked_sub(1)?;
        Some(&rows[shown[self.marked.min(last)]])
    }

    /// Moves the mark by `lines`, staying within the rows shown. Returns whether it moved.
    pub fn step(&mut self, rows: &[RunRow], lines: isize) -> bool {
        let last = self.shown(rows).len().saturating_sub(1);
        let from = self.marked.min(last);
        self.marked = from.saturating_add_signed(lines).min(last);
        self.marked != from
    }

    /// Sorts by the next column; the mark goes to the top.
    pub fn sort_by_next(&mut self) {
        let at = Column::ALL.iter().position(|&c| c == self.sort);
        let next = at.map_or(0, |at| (at + 1) % Column::ALL.len());
        self.sort = Column::ALL[next];
        self.marked = 0;
    }

    /// Scrolls by columns.
    pub fn scroll(&mut self, columns: isize) {
        // The last three columns stay in view.
        self.scrolled = self
            .scrolled
            .saturating_add_signed(columns)
            .min(Column::ALL.len() - 4);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::fixture;

    #[test]
    fn sorting_by_speed_puts_the_fastest_first_and_the_unknown_last() {
        let runs = fixture::finished();
        let view = TableView {
            sort: Column::Speed,
            ..TableView::default()
        };
        let speeds: Vec<Option<f64>> = view
            .shown(&runs.rows)
            .iter()
            .map(|&i| runs.rows[i].mrays_per_s())
            .collect();
        let known: Vec<f64> = speeds.iter().flatten().copied().collect();
        assert!(known.is_sorted_by(|a, b| a >= b), "{known:?}");
        assert_eq!(speeds.last(), Some(&None));
    }

    #[test]
    fn a_filter_keeps_rows_that_contain_all_its_words() {
        let runs = fixture::finished();
        let mut view = TableView {
            filter: "GRID n=8".to_owned(),
            ..TableView::default()
        };
        assert_eq!(view.shown(&runs.rows).len(), 1);
        view.filter = "nothing-like-it".to_owned();
        assert_eq!(view.marked_row(&runs.rows), None);
        assert!(!view.step(&runs.rows, 1));
    }

    #[test]
    fn the_mark_stays_within_the_rows() {
        let runs = fixture::finished();
        let mut view = TableView::default();
        assert!(!view.step(&runs.rows, -1));
        assert!(view.step(&runs.rows, 1000));
        assert_eq!(view.marked, runs.rows.len() - 1);
        assert!(!view.step(&runs.rows, 1));
    }
}
