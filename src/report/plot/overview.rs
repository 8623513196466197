//! Small multiples: the speeds of all combinations of a report on one sheet, with the same axes, so that they can be
//! compared by eye.
//!
//! ```text
//!   what all share
//!   |    ---- grid    |    ---- grid    |    ---- grid
//!   |  /              |  /              |  /
//!   +-----------      +-----------      +-----------
//!     teapot            caballito         plant
//! ```

use crate::report::Report;
use crate::report::series::{PanelKey, panels};

use super::axis::{Axis, Base};
use super::canvas::{Anchor, Canvas, Face, Head, finish};
use super::curves::{self, Column};
use super::figure::{self, Kind, MARGIN, Panel, Style, label_face, quiet_face};
use super::font::{self, Weight};
use super::note;
use super::plane::{Plane, Rows, widest_tick};
use super::theme::Theme;

/// The area between the axes of one multiple.
const WIDE: f64 = 200.0;
const TALL: f64 = 150.0;
/// Name of a multiple above it, ticks below it, and the space to the next.
const ABOVE: f64 = 22.0;
const BELOW: f64 = 40.0;
/// Between the labels of a multiple and the next multiple.
const APART: f64 = 14.0;
const TOP: f64 = 58.0;
/// A sheet wider than this is hard to read on a screen: it gets fewer columns.
const WIDEST: f64 = 1_120.0;

struct Sheet {
    multiples: Vec<(String, Panel)>,
    columns: usize,
    x: Axis,
    y: Axis,
    ticks: f64,
    /// Width of a multiple with its labels.
    width: f64,
    tall: f64,
    title: String,
}

/// The sheet as SVG; `None` where there are fewer than two combinations with a curve over n.
///
/// # Errors
/// What could not be drawn.
pub(super) fn svg(report: &Report, style: Style) -> Result<Option<String>, String> {
    let Some(sheet) = plan(report, style.theme) else {
        return Ok(None);
    };
    let rows = sheet.multiples.len().div_ceil(sheet.columns);
    let width = sheet.left(0) + sheet.columns as f64 * sheet.width - APART + MARGIN;
    let foot = TOP + rows as f64 * (ABOVE + sheet.tall + BELOW) + 4.0;
    let runs: Vec<_> = report.runs.iter().collect();
    let note = note::note(
        &runs,
        &report.provenance,
        Kind::Speed,
        "band",
        &["Ring: fastest n."],
    );
    let note = font::wrap(&note, note::SMALL, width - 2.0 * MARGIN);
    let height = (foot + note.len() as f64 * note::PITCH + 6.0).ceil();

    let mut drawn = String::new();
    let mut canvas = Canvas::new(&mut drawn, width, height, style.theme.ground);
    sheet.draw_title(&mut canvas, style.theme, width);
    for index in 0..sheet.multiples.len() {
        sheet.draw_multiple(&mut canvas, style.theme, index);
    }
    note::draw(&mut canvas, style.theme, &note, foot);
    let widths = canvas.end()?;
    let head = Head {
        width,
        height,
        title: &format!("Speed, all combinations: {}", sheet.title),
        adapts: style.adapts,
    };
    Ok(Some(finish(&drawn, &widths, &head)))
}

fn plan(report: &Report, theme: &Theme) -> Option<Sheet> {
    let keys = panels(&report.runs);
    let (shared, names) = split_names(&keys);
    let multiples: Vec<(String, Panel)> = keys
        .iter()
        .zip(names)
        .filter_map(|(key, name)| {
            let panel = figure::panels(report, key, Kind::Speed)
                .into_iter()
                .next()?;
            Some((name, panel))
        })
        .collect();
    let curves = || multiples.iter().flat_map(|(_, p)| &p.curves);
    if multiples.len() < 2 || curves().all(|c| c.series.constant) {
        return None;
    }
    let column = Column::small();
    let panels = || multiples.iter().map(|(_, panel)| panel);
    let labels = panels().map(|p| column.width(p, theme)).fold(0.0, f64::max);
    let tall = panels().map(|p| column.height(p)).fold(TALL, f64::max);
    let n = curves()
        .filter(|c| !c.series.constant)
        .flat_map(|c| c.series.points.iter().map(|p| p.n));
    let y = Axis::new(panels().flat_map(Panel::values), Base::Ten, tall, 22.0);
    let width = WIDE + labels + APART;
    let fits = ((WIDEST - 2.0 * MARGIN) / width) as usize;
    Some(Sheet {
        columns: fits.clamp(1, 3).min(multiples.len()),
        x: Axis::new(n, Base::Two, WIDE, 26.0),
        ticks: widest_tick(&y, theme) + 8.0,
        y,
        width,
        tall,
        title: shared,
        multiples,
    })
}

/// What all combinations share, and what tells each from the others.
fn split_names(keys: &[PanelKey]) -> (String, Vec<String>) {
    let all: Vec<[String; 4]> = keys.iter().map(figure::words).collect();
    let same = |i: usize| all.windows(2).all(|w| w[0][i] == w[1][i]);
    let pick = |parts: &[String; 4], shared: bool| {
        let chosen: Vec<&str> = (0..parts.len())
            .filter(|&i| same(i) == shared)
            .map(|i| parts[i].as_str())
            .collect();
        chosen.join(" · ")
    };
    let title = all.first().map(|p| pick(p, true)).unwrap_or_default();
    (title, all.iter().map(|p| pick(p, false)).collect())
}

impl Sheet {
    /// Left end of the axes in a column.
    fn left(&self, column: usize) -> f64 {
        MARGIN + self.ticks + column as f64 * self.width
    }

    fn draw_title(&self, canvas: &mut Canvas, theme: &Theme, width: f64) {
        let face = Face {
            size: figure::TITLE,
            weight: Weight::Bold,
            colour: theme.ink,
        };
        let title = if self.title.is_empty() {
            "Speed of all combinations".to_owned()
        } else {
            format!("Speed · {}", self.title)
        };
        let title = font::fit(&title, face.size, face.weight, width - 2.0 * MARGIN);
        canvas.text(&title, (MARGIN, 26.0), Anchor::Start, face);
        let quiet = Face {
            colour: theme.muted,
            ..label_face(theme)
        };
        let what =
            "Mrays/s against grid resolution n; higher is better; the axes are the same everywhere";
        let what = font::fit(what, quiet.size, quiet.weight, width - 2.0 * MARGIN);
        canvas.text(&what, (MARGIN, 44.0), Anchor::Start, quiet);
    }

    fn draw_multiple(&self, canvas: &mut Canvas, theme: &Theme, index: usize) {
        let (row, column) = (index / self.columns, index % self.columns);
        let (name, panel) = &self.multiples[index];
        let left = self.left(column);
        let top = TOP + row as f64 * (ABOVE + self.tall + BELOW);
        let face = Face {
            weight: Weight::Bold,
            colour: theme.ink,
            ..quiet_face(theme)
        };
        let name = font::fit(name, face.size, face.weight, self.width - APART);
        canvas.text(&name, (left, top + 13.0), Anchor::Start, face);
        let plane = Plane::new(
            self.x.clone(),
            self.y.clone(),
            (left, top + ABOVE),
            (left + WIDE, top + ABOVE + self.tall),
        );
        let rows = if column == 0 {
            Rows::Labelled
        } else {
            Rows::Ruled
        };
        plane.draw(canvas, theme, rows);
        curves::draw(canvas, theme, &plane, panel, &Column::small());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::{report, run_of};

    #[test]
    fn what_all_share_stands_in_the_title_alone() {
        let runs = ["teapot", "plant"].map(|s| run_of(s, 9, "primary", 1, "grid", Some(4)));
        let (shared, names) = split_names(&panels(&runs));
        assert_eq!(shared, "primary rays · woop · 1 thread");
        assert_eq!(names, ["teapot", "plant"]);
    }

    #[test]
    fn one_combination_needs_no_overview() {
        let theme = &super::super::theme::LIGHT;
        let style = Style {
            theme,
            adapts: false,
        };
        let one = report(vec![run_of("teapot", 9, "primary", 1, "grid", Some(4))]);
        assert!(svg(&one, style).unwrap().is_none());
    }
}
