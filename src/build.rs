//! Tells the program what it was built from: commit, compiler, target, profile. Nothing here can fail the build; what
//! is not known stays empty.

use std::env;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=src/build.rs");
    let release = env::var("PROFILE").is_ok_and(|profile| profile == "release");
    // Only in release builds: elsewhere each commit would compile everything again.
    let (commit, dirty) = if release { state() } else { <_>::default() };
    let rustc =
        env::var("RUSTC").map_or_else(|_| String::new(), |rustc| said(&rustc, &["--version"]));
    for (name, value) in [
        ("RAYLAB_COMMIT", commit),
        ("RAYLAB_DIRTY", dirty),
        ("RAYLAB_RUSTC", rustc),
        ("RAYLAB_TARGET", env::var("TARGET").unwrap_or_default()),
        ("RAYLAB_PROFILE", env::var("PROFILE").unwrap_or_default()),
    ] {
        println!("cargo::rustc-env={name}={value}");
    }
}

/// The commit and, where tracked files differ from it, a word that says so; both empty outside a git checkout.
fn state() -> (String, String) {
    // A package inside somebody else's checkout, e.g. a vendored one, has no commit of its own.
    let top = said("git", &["rev-parse", "--show-prefix"]);
    let commit = said("git", &["rev-parse", "HEAD"]);
    if commit.is_empty() || !top.is_empty() {
        return <_>::default();
    }
    let log = said("git", &["rev-parse", "--git-path", "logs/HEAD"]);
    for path in [log.as_str(), "src", "Cargo.toml"] {
        if std::path::Path::new(path).exists() {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    let changes = said("git", &["status", "--porcelain", "--untracked-files=no"]);
    let dirty = if changes.is_empty() { "" } else { "dirty" };
    (commit, dirty.to_owned())
}

/// What a command prints, on one line; empty where it fails or is not there.
fn said(program: &str, arguments: &[&str]) -> String {
    match Command::new(program).args(arguments).output() {
        Ok(output) if output.status.success() => {
            let text = String::from_utf8_lossy(&output.stdout);
            text.lines().next().unwrap_or_default().trim().to_owned()
        }
        _ => String::new(),
    }
}
