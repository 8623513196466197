//! The bundles on disk: listed and read in threads of their own, so that a slow disk never holds the screen up.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::Sender;
use std::thread;

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::app::Message;
use super::state::BundleRow;
use super::update::Event;
use crate::report::{Report, Run};

/// Lists the bundles in `results`.
pub(super) fn list(results: PathBuf, to: Sender<Message>) {
    thread::spawn(move || {
        let _ = to.send(Message::News(Event::Listed(bundles(&results))));
    });
}

/// Reads the report of the bundle at `path`, with runs that so far only its journal has.
pub(super) fn read(path: PathBuf, to: Sender<Message>) {
    thread::spawn(move || {
        let read = Report::read(&path)
            .map(|mut report| {
                add_journal(&mut report, &path);
                (name(&path), Box::new(report))
            })
            .map_err(|error| error.to_string());
        let _ = to.send(Message::News(Event::Read(read)));
    });
}

/// Adds the runs of the journal that the report lacks. A line that is not whole yet is left out: a sweep may be writing
/// it just now.
fn add_journal(report: &mut Report, path: &Path) {
    let journal = fs::read_to_string(path.join("runs.jsonl")).unwrap_or_default();
    let runs = journal
        .lines()
        .filter_map(|line| serde_json::from_str::<Run>(line).ok());
    for run in runs {
        if report.runs.iter().all(|known| known.id != run.id) {
            report.runs.push(run);
        }
    }
}

fn name(path: &Path) -> String {
    path.file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default()
}

/// The bundles in a directory, newest first; none where the directory does not exist yet.
fn bundles(results: &Path) -> Result<Vec<BundleRow>, String> {
    let unreadable = |error: std::io::Error| {
        let dir = results.display();
        format!("cannot read '{dir}': {error}; check the path and its permissions")
    };
    let entries = match fs::read_dir(results) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(unreadable(error)),
    };
    let mut rows: Vec<BundleRow> = Vec::new();
    for entry in entries {
        rows.extend(bundle(&entry.map_err(unreadable)?.path()));
    }
    rows.sort_by(|a, b| (&b.date, &b.name).cmp(&(&a.date, &a.name)));
    Ok(rows)
}

/// What a list needs of a report; the rest is skipped.
#[derive(Deserialize)]
struct Outline {
    provenance: Dated,
    runs: Vec<IgnoredAny>,
}

#[derive(Deserialize)]
struct Dated {
    date: String,
}

/// The bundle in a directory; `None` where there is none.
fn bundle(path: &Path) -> Option<BundleRow> {
    let mut row = BundleRow {
        path: path.to_owned(),
        name: name(path),
        date: String::new(),
        runs: 0,
        note: String::new(),
    };
    let outline = fs::read(path.join("report.json"))
        .ok()
        .map(|bytes| serde_json::from_slice::<Outline>(&bytes));
    let journal = fs::read_to_string(path.join("runs.jsonl")).ok();
    let kept = journal.as_ref().map_or(0, |text| text.lines().count());
    match (outline, journal) {
        (None, None) => return None,
        (Some(Ok(outline)), _) => {
            row.date = outline.provenance.date;
            row.runs = outline.runs.len().max(kept);
            if kept > outline.runs.len() {
                "not finished: raylab sweep --resume goes on".clone_into(&mut row.note);
            }
        }
        (Some(Err(_)), _) => "report.json is no report".clone_into(&mut row.note),
        (None, Some(_)) => {
            row.runs = kept;
            "not finished: raylab sweep --resume goes on".clone_into(&mut row.note);
        }
    }
    Some(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bundles_come_newest_first_and_other_folders_not_at_all() {
        let results = tempfile::tempdir().unwrap();
        let make = |name: &str, file: &str, text: &str| {
            fs::create_dir_all(results.path().join(name)).unwrap();
            fs::write(results.path().join(name).join(file), text).unwrap();
        };
        let report = |date| format!(r#"{{"provenance":{{"date":"{date}"}},"runs":[{{}},{{}}]}}"#);
        make("old", "report.json", &report("2026-01-01T00:00:00Z"));
        make("new", "report.json", &report("2026-02-01T00:00:00Z"));
        make("torn", "report.json", "{\"prov");
        make("killed", "runs.jsonl", "{}\n{}\n{}\n");
        make("other", "notes.txt", "no bundle");
        let rows = bundles(results.path()).unwrap();
        let names: Vec<&str> = rows.iter().map(|row| row.name.as_str()).collect();
        assert_eq!(names, ["new", "old", "torn", "killed"]);
        assert_eq!((rows[0].runs, rows[3].runs), (2, 3));
        assert!(rows[3].note.contains("--resume") && rows[2].note.contains("no report"));
    }

    #[test]
    fn runs_that_only_the_journal_has_are_shown_too() {
        let dir = tempfile::tempdir().unwrap();
        let runs = crate::tui::fixture::finished().complete();
        let lines: Vec<String> = runs
            .iter()
            .map(|run| serde_json::to_string(run).unwrap())
            .collect();
        let torn = &lines[0][..40];
        fs::write(
            dir.path().join("runs.jsonl"),
            format!("{}\n{torn}", lines.join("\n")),
        )
        .unwrap();
        let mut report = Report {
            schema: Report::SCHEMA.to_owned(),
            judged: None,
            provenance: crate::report::Provenance::default(),
            config: crate::lab::Plan::default(),
            runs: vec![runs[1].clone()],
        };
        add_journal(&mut report, dir.path());
        assert_eq!(report.runs.len(), runs.len());
        assert_eq!(report.runs[0].id, runs[1].id);
    }

    #[test]
    fn a_results_directory_that_does_not_exist_yet_has_no_bundles() {
        assert_eq!(bundles(Path::new("does/not/exist")), Ok(Vec::new()));
    }
}
