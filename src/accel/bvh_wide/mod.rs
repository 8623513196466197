//! A tree of boxes with up to eight children a node, which are tested at once; its leaves hold blocks of eight triangles.
//!
//! ```text
//! node, 256 bytes:  | x least ×8 | x greatest ×8 | y ... | z ... | children ×8 |
//!
//! binary tree:        o                       eight-ary:       o
//!                   /   \                                 / / / \ \ \
//!                  o     o      -- collapse -->          L  o L  L o L
//!                 / \   / \
//! ```
//!
//! The traversal tests the eight boxes of a node, keeps those that are met in one vector of (entry | lane) keys, sorts it by
//! a network and puts all but the nearest child on a stack.
//!
//! **Source:** I. Wald, C. Benthin and S. Boulos, "Getting Rid of Packets", 2008, for wide trees; V. Fuetterling et al.,
//! "Accelerated Single Ray Tracing for Wide Vector Units", HPG 2017, for sorting keys in registers; H. Ylitie, T. Karras
//! and S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, for the collapse.
//! **Differs:** boxes are tested conservatively, so a watertight kernel stays so.

use std::ops::Range;

use crate::geometry::lanes::Isa;
use crate::geometry::{Aabb, Ray};
use crate::scene::Mesh;

use super::batch::run_apart;
use super::bvh::{Build, grouped};
use super::packets;
use super::slab::{NO_BOXES, Scene, WideCorners, box_in, put_box};
use super::traced::finish_in_order;
use super::{AcceleratorEntry, Blocks, Rays, Structure, StructureStats, Visitor};

mod collapse;
mod hybrid;
mod interleaved;
mod stack;
mod together;
mod validate;
mod walk;
mod way;

use hybrid::Hybrid;
use interleaved::Interleaved;
use stack::Stacks;
use walk::Walk;
use way::Way;

pub(super) const ENTRY: AcceleratorEntry = AcceleratorEntry {
    name: "bvh-wide",
    about: "A tree of boxes with eight children a node, tested at once, and triangles in blocks of eight.",
    paper: "Wald, Benthin and Boulos 2008, Getting Rid of Packets",
    params: &[Build::SPLIT_PARAM, Way::PARAM],
    control: false,
    resolution: None,
    peer: None,
    build: |request| {
        let tree = grouped(request.mesh, Build::of(request.params));
        let (mut wide, slots) = BvhWide::collapse(&tree, request.mesh);
        wide.way = Way::of(request.params);
        finish_in_order(wide, &slots, request)
    },
};

/// What is in a child's box: a node, or from one to seven blocks, or nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
struct Child(u32);

impl Child {
    /// Nothing: a leaf without blocks, in a box that no ray meets but one whose numbers tell nothing about boxes.
    const NONE: Self = Self(Self::LEAF);
    /// What is taken from a stack when nothing waits.
    const END: Self = Self(Self::LEAF | 1 << 3);
    /// Set where it is no node.
    const LEAF: u32 = 1 << 31;
    /// Most blocks of a leaf.
    const MOST: u32 = 7;

    fn node(index: usize) -> Self {
        Self(index as u32)
    }

    fn leaf(first: usize, blocks: usize) -> Self {
        Self(Self::LEAF | (first as u32) << 3 | blocks as u32)
    }

    fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// Of the node, or of the first block.
    #[inline(always)]
    fn index(self) -> usize {
        (self.0 & !Self::LEAF) as usize >> (3 * u32::from(self.is_leaf()))
    }

    /// The blocks of a leaf.
    fn blocks(self) -> Range<u32> {
        let first = (self.0 & !Self::LEAF) >> 3;
        first..first + (self.0 & Self::MOST)
    }

    /// The number by which visitors know it: nodes first, then leaves by their first block, which several may share.
    fn place(self) -> u64 {
        if self.is_leaf() {
            LEAVES | u64::from(self.blocks().start)
        } else {
            u64::from(self.0)
        }
    }
}

/// Where the numbers of leaves begin.
const LEAVES: u64 = 1 << 32;

/// The boxes of up to eight children, and the children.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
struct Node {
    boxes: WideCorners,
    children: [u32; 8],
}

/// The structure `bvh-wide`.
#[derive(Debug, PartialEq)]
pub struct BvhWide {
    nodes: Vec<Node>,
    root: Child,
    scene: Scene,
    /// Triangles in each block; the rest of its lanes repeat the last.
    filled: Vec<u8>,
    depth: u32,
    /// The way that was asked for; `None`: the one that suits a batch.
    way: Option<Way>,
}

impl BvhWide {
    /// The triangles of a leaf.
    fn references(&self, leaf: Child) -> u32 {
        let blocks = leaf.blocks().start as usize..leaf.blocks().end as usize;
        self.filled[blocks]
            .iter()
            .map(|count| u32::from(*count))
            .sum()
    }

    /// All children that there are, and the root, each with its box.
    fn children(&self) -> impl Iterator<Item = (Child, Aabb)> {
        let root = std::iter::once((self.root, self.scene.bounds));
        root.chain(self.nodes.iter().flat_map(Node::children))
            .filter(|(child, _)| *child != Child::NONE)
    }
}

impl Node {
    /// A node without children.
    const EMPTY: Self = Self {
        boxes: NO_BOXES,
        children: [Child::NONE.0; 8],
    };

    /// Puts `child` into a lane.
    fn set(&mut self, lane: usize, child: Child, bounds: &Aabb) {
        put_box(&mut self.boxes, lane, bounds);
        self.children[lane] = child.0;
    }

    fn children(&self) -> impl Iterator<Item = (Child, Aabb)> {
        (0..8).map(|lane| {
            let bounds = box_in(&self.boxes, lane);
            (Child(self.children[lane]), bounds)
        })
    }
}

impl Structure for BvhWide {
    type Items = Blocks;
    type Scratch = Stacks;

    fn scratch(&self) -> Stacks {
        Stacks::default()
    }

    #[inline(always)]
    fn traverse<I: Isa, V: Visitor>(&self, ray: &Ray, stacks: &mut Stacks, visitor: &mut V) {
        let stack = stacks.one();
        let mut walk = Walk::<I>::new(self, ray);
        while walk.step(self, stack, visitor) {}
    }

    #[inline(always)]
    fn trace<'a, R: Rays<'a>>(&self, batch: &mut R, stacks: &mut Stacks) {
        if !R::WAYS {
            return packets::trace(self, batch, stacks, false);
        }
        let all = 0..batch.rays().len();
        match self.way.unwrap_or_else(|| way::choose(self, batch.rays())) {
            Way::Single => packets::trace(self, batch, stacks, false),
            Way::Packets => packets::trace(self, batch, stacks, true),
            Way::Hybrid if R::GROUPS => {
                run_apart::<Hybrid, _, _>(self, batch, all, stacks);
            }
            Way::Hybrid | Way::Interleaved => {
                run_apart::<Interleaved, _, _>(self, batch, all, stacks);
            }
            Way::Mixed => way::mixed(self, batch, all, stacks, false),
        }
    }

    fn place_bounds(&self, place: u64) -> Option<Aabb> {
        let found = self.children().filter(|(child, _)| child.place() == place);
        found.map(|(_, bounds)| bounds).reduce(Aabb::union)
    }

    fn stats(&self) -> StructureStats {
        let leaves = || self.children().filter(|(child, _)| child.is_leaf());
        StructureStats {
            cells: self.nodes.len() as u64 + leaves().count() as u64,
            empty_cells: 0,
            references: self.filled.iter().map(|count| u64::from(*count)).sum(),
            depth: self.depth,
            longest_list: leaves()
                .map(|(leaf, _)| self.references(leaf))
                .max()
                .unwrap_or(0),
            dims: None,
        }
    }

    fn memory_bytes(&self) -> u64 {
        (size_of_val(self.nodes.as_slice()) + self.filled.len()) as u64
    }

    fn validate(&self, mesh: &Mesh, lanes: &[u32]) -> Result<(), String> {
        validate::validate(self, mesh, lanes)
    }
}

#[cfg(test)]
mod tests;
