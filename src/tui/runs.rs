//! Runs as the screens see them: the same rows for a live sweep and for an opened report.

use crate::lab::{Checksum, Event, NRule, RunConfig, RunRecord, StopReason};
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
        picked: None,
        triangles: 0,
        ray_count: config.ray_count as u64,
        build_ms: Vec::new(),
        memory_bytes: 0,
        mrays_per_s: Vec::new(),
        stopped_by: StopReason::Unfinished,
        per_ray: None,
        structure: None,
        predicted: None,
        checksum: Checksum::default(),
        valid: true,
        checked_rays: 0,
        kernel_errors: 0,
        wrong_answers: None,
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
}
