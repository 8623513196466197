//! Peers in sweeps and on the command line: what is told of them is what is known, and nothing else.

use std::process::{Command, Output};

use raylab::accel::{self, AcceleratorEntry};
use raylab::lab::{Control, Event, Plan, sweep};
use raylab::report::{Provenance, Report, Run, peers_page, series};
use serde_json::{Value, json};

use schema::faults;

#[path = "fixture/plan.rs"]
mod plan;
#[path = "fixture/schema.rs"]
mod schema;

fn raylab(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_raylab"))
        .args(args)
        .output()
        .unwrap()
}

/// Peers that can be built on this machine; says which cannot.
fn here() -> Vec<&'static AcceleratorEntry> {
    let peers = accel::ACCELERATORS.iter().filter(|a| a.peer.is_some());
    let (here, absent): (Vec<&AcceleratorEntry>, Vec<_>) =
        peers.partition(|a| a.standing().available);
    for entry in absent {
        println!("not tested here: {}", entry.name);
    }
    here
}

/// Peers beside a structure of ours.
fn plan() -> Plan {
    let peers = here().into_iter().map(|entry| entry.name);
    Plan {
        accels: ["bvh"]
            .into_iter()
            .chain(peers)
            .map(|a| accel::parse(a).unwrap())
            .collect(),
        rays: ["bounce", "shadow"].map(str::to_owned).to_vec(),
        ..plan::plan()
    }
}

fn measured() -> Report {
    let plan = plan();
    let mut runs = Vec::new();
    sweep(
        &plan,
        &<_>::default(),
        &Control::default(),
        &mut |event| match event {
            Event::Finished { record } => runs.push(Run::from(record.as_ref())),
            Event::Failed { why, .. } => panic!("{why}"),
            _ => {}
        },
    )
    .unwrap();
    Report {
        schema: Report::SCHEMA.to_owned(),
        provenance: Provenance::gather(&plan, vec!["raylab".to_owned()]).unwrap(),
        judged: None,
        config: plan,
        runs,
    }
}

#[test]
fn a_peer_reports_wrong_answers_and_no_work_and_names_what_decided_its_hits() {
    let report = measured();
    assert_eq!(report.runs.len(), report.config.runs().len());
    for run in &report.runs {
        let entry = accel::entry(&run.accel).unwrap();
        let is_peer = entry.peer.is_some();
        assert_eq!(run.per_ray.is_none(), is_peer, "{run:?}");
        assert_eq!(run.wrong_answers.is_some(), is_peer, "{run:?}");
        // A set of bounced rays is as large as the picture of the scene.
        assert_eq!(run.checked_rays, run.ray_count.min(200));
        assert!(!run.is_broken() && run.checksum.hits > 0 && run.memory_bytes > 0);
        // On the teapot even a peer is seldom wrong.
        assert!(run.wrong_answers.is_none_or(|wrong| wrong < 15), "{run:?}");
        assert_eq!(run.valid, run.wrong_answers.is_none_or(|wrong| wrong == 0));
        if run.accel == "embree" {
            assert_eq!(run.kernel, "embree-robust");
            assert!(run.structure.is_none() && run.params.number("eps").is_none());
            assert!(series::accel_label(run).contains("embree-robust"));
        } else {
            assert_eq!(run.beside_kernel, None);
            assert!(run.structure.is_some_and(|s| s.references >= run.triangles));
        }
        // It stands in the panel of the runs that it was measured beside.
        let panel = series::PanelKey::of(run).kernel;
        assert!(
            ["woop", "sheet-unsigned:eps=0.001"].contains(&panel.as_str()),
            "{panel}"
        );
    }
    assert_eq!(faults(&json!(report)), [""; 0]);
    let page = peers_page(&report);
    let of_obvhs = |run: &&Run| run.accel == "obvhs" && run.kernel == "woop";
    let checked = report
        .runs
        .iter()
        .filter(of_obvhs)
        .map(|run| run.checked_rays);
    let checked = format!(" of {} |", checked.sum::<u64>());
    assert!(
        page.contains("| obvhs ") && page.contains(&checked),
        "'{checked}' is not in {page}"
    );
}

#[test]
fn the_list_says_who_is_a_peer_and_whether_it_is_here() {
    let output = raylab(&["list", "accels", "--json"]);
    let rows: Value = serde_json::from_slice(&output.stdout).unwrap();
    for row in rows.as_array().unwrap() {
        let entry = accel::entry(row["name"].as_str().unwrap()).unwrap();
        assert_eq!(row["peer"], entry.peer.is_some());
        assert_eq!(
            row["available"].as_bool(),
            Some(row["unavailable_because"].is_null())
        );
        assert_eq!(row["own_test"].is_string(), row["name"] == "embree");
    }
}

#[test]
fn a_sweep_without_names_takes_no_peer_and_one_with_a_missing_library_is_refused() {
    let output = raylab(&[
        "sweep",
        "--scene",
        "one",
        "--n",
        "2",
        "--rays-count",
        "20",
        "--quick",
        "--json",
    ]);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let is_peer = |run: &Value| {
        accel::entry(run["accel"].as_str().unwrap())
            .unwrap()
            .peer
            .is_some()
    };
    assert!(!report["runs"].as_array().unwrap().iter().any(is_peer));
    if accel::entry("embree").unwrap().standing().available {
        println!("Embree is installed here: its absence is not tested");
        return;
    }
    for command in [
        &["sweep", "--scene", "one", "--accel", "embree", "--quick"][..],
        &["inspect", "one", "--pixel", "0,0", "--accel", "embree"],
    ] {
        let output = raylab(command);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(
            said.contains("install libembree4-4 or libembree3-3"),
            "{said}"
        );
    }
}

#[test]
fn a_peer_is_inspected_to_its_answer_and_tells_no_steps() {
    for entry in here() {
        let args = [
            "inspect", "teapot:4", "--pixel", "480,360", "--accel", entry.name,
        ];
        let text = String::from_utf8(raylab(&args).stdout).unwrap();
        assert!(text.contains("a peer tells nothing of its steps"), "{text}");
        let output = raylab(&[&args[..], &["--json"]].concat());
        let seen: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(seen["steps"], json!([]));
        assert_eq!(seen["right"], true, "{seen}");
        let test = entry.standing().own_test.unwrap_or("woop");
        assert_eq!(seen["kernel"], test);
    }
}
