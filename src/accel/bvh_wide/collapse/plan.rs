//! How a binary tree is best spread over nodes of eight lanes: of least cost, by dynamic programming from the bottom up.
//!
//! ```text
//! cost of a subtree as at most j children of one node:
//!   C(n, 1) = min( area · blocks · TEST,  area · STEP + C(left, a) + C(right, 8 - a) )      a leaf, or a node
//!   C(n, j) = min( C(n, j - 1),  C(left, a) + C(right, j - a) )
//! ```
//!
//! **Source:** H. Ylitie, T. Karras and S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
//! BVHs", HPG 2017, §3.1. **Differs:** a leaf costs by its blocks of eight.
//!
//! A leaf of the binary tree may hold several references, up to a block; it stays whole.

use std::ops::Range;

use super::super::super::bvh::{BinaryTree, Node};
use super::super::super::items::LANES;
use super::super::super::parallel;
use super::super::super::sah::half_area;

/// Cost of visiting a node.
const STEP: f32 = 1.0;

/// Cost of testing a block, in steps; measured with `moller-trumbore` and `woop`.
const TEST: f32 = 0.8;

/// Most blocks of a leaf that the heuristic may choose.
pub(super) const MOST_BLOCKS: usize = 4;

/// Children of a node.
pub(super) const WIDTH: usize = 8;

/// Subtrees with fewer binary nodes are one thread's work.
pub(super) const APART: usize = 1 << 12;

/// A subtree of the binary tree: its root, and where what is below it ends; see [`BinaryTree::nodes`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Subtree {
    pub root: usize,
    pub end: usize,
}

impl Subtree {
    pub const NONE: Self = Self { root: 0, end: 0 };

    /// All of a tree that is not empty.
    pub fn whole(nodes: &[Node]) -> Self {
        Self {
            root: 0,
            end: nodes.len(),
        }
    }

    /// Both halves of one that is no leaf.
    pub fn halves(self, nodes: &[Node]) -> [Self; 2] {
        let first = nodes[self.root].first as usize;
        let second = &nodes[first + 1];
        let middle = if second.is_leaf() {
            self.end
        } else {
            second.first as usize
        };
        let half = |root, end| Self { root, end };
        [half(first, middle), half(first + 1, self.end)]
    }

    /// Nodes below its root.
    pub fn below(self, nodes: &[Node]) -> usize {
        let root = &nodes[self.root];
        if root.is_leaf() {
            0
        } else {
            self.end - root.first as usize
        }
    }

    /// Where its references begin and end: those of a subtree lie side by side.
    pub fn references(self, nodes: &[Node]) -> Range<usize> {
        let (mut first, mut last) = (&nodes[self.root], &nodes[self.root]);
        while !first.is_leaf() {
            first = &nodes[first.first as usize];
        }
        while !last.is_leaf() {
            last = &nodes[last.first as usize + 1];
        }
        first.first as usize..(last.first + last.count) as usize
    }
}

/// How a subtree is best spread, in four bits each: whether it is a leaf where it takes one lane; and how many the left half
/// takes of 2, 3, … 8 lanes, [`Choice::FEWER`] where fewer lanes cost no more.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Choice(u32);

impl Choice {
    /// The last lane would stay unused.
    pub const FEWER: u32 = 0;
    const LEAF: Self = Self(1);

    pub fn is_leaf(self) -> bool {
        self.0 & 1 != 0
    }

    /// What the left half takes of this many lanes.
    pub fn left(self, lanes: usize) -> usize {
        (self.0 >> (4 * (lanes - 1)) & 15) as usize
    }
}

/// What a subtree costs over at most 1, 2, … 8 lanes; the last is for a node of its own, without the step.
type Costs = [f32; WIDTH];

/// How a subtree is best spread.
struct Spread {
    choice: Choice,
    costs: Costs,
    /// Most lanes that it can take.
    most: usize,
    references: usize,
}

/// What is needed to choose.
struct Planner<'a> {
    nodes: &'a [Node],
    /// Half the surface of the scene's box.
    whole: f64,
}

impl<'a> Planner<'a> {
    /// For a tree that is not empty.
    fn new(nodes: &'a [Node]) -> Self {
        Self {
            nodes,
            whole: half_area(&nodes[0].bounds()).max(f64::MIN_POSITIVE),
        }
    }

    /// The choice and the costs of a subtree; the choices of what is below its root go to `below`.
    fn plan(&self, subtree: Subtree, below: &mut [Choice]) -> Spread {
        let node = &self.nodes[subtree.root];
        // The chance that a ray through the scene meets the node.
        let area = (half_area(&node.bounds()) / self.whole) as f32;
        if node.is_leaf() {
            return Spread {
                choice: Choice::LEAF,
                costs: [area * TEST; WIDTH],
                most: 1,
                references: node.count as usize,
            };
        }
        let halves = subtree.halves(self.nodes);
        let is_large = below.len() >= APART;
        let (pair, below) = below.split_at_mut(2);
        let (left, right) = below.split_at_mut(halves[0].end - node.first as usize - 2);
        let mut first = || self.plan(halves[0], left);
        let mut second = || self.plan(halves[1], right);
        let (left, right) = if is_large {
            rayon::join(first, second)
        } else {
            (first(), second())
        };
        (pair[0], pair[1]) = (left.choice, right.choice);
        spread(area, &left, &right)
    }
}

/// The best spread of a subtree from those of its two halves.
fn spread(area: f32, left: &Spread, right: &Spread) -> Spread {
    let references = left.references + right.references;
    // Behind as many as the left half takes at most: more lanes than the node has cost infinitely much.
    let mut padded = [f32::INFINITY; 2 * WIDTH];
    padded[WIDTH..].copy_from_slice(&right.costs);
    let mut costs = [f32::INFINITY; WIDTH];
    let mut taken = [Choice::FEWER; WIDTH];
    for a in 1..=left.most.min(WIDTH - 1) {
        let right = &padded[WIDTH - a..][..WIDTH];
        for lane in 0..WIDTH {
            let cost = left.costs[a - 1] + right[lane];
            let is_less = cost < costs[lane];
            costs[lane] = if is_less { cost } else { costs[lane] };
            taken[lane] = if is_less { a as u32 } else { taken[lane] };
        }
    }
    // A node of its own may leave lanes unused, but not divide itself into fewer parts than two.
    for j in 2..WIDTH {
        if costs[j - 1] <= costs[j] {
            (costs[j], taken[j]) = (costs[j - 1], taken[j - 1]);
        }
    }
    let blocks = references.div_ceil(LANES);
    let as_node = area * STEP + costs[WIDTH - 1];
    let as_leaf = if blocks <= MOST_BLOCKS {
        area * TEST * blocks as f32
    } else {
        f32::INFINITY
    };
    let is_leaf = as_leaf <= as_node && blocks <= MOST_BLOCKS;
    costs[0] = as_leaf.min(as_node);
    for j in (1..WIDTH - 1).rev() {
        if costs[j - 1] <= costs[j] {
            taken[j] = Choice::FEWER;
        }
    }
    for j in 1..WIDTH - 1 {
        costs[j] = costs[j].min(costs[j - 1]);
    }
    taken[0] = u32::from(is_leaf);
    let bits = (0..WIDTH).fold(0, |bits, j| bits | taken[j] << (4 * j));
    Spread {
        choice: Choice(bits),
        costs,
        most: left.most + right.most,
        references,
    }
}

/// How each subtree of `tree`, which is not empty, is best spread: the choices lie as its nodes do.
pub(super) fn choices(tree: &BinaryTree) -> Vec<Choice> {
    let nodes = tree.nodes.as_slice();
    let planner = Planner::new(nodes);
    let mut choices = parallel::filled(nodes.len(), Choice::LEAF);
    let (root, below) = choices.split_at_mut(1);
    root[0] = planner.plan(Subtree::whole(nodes), below).choice;
    choices
}

#[cfg(test)]
mod tests {
    use super::super::super::super::bvh::{Build, binary, grouped};
    use super::super::super::super::testbed::{mesh, soup};
    use super::*;

    /// The least cost of spreading a subtree over so many lanes, by trying everything; a node of its own takes one.
    fn least(tree: &BinaryTree, at: usize, lanes: usize) -> f32 {
        let node = &tree.nodes[at];
        let area = (half_area(&node.bounds()) / half_area(&tree.nodes[0].bounds())) as f32;
        if node.is_leaf() {
            return area * TEST;
        }
        let first = node.first as usize;
        let divided = |lanes: usize| {
            let cost = |a: usize| least(tree, first, a) + least(tree, first + 1, lanes - a);
            (1..lanes).map(cost).fold(f32::INFINITY, f32::min)
        };
        let blocks = count(tree, at).div_ceil(LANES);
        let leaf = if blocks <= MOST_BLOCKS {
            area * TEST * blocks as f32
        } else {
            f32::INFINITY
        };
        let one = leaf.min(area * STEP + divided(WIDTH));
        if lanes == 1 {
            one
        } else {
            one.min(divided(lanes))
        }
    }

    fn count(tree: &BinaryTree, at: usize) -> usize {
        let node = &tree.nodes[at];
        let first = node.first as usize;
        if node.is_leaf() {
            node.count as usize
        } else {
            count(tree, first) + count(tree, first + 1)
        }
    }

    #[test]
    fn the_cost_is_the_least_of_all_ways_to_spread_a_tree() {
        for (triangles, size) in [(2, 0.1), (5, 0.1), (12, 0.02), (12, 1.0), (14, 0.3)] {
            for seed in 0..6 {
                let mesh = mesh(&soup(triangles, size, seed));
                assert_least(&binary(&mesh, Build::Binned, 1));
            }
        }
        for (triangles, size) in [(9, 0.1), (24, 0.02), (24, 1.0), (40, 0.3)] {
            for seed in 0..6 {
                let mesh = mesh(&soup(triangles, size, seed));
                let tree = grouped(&mesh, Build::Binned);
                let most = tree.nodes.iter().filter(|node| node.is_leaf());
                assert!(most.map(|node| node.count).max() > Some(1));
                assert_least(&tree);
            }
        }
    }

    fn assert_least(tree: &BinaryTree) {
        let planner = Planner::new(&tree.nodes);
        let mut below = vec![Choice::LEAF; tree.nodes.len() - 1];
        let costs = planner.plan(Subtree::whole(&tree.nodes), &mut below).costs;
        for lanes in 1..WIDTH {
            let least = least(tree, 0, lanes);
            assert!((costs[lanes - 1] - least).abs() <= 1e-5 * least);
        }
    }
}
