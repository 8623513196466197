//! The inspect screen: one ray step by step in two accelerators, each as a slice through the ray and as a list.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use super::steps::point;
use super::{slice, steps, sweep};
use crate::lab::NRule;
use crate::tui::inspect::{Inspect, Subject};
use crate::tui::layout;
use crate::tui::plan_editor::{accel_label, kernel_label};
use crate::tui::state::State;
use crate::tui::theme::Role;
use crate::tui::view::{clipped, panel};

/// Draws the screen.
pub fn draw(state: &State, frame: &mut Frame, area: Rect) {
    let inspect = &state.inspect;
    let parts = layout::inspect(state, area);
    let Some(subject) = &inspect.subject else {
        return nothing(state, frame, area);
    };
    head(state, subject, frame, parts.head);
    for side in 0..2 {
        if !parts.sides[side].is_empty() {
            one(state, side, frame, parts.sides[side]);
        }
    }
}

fn nothing(state: &State, frame: &mut Frame, area: Rect) {
    let block = panel(state.theme, "inspect", true);
    let inner = block.inner(area);
    frame.render_widget(block, area);
    let text = "No ray chosen yet. On the screen Preview, Enter puts a cursor into the picture, and Enter again opens the \
         ray under it here.";
    sweep::lines(state.theme, text, frame, inner);
}

/// What is looked at: scene, kernel, where the ray comes from; the ray with its interval.
fn head(state: &State, subject: &Subject, frame: &mut Frame, area: Rect) {
    let theme = state.theme;
    let width = area.width as usize;
    let first = format!(
        " {} · {} · {}",
        subject.source.title(),
        kernel_label(&subject.kernel),
        subject.origin
    );
    let doing = match &state.inspect.doing {
        doing if doing.is_empty() => String::new(),
        doing => format!("{doing} "),
    };
    let room = width.saturating_sub(doing.chars().count() + 1);
    let row = |y| Rect::new(area.x, area.y + y, area.width, 1);
    frame.render_widget(
        Span::styled(clipped(&first, room), theme.style(Role::Title)),
        row(0),
    );
    frame.render_widget(
        Line::styled(doing, theme.style(Role::Quiet)).right_aligned(),
        row(0),
    );
    let examined = (0..2).find_map(|side| state.inspect.examined(side));
    let (text, role) = match (&state.inspect.error, examined) {
        (Some(why), _) => (format!(" ! {why}"), Role::Bad),
        (None, Some(examined)) => {
            let ray = &examined.inspection.ray;
            let (origin, dir) = (point(ray.origin), point(ray.dir));
            let text = format!(
                " t from {} to {}, from {origin} along {dir}",
                ray.t_min, ray.t_max
            );
            (text, Role::Quiet)
        }
        (None, None) => (" The ray comes in a moment.".to_owned(), Role::Quiet),
    };
    frame.render_widget(
        Line::styled(clipped(&text, width), theme.style(role)),
        row(1),
    );
}

/// One accelerator.
fn one(state: &State, side: usize, frame: &mut Frame, area: Rect) {
    let inspect = &state.inspect;
    let theme = state.theme;
    let focused = side == inspect.focus;
    let width = (area.width as usize).saturating_sub(6);
    let mut block = panel(theme, clipped(&title(inspect, side), width), focused);
    let inner = block.inner(area);
    let rows = inner.height / 2;
    let [sheet, list] = [
        Rect {
            height: rows,
            ..inner
        },
        Rect {
            y: inner.y + rows,
            height: inner.height - rows,
            ..inner
        },
    ];
    match &inspect.found[side] {
        Some(Ok(examined)) => {
            let text = format!(" {} ", steps::summary(&examined.inspection));
            let role = if examined.inspection.right {
                Role::Good
            } else {
                Role::Bad
            };
            let text = clipped(&text, width + 2);
            block = block.title_bottom(Line::styled(text, theme.style(role)));
            frame.render_widget(block, area);
            slice::draw(theme, inspect, side, frame, sheet);
            steps::draw(theme, inspect, side, frame, list);
        }
        Some(Err(why)) => {
            frame.render_widget(block, area);
            sweep::lines(theme, why, frame, inner);
        }
        None => frame.render_widget(block, area),
    }
}

/// The accelerator, its resolution, and how far the walk is: `grid n=12 · step 3 of 34`.
fn title(inspect: &Inspect, side: usize) -> String {
    let wanted = &inspect.sides[side];
    let examined = inspect.examined(side);
    let n = match (
        wanted.has_n(),
        wanted.n,
        examined.and_then(|e| e.inspection.n),
    ) {
        (false, ..) => String::new(),
        (true, NRule::Auto, Some(n)) => format!(" n=auto {n}"),
        (true, NRule::Auto, None) => " n=auto".to_owned(),
        (true, NRule::Fixed(n), _) => format!(" n={n}"),
    };
    let steps = examined.map_or(0, |e| e.inspection.steps.len());
    let at = match steps {
        0 => String::new(),
        steps => format!(
            " · step {} of {steps}",
            inspect.marked[side].min(steps - 1) + 1
        ),
    };
    format!("{}{n}{at}", accel_label(&wanted.accel))
}
