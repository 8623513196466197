//! Procedural scenes: one file a family, each with its row of the registry.
//!
//! Built from [`Draft`], seeded with PCG32, and the same on every machine: only `+ − × ÷ √` decide coordinates, which
//! IEEE 754 rounds alike everywhere.

mod draft;
mod random;

pub mod lattice;
pub mod plane;
pub mod soup;
pub mod teapot;
pub mod trivial;

use draft::Draft;
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
