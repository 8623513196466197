//! The preview screen: the scene as it is rendered through a structure, and what that structure costs.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};

use crate::lab::{NRule, Place};
use crate::preview::{ColorMode, Picture, legend_bar};
use crate::tui::figures::{counted, figure, mebibytes};
use crate::tui::layout;
use crate::tui::picture::{Figures, Wish};
use crate::tui::plan_editor::{accel_label, kernel_label};
use crate::tui::state::State;
use crate::tui::theme::Role;
use crate::tui::view::{clipped, panel, wrapped};

/// Draws the screen.
pub fn draw(state: &State, frame: &mut Frame, area: Rect) {
    let (framed, side) = layout::preview(state, area);
    picture(state, frame, framed, true);
    if !side.is_empty() {
        figures(state, frame, side);
    }
}

/// The picture in a frame that says what it shows, and what it waits for.
pub fn picture(state: &State, frame: &mut Frame, area: Rect, focused: bool) {
    let picture = &state.picture;
    let wish = &picture.wish;
    let title = clipped(
        &format!("{} · {}", scene_title(wish), wish.channel.name),
        (area.width as usize).saturating_sub(6),
    );
    let mut block = panel(state.theme, title, focused);
    if !picture.doing.is_empty() {
        let text = clipped(
            &format!(" {} ", picture.doing),
            (area.width as usize).saturating_sub(4),
        );
        block = block.title_bottom(Line::from(text).right_aligned());
    }
    let inner = block.inner(area);
    frame.render_widget(block, area);
    if let Some(why) = &picture.error {
        return super::sweep::lines(state.theme, &format!("No picture: {why}"), frame, inner);
    }
    let Some(shown) = &picture.shown else {
        let text = format!("{} comes in a moment.", wish.scene);
        return super::sweep::lines(state.theme, &text, frame, inner);
    };
    frame.render_widget(Picture::new(&shown.cells), inner);
    if let (Some(cell), true) = (picture.cursor, focused) {
        cursor(state, cell, frame, inner);
    }
}

/// The scene, and where it is put if that is not its own place.
fn scene_title(wish: &Wish) -> String {
    if wish.place == Place::ITS_OWN {
        wish.scene.clone()
    } else {
        format!("{} {}", wish.scene, wish.place)
    }
}

/// A cross on the cell whose ray would be inspected.
fn cursor(state: &State, (x, y): (u16, u16), frame: &mut Frame, area: Rect) {
    let style = state.theme.style(Role::Marked);
    let arms = [
        (0, 0, "┼"),
        (-2, 0, "─"),
        (-1, 0, "─"),
        (1, 0, "─"),
        (2, 0, "─"),
    ];
    for (dx, dy, sign) in arms.into_iter().chain([(0, -1, "│"), (0, 1, "│")]) {
        let at = (i32::from(area.x + x) + dx, i32::from(area.y + y) + dy);
        let inside = |at: i32, from: u16, to: u16| (i32::from(from)..i32::from(to)).contains(&at);
        if inside(at.0, area.left(), area.right()) && inside(at.1, area.top(), area.bottom()) {
            // The picture's own colours would make the cross invisible.
            let style = Style::reset().patch(style);
            frame
                .buffer_mut()
                .set_string(at.0 as u16, at.1 as u16, sign, style);
        }
    }
}

fn figures(state: &State, frame: &mut Frame, area: Rect) {
    let block = panel(state.theme, "through this structure", false);
    let inner = block.inner(area);
    frame.render_widget(block, area);
    let width = inner.width as usize;
    let quiet = state.theme.style(Role::Quiet);
    let rows = choices(&state.picture.wish, state.theme.mode())
        .into_iter()
        .chain(measured(
            &state.picture.wish,
            state.picture.current_figures(),
        ));
    let lines: Vec<Line> = rows
        .map(|(name, value, key)| {
            let room = width.saturating_sub(13 + key.chars().count());
            Line::from(vec![
                Span::styled(format!(" {name:<12}"), quiet),
                Span::raw(format!("{:<room$}", clipped(&value, room))),
                Span::styled(key, state.theme.style(Role::Key)),
            ])
        })
        .collect();
    for (y, line) in lines.iter().take(inner.height as usize).enumerate() {
        frame.render_widget(line, Rect::new(inner.x, inner.y + y as u16, inner.width, 1));
    }
    let used = (lines.len() as u16 + 1).min(inner.height);
    let rest = Rect::new(
        inner.x + 1,
        inner.y + used,
        inner.width - 1,
        inner.height - used,
    );
    meaning(state, frame, rest);
}

/// What the colours of the picture mean, or what the scene was found to need.
fn meaning(state: &State, frame: &mut Frame, area: Rect) {
    let picture = &state.picture;
    let Some(shown) = picture
        .shown
        .as_ref()
        .filter(|s| s.request.wish == picture.wish)
    else {
        return;
    };
    let quiet = state.theme.style(Role::Quiet);
    let mut lines: Vec<Line> = Vec::new();
    let bar_at = shown.legend.as_ref().map(|legend| {
        let title = wrapped(legend.title, area.width as usize);
        lines.extend(title.into_iter().map(Line::from));
        let at = lines.len() as u16;
        lines.push(Line::default());
        let [_, median, _] = legend.labels();
        lines.push(Line::styled(
            format!("median {median}, {}", legend.scale),
            quiet,
        ));
        at
    });
    if bar_at.is_none() {
        let found = wrapped(&shown.found, area.width as usize);
        lines.extend(found.into_iter().map(|line| Line::styled(line, quiet)));
    }
    for (y, line) in lines.into_iter().take(area.height as usize).enumerate() {
        frame.render_widget(line, Rect::new(area.x, area.y + y as u16, area.width, 1));
    }
    if let (Some(at), Some(legend)) = (bar_at, &shown.legend)
        && at < area.height
    {
        let bar = legend_bar(legend, area.width, state.theme.mode());
        let row = Rect::new(area.x, area.y + at, area.width, 1);
        frame.render_widget(Picture::new(&bar), row);
    }
}

/// What was chosen, and the key that changes it.
fn choices(wish: &Wish, mode: ColorMode) -> Vec<(&'static str, String, &'static str)> {
    let n = match (wish.has_n(), wish.n) {
        (false, _) => "-".to_owned(),
        (true, NRule::Auto) => "auto".to_owned(),
        (true, NRule::Fixed(n)) => n.to_string(),
    };
    let symbols = wish.symbols.drawn_in(mode).name;
    vec![
        ("scene", wish.scene.clone(), " [ ]"),
        ("accelerator", accel_label(&wish.accel), " a"),
        ("grid n", n, " n N"),
        ("kernel", kernel_label(&wish.kernel), " m"),
        ("channel", wish.channel.name.to_owned(), " c"),
        ("symbols", symbols.to_owned(), " b"),
    ]
}

/// What the structure costs; `...` until it is known.
fn measured(wish: &Wish, figures: Option<&Figures>) -> Vec<(&'static str, String, &'static str)> {
    let value = |of: fn(&Figures) -> String| figures.map_or_else(|| "...".to_owned(), of);
    let mut rows = vec![
        ("", String::new(), ""),
        ("triangles", value(|f| f.triangles.to_string()), ""),
    ];
    if wish.has_n() {
        rows.push((
            "built n",
            value(|f| f.n.map_or_else(|| "-".to_owned(), |n| n.to_string())),
            "",
        ));
    }
    rows.extend([
        ("build", value(|f| format!("{} ms", figure(f.build_ms))), ""),
        (
            "memory",
            value(|f| format!("{} MiB", figure(mebibytes(f.memory_bytes)))),
            "",
        ),
        (
            "speed",
            value(|f| format!("{} Mrays/s", figure(f.mrays_per_s))),
            "",
        ),
        ("cells/ray", value(|f| counted(f.steps)), ""),
        ("tests/ray", value(|f| counted(f.tests)), ""),
        (
            "rays hit",
            value(|f| format!("{:.0} %", f.hit_share * 100.0)),
            "",
        ),
    ]);
    rows
}
