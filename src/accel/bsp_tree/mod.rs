//! A tree of planes in any direction: through faces of triangles, through their edges across them, and across the axes.
//!
//! ```text
//!    \    /         Cells are convex polytopes. A plane through a face leaves empty space on one side of a
//!     \  /\         curved surface, however the surface is turned; no box around it does.
//!   ---\/--\---
//!      /    \
//! ```
//!
//! The upper levels are those of the kd-tree. Below them each plane is chosen by the surface area heuristic from the best
//! axis-parallel one and from those of a sample of the cell's triangles; surfaces are those of polytopes that are cut plane
//! by plane, and triangles are clipped to them. An axis-parallel plane is the kd-tree's own node, with its cost; an oblique
//! one stands apart, in `f64`, and costs twice as much.
//!
//! Builds are slow: more than ten times as slow as the kd-tree's. They are bounded: only cells of at most some hundred
//! triangles are tried, with a fixed number of planes, depth is that of the stack, and a subtree lists no more references than
//! sixteen times its triangles. Subtrees count what they take, and the build is given up where that is more than it may.
//!
//! **Conservative.** With heights above a plane in lengths of its normal, of which the greatest component is 1: what a triangle
//! has within [`tolerance`](Scale::tolerance) of a plane may be listed on one side only; everything computed here is off by
//! less than [`rounding`](Scale::rounding), after 64 cuts too; and every ray takes what lies within
//! [`pad`](Scale::pad) of the plane, more than both together, to be on both sides, beside the cone that the slab test makes
//! of it. So no hit is lost that lies on the exact triangle, nor one at its rim.
//!
//! **Source:** T. Ize, I. Wald and S. Parker, "Ray Tracing with the BSP Tree", 2008. **Differs:** oblique planes are tried
//! in the lower levels only, and for a sample of the triangles.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::geometry::Aabb;
use crate::scene::Mesh;

use super::items::LANES;
use super::kd_tree::{Cell, Upper};
use super::plane_tree::{Node, Part, PlaneTree, Splitter, Subtree, parts};
use super::share::BLOCK_BYTES;
use super::traced::finish_in_order;
use super::{AcceleratorEntry, BuildError};

mod build;
mod piece;
mod polytope;

pub(super) const ENTRY: AcceleratorEntry = AcceleratorEntry {
    name: "bsp-tree",
    about: "A tree of planes in any direction, through faces of triangles where that pays; slow to build.",
    paper: "Ize, Wald and Parker 2008, Ray Tracing with the BSP Tree",
    params: &[],
    control: false,
    resolution: None,
    peer: None,
    build: |request| {
        let (tree, slots) = build(request.mesh, request.memory_limit)?;
        finish_in_order(tree, &slots, request)
    },
};

/// Below this many parts oblique planes are tried.
const LEAST: usize = 128;

/// Distances that depend on the scene's size.
#[derive(Debug, Clone, Copy)]
struct Scale {
    /// What lies so near to an oblique plane is taken to lie in it.
    tolerance: f64,
    /// What everything that is computed is off by at most. A cut is off by less than 8u of the greatest coordinate,
    /// u = 2⁻⁵³, and no more than 64 follow upon each other.
    rounding: f64,
    /// What rays take to be on both sides.
    pad: f64,
}

impl Scale {
    fn of(scene: &Aabb) -> Self {
        let size = f64::from(scene.max_abs());
        // A face whose corners were rounded to f32 is flat only to so much.
        let tolerance = 2.0 * f64::from(f32::EPSILON) * size;
        Self {
            tolerance,
            rounding: size * 0.5_f64.powi(40),
            pad: 2.0 * tolerance,
        }
    }
}

/// What the subtrees together may take, and what those that have grown take.
struct Budget {
    limit_bytes: u64,
    taken: AtomicU64,
}

impl Budget {
    fn is_exceeded(&self) -> bool {
        self.taken.load(Ordering::Relaxed) > self.limit_bytes
    }

    fn take(&self, bytes: u64) {
        self.taken.fetch_add(bytes, Ordering::Relaxed);
    }
}

/// Builds the tree over `mesh`, in parallel in the rayon pool it is called in; also the triangle of every lane of its blocks.
///
/// # Errors
/// It would take more than `limit_bytes`. Subtrees that are grown count until it is exceeded; whether it is does not depend
/// on their order, and none is begun after.
fn build(mesh: &Mesh, limit_bytes: u64) -> Result<(PlaneTree, Vec<u32>), BuildError> {
    let budget = Budget {
        limit_bytes,
        taken: AtomicU64::new(0),
    };
    let refused = BuildError::Outgrown {
        accel: ENTRY.name,
        limit_bytes,
    };
    // Each triangle takes a lane at least.
    if mesh.len().div_ceil(LANES) as u64 * BLOCK_BYTES > limit_bytes {
        return Err(refused);
    }
    let bounds = mesh.bounds();
    let scale = Scale::of(&bounds);
    let upper = Upper {
        splitter: Splitter { mesh, clip: true },
        least: LEAST,
        small: |cell: &Cell, parts: Vec<Part>| {
            if budget.is_exceeded() {
                return (Node::EMPTY, Subtree::default());
            }
            let (root, tree) = build::grow(mesh, scale, cell, &parts);
            budget.take(tree.bytes());
            (root, tree)
        },
    };
    let grown = upper.grow(&Cell::root(mesh), parts(mesh));
    if budget.is_exceeded() {
        return Err(refused);
    }
    Ok(grown.finish(bounds))
}

#[cfg(test)]
mod tests;
