//! What is refused: bad input, unknown names, too large a grid; each in a sentence and with its exit code.

use std::fs;
use std::path::Path;

use super::{raylab, stderr, stdout};

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
