//! What the tree promises, checked.

use crate::scene::Mesh;

use super::super::stack::MAX_DEPTH;
use super::{Bvh, Node};

/// Longest way from the root to a leaf; 0 for an empty tree.
pub(super) fn depth(nodes: &[Node]) -> u32 {
    let mut deepest = 0;
    let mut open = vec![(0_u32, 0_u32)];
    while let Some((index, depth)) = open.pop() {
        let Some(node) = nodes.get(index as usize) else {
            continue;
        };
        deepest = deepest.max(depth);
        if !node.is_leaf() {
            open.push((node.first, depth + 1));
            open.push((node.first + 1, depth + 1));
        }
    }
    deepest
}

/// Checks that every node is reached once, within the stack's depth, that boxes contain their parts, and that every
/// triangle is referenced once.
pub(super) fn validate(bvh: &Bvh, mesh: &Mesh) -> Result<(), String> {
    if mesh.is_empty() != bvh.tree.nodes.is_empty() {
        return Err("only an empty mesh has an empty tree".to_owned());
    }
    let mut referenced = vec![false; mesh.len()];
    let mut reached = vec![false; bvh.tree.nodes.len()];
    let mut open = vec![(0, 0, mesh.bounds())];
    if bvh.tree.nodes.is_empty() {
        open.clear();
    }
    while let Some((index, depth, outer)) = open.pop() {
        let Some(node) = bvh.tree.nodes.get(index) else {
            return Err(format!("node {index} does not exist"));
        };
        if std::mem::replace(&mut reached[index], true) {
            return Err(format!("node {index} is reached twice"));
        }
        if depth > MAX_DEPTH {
            return Err(format!("node {index} lies deeper than {MAX_DEPTH}"));
        }
        let bounds = node.bounds();
        if outer.union(bounds) != outer {
            return Err(format!("node {index} is not within its parent"));
        }
        if !node.is_leaf() {
            open.push((node.first as usize, depth + 1, bounds));
            open.push((node.first as usize + 1, depth + 1, bounds));
            continue;
        }
        if (node.first as usize + node.count as usize) > bvh.tree.references.len() {
            return Err(format!("leaf {index} has more references than there are"));
        }
        for &prim in bvh.references_of(node) {
            if bounds.union(mesh.triangle_bounds(prim)) != bounds {
                return Err(format!("triangle {prim} is not within its leaf {index}"));
            }
            if std::mem::replace(&mut referenced[prim as usize], true) {
                return Err(format!("triangle {prim} is referenced twice"));
            }
        }
    }
    if let Some(index) = reached.iter().position(|r| !r) {
        return Err(format!("node {index} is never reached"));
    }
    match referenced.iter().position(|r| !r) {
        Some(prim) => Err(format!("triangle {prim} is in no leaf")),
        None => Ok(()),
    }
}
