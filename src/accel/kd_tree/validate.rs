//! What the tree promises, checked.

use crate::geometry::{Aabb, DVec3, Vec3};
use crate::scene::Mesh;

use super::super::clip::clipped_bounds;
use super::{KdTree, MAX_DEPTH, Node, halves};

/// Meshes above this size are checked by a sample of about as many triangles.
const SAMPLE: usize = 20_000;

/// Longest way from the root to a leaf.
pub(super) fn depth(nodes: &[Node]) -> u32 {
    let mut deepest = 0;
    let mut open = vec![(0_u32, 0_u32)];
    while let Some((index, depth)) = open.pop() {
        let Some(node) = nodes.get(index as usize) else {
            continue;
        };
        deepest = deepest.max(depth);
        if !node.is_leaf() {
            open.push((index + 1, depth + 1));
            open.push((node.above(), depth + 1));
        }
    }
    deepest
}

/// Checks that nodes are a tree within the stack's depth whose planes lie inside their cells, that every triangle is
/// listed where it reaches into a leaf, and that each of its corners, edge middles and its centre is found.
pub(super) fn validate(tree: &KdTree, mesh: &Mesh) -> Result<(), String> {
    shape(tree, mesh)?;
    let stride = mesh.len().div_ceil(SAMPLE).max(1);
    let sample: Vec<u32> = (0..mesh.len() as u32).step_by(stride).collect();
    reach(tree, mesh, &sample)?;
    sample.iter().try_for_each(|&prim| points(tree, mesh, prim))
}

fn shape(tree: &KdTree, mesh: &Mesh) -> Result<(), String> {
    let mut reached = vec![false; tree.nodes.len()];
    let mut open = vec![(0, 0, tree.bounds)];
    while let Some((index, depth, cell)) = open.pop() {
        let Some(&node) = tree.nodes.get(index) else {
            return Err(format!("node {index} does not exist"));
        };
        if std::mem::replace(&mut reached[index], true) {
            return Err(format!("node {index} is reached twice"));
        }
        if depth > MAX_DEPTH {
            return Err(format!("node {index} lies deeper than {MAX_DEPTH}"));
        }
        if node.is_leaf() {
            if (node.value + node.count()) as usize > tree.references.len() {
                return Err(format!("leaf {index} has more references than there are"));
            }
            let listed = tree.references_of(node);
            if listed.iter().any(|&prim| prim as usize >= mesh.len()) {
                return Err(format!("leaf {index} lists a triangle that does not exist"));
            }
            if !listed.is_sorted_by(|a, b| a < b) {
                return Err(format!("leaf {index} lists a triangle twice"));
            }
        } else {
            if !(node.plane() > cell.min[node.axis()] && node.plane() < cell.max[node.axis()]) {
                return Err(format!("the plane of node {index} is not inside its cell"));
            }
            let [below, above] = halves(&cell, node);
            open.push((index + 1, depth + 1, below));
            open.push((node.above() as usize, depth + 1, above));
        }
    }
    match reached.iter().position(|r| !r) {
        Some(index) => Err(format!("node {index} is never reached")),
        None => Ok(()),
    }
}

/// Every triangle of `sample` that reaches into the inside of a leaf is listed there.
fn reach(tree: &KdTree, mesh: &Mesh, sample: &[u32]) -> Result<(), String> {
    let mut open = vec![(0, tree.bounds, sample.to_vec())];
    while let Some((index, cell, candidates)) = open.pop() {
        let node = tree.nodes[index];
        if !node.is_leaf() {
            let [below, above] = halves(&cell, node);
            for (child, half) in [(index + 1, below), (node.above() as usize, above)] {
                let inside =
                    |&prim: &u32| !mesh.triangle_bounds(prim).intersection(half).is_empty();
                let candidates = candidates.iter().copied().filter(inside).collect();
                open.push((child, half, candidates));
            }
            continue;
        }
        // What only touches a face may be listed beyond it: shrink the cell by more than the rounding, which among
        // subnormal coordinates is a step of them.
        let rounding = 4.0 * f32::EPSILON * cell.max_abs() + f32::MIN_POSITIVE;
        let margin = (cell.extent() * 1e-3).max(Vec3::splat(rounding));
        let inner = Aabb {
            min: cell.min + margin,
            max: cell.max - margin,
        };
        if inner.is_empty() {
            continue;
        }
        let listed = tree.references_of(node);
        for prim in candidates {
            if listed.binary_search(&prim).is_err()
                && clipped_bounds(&mesh.corners(prim), &inner).is_some()
            {
                return Err(format!("leaf {index} does not list triangle {prim}"));
            }
        }
    }
    Ok(())
}

/// Corners, edge middles and the centre of `prim` are each found in a leaf that lists it.
fn points(tree: &KdTree, mesh: &Mesh, prim: u32) -> Result<(), String> {
    let corners = mesh.corners(prim).map(Vec3::as_dvec3);
    let [a, b, c] = corners;
    let computed = [
        (a + b) / 2.0,
        (b + c) / 2.0,
        (c + a) / 2.0,
        (a + b + c) / 3.0,
    ];
    let size = f64::from(mesh.triangle_bounds(prim).max_abs());
    let exact = corners.iter().map(|&p| (p, 0.0));
    for (point, error) in exact.chain(computed.iter().map(|&p| (p, 8.0 * f64::EPSILON * size))) {
        if !found(tree, prim, point, error) {
            return Err(format!("no leaf at {point} lists triangle {prim}"));
        }
    }
    Ok(())
}

/// Whether a leaf whose closed cell may contain `point` lists `prim`.
fn found(tree: &KdTree, prim: u32, point: DVec3, error: f64) -> bool {
    let mut open = vec![0_u32];
    while let Some(index) = open.pop() {
        let node = tree.nodes[index as usize];
        if node.is_leaf() {
            if tree.references_of(node).binary_search(&prim).is_ok() {
                return true;
            }
            continue;
        }
        let beyond = point[node.axis()] - f64::from(node.plane());
        if beyond <= error {
            open.push(index + 1);
        }
        if beyond >= -error {
            open.push(node.above());
        }
    }
    false
}
