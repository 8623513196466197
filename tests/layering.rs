//! The rooms of the crate depend only downwards: a lower room names no higher one.

use std::fs;
use std::path::{Path, PathBuf};

/// The rooms from the top down. A room may use what stands after it, and itself.
const ROOMS: &[&str] = &[
    "cli", "tui", "preview", "report", "lab", "stats", "shade", "trace", "oracle", "accel",
    "kernel", "scene", "geometry", "registry",
];

/// The sources, as paths relative to `src` and their texts.
fn sources() -> Vec<(PathBuf, String)> {
    fn collect(dir: &Path, src: &Path, files: &mut Vec<(PathBuf, String)>) {
        for entry in fs::read_dir(dir).expect("src is readable") {
            let path = entry.expect("src is readable").path();
            if path.is_dir() {
                collect(&path, src, files);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let relative = path.strip_prefix(src).expect("files lie in src").to_owned();
                files.push((
                    relative,
                    fs::read_to_string(&path).expect("sources are UTF-8"),
                ));
            }
        }
    }
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    collect(&src, &src, &mut files);
    assert!(!files.is_empty());
    files
}

/// The room a file belongs to: the first part of its path, without `.rs`.
fn room_of(path: &Path) -> String {
    let first = path.components().next().expect("a file has a name");
    first
        .as_os_str()
        .to_string_lossy()
        .trim_end_matches(".rs")
        .to_owned()
}

/// Rooms that a text names by `crate::room` outside comments.
fn rooms_named(text: &str) -> Vec<&'static str> {
    let code: String = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect::<Vec<_>>()
        .join("\n");
    let names = |room: &str| {
        code.match_indices(&format!("crate::{room}"))
            .any(|(at, found)| {
                !code[at + found.len()..].starts_with(|c: char| c.is_alphanumeric() || c == '_')
            })
    };
    ROOMS.iter().filter(|room| names(room)).copied().collect()
}

#[test]
fn every_room_uses_only_lower_rooms() {
    let mut wrong = Vec::new();
    for (path, text) in sources() {
        let room = room_of(&path);
        // The program, the map and the build script stand outside the rooms.
        if ["main", "lib", "build"].contains(&room.as_str()) {
            continue;
        }
        let Some(height) = ROOMS.iter().position(|r| *r == room) else {
            wrong.push(format!("{} lies in no known room", path.display()));
            continue;
        };
        for named in rooms_named(&text) {
            if ROOMS[..height].contains(&named) {
                wrong.push(format!("{} uses the higher room {named}", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn imports_are_written_so_that_the_check_sees_them() {
    // `use crate::{a, b}` would hide rooms from the search for `crate::a`.
    for (path, text) in sources() {
        assert!(
            !text.contains("use crate::{"),
            "{} imports with `use crate::{{`",
            path.display()
        );
    }
}
