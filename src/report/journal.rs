//! Journals: files of JSON lines that only grow, so that a kill can tear no more than the last line.

use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::PathBuf;

use serde::{Serialize, de::DeserializeOwned};

use super::ReportError;

/// A file of JSON lines that only grows.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// Opens for appending after the first `length` bytes; what stands behind them is cut off.
    pub fn open(path: PathBuf, length: u64) -> Result<Self, ReportError> {
        let open = || {
            let file = OpenOptions::new().create(true).append(true).open(&path)?;
            file.set_len(length)?;
            Ok(file)
        };
        let file = open().map_err(|why| ReportError::file("write", &path, &why))?;
        Ok(Self { path, file })
    }

    /// Reads all lines and opens for appending. A last line without its end was torn and is cut off; a journal that is
    /// not there is empty.
    pub fn resume<T: DeserializeOwned>(path: PathBuf) -> Result<(Vec<T>, Self), ReportError> {
        let text = match fs::read(&path) {
            Err(why) if why.kind() != std::io::ErrorKind::NotFound => {
                return Err(ReportError::file("read", &path, &why));
            }
            text => text.unwrap_or_default(),
        };
        let whole = text
            .iter()
            .rposition(|b| *b == b'\n')
            .map_or(0, |at| at + 1);
        let mut entries = Vec::new();
        let lines = text[..whole].split(|b| *b == b'\n').zip(1..);
        for (bytes, line) in lines.filter(|(bytes, _)| !bytes.is_empty()) {
            entries.push(
                serde_json::from_slice(bytes).map_err(|why| ReportError::Journal {
                    path: path.clone(),
                    line,
                    why: why.to_string(),
                })?,
            );
        }
        Ok((entries, Self::open(path, whole as u64)?))
    }

    /// Appends one line in one write; `sync` waits until it is on the disk.
    pub fn append(&mut self, entry: &impl Serialize, sync: bool) -> Result<(), ReportError> {
        let mut line = serde_json::to_vec(entry).unwrap_or_default();
        line.push(b'\n');
        let write = || {
            (&self.file).write_all(&line)?;
            if sync { self.file.sync_data() } else { Ok(()) }
        };
        write().map_err(|why| ReportError::file("write", &self.path, &why))
    }

    /// Removes all lines.
    pub fn clear(&mut self) -> Result<(), ReportError> {
        let cut = self.file.set_len(0);
        cut.map_err(|why| ReportError::file("write", &self.path, &why))
    }
}
