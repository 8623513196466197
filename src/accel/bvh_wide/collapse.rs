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
//!
//! Both the choice, from the bottom up, and the making of nodes, from the top down, are shared among threads. Small subtrees
//! are made apart and put behind each other, in the order in which they were found, whatever the number of threads.

use rayon::prelude::*;

use crate::scene::Mesh;

use super::super::bvh::{BinaryTree, Node as BinaryNode};
use super::super::items::{LANES, fill};
use super::super::pages;
use super::super::sah::half_area;
use super::super::slab::Scene;
use super::{BvhWide, Child, Node};

/// Cost of visiting a node.
const STEP: f32 = 1.0;

/// Cost of testing a block, in steps; measured with `moller-trumbore` and `woop`.
const TEST: f32 = 0.8;

/// Most blocks of a leaf that the heuristic may choose.
const MOST_BLOCKS: usize = 4;

/// Children of a node.
const WIDTH: usize = 8;

/// Subtrees with fewer binary nodes are one thread's work.
const APART: usize = 1 << 14;

/// A subtree of the binary tree: its root, and where what is below it ends; see [`BinaryTree::nodes`].
#[derive(Debug, Clone, Copy)]
struct Subtree {
    root: usize,
    end: usize,
}

impl Subtree {
    const NONE: Self = Self { root: 0, end: 0 };

    /// Both halves of one that is no leaf.
    fn halves(self, nodes: &[BinaryNode]) -> [Self; 2] {
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
    fn below(self, nodes: &[BinaryNode]) -> usize {
        let root = &nodes[self.root];
        if root.is_leaf() {
            0
        } else {
            self.end - root.first as usize
        }
    }

    /// References, of which each leaf holds one.
    fn references(self, nodes: &[BinaryNode]) -> usize {
        self.below(nodes) / 2 + 1
    }
}

/// How a subtree is best spread, in four bits each: whether it is a leaf where it takes one lane; and how many the left half
/// takes of 2, 3, … 8 lanes, [`Choice::FEWER`] where fewer lanes cost no more.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Choice(u32);

impl Choice {
    /// The last lane would stay unused.
    const FEWER: u32 = 0;
    const LEAF: Self = Self(1);

    fn is_leaf(self) -> bool {
        self.0 & 1 != 0
    }

    /// What the left half takes of this many lanes.
    fn left(self, lanes: usize) -> usize {
        (self.0 >> (4 * (lanes - 1)) & 15) as usize
    }
}

/// What a subtree costs over at most 1, 2, … 8 lanes; the last is for a node of its own, without the step.
type Costs = [f32; WIDTH];

/// What is needed to choose.
struct Planner<'a> {
    nodes: &'a [BinaryNode],
    /// Half the surface of the scene's box.
    whole: f64,
}

impl Planner<'_> {
    /// The choice and the costs of a subtree; the choices of what is below its root go to `below`.
    fn plan(&self, subtree: Subtree, below: &mut [Choice]) -> (Choice, Costs) {
        let node = &self.nodes[subtree.root];
        // The chance that a ray through the scene meets the node.
        let area = (half_area(&node.bounds()) / self.whole) as f32;
        if node.is_leaf() {
            return (Choice::LEAF, [area * TEST; WIDTH]);
        }
        let halves = subtree.halves(self.nodes);
        let is_large = below.len() >= APART;
        let (pair, below) = below.split_at_mut(2);
        let (left, right) = below.split_at_mut(halves[0].below(self.nodes));
        let mut first = || self.plan(halves[0], left);
        let mut second = || self.plan(halves[1], right);
        let (left, right) = if is_large {
            rayon::join(first, second)
        } else {
            (first(), second())
        };
        (pair[0], pair[1]) = (left.0, right.0);
        let references = halves.map(|half| half.references(self.nodes));
        spread(area, references, &left.1, &right.1)
    }
}

/// The best spread of a subtree from those of its two halves, which have so many references.
fn spread(area: f32, references: [usize; 2], left: &Costs, right: &Costs) -> (Choice, Costs) {
    // No half needs more lanes than it has references, and most subtrees are small.
    let [most_left, most_right] = references.map(|count| count.min(WIDTH - 1));
    let mut costs = [f32::INFINITY; WIDTH];
    let mut taken = [Choice::FEWER; WIDTH];
    for a in 1..=most_left {
        for b in 1..=most_right.min(WIDTH - a) {
            let cost = left[a - 1] + right[b - 1];
            if cost < costs[a + b - 1] {
                (costs[a + b - 1], taken[a + b - 1]) = (cost, a as u32);
            }
        }
    }
    // A node of its own may leave lanes unused, but not divide itself into fewer parts than two.
    for j in 2..WIDTH {
        if costs[j - 1] <= costs[j] {
            (costs[j], taken[j]) = (costs[j - 1], taken[j - 1]);
        }
    }
    let blocks = (references[0] + references[1]).div_ceil(LANES);
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
    (Choice(bits), costs)
}

/// Subtrees that together become the lanes of a node.
struct Lanes {
    subtrees: [Subtree; WIDTH],
    count: usize,
}

/// Part of a wide tree in the making.
#[derive(Debug, Default)]
struct Part {
    nodes: Vec<Node>,
    slots: Vec<u32>,
    filled: Vec<u8>,
    depth: u32,
    /// Subtrees with fewer binary nodes are put apart.
    least: usize,
    apart: Vec<Apart>,
}

/// A subtree to be made later, for a lane of a node.
#[derive(Debug, Clone, Copy)]
struct Apart {
    subtree: Subtree,
    depth: u32,
    node: usize,
    lane: usize,
}

impl Part {
    /// Appends what was made apart, and puts its root into its lane.
    fn append(&mut self, apart: &Apart, child: Child, part: &Self) {
        let (nodes, blocks) = (self.nodes.len() as u32, self.filled.len() as u32);
        self.nodes.extend(part.nodes.iter().map(|node| {
            Node {
                boxes: node.boxes,
                children: node
                    .children
                    .map(|child| Child(child).moved(nodes, blocks).0),
            }
        }));
        self.slots.extend_from_slice(&part.slots);
        self.filled.extend_from_slice(&part.filled);
        self.depth = self.depth.max(part.depth);
        self.nodes[apart.node].children[apart.lane] = child.moved(nodes, blocks).0;
    }
}

impl Child {
    /// The same behind so many more nodes and blocks.
    fn moved(self, nodes: u32, blocks: u32) -> Self {
        if self == Self::NONE {
            self
        } else if self.is_leaf() {
            Self(self.0 + (blocks << 3))
        } else {
            Self(self.0 + nodes)
        }
    }
}

/// A binary tree and how it is best spread.
struct Collapse<'a> {
    nodes: &'a [BinaryNode],
    references: &'a [u32],
    choices: Vec<Choice>,
}

impl BvhWide {
    /// Collapses `tree`, each of whose leaves holds one reference; also returns the triangle of every lane of every block.
    pub(super) fn collapse(tree: &BinaryTree, mesh: &Mesh) -> (Self, Vec<u32>) {
        let mut part = Part {
            nodes: pages::with_capacity(tree.nodes.len() / 12),
            slots: pages::with_capacity(tree.references.len() * 2),
            filled: Vec::with_capacity(tree.references.len() / 4),
            ..Part::default()
        };
        let root = if tree.nodes.is_empty() {
            Child::NONE
        } else {
            Collapse::planned(tree).all(&mut part)
        };
        let wide = Self {
            nodes: part.nodes,
            root,
            scene: Scene::new(mesh.bounds()),
            filled: part.filled,
            depth: part.depth,
            way: None,
        };
        (wide, part.slots)
    }
}

impl<'a> Collapse<'a> {
    /// Chooses how `tree`, which is not empty, is spread.
    fn planned(tree: &'a BinaryTree) -> Self {
        let nodes = tree.nodes.as_slice();
        let planner = Planner {
            nodes,
            whole: half_area(&nodes[0].bounds()).max(f64::MIN_POSITIVE),
        };
        let mut choices = pages::filled(nodes.len(), Choice::LEAF);
        let (root, below) = choices.split_at_mut(1);
        let end = nodes.len();
        (root[0], _) = planner.plan(Subtree { root: 0, end }, below);
        Self {
            nodes,
            references: &tree.references,
            choices,
        }
    }
}

impl Collapse<'_> {
    /// Makes the whole tree: first the top, then the subtrees that it puts apart.
    fn all(&self, top: &mut Part) -> Child {
        let whole = Subtree {
            root: 0,
            end: self.nodes.len(),
        };
        if self.nodes.len() >= APART {
            top.least = APART;
        }
        let root = self.child(whole, 0, top);
        top.least = 0;
        let all_apart = std::mem::take(&mut top.apart);
        if rayon::current_num_threads() == 1 {
            // The same without the copies.
            for apart in all_apart {
                let child = self.child(apart.subtree, apart.depth, top);
                top.nodes[apart.node].children[apart.lane] = child.0;
            }
            return root;
        }
        let parts: Vec<(Child, Part)> = all_apart
            .par_iter()
            .map(|apart| {
                let mut part = Part::default();
                (self.child(apart.subtree, apart.depth, &mut part), part)
            })
            .collect();
        for (apart, (child, part)) in all_apart.iter().zip(&parts) {
            top.append(apart, *child, part);
        }
        root
    }

    /// Makes the child that `subtree` becomes when it takes one lane.
    fn child(&self, subtree: Subtree, depth: u32, part: &mut Part) -> Child {
        let choice = self.choices[subtree.root];
        if choice.is_leaf() {
            part.depth = part.depth.max(depth);
            return self.leaf(subtree, part);
        }
        let mut lanes = Lanes {
            subtrees: [Subtree::NONE; WIDTH],
            count: 0,
        };
        self.divide(subtree, WIDTH, &mut lanes);
        // Where the order does not come from the ray, large boxes are likely to be met.
        let mut sorted = lanes
            .subtrees
            .map(|s| (half_area(&self.nodes[s.root].bounds()), s));
        sorted[..lanes.count].sort_by(|a, b| b.0.total_cmp(&a.0));
        let node = part.nodes.len();
        part.nodes.push(Node::EMPTY);
        for (lane, (_, subtree)) in sorted[..lanes.count].iter().enumerate() {
            let below = subtree.below(self.nodes);
            let child = if below < part.least && !self.choices[subtree.root].is_leaf() {
                part.apart.push(Apart {
                    subtree: *subtree,
                    depth: depth + 1,
                    node,
                    lane,
                });
                Child::NONE
            } else {
                self.child(*subtree, depth + 1, part)
            };
            part.nodes[node].set(lane, child, &self.nodes[subtree.root].bounds());
        }
        Child::node(node)
    }

    /// Lists what both halves of `subtree` become when they take so many lanes together.
    fn divide(&self, subtree: Subtree, room: usize, lanes: &mut Lanes) {
        let left = self.choices[subtree.root].left(room);
        let [first, second] = subtree.halves(self.nodes);
        self.gather(first, left, lanes);
        self.gather(second, room - left, lanes);
    }

    /// Lists what `subtree` becomes when it is spread over at most `room` lanes.
    fn gather(&self, subtree: Subtree, mut room: usize, lanes: &mut Lanes) {
        let choice = self.choices[subtree.root];
        while room > 1 && choice.left(room) == Choice::FEWER as usize {
            room -= 1;
        }
        if room == 1 {
            lanes.subtrees[lanes.count] = subtree;
            lanes.count += 1;
        } else {
            self.divide(subtree, room, lanes);
        }
    }

    /// Fills blocks with the triangles of `subtree`, each once, the lowest index first.
    fn leaf(&self, subtree: Subtree, part: &mut Part) -> Child {
        // The references of a subtree lie side by side.
        let mut first = &self.nodes[subtree.root];
        while !first.is_leaf() {
            first = &self.nodes[first.first as usize];
        }
        let count = subtree.references(self.nodes);
        let mut prims = [0; MOST_BLOCKS * LANES];
        let prims = &mut prims[..count];
        prims.copy_from_slice(&self.references[first.first as usize..][..count]);
        prims.sort_unstable();
        let mut kept = 1;
        for i in 1..count {
            if prims[i] != prims[kept - 1] {
                prims[kept] = prims[i];
                kept += 1;
            }
        }
        let first = part.filled.len();
        for block in prims[..kept].chunks(LANES) {
            part.filled.push(block.len() as u8);
            fill(&mut part.slots, block);
        }
        Child::leaf(first, part.filled.len() - first)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::Structure;
    use super::super::super::bvh::{Build, binary};
    use super::super::super::testbed::{assert_same_on_threads, mesh, soup};
    use super::*;

    #[test]
    fn one_thread_and_many_collapse_to_the_same_tree() {
        // Large enough for subtrees that are made apart, with cut triangles too.
        let mesh = mesh(&soup(30_000, 0.05, 4));
        for build in [Build::Binned, Build::SbvhReinsert] {
            let tree = binary(&mesh, build, 1);
            assert!(tree.nodes.len() > 3 * APART);
            let (wide, slots) = BvhWide::collapse(&tree, &mesh);
            assert_eq!(wide.validate(&mesh, &slots), Ok(()));
            assert_same_on_threads(|| BvhWide::collapse(&tree, &mesh));
        }
    }

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
        let leaf = area * TEST * (count(tree, at).div_ceil(LANES)) as f32;
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
            1
        } else {
            count(tree, first) + count(tree, first + 1)
        }
    }

    #[test]
    fn the_cost_is_the_least_of_all_ways_to_spread_a_tree() {
        for (triangles, size) in [(2, 0.1), (5, 0.1), (12, 0.02), (12, 1.0), (14, 0.3)] {
            for seed in 0..6 {
                let mesh = mesh(&soup(triangles, size, seed));
                let tree = binary(&mesh, Build::Binned, 1);
                let planner = Planner {
                    nodes: &tree.nodes,
                    whole: half_area(&tree.nodes[0].bounds()),
                };
                let mut below = vec![Choice::LEAF; tree.nodes.len() - 1];
                let end = tree.nodes.len();
                let (_, costs) = planner.plan(Subtree { root: 0, end }, &mut below);
                for lanes in 1..WIDTH {
                    let least = least(&tree, 0, lanes);
                    assert!((costs[lanes - 1] - least).abs() <= 1e-5 * least);
                }
            }
        }
    }
}
