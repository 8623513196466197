//! What the tree promises, checked.

use crate::geometry::Aabb;
use crate::scene::Mesh;

use super::super::stack::MAX_DEPTH;
use super::cover::is_covered;
use super::{BinaryTree, Node};

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

/// Checks that every node is reached once, in order and within the stack's depth, that boxes contain
/// those below them, and that the boxes of the leaves that list a triangle together contain it.
pub(super) fn validate(tree: &BinaryTree, mesh: &Mesh) -> Result<(), String> {
    if mesh.is_empty() != tree.nodes.is_empty() {
        return Err("only an empty mesh has an empty tree".to_owned());
    }
    let mut references = references(tree, mesh)?;
    references.sort_by_key(|&(prim, leaf)| (prim, leaf));
    let mut listed = references.chunk_by(|a, b| a.0 == b.0);
    for prim in 0..mesh.len() as u32 {
        let Some(leaves) = listed.next().filter(|leaves| leaves[0].0 == prim) else {
            return Err(format!("triangle {prim} is in no leaf"));
        };
        if leaves.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(format!("a leaf lists triangle {prim} twice"));
        }
        let boxes: Vec<Aabb> = leaves
            .iter()
            .map(|&(_, leaf)| tree.nodes[leaf].bounds())
            .collect();
        let is_within = match boxes.as_slice() {
            [one] => one.union(mesh.triangle_bounds(prim)) == *one,
            several => is_covered(&mesh.corners(prim), several),
        };
        if !is_within {
            return Err(format!("triangle {prim} is not within its leaves"));
        }
    }
    Ok(())
}

/// Every reference with its leaf, after the nodes were checked.
fn references(tree: &BinaryTree, mesh: &Mesh) -> Result<Vec<(u32, usize)>, String> {
    let mut references = Vec::with_capacity(tree.references.len());
    let mut reached = vec![false; tree.nodes.len()];
    let mut open = vec![(0, 0, mesh.bounds())];
    if tree.nodes.is_empty() {
        open.clear();
    }
    // Where the next children lie, going down on the first side first.
    let mut next = 1;
    while let Some((index, depth, outer)) = open.pop() {
        let Some(node) = tree.nodes.get(index) else {
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
        let first = node.first as usize;
        if !node.is_leaf() {
            if first < next {
                return Err(format!("the children of node {index} are out of order"));
            }
            next = first + 2;
            open.push((first + 1, depth + 1, bounds));
            open.push((first, depth + 1, bounds));
            continue;
        }
        if first + node.count as usize > tree.references.len() {
            return Err(format!("leaf {index} has more references than there are"));
        }
        for &prim in tree.references_of(node) {
            if prim as usize >= mesh.len() {
                return Err(format!("leaf {index} lists a triangle that does not exist"));
            }
            references.push((prim, index));
        }
    }
    match reached.iter().position(|reached| !reached) {
        Some(index) => Err(format!("node {index} is never reached")),
        None => Ok(references),
    }
}
