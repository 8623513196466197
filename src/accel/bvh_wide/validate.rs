//! What a wide tree promises, checked.

use crate::geometry::Aabb;
use crate::scene::Mesh;

use super::super::items::LANES;
use super::super::stack::MAX_DEPTH;
use super::{BvhWide, Child};

/// Checks boxes, depth, that each node is some child's exactly once and each block some leaf's, and that every triangle is in some leaf
/// whose box meets its own.
pub(super) fn validate(tree: &BvhWide, mesh: &Mesh, lanes: &[u32]) -> Result<(), String> {
    if tree.depth as usize > MAX_DEPTH {
        return Err(format!(
            "depth {} exceeds the stack's {MAX_DEPTH}",
            tree.depth
        ));
    }
    if mesh.is_empty() {
        let is_empty = tree.root == Child::NONE;
        return is_empty
            .then_some(())
            .ok_or_else(|| "an empty mesh has a tree".to_owned());
    }
    let (mut nodes, mut blocks) = (
        vec![0_u32; tree.nodes.len()],
        vec![0_u32; tree.filled.len()],
    );
    for (child, bounds) in tree.children() {
        if child.is_leaf() {
            for block in child.blocks() {
                blocks[block as usize] += 1;
            }
            continue;
        }
        nodes[child.0 as usize] += 1;
        for (part, part_bounds) in tree.nodes[child.0 as usize].children() {
            if part != Child::NONE && !contains(&bounds, &part_bounds) {
                return Err(format!("node {} does not contain a child", child.0));
            }
        }
    }
    if nodes.iter().any(|count| *count != 1) {
        return Err("a node has not exactly one parent".to_owned());
    }
    if blocks.contains(&0) {
        return Err("a block is no leaf's".to_owned());
    }
    triangles_are_covered(tree, mesh, lanes)
}

/// The boxes of the leaves that list a triangle, taken together, contain its corners.
fn triangles_are_covered(tree: &BvhWide, mesh: &Mesh, lanes: &[u32]) -> Result<(), String> {
    let mut boxes = vec![Aabb::EMPTY; mesh.len()];
    for (leaf, bounds) in tree.children().filter(|(child, _)| child.is_leaf()) {
        for block in leaf.blocks() {
            for prim in &lanes[block as usize * LANES..][..LANES] {
                boxes[*prim as usize] = boxes[*prim as usize].union(bounds);
            }
        }
    }
    let is_bare = |prim: &u32| {
        let corners = mesh.corners(*prim);
        !contains(&boxes[*prim as usize], &Aabb::of_points(corners))
    };
    match (0..mesh.len() as u32).find(is_bare) {
        Some(prim) => Err(format!(
            "triangle {prim} reaches out of the leaves that list it"
        )),
        None => Ok(()),
    }
}

fn contains(outer: &Aabb, inner: &Aabb) -> bool {
    outer.min.cmple(inner.min).all() && outer.max.cmpge(inner.max).all()
}
