//! A tree of axis-parallel planes, placed by the surface area heuristic over triangles that are clipped to their cells.
//!
//! Large cells are swept in bins, and exactly only around the best of them; small ones exactly. A subtree becomes a leaf
//! where that costs less, decided from the bottom up. Large cells are divided in parallel; the tree is the same whatever
//! the number of threads, since a cell's parts alone decide what becomes of it.
//!
//! **Source:** I. Wald and V. Havran, "On building fast kd-Trees for Ray Tracing, and on doing that in O(N log N)",
//! 2006, for the sweep and the clipping; M. Shevtsov, A. Soupikov and A. Kapustin, "Highly Parallel Fast KD-tree
//! Construction for Interactive Ray Tracing of Dynamic Scenes", 2007, for the bins of starts and ends.
//! **Differs:** a leaf costs by its blocks of eight; planes on the faces of a cell are not considered, so no cell is flat
//! unless the scene is; the bonus for empty space asks for a tenth of the cell, else a fan of triangles around a vertex is
//! trimmed by slivers without end.

use crate::registry::{ParamKind, ParamSpec, Params};
use crate::scene::Mesh;

use super::AcceleratorEntry;
use super::plane_tree::PlaneTree;
use super::traced::finish_in_order;

mod binned;
mod build;
mod cost;
mod small;
mod sweep;

pub(super) use build::{Upper, divide};
pub(super) use small::Cell;
pub(super) use sweep::Events;

pub(super) const ENTRY: AcceleratorEntry = AcceleratorEntry {
    name: "kd-tree",
    about: "A tree of axis-parallel planes, placed by the surface area heuristic, that tiles space.",
    paper: "Wald and Havran 2006, On building fast kd-Trees for Ray Tracing, and on doing that in O(N log N)",
    params: &[ParamSpec {
        name: "clip",
        about: "Whether triangles are clipped to the cells that they are counted in.",
        kind: ParamKind::Choice(&["on", "off"]),
        default: "on",
    }],
    control: false,
    resolution: None,
    peer: None,
    build: |request| {
        let (tree, slots) = build(request.mesh, request.params);
        finish_in_order(tree, &slots, request)
    },
};

/// Builds the tree over `mesh`, in parallel in the rayon pool it is called in; also the triangle of every lane of its blocks.
fn build(mesh: &Mesh, params: &Params) -> (PlaneTree, Vec<u32>) {
    build::build(mesh, params.text("clip") != "off")
}

#[cfg(test)]
mod tests;
