//! A tree in the making: subtrees that are grown apart and put together, in an order that does not depend on who grew them.

use crate::geometry::Aabb;

use super::super::items::{LANES, fill};
use super::super::pages;
use super::super::share::BLOCK_BYTES;
use super::PlaneTree;
use super::node::{Node, Oblique};

/// Part of a tree; its root stands apart, since it lies beside its sibling.
#[derive(Debug, Default)]
pub(in super::super) struct Subtree {
    nodes: Vec<Node>,
    obliques: Vec<Oblique>,
    /// The triangle of every lane of every block.
    slots: Vec<u32>,
    /// Triangles in each block.
    filled: Vec<u8>,
}

/// How far a subtree had grown.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Mark([usize; 4]);

impl Subtree {
    /// A leaf of these triangles, which ascend.
    pub fn leaf(&mut self, prims: &[u32]) -> Node {
        let first = self.filled.len();
        for block in prims.chunks(LANES) {
            self.filled.push(block.len() as u8);
            fill(&mut self.slots, block);
        }
        Node::leaf(first as u32, (self.filled.len() - first) as u32)
    }

    /// Room for two children; their descendants are to follow, those of the first first.
    pub fn pair(&mut self) -> u32 {
        self.nodes.extend([Node::EMPTY; 2]);
        self.nodes.len() as u32 - 2
    }

    /// Puts children into their room.
    pub fn set(&mut self, pair: u32, children: [Node; 2]) {
        self.nodes[pair as usize..][..2].copy_from_slice(&children);
    }

    /// A node for an oblique plane.
    pub fn oblique(&mut self, plane: Oblique) -> Node {
        self.obliques.push(plane);
        Node::oblique(self.obliques.len() as u32 - 1)
    }

    /// Its blocks.
    pub fn blocks(&self) -> usize {
        self.filled.len()
    }

    /// Bytes it takes once its blocks are packed.
    pub fn bytes(&self) -> u64 {
        let nodes = size_of_val(self.nodes.as_slice()) + size_of_val(self.obliques.as_slice());
        nodes as u64 + self.filled.len() as u64 * (1 + BLOCK_BYTES)
    }

    /// How far it has grown.
    pub fn mark(&self) -> Mark {
        Mark([
            self.nodes.len(),
            self.obliques.len(),
            self.slots.len(),
            self.filled.len(),
        ])
    }

    /// Takes back what has grown since.
    pub fn rewind(&mut self, mark: Mark) {
        let Mark([nodes, obliques, slots, filled]) = mark;
        self.nodes.truncate(nodes);
        self.obliques.truncate(obliques);
        self.slots.truncate(slots);
        self.filled.truncate(filled);
    }

    /// Appends another subtree with this root; returns its root's node here.
    fn append(&mut self, root: Node, other: &Self) -> Node {
        let [nodes, obliques, blocks] =
            [self.nodes.len(), self.obliques.len(), self.filled.len()].map(|count| count as u32);
        let moved = |node: &Node| node.moved(nodes, blocks, obliques);
        self.nodes.extend(other.nodes.iter().map(moved));
        self.obliques
            .extend(other.obliques.iter().map(|plane| Oblique {
                pair: plane.pair + nodes,
                ..*plane
            }));
        self.slots.extend_from_slice(&other.slots);
        self.filled.extend_from_slice(&other.filled);
        moved(&root)
    }
}

/// What has grown.
#[derive(Debug)]
pub(in super::super) enum Grown {
    /// By one thread.
    Whole(Node, Subtree),
    /// By more: a plane, given for no children, and both sides.
    Split(Node, Box<[Grown; 2]>),
}

impl Grown {
    /// References, nodes and blocks in all.
    fn sizes(&self) -> [usize; 3] {
        match self {
            Self::Whole(_, tree) => [tree.nodes.len(), tree.slots.len(), tree.filled.len()],
            Self::Split(_, sides) => {
                let [a, b] = [sides[0].sizes(), sides[1].sizes()];
                [a[0] + b[0] + 2, a[1] + b[1], a[2] + b[2]]
            }
        }
    }

    fn append_to(self, tree: &mut Subtree) -> Node {
        match self {
            Self::Whole(root, subtree) => tree.append(root, &subtree),
            Self::Split(plane, sides) => {
                let pair = tree.pair();
                let [below, above] = *sides;
                let children = [below.append_to(tree), above.append_to(tree)];
                tree.set(pair, children);
                plane.moved(pair, 0, 0)
            }
        }
    }

    /// The whole tree, over the box that it divides, and the triangle of every lane of every block.
    pub fn finish(self, bounds: Aabb) -> (PlaneTree, Vec<u32>) {
        let [nodes, slots, filled] = self.sizes();
        let mut tree = Subtree {
            nodes: pages::with_capacity(nodes + 2),
            obliques: Vec::new(),
            slots: Vec::with_capacity(slots),
            filled: Vec::with_capacity(filled),
        };
        // The root has a pair of its own, so that no pair lies in two lines of the cache.
        let pair = tree.pair();
        let root = self.append_to(&mut tree);
        tree.set(pair, [root, Node::EMPTY]);
        let plane_tree = PlaneTree {
            nodes: tree.nodes,
            obliques: tree.obliques,
            filled: tree.filled,
            bounds,
        };
        (plane_tree, tree.slots)
    }
}
