//! Images as PNG files.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::shade::{Image, ImageError};

/// Why a picture was not written.
#[derive(Debug, Error)]
pub enum PictureError {
    /// The image cannot be encoded.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The file cannot be written.
    #[error(
        "cannot write the picture '{}': {cause}; check that its directory exists and may be written, or choose another with --out",
        path.display()
    )]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
}

/// Writes `image` as a PNG file. The file is written beside `path` and renamed, so there is a whole picture or none.
///
/// # Errors
/// An image without pixels; a file that cannot be written.
pub fn write_png(image: &Image, path: &Path) -> Result<(), PictureError> {
    let bytes = image.png()?;
    // The process id keeps two writers of one file apart.
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.part", std::process::id()));
    let part = path.with_file_name(name);
    let written = fs::write(&part, bytes).and_then(|()| fs::rename(&part, path));
    written.map_err(|cause| {
        // What was written is of no use; that it cannot be removed changes nothing.
        let _ = fs::remove_file(&part);
        PictureError::Write {
            path: path.to_owned(),
            cause,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_written_whole_and_nothing_is_left_beside_it() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.png");
        let image = Image::filled(2, 2, [1, 2, 3]);
        write_png(&image, &path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), image.png().unwrap());
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_file_that_cannot_be_written_is_named_with_a_remedy() {
        let dir = tempfile::tempdir().unwrap();
        let image = Image::filled(2, 2, [1, 2, 3]);
        for path in [dir.path().join("missing/a.png"), dir.path().to_owned()] {
            let message = write_png(&image, &path).unwrap_err().to_string();
            assert!(message.contains(&*path.to_string_lossy()), "{message}");
            assert!(message.contains("--out"), "{message}");
        }
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
    }
}
