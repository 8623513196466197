//! The lower levels: planes of all directions are tried.

use std::ops::Range;

use crate::geometry::{Aabb, DVec3, Vec3};
use crate::scene::Mesh;

use super::super::items::LANES;
use super::super::kd_tree::{Cell, Events};
use super::super::plane_tree::cost::{self, STEP};
use super::super::plane_tree::{Node, Oblique, Part, Plane, Subtree, halves};
use super::Scale;
use super::piece::{Piece, Side};
use super::polytope::Polytope;

/// Cost of an oblique plane: it is computed in `f64`, from two lines of the cache more.
const OBLIQUE_STEP: f64 = 2.0 * STEP;

/// Triangles of a cell whose faces are tried.
const FACES: usize = 8;

/// Triangles of a cell whose edges are tried.
const EDGES: usize = 2;

/// Up to this many pieces a cell is not divided.
const FEW: usize = 2;

/// References of a subtree for each of its triangles.
const MOST_REFERENCES: usize = 16;

/// Grows the subtree of a cell with these parts.
pub(super) fn grow(mesh: &Mesh, scale: Scale, cell: &Cell, parts: &[Part]) -> (Node, Subtree) {
    let pile: Vec<Piece> = parts
        .iter()
        .map(|part| Piece::of(mesh, part, &scale))
        .collect();
    let all = 0..pile.len();
    let mut lower = Lower {
        mesh,
        scale,
        most_blocks: parts.len() * MOST_REFERENCES / LANES + 1,
        pile,
        above: Vec::new(),
        tree: Subtree::default(),
        events: Events::default(),
    };
    let (root, _) = lower.node(cell, &Polytope::of_box(&cell.bounds), all);
    (root, lower.tree)
}

/// A plane in any direction.
#[derive(Debug, Clone, Copy)]
enum Cut {
    Axis(Plane),
    Oblique { plane: Oblique, planar_below: bool },
}

/// A plane that was tried.
struct Tried {
    cut: Cut,
    cost: f64,
    /// What it leaves of the cell on both sides.
    sides: [Polytope; 2],
}

struct Lower<'a> {
    mesh: &'a Mesh,
    scale: Scale,
    most_blocks: usize,
    pile: Vec<Piece>,
    /// Room for what is above a plane.
    above: Vec<Piece>,
    tree: Subtree,
    events: Events,
}

impl Lower<'_> {
    /// The node of a cell with these pieces, and what it costs a ray that meets it.
    fn node(&mut self, cell: &Cell, shape: &Polytope, pieces: Range<usize>) -> (Node, f64) {
        let count = pieces.len();
        let as_leaf = cost::leaf(count);
        if count <= FEW || cell.depth == 0 || self.tree.blocks() > self.most_blocks {
            return (self.leaf(pieces), as_leaf);
        }
        let listed = self.pile[pieces.clone()].to_vec();
        let best = self.best(cell, shape, &listed);
        let pays = best.as_ref().is_some_and(|best| best.cost < as_leaf);
        let Some(best) = best.filter(|_| cell.may_split(pays)) else {
            return (self.leaf(pieces), as_leaf);
        };
        let bounds = match &best.cut {
            Cut::Axis(plane) => halves(&cell.bounds, plane.axis, plane.place),
            Cut::Oblique { .. } => [0, 1].map(|side: usize| best.sides[side].bounds(&cell.bounds)),
        };
        let [below, above] = self.divide(&pieces, &best.cut);
        let mark = self.tree.mark();
        let pair = self.tree.pair();
        let [lower, upper] = bounds.map(|bounds| cell.below(bounds, pays));
        let (first, first_cost) = self.node(&lower, &best.sides[0], below.clone());
        let (second, second_cost) = self.node(&upper, &best.sides[1], above);
        self.pile.truncate(below.start);
        let chances = best.sides.each_ref().map(|side| side.area / shape.area);
        let divided = best.cut.step() + chances[0] * first_cost + chances[1] * second_cost;
        if as_leaf <= divided {
            self.tree.rewind(mark);
            return (self.leaf(pieces), as_leaf);
        }
        self.tree.set(pair, [first, second]);
        let node = match best.cut {
            Cut::Axis(plane) => Node::axis(plane.axis, plane.place, pair),
            Cut::Oblique { plane, .. } => self.tree.oblique(Oblique { pair, ..plane }),
        };
        (node, divided)
    }

    fn leaf(&mut self, pieces: Range<usize>) -> Node {
        let pieces = &self.pile[pieces];
        let prims: Vec<u32> = pieces.iter().map(|piece| piece.part.prim).collect();
        self.tree.leaf(&prims)
    }

    /// Piles up the pieces on both sides of a plane; where they lie.
    fn divide(&mut self, pieces: &Range<usize>, cut: &Cut) -> [Range<usize>; 2] {
        let start = self.pile.len();
        for i in pieces.clone() {
            let piece = &self.pile[i];
            let [below, above] = match cut {
                Cut::Axis(plane) => piece.cut_across(plane, &self.scale),
                Cut::Oblique {
                    plane,
                    planar_below,
                } => piece.cut(plane, *planar_below, &self.scale),
            };
            self.pile.extend(below);
            self.above.extend(above);
        }
        let middle = self.pile.len();
        self.pile.append(&mut self.above);
        [start..middle, middle..self.pile.len()]
    }

    /// The cheapest plane of those that are tried, the first of equals; `None` where the cell has no area or nothing divides it.
    fn best(&mut self, cell: &Cell, shape: &Polytope, pieces: &[Piece]) -> Option<Tried> {
        if shape.area <= 0.0 {
            return None;
        }
        let mut best = self.best_across(&cell.bounds, shape, pieces);
        let stride = |most: usize| pieces.len().div_ceil(most).max(1);
        for piece in pieces.iter().step_by(stride(FACES)) {
            self.try_planes(&mut best, shape, pieces, self.face(piece).into_iter());
        }
        for piece in pieces.iter().step_by(stride(EDGES)) {
            self.try_planes(&mut best, shape, pieces, self.edges(piece));
        }
        best
    }

    /// The best axis-parallel plane, chosen by boxes and priced by the shape.
    fn best_across(&mut self, bounds: &Aabb, shape: &Polytope, pieces: &[Piece]) -> Option<Tried> {
        let parts: Vec<Part> = pieces.iter().map(|piece| piece.part).collect();
        let plane = self.events.best(bounds, &parts)?.plane;
        let mut normal = DVec3::ZERO;
        normal[plane.axis] = 1.0;
        let place = f64::from(plane.place);
        let sides = shape.cut(normal, |v| v[plane.axis] - place);
        let cut = Cut::Axis(plane);
        let mut counts = [0; 2];
        for part in &parts {
            let [below, above] = plane.reach(part).sides();
            counts[0] += usize::from(below);
            counts[1] += usize::from(above);
        }
        Some(Tried {
            cost: price(&cut, shape, &sides, counts),
            cut,
            sides,
        })
    }

    /// Tries `planes`, and puts the cheapest into `best` if it is cheaper.
    fn try_planes(
        &self,
        best: &mut Option<Tried>,
        shape: &Polytope,
        pieces: &[Piece],
        planes: impl Iterator<Item = Oblique>,
    ) {
        for plane in planes {
            let [mut below, mut above, mut planar] = [0; 3];
            for piece in pieces {
                let side = piece.side(&plane, self.scale.tolerance);
                planar += usize::from(side == Side::Planar);
                below += usize::from(matches!(side, Side::Below | Side::Both));
                above += usize::from(matches!(side, Side::Above | Side::Both));
            }
            if below.min(above) == pieces.len() {
                continue;
            }
            let sides = shape.cut(plane.normal, |v| plane.height(v));
            for planar_below in [true, false] {
                let cut = Cut::Oblique {
                    plane,
                    planar_below,
                };
                let counts = if planar_below {
                    [below + planar, above]
                } else {
                    [below, above + planar]
                };
                let cost = price(&cut, shape, &sides, counts);
                if best.as_ref().is_none_or(|best| cost < best.cost) {
                    *best = Some(Tried {
                        cut,
                        cost,
                        sides: sides.clone(),
                    });
                }
                if planar == 0 {
                    break;
                }
            }
        }
    }

    /// The plane through a point across `normal`; `None` where that has no direction, or is an axis.
    fn plane(&self, normal: DVec3, through: DVec3) -> Option<Oblique> {
        let normal = normal / normal.abs().max_element();
        let is_axis = normal.abs().element_sum() == 1.0;
        (normal.is_finite() && !is_axis).then(|| Oblique {
            normal,
            offset: normal.dot(through),
            pad: self.scale.pad * normal.abs().element_sum(),
            pair: 0,
        })
    }

    /// The plane of a piece's triangle.
    fn face(&self, piece: &Piece) -> Option<Oblique> {
        let [a, b, c] = self.mesh.corners(piece.part.prim).map(Vec3::as_dvec3);
        self.plane((b - a).cross(c - a), a)
    }

    /// The planes through the edges of a piece's triangle across it.
    fn edges(&self, piece: &Piece) -> impl Iterator<Item = Oblique> {
        let [a, b, c] = self.mesh.corners(piece.part.prim).map(Vec3::as_dvec3);
        let normal = (b - a).cross(c - a);
        let normal = normal / normal.abs().max_element();
        let edges = [(a, b), (b, c), (c, a)];
        let planes = edges.map(|(from, to)| self.plane(normal.cross(to - from), from));
        planes.into_iter().flatten()
    }
}

impl Cut {
    /// What a ray pays to cross it.
    fn step(&self) -> f64 {
        match self {
            Self::Axis(_) => STEP,
            Self::Oblique { .. } => OBLIQUE_STEP,
        }
    }
}

/// What a cell costs that is cut into `sides` with so many pieces.
fn price(cut: &Cut, shape: &Polytope, sides: &[Polytope; 2], counts: [usize; 2]) -> f64 {
    let tests = |side: usize| sides[side].area / shape.area * cost::expected(counts[side]);
    cut.step() + tests(0) + tests(1)
}
