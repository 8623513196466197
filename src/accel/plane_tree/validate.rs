//! What a tree of planes promises, checked.

use crate::geometry::{Aabb, DVec3, Vec3};
use crate::scene::Mesh;

use super::super::clip::clipped_bounds;
use super::super::items::LANES;
use super::super::stack::MAX_DEPTH;
use super::PlaneTree;
use super::node::{Kind, Node, halves};

/// Meshes above this size are checked by a sample of about as many triangles.
const SAMPLE: usize = 20_000;

/// Points along an edge of a triangle that are looked for.
const POINTS: u32 = 4;

/// A node on the way down.
#[derive(Clone, Copy)]
struct At {
    index: u32,
    /// What the axis-parallel planes above it leave of the scene's box.
    cell: Aabb,
    /// Nodes above it.
    depth: usize,
    /// Of these, those that are a step.
    steps: u32,
}

impl PlaneTree {
    fn root(&self) -> At {
        At {
            index: 0,
            cell: self.bounds,
            depth: 0,
            steps: 0,
        }
    }

    /// The node, unless there is none with this index.
    fn node(&self, at: &At) -> Option<Node> {
        self.nodes.get(at.index as usize).copied()
    }

    /// Both children; `None` for a leaf.
    fn children(&self, at: &At) -> Option<[At; 2]> {
        let node = self.node(at)?;
        let (pair, cells) = match node.kind() {
            Kind::Leaf(_) => return None,
            Kind::Axis { axis, place, pair } => (pair, halves(&at.cell, axis, place)),
            Kind::Oblique(index) => (self.obliques.get(index as usize)?.pair, [at.cell; 2]),
        };
        Some([0, 1].map(|side: u32| At {
            index: pair + side,
            cell: cells[side as usize],
            depth: at.depth + 1,
            steps: at.steps + u32::from(node.is_step()),
        }))
    }

    /// The triangles of a leaf, ascending.
    fn listed<'a>(&self, leaf: Node, lanes: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
        let blocks = leaf.blocks();
        let filled = self.filled[blocks.start as usize..blocks.end as usize].to_vec();
        let blocks = lanes[blocks.start as usize * LANES..].chunks(LANES);
        blocks
            .zip(filled)
            .flat_map(|(block, filled)| block[..usize::from(filled)].iter().copied())
    }
}

/// Traversal steps on the longest way from the root to a leaf.
pub(super) fn depth(tree: &PlaneTree) -> u32 {
    let mut deepest = 0;
    let mut open = vec![tree.root()];
    while let Some(at) = open.pop() {
        deepest = deepest.max(at.steps);
        open.extend(tree.children(&at).into_iter().flatten());
    }
    deepest
}

/// What the axis-parallel planes above the node with index `place` leave of the scene's box.
pub(super) fn place_bounds(tree: &PlaneTree, place: u32) -> Option<Aabb> {
    let mut at = tree.root();
    while at.index != place {
        // What is below the first child comes before what is below the second.
        let [below, above] = tree.children(&at)?;
        let first_below_above = tree.children(&above).map(|children| children[0].index);
        let is_above =
            above.index == place || first_below_above.is_some_and(|first| place >= first);
        at = if is_above { above } else { below };
    }
    Some(at.cell)
}

/// Checks that nodes are a tree within the stack's depth whose planes lie inside their cells, that every triangle is
/// listed where it reaches into a leaf, and that points all over it are found.
pub(super) fn validate(tree: &PlaneTree, mesh: &Mesh, lanes: &[u32]) -> Result<(), String> {
    shape(tree, mesh, lanes)?;
    let stride = mesh.len().div_ceil(SAMPLE).max(1);
    let sample: Vec<u32> = (0..mesh.len() as u32).step_by(stride).collect();
    reach(tree, mesh, lanes, &sample)?;
    sample
        .iter()
        .try_for_each(|&prim| points(tree, mesh, lanes, prim))
}

fn shape(tree: &PlaneTree, mesh: &Mesh, lanes: &[u32]) -> Result<(), String> {
    let mut reached = vec![false; tree.nodes.len()];
    let mut listed = vec![false; tree.filled.len()];
    // The root's sibling.
    reached[1] = true;
    let mut open = vec![tree.root()];
    while let Some(at) = open.pop() {
        let index = at.index;
        let Some(node) = tree.node(&at) else {
            return Err(format!("node {index} does not exist"));
        };
        if std::mem::replace(&mut reached[index as usize], true) {
            return Err(format!("node {index} is reached twice"));
        }
        if at.depth > MAX_DEPTH {
            return Err(format!("node {index} lies deeper than {MAX_DEPTH}"));
        }
        match node.kind() {
            Kind::Leaf(blocks) => {
                for block in blocks {
                    match listed.get_mut(block as usize) {
                        None => {
                            return Err(format!("leaf {index} names a block that does not exist"));
                        }
                        Some(true) => return Err(format!("block {block} is in two leaves")),
                        Some(block) => *block = true,
                    }
                }
                let prims: Vec<u32> = tree.listed(node, lanes).collect();
                if prims.iter().any(|&prim| prim as usize >= mesh.len()) {
                    return Err(format!("leaf {index} lists a triangle that does not exist"));
                }
                if !prims.is_sorted_by(|a, b| a < b) {
                    return Err(format!("leaf {index} lists a triangle twice"));
                }
            }
            Kind::Axis { axis, place, .. } => {
                if !(place > at.cell.min[axis] && place < at.cell.max[axis]) {
                    return Err(format!("the plane of node {index} is not inside its cell"));
                }
            }
            Kind::Oblique(plane) => {
                if tree.obliques.get(plane as usize).is_none() {
                    return Err(format!("the oblique plane of node {index} does not exist"));
                }
            }
        }
        open.extend(tree.children(&at).into_iter().flatten());
    }
    if let Some(index) = reached.iter().position(|r| !r) {
        return Err(format!("node {index} is never reached"));
    }
    match listed.iter().position(|l| !l) {
        Some(block) => Err(format!("block {block} is in no leaf")),
        None => Ok(()),
    }
}

/// Every triangle of `sample` that reaches into the inside of a leaf is listed there, as far as boxes tell.
fn reach(tree: &PlaneTree, mesh: &Mesh, lanes: &[u32], sample: &[u32]) -> Result<(), String> {
    let mut open = vec![(tree.root(), sample.to_vec())];
    while let Some((at, candidates)) = open.pop() {
        let Some(node) = tree.node(&at) else {
            continue;
        };
        if let Kind::Oblique(_) = node.kind() {
            // Here cells are no boxes any more.
            continue;
        }
        if let Some(children) = tree.children(&at) {
            for child in children {
                let inside = |&prim: &u32| {
                    !mesh
                        .triangle_bounds(prim)
                        .intersection(child.cell)
                        .is_empty()
                };
                let candidates = candidates.iter().copied().filter(inside).collect();
                open.push((child, candidates));
            }
            continue;
        }
        // What only touches a face may be listed beyond it: shrink the cell by more than the rounding, which among
        // subnormal coordinates is a step of them.
        let rounding = 4.0 * f32::EPSILON * at.cell.max_abs() + f32::MIN_POSITIVE;
        let margin = (at.cell.extent() * 1e-3).max(Vec3::splat(rounding));
        let inner = Aabb {
            min: at.cell.min + margin,
            max: at.cell.max - margin,
        };
        if inner.is_empty() {
            continue;
        }
        let listed: Vec<u32> = tree.listed(node, lanes).collect();
        for prim in candidates {
            if listed.binary_search(&prim).is_err()
                && clipped_bounds(&mesh.corners(prim), &inner).is_some()
            {
                return Err(format!("leaf {} does not list triangle {prim}", at.index));
            }
        }
    }
    Ok(())
}

/// Points all over `prim`, its corners among them, are each found in a leaf that lists it.
fn points(tree: &PlaneTree, mesh: &Mesh, lanes: &[u32], prim: u32) -> Result<(), String> {
    let [a, b, c] = mesh.corners(prim).map(Vec3::as_dvec3);
    let size = f64::from(mesh.triangle_bounds(prim).max_abs());
    for i in 0..=POINTS {
        for j in 0..=POINTS - i {
            let (u, v) = (
                f64::from(i) / f64::from(POINTS),
                f64::from(j) / f64::from(POINTS),
            );
            let point = a * (1.0 - u - v) + b * u + c * v;
            // The corners themselves are computed exactly.
            let is_corner = [i, j, POINTS - i - j].contains(&POINTS);
            let error = if is_corner {
                0.0
            } else {
                8.0 * f64::EPSILON * size
            };
            if !found(tree, lanes, prim, point, error) {
                return Err(format!("no leaf at {point} lists triangle {prim}"));
            }
        }
    }
    Ok(())
}

/// Whether a leaf whose closed cell may contain `point` lists `prim`.
fn found(tree: &PlaneTree, lanes: &[u32], prim: u32, point: DVec3, error: f64) -> bool {
    let mut open = vec![tree.root()];
    while let Some(at) = open.pop() {
        let (Some(node), children) = (tree.node(&at), tree.children(&at)) else {
            continue;
        };
        let Some([below, above]) = children else {
            // Ascending, the repeated last ones included.
            let blocks = node.blocks();
            let listed = &lanes[blocks.start as usize * LANES..blocks.end as usize * LANES];
            if listed.binary_search(&prim).is_ok() {
                return true;
            }
            continue;
        };
        let (beyond, error) = match node.kind() {
            Kind::Axis { axis, place, .. } => (point[axis] - f64::from(place), error),
            Kind::Oblique(index) => {
                let plane = &tree.obliques[index as usize];
                (plane.height(point), plane.pad)
            }
            Kind::Leaf(_) => continue,
        };
        if beyond <= error {
            open.push(below);
        }
        if beyond >= -error {
            open.push(above);
        }
    }
    false
}
