//! The real program without a terminal: what it prints, what it writes, and how it refuses bad input.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn raylab(dir: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_raylab"))
        .args(args)
        .current_dir(dir)
        .env_remove("NO_COLOR")
        .output()
        .expect("the program starts")
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("output is UTF-8")
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("messages are UTF-8")
}

/// Runs a command that must succeed, and gives its standard output.
fn succeed(dir: &Path, args: &[&str]) -> String {
    let output = raylab(dir, args);
    assert!(
        output.status.success(),
        "{args:?} failed: {}",
        stderr(&output)
    );
    stdout(&output)
}

/// A command line that must be refused: exit code, and words that its one sentence must contain.
struct Refusal {
    args: &'static [&'static str],
    code: i32,
    words: &'static [&'static str],
}

const fn refusal(
    args: &'static [&'static str],
    code: i32,
    words: &'static [&'static str],
) -> Refusal {
    Refusal { args, code, words }
}

/// Files that the refused command lines name.
fn write_bad_files(dir: &Path) {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let files: &[(&str, &[u8])] = &[
        ("nan.obj", b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("range.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
        ("zero.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 0 1 2\n"),
        ("bare.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf\n"),
        ("points.obj", triangle.as_bytes()),
        ("huge.obj", b"v 1e400 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("torn.rays", &[0; 33]),
        ("nan.rays", &[255; 32]),
        (
            "torn.json",
            b"{\"schema\": \"raylab/report/1\", \"runs\": [",
        ),
        ("foreign.json", b"{\"schema\": \"other/1\"}"),
        ("text.json", b"hello"),
    ];
    for (name, bytes) in files {
        fs::write(dir.join(name), bytes).expect("the folder can be written");
    }
    fs::create_dir(dir.join("folder.obj")).expect("the folder can be written");
    fs::write(dir.join("file"), b"").expect("the folder can be written");
}

const REFUSALS: &[Refusal] = &[
    refusal(&["render", "missing.obj"], 5, &["missing.obj"]),
    refusal(&["render", "folder.obj"], 5, &["folder.obj"]),
    refusal(&["render", "nan.obj"], 5, &["nan.obj:2", "nan"]),
    refusal(&["render", "huge.obj"], 5, &["huge.obj:1"]),
    refusal(&["render", "range.obj"], 5, &["range.obj:4", "4"]),
    refusal(&["render", "zero.obj"], 5, &["zero.obj:5", "0"]),
    refusal(&["render", "bare.obj"], 5, &["bare.obj:4"]),
    refusal(
        &["render", "points.obj"],
        5,
        &["points.obj", "no triangles"],
    ),
    refusal(
        &["render", "teapto"],
        2,
        &["teapto", "did you mean 'teapot'?"],
    ),
    refusal(&["render", "soup:none"], 2, &["none"]),
    refusal(&["render", "soup:1000000000000"], 2, &["20000000"]),
    refusal(
        &["render", "one", "--channel", "colour"],
        2,
        &["colour", "color"],
    ),
    refusal(&["render", "one", "--accel", "gird"], 2, &["gird", "grid"]),
    refusal(
        &["render", "one", "--accel", "grid:overlap=none"],
        2,
        &["none", "three-test"],
    ),
    refusal(&["render", "one", "--kernel", "wop"], 2, &["wop", "woop"]),
    refusal(&["render", "one", "--n", "0", "--accel", "grid"], 2, &["0"]),
    refusal(&["render", "one", "--n", "many"], 2, &["many"]),
    refusal(
        &["render", "one", "--n", "1..4"],
        2,
        &["1..4", "one number"],
    ),
    refusal(&["render", "one", "--threads", "0"], 2, &["0", "max"]),
    refusal(&["render", "one", "--size", "0x0"], 2, &["0x0"]),
    refusal(&["render", "one", "--color", "pink"], 2, &["pink"]),
    refusal(&["render", "one", "--symbols", "smoke"], 2, &["smoke"]),
    refusal(
        &["render", "one", "--out", "no/such/folder/a.png"],
        1,
        &["a.png"],
    ),
    refusal(
        &["rays", "one", "--rays", "primry", "--out", "a.rays"],
        2,
        &["primry", "primary"],
    ),
    refusal(
        &[
            "rays",
            "one",
            "--rays",
            "primary",
            "--out",
            "no/such/a.rays",
        ],
        1,
        &["a.rays"],
    ),
    refusal(
        &[
            "rays",
            "one",
            "--rays",
            "primary",
            "--out",
            "a.rays",
            "--rays-count",
            "0",
        ],
        2,
        &["0"],
    ),
    refusal(&["inspect", "one"], 2, &["--pixel"]),
    refusal(
        &["inspect", "one", "--pixel", "960,0"],
        2,
        &["960,0", "960x720", "959,719", "--size"],
    ),
    refusal(
        &["inspect", "one", "--pixel", "1,8", "--size", "8x8"],
        2,
        &["1,8", "8x8"],
    ),
    refusal(&["inspect", "one", "--pixel", "1"], 2, &["'1'", "320,240"]),
    refusal(&["inspect", "one", "--origin", "0,0,1"], 2, &["--dir"]),
    refusal(
        &["inspect", "one", "--origin", "0,0,1", "--dir", "0,0,0"],
        2,
        &["0,0,0"],
    ),
    refusal(
        &["inspect", "one", "--origin", "0,0,1", "--dir", "nan,0,0"],
        2,
        &["nan", "finite"],
    ),
    refusal(
        &[
            "inspect", "one", "--origin", "0,0,1", "--dir", "0,0,-1", "--pixel", "0,0",
        ],
        2,
        &["--origin", "--pixel"],
    ),
    refusal(
        &["inspect", "missing.obj", "--pixel", "0,0"],
        5,
        &["missing.obj"],
    ),
    refusal(
        &["inspect", "one", "--pixel", "0,0", "--accel", "gird"],
        2,
        &["gird", "grid"],
    ),
    refusal(
        &["trace", "one", "--rays-file", "missing.rays"],
        5,
        &["missing.rays"],
    ),
    refusal(
        &["trace", "one", "--rays-file", "torn.rays"],
        5,
        &["torn.rays", "32"],
    ),
    refusal(
        &["trace", "one", "--rays-file", "nan.rays"],
        5,
        &["nan.rays", "0"],
    ),
    refusal(
        &["sweep", "--scene", "one", "--accel", "octopus"],
        2,
        &["octopus", "known"],
    ),
    refusal(&["sweep", "--scene", "one", "--n", "8..2"], 2, &["8"]),
    refusal(
        &["sweep", "--scene", "one", "--n", "1..99999"],
        2,
        &["99999"],
    ),
    refusal(
        &["sweep", "--scene", "one", "--set", "colour=red"],
        2,
        &["colour"],
    ),
    refusal(&["sweep", "--scene", "nan.obj"], 5, &["nan.obj:2"]),
    refusal(
        &["sweep", "--scene", "one", "--rays", "file:missing.rays"],
        5,
        &["missing.rays"],
    ),
    refusal(
        &["sweep", "--scene", "one", "--quick", "--out", "file/inside"],
        1,
        &["file/inside"],
    ),
    refusal(&["sweep", "--resume", "nowhere"], 5, &["nowhere"]),
    refusal(
        &["report", "torn.json", "--out", "plots"],
        5,
        &["torn.json"],
    ),
    refusal(
        &["report", "foreign.json", "--out", "plots"],
        5,
        &["foreign.json"],
    ),
    refusal(
        &["report", "text.json", "--out", "plots"],
        5,
        &["text.json"],
    ),
    refusal(
        &["report", "missing.json", "--out", "plots"],
        5,
        &["missing.json"],
    ),
    refusal(&["lst"], 2, &["lst"]),
    refusal(&["teapot"], 2, &["terminal", "render", "sweep"]),
    refusal(&[], 2, &["terminal", "render", "sweep"]),
];

#[test]
fn every_bad_input_gives_its_sentence_and_exit_code() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    write_bad_files(dir.path());
    for Refusal { args, code, words } in REFUSALS {
        let output = raylab(dir.path(), args);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(*code), "{args:?}: {message}");
        for word in *words {
            assert!(
                message.contains(word),
                "{args:?} does not say '{word}': {message}"
            );
        }
        assert!(!message.contains("panicked"), "{args:?}: {message}");
        assert!(
            output.stdout.is_empty(),
            "{args:?} printed data: {}",
            stdout(&output)
        );
    }
}

#[test]
fn a_grid_beyond_the_memory_limit_is_refused_with_its_size_and_the_largest_n_that_fits() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    let output = raylab(
        dir.path(),
        &["render", "soup:1000", "--accel", "grid", "--n", "1024"],
    );
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(
        message.contains("1024") && message.contains("MB") && message.contains("largest n"),
        "{message}"
    );
}

#[test]
fn every_registry_is_listed_as_text_and_as_json() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    for registry in ["scenes", "accels", "kernels", "rays", "formats", "channels"] {
        let rows: Value = serde_json::from_str(&succeed(dir.path(), &["list", registry, "--json"]))
            .expect("JSON");
        let text = succeed(dir.path(), &["list", registry]);
        let rows = rows.as_array().expect("an array");
        assert!(!rows.is_empty());
        for row in rows {
            let name = row["name"].as_str().expect("a name");
            assert!(
                row["about"]
                    .as_str()
                    .is_some_and(|about| about.ends_with('.')),
                "{name}"
            );
            assert!(row["params"].is_array(), "{name}");
            assert!(text.contains(name), "{name} is not in the text");
        }
    }
}

#[test]
fn a_ray_set_is_written_and_traced_alike_by_every_accelerator() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    let dir = dir.path();
    succeed(
        dir,
        &[
            "rays",
            "teapot:4",
            "--rays",
            "bounce",
            "--rays-count",
            "2000",
            "--out",
            "b.rays",
            "--quiet",
        ],
    );
    assert_eq!(
        fs::metadata(dir.join("b.rays")).expect("written").len() % 32,
        0
    );
    let mut answers = Vec::new();
    for accel in ["brute", "grid", "kd-tree", "octree", "bsp-tree", "bvh"] {
        let args = [
            "trace",
            "teapot:4",
            "--rays-file",
            "b.rays",
            "--hits",
            "b.hits",
            "--accel",
            accel,
            "--json",
        ];
        let result: Value = serde_json::from_str(&succeed(dir, &args)).expect("JSON");
        assert!(
            result["mrays_per_s"]["median"]
                .as_f64()
                .is_some_and(|m| m > 0.0),
            "{result}"
        );
        assert!(
            result["mrays_per_s"]["samples"]
                .as_array()
                .is_some_and(|s| !s.is_empty())
        );
        assert_eq!(result["accel"], accel);
        answers.push((
            result["hits"].as_u64(),
            fs::read(dir.join("b.hits")).expect("written"),
        ));
    }
    assert!(answers[0].0.is_some_and(|hits| hits > 0));
    assert!(
        answers.iter().all(|a| *a == answers[0]),
        "accelerators differ"
    );

    let blocked = [
        "trace",
        "teapot:4",
        "--rays-file",
        "b.rays",
        "--hits",
        "o.hits",
        "--occluded",
        "--json",
        "--quiet",
    ];
    let result: Value = serde_json::from_str(&succeed(dir, &blocked)).expect("JSON");
    assert_eq!(
        result["hits"].as_u64(),
        answers[0].0,
        "occlusion differs from closest hit"
    );
}

#[test]
fn every_accelerator_is_inspected_to_the_answer_that_trace_gives() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    let dir = dir.path();
    // Twelve rays are a picture of 4 × 3.
    let rays = [
        "rays",
        "teapot:4",
        "--rays",
        "primary",
        "--rays-count",
        "12",
        "--out",
        "p.rays",
        "--quiet",
    ];
    succeed(dir, &rays);
    let trace = [
        "trace",
        "teapot:4",
        "--rays-file",
        "p.rays",
        "--hits",
        "p.hits",
        "--quiet",
    ];
    succeed(dir, &trace);
    let read = |file: &str, at: usize| {
        let bytes = fs::read(dir.join(file)).expect("written");
        <[u8; 4]>::try_from(&bytes[4 * at..4 * at + 4]).expect("four bytes")
    };
    let rays: Vec<f32> = (0..96)
        .map(|i| f32::from_le_bytes(read("p.rays", i)))
        .collect();
    let float = |value: &Value| value.as_f64().expect("a number") as f32;
    let pixels = ["1,1", "2,1"];
    for (accel, kind) in [
        ("brute", "leaf"),
        ("grid", "cell"),
        ("kd-tree", "node"),
        ("octree", "node"),
        ("bsp-tree", "node"),
        ("bvh", "node"),
    ] {
        for pixel in pixels {
            let args = [
                "inspect", "teapot:4", "--pixel", pixel, "--size", "4x3", "--accel", accel,
                "--json",
            ];
            let seen: Value = serde_json::from_str(&succeed(dir, &args)).expect("JSON");
            let dir_of_ray: Vec<f32> = (0..3).map(|a| float(&seen["ray"]["dir"][a])).collect();
            let ray = (0..12)
                .find(|i| rays[8 * i + 4..8 * i + 7] == dir_of_ray)
                .expect("the pixel's ray is in the set");
            let prim = u32::from_le_bytes(read("p.hits", 2 * ray));
            let t = f32::from_le_bytes(read("p.hits", 2 * ray + 1));
            assert_eq!(seen["hit"]["prim"], prim, "{accel}: {seen}");
            assert_eq!(float(&seen["hit"]["t"]).to_bits(), t.to_bits(), "{accel}");
            assert_eq!(seen["right"], true);
            assert_eq!(seen["accel"], accel);
            assert_eq!(seen["ray"]["t_max"], Value::Null, "infinite");
            let steps = seen["steps"].as_array().expect("steps");
            assert_eq!(steps[0]["kind"], kind, "{accel}");
            assert_eq!(steps[0]["bounds"].is_null(), accel == "brute");
            let mut tests = steps
                .iter()
                .flat_map(|s| s["tests"].as_array().expect("tests"));
            let nearest = tests.rfind(|test| test["outcome"] == "nearest");
            assert_eq!(nearest.expect("a hit")["prim"], prim);
        }
    }
}

#[test]
fn an_inspected_ray_is_a_table_that_ends_in_its_answer() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    let args = [
        "inspect",
        "plane:2",
        "--origin",
        "0.3,0.2,5",
        "--dir",
        "0,0,-1",
        "--accel",
        "grid",
        "--n",
        "4",
    ];
    let text = succeed(dir.path(), &args);
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].starts_with("plane:2: grid n=4, woop"), "{text}");
    assert!(
        lines[3].contains("entry t") && lines[4].contains("cell"),
        "{text}"
    );
    let last = lines.last().expect("an answer");
    assert!(
        last.contains("triangle") && last.contains("right by exact arithmetic"),
        "{text}"
    );

    let away = [
        "inspect",
        "plane:2",
        "--accel",
        "bvh",
        "--origin",
        "0.3,0.2,5",
        "--dir",
        "0,0,1",
    ];
    let text = succeed(dir.path(), &away);
    assert!(
        text.ends_with("steps 0, tests 0, skipped 0: a miss; right by exact arithmetic\n"),
        "{text}"
    );
}

#[test]
fn a_picture_without_colour_has_no_escape_codes_and_a_png_has_its_size() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    let text = succeed(
        dir.path(),
        &["render", "teapot:4", "--size", "40x12", "--quiet"],
    );
    assert!(!text.contains('\u{1b}'));
    assert_eq!(text.lines().count(), 12);
    assert!(
        text.contains(|c| !matches!(c, ' ' | '\n')),
        "the picture is empty"
    );
    succeed(
        dir.path(),
        &[
            "render", "teapot:4", "--size", "40x30", "--out", "a.png", "--quiet",
        ],
    );
    let png = fs::read(dir.path().join("a.png")).expect("written");
    assert_eq!(
        &png[16..24],
        &[0, 0, 0, 40, 0, 0, 0, 30],
        "width and height of the header"
    );
}

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
fn completions_and_the_manual_are_printed() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    for shell in ["bash", "zsh", "fish", "powershell"] {
        assert!(succeed(dir.path(), &["completions", shell]).contains("raylab"));
    }
    assert!(succeed(dir.path(), &["man"]).contains(".TH"));
}
