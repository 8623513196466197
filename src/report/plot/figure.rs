//! One figure: a title, one panel a quantity over each other, small print.
//!
//! ```text
//!   title                        scene · kernel · rays · threads
//!   subtitle                     triangles, rays a sample
//!   quantity (unit)   hint
//!     |  prediction  |--<>--|
//!     |                                  o-- label  value
//!     |   lines over n                   ---- label
//!     +------------------------
//!        1   2   4   8
//!   small print                  how it was measured, and on what
//! ```
//!
//! What a panel draws (`lines`, `dots`) and how tall it is are separate questions: a panel first says what room it
//! needs, then the figure gives it a place.

use std::collections::BTreeSet;

use crate::report::series::{PanelKey, Quantity, Series, accel_label, series};
use crate::report::{Report, Run};

use super::axis::number;
use super::canvas::{Anchor, Canvas, Face, Head, finish};
use super::font::{self, Weight};
use super::theme::{Look, Theme};
use super::{dots, lines, note};

/// What a figure is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// Rays/s against n.
    Speed,
    /// Steps and tests of a ray against n.
    Work,
    /// Build time and memory against n.
    Cost,
}

impl Kind {
    /// All of them, in the order in which they are shown.
    pub const ALL: [Self; 3] = [Self::Speed, Self::Work, Self::Cost];

    /// First word of the file's name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Work => "work",
            Self::Cost => "cost",
        }
    }

    /// One panel each.
    #[must_use]
    pub const fn quantities(self) -> &'static [Quantity] {
        match self {
            Self::Speed => &[Quantity::Speed],
            Self::Work => &[Quantity::Steps, Quantity::Tests],
            Self::Cost => &[Quantity::Build, Quantity::Memory],
        }
    }
}

/// Narrowest figure in pixels: two columns of a paper, or a page of a README.
pub(super) const WIDTH: f64 = 720.0;
/// Room at the outer edges.
pub(super) const MARGIN: f64 = 16.0;
/// Widest name of a curve.
const WIDEST_NAME: f64 = 280.0;
pub(super) const TITLE: f64 = 15.0;

/// A curve and how it looks.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    pub series: Series,
    /// The series' label, shortened where it is long and stays distinct.
    pub name: String,
    /// What stands beside the name where it is not the peak or the level.
    pub figure: Option<String>,
    pub look: Look,
}

/// One quantity and its curves; at least one.
#[derive(Debug, Clone)]
pub(super) struct Panel {
    pub quantity: Quantity,
    pub curves: Vec<Curve>,
}

impl Panel {
    /// What is good: shown beside the quantity.
    pub const fn hint(&self) -> &'static str {
        match self.quantity {
            Quantity::Speed => "higher is better",
            _ => "lower is better",
        }
    }

    /// All values that the axis of the quantity must show.
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.curves.iter().flat_map(|c| {
            let measured = c.series.points.iter().flat_map(|p| {
                // An interval that reaches to zero or far below its value would crush the curves.
                [p.y, p.hi, p.lo.max(p.y / 4.0)]
            });
            measured.chain(c.series.predicted.iter().map(|p| p.1))
        })
    }
}

/// A text in the figure's sizes.
pub(super) const fn label_face(theme: &Theme) -> Face {
    Face {
        size: 11.5,
        weight: Weight::Regular,
        colour: theme.ink,
    }
}

/// A number beside a label, or a tick's.
pub(super) const fn quiet_face(theme: &Theme) -> Face {
    Face {
        size: 10.5,
        weight: Weight::Regular,
        colour: theme.muted,
    }
}

/// The quantity over its panel, base line at `y`.
pub(super) fn panel_head(canvas: &mut Canvas, theme: &Theme, panel: &Panel, x: f64, y: f64) {
    let face = Face {
        size: 12.0,
        weight: Weight::Bold,
        colour: theme.ink,
    };
    let title = capitalised(&panel.quantity.title());
    canvas.text(&title, (x, y), Anchor::Start, face);
    let after = x + face.width(&title) + 8.0;
    canvas.text(panel.hint(), (after, y), Anchor::Start, quiet_face(theme));
}

fn capitalised(text: &str) -> String {
    let mut chars = text.chars();
    chars
        .next()
        .map(|c| c.to_uppercase().chain(chars).collect())
        .unwrap_or_default()
}

/// How a figure is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Style<'a> {
    pub theme: &'a Theme,
    /// Whether the SVG follows the reader's preference for dark.
    pub adapts: bool,
}

/// The figure of `kind` over one combination as SVG; `None` where the report has no values for it.
///
/// # Errors
/// What could not be drawn.
pub(super) fn svg(
    report: &Report,
    key: &PanelKey,
    kind: Kind,
    style: Style,
) -> Result<Option<String>, String> {
    let panels = panels(report, key, kind);
    if panels.is_empty() {
        return Ok(None);
    }
    let theme = style.theme;
    let over_n = panels
        .iter()
        .flat_map(|p| &p.curves)
        .any(|c| !c.series.constant);
    let runs: Vec<&Run> = report
        .runs
        .iter()
        .filter(|run| PanelKey::of(run) == *key)
        .collect();
    let plan: Box<dyn Plot> = if over_n {
        Box::new(lines::plan(panels, theme))
    } else {
        Box::new(dots::plan(panels, theme))
    };
    let width = plan.width();
    let lines = font::wrap(
        &note::note(
            &runs,
            &report.provenance,
            kind,
            plan.interval(),
            &plan.legend(),
        ),
        note::SMALL,
        width - 2.0 * MARGIN,
    );
    let top = 58.0;
    let foot = top + plan.height() + 12.0;
    let height = (foot + lines.len() as f64 * note::PITCH + 6.0).ceil();

    let mut drawn = String::new();
    let mut canvas = Canvas::new(&mut drawn, width, height, theme.ground);
    title(&mut canvas, theme, key, &runs, width);
    plan.draw(&mut canvas, theme, top);
    note::draw(&mut canvas, theme, &lines, foot);
    let widths = canvas.end()?;
    let head = Head {
        width,
        height,
        title: &format!("{key}: {}", kind.name()),
        adapts: style.adapts,
    };
    Ok(Some(finish(&drawn, &widths, &head)))
}

/// What fills a figure between title and small print.
pub(super) trait Plot {
    /// Width of the figure in pixels.
    fn width(&self) -> f64;
    /// Height of all panels in pixels.
    fn height(&self) -> f64;
    /// Draws them, the first beginning at `top`.
    fn draw(&self, canvas: &mut Canvas, theme: &Theme, top: f64);
    /// What shows an interval.
    fn interval(&self) -> &'static str;
    /// What a reader needs to know of the signs used, in sentences.
    fn legend(&self) -> Vec<&'static str>;
}

/// The panels of a figure that have values. A curve looks the same in every figure of a report.
pub(super) fn panels(report: &Report, key: &PanelKey, kind: Kind) -> Vec<Panel> {
    let looks = Looks::of(report);
    kind.quantities()
        .iter()
        .map(|&quantity| Panel {
            quantity,
            curves: series(&report.runs, key, quantity)
                .into_iter()
                .map(|series| looks.curve(series))
                .collect(),
        })
        .filter(|panel| !panel.curves.is_empty())
        .collect()
}

/// How the accelerators of a report look, the same in all its figures.
pub(super) struct Looks {
    labels: Vec<String>,
    names: Vec<String>,
}

impl Looks {
    pub fn of(report: &Report) -> Self {
        let mut labels: Vec<String> = Vec::new();
        for label in report.runs.iter().map(accel_label) {
            if !labels.contains(&label) {
                labels.push(label);
            }
        }
        let names = names(&labels);
        Self { labels, names }
    }

    /// `series` with its look; without a figure of its own.
    pub fn curve(&self, series: Series) -> Curve {
        let index = self.labels.iter().position(|l| *l == series.label);
        let index = index.unwrap_or_default();
        Curve {
            look: Look::of(index),
            name: self.names[index].clone(),
            figure: None,
            series,
        }
    }
}

/// `labels` as figures write them: long ones shortened in the middle unless two would then look the same.
fn names(labels: &[String]) -> Vec<String> {
    let fit = |label: &String| font::fit(label, 11.5, Weight::Regular, WIDEST_NAME);
    let short: Vec<String> = labels.iter().map(fit).collect();
    let distinct: BTreeSet<&String> = short.iter().collect();
    if distinct.len() == short.len() {
        short
    } else {
        labels.to_vec()
    }
}

fn title(canvas: &mut Canvas, theme: &Theme, key: &PanelKey, runs: &[&Run], width: f64) {
    let face = Face {
        size: TITLE,
        weight: Weight::Bold,
        colour: theme.ink,
    };
    let room = width - 2.0 * MARGIN;
    let line = font::fit(&words(key).join(" · "), face.size, face.weight, room);
    canvas.text(&line, (MARGIN, 26.0), Anchor::Start, face);
    if let Some(run) = runs.first() {
        let facts = format!(
            "{} triangles, {} rays a sample",
            number(run.triangles as f64),
            ray_counts(runs)
        );
        canvas.text(
            &facts,
            (MARGIN, 44.0),
            Anchor::Start,
            label_face_quiet(theme),
        );
    }
}

/// The rays of a sample, with the fewest where some runs trace a part of the set: `157 to 16,428`.
fn ray_counts(runs: &[&Run]) -> String {
    let counts = || runs.iter().map(|run| run.ray_count);
    match (counts().min(), counts().max()) {
        (Some(fewest), Some(most)) if fewest < most => {
            format!("{} to {}", number(fewest as f64), number(most as f64))
        }
        (_, most) => number(most.unwrap_or(0) as f64),
    }
}

/// Of a path, the name of its file: the whole path is in the tables.
pub(super) fn file_name(spec: &str) -> &str {
    spec.rsplit(['/', '\\']).next().unwrap_or(spec)
}

/// Scene, rays, kernel and threads as words.
pub(super) fn words(key: &PanelKey) -> [String; 4] {
    let rays = match key.rays.strip_prefix("file:") {
        Some(path) => format!("rays of {}", file_name(path)),
        None => format!("{} rays", key.rays),
    };
    let plural = if key.threads == 1 { "" } else { "s" };
    [
        file_name(&key.scene).to_owned(),
        rays,
        key.kernel.clone(),
        format!("{} thread{plural}", key.threads),
    ]
}

const fn label_face_quiet(theme: &Theme) -> Face {
    Face {
        colour: theme.muted,
        ..label_face(theme)
    }
}
