//! Subtrees that one thread grows. Parts of the cells on the way down lie on one pile, so nothing is allocated a cell.

use std::ops::Range;

use crate::geometry::Aabb;
use crate::scene::Mesh;

use super::super::plane_tree::cost::leaf as leaf_cost;
use super::super::plane_tree::{Node, Part, Plane, Splitter, Subtree, halves};
use super::super::stack::MAX_DEPTH;
use super::sweep::Events;
use super::{binned, cost};

/// Up to this many parts a cell is swept exactly.
const EXACT: usize = 48;

/// Up to this many parts a cell is not divided.
const FEW: usize = 4;

/// Splits in a row that seem not to pay, in the hope for others below that do. Two took twice the time for the same tree.
const MOST_POOR: u32 = 1;

/// A cell that is not built yet.
#[derive(Debug, Clone)]
pub(in super::super) struct Cell {
    pub bounds: Aabb,
    /// How many levels may follow.
    pub depth: usize,
    /// Splits in a row, up to this cell, that seemed not to pay.
    pub poor: u32,
}

impl Cell {
    /// The whole scene's.
    pub fn root(mesh: &Mesh) -> Self {
        // Twice the depth of a balanced tree leaves room for empty space and for parts in several cells.
        let depth = (8 + 2 * (mesh.len() + 1).ilog2() as usize).min(MAX_DEPTH);
        Self {
            bounds: mesh.bounds(),
            depth,
            poor: 0,
        }
    }

    /// The cell with `bounds` below this one.
    pub fn below(&self, bounds: Aabb, pays: bool) -> Self {
        Self {
            bounds,
            depth: self.depth - 1,
            poor: if pays { 0 } else { self.poor + 1 },
        }
    }

    /// Whether a split that costs so much is to be made.
    pub fn may_split(&self, pays: bool) -> bool {
        pays || self.poor < MOST_POOR
    }
}

/// Grows the subtree of a cell.
pub(super) fn grow(splitter: Splitter, cell: &Cell, parts: Vec<Part>) -> (Node, Subtree) {
    let all = 0..parts.len();
    let mut small = Small {
        splitter,
        pile: parts,
        tree: Subtree::default(),
        events: Events::default(),
        above: Vec::new(),
        prims: Vec::new(),
    };
    let (root, _) = small.node(cell, all);
    (root, small.tree)
}

struct Small<'a> {
    splitter: Splitter<'a>,
    pile: Vec<Part>,
    tree: Subtree,
    events: Events,
    /// Room for what is above a plane, and for the triangles of a leaf.
    above: Vec<Part>,
    prims: Vec<u32>,
}

impl Small<'_> {
    /// The node of a cell with these parts, and what it costs a ray that meets it.
    fn node(&mut self, cell: &Cell, parts: Range<usize>) -> (Node, f64) {
        let as_leaf = leaf_cost(parts.len());
        if parts.len() <= FEW || cell.depth == 0 {
            return (self.leaf(parts), as_leaf);
        }
        let listed = &self.pile[parts.clone()];
        let best = if parts.len() <= EXACT {
            self.events.best(&cell.bounds, listed)
        } else {
            binned::best(&cell.bounds, listed)
        };
        let pays = best.is_some_and(|best| best.cost < as_leaf);
        let Some(best) = best.filter(|_| cell.may_split(pays)) else {
            return (self.leaf(parts), as_leaf);
        };
        let plane = best.plane;
        let sides = halves(&cell.bounds, plane.axis, plane.place);
        let [below, above] = self.divide(&parts, &plane);
        let mark = self.tree.mark();
        let pair = self.tree.pair();
        let [lower, upper] = sides.map(|bounds| cell.below(bounds, pays));
        let (first, first_cost) = self.node(&lower, below.clone());
        let (second, second_cost) = self.node(&upper, above);
        self.pile.truncate(below.start);
        let divided = cost::split(&cell.bounds, &plane, [first_cost, second_cost]);
        if as_leaf <= divided {
            self.tree.rewind(mark);
            return (self.leaf(parts), as_leaf);
        }
        self.tree.set(pair, [first, second]);
        (Node::axis(plane.axis, plane.place, pair), divided)
    }

    /// Piles up the parts on both sides of `plane`; where they lie.
    fn divide(&mut self, parts: &Range<usize>, plane: &Plane) -> [Range<usize>; 2] {
        let start = self.pile.len();
        for i in parts.clone() {
            let [below, above] = self.splitter.sides(&self.pile[i], plane);
            self.pile.extend(below);
            self.above.extend(above);
        }
        let middle = self.pile.len();
        self.pile.append(&mut self.above);
        [start..middle, middle..self.pile.len()]
    }

    fn leaf(&mut self, parts: Range<usize>) -> Node {
        self.prims.clear();
        self.prims
            .extend(self.pile[parts].iter().map(|part| part.prim));
        self.tree.leaf(&self.prims)
    }
}
