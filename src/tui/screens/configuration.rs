//! A configuration that was opened on the Pareto screen: what was found of it, and the scene as it renders it.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{details, preview};
use crate::tui::figures::{figure, percent};
use crate::tui::layout;
use crate::tui::overlay::Facts;
use crate::tui::pareto::Point;
use crate::tui::runs::RunRow;
use crate::tui::state::State;
use crate::tui::theme::Role;
use crate::tui::view::{clipped, panel};

/// Draws the facts and the picture.
pub fn draw(state: &State, point: &Point, frame: &mut Frame, area: Rect) {
    let (picture, side) = layout::configuration(state, area);
    if !side.is_empty() {
        let facts = facts(point);
        let title = clipped(&facts.title, (side.width as usize).saturating_sub(6));
        let block = panel(state.theme, title, false);
        let inner = block.inner(side);
        frame.render_widget(block, side);
        let lines = details::text(&facts, inner.width as usize);
        for (y, line) in lines.into_iter().take(inner.height as usize).enumerate() {
            let role = if line.contains("WRONG") {
                Role::Bad
            } else {
                Role::Text
            };
            let row = Rect::new(inner.x, inner.y + y as u16, inner.width, 1);
            frame.render_widget(Line::styled(line, state.theme.style(role)), row);
        }
    }
    preview::picture(state, frame, picture, true);
}

/// What was found: the decisions first, then everything known of the run.
#[must_use]
pub fn facts(point: &Point) -> Facts {
    let judged = &point.judged;
    let accuracy = &judged.accuracy;
    let mut facts = Facts::new(judged.label.clone());
    facts.put("wrong", rate(accuracy.wrong(), accuracy.rays, judged.bound));
    let bounds = &accuracy.upper95;
    for (name, seen, bound) in [
        ("  leaks", accuracy.leaks, bounds.leaks),
        ("  phantoms", accuracy.phantoms, bounds.phantoms),
        ("  surfaces", accuracy.wrong_surface, bounds.wrong_surface),
        ("swaps", accuracy.neighbour_swaps, bounds.neighbour_swaps),
        (
            "occlusion",
            accuracy.occlusion_disagreements,
            bounds.occlusion_disagreements,
        ),
    ] {
        facts.put(name, rate(seen, accuracy.rays, bound));
    }
    let ulp = &accuracy.t_ulp;
    facts.put(
        "error of t",
        format!(
            "median {}, 99 % {}, most {} ulp",
            figure(ulp.p50),
            figure(ulp.p99),
            figure(ulp.max)
        ),
    );
    let front = if judged.front {
        "on it: no method is at least as fast and less often wrong"
    } else {
        "dominated: another method is at least as fast and no more often wrong"
    };
    facts.put("front", front);
    let run = details::facts(&RunRow::reported(&point.run));
    facts
        .rows
        .extend(run.rows.into_iter().filter(|(name, _)| name != "status"));
    facts
}

/// `12 of 65536 (0.018 %, 95 %: at most 0.03 %)`.
fn rate(seen: u64, rays: u64, bound: f64) -> String {
    let share = seen as f64 / rays.max(1) as f64;
    format!(
        "{seen} of {rays} ({}, 95 %: at most {})",
        percent(share),
        percent(bound)
    )
}
