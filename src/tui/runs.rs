//! Runs as the screens see them: the same rows for a live sweep and for an opened report, and how a table shows them.

use std::cmp::Ordering;

use crate::accel::StructureStats;
use crate::lab::{Checksum, Event, NRule, PerRay, RunConfig, RunRecord, StopReason};
use crate::report::Run;
use crate::report::series::{accel_label, kernel_label};

/// How far a run is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Status {
    /// Not begun.
    Waiting,
    /// Its structure is being built and its work counted.
    Building,
    /// Samples are being taken.
    Sampling,
    /// Complete.
    Done,
    /// Could not be made; why.
    Failed(String),
}

impl Status {
    /// One character and one word for it.
    #[must_use]
    pub fn symbol(&self) -> (&'static str, &'static str) {
        match self {
            Self::Waiting => ("·", "waiting"),
            Self::Building => ("+", "building"),
            Self::Sampling => ("~", "sampling"),
            Self::Done => ("✓", "done"),
            Self::Failed(_) => ("!", "failed"),
        }
    }
}

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunRow {
    /// Everything measured so far, in the form of reports; what is not yet known is empty.
    pub run: Run,
    /// Accelerator with those parameters that are not the default.
    pub accel: String,
    /// Kernel with those parameters that are not the default.
    pub kernel: String,
    /// Whether the predictor chooses n.
    pub auto: bool,
    /// How far it is.
    pub status: Status,
}

impl RunRow {
    /// A run that has not begun.
    #[must_use]
    pub fn waiting(id: &str, config: &RunConfig) -> Self {
        let n = match config.n {
            Some(NRule::Fixed(n)) => Some(n),
            _ => None,
        };
        let mut run = blank(id, config);
        run.n = n;
        Self {
            accel: accel_label(&run),
            kernel: kernel_label(&run),
            run,
            auto: config.n == Some(NRule::Auto),
            status: Status::Waiting,
        }
    }

    /// A run of a report.
    #[must_use]
    pub fn reported(run: &Run) -> Self {
        Self {
            accel: accel_label(run),
            kernel: kernel_label(run),
            auto: run.params.text("n_rule") == "auto",
            run: run.clone(),
            status: Status::Done,
        }
    }

    /// Whether the structure stands, so that all but the speed is known.
    #[must_use]
    pub fn is_built(&self) -> bool {
        matches!(self.status, Status::Sampling | Status::Done)
    }

    /// The speed as far as known.
    #[must_use]
    pub fn mrays_per_s(&self) -> Option<f64> {
        let speed = &self.run.mrays_per_s;
        (!speed.samples.is_empty() || speed.median > 0.0).then_some(speed.median)
    }

    /// The resolution as the table shows it: `32`, `auto 41`, `-` where there is none.
    #[must_use]
    pub fn n_text(&self) -> String {
        match (self.auto, self.run.n) {
            (true, Some(n)) => format!("auto {n}"),
            (true, None) => "auto".to_owned(),
            (false, Some(n)) => n.to_string(),
            (false, None) => "-".to_owned(),
        }
    }

    /// Whether every word of `text` occurs in what the table shows of the run, whatever the case.
    #[must_use]
    pub fn contains(&self, text: &str) -> bool {
        let line = format!(
            "{} {} n={} {} {} {}",
            self.run.scene,
            self.accel,
            self.n_text(),
            self.kernel,
            self.run.rays,
            self.status.symbol().1
        )
        .to_lowercase();
        text.split_whitespace()
            .all(|word| line.contains(&word.to_lowercase()))
    }

    fn take(&mut self, record: &RunRecord, status: Status) {
        self.run = Run::from(record);
        self.status = status;
    }
}

/// A run of which nothing is known but its configuration.
fn blank(id: &str, config: &RunConfig) -> Run {
    Run::from(&RunRecord {
        id: id.to_owned(),
        config: config.clone(),
        n: None,
        triangles: 0,
        ray_count: config.ray_count as u64,
        build_ms: Vec::new(),
        memory_bytes: 0,
        mrays_per_s: Vec::new(),
        stopped_by: StopReason::Unfinished,
        per_ray: PerRay::default(),
        structure: StructureStats::default(),
        predicted: None,
        checksum: Checksum::default(),
        valid: true,
        checked_rays: 0,
        kernel_errors: 0,
        warnings: Vec::new(),
    })
}

/// The runs of a sweep, as its events tell of them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Runs {
    /// In plan order.
    pub rows: Vec<RunRow>,
    /// The row that was spoken of last.
    pub current: Option<usize>,
}

impl Runs {
    /// The runs of a report.
    #[must_use]
    pub fn reported(runs: &[Run]) -> Self {
        Self {
            rows: runs.iter().map(RunRow::reported).collect(),
            current: None,
        }
    }

    /// Takes in an event. One that speaks of an unknown run changes nothing.
    pub fn take(&mut self, event: &Event) {
        match event {
            Event::Started { runs } => {
                self.current = None;
                self.rows = runs
                    .iter()
                    .map(|(id, config)| RunRow::waiting(id, config))
                    .collect();
            }
            Event::Building { id } => self.with(id, |row| row.status = Status::Building),
            Event::Built { record } => {
                self.with(&record.id, |row| row.take(record, Status::Sampling));
            }
            Event::Sampled {
                id, mrays_per_s, ..
            } => self.with(id, |row| row.sample(*mrays_per_s)),
            Event::Finished { record } => {
                self.with(&record.id, |row| row.take(record, Status::Done));
            }
            Event::Failed { id, why } => {
                self.with(id, |row| row.status = Status::Failed(why.clone()));
            }
            Event::Ended { .. } => self.current = None,
        }
    }

    fn with(&mut self, id: &str, change: impl FnOnce(&mut RunRow)) {
        if let Some(at) = self.rows.iter().position(|row| row.run.id == id) {
            self.current = Some(at);
            change(&mut self.rows[at]);
        }
    }

    /// How many runs are complete, and how many could not be made.
    #[must_use]
    pub fn finished(&self) -> (usize, usize) {
        let count =
            |pick: fn(&Status) -> bool| self.rows.iter().filter(|r| pick(&r.status)).count();
        (
            count(|s| *s == Status::Done),
            count(|s| matches!(s, Status::Failed(_))),
        )
    }

    /// Those runs that are complete, for reports.
    #[must_use]
    pub fn complete(&self) -> Vec<Run> {
        let complete = self.rows.iter().filter(|row| row.status == Status::Done);
        complete.map(|row| row.run.clone()).collect()
    }

    /// Those runs whose structure stands, for charts.
    #[must_use]
    pub fn built(&self) -> Vec<Run> {
        self.rows
            .iter()
            .filter(|row| row.is_built())
            .map(|row| row.run.clone())
            .collect()
    }
}

impl RunRow {
    /// Takes in a speed while sampling goes on: the median is kept up, the interval is that of the samples.
    fn sample(&mut self, mrays_per_s: f64) {
        let speed = &mut self.run.mrays_per_s;
        speed.samples.push(mrays_per_s);
        let ends = |pick: fn(f64, f64) -> f64| speed.samples.iter().copied().reduce(pick);
        let (lo, hi) = (ends(f64::min), ends(f64::max));
        speed.median = crate::stats::median(&speed.samples).unwrap_or(0.0);
        speed.lo = lo.unwrap_or(0.0);
        speed.hi = hi.unwrap_or(0.0);
        self.status = Status::Sampling;
    }
}

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
            Self::Steps => built(figure(row.run.per_ray.steps.mean)),
            Self::Tests => built(figure(row.run.per_ray.tests.mean)),
            Self::Build => built(figure(row.run.build_ms.median)),
            Self::Memory => built(figure(mebibytes(row.run.memory_bytes))),
            Self::Checked => built(match (row.run.valid, row.run.kernel_errors) {
                (false, _) => "WRONG".to_owned(),
                (true, 0) => "yes".to_owned(),
                (true, errors) => format!("yes -{errors}"),
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
                Self::Steps => built.then_some(row.run.per_ray.steps.mean),
                Self::Tests => built.then_some(row.run.per_ray.tests.mean),
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

/// Bytes in MiB.
#[must_use]
pub fn mebibytes(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 20)
}

/// A figure with three significant digits, so that columns stay narrow: `0.0123`, `1.23`, `12.3`, `123`, `12.3k`, `1.2M`.
#[must_use]
pub fn figure(x: f64) -> String {
    let size = x.abs();
    match size {
        _ if !x.is_finite() => "-".to_owned(),
        _ if size == 0.0 => "0".to_owned(),
        _ if size < 0.000_95 => format!("{x:.0e}"),
        _ if size < 0.0995 => format!("{x:.4}"),
        _ if size < 9.995 => format!("{x:.2}"),
        _ if size < 99.95 => format!("{x:.1}"),
        _ if size < 9_999.5 => format!("{x:.0}"),
        _ if size < 999_500.0 => format!("{:.1}k", x / 1e3),
        _ if size < 999.5e6 => format!("{:.1}M", x / 1e6),
        _ => format!("{:.1}G", x / 1e9),
    }
}

/// Seconds as `0:07`, `2:41` or `1:02:03`.
#[must_use]
pub fn clock(seconds: f64) -> String {
    let s = seconds.clamp(0.0, 359_999.0).round() as u64;
    if s >= 3600 {
        format!("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
    } else {
        format!("{}:{:02}", s / 60, s % 60)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::fixture;

    #[test]
    fn a_run_goes_from_waiting_to_done_as_events_come() {
        let mut runs = Runs::default();
        let mut seen = Vec::new();
        for event in fixture::events() {
            runs.take(&event);
            if let Some(row) = runs.rows.first() {
                seen.push(row.status.symbol().1);
            }
        }
        seen.dedup();
        assert_eq!(seen, ["waiting", "building", "sampling", "done"]);
        assert_eq!(runs.finished(), (runs.rows.len() - 1, 1));
        assert_eq!(runs.built().len(), runs.rows.len() - 1);
    }

    #[test]
    fn events_of_unknown_runs_change_nothing() {
        let mut runs = Runs::default();
        runs.take(&Event::Building { id: "no".into() });
        assert_eq!(runs, Runs::default());
    }

    #[test]
    fn the_live_speed_is_the_median_so_far() {
        let mut runs = fixture::finished();
        let row = &mut runs.rows[0];
        row.run.mrays_per_s = crate::stats::Summary::default();
        assert_eq!(row.mrays_per_s(), None);
        for x in [5.0, 1.0, 2.0] {
            row.sample(x);
        }
        assert_eq!(row.mrays_per_s(), Some(2.0));
        assert_eq!((row.run.mrays_per_s.lo, row.run.mrays_per_s.hi), (1.0, 5.0));
    }

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

    #[test]
    fn figures_have_three_digits_and_stay_narrow() {
        for (x, text) in [
            (0.0, "0"),
            (0.000_012, "1e-5"),
            (0.0123, "0.0123"),
            (1.234, "1.23"),
            (12.34, "12.3"),
            (99.96, "100"),
            (1234.4, "1234"),
            (12_340.0, "12.3k"),
            (1.25e6, "1.2M"),
            (f64::NAN, "-"),
        ] {
            assert_eq!(figure(x), text);
        }
        assert_eq!(clock(7.2), "0:07");
        assert_eq!(clock(3723.0), "1:02:03");
        assert_eq!(clock(f64::INFINITY), "99:59:59");
    }
}
