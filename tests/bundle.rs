//! Bundles of real sweeps: what lies on the disk fits the schema, and survives being stopped.

use std::collections::BTreeMap;
use std::path::Path;

use raylab::accel;
use raylab::lab::{Control, Event, sweep_from};
use raylab::report::{
    Accuracy, Bundle, ErrorSpread, Fallbacks, Places, Provenance, Rate, Report, Run, SelfHits,
    StartRule,
};
use serde_json::{Value, json};

use plan::plan;
use schema::faults;

#[path = "fixture/plan.rs"]
mod plan;
#[path = "fixture/schema.rs"]
mod schema;

/// Sweeps into the bundle until `stop_after` samples were taken, as a program would that is then killed: nothing is
/// written after the last event. Whether the plan is complete.
fn sweep_into(bundle: &mut Bundle, stop_after: usize) -> bool {
    let control = Control::default();
    let (plan, done) = (bundle.plan().clone(), bundle.done().clone());
    let mut samples = 0;
    let mut stopped = true;
    sweep_from(&plan, &done, &control, &mut |event| {
        bundle.note(&event).unwrap();
        match event {
            Event::Sampled { .. } => samples += 1,
            Event::Ended { stopped: early } => stopped = early,
            Event::Failed { why, .. } => panic!("{why}"),
            _ => {}
        }
        if samples >= stop_after {
            control.stop();
        }
    })
    .unwrap();
    !stopped
}

fn measured(dir: &Path) -> Bundle {
    let plan = plan();
    let provenance = Provenance::gather(&plan, vec!["raylab".to_owned()]).unwrap();
    let mut bundle = Bundle::create(dir, &plan, provenance).unwrap();
    assert!(sweep_into(&mut bundle, usize::MAX));
    bundle.finish().unwrap();
    bundle
}

fn json_of(dir: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(dir.join("report.json")).unwrap()).unwrap()
}

#[test]
fn a_real_report_fits_the_schema() {
    let home = tempfile::tempdir().unwrap();
    let dir = home.path().join("results/one");
    let bundle = measured(&dir);
    let report = json_of(&dir);
    assert_eq!(faults(&report), [""; 0]);
    assert_eq!(&Report::read(&dir).unwrap(), bundle.report());
    assert_eq!(
        report["runs"].as_array().unwrap().len(),
        plan().runs().len()
    );
    let auto = |run: &&Value| run["params"]["n_rule"] == "auto";
    for run in report["runs"].as_array().unwrap().iter().filter(auto) {
        let accel = accel::entry(run["accel"].as_str().unwrap()).unwrap();
        assert!(accel.resolution.is_some(), "{run}");
        assert!(run["n"].is_number() && run["predicted"].is_object());
    }
    let sheet = |run: &&Value| run["kernel"] == "sheet-unsigned";
    for run in report["runs"].as_array().unwrap().iter().filter(sheet) {
        assert_eq!(run["params"]["eps"], 0.001);
    }
}

#[test]
fn an_unfinished_report_fits_the_schema_too() {
    let home = tempfile::tempdir().unwrap();
    let plan = plan();
    let provenance = Provenance::gather(&plan, Vec::new()).unwrap();
    let mut bundle = Bundle::create(home.path(), &plan, provenance).unwrap();
    assert_eq!(faults(&json_of(home.path())), [""; 0]);
    assert!(!sweep_into(&mut bundle, 20));
    bundle.finish().unwrap();
    assert_eq!(faults(&json_of(home.path())), [""; 0]);
}

#[test]
fn a_report_with_measured_accuracy_fits_the_schema() {
    let home = tempfile::tempdir().unwrap();
    let mut report = measured(home.path()).report().clone();
    report.runs[0].accuracy = Some(Accuracy::default());
    let spread = Some(ErrorSpread::default());
    let rate = Rate::of(1, 7);
    report.runs[1].accuracy = Some(Accuracy {
        plane: spread,
        barycentric: spread,
        self_hits: Some(StartRule::ALL.map(|rule| SelfHits { rule, rate })),
        vertex_rotation: Some(rate),
        translation: Some(rate),
        fallbacks: Some(Fallbacks::default()),
        ..Accuracy::default()
    });
    report.judged = Some(Places {
        offsets: vec![0.0, 1e4],
        scales: vec![1.0, 1e-30],
    });
    assert_eq!(faults(&serde_json::to_value(&report).unwrap()), [""; 0]);
}

#[test]
fn a_broken_report_does_not_fit_the_schema() {
    let home = tempfile::tempdir().unwrap();
    measured(home.path());
    let breaks: [(&str, Value); 10] = [
        ("/schema", json!("raylab/report/2")),
        ("/runs/0/id", json!("xyz")),
        ("/runs/0/mrays_per_s/median", json!(null)),
        ("/runs/0/mrays_per_s/samples/0", json!("1.5")),
        ("/runs/0/n", json!(0)),
        ("/runs/0/threads", json!(0)),
        ("/runs/0/checksum/id_sum", json!(1_u64 << 53)),
        ("/runs/0/stopped_by", json!("whim")),
        ("/config/n/0", json!("atuo")),
        ("/provenance/date", json!("yesterday")),
    ];
    for (place, value) in breaks {
        let mut report = json_of(home.path());
        *report.pointer_mut(place).unwrap() = value;
        assert_eq!(faults(&report).len(), 1, "{place}");
    }
    for (object, key) in [
        ("", "provenance"),
        ("/runs/0", "valid"),
        ("/runs/0/per_ray", "tests"),
    ] {
        let mut report = json_of(home.path());
        let object = report.pointer_mut(object).unwrap().as_object_mut().unwrap();
        object.remove(key).unwrap();
        assert_eq!(faults(&report).len(), 1, "{key}");
    }
    let mut report = json_of(home.path());
    report["runs"][0]["surprise"] = json!(1);
    assert_eq!(faults(&report).len(), 1);
}

#[test]
fn a_sweep_that_is_killed_again_and_again_loses_and_repeats_nothing() {
    let home = tempfile::tempdir().unwrap();
    let dir = home.path().join("killed");
    let plan = plan();
    drop(Bundle::create(&dir, &plan, Provenance::default()).unwrap());
    let mut lines_before = 0;
    for round in 0.. {
        assert!(round < 100, "the sweep never ends");
        let mut bundle = Bundle::resume(&dir).unwrap();
        assert_eq!(bundle.report().runs.len(), lines_before);
        let complete = sweep_into(&mut bundle, 9);
        if complete {
            assert!(round > 2);
            bundle.finish().unwrap();
            break;
        }
        drop(bundle);
        let journal = std::fs::read_to_string(dir.join("runs.jsonl")).unwrap();
        let runs = journal
            .lines()
            .map(|line| serde_json::from_str::<Run>(line).unwrap().id);
        let ids: std::collections::BTreeSet<String> = runs.collect();
        assert_eq!(ids.len(), journal.lines().count(), "a run was repeated");
        assert!(ids.len() >= lines_before, "a run was lost");
        lines_before = ids.len();
        // A kill in the middle of a write tears the last line of both journals.
        for (name, torn) in [("runs.jsonl", "{\"id\": \"ab"), ("samples.jsonl", "{")] {
            let path = dir.join(name);
            let text = std::fs::read_to_string(&path).unwrap() + torn;
            std::fs::write(path, text).unwrap();
        }
    }
    let by_id = |report: &Report| {
        let runs = report.runs.iter();
        runs.map(|r| {
            (
                r.id.clone(),
                (r.checksum, r.per_ray, r.structure, r.valid, r.kernel_errors),
            )
        })
        .collect::<BTreeMap<_, _>>()
    };
    let killed = Report::read(&dir).unwrap();
    assert_eq!(killed.runs.len(), plan.runs().len());
    let whole = measured(&home.path().join("whole"));
    assert_eq!(by_id(&killed), by_id(whole.report()));
    assert!(
        killed
            .runs
            .iter()
            .all(|run| run.mrays_per_s.samples.len() >= 3)
    );
}
