//! `raylab accuracy` as a whole: its report fits the schema, stands in the order of its plan, and goes on where it was.

use std::path::Path;
use std::process::{Command, Output};

use raylab::lab::{AccuracyEvent, AccuracyPlan, Budget, Control, Plan, accuracy_from};
use raylab::report::{Bundle, Provenance};
use raylab::{accel, kernel};
use serde_json::Value;

use schema::faults;

#[path = "fixture/schema.rs"]
mod schema;

fn raylab(dir: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_raylab"))
        .args(args)
        .current_dir(dir)
        .output()
        .expect("the program starts")
}

fn read(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// A plan that takes a second.
fn plan() -> AccuracyPlan {
    AccuracyPlan {
        plan: Plan {
            scenes: vec!["shells:1,2".to_owned()],
            accels: ["bvh", "brute"].map(|a| accel::parse(a).unwrap()).to_vec(),
            kernels: ["sheet-signed", "woop"]
                .map(|k| kernel::parse(k).unwrap())
                .to_vec(),
            rays: vec!["edge:at=vertex".to_owned(), "random".to_owned()],
            threads: vec![1],
            ray_count: 3000,
            budget: Budget {
                sample_seconds: 1e-4,
                min_samples: 2,
                max_samples: 3,
                run_seconds: 0.01,
                checked_rays: 64,
                ..Budget::quick()
            },
            ..Plan::default()
        },
        offsets: vec![0.0, 1e4],
        scales: vec![1.0, 0.125],
    }
}

#[test]
fn a_killed_measurement_goes_on_and_stands_in_the_order_of_its_plan() {
    let home = tempfile::tempdir().unwrap();
    let dir = home.path().join("judged");
    let plan = plan();
    let provenance = Provenance::gather(&plan.plan, Vec::new()).unwrap();
    let mut bundle = Bundle::create_judged(&dir, &plan, provenance).unwrap();
    let control = Control::default();
    let mut ended = 0;
    let done = bundle.done().clone();
    accuracy_from(&plan, &done, &control, &mut |event| {
        bundle.note_judged(&event).unwrap();
        ended += usize::from(matches!(event, AccuracyEvent::Finished { .. }));
        if ended == 5 {
            control.stop();
        }
    })
    .unwrap_or_else(|why| panic!("{why}"));
    drop(bundle);
    let (bundle, again) = Bundle::resume_judged(&dir).unwrap();
    assert_eq!(again, plan);
    let kept = bundle.done().finished.len();
    assert!(kept >= 5 && kept < plan.runs().len());
    drop(bundle);
    let output = raylab(home.path(), &["accuracy", "--resume", "judged", "--json"]);
    assert!(output.status.success(), "{output:?}");
    let printed: Value = serde_json::from_slice(&output.stdout).unwrap();
    let report = read(&dir.join("report.json"));
    assert_eq!(faults(&report), [""; 0]);
    assert_eq!(printed["runs"], report["runs"]);
    let ids = report["runs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|r| r["id"].as_str());
    let expected: Vec<String> = plan.runs().into_iter().map(|r| r.id).collect();
    assert_eq!(ids.map(Option::unwrap).collect::<Vec<_>>(), expected);
    for run in report["runs"].as_array().unwrap() {
        let accuracy = &run["accuracy"];
        let watertight = run["kernel"] == "woop" && run["rays"] != "random";
        assert!(!watertight || accuracy["leaks"] == 0, "{run}");
        assert_eq!(accuracy["self_hits"].as_array().unwrap().len(), 5);
    }
    // Nothing is left to do, so nothing is done again.
    let output = raylab(home.path(), &["accuracy", "--resume", "judged"]);
    assert!(
        output.status.success() && String::from_utf8_lossy(&output.stderr).contains("about 0 ")
    );
}

#[test]
fn bundles_of_sweeps_and_of_judged_runs_are_not_taken_for_each_other() {
    let home = tempfile::tempdir().unwrap();
    let plan = plan();
    let provenance = Provenance::gather(&plan.plan, Vec::new()).unwrap();
    let [swept, judged] = ["swept", "judged"].map(|name| home.path().join(name));
    drop(Bundle::create(&swept, &plan.plan, provenance.clone()).unwrap());
    drop(Bundle::create_judged(&judged, &plan, provenance).unwrap());
    for (command, dir, other) in [
        ("sweep", "judged", "accuracy"),
        ("accuracy", "swept", "sweep"),
    ] {
        let output = raylab(home.path(), &[command, "--resume", dir]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(&format!("raylab {other} --resume")), "{said}");
    }
}

#[test]
fn both_tables_name_every_kernel_and_bad_places_are_refused() {
    let home = tempfile::tempdir().unwrap();
    let asked = [
        "accuracy",
        "one",
        "--kernel",
        "woop,sheet-unsigned",
        "--set",
        "eps=1e-5,1e-3",
        "--quick",
        "--rays-count",
        "500",
        "--offset",
        "0,8",
        "--scale",
        "0.5,1",
    ];
    let output = raylab(home.path(), &asked);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    // Two tables of three methods on two ray sets at four places.
    let rows = |word: &str| text.lines().filter(|line| line.contains(word)).count();
    assert_eq!((rows("woop"), rows("eps=0.001")), (16, 16), "{text}");
    for (option, value, words) in [
        ("--offset", "-1", "cannot be moved by -1"),
        ("--scale", "0", "cannot be scaled by 0"),
        ("--scale", "big", "'big' is not a scale"),
        ("--offset", "1,,2", "'' is not an offset"),
    ] {
        let given = format!("{option}={value}");
        let output = raylab(home.path(), &["accuracy", "one", &given]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(words), "{said}");
    }
}
