//! The charts screen: one quantity large, the others small where there is room.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::{Line, Span};

use super::chart::Chart;
use super::sweep::lines;
use crate::report::Run;
use crate::report::series::{PanelKey, Quantity, panels, series};
use crate::tui::layout::is_large;
use crate::tui::state::{ChartLine, Screen, Source, State};
use crate::tui::theme::Role;
use crate::tui::view::{clipped, panel};

/// Draws the screen.
pub fn draw(state: &State, frame: &mut Frame, area: Rect) {
    let [choices, rest] = Layout::vertical([
        Constraint::Length(ChartLine::ALL.len() as u16),
        Constraint::Fill(1),
    ])
    .areas(area);
    let runs = state.charted().built();
    let panels = panels(&runs);
    let key = panels.get(state.charts.panel.min(panels.len().saturating_sub(1)));
    choice_lines(state, key, panels.len(), frame, choices);
    let Some(key) = key else {
        let block = panel(state.theme, "charts", true);
        let inner = block.inner(rest);
        frame.render_widget(block, rest);
        let reports = Screen::Reports.number();
        let text = format!(
            "Nothing to chart yet. Screen 1 (press 1) runs a sweep, and its curves appear here as they grow; screen \
             {reports} (press {reports}) opens a report."
        );
        return lines(state.theme, &text, frame, inner);
    };
    let chosen = state.charts.quantity;
    if !is_large(area) || state.expanded {
        return one(state, &runs, key, chosen, true, frame, rest);
    }
    let [large, small] = Layout::vertical([Constraint::Fill(3), Constraint::Fill(2)]).areas(rest);
    one(state, &runs, key, chosen, true, frame, large);
    let others: Vec<Quantity> = Quantity::ALL.into_iter().filter(|q| *q != chosen).collect();
    // Two or four of the others in a row, by what stays readable.
    let count = if area.width >= 180 { 4 } else { 2 };
    let cells = Layout::horizontal(vec![Constraint::Fill(1); count]).split(small);
    for (cell, quantity) in cells.iter().zip(others) {
        one(state, &runs, key, quantity, false, frame, *cell);
    }
}

fn choice_lines(
    state: &State,
    key: Option<&PanelKey>,
    panels: usize,
    frame: &mut Frame,
    area: Rect,
) {
    for (y, line) in ChartLine::ALL.into_iter().enumerate() {
        let value = match line {
            ChartLine::Quantity => state.charts.quantity.title(),
            ChartLine::Panel => match key {
                Some(key) if panels > 1 => {
                    let at = state.charts.panel.min(panels - 1) + 1;
                    format!("{key}  ({at} of {panels})")
                }
                Some(key) => key.to_string(),
                None => "no runs yet".to_owned(),
            },
            ChartLine::Source => match (&state.charts.source, &state.reports.opened) {
                (Source::Opened, Some(opened)) => format!("report {}", opened.name),
                _ => "the sweep of this session".to_owned(),
            },
        };
        let name = match line {
            ChartLine::Quantity => "show",
            ChartLine::Panel => "of",
            ChartLine::Source => "from",
        };
        let marked = line == state.charts.marked;
        let (mark, arrows) = if marked {
            ("▸", ["◂ ", " ▸"])
        } else {
            (" ", ["  ", "  "])
        };
        let room = (area.width as usize).saturating_sub(12);
        let text = Line::from(vec![
            Span::raw(format!(" {mark}")),
            Span::styled(format!("{name:<5}"), state.theme.style(Role::Quiet)),
            Span::styled(
                format!("{}{}{}", arrows[0], clipped(&value, room), arrows[1]),
                state
                    .theme
                    .style(if marked { Role::Title } else { Role::Text }),
            ),
        ]);
        frame.render_widget(text, Rect::new(area.x, area.y + y as u16, area.width, 1));
    }
}

fn one(
    state: &State,
    runs: &[Run],
    key: &PanelKey,
    quantity: Quantity,
    focused: bool,
    frame: &mut Frame,
    area: Rect,
) {
    let series = series(runs, key, quantity);
    let mut block = panel(state.theme, format!("{} over n", quantity.title()), focused);
    if focused {
        let best = series
            .iter()
            .find_map(|s| Some((s.label.clone(), s.best_n?)));
        if let Some((label, n)) = best {
            block = block.title_bottom(format!(" predicted best n of {label}: {n} "));
        }
        block = block.title_bottom(Line::from(" dotted: no n ").right_aligned());
    }
    let inner = block.inner(area);
    frame.render_widget(block, area);
    Chart {
        quantity,
        lines: &series,
        theme: state.theme,
    }
    .draw(frame, inner);
}
