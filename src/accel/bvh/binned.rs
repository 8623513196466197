//! The binned build: top down, each node split where a histogram of centroids says that it is cheapest, down to single
//! references or to as many as a leaf may hold.
//!
//! A subtree of k references has at most 2k - 2 nodes below its root, so each has its room among the nodes before it is
//! built; and exactly so many where a leaf holds one. A small subtree is one thread's, which puts its nodes side by side
//! ([`Row`]), so that what leaves of several references leave over lies behind them.
//!
//! Every decision depends only on the references of the node, and chunks that threads share are cut and joined by
//! counts, so the tree is the same whatever the number of threads.
//!
//! **Where the time goes**, of one thread with leaves of up to eight references: a quarter each on histograms, on moving
//! references and on small subtrees; see [`loops`](super::loops) for what was tried.

use rayon::prelude::*;

use crate::geometry::Aabb;
use crate::scene::Mesh;

use super::super::pages;
use super::super::stack::MAX_DEPTH;
use super::loops::Loops;
use super::partition::Task;
use super::reference::Reference;
use super::{BinaryTree, Node, small};

/// Below this many references a node is built by one thread.
pub(super) const PARALLEL: usize = 4096;

/// The references of all triangles of `mesh`.
pub(super) fn references(mesh: &Mesh) -> Vec<Reference> {
    references_before(mesh, 0)
}

/// The references of all triangles of `mesh` before room for so many more.
pub(super) fn references_before(mesh: &Mesh, room: usize) -> Vec<Reference> {
    let mut references = pages::with_capacity(mesh.len() + room);
    let reference = |prim| Reference::new(mesh.triangle_bounds(prim), prim);
    references.par_extend((0..mesh.len() as u32).into_par_iter().map(reference));
    references.resize(mesh.len() + room, Reference::NONE);
    references
}

/// A tree over `references` whose leaves hold at most `most` each, which is no more than [`small::MOST`].
pub(super) fn build(mut references: Vec<Reference>, most: usize) -> BinaryTree {
    let count = references.len();
    let mut spare = pages::filled(count, Reference::NONE);
    grow(count, most, |node, place| {
        let task = Task::new(&mut references, &mut spare, count);
        split(node, task, place, Loops::best());
    })
}

/// A tree over `count` references: `fill` gets the root and where what is below it goes.
pub(super) fn grow(count: usize, most: usize, fill: impl FnOnce(&mut Node, Place)) -> BinaryTree {
    if count == 0 {
        return BinaryTree::EMPTY;
    }
    let mut nodes = pages::filled(2 * count - 1, Node::NONE);
    let mut references = pages::filled(count, 0);
    let (root, below) = nodes.split_at_mut(1);
    let place = Place {
        prims: &mut references,
        first_reference: 0,
        nodes: below,
        first_node: 1,
        depth: 0,
        most,
    };
    fill(&mut root[0], place);
    BinaryTree { nodes, references }
}

/// Where a subtree goes.
pub(super) struct Place<'a> {
    /// Triangle indices of its leaves.
    pub prims: &'a mut [u32],
    pub first_reference: u32,
    /// Room for the nodes below its root.
    pub nodes: &'a mut [Node],
    pub first_node: u32,
    pub depth: usize,
    /// Most references of a leaf.
    pub most: usize,
}

impl<'a> Place<'a> {
    /// The children of a node that gives `count` references to the first of them, and the places of both subtrees.
    pub fn split(self, count: usize) -> (&'a mut [Node], [Place<'a>; 2]) {
        let (children, below) = self.nodes.split_at_mut(2);
        let (a_nodes, b_nodes) = below.split_at_mut(2 * count - 2);
        let (a_prims, b_prims) = self.prims.split_at_mut(count);
        let first_node = self.first_node + 2;
        let part = |prims, first_reference, nodes, first_node| Place {
            prims,
            first_reference,
            nodes,
            first_node,
            depth: self.depth + 1,
            most: self.most,
        };
        let a = part(a_prims, self.first_reference, a_nodes, first_node);
        let b = part(
            b_prims,
            self.first_reference + count as u32,
            b_nodes,
            first_node + 2 * count as u32 - 2,
        );
        (children, [a, b])
    }
}

/// A place that one thread fills, one node after another, so that no room is left between them.
pub(super) struct Row<'a> {
    place: Place<'a>,
    /// Nodes and references that are taken.
    nodes: usize,
    references: usize,
    loops: Loops,
}

impl<'a> Row<'a> {
    fn new(place: Place<'a>, loops: Loops) -> Self {
        Self {
            place,
            loops,
            nodes: 0,
            references: 0,
        }
    }

    /// Most references of a leaf.
    #[inline(always)]
    pub fn most(&self) -> usize {
        self.place.most
    }

    /// A leaf that lists `prims`.
    #[inline(always)]
    pub fn leaf(&mut self, bounds: Aabb, prims: impl ExactSizeIterator<Item = u32>) -> Node {
        let (first, count) = (self.references, prims.len());
        self.references += count;
        for (slot, prim) in self.place.prims[first..].iter_mut().zip(prims) {
            *slot = prim;
        }
        let first = self.place.first_reference + first as u32;
        Node::leaf(bounds, first, count as u32)
    }

    /// A node with the two children that `children` gives, which lie before what is below them.
    #[inline(always)]
    pub fn interior(
        &mut self,
        bounds: Aabb,
        children: impl FnOnce(&mut Self) -> [Node; 2],
    ) -> Node {
        let first = self.nodes;
        self.nodes += 2;
        let children = children(self);
        self.place.nodes[first..first + 2].copy_from_slice(&children);
        Node::interior(bounds, self.place.first_node + first as u32)
    }

    /// The root of a subtree over what `task` holds, at `depth`, after everything below it.
    fn subtree(&mut self, task: Task, depth: usize) -> Node {
        if task.len() <= small::MOST {
            return small::build(task.references(), &task.extent, depth, self);
        }
        let bounds = task.extent.bounds.aabb();
        let [first, second] = sides(task, depth, self.loops);
        self.interior(bounds, |row| {
            [first, second].map(|side| row.subtree(side, depth + 1))
        })
    }
}

/// Whether a subtree of `count` references whose root is at `depth` may be split at will: what is left must fit below
/// even if it is halved by index from the next level on.
pub(super) fn may_choose(depth: usize, count: usize) -> bool {
    let levels = count.next_power_of_two().trailing_zeros() as usize;
    depth + levels < MAX_DEPTH
}

/// Both sides of the best split of a node at `depth`.
fn sides(task: Task, depth: usize, loops: Loops) -> [Task; 2] {
    let choice = may_choose(depth, task.len())
        .then(|| task.choose(loops))
        .flatten();
    match choice {
        Some(choice) => task.divided(loops, &choice),
        // Identical centroids, or too deep: halves by index keep the depth bounded.
        None => task.halved(),
    }
}

/// Fills `node` and everything below it.
pub(super) fn split(node: &mut Node, task: Task, place: Place, loops: Loops) {
    let depth = place.depth;
    if task.len() < PARALLEL {
        *node = Row::new(place, loops).subtree(task, depth);
        return;
    }
    *node = Node::interior(task.extent.bounds.aabb(), place.first_node);
    let [a_task, b_task] = sides(task, depth, loops);
    let (children, [a_place, b_place]) = place.split(a_task.len());
    let (a, b) = children.split_at_mut(1);
    rayon::join(
        || split(&mut a[0], a_task, a_place, loops),
        || split(&mut b[0], b_task, b_place, loops),
    );
}

#[cfg(test)]
mod tests {
    use super::super::super::testbed::{mesh, soup};
    use super::super::validate;
    use super::*;

    #[test]
    fn a_leaf_holds_at_most_as_many_as_asked_for_in_the_least_box_around_them() {
        let mesh = mesh(&soup(5000, 0.1, 3));
        for most in [1, 3, 8, small::MOST] {
            let tree = build(references(&mesh), most);
            validate::validate(&tree, &mesh).expect("valid");
            let leaves = || tree.nodes.iter().filter(|node| node.is_leaf());
            assert!(leaves().all(|leaf| leaf.count as usize <= most));
            for node in tree.nodes.iter().filter(|node| **node != Node::NONE) {
                let children = &tree.nodes[node.first as usize..];
                let is_lowest = !node.is_leaf() && children[..2].iter().all(Node::is_leaf);
                // What fits into a leaf is not divided.
                assert!(!is_lowest || (children[0].count + children[1].count) as usize > most);
            }
            for leaf in leaves() {
                let boxes = tree.references_of(leaf).iter();
                let boxes = boxes.map(|prim| mesh.triangle_bounds(*prim));
                assert_eq!(leaf.bounds(), boxes.fold(Aabb::EMPTY, Aabb::union));
            }
        }
    }
}
