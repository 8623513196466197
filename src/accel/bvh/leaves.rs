//! Leaves of several references, made of a tree whose leaves hold one each: a subtree becomes a leaf where that costs
//! less by the surface area heuristic. Decided from the bottom up, so each choice knows the best of what is below.

use super::super::sah::{Costs, half_area};
use super::{BinaryTree, Node};

/// A step tests two boxes, goes where it was not foreseen and takes about as long as two triangles. If it were one, the nodes of
/// the bunny and the armadillo would be half as many again and take a fifth more memory, and primary and bounce rays be 3 % slower.
pub(super) const COSTS: Costs = Costs {
    step: 2.0,
    test: 1.0,
};

/// The tree of least cost that has `tree`'s nodes, or leaves of at most `most` references in their place.
pub(super) fn merged(tree: &BinaryTree, most: usize) -> BinaryTree {
    let becomes_leaf = leaves(&tree.nodes, most as u32);
    let Some(root) = tree.nodes.first() else {
        return BinaryTree::EMPTY;
    };
    let mut nodes = vec![*root];
    let mut references = Vec::with_capacity(tree.references.len());
    // Nodes of `nodes` that still are as in `tree`, with their index there. Depth first, so that subtrees and their
    // references are contiguous.
    let mut open = vec![(0, 0)];
    while let Some((at, old)) = open.pop() {
        let node: Node = nodes[at];
        if becomes_leaf[old] {
            let first = references.len();
            append(tree, old, &mut references);
            // A triangle that spatial splits have cut may be there twice.
            references[first..].sort_unstable();
            let mut kept = first;
            for i in first..references.len() {
                if i == first || references[i] != references[kept - 1] {
                    references[kept] = references[i];
                    kept += 1;
                }
            }
            references.truncate(kept);
            nodes[at] = Node::leaf(node.bounds(), first as u32, (kept - first) as u32);
        } else {
            let first = nodes.len();
            nodes.extend_from_slice(&tree.nodes[node.first as usize..][..2]);
            nodes[at].first = first as u32;
            open.push((first + 1, node.first as usize + 1));
            open.push((first, node.first as usize));
        }
    }
    nodes.shrink_to_fit();
    BinaryTree { nodes, references }
}

/// Which nodes are, or become, leaves.
fn leaves(nodes: &[Node], most: u32) -> Vec<bool> {
    let mut costs = vec![(0.0, 0); nodes.len()];
    let mut becomes_leaf = vec![true; nodes.len()];
    // Children lie behind their parents.
    for (i, node) in nodes.iter().enumerate().rev() {
        let area = half_area(&node.bounds());
        costs[i] = if node.is_leaf() {
            (COSTS.test * area * f64::from(node.count), node.count)
        } else {
            let [a, b] = [0, 1].map(|side| costs[node.first as usize + side]);
            let count = a.1 + b.1;
            let split = COSTS.step * area + a.0 + b.0;
            let leaf = COSTS.test * area * f64::from(count);
            becomes_leaf[i] = count <= most && leaf <= split;
            (if becomes_leaf[i] { leaf } else { split }, count)
        };
    }
    becomes_leaf
}

/// Appends the references of all leaves below `node`.
fn append(tree: &BinaryTree, node: usize, references: &mut Vec<u32>) {
    let node = tree.nodes[node];
    if node.is_leaf() {
        references.extend_from_slice(tree.references_of(&node));
    } else {
        append(tree, node.first as usize, references);
        append(tree, node.first as usize + 1, references);
    }
}
