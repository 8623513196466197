//! Reading and writing `report.json`.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::{Report, ReportError};

/// The JSON Schema of [`Report::SCHEMA`], as text.
pub const SCHEMA_JSON: &str = include_str!("schema.json");

impl Report {
    /// Reads a report: a `report.json`, or the one in a bundle's folder.
    ///
    /// # Errors
    /// A file that cannot be read, is cut off, is no JSON, is of something else, or lacks a part.
    pub fn read(path: &Path) -> Result<Self, ReportError> {
        let path = if path.is_dir() {
            let inside = path.join("report.json");
            if !inside.exists() {
                let dir = path.to_owned();
                return Err(ReportError::NoBundle { dir });
            }
            inside
        } else {
            path.to_owned()
        };
        let bytes = std::fs::read(&path).map_err(|why| ReportError::file("read", &path, &why))?;
        Self::parse(&bytes, path)
    }

    /// Reads the bytes of a report; `path` is named in errors.
    fn parse(bytes: &[u8], path: PathBuf) -> Result<Self, ReportError> {
        let value: Value = match serde_json::from_slice(bytes) {
            Ok(value) => value,
            Err(why) if why.is_eof() => {
                let line = why.line();
                return Err(ReportError::Truncated { path, line });
            }
            Err(why) => {
                let why = why.to_string();
                return Err(ReportError::NotJson { path, why });
            }
        };
        let foreign = |why: String| ReportError::Foreign {
            path: path.clone(),
            why,
        };
        match value.get("schema") {
            Some(Value::String(schema)) if schema == Self::SCHEMA => {}
            Some(schema) => {
                let expected = Self::SCHEMA;
                return Err(foreign(format!(
                    "its schema is {schema}, not \"{expected}\""
                )));
            }
            None => return Err(foreign("it names no schema".to_owned())),
        }
        serde_json::from_value(value).map_err(|why| foreign(why.to_string()))
    }

    /// Writes the report: beside the file first, then in its place, so a kill leaves the old one or the new one.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), ReportError> {
        // Reports hold nothing that JSON cannot: names are text and figures finite.
        let mut text = serde_json::to_vec_pretty(self).unwrap_or_default();
        text.push(b'\n');
        replace(path, &text)
    }
}

/// Writes a file beside `path` and renames it over `path`.
///
/// # Errors
/// It cannot be written or renamed.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<(), ReportError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let beside = path.with_file_name(name);
    let write = || {
        let mut file = File::create(&beside)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        std::fs::rename(&beside, path)
    };
    write().map_err(|why| {
        // Best effort: what could not be finished shall not lie around.
        let _ = std::fs::remove_file(&beside);
        ReportError::file("write", path, &why)
    })
}

#[cfg(test)]
mod tests {
    use super::super::fixture;
    use super::*;

    fn why(bytes: &[u8]) -> String {
        let error = Report::parse(bytes, PathBuf::from("a.json")).unwrap_err();
        error.to_string()
    }

    #[test]
    fn a_report_comes_back_equal() {
        let dir = tempfile::tempdir().unwrap();
        let report = fixture::report(vec![fixture::run("grid", Some(8))]);
        let path = dir.path().join("report.json");
        report.write(&path).unwrap();
        assert_eq!(Report::read(&path).unwrap(), report);
        assert_eq!(Report::read(dir.path()).unwrap(), report);
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_report_that_was_cut_off_is_told_from_one_that_never_was() {
        let report = fixture::report(vec![fixture::run("grid", Some(8))]);
        let text = serde_json::to_vec_pretty(&report).unwrap();
        assert!(why(&text[..text.len() / 2]).contains("was cut off"));
        assert!(why(b"").contains("was cut off"));
        assert!(why(b"v 1 2 3\n").contains("is not JSON"));
        assert!(why(b"\xff\xfe").contains("is not JSON"));
    }

    #[test]
    fn json_of_something_else_is_refused() {
        assert!(why(b"[]").contains("names no schema"));
        assert!(why(br#"{"schema": "other/2"}"#).contains("its schema is \"other/2\""));
        let lacking = why(br#"{"schema": "raylab/report/1"}"#);
        assert!(lacking.contains("missing field"), "{lacking}");
    }

    #[test]
    fn a_missing_file_and_a_folder_without_a_report_are_named() {
        let dir = tempfile::tempdir().unwrap();
        let told = Report::read(dir.path()).unwrap_err().to_string();
        assert!(told.contains("holds no bundle"), "{told}");
        let told = Report::read(Path::new("no/report.json"))
            .unwrap_err()
            .to_string();
        assert!(told.starts_with("cannot read no/report.json"), "{told}");
    }
}
