//! The build: a cell's parts are handed to its eighths, in parallel where there are many.

use rayon::prelude::*;

use crate::geometry::Aabb;
use crate::scene::Mesh;

use super::super::kd_tree::divide;
use super::super::plane_tree::cost::{self, STEP};
use super::super::plane_tree::{Grown, Node, Part, Plane, PlaneTree, Splitter, Subtree, parts};
use super::super::sah::half_area;
use super::super::stack::MAX_DEPTH;

/// Below this many parts a subtree is grown by one thread.
const PARALLEL: usize = 1 << 12;

/// Levels: each takes three of the traversal's stack.
const MOST_LEVELS: u32 = MAX_DEPTH as u32 / 3;

/// References a triangle, on average over any cell: where triangles lie in one place no division parts them, yet each pays a
/// little along their edges, for ever.
const MOST_GROWTH: f64 = 16.0;

/// Divisions in a row that seem not to pay, in the hope for others below that do.
const MOST_POOR: u32 = 1;

/// A cell is divided along an axis where its edge is at least this part of its longest, so that cells become cubes.
const LONG: f32 = 0.7;

/// Up to this many parts a cell is not divided.
const FEW: usize = 4;

/// The tree, and the triangle of every lane of its blocks.
pub(super) fn build(mesh: &Mesh) -> (PlaneTree, Vec<u32>) {
    let cell = Cell {
        bounds: mesh.bounds(),
        levels: MOST_LEVELS,
        growth: MOST_GROWTH,
        poor: 0,
    };
    let splitter = Splitter { mesh, clip: true };
    grow(splitter, &cell, parts(mesh)).finish(mesh.bounds())
}

/// A cell that is not built yet.
#[derive(Debug, Clone, Copy)]
struct Cell {
    bounds: Aabb,
    /// How often it may still be divided.
    levels: u32,
    /// How many times its parts its leaves may list.
    growth: f64,
    /// Divisions in a row, up to this cell, that seemed not to pay.
    poor: u32,
}

/// The middle planes of a cell, and its eighths: bit `a` of an eighth's number tells its side along axis `a`.
struct Middle {
    /// `None` along an axis in which the cell is not divided.
    planes: [Option<Plane>; 3],
    eighths: [Aabb; 8],
    /// The chance that a line through the cell meets an eighth; 0 for those that there are not.
    chances: [f64; 8],
}

impl Middle {
    /// `None` where nothing divides the cell.
    fn of(cell: &Aabb) -> Option<Self> {
        let area = half_area(cell);
        let (middle, extent) = (cell.centre(), cell.extent());
        let least = LONG * extent.max_element();
        let planes = [0, 1, 2].map(|axis: usize| {
            let place = middle[axis];
            let is_long = extent[axis] >= least;
            (is_long && cell.min[axis] < place && place < cell.max[axis]).then_some(Plane {
                axis,
                place,
                planar_below: true,
            })
        });
        if area <= 0.0 || planes.iter().all(Option::is_none) {
            return None;
        }
        let (mut eighths, mut chances) = ([*cell; 8], [0.0; 8]);
        for (number, eighth) in eighths.iter_mut().enumerate() {
            let mut exists = true;
            for (axis, plane) in planes.iter().enumerate() {
                let is_above = number >> axis & 1 == 1;
                match plane {
                    Some(plane) if is_above => eighth.min[axis] = plane.place,
                    Some(plane) => eighth.max[axis] = plane.place,
                    None => exists &= !is_above,
                }
            }
            if exists {
                chances[number] = half_area(eighth) / area;
            }
        }
        Some(Self {
            planes,
            eighths,
            chances,
        })
    }

    /// What the cell costs if it is divided into eighths of these costs.
    fn cost(&self, costs: impl Fn(usize) -> f64) -> f64 {
        let planes = self.planes.iter().flatten().count();
        let eighths = (0..8).map(|number| self.chances[number] * costs(number));
        STEP * planes as f64 + eighths.sum::<f64>()
    }
}

impl Cell {
    /// The cell of an eighth.
    fn eighth(&self, bounds: Aabb, pays: bool, growth: f64) -> Self {
        Self {
            bounds,
            levels: self.levels - 1,
            growth: self.growth / growth,
            poor: if pays { 0 } else { self.poor + 1 },
        }
    }

    /// Where the cell would be divided, if it may be.
    fn middle(&self, parts: usize) -> Option<Middle> {
        if parts <= FEW || self.levels == 0 {
            return None;
        }
        Middle::of(&self.bounds)
    }
}

/// What a cell's eighths have.
type Eighths = [Vec<Part>; 8];

/// Hands `parts` to the eighths, axis by axis.
fn divided(splitter: Splitter, middle: &Middle, parts: &[Part]) -> Eighths {
    let mut eighths = Eighths::default();
    eighths[0] = parts.to_vec();
    for (axis, plane) in middle.planes.iter().enumerate() {
        let Some(plane) = plane else {
            continue;
        };
        // Those of lower axes are done.
        for number in 0..1 << axis {
            let [below, above] = divide(splitter, &eighths[number], plane);
            eighths[number] = below;
            eighths[number | 1 << axis] = above;
        }
    }
    eighths
}

/// How many times as many references the eighths of a cell of `parts` have.
fn growth(parts: usize, eighths: &Eighths) -> f64 {
    let references: usize = eighths.iter().map(Vec::len).sum();
    (references as f64 / parts as f64).max(1.0)
}

/// Whether dividing a cell of `parts` seems to pay.
fn pays(middle: &Middle, parts: usize, eighths: &Eighths) -> bool {
    middle.cost(|number| cost::expected(eighths[number].len())) < cost::leaf(parts)
}

/// Grows the subtree of a cell.
fn grow(splitter: Splitter, cell: &Cell, parts: Vec<Part>) -> Grown {
    let whole = |parts: &[Part], must_be_leaf: bool| {
        let mut tree = Subtree::default();
        let root = if must_be_leaf {
            leaf(&mut tree, parts)
        } else {
            node(splitter, &mut tree, cell, parts).0
        };
        Grown::Whole(root, tree)
    };
    if parts.len() < PARALLEL {
        return whole(&parts, false);
    }
    let Some(middle) = cell.middle(parts.len()) else {
        return whole(&parts, true);
    };
    let eighths = divided(splitter, &middle, &parts);
    let pays = pays(&middle, parts.len(), &eighths);
    let growth = growth(parts.len(), &eighths);
    if growth > cell.growth || (!pays && cell.poor == MOST_POOR) {
        return whole(&parts, true);
    }
    drop(parts);
    let grown: Vec<Grown> = eighths
        .into_par_iter()
        .zip(middle.eighths)
        .map(|(parts, bounds)| grow(splitter, &cell.eighth(bounds, pays, growth), parts))
        .collect();
    joined(&middle, grown)
}

/// The planes of a node over its eighths.
fn joined(middle: &Middle, eighths: Vec<Grown>) -> Grown {
    let mut level = eighths;
    for axis in (0..3).rev() {
        let above = level.split_off(1 << axis);
        let Some(plane) = &middle.planes[axis] else {
            // There is nothing above.
            continue;
        };
        let node = plane_node(middle, plane, 0);
        let pairs = level.into_iter().zip(above);
        level = pairs
            .map(|(below, above)| Grown::Split(node, Box::new([below, above])))
            .collect();
    }
    level.swap_remove(0)
}

/// The node of one of the middle planes: all but the first are parts of the octree's node.
fn plane_node(middle: &Middle, plane: &Plane, pair: u32) -> Node {
    let node = Node::axis(plane.axis, plane.place, pair);
    if middle.planes[..plane.axis].iter().any(Option::is_some) {
        node.inner()
    } else {
        node
    }
}

/// A leaf of these parts.
fn leaf(tree: &mut Subtree, parts: &[Part]) -> Node {
    let prims: Vec<u32> = parts.iter().map(|part| part.prim).collect();
    tree.leaf(&prims)
}

/// The node of a cell with these parts, and what it costs a ray that meets it.
fn node(splitter: Splitter, tree: &mut Subtree, cell: &Cell, parts: &[Part]) -> (Node, f64) {
    let as_leaf = cost::leaf(parts.len());
    let Some(middle) = cell.middle(parts.len()) else {
        return (leaf(tree, parts), as_leaf);
    };
    let eighths = divided(splitter, &middle, parts);
    let pays = pays(&middle, parts.len(), &eighths);
    let growth = growth(parts.len(), &eighths);
    if growth > cell.growth || (!pays && cell.poor == MOST_POOR) {
        return (leaf(tree, parts), as_leaf);
    }
    let mark = tree.mark();
    let mut costs = [0.0; 8];
    let mut eighth = |tree: &mut Subtree, number: usize| {
        let cell = cell.eighth(middle.eighths[number], pays, growth);
        let (node, cost) = node(splitter, tree, &cell, &eighths[number]);
        costs[number] = cost;
        node
    };
    let root = planes(tree, &middle, 0, 0, &mut eighth);
    let divided = middle.cost(|number| costs[number]);
    if as_leaf <= divided {
        tree.rewind(mark);
        return (leaf(tree, parts), as_leaf);
    }
    (root, divided)
}

/// The planes across `axis` and higher ones over the eighths that share `number` of the lower ones, depth first.
fn planes(
    tree: &mut Subtree,
    middle: &Middle,
    axis: usize,
    number: usize,
    eighth: &mut impl FnMut(&mut Subtree, usize) -> Node,
) -> Node {
    let Some(plane) = middle.planes.get(axis) else {
        return eighth(tree, number);
    };
    let Some(plane) = plane else {
        return planes(tree, middle, axis + 1, number, eighth);
    };
    let pair = tree.pair();
    let below = planes(tree, middle, axis + 1, number, eighth);
    let above = planes(tree, middle, axis + 1, number | 1 << axis, eighth);
    tree.set(pair, [below, above]);
    plane_node(middle, plane, pair)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec3;

    #[test]
    fn flat_and_long_cells_are_divided_until_they_are_cubes() {
        for (extent, axes) in [
            ([1.0, 1.0, 1.0], vec![0, 1, 2]),
            ([8.0, 1.0, 7.0], vec![0, 2]),
            ([1.0, 5.0, 1.0], vec![1]),
            ([0.0, 2.0, 1.5], vec![1, 2]),
        ] {
            let mut cell = Aabb {
                min: Vec3::splat(-1.0),
                max: Vec3::splat(-1.0) + Vec3::from(extent),
            };
            let divided = |cell: &Aabb| -> Vec<usize> {
                let middle = Middle::of(cell).expect("divided");
                let planes = middle.planes.iter().flatten();
                planes.map(|plane| plane.axis).collect()
            };
            assert_eq!(divided(&cell), axes);
            for _ in 0..3 {
                cell = Middle::of(&cell).expect("divided").eighths[0];
            }
            let edges = extent.iter().filter(|edge| **edge > 0.0).count();
            assert_eq!(divided(&cell).len(), edges);
            let longest = cell.extent().max_element();
            let is_even = |edge: &f32| *edge == 0.0 || *edge >= 0.5 * longest;
            assert!(cell.extent().to_array().iter().all(is_even));
        }
    }
}
