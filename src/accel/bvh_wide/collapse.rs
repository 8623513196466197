//! The collapse of a binary tree into an eight-ary one.
//!
//! First it is planned from the bottom up which subtrees become the children of one node, see [`plan`]; then the nodes are
//! made from the top down. Both are shared among threads. Small subtrees are made apart and put behind each other, in the
//! order in which they were found, whatever the number of threads.

use std::cmp::Reverse;

use crate::scene::Mesh;

use super::super::bvh::{BinaryTree, Node as BinaryNode};
use super::super::pages;
use super::super::parallel;
use super::super::sah::half_area;
use super::super::slab::Scene;
use super::{BvhWide, Child, Node};

use filling::{Filling, Prims};
use plan::{APART, Choice, Subtree, WIDTH, choices};

mod filling;
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
    blocks: Filling,
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
        let (nodes, blocks) = (self.nodes.len() as u32, self.blocks.filled.len() as u32);
        self.nodes.extend(part.nodes.iter().map(|node| {
            Node {
                boxes: node.boxes,
                children: node
                    .children
                    .map(|child| Child(child).moved(nodes, blocks).0),
            }
        }));
        self.blocks.append(&part.blocks);
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

/// Binary nodes below a subtree from which on its children are ordered by [`Collapse::promise`]; with all of them ordered so, the
/// steps of a shadow ray are within 1.5 % on ten meshes.
const LARGE: usize = 256;

/// A binary tree and how it is best spread.
struct Collapse<'a> {
    nodes: &'a [BinaryNode],
    references: &'a [u32],
    choices: Vec<Choice>,
    /// The areas of the leaves before each node, and of all at the end.
    leaves: Vec<f64>,
}

impl BvhWide {
    /// Collapses `tree`, whose leaves hold at most as many references as a block has lanes each; also returns the triangle
    /// of every lane of every block.
    pub(super) fn collapse(tree: &BinaryTree, mesh: &Mesh) -> (Self, Vec<u32>) {
        let mut part = Part {
            nodes: pages::with_capacity(tree.nodes.len() / 8),
            blocks: Filling::with_capacity(tree.references.len()),
            ..Part::default()
        };
        let root = if tree.nodes.is_empty() {
            Child::NONE
        } else {
            let collapse = Collapse {
                nodes: &tree.nodes,
                references: &tree.references,
                choices: choices(tree),
                leaves: leaf_areas(&tree.nodes),
            };
            collapse.all(&mut part)
        };
        let wide = Self {
            nodes: part.nodes,
            root,
            scene: Scene::new(mesh.bounds()),
            filled: part.blocks.filled,
            depth: part.depth,
            way: None,
        };
        (wide, part.blocks.slots)
    }
}

/// The areas of the leaves among `nodes` before each of them, and of all at the end.
fn leaf_areas(nodes: &[BinaryNode]) -> Vec<f64> {
    let mut areas = pages::with_capacity(nodes.len() + 1);
    let mut sum = 0.0;
    areas.push(sum);
    for node in nodes {
        if node.is_leaf() {
            sum += half_area(&node.bounds());
        }
        areas.push(sum);
    }
    areas
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
                top.blocks.close();
                let child = self.child(apart.subtree, apart.depth, top);
                top.nodes[apart.node].children[apart.lane] = child.0;
            }
            return root;
        }
        let parts = parallel::map(all_apart.len(), 1, |i| {
            let apart = &all_apart[i];
            let mut part = Part::default();
            (self.child(apart.subtree, apart.depth, &mut part), part)
        });
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
            return part.blocks.leaf(&self.prims(subtree));
        }
        let mut lanes = Lanes {
            subtrees: [Subtree::NONE; WIDTH],
            count: 0,
        };
        self.divide(subtree, WIDTH, &mut lanes);
        // Where any hit will do the last lane is visited first: near the root what promises most, farther down the largest box.
        let is_large = subtree.below(self.nodes) >= LARGE;
        let mut sorted = [(0.0, Subtree::NONE); WIDTH];
        for (sorted, subtree) in sorted.iter_mut().zip(&lanes.subtrees[..lanes.count]) {
            let key = if is_large {
                self.promise(*subtree)
            } else {
                half_area(&self.nodes[subtree.root].bounds())
            };
            *sorted = (key, *subtree);
        }
        sorted[..lanes.count].sort_by(|a, b| a.0.total_cmp(&b.0));
        let node = part.nodes.len();
        part.nodes.push(Node::EMPTY);
        let sorted = sorted.map(|(_, subtree)| subtree);
        let sorted = &sorted[..lanes.count];
        let leaves = self.leaves(sorted, &mut part.blocks);
        for (lane, subtree) in sorted.iter().enumerate() {
            let child = if self.choices[subtree.root].is_leaf() {
                part.depth = part.depth.max(depth + 1);
                leaves[lane]
            } else if subtree.below(self.nodes) < part.least {
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

    /// How much a subtree is worth to be visited before its neighbours by a ray that any hit will block.
    ///
    /// It blocks a ray that meets its box the likelier, the greater the areas of its leaves are against the box's,
    /// 1 - e^(-l / b); what it costs to learn goes with its depth; and larger boxes are met by more rays of a group, b^¼. Steps a
    /// shadow ray, largest box first and so: sponza 5.2 to 3.7, CAD counter 5.5 to 5.2, eight other meshes within 3 %; rays a
    /// second follow. Without the last factor: bunny 11.8 to 10.7, Nefertiti 11.6 to 9.7, but armadillo 10.1 to 12.3. With areas
    /// of triangles, which take longer to look up, alike.
    fn promise(&self, subtree: Subtree) -> f64 {
        let root = &self.nodes[subtree.root];
        let area = half_area(&root.bounds());
        let leaves = if root.is_leaf() {
            area
        } else {
            self.leaves[subtree.end] - self.leaves[root.first as usize]
        };
        let references = subtree.references(self.nodes).len() as f64;
        let blocks = 1.0 - (-leaves / area.max(f64::MIN_POSITIVE)).exp();
        blocks * area.sqrt().sqrt() / (2.0 + references.log2())
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

    /// Makes the leaves among the children of a node, the fullest first, so that the others find room.
    fn leaves(&self, children: &[Subtree], blocks: &mut Filling) -> [Child; WIDTH] {
        let mut leaves = [Child::NONE; WIDTH];
        let mut waiting = [(Prims::NONE, 0); WIDTH];
        let mut count = 0;
        for (lane, subtree) in children.iter().enumerate() {
            if self.choices[subtree.root].is_leaf() {
                waiting[count] = (self.prims(*subtree), lane);
                count += 1;
            }
        }
        let waiting = &mut waiting[..count];
        waiting.sort_by_key(|(prims, _)| Reverse(prims.count()));
        for (prims, lane) in waiting {
            leaves[*lane] = blocks.leaf(prims);
        }
        leaves
    }

    /// The triangles of `subtree`.
    fn prims(&self, subtree: Subtree) -> Prims {
        Prims::of(&self.references[subtree.references(self.nodes)])
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::Structure;
    use super::super::super::bvh::{Build, grouped};
    use super::super::super::items::LANES;
    use super::super::super::testbed::{assert_same_on_threads, mesh, soup};
    use super::*;
    use crate::geometry::{Aabb, Vec3};

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
    fn a_wall_is_visited_before_larger_boxes_of_dust_by_rays_that_any_hit_blocks() {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 3.0);
        let (a, b, c, d) = (
            corner(0.0, 0.0),
            corner(1.0, 0.0),
            corner(1.0, 1.0),
            corner(0.0, 1.0),
        );
        let mut triangles = soup(5000, 0.001, 5);
        triangles.extend([[a, b, c], [a, c, d]]);
        let mesh = mesh(&triangles);
        let tree = grouped(&mesh, Build::Binned);
        let (wide, slots) = BvhWide::collapse(&tree, &mesh);
        let top: Vec<(Child, Aabb)> = wide.nodes[0].children().collect();
        let (last, wall) = *top
            .iter()
            .rfind(|(child, _)| *child != Child::NONE)
            .unwrap();
        let blocks = last.blocks();
        let lanes = blocks.start as usize * LANES..blocks.end as usize * LANES;
        assert!(last.is_leaf() && slots[lanes].contains(&5000));
        assert!(
            top.iter()
                .any(|(_, dust)| half_area(dust) > half_area(&wall))
        );
    }

    #[test]
    fn a_few_triangles_far_away_are_a_leaf_beside_all_others() {
        // The first splits put a group beside thousands.
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
                    // They may share their block with others.
                    let is_few = |leaf: Child| {
                        let blocks = leaf.blocks();
                        let lanes = blocks.start as usize * LANES..blocks.end as usize * LANES;
                        leaf.is_leaf() && (0..few).all(|prim| slots[lanes.clone()].contains(&prim))
                    };
                    let top = wide.nodes[0].children();
                    assert!(top.into_iter().any(|(child, _)| is_few(child)));
                }
            }
        }
    }
}
