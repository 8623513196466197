//! Exports: what a report can be written as. One row and one file a format.
//!
//! Every file is written beside its place and then renamed, so a reader never meets half of one.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;
use thiserror::Error;

use crate::registry::ChoiceError;

use super::plot::{self, PlotFormat};
use super::{Report, csv, html, markdown, peers, scaling};

/// Why a report was not written.
#[derive(Debug, Error)]
pub enum ExportError {
    /// No such format.
    #[error(transparent)]
    Format(#[from] ChoiceError),
    /// The file system refused.
    #[error("cannot write '{path}': {why}; choose a folder that can be written with --out")]
    Write {
        /// The file or folder.
        path: String,
        /// What the system says.
        why: std::io::Error,
    },
    /// A figure could not be drawn.
    #[error("cannot draw '{figure}': {why}")]
    Draw {
        /// Name of the figure's file.
        figure: String,
        /// What went wrong.
        why: String,
    },
}

/// A row of the registry of formats.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct FormatEntry {
    /// Kebab-case name.
    pub name: &'static str,
    /// One sentence.
    pub about: &'static str,
    /// Writes a report into a folder, which exists, and says which files.
    #[serde(skip)]
    pub write: fn(&Report, &Path) -> Result<Vec<PathBuf>, ExportError>,
}

/// All formats, in the order in which they are listed.
pub const FORMATS: &[FormatEntry] = &[
    FormatEntry {
        name: "svg",
        about: "Figures as SVG, one a scene, kernel, ray set and thread count; they follow a light or dark page.",
        write: |report, dir| plot::write_all(report, dir, &[PlotFormat::Svg]),
    },
    FormatEntry {
        name: "png",
        about: "The same figures as PNG, dark on white.",
        write: |report, dir| plot::write_all(report, dir, &[PlotFormat::Png]),
    },
    FormatEntry {
        name: "png-dark",
        about: "The same figures as PNG, light on dark.",
        write: |report, dir| plot::write_all(report, dir, &[PlotFormat::PngDark]),
    },
    FormatEntry {
        name: "html",
        about: "One self-contained page with figures, tables, provenance and warnings.",
        write: |report, dir| Ok(vec![put(dir, "report.html", html::page(report)?)?]),
    },
    FormatEntry {
        name: "csv",
        about: "One line a run with all figures, for spreadsheets and data frames.",
        write: |report, dir| Ok(vec![put(dir, "report.csv", csv::table(report))?]),
    },
    FormatEntry {
        name: "md",
        about: "Tables in Markdown, for a README or a pull request.",
        write: |report, dir| Ok(vec![put(dir, "report.md", markdown::page(report))?]),
    },
    FormatEntry {
        name: "scaling",
        about: "How build and tracing grow with the number of triangles: fitted laws, in Markdown and JSON.",
        write: |report, dir| {
            let page = put(dir, "scaling.md", scaling::table::page(report))?;
            Ok(vec![
                page,
                put(dir, "scaling.json", scaling::table::json(report))?,
            ])
        },
    },
    FormatEntry {
        name: "peers",
        about: "Ratios against Embree, goal by goal, and every structure scene by scene, in Markdown.",
        write: |report, dir| Ok(vec![put(dir, "peers.md", peers::page(report))?]),
    },
];

/// Writes `report` in the format named `format` into `dir`, which is made where it is missing; returns the files.
///
/// # Errors
/// An unknown format (with the nearest), a folder or file that cannot be written.
pub fn export(report: &Report, format: &str, dir: &Path) -> Result<Vec<PathBuf>, ExportError> {
    let entry = FORMATS
        .iter()
        .find(|f| f.name == format)
        .ok_or_else(|| ChoiceError::unknown("format", format, FORMATS.iter().map(|f| f.name)))?;
    make(dir)?;
    (entry.write)(report, dir)
}

/// Makes the folder `dir` and those above it.
pub(super) fn make(dir: &Path) -> Result<(), ExportError> {
    fs::create_dir_all(dir).map_err(|why| failed(dir, why))
}

/// Writes `content` as `dir/name`: beside it first, then renamed.
pub(super) fn put(
    dir: &Path,
    name: &str,
    content: impl AsRef<[u8]>,
) -> Result<PathBuf, ExportError> {
    let path = dir.join(name);
    // The process id keeps two writers of one folder apart.
    let beside = dir.join(format!(".{name}.{}.part", std::process::id()));
    fs::write(&beside, content)
        .and_then(|()| fs::rename(&beside, &path))
        .map_err(|why| {
            // Best effort: the reason of the failure matters more than the left-over.
            let _ = fs::remove_file(&beside);
            failed(&path, why)
        })?;
    Ok(path)
}

fn failed(path: &Path, why: std::io::Error) -> ExportError {
    ExportError::Write {
        path: path.display().to_string(),
        why,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture;

    #[test]
    fn names_of_formats_are_unique_kebab_case_and_said_in_a_sentence() {
        for (i, format) in FORMATS.iter().enumerate() {
            assert!(FORMATS[..i].iter().all(|f| f.name != format.name));
            assert!(
                format
                    .name
                    .chars()
                    .all(|c| c.is_ascii_lowercase() || c == '-')
            );
            assert!(
                format.about.ends_with('.') && format.about.len() < 110,
                "{}",
                format.about
            );
        }
    }

    #[test]
    fn every_format_writes_files_that_exist_and_no_others() {
        let report = fixture::report(fixture::growing());
        let dir = tempfile::tempdir().unwrap();
        let mut written = 0;
        for format in FORMATS {
            let files = export(&report, format.name, dir.path()).unwrap();
            assert!(!files.is_empty(), "{}", format.name);
            for file in &files {
                assert!(fs::metadata(file).unwrap().len() > 100, "{file:?}");
            }
            written += files.len();
        }
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), written);
    }

    #[test]
    fn an_unknown_format_is_answered_with_the_nearest() {
        let error = export(&fixture::teapot(), "hmtl", Path::new("unused")).unwrap_err();
        assert!(
            error.to_string().contains("did you mean 'html'?"),
            "{error}"
        );
        assert!(!Path::new("unused").exists());
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let error = export(&fixture::teapot(), "csv", &file.path().join("x")).unwrap_err();
        let message = error.to_string();
        assert!(
            message.starts_with("cannot write '") && message.contains("--out"),
            "{message}"
        );
    }
}
