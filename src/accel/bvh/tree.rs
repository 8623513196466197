//! Binary trees of boxes: what every build of this room gives, and the choice among the builds.

use crate::geometry::Aabb;
use crate::registry::{ParamKind, ParamSpec, Params};
use crate::scene::Mesh;

use super::super::items::LANES;
use super::super::slab::{Corners, corners};
use super::reinsert::{self, Work};
use super::spatial::{self, Effort};
use super::{binned, leaves, presplit};

/// A box and what is in it: two children at `first` and `first + 1`, or `count` references from `first` on.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub(in crate::accel) struct Node {
    /// The least and the greatest corner.
    pub corners: Corners,
    /// The first child, or the first reference of a leaf.
    pub first: u32,
    /// References of a leaf; zero for an interior node.
    pub count: u32,
}

impl Node {
    /// Neither a leaf nor interior.
    pub const NONE: Self = Self {
        corners: [[0.0; 3]; 2],
        first: 0,
        count: 0,
    };

    pub fn leaf(bounds: Aabb, first: u32, count: u32) -> Self {
        Self {
            corners: corners(bounds),
            first,
            count,
        }
    }

    pub fn interior(bounds: Aabb, first: u32) -> Self {
        Self::leaf(bounds, first, 0)
    }

    pub fn is_leaf(&self) -> bool {
        self.count != 0
    }

    /// The same where its children lie so many nodes further back.
    pub fn moved(&self, nodes: u32) -> Self {
        let by = if self.is_leaf() { 0 } else { nodes };
        Self {
            first: self.first + by,
            ..*self
        }
    }

    pub fn bounds(&self) -> Aabb {
        Aabb {
            min: self.corners[0].into(),
            max: self.corners[1].into(),
        }
    }
}

/// A binary tree over the triangles of a mesh.
///
/// No leaf is empty or lies deeper than [`MAX_DEPTH`](super::super::stack::MAX_DEPTH), the box of a node contains those
/// of its children, and the boxes of the leaves that list a triangle together contain all of it. A leaf lists a triangle
/// once; with [`Build::Binned`] only one leaf does, and its box contains the triangle's.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::accel) struct BinaryTree {
    /// The root is first; children lie side by side, behind their parent. Behind the children of a node lies what is below
    /// the first, then what is below the second. Nothing is between. Empty for an empty mesh.
    pub nodes: Vec<Node>,
    /// Triangle indices in the order of the leaves.
    pub references: Vec<u32>,
}

impl BinaryTree {
    /// The tree over nothing.
    pub const EMPTY: Self = Self {
        nodes: Vec::new(),
        references: Vec::new(),
    };

    /// The triangles that `leaf` lists.
    #[inline(always)]
    pub fn references_of(&self, leaf: &Node) -> &[u32] {
        &self.references[leaf.first as usize..][..leaf.count as usize]
    }

    /// What a random line that meets the root costs by the surface area heuristic; 0 where the root has no area.
    #[cfg(test)]
    pub fn cost(&self) -> f64 {
        use super::super::sah::half_area;
        let Some(root) = self.nodes.first().map(|root| half_area(&root.bounds())) else {
            return 0.0;
        };
        let cost = |node: &Node| {
            let work = if node.is_leaf() {
                leaves::COSTS.test * f64::from(node.count)
            } else {
                leaves::COSTS.step
            };
            work * half_area(&node.bounds())
        };
        let cost: f64 = self.nodes.iter().map(cost).sum();
        if root > 0.0 { cost / root } else { 0.0 }
    }
}

/// How a binary tree is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::accel) enum Build {
    /// Top down, split by histograms of centroids.
    Binned,
    /// As [`Build::Binned`]; where that pays, planes first cut triangles where large boxes overlap, elsewhere the largest
    /// subtrees move as with [`Build::Reinsert`].
    Presplit,
    /// As [`Build::Binned`], and planes cut triangles where boxes would overlap.
    Sbvh,
    /// As [`Build::Binned`], then subtrees move to where they enlarge boxes least.
    Reinsert,
    /// As [`Build::Sbvh`], then as [`Build::Reinsert`]: the slowest to build and the cheapest to trace.
    SbvhReinsert,
}

impl Build {
    /// The parameter that names the build, for structures that stand on a binary tree.
    pub const PARAM: ParamSpec = ParamSpec {
        name: "build",
        about: "How the tree is built.",
        kind: ParamKind::Choice(&["binned", "presplit", "sbvh", "reinsert", "sbvh-reinsert"]),
        default: "binned",
    };

    /// The same for a structure whose blocks of triangles make up for the references that are added.
    pub const SPLIT_PARAM: ParamSpec = ParamSpec {
        default: "presplit",
        ..Self::PARAM
    };

    /// The build that `params` names.
    pub fn of(params: &Params) -> Self {
        match params.text("build") {
            "presplit" => Self::Presplit,
            "sbvh" => Self::Sbvh,
            "reinsert" => Self::Reinsert,
            "sbvh-reinsert" => Self::SbvhReinsert,
            _ => Self::Binned,
        }
    }
}

/// Builds a tree over `mesh` whose leaves hold at most `most` references (at least 1); with `most` = 1 each holds one.
///
/// Runs in parallel in the rayon pool it is called in and gives the same tree whatever its threads. In time
/// O(N log N).
pub(in crate::accel) fn binary(mesh: &Mesh, build: Build, most: usize) -> BinaryTree {
    let tree = match build {
        Build::Binned => binned::build(binned::references(mesh), 1),
        Build::Presplit => presplit::build(mesh, 1),
        Build::Sbvh => spatial::build(mesh, Effort::FULL, 1),
        Build::Reinsert => {
            reinsert::optimised(binned::build(binned::references(mesh), 1), Work::FULL)
        }
        Build::SbvhReinsert => {
            reinsert::optimised(spatial::build(mesh, Effort::FULL, 1), Work::FULL)
        }
    };
    if most > 1 {
        leaves::merged(&tree, most)
    } else {
        tree
    }
}

/// A tree over `mesh` for a structure whose leaves are blocks of [`LANES`] triangles: [`Build::Binned`] and [`Build::Presplit`]
/// leave so many together, the others none, as with [`binary`] and `most` = 1.
///
/// A test of a block costs the same whether it is full or not, so that finer leaves hardly help. Measured against leaves of
/// one reference with `bvh-wide` and `woop`: the cost by the heuristic is 0.2 % higher on the Stanford bunny, 0.8 % on the
/// Crytek Sponza and 0.6 % on the two-cylinder engine; rays are as quick, since there are fewer blocks; the build takes a
/// third less time.
pub(in crate::accel) fn grouped(mesh: &Mesh, build: Build) -> BinaryTree {
    match build {
        Build::Binned => binned::build(binned::references(mesh), LANES),
        Build::Presplit => presplit::build(mesh, LANES),
        build => binary(mesh, build, 1),
    }
}
