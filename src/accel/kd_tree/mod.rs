//! A binary tree of axis-parallel planes. Leaves tile the scene's box; a triangle is referenced by every leaf it
//! reaches into.
//!
//! ```text
//!   +-----+--+-------+      nodes, 8 bytes each, depth first:   | x=5 | y=3 | leaf | leaf | leaf |
//!   |     |  |   A   |                                             |            below ^      ^
//!   |     |  +-------+      the child below the plane follows at once; the node names the one above it
//!   |     |  |   B   |
//!   +-----+--+-------+      references of leaves: | 4 7 9 | 2 4 | ...
//! ```
//!
//! The traversal follows the ray from leaf to leaf. At a plane it computes when the ray leaves the near side at the
//! latest and enters the far side at the earliest; where a ray meets a plane at the end of its interval, or lies in
//! it, both sides are visited.
//!
//! **Source:** I. Wald and V. Havran, "On building fast kd-Trees for Ray Tracing, and on doing that in O(N log N)",
//! 2006, for the build; M. Pharr, W. Jakob and G. Humphreys, "Physically Based Rendering", 3rd ed., §4.4, for the nodes.
//! **Differs:** the near side is told by the direction, not by the origin, so an origin on a plane is no special case;
//! planes on the faces of a cell are not considered, so no cell is flat unless the scene is; the bonus for empty space
//! asks for a tenth of the cell, else a fan of triangles around a vertex is trimmed by slivers without end.

use crate::geometry::lanes::Isa;
use crate::geometry::{Aabb, Ray};
use crate::registry::{ParamKind, ParamSpec, Params};
use crate::scene::Mesh;

use super::slab::{SlabRay, corners};
use super::stack::{MAX_DEPTH, Room, Stack, room};
use super::{AcceleratorEntry, Singles, Structure, StructureStats, Visitor, finish};

mod build;
mod part;
mod plane;
mod validate;

pub(super) const ENTRY: AcceleratorEntry = AcceleratorEntry {
    name: "kd-tree",
    about: "A tree of axis-parallel planes, placed by the surface area heuristic, that tiles space.",
    paper: "Wald and Havran 2006, On building fast kd-Trees for Ray Tracing, and on doing that in O(N log N)",
    params: &[ParamSpec {
        name: "clip",
        about: "Whether triangles are clipped to the cells that they are counted in.",
        kind: ParamKind::Choice(&["on", "off"]),
        default: "on",
    }],
    control: false,
    resolution: None,
    peer: None,
    build: |request| finish(KdTree::build(request.mesh, request.params), request),
};

/// The axis of a leaf.
const LEAF: u32 = 3;

/// A split plane, or a leaf.
///
/// `tag & 3` is the axis, or [`LEAF`]. An interior node has the plane's coordinate in `value` and its second child at
/// `tag >> 2`, the first one follows it; a leaf lists `tag >> 2` references from `value` on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
struct Node {
    value: u32,
    tag: u32,
}

impl Node {
    fn leaf(first: u32, count: u32) -> Self {
        Self {
            value: first,
            tag: count << 2 | LEAF,
        }
    }

    fn interior(axis: usize, plane: f32, above: u32) -> Self {
        Self {
            value: plane.to_bits(),
            tag: above << 2 | axis as u32,
        }
    }

    fn is_leaf(self) -> bool {
        self.tag & 3 == LEAF
    }

    fn axis(self) -> usize {
        (self.tag & 3) as usize
    }

    fn plane(self) -> f32 {
        f32::from_bits(self.value)
    }

    /// The second child of an interior node.
    fn above(self) -> u32 {
        self.tag >> 2
    }

    /// References of a leaf; 0 for an interior node.
    fn count(self) -> u32 {
        if self.is_leaf() { self.tag >> 2 } else { 0 }
    }
}

/// The structure `kd-tree`.
#[derive(Debug, Clone, PartialEq)]
pub struct KdTree {
    /// The root is first; there is always one.
    nodes: Vec<Node>,
    references: Vec<u32>,
    bounds: Aabb,
}

impl KdTree {
    /// Builds the tree over `mesh`, in parallel in the rayon pool it is called in; the same tree whatever its threads.
    #[must_use]
    pub fn build(mesh: &Mesh, params: &Params) -> Self {
        let (nodes, references) = build::build(mesh, params.text("clip") != "off");
        Self {
            nodes,
            references,
            bounds: mesh.bounds(),
        }
    }

    fn references_of(&self, leaf: Node) -> &[u32] {
        &self.references[leaf.value as usize..][..leaf.count() as usize]
    }
}

/// The two parts of the cell of an interior node.
fn halves(cell: &Aabb, node: Node) -> [Aabb; 2] {
    let (mut below, mut above) = (*cell, *cell);
    below.max[node.axis()] = node.plane();
    above.min[node.axis()] = node.plane();
    [below, above]
}

impl Structure for KdTree {
    type Items = Singles;
    type Scratch = Room;

    fn scratch(&self) -> Room {
        room()
    }

    #[inline(always)]
    fn traverse<I: Isa, V: Visitor>(&self, ray: &Ray, room: &mut Room, visitor: &mut V) {
        let slabs = SlabRay::new(ray, &self.bounds);
        let Some((mut entry, mut exit)) = slabs.interval(&corners(self.bounds), visitor.t_limit())
        else {
            return;
        };
        let mut stack = Stack::new(room);
        let mut place = 0;
        loop {
            let node = self.nodes[place as usize];
            visitor.step(
                u64::from(place),
                node.is_leaf(),
                node.count(),
                f64::from(entry),
                f64::from(exit),
            );
            if !node.is_leaf() {
                let (near_exit, far_entry, near) =
                    slabs.cut(node.axis(), node.plane(), entry, exit);
                let sides = [place + 1, node.above()];
                let (near, far) = (sides[near & 1], sides[near & 1 ^ 1]);
                if near_exit < entry {
                    place = far;
                } else {
                    if far_entry <= exit {
                        stack.push(far, far_entry, exit);
                    }
                    (place, exit) = (near, near_exit);
                }
                continue;
            }
            for &prim in self.references_of(node) {
                if visitor.test(prim) {
                    return;
                }
            }
            // What waits below a dropped node may begin earlier than it, by the pad, so all are looked at.
            let Some(next) = stack.pop(visitor.t_limit()) else {
                return;
            };
            (place, entry, exit) = (next.node, next.entry, next.exit);
        }
    }

    fn place_bounds(&self, place: u64) -> Option<Aabb> {
        let place = u32::try_from(place).ok()?;
        self.nodes.get(place as usize)?;
        let (mut cell, mut at) = (self.bounds, 0);
        // Nodes lie depth first: what is below a plane comes before its second child.
        while at != place {
            let node = self.nodes[at as usize];
            let [below, above] = halves(&cell, node);
            (cell, at) = if place < node.above() {
                (below, at + 1)
            } else {
                (above, node.above())
            };
        }
        Some(cell)
    }

    fn stats(&self) -> StructureStats {
        let leaves = || self.nodes.iter().filter(|n| n.is_leaf());
        StructureStats {
            cells: self.nodes.len() as u64,
            empty_cells: leaves().filter(|n| n.count() == 0).count() as u64,
            references: self.references.len() as u64,
            depth: validate::depth(&self.nodes),
            longest_list: leaves().map(|n| n.count()).max().unwrap_or(0),
            dims: None,
        }
    }

    fn memory_bytes(&self) -> u64 {
        (size_of_val(self.nodes.as_slice()) + size_of_val(self.references.as_slice())) as u64
    }

    fn validate(&self, mesh: &Mesh, _: &[u32]) -> Result<(), String> {
        validate::validate(self, mesh)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testbed::{
        assert_agrees, built, geometric, mesh, nasty, ray_count, rays, soup, sphere,
    };
    use super::*;
    use proptest::prelude::*;

    fn tree(mesh: &Mesh) -> KdTree {
        let tree = KdTree::build(mesh, &Params::defaults(ENTRY.params));
        tree.validate(mesh, &[]).expect("valid");
        tree
    }

    #[test]
    fn nasty_meshes_are_answered_as_by_brute_force() {
        for (name, mesh) in nasty() {
            for accel in ["kd-tree", "kd-tree:clip=off"] {
                assert_agrees(name, &mesh, accel, &rays(&mesh, ray_count(&mesh), 7));
            }
        }
    }

    #[test]
    fn one_thread_and_many_build_the_same_tree() {
        let mesh = mesh(&soup(10_000, 0.05, 10));
        let build = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().expect("a pool").install(|| tree(&mesh))
        };
        assert_eq!(build(1), build(5));
    }

    #[test]
    fn identical_triangles_end_in_one_leaf_at_once() {
        let twin = soup(1, 1.0, 3)[0];
        let stats = tree(&mesh(&vec![twin; 10_000])).stats();
        assert_eq!((stats.depth, stats.references), (0, 10_000));
    }

    #[test]
    fn the_depth_stays_bounded_where_planes_peel_off_one_triangle_at_a_time() {
        let stats = tree(&mesh(&geometric(-120..149).repeat(20))).stats();
        assert!(
            stats.depth > 20 && stats.depth <= MAX_DEPTH as u32,
            "{stats:?}"
        );
    }

    #[test]
    fn clipping_saves_references() {
        let mesh = mesh(&soup(2000, 0.3, 5));
        let references = |accel| built(&mesh, accel, "moller-trumbore").stats().references;
        assert!(references("kd-tree") < references("kd-tree:clip=off"));
    }

    #[test]
    fn nodes_and_references_grow_in_proportion_to_the_triangles() {
        let per_triangle = |n: u32| {
            let mesh = mesh(&sphere(n));
            let stats = tree(&mesh).stats();
            (stats.cells + stats.references) as f64 / mesh.len() as f64
        };
        let (small, large) = (per_triangle(10), per_triangle(80));
        assert!(large < 2.0 * small, "{small} and {large} a triangle");
    }

    #[test]
    fn empty_space_is_cut_off() {
        let mesh = mesh(&sphere(32));
        assert!(tree(&mesh).stats().empty_cells > 50);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn any_soup_is_answered_as_by_brute_force(
            count in 0_u32..120,
            size in prop_oneof![Just(0.0_f32), 1e-4_f32..2.0],
            seed in any::<u64>(),
        ) {
            let mesh = mesh(&soup(count, size, seed));
            assert_agrees("soup", &mesh, "kd-tree", &rays(&mesh, 200, seed ^ 1));
        }
    }
}
