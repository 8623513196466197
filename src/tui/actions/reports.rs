//! Actions on the list of bundles and on the opened report.

use super::lines;
use crate::tui::keymap::Action;
use crate::tui::overlay::{Overlay, Purpose, TextField};
use crate::tui::screens::details;
use crate::tui::state::{Screen, Source, State};
use crate::tui::update::Effect;

pub(super) fn apply(state: &mut State, action: Action) -> Vec<Effect> {
    if state.reports.opened.is_some() {
        return opened(state, action);
    }
    match action {
        Action::Open => {
            let marked = state.reports.shown().nth(state.reports.marked);
            match marked.map(|bundle| bundle.path.clone()) {
                Some(path) => return vec![Effect::Read(path)],
                None => state.say("There is no report yet; screen 1 runs a sweep and writes one."),
            }
        }
        Action::Filter => filter(state, &state.reports.filter.clone()),
        Action::Sort => {
            if let Some(bundles) = &mut state.reports.bundles {
                // They come newest first; the other order is that of their names.
                if bundles.is_sorted_by(|a, b| a.name <= b.name) {
                    bundles.sort_by(|a, b| b.date.cmp(&a.date));
                    state.say("Sorted by date, newest first.");
                } else {
                    bundles.sort_by(|a, b| a.name.cmp(&b.name));
                    state.say("Sorted by name.");
                }
            }
        }
        Action::Back if !state.reports.filter.is_empty() => state.reports.filter.clear(),
        Action::Back => state.screen = Screen::Sweep,
        _ => {
            if let Some(lines) = lines(action) {
                let last = state.reports.shown().count().saturating_sub(1);
                let reports = &mut state.reports;
                reports.marked = reports.marked.saturating_add_signed(lines).min(last);
            }
        }
    }
    Vec::new()
}

/// Actions on the opened report.
fn opened(state: &mut State, action: Action) -> Vec<Effect> {
    let Some(report) = &mut state.reports.opened else {
        return Vec::new();
    };
    match action {
        Action::Open => {
            if let Some(row) = report.table.marked_row(&report.runs.rows) {
                let facts = Box::new(details::facts(row));
                state.overlays.push(Overlay::Details(facts, 0));
            }
        }
        Action::Filter => {
            let text = report.table.filter.clone();
            filter(state, &text);
        }
        Action::Sort => {
            report.table.sort_by_next();
            let sentence = format!("Sorted by {}.", report.table.sort.sort_name());
            state.say(sentence);
        }
        Action::Left => report.table.scroll(-1),
        Action::Right => report.table.scroll(1),
        Action::Back if !report.table.filter.is_empty() => report.table.filter.clear(),
        Action::Back => {
            state.reports.opened = None;
            state.charts.source = Source::Live;
            state.charts.panel = 0;
            state.pareto.look_at(None);
        }
        _ => {
            if let Some(lines) = lines(action) {
                report.table.step(&report.runs.rows, lines);
            }
        }
    }
    Vec::new()
}

fn filter(state: &mut State, text: &str) {
    let field = TextField::new(Purpose::ReportsFilter, text);
    state.overlays.push(Overlay::Text(field));
}
