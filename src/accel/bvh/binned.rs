//! The binned build: top down, each node split where a histogram of centroids says that it is cheapest.
//!
//! Every decision depends only on the references of the node, and ranges of references and nodes are handed out by
//! counts, so the tree is the same whatever the number of threads.

use rayon::prelude::*;

use crate::geometry::{Aabb, Vec3, axis};
use crate::scene::Mesh;

use super::super::sah::{Costs, half_area};
use super::super::stack::MAX_DEPTH;
use super::Node;

/// Bins an axis. More than 16 gains less than 1 % of SAH cost (Wald 2007, figure 5).
const BINS: usize = 16;

/// A step tests two boxes, which takes about as long as one triangle.
const COSTS: Costs = Costs {
    step: 1.0,
    test: 1.0,
};

/// Below this many references a node is built by one thread.
const PARALLEL: usize = 4096;

/// A triangle's box and index.
#[derive(Debug, Clone, Copy)]
struct Item {
    bounds: Aabb,
    prim: u32,
}

impl Item {
    #[inline(always)]
    fn centroid(&self) -> Vec3 {
        self.bounds.centre()
    }
}

/// Nodes (root first) and references in leaf order; both empty for an empty mesh.
pub(super) fn build(mesh: &Mesh, most: usize) -> (Vec<Node>, Vec<u32>) {
    if mesh.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let mut items: Vec<Item> = (0..mesh.len() as u32)
        .into_par_iter()
        .map(|prim| Item {
            bounds: mesh.triangle_bounds(prim),
            prim,
        })
        .collect();
    // A subtree of k references has at most 2k - 2 nodes below its root: each gets that room, holes are closed later.
    let mut nodes = vec![Node::leaf(mesh.bounds(), 0, 0); 2 * items.len() - 1];
    let (root, room) = nodes.split_at_mut(1);
    let task = Task {
        items: &mut items,
        first_item: 0,
        room,
        first_node: 1,
        depth: 0,
    };
    split(&mut root[0], task, most);
    (
        close_holes(&nodes),
        items.iter().map(|item| item.prim).collect(),
    )
}

/// The references of a node and the room for what comes below it.
struct Task<'a> {
    items: &'a mut [Item],
    first_item: u32,
    room: &'a mut [Node],
    first_node: u32,
    depth: usize,
}

/// Fills `node` and everything below it.
fn split(node: &mut Node, task: Task, most: usize) {
    let Task {
        items,
        first_item,
        room,
        first_node,
        depth,
    } = task;
    let extent = Extent::of(items);
    let Some(middle) = partition(items, &extent, depth, most) else {
        *node = Node::leaf(extent.bounds, first_item, items.len() as u32);
        return;
    };
    *node = Node::interior(extent.bounds, first_node);
    let (pair, below) = room.split_at_mut(2);
    let (a, b) = pair.split_at_mut(1);
    let (a_room, b_room) = below.split_at_mut(2 * middle - 2);
    let parallel = items.len() >= PARALLEL;
    let (a_items, b_items) = items.split_at_mut(middle);
    let a_task = Task {
        items: a_items,
        first_item,
        first_node: first_node + 2,
        room: a_room,
        depth: depth + 1,
    };
    let b_task = Task {
        items: b_items,
        first_item: first_item + middle as u32,
        first_node: first_node + 2 * middle as u32,
        room: b_room,
        depth: depth + 1,
    };
    if parallel {
        rayon::join(
            || split(&mut a[0], a_task, most),
            || split(&mut b[0], b_task, most),
        );
    } else {
        split(&mut a[0], a_task, most);
        split(&mut b[0], b_task, most);
    }
}

/// The boxes of a node's triangles and of their centroids.
#[derive(Clone, Copy)]
struct Extent {
    bounds: Aabb,
    centroids: Aabb,
}

impl Extent {
    const EMPTY: Self = Self {
        bounds: Aabb::EMPTY,
        centroids: Aabb::EMPTY,
    };

    fn union(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            centroids: self.centroids.union(other.centroids),
        }
    }

    fn of(items: &[Item]) -> Self {
        let serial = |items: &[Item]| {
            items.iter().fold(Self::EMPTY, |e, item| Self {
                bounds: e.bounds.union(item.bounds),
                centroids: e.centroids.grown(item.centroid()),
            })
        };
        // Unions do not depend on their order, so chunks may be joined in any.
        if items.len() < PARALLEL {
            serial(items)
        } else {
            items
                .par_chunks(PARALLEL)
                .map(serial)
                .reduce(|| Self::EMPTY, Self::union)
        }
    }
}

/// Orders `items` into two sides and returns how many are on the first; `None` where a leaf is better.
fn partition(items: &mut [Item], extent: &Extent, depth: usize, most: usize) -> Option<usize> {
    let count = items.len();
    if count == 1 {
        return None;
    }
    // What is left must fit below even if it is halved by index from here on.
    let levels = count.next_power_of_two().trailing_zeros() as usize;
    let may_choose = depth + levels < MAX_DEPTH;
    let best = if may_choose {
        Histogram::of(items, extent).best(half_area(&extent.bounds))
    } else {
        None
    };
    let Some(best) = best else {
        // Identical centroids, or too deep: halves by index keep the depth bounded.
        return (count > most).then_some(count / 2);
    };
    if count <= most && COSTS.test * count as f64 <= best.cost {
        return None;
    }
    let bins = Bins::new(&extent.centroids, best.axis);
    let mut middle = 0;
    for i in 0..count {
        if bins.of(&items[i]) < best.bin {
            items.swap(middle, i);
            middle += 1;
        }
    }
    Some(middle)
}

/// The bins along one axis.
#[derive(Clone, Copy)]
struct Bins {
    axis: usize,
    start: f32,
    scale: f32,
}

impl Bins {
    fn new(centroids: &Aabb, at: usize) -> Self {
        let (start, end) = (axis(centroids.min, at), axis(centroids.max, at));
        // Halved so that the width of the widest box does not overflow. A width of zero gives NaN or infinite bins,
        // which all fall on bin 0 or the last: a side stays empty and the axis is not chosen.
        let scale = BINS as f32 * 0.5 / (end * 0.5 - start * 0.5);
        Self {
            axis: at,
            start,
            scale,
        }
    }

    /// The bin of an item: monotone in its centroid.
    #[inline(always)]
    fn of(&self, item: &Item) -> usize {
        let along = axis(item.centroid(), self.axis) - self.start;
        // The conversion saturates, and turns NaN into 0.
        ((along * self.scale) as usize).min(BINS - 1)
    }
}

/// How many items of what extent fall into each bin of each axis.
#[derive(Clone)]
struct Histogram {
    bins: [[Bin; BINS]; 3],
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self {
        bounds: Aabb::EMPTY,
        count: 0,
    };

    fn union(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            count: self.count + other.count,
        }
    }
}

/// Items of bins below `bin` go to the first side. `cost` is relative to one visit of the node.
struct Best {
    axis: usize,
    bin: usize,
    cost: f64,
}

impl Histogram {
    const EMPTY: Self = Self {
        bins: [[Bin::EMPTY; BINS]; 3],
    };

    fn of(items: &[Item], extent: &Extent) -> Self {
        let axes = [0, 1, 2].map(|at| Bins::new(&extent.centroids, at));
        let serial = |items: &[Item]| {
            let mut histogram = Self::EMPTY;
            for item in items {
                for (bins, of) in histogram.bins.iter_mut().zip(&axes) {
                    let bin = &mut bins[of.of(item)];
                    bin.bounds = bin.bounds.union(item.bounds);
                    bin.count += 1;
                }
            }
            histogram
        };
        if items.len() < PARALLEL {
            serial(items)
        } else {
            items
                .par_chunks(PARALLEL)
                .map(serial)
                .reduce(|| Self::EMPTY, |a, b| a.union(&b))
        }
    }

    fn union(mut self, other: &Self) -> Self {
        for (mine, theirs) in self
            .bins
            .iter_mut()
            .flatten()
            .zip(other.bins.iter().flatten())
        {
            *mine = mine.union(*theirs);
        }
        self
    }

    /// The cheapest split with something on both sides; `None` where no bins separate the items.
    fn best(&self, area: f64) -> Option<Best> {
        let mut best: Option<Best> = None;
        for (axis, bins) in self.bins.iter().enumerate() {
            // Costs of the second side, swept from the right; then of the first, from the left.
            let mut second = [(0.0, 0); BINS];
            let mut side = Bin::EMPTY;
            for bin in (1..BINS).rev() {
                side = side.union(bins[bin]);
                second[bin] = (half_area(&side.bounds) * side.count as f64, side.count);
            }
            let mut side = Bin::EMPTY;
            for bin in 1..BINS {
                side = side.union(bins[bin - 1]);
                let (second_cost, second_count) = second[bin];
                if side.count == 0 || second_count == 0 {
                    continue;
                }
                let tests = half_area(&side.bounds) * side.count as f64 + second_cost;
                // A box without area is met only by rays in its plane: all splits of it cost the same.
                let share = if area > 0.0 { tests / area } else { 0.0 };
                let cost = COSTS.step + COSTS.test * share;
                if best.as_ref().is_none_or(|b| cost < b.cost) {
                    best = Some(Best { axis, bin, cost });
                }
            }
        }
        best
    }
}

/// The same tree without the unused nodes, children of a node side by side, first children first.
fn close_holes(nodes: &[Node]) -> Vec<Node> {
    let mut closed = vec![nodes[0]];
    // Nodes of `closed` whose children are still in `nodes`.
    let mut open = vec![0];
    while let Some(parent) = open.pop() {
        let node: Node = closed[parent];
        if node.is_leaf() {
            continue;
        }
        let first = closed.len();
        closed.extend_from_slice(&nodes[node.first as usize..][..2]);
        closed[parent].first = first as u32;
        open.push(first + 1);
        open.push(first);
    }
    closed.shrink_to_fit();
    closed
}
