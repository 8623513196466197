//! The collapse of a binary tree into an eight-ary one.
//!
//! First it is planned from the bottom up which subtrees become the children of one node, see [`plan`]; then the nodes are
//! made from the top down. Both are shared among threads. Small subtrees are made apart and put behind each other, in the
//! order in which they were found, whatever the number of threads.

use rayon::prelude::*;

use crate::scene::Mesh;

use super::super::bvh::{BinaryTree, Node as BinaryNode};
use super::super::items::{LANES, fill};
use super::super::pages;
use super::super::sah::half_area;
use super::super::slab::Scene;
use super::{BvhWide, Child, Node};

use plan::{APART, Choice, MOST_BLOCKS, Subtree, WIDTH, choices};

mod plan;

/// Subtrees that together become the lanes of a node.
struct Lanes {
    subtrees: [Subtree; WIDTH],
    count: usize,
}

/// Part of a wide tree in the making.
#[derive(Debug, Default)]
struct Part {
    nodes: Vec<Node>,
    slots: Vec<u32>,
    filled: Vec<u8>,
    depth: u32,
    /// Subtrees with fewer binary nodes are put apart.
    least: usize,
    apart: Vec<Apart>,
}

/// A subtree to be made later, for a lane of a node.
#[derive(Debug, Clone, Copy)]
struct Apart {
    subtree: Subtree,
    depth: u32,
    node: usize,
    lane: usize,
}

impl Part {
    /// Appends what was made apart, and puts its root into its lane.
    fn append(&mut self, apart: &Apart, child: Child, part: &Self) {
        let (nodes, blocks) = (self.nodes.len() as u32, self.filled.len() as u32);
        self.nodes.extend(part.nodes.iter().map(|node| {
            Node {
                boxes: node.boxes,
                children: node
                    .children
                    .map(|child| Child(child).moved(nodes, blocks).0),
            }
        }));
        self.slots.extend_from_slice(&part.slots);
        self.filled.extend_from_slice(&part.filled);
        self.depth = self.depth.max(part.depth);
        self.nodes[apart.node].children[apart.lane] = child.moved(nodes, blocks).0;
    }
}

impl Child {
    /// The same behind so many more nodes and blocks.
    fn moved(self, nodes: u32, blocks: u32) -> Self {
        if self == Self::NONE {
            self
        } else if self.is_leaf() {
            Self(self.0 + (blocks << 3))
        } else {
            Self(self.0 + nodes)
        }
    }
}

/// A binary tree and how it is best spread.
struct Collapse<'a> {
    nodes: &'a [BinaryNode],
    references: &'a [u32],
    choices: Vec<Choice>,
}

impl BvhWide {
    /// Collapses `tree`, whose leaves hold at most [`LANES`] references each; also returns the triangle of every lane of
    /// every block.
    pub(super) fn collapse(tree: &BinaryTree, mesh: &Mesh) -> (Self, Vec<u32>) {
        let mut part = Part {
            nodes: pages::with_capacity(tree.nodes.len() / 12),
            slots: pages::with_capacity(tree.references.len() * 2),
            filled: Vec::with_capacity(tree.references.len() / 4),
            ..Part::default()
        };
        let root = if tree.nodes.is_empty() {
            Child::NONE
        } else {
            let collapse = Collapse {
                nodes: &tree.nodes,
                references: &tree.references,
                choices: choices(tree),
            };
            collapse.all(&mut part)
        };
        let wide = Self {
            nodes: part.nodes,
            root,
            scene: Scene::new(mesh.bounds()),
            filled: part.filled,
            depth: part.depth,
            way: None,
        };
        (wide, part.slots)
    }
}

impl Collapse<'_> {
    /// Makes the whole tree: first the top, then the subtrees that it puts apart.
    fn all(&self, top: &mut Part) -> Child {
        let whole = Subtree::whole(self.nodes);
        if self.nodes.len() >= APART {
            top.least = APART;
        }
        let root = self.child(whole, 0, top);
        top.least = 0;
        let all_apart = std::mem::take(&mut top.apart);
        if rayon::current_num_threads() == 1 {
            // The same without the copies.
            for apart in all_apart {
                let child = self.child(apart.subtree, apart.depth, top);
                top.nodes[apart.node].children[apart.lane] = child.0;
            }
            return root;
        }
        let parts: Vec<(Child, Part)> = all_apart
            .par_iter()
            .map(|apart| {
                let mut part = Part::default();
                (self.child(apart.subtree, apart.depth, &mut part), part)
            })
            .collect();
        for (apart, (child, part)) in all_apart.iter().zip(&parts) {
            top.append(apart, *child, part);
        }
        root
    }

    /// Makes the child that `subtree` becomes when it takes one lane.
    fn child(&self, subtree: Subtree, depth: u32, part: &mut Part) -> Child {
        let choice = self.choices[subtree.root];
        if choice.is_leaf() {
            part.depth = part.depth.max(depth);
            return self.leaf(subtree, part);
        }
        let mut lanes = Lanes {
            subtrees: [Subtree::NONE; WIDTH],
            count: 0,
        };
        self.divide(subtree, WIDTH, &mut lanes);
        // Where any hit will do the last lane is visited first. The largest box is the likeliest to block: against the
        // smallest first, shadow rays are a seventh (engine, plant) to a third (sponza, armadillo) faster, and slower by a
        // seventh on the bunny alone.
        let mut sorted = lanes
            .subtrees
            .map(|s| (half_area(&self.nodes[s.root].bounds()), s));
        sorted[..lanes.count].sort_by(|a, b| a.0.total_cmp(&b.0));
        let node = part.nodes.len();
        part.nodes.push(Node::EMPTY);
        for (lane, (_, subtree)) in sorted[..lanes.count].iter().enumerate() {
            let below = subtree.below(self.nodes);
            let child = if below < part.least && !self.choices[subtree.root].is_leaf() {
                part.apart.push(Apart {
                    subtree: *subtree,
                    depth: depth + 1,
                    node,
                    lane,
                });
                Child::NONE
            } else {
                self.child(*subtree, depth + 1, part)
            };
            part.nodes[node].set(lane, child, &self.nodes[subtree.root].bounds());
        }
        Child::node(node)
    }

    /// Lists what both halves of `subtree` become when they take so many lanes together.
    fn divide(&self, subtree: Subtree, room: usize, lanes: &mut Lanes) {
        let left = self.choices[subtree.root].left(room);
        let [first, second] = subtree.halves(self.nodes);
        self.gather(first, left, lanes);
        self.gather(second, room - left, lanes);
    }

    /// Lists what `subtree` becomes when it is spread over at most `room` lanes.
    fn gather(&self, subtree: Subtree, mut room: usize, lanes: &mut Lanes) {
        let choice = self.choices[subtree.root];
        while room > 1 && choice.left(room) == Choice::FEWER as usize {
            room -= 1;
        }
        if room == 1 {
            lanes.subtrees[lanes.count] = subtree;
            lanes.count += 1;
        } else {
            self.divide(subtree, room, lanes);
        }
    }

    /// Fills blocks with the triangles of `subtree`, each once, the lowest index first.
    fn leaf(&self, subtree: Subtree, part: &mut Part) -> Child {
        let references = &self.references[subtree.references(self.nodes)];
        let count = references.len();
        let mut prims = [0; MOST_BLOCKS * LANES];
        let prims = &mut prims[..count];
        prims.copy_from_slice(references);
        prims.sort_unstable();
        let mut kept = 1;
        for i in 1..count {
            if prims[i] != prims[kept - 1] {
                prims[kept] = prims[i];
                kept += 1;
            }
        }
        let first = part.filled.len();
        for block in prims[..kept].chunks(LANES) {
            part.filled.push(block.len() as u8);
            fill(&mut part.slots, block);
        }
        Child::leaf(first, part.filled.len() - first)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::Structure;
    use super::super::super::bvh::{Build, grouped};
    use super::super::super::testbed::{assert_same_on_threads, mesh, soup};
    use super::*;
    use crate::geometry::Vec3;

    #[test]
    fn one_thread_and_many_collapse_to_the_same_tree() {
        // Large enough for subtrees that are made apart, with cut triangles too.
        let mesh = mesh(&soup(60_000, 0.05, 4));
        for build in [Build::Binned, Build::Presplit, Build::SbvhReinsert] {
            let tree = grouped(&mesh, build);
            assert!(tree.nodes.len() > 3 * APART);
            let (wide, slots) = BvhWide::collapse(&tree, &mesh);
            assert_eq!(wide.validate(&mesh, &slots), Ok(()));
            assert_same_on_threads(|| BvhWide::collapse(&tree, &mesh));
        }
    }

    #[test]
    fn a_few_triangles_far_away_are_a_leaf_beside_all_others() {
        // The first splits put a group beside thousands: room for nodes that a group does not need lies before those
        // of its neighbour.
        for many in [20, 5000, 20_000] {
            for few in [1, 3, 8] {
                for far in [-1e3, 1e3] {
                    let mut triangles = soup(few, 0.1, 5);
                    for corner in triangles.as_flattened_mut() {
                        *corner += Vec3::splat(far);
                    }
                    triangles.extend(soup(many, 0.05, 6));
                    let mesh = mesh(&triangles);
                    let tree = grouped(&mesh, Build::Binned);
                    let (wide, slots) = BvhWide::collapse(&tree, &mesh);
                    assert_eq!(wide.validate(&mesh, &slots), Ok(()));
                    let is_few = |leaf: Child| leaf.is_leaf() && wide.references(leaf) == few;
                    let top = wide.nodes[0].children();
                    assert!(top.into_iter().any(|(child, _)| is_few(child)));
                }
            }
        }
    }
}
