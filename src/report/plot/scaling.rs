//! Costs over the number of triangles: a column a family, a row a cost, a line an accelerator, both axes logarithmic.
//!
//! ```text
//!                  soup                    city
//!   build    |        ,--o bvh  N^1.05 |        ,--o bvh
//!            |    ,--'    . . ∝ N      |    ,--'
//!            +---------------          +---------------
//!   time     |  ,----o---- bvh  N^0.2  |
//!            +---------------          +---------------
//!             10³   10⁴   10⁵           10³   10⁴   10⁵
//! ```

use crate::report::Report;
use crate::report::scaling::table::exponent_text;
use crate::report::scaling::{self, COSTS, Setting, curves, families};
use crate::report::series::{Quantity, Series};

use super::axis::{Axis, Base};
use super::canvas::{Anchor, At, Canvas, Face, Head, finish};
use super::curves::{self as drawing, Column};
use super::figure::{
    self, Curve, Looks, MARGIN, Panel, Style, WIDTH, label_face, panel_head, quiet_face,
};
use super::font::{self, Weight};
use super::note;
use super::plane::{Plane, Rows, widest_tick};
use super::theme::Theme;

/// The area between the axes: least width, least height.
const WIDE: f64 = 190.0;
const TALL: f64 = 150.0;
/// Title and subtitle above the first row; names of the columns.
const TOP: f64 = 58.0;
const NAMES: f64 = 20.0;
/// Name of a row above it, ticks below it.
const ABOVE: f64 = 24.0;
const BELOW: f64 = 36.0;
/// Between the labels of a column and the next column.
const APART: f64 = 18.0;
/// Straight pieces of a guide.
const PIECES: i32 = 40;
/// Name of the axis below the last row.
const AXIS_NAME: f64 = 18.0;

/// One cost of all families, on the same axis.
struct Row {
    /// One a column, in its order; without curves where no accelerator has this cost there.
    panels: Vec<Panel>,
    y: Axis,
    tall: f64,
}

struct Sheet {
    families: Vec<String>,
    rows: Vec<Row>,
    x: Axis,
    /// Width of the numbers at the left.
    ticks: f64,
    /// Width of the area between the axes.
    wide: f64,
    /// Width of a column with its labels.
    column: f64,
    labels: Column,
}

/// The figure of `setting` as SVG; `None` where no accelerator was run on enough sizes of a family.
///
/// # Errors
/// What could not be drawn.
pub(super) fn svg(
    report: &Report,
    setting: &Setting,
    style: Style,
) -> Result<Option<String>, String> {
    let theme = style.theme;
    let Some(sheet) = plan(report, setting, theme) else {
        return Ok(None);
    };
    let width = sheet.left(sheet.families.len()) - APART + MARGIN;
    let note = format!(
        "A line an accelerator, a point a scene; band: 95 % bootstrap interval; of several n the fastest counts. Beside a \
         name: the power of the number N of triangles, fitted by least squares to the logarithms. Dotted, from the median \
         of the first values on: proportional to N (build), to log N (time, steps). {}",
        note::machine(&report.provenance)
    );
    let note = font::wrap(&note, note::SMALL, width - 2.0 * MARGIN);
    let foot = TOP + NAMES + sheet.height() + AXIS_NAME + 8.0;
    let height = (foot + note.len() as f64 * note::PITCH + 6.0).ceil();

    let mut drawn = String::new();
    let mut canvas = Canvas::new(&mut drawn, width, height, theme.ground);
    let title = format!("Costs over the number of triangles · {setting}");
    draw_title(&mut canvas, theme, &title, width);
    sheet.draw(&mut canvas, theme);
    note::draw(&mut canvas, theme, &note, foot);
    let widths = canvas.end()?;
    let head = Head {
        width,
        height,
        title: &title,
        adapts: style.adapts,
    };
    Ok(Some(finish(&drawn, &widths, &head)))
}

fn plan(report: &Report, setting: &Setting, theme: &Theme) -> Option<Sheet> {
    let families = families(&report.runs, setting);
    if families.is_empty() {
        return None;
    }
    let looks = Looks::of(report);
    let labels = Column::small();
    let panel = |family: &String, quantity| Panel {
        quantity,
        curves: curves(&report.runs, setting, family, quantity)
            .into_iter()
            .map(|curve| fitted(&looks, curve))
            .collect(),
    };
    let row = |quantity| {
        let panels: Vec<Panel> = families.iter().map(|f| panel(f, quantity)).collect();
        let tall = panels.iter().map(|p| labels.height(p)).fold(TALL, f64::max);
        let values: Vec<f64> = panels.iter().flat_map(Panel::values).collect();
        (!values.is_empty()).then(|| Row {
            y: Axis::new(values, Base::Ten, tall, 20.0),
            panels,
            tall,
        })
    };
    let rows: Vec<Row> = COSTS.into_iter().filter_map(row).collect();
    let panels = || rows.iter().flat_map(|row| &row.panels);
    let names = panels().map(|p| labels.width(p, theme)).fold(0.0, f64::max);
    let ticks = rows.iter().map(|r| widest_tick(&r.y, theme));
    let ticks = ticks.fold(0.0, f64::max) + 8.0;
    // One family alone fills a figure of the usual width.
    let all = WIDTH - 2.0 * MARGIN - ticks + APART;
    let wide = WIDE.max(all / families.len() as f64 - names - APART);
    let sizes = panels().flat_map(|p| &p.curves);
    let sizes = sizes.flat_map(|c| c.series.points.iter().map(|p| p.n));
    Some(Sheet {
        // Room for the longest number: decades rather than steps between them.
        x: Axis::new(sizes, Base::Ten, wide, 50.0),
        ticks,
        wide,
        column: wide + names + APART,
        labels,
        families,
        rows,
    })
}

/// `curve` as a line to draw, with its exponent as the figure beside its name.
fn fitted(looks: &Looks, curve: scaling::Curve) -> Curve {
    let figure = curve
        .power()
        .map(|fit| format!("N^{}", exponent_text(fit.slope)));
    let series = Series {
        label: curve.label,
        points: curve.points,
        constant: false,
        best_n: None,
        plateau: None,
        predicted: Vec::new(),
    };
    Curve {
        figure,
        ..looks.curve(series)
    }
}

fn draw_title(canvas: &mut Canvas, theme: &Theme, title: &str, width: f64) {
    let bold = Face {
        size: figure::TITLE,
        weight: Weight::Bold,
        colour: theme.ink,
    };
    let room = width - 2.0 * MARGIN;
    let title = font::fit(title, bold.size, bold.weight, room);
    canvas.text(&title, (MARGIN, 26.0), Anchor::Start, bold);
    let quiet = Face {
        colour: theme.muted,
        ..label_face(theme)
    };
    let what = "both axes logarithmic: a power of N is a straight line, a logarithm bends flat";
    let what = font::fit(what, quiet.size, quiet.weight, room);
    canvas.text(&what, (MARGIN, 44.0), Anchor::Start, quiet);
}

impl Sheet {
    /// Left end of the axes in a column.
    fn left(&self, column: usize) -> f64 {
        MARGIN + self.ticks + column as f64 * self.column
    }

    /// Height of all rows.
    fn height(&self) -> f64 {
        let rows = self.rows.iter().map(|row| ABOVE + row.tall + BELOW);
        rows.sum::<f64>() - 14.0
    }

    fn draw(&self, canvas: &mut Canvas, theme: &Theme) {
        let mut top = TOP + NAMES;
        for row in &self.rows {
            // Any panel of the row has its heading.
            panel_head(canvas, theme, &row.panels[0], MARGIN, top + 12.0);
            for (column, panel) in row.panels.iter().enumerate() {
                let left = self.left(column);
                let plane = Plane::new(
                    self.x.clone(),
                    row.y.clone(),
                    (left, top + ABOVE),
                    (left + self.wide, top + ABOVE + row.tall),
                );
                let rows = if column == 0 {
                    Rows::Labelled
                } else {
                    Rows::Ruled
                };
                plane.draw(canvas, theme, rows);
                draw_guide(canvas, theme, &plane, panel);
                drawing::draw(canvas, theme, &plane, panel, &self.labels);
            }
            top += ABOVE + row.tall + BELOW;
        }
        for (column, family) in self.families.iter().enumerate() {
            let face = Face {
                weight: Weight::Bold,
                ..label_face(theme)
            };
            let name = font::fit(family, face.size, face.weight, self.column - APART);
            canvas.text(&name, (self.left(column), TOP + 12.0), Anchor::Start, face);
        }
        let middle = f64::midpoint(self.left(0), self.left(self.families.len() - 1) + self.wide);
        let below = (middle, TOP + NAMES + self.height() + 10.0);
        canvas.text("triangles", below, Anchor::Middle, quiet_face(theme));
    }
}

/// What grows in proportion to N, or to its logarithm, from the median of the curves' first values on.
fn draw_guide(canvas: &mut Canvas, theme: &Theme, plane: &Plane, panel: &Panel) {
    let ends = |pick: fn(f64, f64) -> f64, from: f64| {
        let all = panel.curves.iter().flat_map(|c| &c.series.points);
        all.map(|p| p.n).fold(from, pick)
    };
    let (first, last) = (ends(f64::min, f64::INFINITY), ends(f64::max, 0.0));
    let starts = panel.curves.iter().map(|c| c.series.points[0]);
    let starts: Vec<f64> = starts.filter(|p| p.n == first).map(|p| p.y).collect();
    // A scene of one triangle has no logarithm to be proportional to.
    let Some(start) = crate::stats::median(&starts).filter(|_| first > 1.0) else {
        return;
    };
    let value = |n: f64| match panel.quantity {
        Quantity::Build => start * n / first,
        _ => start * n.ln() / first.ln(),
    };
    let n = (0..=PIECES).map(|i| first * (last / first).powf(f64::from(i) / f64::from(PIECES)));
    let line: Vec<At> = n
        .filter(|n| value(*n) < plane.y.hi)
        .map(|n| plane.at(n, value(n)))
        .collect();
    canvas.line(&line, theme.muted, 1.0, &[1.2, 2.6]);
}
