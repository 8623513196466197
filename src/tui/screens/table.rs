//! The table of runs.
//!
//! Columns that say the same in every row move into the title, so that a narrow screen shows what differs.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use crate::tui::runs::{RunRow, Status};
use crate::tui::table_view::{Column, TableView};
use crate::tui::theme::{Role, Theme};
use crate::tui::view::{clipped, panel};

/// Widest a column gets; longer texts are cut off with `…`.
const WIDEST: usize = 22;

/// Draws the rows in a frame.
pub fn draw(
    theme: Theme,
    title: &str,
    rows: &[RunRow],
    view: &TableView,
    focused: bool,
    frame: &mut Frame,
    area: Rect,
) {
    let shown = view.shown(rows);
    let mut block = panel(theme, heading(title, rows, view, shown.len()), focused);
    let columns = columns(rows, view);
    let inner = block.inner(area);
    let (fitting, widths) = fit(&columns, rows, &shown, inner.width as usize);
    if fitting < columns.len() {
        block = block.title_bottom(
            Line::from(format!(" → {} more columns ", columns.len() - fitting)).right_aligned(),
        );
    }
    frame.render_widget(block, area);
    if inner.height == 0 {
        return;
    }
    let columns = &columns[..fitting];
    let line = |y: u16| Rect::new(inner.x, inner.y + y, inner.width, 1);
    let titles = columns.iter().zip(&widths).map(|(&column, &width)| {
        let sorted = column == view.sort && column != Column::Status;
        let mark = if sorted { "▾" } else { "" };
        padded(
            &format!("{}{mark}", column.title()),
            width,
            column.is_number(),
        )
    });
    let head: String = std::iter::once(" ".to_owned()).chain(titles).collect();
    frame.render_widget(Line::styled(head, theme.style(Role::Title)), line(0));
    let room = inner.height as usize - 1;
    let marked = view.marked.min(shown.len().saturating_sub(1));
    let first = (marked + 1)
        .saturating_sub(room.div_ceil(2).max(1))
        .min(shown.len().saturating_sub(room));
    for (y, &at) in shown.iter().skip(first).take(room).enumerate() {
        let is_marked = focused && first + y == marked;
        let text = row_line(theme, &rows[at], columns, &widths, is_marked);
        frame.render_widget(text, line(y as u16 + 1));
    }
}

/// The title, with what all rows share.
fn heading(title: &str, rows: &[RunRow], view: &TableView, shown: usize) -> String {
    let mut parts = vec![title.to_owned()];
    if rows.len() > 1 {
        let shared = [Column::Scene, Column::Kernel, Column::Rays, Column::Threads];
        parts.extend(shared.into_iter().filter(|&c| is_shared(c, rows)).map(|c| {
            let cell = c.cell(&rows[0]);
            match c {
                Column::Threads if cell == "1" => "1 thread".to_owned(),
                Column::Threads => format!("{cell} threads"),
                Column::Rays => format!("{cell} rays"),
                _ => cell,
            }
        }));
    }
    if !view.filter.is_empty() {
        parts.push(format!("'{}': {shown} of {}", view.filter, rows.len()));
    }
    parts.join(" · ")
}

fn is_shared(column: Column, rows: &[RunRow]) -> bool {
    let first = rows.first().map(|row| column.cell(row));
    rows.iter().all(|row| Some(column.cell(row)) == first)
}

/// The columns worth showing, those scrolled away left out.
fn columns(rows: &[RunRow], view: &TableView) -> Vec<Column> {
    let foldable = [Column::Scene, Column::Kernel, Column::Rays, Column::Threads];
    let worth: Vec<Column> = Column::ALL
        .into_iter()
        .filter(|c| rows.len() < 2 || !foldable.contains(c) || !is_shared(*c, rows))
        .collect();
    let skip = view.scrolled.min(worth.len().saturating_sub(4));
    let (status, rest) = worth.split_at(1);
    status.iter().chain(&rest[skip..]).copied().collect()
}

/// How many of the columns fit, and how wide each is.
fn fit(columns: &[Column], rows: &[RunRow], shown: &[usize], room: usize) -> (usize, Vec<usize>) {
    let mut used = 1;
    let mut widths = Vec::new();
    for &column in columns {
        // One more than the title: the mark of the sorted column.
        let title = column.title().chars().count() + usize::from(column != Column::Status);
        let longest = shown
            .iter()
            .map(|&at| column.cell(&rows[at]).chars().count())
            .max()
            .unwrap_or(0);
        let width = title.max(longest).min(WIDEST);
        if used + width + 1 > room {
            break;
        }
        used += width + 1;
        widths.push(width);
    }
    (widths.len(), widths)
}

fn row_line(
    theme: Theme,
    row: &RunRow,
    columns: &[Column],
    widths: &[usize],
    marked: bool,
) -> Line<'static> {
    let role = match &row.status {
        Status::Failed(_) => Role::Bad,
        Status::Waiting => Role::Quiet,
        Status::Done if row.run.is_broken() => Role::Bad,
        Status::Building | Status::Sampling | Status::Done => Role::Text,
    };
    let mut spans = vec![Span::raw(if marked { "▸" } else { " " })];
    spans.extend(columns.iter().zip(widths).map(|(&column, &width)| {
        let role = match column {
            Column::Status if row.status == Status::Done && row.run.valid => Role::Good,
            Column::Speed if row.status == Status::Done && role == Role::Text => Role::Title,
            _ => role,
        };
        Span::styled(
            padded(&column.cell(row), width, column.is_number()),
            theme.style(role),
        )
    }));
    let line = Line::from(spans);
    if marked {
        line.style(theme.style(Role::Marked))
    } else {
        line
    }
}

/// `text` in exactly `width + 1` columns.
fn padded(text: &str, width: usize, right: bool) -> String {
    let text = clipped(text, width);
    if right {
        format!("{text:>width$} ")
    } else {
        format!("{text:<width$} ")
    }
}
