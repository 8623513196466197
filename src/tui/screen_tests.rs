//! Screens drawn on a test backend.

use crossterm::event::KeyCode;
use ratatui::Terminal;
use ratatui::backend::TestBackend;

use super::fixture;
use super::keymap::{self, Key, Place};
use super::overlay::{Overlay, Pick, Purpose, TextField};
use super::plan_editor::Field;
use super::screens::details;
use super::state::{Panel, Phase, Screen, State};
use super::update::{Event, update};
use super::view::view;

const SIZES: [(u16, u16); 4] = [(60, 18), (80, 24), (120, 40), (200, 60)];

/// The rows of the screen.
fn screen(state: &State) -> Vec<String> {
    let (columns, rows) = state.size;
    let mut terminal = Terminal::new(TestBackend::new(columns, rows)).unwrap();
    terminal.draw(|frame| view(state, frame)).unwrap();
    let buffer = terminal.backend().buffer();
    (0..rows)
        .map(|y| (0..columns).map(|x| buffer[(x, y)].symbol()).collect())
        .collect()
}

fn contains(rows: &[String], text: &str) -> bool {
    rows.iter().any(|row| row.contains(text))
}

#[track_caller]
fn assert_contains(rows: &[String], text: &str) {
    assert!(contains(rows, text), "no '{text}' in\n{}", rows.join("\n"));
}

/// States that put each place on top.
fn states(columns: u16, rows: u16) -> Vec<State> {
    let idle = || fixture::sized(columns, rows);
    let mut states = vec![idle(), fixture::running(idle()), fixture::complete(idle())];
    for screen in [
        Screen::Preview,
        Screen::Charts,
        Screen::Pareto,
        Screen::Stability,
        Screen::Reports,
        Screen::Help,
    ] {
        states.push(State { screen, ..idle() });
        states.push(State {
            screen,
            ..fixture::running(idle())
        });
        states.push(State {
            screen,
            ..fixture::complete(idle())
        });
    }
    states.push(fixture::inspected_in(idle()));
    states.push(State {
        screen: Screen::Inspect,
        ..fixture::running(idle())
    });
    states.push(fixture::judged_in(idle()));
    let mut opened = fixture::judged_in(idle());
    update(&mut opened, Event::Key(Key::code(KeyCode::Enter).event()));
    states.push(opened);
    states.push(fixture::tried_in(idle()));
    let mut trying = fixture::tried_in(idle());
    trying.stability.progress.phase = Phase::Running;
    trying.stability.turn();
    states.push(trying);
    let mut aiming = State {
        screen: Screen::Preview,
        ..idle()
    };
    aiming.picture.cursor = Some((300, 2));
    states.push(aiming);
    let over = |overlay: Overlay| {
        let mut state = fixture::complete(idle());
        state.overlays.push(overlay);
        state
    };
    let row = fixture::finished().rows[2].clone();
    states.push(over(Overlay::Pick(Pick::new(&idle().plan, Field::Accels))));
    states.push(over(Overlay::Text(TextField::new(
        Purpose::Line(Field::N),
        "1..128",
    ))));
    let facts = Box::new(details::facts(&row));
    states.push(over(Overlay::Details(facts, 0)));
    states.push(over(Overlay::Quit("A sweep is running.".to_owned())));
    states
}

#[test]
fn every_hint_in_the_footer_is_whole_on_every_screen_and_size() {
    for (columns, rows) in SIZES {
        for state in states(columns, rows) {
            let footer = screen(&state).pop().unwrap();
            let place = state.place();
            let mut rest = footer.trim().to_owned();
            for (key, word) in keymap::hints(place, state.situation()) {
                let hint = format!("{key} {word}");
                if let Some(after) = rest.strip_prefix(&hint) {
                    rest = after.trim_start().to_owned();
                }
            }
            assert_eq!(rest, "", "{place:?} at {columns}x{rows}: {footer}");
            assert!(footer.trim().len() > 8, "{place:?}: {footer}");
        }
    }
}

#[test]
fn the_first_key_and_the_ways_out_are_always_in_the_footer() {
    for (columns, rows) in SIZES {
        for state in states(columns, rows) {
            let place = state.place();
            let footer = screen(&state).pop().unwrap();
            let first = keymap::hints(place, state.situation()).next().unwrap();
            assert!(
                footer.contains(&format!("{} {}", first.0, first.1)),
                "{footer}"
            );
            if !matches!(
                place,
                Place::Pick | Place::Text | Place::Details | Place::Confirm
            ) {
                for hint in ["Tab screen", "? help", "q quit"] {
                    assert!(footer.contains(hint), "{place:?} at {columns}: {footer}");
                }
            }
        }
    }
}

#[test]
fn the_first_screen_says_what_is_there_and_what_to_press() {
    for (columns, rows) in [(80, 24), (120, 40), (200, 60)] {
        let rows = screen(&fixture::sized(columns, rows));
        let gap = if columns == 80 { "" } else { " " };
        for screen in Screen::ALL {
            let name = format!("{}{gap}{}", screen.number(), screen.title());
            assert_contains(&rows, &name);
        }
        for text in [
            "Enter runs it",
            "Press Enter to run",
            "scenes",
            "teapot",
            "accelerators",
            "grid n",
            "kernels",
            "rays",
            "threads",
            "Ready:",
            "Enter run",
        ] {
            assert_contains(&rows, text);
        }
    }
}

#[test]
fn a_running_sweep_shows_progress_figures_table_and_chart() {
    for (columns, rows) in [(80, 24), (120, 40), (200, 60)] {
        let rows = screen(&fixture::running(fixture::sized(columns, rows)));
        for text in [
            "running",
            "of 7 runs",
            "about",
            "left",
            "now grid n=32",
            "cells/ray",
            "tests/ray",
            "Mrays/s",
            "runs · teapot · woop · primary rays · 1 thread",
            "speed over n",
            "grid",
            "brute",
            "p pause",
            "x stop",
        ] {
            assert_contains(&rows, text);
        }
    }
}

#[test]
fn a_complete_sweep_names_its_report_and_the_failed_run() {
    let rows = screen(&fixture::complete(fixture::sized(120, 40)));
    assert_contains(&rows, "complete in");
    assert_contains(&rows, "1 failed");
    assert_contains(&rows, "failed");
    assert_contains(&rows, "results/2026-11-22-teapot");
}

#[test]
fn charts_show_every_line_with_marker_and_name() {
    for (columns, rows) in SIZES {
        let mut state = fixture::complete(fixture::sized(columns, rows));
        state.screen = Screen::Charts;
        let rows = screen(&state);
        for text in ["● brute", "■ grid", "▲ bvh", "speed (Mrays/s)", "128", "◂"] {
            assert_contains(&rows, text);
        }
        assert!(
            rows.iter()
                .any(|r| r.chars().any(|c| ('\u{2801}'..'\u{28ff}').contains(&c)))
        );
    }
}

#[test]
fn a_large_terminal_shows_other_quantities_too() {
    let mut state = fixture::complete(fixture::sized(200, 60));
    state.screen = Screen::Charts;
    let rows = screen(&state);
    for text in [
        "speed (Mrays/s) over n",
        "steps per ray over n",
        "tests per ray over n",
        "build time",
        "memory",
    ] {
        assert_contains(&rows, text);
    }
}

#[test]
fn the_preview_names_the_key_beside_each_choice() {
    for (columns, rows) in SIZES {
        let mut state = fixture::sized(columns, rows);
        state.screen = Screen::Preview;
        let rows = screen(&state);
        for text in [
            "scene",
            "accelerator",
            "grid n",
            "kernel",
            "channel",
            "tests/ray",
            "build",
        ] {
            assert_contains(&rows, text);
        }
    }
}

#[test]
fn the_inspector_shows_both_sides_with_slice_steps_and_verdict() {
    for (columns, rows) in [(80, 24), (120, 40), (200, 60)] {
        let rows = screen(&fixture::inspected_in(fixture::sized(columns, rows)));
        for text in [
            "bvh",
            "grid n=auto",
            "step 1 of",
            "ray ×",
            "▸ ",
            "leaf",
            "cell",
            "t from 0 to inf",
        ] {
            assert_contains(&rows, text);
        }
        assert_eq!(
            rows.iter()
                .map(|row| row.matches("RIGHT").count())
                .sum::<usize>(),
            2
        );
    }
}

#[test]
fn a_narrow_or_expanded_inspector_shows_the_side_that_has_the_keys() {
    let mut state = fixture::inspected_in(fixture::sized(60, 18));
    assert!(!contains(&screen(&state), "grid n=auto"));
    state.inspect.focus = 1;
    assert_contains(&screen(&state), "grid n=auto");
    let mut state = fixture::inspected_in(fixture::sized(120, 40));
    state.expanded = true;
    assert!(!contains(&screen(&state), "grid n=auto"));
}

#[test]
fn the_pareto_chart_names_every_method_and_draws_the_front_and_the_floor() {
    for (columns, rows) in [(80, 24), (120, 40), (200, 60)] {
        let rows = screen(&fixture::judged_in(fixture::sized(columns, rows)));
        for text in [
            "woop",
            "moller-trumbore",
            "sheet-signed",
            "sheet-unsigned",
            "3/N =",
            "none ┤",
            "Mrays/s",
            "(1 of 2)",
            "in its place",
            "complete in 0:09",
        ] {
            assert_contains(&rows, text);
        }
        // The front goes from woop to moller-trumbore, and up from there.
        assert_contains(&rows, "┌──");
    }
}

#[test]
fn a_small_terminal_shows_chart_or_list_and_the_list_tells_what_kind_of_wrong() {
    let mut state = fixture::judged_in(fixture::sized(80, 24));
    assert!(!contains(&screen(&state), "methods by"));
    state.expanded = true;
    let rows = screen(&state);
    assert_contains(&rows, "methods by speed");
    assert_contains(&rows, "front");
    let mut state = fixture::judged_in(fixture::sized(120, 40));
    state.expanded = true;
    let rows = screen(&state);
    for text in ["leaks", "phantoms", "surface", "swaps", "t ulp 99"] {
        assert_contains(&rows, text);
    }
}

#[test]
fn an_opened_method_tells_its_rates_and_shows_its_picture() {
    for (columns, rows) in [(80, 24), (120, 40), (200, 60)] {
        let mut state = fixture::judged_in(fixture::sized(columns, rows));
        update(&mut state, Event::Key(Key::code(KeyCode::Enter).event()));
        assert_eq!(state.picture.wish.kernel.name, "moller-trumbore");
        let rows = screen(&state);
        for text in [
            "moller-trumbore",
            "wrong",
            "leaks",
            "300 of",
            "front",
            "teapot · color",
        ] {
            assert_contains(&rows, text);
        }
    }
}

#[test]
fn the_map_has_a_letter_for_each_cell_and_tells_the_marked_one_in_full() {
    for (columns, rows) in [(80, 24), (120, 40), (200, 60)] {
        let mut state = fixture::tried_in(fixture::sized(columns, rows));
        assert!(state.stability.seek(1));
        let rows = screen(&state);
        for text in [
            "map: kernels alone",
            "▸ moller-trumbore",
            "fails as known",
            "leak",
            "edges",
            "▾ closed-edges",
        ] {
            assert_contains(&rows, text);
        }
        let row = rows
            .iter()
            .find(|row| row.contains("▸ moller-trumbore"))
            .unwrap();
        assert!(row.contains('k') && row.contains('.'), "{row}");
    }
}

#[test]
fn reports_and_help_say_where_to_go_when_there_is_nothing() {
    let mut state = fixture::sized(80, 24);
    state.screen = Screen::Reports;
    update(&mut state, Event::Listed(Ok(Vec::new())));
    assert_contains(&screen(&state), "No report yet. Screen 1 (press 1)");
    state.screen = Screen::Charts;
    assert_contains(&screen(&state), "Nothing to chart yet. Screen 1 (press 1)");
    state.screen = Screen::Help;
    assert_contains(&screen(&state), "Everywhere");
}

#[test]
fn a_bad_line_of_the_plan_says_so_in_the_line() {
    let mut state = fixture::sized(80, 24);
    state.plan.set(Field::Accels, "gird");
    let rows = screen(&state);
    assert_contains(&rows, "! unknown accelerator 'gird'");
    assert_contains(&rows, "marked with !");
}

#[test]
fn a_terminal_that_is_too_small_gets_one_sentence() {
    for size in [(1, 1), (10, 3), (59, 30), (80, 17)] {
        let rows = screen(&fixture::sized(size.0, size.1));
        assert!(!contains(&rows, "Sweep"));
    }
    let rows = screen(&fixture::sized(59, 17));
    assert_contains(&rows, "raylab needs 60x18");
}

#[test]
fn nothing_panics_at_any_size() {
    for columns in [1, 2, 59, 60, 61, 79, 109, 110, 131] {
        for rows in [1, 2, 17, 18, 19, 25, 34, 35] {
            for state in states(columns, rows) {
                screen(&state);
                screen(&State {
                    expanded: true,
                    ..state
                });
            }
        }
    }
}

#[test]
fn an_expanded_panel_has_the_whole_body() {
    let mut state = fixture::running(fixture::sized(80, 24));
    state.expanded = true;
    let rows = screen(&state);
    assert!(!contains(&rows, "speed over n"));
    for run in ["brute", "bvh", "1024"] {
        assert_contains(&rows, run);
    }
    state.panel = Panel::Plan;
    assert!(!contains(&screen(&state), "runs ·"));
}
