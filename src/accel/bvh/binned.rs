//! The binned build: top down, each node split where a histogram of centroids says that it is cheapest, down to single
//! references.
//!
//! A subtree of k references has 2k - 2 nodes below its root, so each has its room among the nodes before it is built.
//!
//! Every decision depends only on the references of the node, and chunks that threads share are cut and joined by
//! counts, so the tree is the same whatever the number of threads.

use rayon::prelude::*;

use crate::scene::Mesh;

use super::super::pages;
use super::super::stack::MAX_DEPTH;
use super::partition::Task;
use super::reference::Reference;
use super::{BinaryTree, Node, small};

/// Below this many references a node is built by one thread.
pub(super) const PARALLEL: usize = 4096;

/// The references of all triangles of `mesh`.
pub(super) fn references(mesh: &Mesh) -> Vec<Reference> {
    let mut references = pages::with_capacity(mesh.len());
    let reference = |prim| Reference::new(mesh.triangle_bounds(prim), prim);
    references.par_extend((0..mesh.len() as u32).into_par_iter().map(reference));
    references
}

/// A tree over `references` whose leaves hold one each.
pub(super) fn build(mut references: Vec<Reference>) -> BinaryTree {
    let count = references.len();
    let mut spare = pages::filled(count, Reference::NONE);
    grow(count, |node, place| {
        split(node, Task::new(&mut references, &mut spare, count), place);
    })
}

/// A tree with `count` leaves: `fill` gets the root and where what is below it goes.
pub(super) fn grow(count: usize, fill: impl FnOnce(&mut Node, Place)) -> BinaryTree {
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
    };
    fill(&mut root[0], place);
    BinaryTree { nodes, references }
}

/// Where a subtree goes.
pub(super) struct Place<'a> {
    /// Triangle indices of its leaves.
    pub prims: &'a mut [u32],
    pub first_reference: u32,
    /// The nodes below its root.
    pub nodes: &'a mut [Node],
    pub first_node: u32,
    pub depth: usize,
}

impl<'a> Place<'a> {
    /// The children of a node that gives `count` references to the first of them, and the places of both subtrees.
    pub fn split(self, count: usize) -> (&'a mut [Node], [Place<'a>; 2]) {
        let (children, below) = self.nodes.split_at_mut(2);
        let (a_nodes, b_nodes) = below.split_at_mut(2 * count - 2);
        let (a_prims, b_prims) = self.prims.split_at_mut(count);
        let depth = self.depth + 1;
        let first_node = self.first_node + 2;
        let a = Place {
            prims: a_prims,
            first_reference: self.first_reference,
            nodes: a_nodes,
            first_node,
            depth,
        };
        let b = Place {
            prims: b_prims,
            first_reference: self.first_reference + count as u32,
            nodes: b_nodes,
            first_node: first_node + 2 * count as u32 - 2,
            depth,
        };
        (children, [a, b])
    }

    /// As [`may_choose`] for this place.
    pub fn may_choose(&self, count: usize) -> bool {
        may_choose(self.depth, count)
    }
}

/// Whether a subtree of `count` references whose root is at `depth` may be split at will: what is left must fit below
/// even if it is halved by index from the next level on.
pub(super) fn may_choose(depth: usize, count: usize) -> bool {
    let levels = count.next_power_of_two().trailing_zeros() as usize;
    depth + levels < MAX_DEPTH
}

/// Fills `node` and everything below it.
pub(super) fn split(node: &mut Node, task: Task, place: Place) {
    let count = task.len();
    if count <= small::MOST {
        small::build(node, task.references(), &task.extent, place);
        return;
    }
    *node = Node::interior(task.extent.bounds.aabb(), place.first_node);
    let choice = place.may_choose(count).then(|| task.choose()).flatten();
    let [a_task, b_task] = match choice {
        Some(choice) => task.divided(&choice),
        // Identical centroids, or too deep: halves by index keep the depth bounded.
        None => task.halved(),
    };
    let (children, [a_place, b_place]) = place.split(a_task.len());
    let (a, b) = children.split_at_mut(1);
    let first = || split(&mut a[0], a_task, a_place);
    let second = || split(&mut b[0], b_task, b_place);
    if count >= PARALLEL {
        rayon::join(first, second);
    } else {
        first();
        second();
    }
}
