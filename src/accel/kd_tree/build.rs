//! The upper levels, divided in parallel.

use crate::scene::Mesh;

use super::super::parallel;
use super::super::plane_tree::cost::leaf as leaf_cost;
use super::super::plane_tree::{
    Grown, Node, Part, Plane, PlaneTree, Splitter, Subtree, halves, parts,
};
use super::binned;
use super::small::{self, Cell};

/// Below this many parts a subtree is grown by one thread.
const PARALLEL: usize = 1 << 12;

/// Parts that one thread divides at a time.
const CHUNK: usize = 1 << 13;

/// The tree, and the triangle of every lane of its blocks. `clip`: whether parts are clipped to their cells.
pub(super) fn build(mesh: &Mesh, clip: bool) -> (PlaneTree, Vec<u32>) {
    let splitter = Splitter { mesh, clip };
    let upper = Upper {
        splitter,
        least: PARALLEL,
        small: |cell: &Cell, parts| small::grow(splitter, cell, parts),
    };
    upper
        .grow(&Cell::root(mesh), parts(mesh))
        .finish(mesh.bounds())
}

/// The upper levels of a tree, and what grows the subtrees below them.
pub(in super::super) struct Upper<'a, F> {
    pub splitter: Splitter<'a>,
    /// Below this many parts a subtree is left to `small`.
    pub least: usize,
    pub small: F,
}

impl<F: Fn(&Cell, Vec<Part>) -> (Node, Subtree) + Sync> Upper<'_, F> {
    /// Grows the subtree of a cell.
    pub fn grow(&self, cell: &Cell, parts: Vec<Part>) -> Grown {
        if parts.len() < self.least || cell.depth == 0 {
            let (root, tree) = (self.small)(cell, parts);
            return Grown::Whole(root, tree);
        }
        let best = binned::best(&cell.bounds, &parts);
        let pays = best.is_some_and(|best| best.cost < leaf_cost(parts.len()));
        let Some(best) = best.filter(|_| cell.may_split(pays)) else {
            let prims: Vec<u32> = parts.iter().map(|part| part.prim).collect();
            let mut tree = Subtree::default();
            return Grown::Whole(tree.leaf(&prims), tree);
        };
        let plane = best.plane;
        let sides = halves(&cell.bounds, plane.axis, plane.place);
        let [below, above] = divide(self.splitter, &parts, &plane);
        drop(parts);
        let [lower, upper] = sides.map(|bounds| cell.below(bounds, pays));
        let (below, above) = rayon::join(|| self.grow(&lower, below), || self.grow(&upper, above));
        let node = Node::axis(plane.axis, plane.place, 0);
        Grown::Split(node, Box::new([below, above]))
    }
}

/// The parts on both sides of `plane`, in the order of `parts`.
pub(in super::super) fn divide(
    splitter: Splitter,
    parts: &[Part],
    plane: &Plane,
) -> [Vec<Part>; 2] {
    let divide = |chunk: &[Part]| -> [Vec<Part>; 2] {
        let mut divided = [0, 1].map(|_| Vec::with_capacity(chunk.len()));
        for part in chunk {
            let [below, above] = splitter.sides(part, plane);
            divided[0].extend(below);
            divided[1].extend(above);
        }
        divided
    };
    if parts.len() < 2 * CHUNK {
        return divide(parts);
    }
    let chunks = parallel::chunks(parts, CHUNK, divide);
    [0, 1].map(|side: usize| {
        let count = chunks.iter().map(|chunk| chunk[side].len()).sum();
        let mut all = Vec::with_capacity(count);
        for chunk in &chunks {
            all.extend_from_slice(&chunk[side]);
        }
        all
    })
}
