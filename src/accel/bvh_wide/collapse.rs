//! The collapse of a binary tree into an eight-ary one of least cost, by dynamic programming.
//!
//! ```text
//! cost of a subtree as at most j children of one node:
//!   C(n, 1) = min( area · blocks · TEST,  area · STEP + C(left, a) + C(right, 8 - a) )      a leaf, or a node
//!   C(n, j) = min( C(n, j - 1),  C(left, a) + C(right, j - a) )
//! ```
//!
//! **Source:** H. Ylitie, T. Karras and S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
//! BVHs", HPG 2017, §3.1. **Differs:** a leaf costs by its blocks of eight.

use crate::geometry::Aabb;
use crate::scene::Mesh;

use super::super::bvh::{BinaryTree, Node as BinaryNode};
use super::super::items::{LANES, fill};
use super::super::pages;
use super::super::slab::Scene;
use super::{BvhWide, Child, Node};

/// Cost of visiting a node.
const STEP: f32 = 1.0;

/// Cost of testing a block, in steps; measured with `moller-trumbore` and `woop`.
const TEST: f32 = 0.8;

/// Most blocks of a leaf that the heuristic may choose.
const MOST_BLOCKS: u32 = 4;

/// Children of a node.
const WIDTH: usize = 8;

/// How a subtree is best spread over at most 1, 2, … 8 children.
#[derive(Clone, Copy, Default)]
struct Best {
    /// Least costs; the last is for a node of its own, without the step.
    cost: [f32; WIDTH],
    /// How many children the left part takes: `TAKE_FEWER` where fewer children cost no more.
    left: [u8; WIDTH],
    /// Whether one child is best a leaf.
    is_leaf: bool,
    references: u32,
}

/// Marks that the last child would stay unused.
const TAKE_FEWER: u8 = 0;

/// Half the surface of a node's box, in `f64` where it cannot overflow.
fn half_area(node: &BinaryNode) -> f64 {
    let d = node.bounds().max.as_dvec3() - node.bounds().min.as_dvec3();
    d.x * d.y + d.y * d.z + d.z * d.x
}

/// The best spread of every subtree.
fn plan(nodes: &[BinaryNode]) -> Vec<Best> {
    let mut plan = vec![Best::default(); nodes.len()];
    let whole = nodes.first().map_or(1.0, half_area).max(f64::MIN_POSITIVE);
    // Children lie behind their parents.
    for (i, node) in nodes.iter().enumerate().rev() {
        // The chance that a ray through the scene meets the node.
        let area = (half_area(node) / whole) as f32;
        plan[i] = if node.is_leaf() {
            Best {
                cost: [area * TEST; WIDTH],
                left: [TAKE_FEWER; WIDTH],
                is_leaf: true,
                references: node.count,
            }
        } else {
            let first = node.first as usize;
            spread(area, &plan[first], &plan[first + 1])
        };
    }
    plan
}

/// The best spread of a subtree from those of its two parts.
fn spread(area: f32, left: &Best, right: &Best) -> Best {
    let references = left.references + right.references;
    let blocks = references.div_ceil(LANES as u32);
    let mut best = Best {
        references,
        ..Best::default()
    };
    // Distributed over j + 1 children.
    for j in 1..WIDTH {
        let (mut least, mut split) = (f32::INFINITY, 1);
        for a in 0..j {
            let cost = left.cost[a] + right.cost[j - 1 - a];
            if cost < least {
                (least, split) = (cost, a as u8 + 1);
            }
        }
        (best.cost[j], best.left[j]) = (least, split);
    }
    let as_node = area * STEP + best.cost[WIDTH - 1];
    let as_leaf = if blocks <= MOST_BLOCKS {
        area * TEST * blocks as f32
    } else {
        f32::INFINITY
    };
    best.is_leaf = blocks <= MOST_BLOCKS && as_leaf <= as_node;
    best.cost[0] = as_leaf.min(as_node);
    for j in 1..WIDTH - 1 {
        if best.cost[j - 1] <= best.cost[j] {
            (best.cost[j], best.left[j]) = (best.cost[j - 1], TAKE_FEWER);
        }
    }
    best
}

/// A wide tree in the making.
struct Collapse<'a> {
    nodes: &'a [BinaryNode],
    references: &'a [u32],
    plan: &'a [Best],
    wide: Vec<Node>,
    slots: Vec<u32>,
    filled: Vec<u8>,
    depth: u32,
}

impl BvhWide {
    /// Collapses `tree`, each of whose leaves holds one reference; also returns the triangle of every lane of every block.
    pub(super) fn collapse(tree: &BinaryTree, mesh: &Mesh) -> (Self, Vec<u32>) {
        let plan = plan(&tree.nodes);
        let mut collapse = Collapse {
            nodes: &tree.nodes,
            references: &tree.references,
            plan: &plan,
            wide: pages::with_capacity(tree.nodes.len() / 12),
            slots: Vec::with_capacity(tree.references.len() * 2),
            filled: Vec::with_capacity(tree.references.len() / 4),
            depth: 0,
        };
        let root = if tree.nodes.is_empty() {
            Child::NONE
        } else {
            collapse.child(0, 0)
        };
        let wide = Self {
            nodes: collapse.wide,
            root,
            scene: Scene::new(mesh.bounds()),
            filled: collapse.filled,
            depth: collapse.depth,
            way: None,
        };
        (wide, collapse.slots)
    }
}

impl Collapse<'_> {
    /// Makes the child that subtree `at` becomes when it takes one lane.
    fn child(&mut self, at: usize, depth: u32) -> Child {
        if self.plan[at].is_leaf {
            self.depth = self.depth.max(depth);
            return self.leaf(at);
        }
        let mut lanes = Vec::with_capacity(WIDTH);
        let (first, split) = (self.nodes[at].first as usize, self.plan[at].left[WIDTH - 1]);
        self.gather(first, usize::from(split), &mut lanes);
        self.gather(first + 1, WIDTH - usize::from(split), &mut lanes);
        // Where the order does not come from the ray, large boxes are likely to be met.
        lanes.sort_by(|a, b| half_area(&self.nodes[*b]).total_cmp(&half_area(&self.nodes[*a])));
        let index = self.wide.len();
        self.wide.push(Node::EMPTY);
        for (lane, at) in lanes.into_iter().enumerate() {
            let child = self.child(at, depth + 1);
            let bounds: Aabb = self.nodes[at].bounds();
            self.wide[index].set(lane, child, &bounds);
        }
        Child::node(index)
    }

    /// Lists the subtrees that `at` becomes when it is spread over at most `room` lanes.
    fn gather(&self, at: usize, mut room: usize, lanes: &mut Vec<usize>) {
        let best = &self.plan[at];
        while room > 1 && best.left[room - 1] == TAKE_FEWER {
            room -= 1;
        }
        if room == 1 {
            lanes.push(at);
            return;
        }
        let (first, split) = (
            self.nodes[at].first as usize,
            usize::from(best.left[room - 1]),
        );
        self.gather(first, split, lanes);
        self.gather(first + 1, room - split, lanes);
    }

    /// Fills blocks with the triangles below `at`, each once, the lowest index first.
    fn leaf(&mut self, at: usize) -> Child {
        let mut prims = Vec::with_capacity(self.plan[at].references as usize);
        self.list(at, &mut prims);
        prims.sort_unstable();
        prims.dedup();
        let first = self.filled.len();
        for block in prims.chunks(LANES) {
            self.filled.push(block.len() as u8);
            fill(&mut self.slots, block);
        }
        Child::leaf(first, self.filled.len() - first)
    }

    fn list(&self, at: usize, prims: &mut Vec<u32>) {
        let node = &self.nodes[at];
        let first = node.first as usize;
        if node.is_leaf() {
            prims.extend(&self.references[first..][..node.count as usize]);
        } else {
            self.list(first, prims);
            self.list(first + 1, prims);
        }
    }
}
