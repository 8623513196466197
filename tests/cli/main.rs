//! The real program without a terminal: what it prints, what it writes, and how it refuses bad input.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

mod rays;
mod refusals;
mod sweeps;

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
fn completions_and_the_manual_are_printed() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    for shell in ["bash", "zsh", "fish", "powershell"] {
        assert!(succeed(dir.path(), &["completions", shell]).contains("raylab"));
    }
    assert!(succeed(dir.path(), &["man"]).contains(".TH"));
}
