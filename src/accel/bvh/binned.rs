//! The binned build: top down, each node split where a histogram of centroids says that it is cheapest, down to single
//! references.
//!
//! ```text
//!   references of a node          spare room of the same size
//!   | . . . . . . . . . . |  -->  | first side . . > < . second side |     then the two change roles
//! ```
//!
//! A split moves the references to the other of two arrays, the first side from its begin, the second from its end,
//! without a branch that could be mispredicted. A subtree of k references has 2k - 2 nodes below its root, so each has
//! its room among the nodes before it is built.
//!
//! Every decision depends only on the references of the node, and chunks that threads share are cut and joined by
//! counts, so the tree is the same whatever the number of threads.

use glam::{BVec4A, Vec4};
use rayon::prelude::*;

use crate::scene::Mesh;

use super::super::stack::MAX_DEPTH;
use super::bins::{Grid, Histogram, Split};
use super::reference::{Bounds, Extent, Reference};
use super::{BinaryTree, Node, small};

/// Below this many references a node is built by one thread.
const PARALLEL: usize = 4096;

/// Above this many references, threads share the work on a single node, in chunks of [`CHUNK`].
const SHARED: usize = 4 * CHUNK;

/// References of a chunk: large beside a histogram, small beside a mesh.
const CHUNK: usize = 16_384;

/// The references of all triangles of `mesh`.
pub(super) fn references(mesh: &Mesh) -> Vec<Reference> {
    (0..mesh.len() as u32)
        .into_par_iter()
        .map(|prim| Reference::new(mesh.triangle_bounds(prim), prim))
        .collect()
}

/// A tree over `references` whose leaves hold one each.
pub(super) fn build(mut references: Vec<Reference>) -> BinaryTree {
    if references.is_empty() {
        return BinaryTree::EMPTY;
    }
    let count = references.len();
    let room = |count| (0..count).into_par_iter();
    let mut spare: Vec<Reference> = room(count).map(|_| Reference::NONE).collect();
    let mut nodes: Vec<Node> = room(2 * count - 1).map(|_| Node::NONE).collect();
    let mut prims: Vec<u32> = vec![0; count];
    let extent = extent(&references);
    let (root, below) = nodes.split_at_mut(1);
    let place = Place {
        prims: &mut prims,
        first_reference: 0,
        nodes: below,
        first_node: 1,
        depth: 0,
    };
    let task = Task {
        references: &mut references,
        spare: &mut spare,
        extent,
    };
    split(&mut root[0], task, place);
    BinaryTree {
        nodes,
        references: prims,
    }
}

/// The references of a node, and as much room.
struct Task<'a> {
    references: &'a mut [Reference],
    spare: &'a mut [Reference],
    extent: Extent,
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

    /// Whether a subtree of `count` references may be split at will: what is left must fit below even if it is halved
    /// by index from the next level on.
    pub fn may_choose(&self, count: usize) -> bool {
        let levels = count.next_power_of_two().trailing_zeros() as usize;
        self.depth + levels < MAX_DEPTH
    }
}

/// Fills `node` and everything below it.
fn split(node: &mut Node, task: Task, place: Place) {
    let count = task.references.len();
    if count <= small::MOST {
        small::build(node, task.references, &task.extent, place);
        return;
    }
    *node = Node::interior(task.extent.bounds.aabb(), place.first_node);
    let [a_task, b_task] = task.divided(place.may_choose(count));
    let (children, [a_place, b_place]) = place.split(a_task.references.len());
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

impl<'a> Task<'a> {
    /// Both sides: of the best split where `may_choose`, else halves by index, which keep the depth bounded.
    fn divided(self, may_choose: bool) -> [Self; 2] {
        let Self {
            references,
            spare,
            extent: whole,
        } = self;
        if let Some((grid, split, parts)) = may_choose.then(|| choose(references, &whole)).flatten()
        {
            let centroids = if parts.is_empty() {
                partition(references, spare, &grid, &split)
            } else {
                partition_shared(references, spare, &grid, &split, &parts)
            };
            let extents = [0, 1].map(|side| Extent {
                bounds: split.sides[side],
                centroids: centroids[side],
            });
            return Self::pair(spare, references, split.count, extents);
        }
        let middle = references.len() / 2;
        let (a, b) = references.split_at(middle);
        let extents = [extent(a), extent(b)];
        Self::pair(references, spare, middle, extents)
    }

    /// The first `middle` references and the others.
    fn pair(
        references: &'a mut [Reference],
        spare: &'a mut [Reference],
        middle: usize,
        extents: [Extent; 2],
    ) -> [Self; 2] {
        let (a, b) = references.split_at_mut(middle);
        let (a_spare, b_spare) = spare.split_at_mut(middle);
        let [a_extent, b_extent] = extents;
        [(a, a_spare, a_extent), (b, b_spare, b_extent)].map(|(references, spare, extent)| Self {
            references,
            spare,
            extent,
        })
    }
}

/// The boxes of `references` and of their centroids.
fn extent(references: &[Reference]) -> Extent {
    let serial = |chunk: &[Reference]| chunk.iter().fold(Extent::EMPTY, Extent::grown);
    if references.len() < SHARED {
        return serial(references);
    }
    // Unions do not depend on their order, so chunks may be joined in any.
    references
        .par_chunks(CHUNK)
        .map(serial)
        .reduce(|| Extent::EMPTY, Extent::union)
}

/// The best split of a node, and the histograms of its chunks where threads share it.
fn choose(references: &[Reference], extent: &Extent) -> Option<(Grid, Split, Vec<Histogram>)> {
    let grid = Grid::new(&extent.centroids, references.len());
    let mut parts = Vec::new();
    let histogram = if references.len() < SHARED {
        Histogram::of(references, &grid)
    } else {
        references
            .par_chunks(CHUNK)
            .map(|chunk| Histogram::of(chunk, &grid))
            .collect_into_vec(&mut parts);
        let mut joined = Histogram::EMPTY;
        for part in &parts {
            joined.join(part);
        }
        joined
    };
    let split = histogram.best(&grid, &extent.bounds)?;
    Some((grid, split, parts))
}

/// Moves `references` to `to`, those of the first side from its begin, the others from its end, and returns the boxes
/// of the centroids of both sides.
fn partition(
    references: &[Reference],
    to: &mut [Reference],
    grid: &Grid,
    split: &Split,
) -> [Bounds; 2] {
    match split.axis {
        0 => partition_along::<0>(references, to, grid, split.bin),
        1 => partition_along::<1>(references, to, grid, split.bin),
        _ => partition_along::<2>(references, to, grid, split.bin),
    }
}

fn partition_along<const AXIS: usize>(
    references: &[Reference],
    to: &mut [Reference],
    grid: &Grid,
    bin: usize,
) -> [Bounds; 2] {
    let (mut first, mut second) = (0, to.len());
    let mut centroids = Centroids::EMPTY;
    for reference in references {
        let centroid = reference.centroid();
        let beyond = grid.is_beyond::<AXIS>(centroid, bin);
        centroids.add(centroid, beyond);
        let is_beyond = beyond.bitmask() as usize & 1;
        second -= is_beyond;
        to[first + (second - first) * is_beyond] = *reference;
        first += is_beyond ^ 1;
    }
    centroids.0
}

/// The boxes of the centroids on both sides of a split.
#[derive(Clone, Copy)]
struct Centroids([Bounds; 2]);

impl Centroids {
    const EMPTY: Self = Self([Bounds::EMPTY; 2]);

    /// Adds to one side without a branch: for the other side the centroid lies at infinity.
    #[inline(always)]
    fn add(&mut self, centroid: Vec4, beyond: BVec4A) {
        let [first, second] = &mut self.0;
        let a = Vec4::select(beyond, Vec4::INFINITY, Vec4::ZERO);
        let b = Vec4::select(beyond, Vec4::ZERO, Vec4::INFINITY);
        first.min = first.min.min(centroid + a);
        first.max = first.max.max(centroid - a);
        second.min = second.min.min(centroid + b);
        second.max = second.max.max(centroid - b);
    }

    fn union(self, other: Self) -> Self {
        let [a, b] = self.0;
        let [c, d] = other.0;
        Self([a.union(c), b.union(d)])
    }
}

/// As [`partition`], chunk by chunk; `parts` are their histograms, which say where each chunk's references go.
fn partition_shared(
    references: &[Reference],
    to: &mut [Reference],
    grid: &Grid,
    split: &Split,
    parts: &[Histogram],
) -> [Bounds; 2] {
    let (mut first, mut second) = to.split_at_mut(split.count);
    let mut chunks = Vec::with_capacity(parts.len());
    for (chunk, part) in references.chunks(CHUNK).zip(parts) {
        let below = part.below(split.axis, split.bin);
        let (a, a_rest) = std::mem::take(&mut first).split_at_mut(below);
        let (b, b_rest) = std::mem::take(&mut second).split_at_mut(chunk.len() - below);
        (first, second) = (a_rest, b_rest);
        chunks.push((chunk, [a, b]));
    }
    let joined = chunks
        .into_par_iter()
        .map(|(chunk, mut sides)| match split.axis {
            0 => deal::<0>(chunk, &mut sides, grid, split.bin),
            1 => deal::<1>(chunk, &mut sides, grid, split.bin),
            _ => deal::<2>(chunk, &mut sides, grid, split.bin),
        })
        .reduce(|| Centroids::EMPTY, Centroids::union);
    joined.0
}

/// Moves a chunk to its room on both sides.
fn deal<const AXIS: usize>(
    chunk: &[Reference],
    sides: &mut [&mut [Reference]; 2],
    grid: &Grid,
    bin: usize,
) -> Centroids {
    let mut centroids = Centroids::EMPTY;
    let mut filled = [0; 2];
    for reference in chunk {
        let centroid = reference.centroid();
        let beyond = grid.is_beyond::<AXIS>(centroid, bin);
        centroids.add(centroid, beyond);
        let side = beyond.bitmask() as usize & 1;
        sides[side][filled[side]] = *reference;
        filled[side] += 1;
    }
    centroids
}
