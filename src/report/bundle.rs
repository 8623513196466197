//! Bundles: what a sweep leaves in `results/NAME/`.
//!
//! ```text
//! report.json     plan and provenance at once; the runs when the sweep ends or stops     written beside and renamed
//! runs.jsonl      one line a finished run                                               synced to disk as it ends
//! samples.jsonl   one line a sample of a run in progress                                handed to the system as taken
//! ```
//!
//! **What a kill costs.** Samples of a group of runs are interleaved, so many runs are in progress at any moment. The
//! journal of samples keeps what was measured of them: a kill loses the sample being taken, and a resumed sweep goes on
//! with the others. (A power failure may also take the last lines of `samples.jsonl`, never a finished run.) A line that
//! was torn is dropped.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::lab::{AccuracyEvent, AccuracyPlan, Done, Event, Plan, RunRecord};

use super::journal::Journal;
use super::{Places, Provenance, Report, ReportError, Run};

/// A bundle that a sweep writes to.
#[derive(Debug)]
pub struct Bundle {
    dir: PathBuf,
    report: Report,
    done: Done,
    runs: Journal,
    samples: Journal,
    /// Runs that could not be made in this sweep: id and reason.
    failed: Vec<(String, String)>,
}

/// A line of `samples.jsonl`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Sample {
    id: String,
    mrays_per_s: f64,
}

impl Bundle {
    /// Makes the folder and everything in it; the report has no runs yet.
    ///
    /// # Errors
    /// There is a bundle already; the folder or a file cannot be made.
    pub fn create(dir: &Path, plan: &Plan, provenance: Provenance) -> Result<Self, ReportError> {
        Self::make(dir, plan, None, provenance)
    }

    /// As [`Bundle::create`], for runs that the oracle judges.
    ///
    /// # Errors
    /// As [`Bundle::create`].
    pub fn create_judged(
        dir: &Path,
        plan: &AccuracyPlan,
        provenance: Provenance,
    ) -> Result<Self, ReportError> {
        let places = Places {
            offsets: plan.offsets.clone(),
            scales: plan.scales.clone(),
        };
        Self::make(dir, &plan.plan, Some(places), provenance)
    }

    fn make(
        dir: &Path,
        plan: &Plan,
        judged: Option<Places>,
        provenance: Provenance,
    ) -> Result<Self, ReportError> {
        let [report, runs, samples] = paths(dir);
        if report.exists() || runs.exists() {
            let dir = dir.to_owned();
            return Err(ReportError::Exists { dir });
        }
        fs::create_dir_all(dir).map_err(|why| ReportError::file("make", dir, &why))?;
        let bundle = Self {
            dir: dir.to_owned(),
            report: Report {
                schema: Report::SCHEMA.to_owned(),
                provenance,
                config: plan.clone(),
                judged,
                runs: Vec::new(),
            },
            done: Done::default(),
            runs: Journal::open(runs, 0)?,
            samples: Journal::open(samples, 0)?,
            failed: Vec::new(),
        };
        bundle.report.write(&report)?;
        Ok(bundle)
    }

    /// Opens a bundle that a stopped or killed sweep left, with everything that was measured.
    ///
    /// # Errors
    /// There is none, or one of judged runs; a file cannot be read; a line of the journal other than the last is broken.
    pub fn resume(dir: &Path) -> Result<Self, ReportError> {
        let bundle = Self::open(dir)?;
        if bundle.report.judged.is_some() {
            let (dir, made_by) = (dir.to_owned(), "accuracy");
            return Err(ReportError::OtherExperiment { dir, made_by });
        }
        Ok(bundle)
    }

    /// As [`Bundle::resume`], of runs that the oracle judges; with their plan.
    ///
    /// # Errors
    /// As [`Bundle::resume`]; the bundle is one of a sweep.
    pub fn resume_judged(dir: &Path) -> Result<(Self, AccuracyPlan), ReportError> {
        let bundle = Self::open(dir)?;
        if let Some(plan) = bundle.report.accuracy_plan() {
            Ok((bundle, plan))
        } else {
            let (dir, made_by) = (dir.to_owned(), "sweep");
            Err(ReportError::OtherExperiment { dir, made_by })
        }
    }

    fn open(dir: &Path) -> Result<Self, ReportError> {
        let [report, runs, samples] = paths(dir);
        let mut report = Report::read(if report.exists() { &report } else { dir })?;
        let (finished, runs) = Journal::resume::<Run>(runs)?;
        let (taken, samples) = Journal::resume::<Sample>(samples)?;
        let mut done = Done::default();
        // The journal is written first and holds at least what the report does.
        report.runs.extend(finished);
        report
            .runs
            .retain(|run| done.finished.insert(run.id.clone()));
        let mut by_run: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for sample in taken {
            by_run
                .entry(sample.id)
                .or_default()
                .push(sample.mrays_per_s);
        }
        by_run.retain(|id, _| !done.finished.contains(id));
        done.samples = by_run;
        Ok(Self {
            dir: dir.to_owned(),
            report,
            done,
            runs,
            samples,
            failed: Vec::new(),
        })
    }

    /// Keeps what an event says: samples and finished runs. To be called with every event of the sweep.
    ///
    /// # Errors
    /// A journal cannot be written.
    pub fn note(&mut self, event: &Event) -> Result<(), ReportError> {
        match event {
            Event::Sampled {
                id, mrays_per_s, ..
            } => self.note_sample(id, *mrays_per_s),
            Event::Finished { record } => self.append(record),
            Event::Failed { id, why } => {
                self.failed.push((id.clone(), why.clone()));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Keeps what an event of judged runs says. To be called with every event.
    ///
    /// # Errors
    /// A journal cannot be written.
    pub fn note_judged(&mut self, event: &AccuracyEvent) -> Result<(), ReportError> {
        match event {
            AccuracyEvent::Sampled { id, mrays_per_s } => self.note_sample(id, *mrays_per_s),
            AccuracyEvent::Finished { record } => self.keep(Run::from(record.as_ref())),
            _ => Ok(()),
        }
    }

    fn note_sample(&mut self, id: &str, mrays_per_s: f64) -> Result<(), ReportError> {
        let id = id.to_owned();
        self.samples.append(&Sample { id, mrays_per_s }, false)
    }

    /// Appends a finished run to the journal and syncs it to disk; a run that is there already is left alone.
    ///
    /// # Errors
    /// The journal cannot be written.
    pub fn append(&mut self, record: &RunRecord) -> Result<(), ReportError> {
        self.keep(Run::from(record))
    }

    fn keep(&mut self, run: Run) -> Result<(), ReportError> {
        if self.done.finished.insert(run.id.clone()) {
            self.runs.append(&run, true)?;
            self.report.runs.push(run);
        }
        Ok(())
    }

    /// Writes `report.json` with all finished runs, in the order of the plan. To be called when the sweep ends or
    /// stops, and whenever the report is wanted in between.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish(&mut self) -> Result<(), ReportError> {
        self.report.put_in_order();
        self.report.write(&self.dir.join("report.json"))?;
        if self.is_complete() {
            self.samples.clear()?;
        }
        Ok(())
    }

    /// Whether every run of the plan is finished.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let ids = self.report.planned_ids();
        ids.iter().all(|id| self.done.finished.contains(id))
    }

    /// The folder.
    #[must_use]
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// The plan.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.report.config
    }

    /// What need not be measured again.
    #[must_use]
    pub fn done(&self) -> &Done {
        &self.done
    }

    /// Everything so far; runs stand in the order in which they ended until [`Bundle::finish`].
    #[must_use]
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// Runs that could not be made in this sweep: id and reason.
    #[must_use]
    pub fn failed(&self) -> &[(String, String)] {
        &self.failed
    }
}

/// Report, journal of runs, journal of samples.
fn paths(dir: &Path) -> [PathBuf; 3] {
    ["report.json", "runs.jsonl", "samples.jsonl"].map(|name| dir.join(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::NRule;

    fn record(plan: &Plan, index: usize) -> RunRecord {
        let config = plan.runs()[index].clone();
        RunRecord {
            id: config.id(),
            config,
            n: Some(8),
            picked: None,
            triangles: 1,
            ray_count: 1,
            build_ms: vec![0.1],
            memory_bytes: 1,
            mrays_per_s: vec![1.0 / 3.0, 0.1],
            stopped_by: crate::lab::StopReason::Time,
            per_ray: None,
            structure: None,
            predicted: None,
            checksum: <_>::default(),
            valid: true,
            checked_rays: 1,
            kernel_errors: 0,
            wrong_answers: None,
            warnings: Vec::new(),
        }
    }

    fn plan() -> Plan {
        Plan {
            n: vec![NRule::Fixed(8), NRule::Auto],
            threads: vec![1, 2],
            ..Plan::default()
        }
    }

    fn finished(record: RunRecord) -> Event {
        let record = Box::new(record);
        Event::Finished { record }
    }

    fn sampled(id: &str, mrays_per_s: f64) -> Event {
        Event::Sampled {
            id: id.to_owned(),
            mrays_per_s,
            done: 0.0,
            seconds_left: 0.0,
        }
    }

    #[test]
    fn a_bundle_that_was_left_comes_back_with_all_that_was_measured() {
        let home = tempfile::tempdir().unwrap();
        let dir = home.path().join("a/b");
        let plan = plan();
        let mut bundle = Bundle::create(&dir, &plan, Provenance::default()).unwrap();
        let [one, two] = [1, 0].map(|i| record(&plan, i));
        for event in [
            sampled(&one.id, 1.0 / 3.0),
            sampled(&two.id, 0.2),
            finished(one.clone()),
            sampled(&two.id, 0.3),
        ] {
            bundle.note(&event).unwrap();
        }
        drop(bundle);
        let mut bundle = Bundle::resume(&dir).unwrap();
        assert_eq!(bundle.plan(), &plan);
        assert_eq!(bundle.report().runs, [Run::from(&one)]);
        assert!(bundle.done().finished.contains(&one.id));
        assert_eq!(
            bundle.done().samples,
            BTreeMap::from([(two.id.clone(), vec![0.2, 0.3])])
        );
        bundle.note(&finished(two.clone())).unwrap();
        bundle.note(&finished(two.clone())).unwrap();
        bundle.finish().unwrap();
        let ids = |report: &Report| report.runs.iter().map(|r| r.id.clone()).collect::<Vec<_>>();
        // In the order of the plan, each once.
        assert_eq!(ids(&Report::read(&dir).unwrap()), [two.id, one.id]);
        assert_eq!(ids(Bundle::resume(&dir).unwrap().report()).len(), 2);
    }

    #[test]
    fn a_torn_line_costs_only_itself() {
        let home = tempfile::tempdir().unwrap();
        let plan = plan();
        let mut bundle = Bundle::create(home.path(), &plan, Provenance::default()).unwrap();
        bundle.append(&record(&plan, 0)).unwrap();
        drop(bundle);
        let journal = home.path().join("runs.jsonl");
        let whole = fs::read(&journal).unwrap();
        for torn in [1, 7, whole.len() - 1] {
            let mut text = whole.clone();
            text.extend(&whole[..torn]);
            fs::write(&journal, &text).unwrap();
            let mut bundle = Bundle::resume(home.path()).unwrap();
            assert_eq!(bundle.done().finished.len(), 1);
            bundle.append(&record(&plan, 1)).unwrap();
            assert_eq!(Bundle::resume(home.path()).unwrap().report().runs.len(), 2);
        }
    }

    #[test]
    fn a_broken_line_inside_the_journal_is_named() {
        let home = tempfile::tempdir().unwrap();
        drop(Bundle::create(home.path(), &plan(), Provenance::default()).unwrap());
        fs::write(home.path().join("runs.jsonl"), "\n{\"id\": 3}\n").unwrap();
        let why = Bundle::resume(home.path()).unwrap_err().to_string();
        assert!(why.contains("runs.jsonl:2 is not a finished run"), "{why}");
    }

    #[test]
    fn a_bundle_is_never_overwritten_and_never_made_up() {
        let home = tempfile::tempdir().unwrap();
        let why = Bundle::resume(home.path()).unwrap_err().to_string();
        assert!(why.contains("holds no bundle"), "{why}");
        drop(Bundle::create(home.path(), &plan(), Provenance::default()).unwrap());
        let why = Bundle::create(home.path(), &plan(), Provenance::default()).unwrap_err();
        assert!(why.to_string().contains("--resume"), "{why}");
    }

    #[test]
    fn a_bundle_that_cannot_be_made_is_named() {
        let home = tempfile::tempdir().unwrap();
        let file = home.path().join("file");
        fs::write(&file, "").unwrap();
        let why = Bundle::create(&file.join("b"), &plan(), Provenance::default()).unwrap_err();
        assert!(why.to_string().starts_with("cannot make "), "{why}");
    }

    #[test]
    fn a_complete_bundle_keeps_no_samples_of_its_own() {
        let home = tempfile::tempdir().unwrap();
        let plan = plan();
        let mut bundle = Bundle::create(home.path(), &plan, Provenance::default()).unwrap();
        for i in 0..plan.runs().len() {
            bundle.note(&sampled(&record(&plan, i).id, 1.0)).unwrap();
            assert!(!bundle.is_complete());
            bundle.note(&finished(record(&plan, i))).unwrap();
        }
        bundle.finish().unwrap();
        assert!(bundle.is_complete());
        assert_eq!(fs::read(home.path().join("samples.jsonl")).unwrap(), b"");
    }
}
