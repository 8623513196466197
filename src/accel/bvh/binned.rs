//! The binned build: top down, each node split where a histogram of centroids says that it is cheapest, down to single
//! references or to as many as a leaf may hold.
//!
//! How many nodes there will be is not known before, since leaves may hold several references. A small subtree is one
//! thread's, which puts its nodes side by side ([`Row`]); in the end the rows are put behind each other ([`Limb`]). Where
//! each reference goes is known at each split.
//!
//! Every decision depends only on the references of the node, and chunks that threads share are cut and joined by
//! counts, so the tree is the same whatever the number of threads.
//!
//! **Where the time goes**, of one thread with leaves of up to eight references: a quarter each on histograms, on moving
//! references and on small subtrees; see [`loops`](super::loops) for what was tried.

use crate::geometry::Aabb;
use crate::scene::Mesh;

use super::super::pages;
use super::super::parallel::{self, MANY};
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
    parallel::extend(&mut references, mesh.len(), MANY, |i| {
        let prim = i as u32;
        Reference::new(mesh.triangle_bounds(prim), prim)
    });
    references.resize(mesh.len() + room, Reference::NONE);
    references
}

/// A tree over `references` whose leaves hold at most `most` each, which is no more than [`small::MOST`].
pub(super) fn build(mut references: Vec<Reference>, most: usize) -> BinaryTree {
    let count = references.len();
    let mut spare = parallel::filled(count, Reference::NONE);
    grow(count, most, |place| {
        let task = Task::new(&mut references, &mut spare, count);
        split(task, place, Loops::best())
    })
}

/// A tree over `count` references: `make` makes its root and what is below that.
pub(super) fn grow(count: usize, most: usize, make: impl FnOnce(Place) -> Limb) -> BinaryTree {
    if count == 0 {
        return BinaryTree::EMPTY;
    }
    let mut references = parallel::filled(count, 0);
    let limb = make(Place {
        prims: &mut references,
        first_reference: 0,
        depth: 0,
        most,
    });
    let mut nodes = pages::with_capacity(limb.len());
    nodes.push(Node::NONE);
    limb.lay(0, &mut nodes);
    BinaryTree { nodes, references }
}

/// Where a subtree goes.
pub(super) struct Place<'a> {
    /// Triangle indices of its leaves.
    pub prims: &'a mut [u32],
    pub first_reference: u32,
    pub depth: usize,
    /// Most references of a leaf.
    pub most: usize,
}

impl<'a> Place<'a> {
    /// The places of both children of a node that gives `count` references to the first of them.
    pub fn split(self, count: usize) -> [Place<'a>; 2] {
        let (a_prims, b_prims) = self.prims.split_at_mut(count);
        let part = |prims, first_reference| Place {
            prims,
            first_reference,
            depth: self.depth + 1,
            most: self.most,
        };
        [
            part(a_prims, self.first_reference),
            part(b_prims, self.first_reference + count as u32),
        ]
    }
}

/// A subtree whose nodes do not lie side by side yet.
pub(super) enum Limb {
    /// Made by one thread: the root, and what is below it, which counts from the begin of `below`.
    Row {
        root: Node,
        below: Vec<Node>,
    },
    Fork {
        bounds: Aabb,
        sides: Box<[Limb; 2]>,
    },
}

impl Limb {
    /// Nodes, with the root.
    fn len(&self) -> usize {
        match self {
            Limb::Row { below, .. } => 1 + below.len(),
            Limb::Fork { sides, .. } => 1 + sides[0].len() + sides[1].len(),
        }
    }

    /// Puts the root at `at` and what is below it behind all of `nodes`.
    fn lay(self, at: usize, nodes: &mut Vec<Node>) {
        let first = nodes.len();
        match self {
            Limb::Row { root, below } => {
                let by = first as u32;
                nodes[at] = root.moved(by);
                nodes.extend(below.iter().map(|node| node.moved(by)));
            }
            Limb::Fork { bounds, sides } => {
                nodes[at] = Node::interior(bounds, first as u32);
                nodes.extend([Node::NONE; 2]);
                let [a, b] = *sides;
                a.lay(first, nodes);
                b.lay(first + 1, nodes);
            }
        }
    }
}

/// A place that one thread fills, one node after another.
pub(super) struct Row<'a> {
    place: Place<'a>,
    nodes: Vec<Node>,
    /// References that are taken.
    references: usize,
    loops: Loops,
}

impl<'a> Row<'a> {
    /// What is made of `task` at `place`.
    fn limb(task: Task, place: Place<'a>, loops: Loops) -> Limb {
        let depth = place.depth;
        let mut row = Self {
            nodes: Vec::with_capacity(2 * task.len() / place.most),
            place,
            loops,
            references: 0,
        };
        let root = row.subtree(task, depth);
        Limb::Row {
            root,
            below: row.nodes,
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
        let first = self.nodes.len();
        self.nodes.extend([Node::NONE; 2]);
        let children = children(self);
        self.nodes[first..first + 2].copy_from_slice(&children);
        Node::interior(bounds, first as u32)
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

/// The tree over what `task` holds.
pub(super) fn split(task: Task, place: Place, loops: Loops) -> Limb {
    if task.len() < PARALLEL {
        return Row::limb(task, place, loops);
    }
    let bounds = task.extent.bounds.aabb();
    let [a_task, b_task] = sides(task, place.depth, loops);
    let [a_place, b_place] = place.split(a_task.len());
    let (a, b) = rayon::join(
        || split(a_task, a_place, loops),
        || split(b_task, b_place, loops),
    );
    Limb::Fork {
        bounds,
        sides: Box::new([a, b]),
    }
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
            for node in tree.nodes.iter().filter(|node| !node.is_leaf()) {
                let children = &tree.nodes[node.first as usize..];
                let is_lowest = children[..2].iter().all(Node::is_leaf);
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
