//! The stability map in its reduced form: accelerators with `woop` and `exact` only. It must be exactly as the list of
//! known failures states: nothing fails beyond it, and nothing that it states is gone.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::process::{Command, Output};
use std::sync::OnceLock;

use raylab::accel::{self, ACCELERATORS};
use raylab::kernel;
use raylab::lab::Control;
use raylab::lab::stability::{CASES, Cell, Map, StabilityPlan, Verdict, case, stability};

/// The map of the quick plan, made once.
fn map() -> &'static Map {
    static MAP: OnceLock<Map> = OnceLock::new();
    MAP.get_or_init(|| {
        let plan = StabilityPlan {
            quick: true,
            ..StabilityPlan::default()
        };
        stability(&plan, &Control::default(), &mut |_| {}).expect("the plan is sound")
    })
}

fn is_control(accel: &str) -> bool {
    accel::entry(accel).is_ok_and(|entry| entry.control)
}

/// The cells that are not as the list states, and the rows that would state them, by method.
fn told<'a>(cells: impl Iterator<Item = &'a Cell>) -> String {
    let mut rows: BTreeMap<&str, String> = BTreeMap::new();
    for cell in cells {
        let method = if cell.of_kernel() {
            &cell.kernel
        } else {
            &cell.accel
        };
        let rows = rows.entry(method).or_default();
        let case = case(cell.case).expect("cells are of cases");
        let first = cell.witness.map_or(f64::NAN, |w| case.rungs[w.rung]);
        let _ = writeln!(
            rows,
            "        (\"{}\", {first:?}, {}), // {}",
            cell.case,
            cell.faults.total(),
            cell.story()
        );
    }
    rows.iter().fold(String::new(), |mut text, (method, rows)| {
        let _ = write!(text, "\n{method}:\n{rows}");
        text
    })
}

#[test]
fn nothing_fails_beyond_what_is_known_and_nothing_known_is_gone() {
    let wrong = [Verdict::Fails, Verdict::Gone];
    let cells = map().cells.iter().filter(|c| wrong.contains(&c.verdict));
    // With other kernels exhibits have no rows.
    let told = told(cells.filter(|c| c.of_kernel() || !is_control(&c.accel) || c.kernel == "woop"));
    assert!(told.is_empty(), "{told}");
    let fails = map().with(Verdict::Fails).count();
    assert_eq!(fails, 0);
}

#[test]
fn the_exact_kernel_is_never_wrong_in_any_accelerator() {
    let exact = map().cells.iter().filter(|c| c.kernel == "exact");
    let wrong = exact.filter(|c| !is_control(&c.accel) && c.faults.total() > 0);
    let told = told(wrong);
    assert!(told.is_empty(), "{told}");
}

#[test]
fn no_ray_leaves_a_closed_mesh_through_a_watertight_kernel_at_any_offset() {
    for name in ["closed-edges", "closed-vertices", "closed-faces"] {
        let cell = map().kernel_cell("woop", name).expect("woop is a kernel");
        assert_eq!(cell.faults.leaks, 0, "{name}");
        assert_eq!(cell.rungs.len(), case(name).unwrap().rungs.len());
    }
}

#[test]
fn every_exhibit_fails_visibly_and_nothing_else_does() {
    let own = ACCELERATORS.iter().filter(|a| a.peer.is_none());
    for entry in own.filter(|a| a.name != "brute") {
        let of = |c: &&Cell| c.accel == entry.name && c.kernel == "woop";
        let failing = map()
            .cells
            .iter()
            .filter(of)
            .filter(|c| c.faults.total() > 0);
        assert_eq!(failing.count() > 0, entry.control, "{}", entry.name);
    }
}

#[test]
fn every_cell_of_the_plan_is_in_the_map_and_says_why_it_is_not_ok() {
    let quick = StabilityPlan {
        quick: true,
        ..StabilityPlan::default()
    };
    assert_eq!(map().cells.len(), quick.cells());
    for cell in &map().cells {
        assert_eq!(cell.faults.total() > 0, cell.witness.is_some());
        assert_eq!(cell.first.is_some(), cell.witness.is_some());
        let told = cell.reason.is_some() || cell.note.is_some();
        assert!(cell.verdict == Verdict::Ok || told, "{}", cell.story());
    }
    assert_eq!(map().cases.len(), CASES.len());
}

/// A plan of a second.
fn small(threads: usize) -> StabilityPlan {
    StabilityPlan {
        cases: vec!["closed-edges", "flat-boxes", "depth-bomb"],
        kernels: ["woop", "moller-trumbore"]
            .map(|k| kernel::parse(k).unwrap())
            .to_vec(),
        accels: ["grid", "bvh-naive-slab"]
            .map(|a| accel::parse(a).unwrap())
            .to_vec(),
        threads,
        ..StabilityPlan::default()
    }
}

#[test]
fn the_map_is_the_same_for_every_number_of_threads() {
    let [one, three] =
        [1, 3].map(|threads| stability(&small(threads), &Control::default(), &mut |_| {}).unwrap());
    assert_eq!(one, three);
    assert_eq!(one.cells.len(), 3 * (2 + 2 * 2));
    assert!(!one.stopped);
}

#[test]
fn a_suite_that_is_stopped_keeps_what_was_finished() {
    let control = Control::default();
    let mut told = 0;
    let map = stability(&small(1), &control, &mut |_| {
        told += 1;
        control.stop();
    })
    .unwrap();
    assert!(map.stopped);
    assert!(map.cells.len() == told && told < small(1).cells());
}

#[test]
fn another_seed_makes_other_rays_and_the_same_verdicts_of_the_sound() {
    let plan = StabilityPlan {
        seed: 7,
        kernels: vec![kernel::parse("woop").unwrap()],
        ..small(2)
    };
    let map = stability(&plan, &Control::default(), &mut |_| {}).unwrap();
    // The bounds of the list are those of the suite's own rays: exhibits may fail a little more often with others.
    let failing = || map.with(Verdict::Fails).filter(|c| !is_control(&c.accel));
    assert_eq!(failing().count(), 0, "{}", told(failing()));
    let verdict = |accel, case| map.cell("woop", accel, case).unwrap().verdict;
    assert_eq!(verdict("grid", "flat-boxes"), Verdict::Ok);
    assert_eq!(verdict("bvh-naive-slab", "flat-boxes"), Verdict::Known);
}

fn raylab(dir: &std::path::Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_raylab"));
    command
        .current_dir(dir)
        .args(args)
        .output()
        .expect("the program runs")
}

#[test]
fn the_command_ends_with_4_where_something_fails_that_is_not_known() {
    let here = tempfile::tempdir().unwrap();
    let run = |args: &[&str]| {
        let all = [&["stability", "--quiet"], args].concat();
        let out = raylab(here.path(), &all);
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (out.status.code(), text(&out.stdout), text(&out.stderr))
    };
    let (code, map, _) = run(&[
        "--case", "ordinary", "--kernel", "woop", "--accel", "grid,bvh",
    ]);
    assert_eq!(code, Some(0));
    assert!(map.contains("ordinary   ."), "{map}");
    // No list knows what this eps does.
    let unknown = [
        "--case",
        "closed-faces",
        "--kernel",
        "sheet-unsigned:eps=1e-9",
        "--accel",
        "bvh",
    ];
    let (code, map, why) = run(&unknown);
    assert_eq!(code, Some(4));
    assert!(map.contains("closed-faces   F"), "{map}");
    assert!(why.contains("fail unexpectedly"), "{why}");
    let (code, _, why) = run(&["--case", "slivres"]);
    assert_eq!(code, Some(2));
    assert!(why.contains("did you mean 'slivers'?"), "{why}");
}

#[test]
fn an_exported_failure_is_stepped_through_by_inspect() {
    let here = tempfile::tempdir().unwrap();
    let args =
        "stability --quiet --json --case flat-boxes --kernel woop --accel bvh-naive-slab --out map";
    let out = raylab(here.path(), &args.split(' ').collect::<Vec<_>>());
    assert_eq!(out.status.code(), Some(0));
    let map: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let cells = map["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 2);
    assert_eq!(cells[1]["verdict"], "known");
    let folder = here.path().join("map").join("failures");
    let text = std::fs::read_to_string(folder.join("README.md")).unwrap();
    let command = text
        .split("`raylab ")
        .nth(2)
        .and_then(|t| t.split('`').next());
    let command = command.expect("the second failure is the accelerator's");
    let out = raylab(&folder, &command.split(' ').collect::<Vec<_>>());
    let told = String::from_utf8_lossy(&out.stdout).into_owned();
    assert_eq!(
        out.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&out.stderr)
    );
    assert!(told.contains("WRONG"), "{told}");
    let rays: Vec<&str> = command.split(' ').collect();
    let mut beyond = rays.clone();
    beyond.extend(["--ray", "1"]);
    let out = raylab(&folder, &beyond);
    assert_eq!(out.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&out.stderr).contains("has no ray 1"));
}
