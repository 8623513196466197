//! The lab driven by keys in a real pseudo-terminal, as a person drives it: start, edit the plan, run, watch, write, quit;
//! resize, interrupt, suspend. Afterwards the terminal must be what it was.
#![cfg(unix)]

mod pty;

use std::fs;
use std::path::{Path, PathBuf};

use pty::Terminal;
use serde_json::Value;

const ESC: &str = "\x1b";
const CTRL_C: &str = "\x03";

/// Starts the lab on a scene so small that a sweep takes seconds, in a folder of its own.
fn lab(dir: &Path, cols: u16, rows: u16) -> Terminal {
    Terminal::start(&["teapot:2"], &[], dir, cols, rows)
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder can be made")
}

/// Goes `down` lines from the top of the plan and types `text` there in place of what it holds.
fn edit(terminal: &mut Terminal, down: usize, line: &str, text: &str) {
    terminal.press("g");
    terminal.press(&"j".repeat(down));
    terminal.wait_until(line, |screen| screen.contains(&format!("▸{line}")));
    terminal.press("t");
    terminal.wait_for("Enter done");
    terminal.press("\x15");
    terminal.press(text);
    terminal.wait_for(text);
    terminal.press("\r");
    terminal.wait_until("the plan", |screen| !screen.contains("Enter done"));
}

/// The only bundle in `results`.
fn bundle(dir: &Path) -> PathBuf {
    let mut entries = fs::read_dir(dir.join("results")).expect("a sweep writes results");
    entries
        .next()
        .expect("a bundle was written")
        .expect("results can be read")
        .path()
}

fn report(bundle: &Path) -> Value {
    let text = fs::read(bundle.join("report.json")).expect("the report is written");
    serde_json::from_slice(&text).expect("the report is JSON")
}

#[test]
fn a_newcomer_sees_a_picture_a_plan_and_what_to_press() {
    let dir = folder();
    let mut terminal = lab(dir.path(), 80, 24);
    let screen = terminal.wait_until("a picture", |s| s.contains('▄') || s.contains('▀'));
    for words in [
        "teapot:2",
        "grid n",
        "Press Enter to run",
        "? help",
        "q quit",
    ] {
        assert!(screen.contains(words), "'{words}' is missing:\n{screen}");
    }
    terminal.press("q");
    assert_eq!(terminal.wait_for_end(), 0);
    terminal.assert_restored();
}

#[test]
fn a_plan_is_edited_run_watched_written_and_left() {
    let dir = folder();
    let mut terminal = lab(dir.path(), 120, 40);
    terminal.wait_for("Press Enter to run");
    edit(&mut terminal, 2, "grid n", "1,2");
    edit(&mut terminal, 5, "rays a set", "300");
    terminal.press("\r");
    terminal.wait_for("running");
    terminal.wait_until("all runs", |s| s.contains("5 of 5 runs"));
    let screen = terminal.screen();
    for words in ["brute", "kd-tree", "bvh", "Mrays/s"] {
        assert!(screen.contains(words), "'{words}' is missing:\n{screen}");
    }
    terminal.press("w");
    terminal.wait_for("Report and plots are in");
    let bundle = bundle(dir.path());
    let report = report(&bundle);
    let runs = report["runs"].as_array().expect("runs");
    assert_eq!(runs.len(), 5);
    assert!(runs.iter().all(|run| run["valid"] == true));
    for file in ["runs.jsonl", "report.html"] {
        assert!(bundle.join(file).exists(), "{file} is missing");
    }
    terminal.press("7");
    terminal.wait_for("teapot");
    terminal.press("\r");
    terminal.wait_for("Mrays/s");
    terminal.press("q");
    assert_eq!(terminal.wait_for_end(), 0);
    terminal.assert_restored();
}

#[test]
fn every_screen_opens_and_survives_every_size() {
    let dir = folder();
    let mut terminal = lab(dir.path(), 80, 24);
    terminal.wait_for("Press Enter to run");
    for (key, words) in [
        ("2", "accelerator"),
        ("3", "grid n=auto"),
        ("4", "Charts"),
        ("5", "offsets"),
        ("6", "cases"),
        ("7", "Reports"),
        ("8", "Everywhere"),
        ("1", "grid n"),
    ] {
        terminal.press(key);
        terminal.wait_for(words);
        for (cols, rows) in [(200, 60), (40, 10), (1, 1), (61, 19), (80, 24)] {
            terminal.resize(cols, rows);
            std::thread::sleep(std::time::Duration::from_millis(60));
        }
        terminal.wait_for(words);
    }
    terminal.resize(30, 8);
    terminal.wait_until("a sentence about the size", |s| s.contains("raylab needs"));
    terminal.press("q");
    assert_eq!(terminal.wait_for_end(), 0);
    terminal.assert_restored();
}

#[test]
fn a_ray_is_chosen_in_the_picture_and_walked_in_two_accelerators() {
    let dir = folder();
    let mut terminal = lab(dir.path(), 120, 40);
    terminal.press("2");
    terminal.wait_until("a picture", |s| s.contains('▄') || s.contains('▀'));
    terminal.press("\r");
    terminal.wait_for("Enter inspect the ray");
    terminal.press("h");
    terminal.press("\r");
    let screen = terminal.wait_until("both sides", |s| s.matches("RIGHT").count() == 2);
    for words in [
        "bvh · step 1 of",
        "grid n=auto",
        "t from 0 to inf",
        "node 0",
        "cell",
    ] {
        assert!(screen.contains(words), "'{words}' is missing:\n{screen}");
    }
    terminal.press("j");
    terminal.wait_for("bvh · step 2 of");
    terminal.press("\r");
    terminal.wait_for("entry t");
    terminal.press(ESC);
    terminal.wait_until("the slices again", |s| !s.contains("entry t"));
    terminal.press(ESC);
    terminal.wait_for("Enter inspect the ray");
    terminal.press("q");
    assert_eq!(terminal.wait_for_end(), 0);
    terminal.assert_restored();
}

#[test]
fn methods_are_judged_charted_and_opened_and_a_wrong_ray_is_inspected() {
    let dir = folder();
    let mut terminal = lab(dir.path(), 120, 40);
    terminal.press("5");
    terminal.wait_for("to be judged");
    edit(&mut terminal, 1, "rays", "edge");
    edit(&mut terminal, 2, "offsets", "1e4");
    edit(&mut terminal, 4, "kernels", "sheet-signed, woop");
    edit(&mut terminal, 7, "rays a set", "600");
    terminal.press("\r");
    terminal.wait_until("both methods", |s| {
        s.contains("2 judged") && s.contains("complete in")
    });
    let screen = terminal.wait_for("report: results");
    for words in ["sheet-signed", "woop", "3/N =", "moved by 1e4", "Mrays/s"] {
        assert!(screen.contains(words), "'{words}' is missing:\n{screen}");
    }
    let report = report(&bundle(dir.path()));
    let runs = report["runs"].as_array().expect("runs");
    assert!(runs.iter().all(|run| run["accuracy"]["rays"] == 600));
    // The one that decides most rays wrongly.
    terminal.press("s");
    terminal.press("G");
    terminal.press("\r");
    terminal.wait_until("its picture", |s| s.contains('▄') || s.contains('▀'));
    terminal.press("i");
    terminal.wait_for("WRONG");
    terminal.press(ESC);
    terminal.wait_for("i inspect a wrong ray");
    terminal.press("q");
    assert_eq!(terminal.wait_for_end(), 0);
    terminal.assert_restored();
}

#[test]
fn the_stability_map_fills_and_a_failing_cell_opens_in_the_inspector() {
    let dir = folder();
    let mut terminal = lab(dir.path(), 120, 40);
    terminal.press("6");
    terminal.wait_for("to be tried");
    edit(&mut terminal, 0, "cases", "ordinary, closed-edges");
    edit(&mut terminal, 1, "kernels", "woop, moller-trumbore");
    edit(&mut terminal, 2, "accelerators", "grid");
    terminal.press("\r");
    terminal.wait_for("complete in");
    terminal.press("n");
    terminal.wait_for("k moller-trumbore on closed-edges");
    terminal.wait_for("fails as known: leak");
    terminal.press("o");
    terminal.wait_for("Wrote ");
    assert!(dir.path().join("results/failures").exists());
    terminal.press("\r");
    let screen = terminal.wait_for("triangles are enough");
    assert!(screen.contains("closed-edges"), "{screen}");
    terminal.wait_for("WRONG");
    terminal.press(ESC);
    terminal.wait_for("map: kernels alone");
    terminal.press("q");
    assert_eq!(terminal.wait_for_end(), 0);
    terminal.assert_restored();
}

#[test]
fn a_sweep_survives_resizing_and_ctrl_c_asks_then_quits() {
    let dir = folder();
    let mut terminal = Terminal::start(&["teapot:8"], &[], dir.path(), 80, 24);
    terminal.wait_for("Press Enter to run");
    terminal.press("\r");
    terminal.wait_for("running");
    terminal.resize(120, 40);
    terminal.wait_for("cells/ray");
    terminal.resize(80, 24);
    terminal.wait_for("running");
    terminal.press(CTRL_C);
    terminal.press(CTRL_C);
    terminal.wait_for_end();
    terminal.assert_restored();
    assert!(bundle(dir.path()).join("runs.jsonl").exists());
}

#[test]
fn signals_to_end_restore_the_terminal() {
    for signal in ["TERM", "HUP", "INT"] {
        let dir = folder();
        let mut terminal = lab(dir.path(), 80, 24);
        terminal.wait_for("Press Enter to run");
        terminal.signal(signal);
        terminal.wait_for_end();
        terminal.assert_restored();
    }
}

#[cfg(unix)]
#[test]
fn a_signal_before_the_first_frame_restores_the_terminal() {
    for signal in ["TERM", "HUP", "INT"] {
        let dir = folder();
        let mut terminal = lab(dir.path(), 80, 24);
        terminal.wait_until_claimed();
        terminal.signal(signal);
        terminal.wait_for_end();
        terminal.assert_restored();
    }
}

#[test]
fn a_terminal_that_is_taken_away_ends_the_program() {
    let dir = folder();
    assert!(pty::ends_when_hung_up(&["teapot:2"], dir.path()));
}

#[test]
fn without_colour_no_colour_is_sent_and_the_picture_is_there() {
    let dir = folder();
    let mut terminal = Terminal::start(&["teapot:2"], &[("NO_COLOR", "1")], dir.path(), 80, 24);
    terminal.wait_for("Press Enter to run");
    terminal.wait_until("a picture in characters", |s| {
        s.contains('@') || s.contains("##") || s.contains("==")
    });
    assert!(!terminal.colours_seen(), "a colour was set under NO_COLOR");
    terminal.press("q");
    assert_eq!(terminal.wait_for_end(), 0);
    terminal.assert_restored();
}

#[test]
fn escape_and_unknown_keys_do_no_harm() {
    let dir = folder();
    let mut terminal = lab(dir.path(), 80, 24);
    terminal.wait_for("Press Enter to run");
    for keys in [
        ESC,
        "zZ~^",
        "\x1b[99~",
        "\x00",
        "é",
        "\x1b[200~pasted\x1b[201~",
        ESC,
    ] {
        terminal.press(keys);
        std::thread::sleep(std::time::Duration::from_millis(30));
    }
    terminal.press("1");
    terminal.wait_for("grid n");
    terminal.press(CTRL_C);
    terminal.wait_for_end();
    terminal.assert_restored();
}
