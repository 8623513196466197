//! Trees of planes that tile the scene's box: what `kd-tree`, `octree` and `bsp-tree` have in common. They differ in where
//! they put the planes.
//!
//! ```text
//!   +-----+--+-------+      nodes, 8 bytes each, children side by side:   | x=5 . | y=3  leaf | leaf  leaf | ...
//!   |     |  |   A   |                                                       |      ^  |       ^
//!   |     |  +-------+                                                       `------'  `-------'
//!   |     |  |   B   |
//!   +-----+--+-------+      leaves name blocks of eight triangles; a triangle is in every leaf that it reaches into
//! ```
//!
//! The traversal follows the ray from leaf to leaf. At a plane it computes when the ray leaves the near side at the
//! latest and enters the far side at the earliest; where a ray meets a plane at the end of its interval, or lies in
//! it, both sides are visited. The way from leaf to leaf is not compiled for each kernel and instruction set: only the test
//! of a leaf's blocks is.
//!
//! Rays from one origin go together as packets where that is cheaper, with bounds on what each of them would compute.
//!
//! **Source:** M. Pharr, W. Jakob and G. Humphreys, "Physically Based Rendering", 3rd ed., §4.4, for the nodes.
//! **Differs:** the near side is told by the direction, not by the origin, so an origin on a plane is no special case.

use crate::geometry::lanes::Isa;
use crate::geometry::{Aabb, Ray};
use crate::scene::Mesh;

use super::packets;
use super::stack::{Room, room};
use super::{Blocks, Rays, Structure, StructureStats, Visitor};

pub(super) mod cost;
mod cut;
mod grow;
mod node;
mod parts;
mod together;
mod validate;
mod walk;

use cut::RayCut;
use walk::{Nobody, Walk, Watched};

pub(super) use grow::{Grown, Subtree};
pub(super) use node::{Node, Oblique, halves};
pub(super) use parts::{Part, Plane, Reach, Splitter, parts};

/// A tree of planes: the structure of `kd-tree`, `octree` and `bsp-tree`.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneTree {
    /// The root is first, and its sibling is unused.
    nodes: Vec<Node>,
    obliques: Vec<Oblique>,
    /// Triangles in each block; the rest of its lanes repeat the last.
    filled: Vec<u8>,
    bounds: Aabb,
}

impl PlaneTree {
    /// The triangles of a leaf.
    fn references(&self, leaf: Node) -> u32 {
        let blocks = leaf.blocks();
        self.filled[blocks.start as usize..blocks.end as usize]
            .iter()
            .map(|count| u32::from(*count))
            .sum()
    }

    /// All nodes, with their indices.
    fn all(&self) -> impl Iterator<Item = (u32, Node)> {
        (0..)
            .zip(self.nodes.iter().copied())
            .filter(|(i, _)| *i != 1)
    }
}

/// The walk of one ray, compiled once for all kernels.
#[inline(never)]
fn next(walk: &mut Walk<RayCut>, tree: &PlaneTree, limit: f32) -> Option<std::ops::Range<u32>> {
    walk.next(tree, limit, &mut Nobody)
}

#[inline(never)]
fn begin<'a>(tree: &PlaneTree, ray: &Ray, room: &'a mut Room, limit: f32) -> Walk<'a, RayCut> {
    Walk::new(RayCut::new(ray, &tree.bounds), tree, room, limit)
}

impl Structure for PlaneTree {
    type Items = Blocks;
    type Scratch = Room;

    fn scratch(&self) -> Room {
        room()
    }

    #[inline(always)]
    fn traverse<I: Isa, V: Visitor>(&self, ray: &Ray, room: &mut Room, visitor: &mut V) {
        let mut walk = begin(self, ray, room, visitor.t_limit());
        loop {
            let limit = visitor.t_limit();
            let leaf = if V::WATCHED {
                walk.next(self, limit, &mut Watched(visitor))
            } else {
                next(&mut walk, self, limit)
            };
            let Some(blocks) = leaf else {
                return;
            };
            for block in blocks {
                if visitor.test(block) {
                    return;
                }
            }
        }
    }

    #[inline(always)]
    fn trace<'a, R: Rays<'a>>(&self, batch: &mut R, room: &mut Room) {
        let packets = packets::share_origin(batch.rays());
        packets::trace(self, batch, room, packets);
    }

    fn place_bounds(&self, place: u64) -> Option<Aabb> {
        validate::place_bounds(self, u32::try_from(place).ok()?)
    }

    fn stats(&self) -> StructureStats {
        let leaves = || self.all().filter(|(_, node)| node.is_leaf());
        StructureStats {
            cells: self.all().filter(|(_, node)| node.is_step()).count() as u64,
            empty_cells: leaves()
                .filter(|(_, leaf)| leaf.blocks().is_empty())
                .count() as u64,
            references: self.filled.iter().map(|count| u64::from(*count)).sum(),
            depth: validate::depth(self),
            longest_list: leaves()
                .map(|(_, leaf)| self.references(leaf))
                .max()
                .unwrap_or(0),
            dims: None,
        }
    }

    fn memory_bytes(&self) -> u64 {
        (size_of_val(self.nodes.as_slice())
            + size_of_val(self.obliques.as_slice())
            + self.filled.len()) as u64
    }

    fn validate(&self, mesh: &Mesh, lanes: &[u32]) -> Result<(), String> {
        validate::validate(self, mesh, lanes)
    }
}
