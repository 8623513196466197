//! Procedural scenes: one file a family, each with its row of the registry.
//!
//! Built from `Draft`, seeded with PCG32, and the same on every machine: only `+ − × ÷ √` decide coordinates, which
//! IEEE 754 rounds alike everywhere.

pub mod city;
pub mod degenerate;
mod draft;
mod exact;
pub mod gears;
pub(super) mod icosphere;
pub mod lattice;
pub mod menger;
pub mod mountain;
pub mod moved;
pub mod needles;
pub mod nested;
pub mod plane;
mod random;
pub mod rings;
pub mod soup;
pub mod sphereflake;
pub mod stadium;
pub mod teapot;
pub mod tetra;
pub mod tree;
pub mod trivial;

use draft::Draft;
pub(super) use icosphere::Icosphere;
use random::Random;

/// Whether each directed edge occurs once and its reverse once: a closed surface, consistently oriented.
#[cfg(test)]
pub(in crate::scene) fn closed(mesh: &crate::scene::Mesh) -> bool {
    let mut edges = std::collections::HashSet::new();
    let all_once = mesh
        .triangles()
        .iter()
        .all(|t| (0..3).all(|i| edges.insert((t[i], t[(i + 1) % 3]))));
    all_once && edges.iter().all(|&(a, b)| edges.contains(&(b, a)))
}
