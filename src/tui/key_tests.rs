//! Every row of the keymap has an effect in every place it names.

use std::path::PathBuf;

use super::fixture;
use super::keymap::{self, Action, Key, Place};
use super::overlay::{Overlay, Pick, Purpose, TextField};
use super::plan_editor::Field;
use super::runner::{Keeping, Work};
use super::screens::details;
use super::state::{BundleRow, ChartLine, Experiment, Opened, Phase, Screen, State};
use super::update::{Effect, Event, update};
use crate::report::Report;

fn press(state: &mut State, key: Key) -> Vec<Effect> {
    update(state, Event::Key(key.event()))
}

fn report() -> Report {
    Report {
        schema: Report::SCHEMA.to_owned(),
        judged: None,
        provenance: crate::report::Provenance::default(),
        config: crate::lab::Plan::default(),
        runs: fixture::finished().built(),
    }
}

/// Something measured, for `action` in `place` to act on.
fn measured(place: Place, action: Action) -> State {
    let mut state = fixture::sized(80, 24);
    if place == Place::Inspect {
        state = fixture::inspected_in(state);
        state.inspect.focus = usize::from(action != Action::Right);
        state.inspect.step(2);
        state.inspect.sides[1].n = crate::lab::NRule::Fixed(8);
        state.inspect.zoom = 1.5;
    }
    if matches!(place, Place::Points | Place::Configuration) {
        state = fixture::judged_in(state);
        state.pareto.marked = 1;
        if place == Place::Configuration {
            press(&mut state, Key::code(crossterm::event::KeyCode::Enter));
        }
        if matches!(action, Action::Pause | Action::Stop) {
            state.pareto.progress.phase = Phase::Running;
        }
    } else if matches!(place, Place::Map | Place::OtherPlan) {
        state = fixture::tried_in(state);
        (state.stability.row, state.stability.case) = (1, 1);
        let from_top = [Action::NextFault, Action::PreviousFault];
        if matches!(action, Action::Down | Action::Last | Action::PageDown)
            || from_top.contains(&action)
        {
            state.stability.row = 0;
        }
        state.stability.panel = match place {
            Place::Map => super::state::Panel::Runs,
            _ => super::state::Panel::Plan,
        };
        state.stability.plan.marked = Field::Accels;
        if matches!(action, Action::Pause | Action::Stop) {
            state.stability.progress.phase = Phase::Running;
        }
    } else if matches!(action, Action::Pause | Action::Stop) || place == Place::Runs {
        state = fixture::running(state);
    } else if place == Place::Charts {
        state = fixture::complete(state);
    }
    state
}

/// A state in which `action` in `place` has something to act on.
fn prepared(place: Place, action: Action) -> State {
    let mut state = measured(place, action);
    state.screen = match place {
        Place::Preview | Place::Aim => Screen::Preview,
        Place::Inspect => Screen::Inspect,
        Place::Charts => Screen::Charts,
        Place::Points | Place::Configuration => Screen::Pareto,
        Place::Map | Place::OtherPlan => Screen::Stability,
        Place::Reports => Screen::Reports,
        Place::Help => Screen::Help,
        _ => Screen::Sweep,
    };
    if place == Place::Plan {
        state.panel = super::state::Panel::Plan;
        state.plan.marked = Field::N;
    }
    state.table.marked = 2;
    state.table.scrolled = 1;
    state.charts.marked = ChartLine::Quantity;
    if matches!(action, Action::Up | Action::First | Action::PageUp) {
        state.charts.marked = ChartLine::Source;
    }
    state.help_line = 3;
    state.picture.wish.orbit.zoom = 1.5;
    if place == Place::Aim {
        state.picture.cursor = Some((5, 5));
    }
    if action == Action::NextAccel {
        state.picture.wish.step_accel(1);
    }
    state.picture.wish.n = crate::lab::NRule::Fixed(8);
    state.expanded = action == Action::Back;
    let bundles = ["a", "b", "c"].map(|name| BundleRow {
        path: PathBuf::from(name),
        name: name.to_owned(),
        date: format!("2026-11-2{}", name.len()),
        runs: 3,
        note: String::new(),
    });
    state.reports.bundles = Some(bundles.to_vec());
    state.reports.marked = 1;
    if place == Place::Reports && matches!(action, Action::Left | Action::Right) {
        let mut opened = Opened::new("a".to_owned(), report());
        opened.table.scrolled = 1;
        state.reports.opened = Some(opened);
    }
    match place {
        Place::Pick => {
            let mut pick = Pick::new(&state.plan, Field::Accels);
            pick.items.extend(pick.items.clone());
            pick.marked = 1;
            state.overlays.push(Overlay::Pick(pick));
        }
        Place::Text => {
            let mut field = TextField::new(Purpose::Line(Field::N), "1..8");
            field.input.left();
            state.overlays.push(Overlay::Text(field));
        }
        Place::Details => {
            let mut row = fixture::finished().rows[1].clone();
            row.run.warnings = vec!["a note".to_owned(); 40];
            let facts = Box::new(details::facts(&row));
            state.overlays.push(Overlay::Details(facts, 2));
        }
        Place::Confirm => state.overlays.push(Overlay::Quit("why".to_owned())),
        _ => {}
    }
    state
}

#[test]
fn every_row_of_the_keymap_has_an_effect_wherever_it_is_offered() {
    for row in keymap::rows() {
        for &place in row.places {
            for &key in row.keys {
                let mut state = prepared(place, row.action);
                assert_eq!(state.place(), place);
                // The picture is asked for beforehand, so that an effect is the key's own.
                update(&mut state, Event::Clock(20.0));
                let before = format!("{state:?}");
                let own = Action::Screen(state.screen.number() as u8);
                let to_itself =
                    row.action == own || (place, row.action) == (Place::Help, Action::Help);
                let effects = press(&mut state, key);
                let changed = format!("{state:?}") != before;
                assert!(
                    changed || !effects.is_empty() || to_itself,
                    "{} in {place:?} does nothing ({:?})",
                    key.name(),
                    row.action
                );
            }
        }
    }
}

#[test]
fn enter_runs_the_plan_as_it_stands_at_the_start() {
    let mut state = fixture::sized(80, 24);
    let effects = press(&mut state, Key::code(crossterm::event::KeyCode::Enter));
    assert!(
        matches!(&effects[0], Effect::Start(work) if **work == Work::Sweep(crate::lab::Plan::default()))
    );
    assert_eq!(state.sweep.phase, Phase::Running);
    let again = press(&mut state, Key::code(crossterm::event::KeyCode::Enter));
    assert!(!again.iter().any(|e| matches!(e, Effect::Start(_))));
}

#[test]
fn a_plan_with_a_bad_line_is_not_run_and_the_line_is_marked() {
    let mut state = fixture::sized(80, 24);
    state.plan.set(Field::Rays, "primry");
    let effects = press(&mut state, Key::code(crossterm::event::KeyCode::Enter));
    assert!(effects.is_empty());
    assert_eq!(state.plan.marked, Field::Rays);
    assert!(
        state
            .notice
            .is_some_and(|n| n.bad && n.text.contains("primary"))
    );
}

#[test]
fn quitting_asks_only_while_something_would_be_lost() {
    let q = Key::char('q');
    let mut idle = fixture::sized(80, 24);
    assert_eq!(press(&mut idle, q), [Effect::Quit]);
    let mut complete = fixture::complete(fixture::sized(80, 24));
    assert_eq!(press(&mut complete, q), [Effect::Quit]);
    let mut running = fixture::running(fixture::sized(80, 24));
    assert!(press(&mut running, q).is_empty());
    assert_eq!(running.place(), Place::Confirm);
    assert!(press(&mut running, Key::char('n')).is_empty());
    assert_eq!(running.place(), Place::Runs);
    press(&mut running, q);
    assert_eq!(press(&mut running, Key::char('y')), [Effect::Quit]);
}

#[test]
fn ctrl_c_twice_quits_whatever_is_open() {
    let mut state = fixture::running(fixture::sized(80, 24));
    let field = TextField::new(Purpose::RunsFilter, "");
    state.overlays.push(Overlay::Text(field));
    assert!(press(&mut state, Key::ctrl('c')).is_empty());
    assert_eq!(press(&mut state, Key::ctrl('c')), [Effect::Quit]);
}

#[test]
fn a_sweep_that_cannot_be_written_is_unsaved_and_asks_before_quitting() {
    let mut state = fixture::running(fixture::sized(80, 24));
    update(
        &mut state,
        Event::Kept(Experiment::Sweep, Keeping::Failed("no space".to_owned())),
    );
    update(
        &mut state,
        Event::Lab(crate::lab::Event::Ended { stopped: false }),
    );
    assert!(press(&mut state, Key::char('q')).is_empty());
    assert_eq!(state.place(), Place::Confirm);
}

#[test]
fn a_sweep_that_cannot_begin_leaves_the_plan_ready() {
    let mut state = fixture::sized(80, 24);
    press(&mut state, Key::code(crossterm::event::KeyCode::Enter));
    update(
        &mut state,
        Event::Kept(
            Experiment::Sweep,
            Keeping::Broken("no such scene".to_owned()),
        ),
    );
    assert!(!state.sweep.is_running());
}

#[test]
fn a_frozen_display_stays_still_and_catches_up_later() {
    let mut state = fixture::running(fixture::sized(80, 24));
    press(&mut state, Key::char('f'));
    let (runs, done) = (state.sweep.runs.clone(), state.sweep.done);
    for event in fixture::events().into_iter().skip(24) {
        update(&mut state, Event::Lab(event));
    }
    assert_eq!((&state.sweep.runs, state.sweep.done), (&runs, done));
    press(&mut state, Key::char('f'));
    assert_eq!(state.sweep.runs.finished(), (6, 1));
    assert!(state.sweep.done > done);
}

#[test]
fn every_update_asks_for_the_picture_that_the_screen_shows() {
    let mut state = fixture::state();
    let effects = update(&mut state, Event::Resize(80, 24));
    assert!(matches!(&effects[0], Effect::Render(request) if request.cells.0 > 20));
    assert!(update(&mut state, Event::Clock(1.0)).is_empty());
    assert!(matches!(
        press(&mut state, Key::char('2'))[0],
        Effect::Render(_)
    ));
    assert!(press(&mut state, Key::char('4')).is_empty());
}
