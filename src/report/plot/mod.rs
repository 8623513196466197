//! Plots of a report as they would stand in a paper: one figure a combination of scene, kernel, ray set and threads.
//!
//! ```text
//! Report --series--> curves --figure--> lines or dots on a sheet --canvas--> SVG --raster--> PNG
//! ```
//!
//! | figure | panels |
//! |---|---|
//! | `speed` | rays/s with its interval, the fastest n, the predicted best n and its ties |
//! | `work` | steps and tests of a ray, measured and predicted |
//! | `cost` | build time and memory |
//! | `overview` | the speeds of all combinations as small multiples, where there is more than one |
//! | `scaling` | build time, time and steps of a ray over the number of triangles, where a family was run at three sizes |
//! | `pareto` | speed against wrong decisions, where the oracle judged |
//! | `drift` | wrong decisions and error of t against the offset or the scale, where it judged at more than one |
//! | `tuned` | wrong decisions and swaps against a kernel's parameter, where it judged several values |
//! | `stability` | the stability map: not of a report, but of a run of that suite |
//!
//! Equal reports give equal bytes: nothing here knows the time, the machine or its fonts.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::lab::stability::Map;

use super::Report;
use super::export::{ExportError, make, put};
use super::judged::{Along, Course, Tuned, courses, drifts, places, tuned};
use super::scaling::{Setting, settings};
use super::series::{PanelKey, panels};
use crate::lab::Place;

mod against;
mod axis;
mod canvas;
mod curves;
mod dots;
mod drift;
mod figure;
mod font;
mod labels;
mod lines;
mod note;
mod overview;
mod pareto;
mod plane;
mod raster;
mod scaling;
mod stability;
mod theme;
mod tuned;

pub use figure::Kind;

/// How the other formats write numbers and names, the same as figures do.
pub(super) mod text {
    pub(in crate::report) use super::axis::{measured, number};
    pub(in crate::report) use super::canvas::escape;
    pub(in crate::report) use super::font::css;
}

use figure::Style;

/// How a figure is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PlotFormat {
    /// SVG whose colours follow the reader's preference for light or dark.
    Svg,
    /// PNG, dark on white.
    Png,
    /// PNG, light on dark.
    PngDark,
}

impl PlotFormat {
    /// What follows a figure's name.
    const fn suffix(self) -> &'static str {
        match self {
            Self::Svg => ".svg",
            Self::Png => ".png",
            Self::PngDark => "-dark.png",
        }
    }

    const fn style(self) -> Style<'static> {
        let (theme, adapts) = match self {
            Self::Svg => (&theme::LIGHT, true),
            Self::Png => (&theme::LIGHT, false),
            Self::PngDark => (&theme::DARK, false),
        };
        Style { theme, adapts }
    }
}

/// Writes all figures of `report` into `dir`, which is made where it is missing; returns the files in the order of the
/// report. A report without values gives no figure.
///
/// # Errors
/// A folder or file that cannot be written.
pub fn write_all(
    report: &Report,
    dir: &Path,
    formats: &[PlotFormat],
) -> Result<Vec<PathBuf>, ExportError> {
    make(dir)?;
    let mut files = Vec::new();
    for (name, subject) in figures(report) {
        for &format in formats {
            let draw = |why| ExportError::Draw {
                figure: name.clone(),
                why,
            };
            let Some(svg) = drawn(report, &subject, format.style()).map_err(draw)? else {
                continue;
            };
            let content = match format {
                PlotFormat::Svg => svg.into_bytes(),
                PlotFormat::Png | PlotFormat::PngDark => raster::png(&svg).map_err(draw)?,
            };
            files.push(put(dir, &format!("{name}{}", format.suffix()), content)?);
        }
    }
    Ok(files)
}

/// Writes the stability map into `dir`, which is made where it is missing: `stability.svg`, `.png` and `-dark.png`.
///
/// # Errors
/// A folder or file that cannot be written.
pub fn write_map(map: &Map, dir: &Path) -> Result<Vec<PathBuf>, ExportError> {
    make(dir)?;
    let mut files = Vec::new();
    for format in [PlotFormat::Svg, PlotFormat::Png, PlotFormat::PngDark] {
        let draw = |why| ExportError::Draw {
            figure: "stability".to_owned(),
            why,
        };
        let svg = stability::svg(map, format.style()).map_err(draw)?;
        let content = match format {
            PlotFormat::Svg => svg.into_bytes(),
            PlotFormat::Png | PlotFormat::PngDark => raster::png(&svg).map_err(draw)?,
        };
        files.push(put(dir, &format!("stability{}", format.suffix()), content)?);
    }
    Ok(files)
}

/// What a figure shows.
#[derive(Debug, Clone, PartialEq)]
pub enum Subject {
    /// The speeds of all combinations as small multiples.
    Overview,
    /// One combination.
    One(PanelKey, Kind),
    /// Costs over the number of triangles, all families of a setting.
    Scaling(Setting),
    /// Speed against wrong decisions on one course, at a place.
    Pareto(Course, Place),
    /// Error on one course against the offset or the scale.
    Drift(Course, Along),
    /// Error on one course against a kernel's parameter.
    Tuned(Course, Tuned),
}

/// One figure of `report` as SVG that follows the reader's preference for light or dark; `None` where the report has no
/// values for it, or too few combinations for an overview.
///
/// # Errors
/// A figure that cannot be drawn.
pub fn svg(report: &Report, subject: &Subject) -> Result<Option<String>, ExportError> {
    drawn(report, subject, PlotFormat::Svg.style()).map_err(|why| ExportError::Draw {
        figure: format!("{subject:?}"),
        why,
    })
}

fn drawn(report: &Report, subject: &Subject, style: Style) -> Result<Option<String>, String> {
    match subject {
        Subject::Overview => overview::svg(report, style),
        Subject::One(key, kind) => figure::svg(report, key, *kind, style),
        Subject::Scaling(setting) => scaling::svg(report, setting, style),
        Subject::Pareto(course, place) => pareto::svg(report, course, *place, style),
        Subject::Drift(course, along) => drift::svg(report, course, *along, style),
        Subject::Tuned(course, tuned) => tuned::svg(report, course, tuned, style),
    }
}

/// All figures of `report` with the names of their files, without ending: `speed-teapot-woop-primary-1t`.
fn figures(report: &Report) -> Vec<(String, Subject)> {
    let mut used: BTreeMap<String, usize> = BTreeMap::new();
    let mut figures = vec![("overview".to_owned(), Subject::Overview)];
    for key in panels(&report.runs) {
        let stem = distinct(file_stem(&key), &mut used);
        for kind in Kind::ALL {
            let subject = Subject::One(key.clone(), kind);
            figures.push((format!("{}-{stem}", kind.name()), subject));
        }
    }
    for setting in settings(&report.runs) {
        let parts = [&setting.kernel, &last(&setting.rays)].map(|part| sanitised(part));
        let stem = format!("scaling-{}-{}t", parts.join("-"), setting.threads);
        figures.push((distinct(stem, &mut used), Subject::Scaling(setting)));
    }
    for course in courses(&report.runs) {
        let parts = [last(&course.scene), last(&course.rays)];
        let stem = [sanitised(&parts[0]), sanitised(&parts[1])].join("-");
        let stem = distinct(format!("{stem}-{}t", course.threads), &mut used);
        let scaled = |scale: f64| match scale {
            1.0 => String::new(),
            scale => format!("-x{}", sanitised(&scale.to_string())),
        };
        for place in places(&report.runs, &course) {
            let offset = sanitised(&place.offset.to_string());
            let name = format!("pareto-{stem}-{offset}{}", scaled(place.scale));
            figures.push((name, Subject::Pareto(course.clone(), place)));
        }
        for along in drifts(&report.runs, &course) {
            let name = match along {
                Along::Offset { scale } => format!("drift-{stem}{}", scaled(scale)),
                Along::Scale { offset } => {
                    format!("scale-{stem}-{}", sanitised(&offset.to_string()))
                }
            };
            figures.push((name, Subject::Drift(course.clone(), along)));
        }
        for tuned in tuned(&report.runs, &course) {
            let method = sanitised(&format!("{}-{}", tuned.kernel, tuned.key));
            let name = distinct(format!("tuned-{method}-{stem}"), &mut used);
            figures.push((name, Subject::Tuned(course.clone(), tuned)));
        }
    }
    figures
}

/// `stem`, numbered where it was used before: scenes that differ only in characters a file name cannot have are
/// numbered in the order of the report.
fn distinct(stem: String, used: &mut BTreeMap<String, usize>) -> String {
    let count = used.entry(stem.clone()).or_default();
    *count += 1;
    if *count > 1 {
        format!("{stem}-{count}")
    } else {
        stem
    }
}

/// Of a path, the file's name.
fn last(spec: &str) -> String {
    let name = spec.rsplit(['/', '\\']).find(|part| !part.is_empty());
    name.unwrap_or(spec).to_owned()
}

/// A name that every file system takes: lower-case letters, digits, `.` and single hyphens. Of a path, the file's name.
fn file_stem(key: &PanelKey) -> String {
    let parts = [
        last(&key.scene),
        key.kernel.clone(),
        last(&key.rays),
        format!("{}t", key.threads),
    ];
    parts
        .iter()
        .map(|part| sanitised(part))
        .collect::<Vec<_>>()
        .join("-")
}

fn sanitised(part: &str) -> String {
    let mut out = String::new();
    for c in part.chars() {
        if c.is_ascii_alphanumeric() || (c == '.' && !out.is_empty()) {
            out.push(c.to_ascii_lowercase());
        } else if !out.is_empty() && !out.ends_with('-') {
            out.push('-');
        }
        // Most file systems take 255 bytes a name; four parts, the kind and the ending fit well below.
        if out.len() >= 48 {
            break;
        }
    }
    let out = out.trim_end_matches(['-', '.']);
    if out.is_empty() {
        "x".to_owned()
    } else {
        out.to_owned()
    }
}

#[cfg(test)]
mod tests;
