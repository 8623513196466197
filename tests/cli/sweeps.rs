//! Sweeps: printed, interrupted, resumed, charted.

use std::fs;
use std::process::Command;

use serde_json::Value;

use super::succeed;

#[test]
fn a_sweep_prints_a_report_in_which_every_run_is_valid() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    let args = [
        "sweep",
        "--scene",
        "teapot:4,soup:500,0.5",
        "--accel",
        "brute,grid,kd-tree,bvh",
        "--n",
        "1..8",
        "--kernel",
        "moller-trumbore,woop",
        "--rays",
        "primary,random",
        "--rays-count",
        "500",
        "--quick",
        "--threads",
        "1",
        "--json",
        "--quiet",
    ];
    let report: Value = serde_json::from_str(&succeed(dir.path(), &args)).expect("JSON");
    assert_eq!(report["schema"], "raylab/report/1");
    let runs = report["runs"].as_array().expect("runs");
    // Two scenes, kernels and ray sets; six resolutions of the grid and three structures without one.
    assert_eq!(runs.len(), 8 * (6 + 3));
    for run in runs {
        assert_eq!(run["valid"], true, "{run}");
        assert_eq!(run["kernel_errors"], 0, "{run}");
    }
}

#[test]
fn an_interrupted_sweep_goes_on_where_it_was() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    let dir = dir.path();
    let args = [
        "sweep",
        "--scene",
        "teapot:6",
        "--n",
        "1..64",
        "--threads",
        "1",
        "--rays-count",
        "4000",
        "--out",
        "bundle",
    ];
    let mut child = Command::new(env!("CARGO_BIN_EXE_raylab"))
        .args(args)
        .current_dir(dir)
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("the program starts");
    let journal = dir.join("bundle/runs.jsonl");
    let finished = || -> Vec<String> {
        let text = fs::read_to_string(&journal).unwrap_or_default();
        let whole = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
        let id = |line: &str| {
            serde_json::from_str::<Value>(line).expect("a line is a run")["id"].to_string()
        };
        whole.lines().map(id).collect()
    };
    // Killed as hard as can be as soon as a few runs are finished; on a very fast machine perhaps all are.
    while finished().len() < 3
        && child
            .try_wait()
            .expect("the program can be waited for")
            .is_none()
    {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    child.kill().expect("the program can be killed");
    child.wait().expect("the program ends");
    let before = finished();
    assert!(before.len() >= 3);

    succeed(dir, &["sweep", "--resume", "bundle", "--quiet"]);
    let after = finished();
    assert_eq!(
        after[..before.len()],
        before,
        "a finished run was lost or moved"
    );
    let unique: std::collections::BTreeSet<_> = after.iter().collect();
    assert_eq!(unique.len(), after.len(), "a run was repeated");
    let report: Value =
        serde_json::from_slice(&fs::read(dir.join("bundle/report.json")).expect("written"))
            .expect("JSON");
    assert_eq!(report["runs"].as_array().map(Vec::len), Some(after.len()));
    assert!(dir.join("bundle/report.html").exists());
    assert!(
        fs::read_dir(dir.join("bundle"))
            .expect("readable")
            .any(|f| {
                f.expect("readable")
                    .path()
                    .extension()
                    .is_some_and(|e| e == "svg")
            })
    );
}

#[test]
fn a_sweep_over_sizes_of_a_family_charts_and_tabulates_how_costs_grow() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    let sweep = [
        "sweep",
        "--scene",
        "soup:20,soup:200,soup:2000",
        "--accel",
        "bvh,grid",
        "--n",
        "2,4",
        "--threads",
        "1",
        "--rays-count",
        "300",
        "--quick",
        "--out",
        "growth",
    ];
    let text = succeed(dir.path(), &sweep);
    let (_, growths) = text.split_once("\n\n").expect("a second table");
    let rows: Vec<&str> = growths.lines().collect();
    assert_eq!(rows.len(), 3, "{growths}");
    assert!(rows[0].starts_with("family") && rows[0].contains("build N^"));
    assert!(rows[1].starts_with("soup    bvh ") && rows[2].starts_with("soup    grid "));
    let bundle = dir.path().join("growth");
    for file in ["scaling-woop-primary-1t.svg", "scaling-woop-primary-1t.png"] {
        assert!(bundle.join(file).is_file(), "{file}");
    }
    let page = fs::read_to_string(bundle.join("report.html")).expect("a page");
    assert!(page.contains("How costs grow with triangles"));
    succeed(
        dir.path(),
        &[
            "report",
            "growth/report.json",
            "--format",
            "scaling",
            "--out",
            "laws",
        ],
    );
    let laws = fs::read_to_string(dir.path().join("laws/scaling.json")).expect("laws");
    let laws: Value = serde_json::from_str(&laws).expect("JSON");
    let bvh = &laws[0];
    assert_eq!((&bvh["accel"], &bvh["sizes"]), (&"bvh".into(), &3.into()));
    // A tree's steps are about a logarithm, whatever the machine.
    let exponent = bvh["steps_per_ray"]["exponent"].as_f64().expect("a number");
    assert!((0.05..0.45).contains(&exponent), "{exponent}");
    // Two sizes are no curve.
    let text = succeed(
        dir.path(),
        &[
            "sweep",
            "--scene",
            "soup:20,soup:200",
            "--accel",
            "bvh",
            "--rays-count",
            "90",
            "--quick",
        ],
    );
    assert!(!text.contains("build N^"), "{text}");
}
