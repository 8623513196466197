//! The build in O(N log N): events are sorted once, and a split hands them down in order; only parts that it cuts get
//! new events.
//!
//! A cell's parts and events decide everything, so the tree is the same whatever the number of threads.

use rayon::prelude::*;

use crate::geometry::Aabb;
use crate::scene::Mesh;

use super::super::clip::clipped_bounds;
use super::part::{ABSENT, Events, Part, events, inherited};
use super::plane::{COSTS, Plane, best};
use super::{MAX_DEPTH, Node};

/// Below this many parts a cell is built by one thread.
const PARALLEL: usize = 1024;

/// A finished subtree.
enum Tree {
    Leaf(Vec<u32>),
    Split(Plane, Box<[Tree; 2]>),
}

/// Nodes, root first, and references of the leaves. `clip`: whether parts are clipped to their cells.
pub(super) fn build(mesh: &Mesh, clip: bool) -> (Vec<Node>, Vec<u32>) {
    let parts: Vec<Part> = (0..mesh.len() as u32)
        .into_par_iter()
        .map(|prim| Part {
            prim,
            bounds: mesh.triangle_bounds(prim),
        })
        .collect();
    // Twice the depth of a balanced tree leaves room for empty space and for parts in several cells.
    let depth = (8 + 2 * (mesh.len() + 1).ilog2() as usize).min(MAX_DEPTH);
    let builder = Builder { mesh, clip };
    let events = events(&parts);
    let tree = builder.tree(Cell {
        bounds: mesh.bounds(),
        parts,
        events,
        depth,
    });
    let (mut nodes, mut references) = (Vec::new(), Vec::new());
    flatten(&tree, &mut nodes, &mut references);
    (nodes, references)
}

/// A cell that is not built yet.
struct Cell {
    bounds: Aabb,
    parts: Vec<Part>,
    events: Events,
    /// How many levels may follow.
    depth: usize,
}

struct Builder<'a> {
    mesh: &'a Mesh,
    clip: bool,
}

impl Builder<'_> {
    fn tree(&self, cell: Cell) -> Tree {
        let count = cell.parts.len();
        let leaf_cost = COSTS.test * count as f64;
        let plane = (cell.depth > 0)
            .then(|| best(&cell.bounds, count, &cell.events))
            .flatten()
            .filter(|plane| plane.cost < leaf_cost);
        let Some(plane) = plane else {
            return Tree::Leaf(cell.parts.iter().map(|part| part.prim).collect());
        };
        let [below, above] = self.split(cell, &plane);
        let sides = if count >= PARALLEL {
            let (below, above) = rayon::join(|| self.tree(below), || self.tree(above));
            [below, above]
        } else {
            [self.tree(below), self.tree(above)]
        };
        Tree::Split(plane, Box::new(sides))
    }

    /// The cells on both sides of `plane`.
    fn split(&self, cell: Cell, plane: &Plane) -> [Cell; 2] {
        let (mut below, mut above) = (cell.bounds, cell.bounds);
        below.max[plane.axis] = plane.place;
        above.min[plane.axis] = plane.place;
        let sides = [below, above].map(|bounds| self.side(&cell, bounds, plane));
        drop(cell);
        sides
    }

    /// The cell with `bounds` on one side of `plane`.
    fn side(&self, cell: &Cell, bounds: Aabb, plane: &Plane) -> Cell {
        let is_below = bounds.max[plane.axis] == plane.place;
        let mut moved = vec![ABSENT; cell.parts.len()];
        let mut cut = Vec::new();
        let mut parts = Vec::new();
        // Parts keep their order, so references in leaves ascend.
        for (part, index) in cell.parts.iter().zip(&mut moved) {
            match Reach::of(part, plane) {
                Reach::Both => {
                    let Some(clipped) = self.clipped(part, &bounds) else {
                        continue;
                    };
                    cut.push(parts.len() as u32);
                    parts.push(Part {
                        bounds: clipped,
                        ..*part
                    });
                }
                reach => {
                    if (reach == Reach::Below) == is_below {
                        *index = parts.len() as u32;
                        parts.push(*part);
                    }
                }
            }
        }
        Cell {
            bounds,
            events: inherited(&cell.events, &moved, &parts, &cut),
            parts,
            depth: cell.depth - 1,
        }
    }

    /// The box of what `part` has inside `bounds`; `None` where that is nothing.
    fn clipped(&self, part: &Part, bounds: &Aabb) -> Option<Aabb> {
        let overlap = part.bounds.intersection(*bounds);
        if self.clip {
            clipped_bounds(&self.mesh.corners(part.prim), &overlap)
        } else {
            Some(overlap)
        }
    }
}

/// On which sides of a plane a part lies.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Reach {
    Below,
    Above,
    Both,
}

impl Reach {
    /// What only touches the plane is on its own side alone: the plane belongs to the closed cells of both sides, and
    /// rays that meet it there visit both.
    fn of(part: &Part, plane: &Plane) -> Self {
        let (start, end) = part.interval(plane.axis);
        if start == end && start == plane.place {
            if plane.planar_below {
                Self::Below
            } else {
                Self::Above
            }
        } else if end <= plane.place {
            Self::Below
        } else if start >= plane.place {
            Self::Above
        } else {
            Self::Both
        }
    }
}

/// Appends the nodes of `tree`, depth first, and the references of its leaves.
fn flatten(tree: &Tree, nodes: &mut Vec<Node>, references: &mut Vec<u32>) {
    match tree {
        Tree::Leaf(prims) => {
            nodes.push(Node::leaf(references.len() as u32, prims.len() as u32));
            references.extend_from_slice(prims);
        }
        Tree::Split(plane, sides) => {
            let at = nodes.len();
            nodes.push(Node::leaf(0, 0));
            flatten(&sides[0], nodes, references);
            nodes[at] = Node::interior(plane.axis, plane.place, nodes.len() as u32);
            flatten(&sides[1], nodes, references);
        }
    }
}
