//! The README names every entry of every registry, in code marks, so that nothing is added without being told.

use raylab::accel::ACCELERATORS;
use raylab::kernel::KERNELS;
use raylab::lab::stability::CASES;
use raylab::report::FORMATS;
use raylab::scene::SCENES;
use raylab::shade::CHANNELS;
use raylab::trace::RAY_SETS;

const README: &str = include_str!("../README.md");

/// Whether `name` stands in code marks: alone, or followed by its size or parameters.
fn told(name: &str) -> bool {
    [
        format!("`{name}`"),
        format!("`{name}:"),
        format!("`{name}["),
    ]
    .iter()
    .any(|form| README.contains(form.as_str()))
}

#[test]
fn the_readme_names_every_entry_of_every_registry() {
    let names = ACCELERATORS.iter().map(|a| a.name);
    let names = names.chain(KERNELS.iter().map(|k| k.name));
    let names = names.chain(SCENES.iter().map(|s| s.name));
    let names = names.chain(RAY_SETS.iter().map(|r| r.name));
    let names = names.chain(CASES.iter().map(|c| c.name));
    let names = names.chain(CHANNELS.iter().map(|c| c.name));
    let names = names.chain(FORMATS.iter().map(|f| f.name));
    let missing: Vec<&str> = names.filter(|name| !told(name)).collect();
    assert!(missing.is_empty(), "the README does not name {missing:?}");
}

#[test]
fn every_picture_of_the_readme_is_in_the_repository() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let links = README
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next());
    for link in links.filter(|link| !link.contains("://")) {
        assert!(
            root.join(link).exists(),
            "the README links to '{link}', which is not there"
        );
    }
}
