//! The reinsertion of subtrees: a finished tree is made better by moving subtrees to where they enlarge boxes least.
//!
//! ```text
//!         o                 o          x moves beside y: its parent p goes with it, its sibling s takes
//!       /   \             /   \        p's place. Ids of nodes stay, only links change.
//!      p     o           s     o
//!     / \   / \               / \
//!    x   s y   z             p   z
//!                           / \
//!                          x   y
//! ```
//!
//! In each pass the nodes with the largest boxes look for their best places, all in the tree as it is at the begin of the
//! pass and hence in parallel; then they move one after the other, those first that gain most, and what no longer
//! gains after the others have moved goes back. So a pass never makes the tree worse, and the result does not
//! depend on the number of threads.
//!
//! **Source:** J. Bittner, M. Hapala and V. Havran, "Fast Insertion-Based Optimization of Bounding Volume Hierarchies",
//! 2013; D. Meister and J. Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", 2018.
//! **Differs:** moves are checked when they are made, instead of locking what they touch; the work is bounded by the
//! number of passes and of nodes a pass.
//!
//! **Gains**, one thread, of the SAH cost of the binary tree, and of rays a second through `bvh-wide` (bounce, random); the
//! build takes twice as long:
//!
//! | | binned | reinsert | sbvh | sbvh-reinsert | reinsert to binned | sbvh-reinsert to sbvh |
//! |---|---|---|---|---|---|---|
//! | Stanford bunny | 32.6 | 32.5 | 32.5 | 32.4 | 1.01, 1.00 | 1.00, 1.00 |
//! | `plant` | 179 | 172 | 145 | 140 | 1.06, 1.05 | 1.03, 1.02 |
//! | Crytek Sponza | 93 | 75 | 74 | 67 | 1.08, 1.08 | 1.03, 1.06 |
//! | `sphereflake:4` | 9.0 | 6.4 | 8.9 | 6.4 | 1.07, 0.94 | 1.07, 0.94 |
//! | `city:300` | 33.8 | 29.8 | 30.9 | 29.6 | 1.00, 0.99 | 1.04, 1.01 |
//!
//! So it pays on architecture and plants; a mesh of small, even triangles is already split well.
//!
//! With [`Work::TOP`] on leaves of up to eight, for a tenth to a fifth of the build, where nothing moves 2 %, rays a second through
//! `bvh-wide` (primary, bounce, random; `moller-trumbore`, one thread, an AMD EPYC with AVX-512): Crytek Sponza 1.01, 1.10, 1.09;
//! kitchen 0.95, 1.05, 1.04; `city:300` 0.99, 1.05, 1.04; CAD counter 1.00, 1.01, 1.02; `sphereflake:4`, which is left as it was
//! since, 0.99, 1.01, 0.98.

use rayon::prelude::*;

use super::super::parallel::{self, MANY};
use super::super::stack::MAX_DEPTH;
use super::reference::Bounds;
use super::{BinaryTree, Node, validate};

/// Passes over the tree. Three bring about nine tenths of what ten do: of what they save in SAH cost, 87 % on `plant`, 93 %
/// on the Crytek Sponza and 99 % on `sphereflake:4`.
const PASSES: usize = 3;

/// Searches that one task does: each takes microseconds.
const SEARCHES: usize = 64;

/// How much work is done.
#[derive(Debug, Clone, Copy)]
pub(super) struct Work {
    /// One node in so many looks for a better place in a pass: large boxes cost most.
    part: usize,
    /// The share that a pass must take off the areas ([`Links::area`]) for another to follow, if any; where the first does not,
    /// the tree stays as it was.
    least: Option<f64>,
}

impl Work {
    /// On the Crytek Sponza four passes of all nodes come 1 % lower and take ten times as long.
    pub const FULL: Self = Self {
        part: 8,
        least: None,
    };

    /// Where a tree is to be built fast: the first pass takes 15 % off the Crytek Sponza and the kitchen, 6 % off the CAD counter,
    /// 2.5 % off `city:300`, 1 % off `sphereflake:4`, a thousandth off scanned meshes (Stanford bunny, armadillo, Nefertiti),
    /// nothing off soups.
    pub const TOP: Self = Self {
        part: 32,
        least: Some(0.015),
    };
}

/// Most places that a node looks at: where all boxes overlap, nothing bounds the search.
const PLACES: usize = 2048;

/// No node.
const NONE: u32 = u32::MAX;

/// A node with links in all directions.
#[derive(Debug, Clone, Copy)]
struct Linked {
    bounds: Bounds,
    area: f32,
    parent: u32,
    /// [`NONE`] for leaves.
    children: [u32; 2],
}

impl Linked {
    fn is_leaf(&self) -> bool {
        self.children[0] == NONE
    }
}

/// `tree` after its subtrees were moved.
pub(super) fn optimised(tree: BinaryTree, work: Work) -> BinaryTree {
    if tree.nodes.is_empty() {
        return tree;
    }
    let mut links = Links::of(&tree.nodes);
    let mut area = links.area();
    for pass in 0..PASSES {
        let gain = links.pass(work.part);
        let before = std::mem::replace(&mut area, links.area());
        let is_enough = |least| before - area > least * before;
        if gain > 0.0 && work.least.is_none_or(is_enough) {
            continue;
        }
        if pass == 0 {
            return tree;
        }
        break;
    }
    let moved = links.tree(&tree);
    // What is moved can come to lie too deep.
    let is_deep = validate::depth(&moved.nodes) as usize > MAX_DEPTH;
    if is_deep { tree } else { moved }
}

/// Where a node would better be.
#[derive(Debug, Clone, Copy)]
struct Move {
    node: u32,
    to: u32,
    /// By how much the areas of all nodes together would shrink.
    gain: f32,
}

/// A tree that can be changed. The root is node 0.
struct Links {
    nodes: Vec<Linked>,
    scale: f32,
}

impl Links {
    fn of(nodes: &[Node]) -> Self {
        let scale = nodes
            .first()
            .map_or(1.0, |root| Bounds::from(root.bounds()).scale());
        let mut linked = parallel::map(nodes.len(), MANY, |i| {
            let node = &nodes[i];
            let bounds = Bounds::from(node.bounds());
            Linked {
                bounds,
                area: bounds.half_area(scale),
                parent: NONE,
                children: if node.is_leaf() {
                    [NONE; 2]
                } else {
                    [node.first, node.first + 1]
                },
            }
        });
        for id in 0..linked.len() {
            for child in linked[id].children {
                if child != NONE {
                    linked[child as usize].parent = id as u32;
                }
            }
        }
        Self {
            nodes: linked,
            scale,
        }
    }

    fn node(&self, id: u32) -> &Linked {
        &self.nodes[id as usize]
    }

    fn sibling(&self, id: u32) -> u32 {
        let [a, b] = self.node(self.node(id).parent).children;
        if a == id { b } else { a }
    }

    /// Whether a node can move: it has a grandparent.
    fn can_move(&self, id: u32) -> bool {
        let parent = self.node(id).parent;
        parent != NONE && self.node(parent).parent != NONE
    }

    /// The areas of all nodes together, but those of more than half the root's: few, and children of the root once the tree is
    /// collapsed into one of eight children a node. Nearly all that can be taken off the sphereflake is of these.
    fn area(&self) -> f64 {
        let most = 0.5 * self.node(0).area;
        let areas = self.nodes.iter().map(|node| node.area);
        areas.filter(|area| *area <= most).map(f64::from).sum()
    }

    /// Moves those of one node in `part` that gain; by how much the areas of all nodes together shrink.
    fn pass(&mut self, part: usize) -> f64 {
        let mut candidates: Vec<u32> = (0..self.nodes.len() as u32)
            .into_par_iter()
            .filter(|&id| self.can_move(id))
            .collect();
        let count = self.nodes.len().div_ceil(part);
        if candidates.len() > count {
            // The largest first; equals by their ids, so that the choice is the same in every run.
            let order = |a: &u32, b: &u32| {
                let areas = [b, a].map(|id| self.node(*id).area);
                areas[0].total_cmp(&areas[1]).then(a.cmp(b))
            };
            candidates.select_nth_unstable_by(count, order);
            candidates.truncate(count);
        }
        let best = parallel::map(candidates.len(), SEARCHES, |i| {
            self.best_move(candidates[i])
        });
        let mut moves: Vec<Move> = best.into_iter().flatten().collect();
        moves.par_sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.node.cmp(&b.node)));
        moves.into_iter().map(|next| self.try_move(next)).sum()
    }

    /// The place of the greatest gain for a node that can move, found by branch and bound.
    fn best_move(&self, id: u32) -> Option<Move> {
        let moving = self.node(id);
        let parent = moving.parent;
        let mut best = Move {
            node: id,
            to: NONE,
            gain: 0.0,
        };
        // What is gained if the node is taken out, up to the pivot: the area of its parent, and what boxes above shrink.
        let mut gain = self.node(parent).area;
        let mut sibling = self.sibling(id);
        let mut shrunk = self.node(sibling).bounds;
        let mut pivot = parent;
        let mut open: Vec<(f32, u32)> = Vec::with_capacity(64);
        let mut places = 0;
        loop {
            // Places below the pivot's other child.
            open.push((gain, sibling));
            while let Some((gain, at)) = open.pop() {
                if gain - moving.area <= best.gain || places > PLACES {
                    continue;
                }
                places += 1;
                let node = self.node(at);
                let left = gain - node.bounds.union(moving.bounds).half_area(self.scale);
                if left > best.gain {
                    (best.to, best.gain) = (at, left);
                }
                if !node.is_leaf() {
                    open.extend(node.children.map(|child| (left + node.area, child)));
                }
            }
            if pivot != parent {
                shrunk = shrunk.union(self.node(sibling).bounds);
                gain += self.node(pivot).area - shrunk.half_area(self.scale);
            }
            if self.node(pivot).parent == NONE || places > PLACES {
                break;
            }
            sibling = self.sibling(pivot);
            pivot = self.node(pivot).parent;
        }
        let stays = best.to == NONE || best.to == parent || best.to == self.sibling(id);
        (!stays).then_some(best)
    }

    /// Moves where that still gains; by how much, 0 where it does not.
    fn try_move(&mut self, next: Move) -> f64 {
        let (id, to) = (next.node, next.to);
        if !self.can_move(id) {
            return 0.0;
        }
        let (parent, sibling) = (self.node(id).parent, self.sibling(id));
        if to == parent || to == sibling || self.is_below(to, id) {
            return 0.0;
        }
        let gain = self.relink(id, to);
        if gain > 0.0 {
            return gain;
        }
        self.relink(id, sibling);
        0.0
    }

    /// Whether `id` is `ancestor` or below it.
    fn is_below(&self, mut id: u32, ancestor: u32) -> bool {
        while id != NONE {
            if id == ancestor {
                return true;
            }
            id = self.node(id).parent;
        }
        false
    }

    /// Moves a node with its parent to above `to`, which is neither of them nor its sibling nor below it; by how much all
    /// areas together shrink.
    fn relink(&mut self, id: u32, to: u32) -> f64 {
        let (parent, sibling) = (self.node(id).parent, self.sibling(id));
        let above = self.node(parent).parent;
        self.replace_child(above, parent, sibling);
        let mut gain = f64::from(self.node(parent).area) + self.refit(above);
        let above = self.node(to).parent;
        self.replace_child(above, to, parent);
        let bounds = self.node(id).bounds.union(self.node(to).bounds);
        let area = bounds.half_area(self.scale);
        let joint = &mut self.nodes[parent as usize];
        (joint.bounds, joint.area, joint.children) = (bounds, area, [id, to]);
        self.nodes[to as usize].parent = parent;
        gain += self.refit(above) - f64::from(area);
        gain
    }

    fn replace_child(&mut self, parent: u32, old: u32, new: u32) {
        for child in &mut self.nodes[parent as usize].children {
            if *child == old {
                *child = new;
            }
        }
        self.nodes[new as usize].parent = parent;
    }

    /// Fits the boxes of a node and of those above it to their children, as long as they change; by how much their
    /// areas shrink.
    fn refit(&mut self, mut id: u32) -> f64 {
        let mut gain = 0.0;
        while id != NONE {
            let [a, b] = self.node(id).children.map(|child| self.node(child).bounds);
            let bounds = a.union(b);
            let node = &mut self.nodes[id as usize];
            if node.bounds.min.truncate() == bounds.min.truncate()
                && node.bounds.max.truncate() == bounds.max.truncate()
            {
                break;
            }
            let area = bounds.half_area(self.scale);
            gain += f64::from(node.area) - f64::from(area);
            (node.bounds, node.area) = (bounds, area);
            id = node.parent;
        }
        gain
    }

    /// The tree in the order of its nodes, with the leaves of `old`, whose nodes have the ids of this.
    fn tree(&self, old: &BinaryTree) -> BinaryTree {
        let mut nodes = Vec::with_capacity(self.nodes.len());
        let mut references = Vec::with_capacity(old.references.len());
        nodes.push(Node::NONE);
        let mut open = vec![(0, 0)];
        while let Some((at, id)) = open.pop() {
            let linked = self.node(id);
            let bounds = linked.bounds.aabb();
            if linked.is_leaf() {
                let listed = old.references_of(&old.nodes[id as usize]);
                nodes[at] = Node::leaf(bounds, references.len() as u32, listed.len() as u32);
                references.extend_from_slice(listed);
                continue;
            }
            let first = nodes.len();
            nodes[at] = Node::interior(bounds, first as u32);
            nodes.extend([Node::NONE; 2]);
            open.push((first + 1, linked.children[1]));
            open.push((first, linked.children[0]));
        }
        BinaryTree { nodes, references }
    }
}
