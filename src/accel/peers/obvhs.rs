//! `obvhs`: the trees of the crate obvhs, binary or eight wide and compressed, with the run's kernel in their leaves.
//!
//! **Source:** D. Griffin, crate obvhs 0.4: PLOC build with parallel reinsertion, Ylitie, Karras and Laine's
//! compressed wide nodes (HPG 2017).
//! **Differs:** its own test is not used, so that trees are compared and not tests; triangles lie in the order of its
//! leaves, as its documentation advises. Its box test is not conservative, and a wide tree deeper than its stack of 32
//! loses what it cannot hold.

use std::time::Duration;

use ::obvhs::bvh2::Bvh2;
use ::obvhs::bvh2::builder::build_bvh2_from_tris;
use ::obvhs::cwbvh::CwBvh;
use ::obvhs::cwbvh::builder::build_cwbvh_from_tris;
use ::obvhs::faststack::{FastStack, HeapStack, StackStack};
use ::obvhs::ray::{Ray as ObvhsRay, RayHit};
use ::obvhs::triangle::Triangle;
use ::obvhs::{BvhBuildParams, traverse};
use glam::{UVec2, Vec3A};

use crate::accel::{AcceleratorEntry, BuildError, BuildRequest, StructureStats};
use crate::geometry::{Aabb, Ray};
use crate::registry::{ParamKind, ParamSpec, Params};
use crate::scene::Mesh;

use super::tested::{Next, Tree, finish};
use super::{Peer, forward, refuse_enormous};

pub(in crate::accel) const ENTRY: AcceleratorEntry = AcceleratorEntry {
    name: "obvhs",
    about: "A peer: the binary or the eight-wide compressed tree of the crate obvhs.",
    paper: "Griffin 2025, crate obvhs 0.4; Ylitie, Karras, Laine 2017, Efficient Incoherent Ray Traversal on GPUs \
            Through Compressed Wide BVHs",
    params: &[
        ParamSpec {
            name: "build",
            about: "The crate's presets: the longer the build, the faster the tree.",
            kind: ParamKind::Choice(&["fast", "medium", "slow", "very-slow"]),
            default: "medium",
        },
        ParamSpec {
            name: "layout",
            about: "Binary nodes, or compressed nodes of eight.",
            kind: ParamKind::Choice(&["bvh2", "cwbvh"]),
            default: "bvh2",
        },
    ],
    control: false,
    resolution: None,
    peer: Some(Peer::COMPILED_IN),
    build: |request| match request.params.text("layout") {
        "cwbvh" => finish(Wide::build(request)?, request),
        _ => finish(Binary::build(request), request),
    },
};

/// Depth of the stack that needs no memory from the heap; the crate's own choice.
const ORDINARY_DEPTH: usize = 96;

/// The preset that `params` name.
fn preset(params: &Params) -> BvhBuildParams {
    match params.text("build") {
        "fast" => BvhBuildParams::fast_build(),
        "slow" => BvhBuildParams::slow_build(),
        "very-slow" => BvhBuildParams::very_slow_build(),
        _ => BvhBuildParams::medium_build(),
    }
}

/// The triangles in the crate's form.
fn triangles(mesh: &Mesh) -> Vec<Triangle> {
    (0..mesh.len() as u32)
        .map(|prim| {
            let [v0, v1, v2] = mesh.corners(prim).map(Vec3A::from);
            Triangle { v0, v1, v2 }
        })
        .collect()
}

/// The crate's ray along `ray` from where `t` is 0 or more, and that `t`.
fn crate_ray(ray: &Ray, bounds: &Aabb) -> (ObvhsRay, f32) {
    let (ray, start) = forward(ray, bounds);
    let (origin, dir) = (Vec3A::from(ray.origin), Vec3A::from(ray.dir));
    // Its comparisons are strict.
    let limit = ray.t_max.next_up();
    (ObvhsRay::new(origin, dir, ray.t_min, limit), start)
}

/// The binary tree.
struct Binary {
    bvh: Bvh2,
    bounds: Aabb,
}

impl Binary {
    fn build(request: &BuildRequest) -> Self {
        let mesh = request.mesh;
        let mut bvh = if mesh.is_empty() {
            Bvh2::default()
        } else {
            let mut time = Duration::ZERO;
            build_bvh2_from_tris(&triangles(mesh), preset(request.params), &mut time)
        };
        // The crate leaves this at the depth before its last passes, which can deepen the tree.
        bvh.max_depth = depth(&bvh) + 1;
        Self {
            bvh,
            bounds: mesh.bounds(),
        }
    }

    #[inline(always)]
    fn traverse_with(
        &self,
        stack: &mut impl FastStack<u32>,
        ray: &Ray,
        mut test: impl FnMut(usize) -> Next,
    ) {
        let (ray, start) = crate_ray(ray, &self.bounds);
        let mut hit = RayHit::none();
        self.bvh
            .ray_traverse_dynamic(stack, ray, &mut hit, |node, ray, _| {
                for place in node.first_index..node.first_index + node.prim_count {
                    match test(place as usize) {
                        Next::Continue(limit) => ray.tmax = (limit - start).next_up(),
                        Next::Break(()) => return false,
                    }
                }
                true
            });
    }
}

impl Tree for Binary {
    #[inline(always)]
    fn traverse(&self, ray: &Ray, test: impl FnMut(usize) -> Next) {
        if self.bvh.max_depth <= ORDINARY_DEPTH {
            let mut stack = StackStack::<u32, ORDINARY_DEPTH>::default();
            self.traverse_with(&mut stack, ray, test);
        } else {
            let mut stack = HeapStack::<u32>::new_with_capacity(self.bvh.max_depth);
            self.traverse_with(&mut stack, ray, test);
        }
    }

    fn places(&self) -> Vec<u32> {
        self.bvh.primitive_indices.clone()
    }

    fn stats(&self) -> StructureStats {
        let leaves = self.bvh.nodes.iter().filter(|node| node.is_leaf());
        StructureStats {
            cells: self.bvh.nodes.len() as u64,
            references: self.bvh.primitive_indices.len() as u64,
            depth: depth(&self.bvh) as u32,
            longest_list: leaves.map(|leaf| leaf.prim_count).max().unwrap_or(0),
            ..StructureStats::default()
        }
    }

    fn memory_bytes(&self) -> u64 {
        size_of_val(self.bvh.nodes.as_slice()) as u64
    }
}

/// Longest way from the root to a leaf.
fn depth(bvh: &Bvh2) -> usize {
    let mut deepest = 0;
    let mut open = vec![(0, 0)];
    while let Some((index, depth)) = open.pop() {
        deepest = deepest.max(depth);
        if let Some(node) = bvh.nodes.get(index).filter(|node| !node.is_leaf()) {
            let first = node.first_index as usize;
            open.extend([(first, depth + 1), (first + 1, depth + 1)]);
        }
    }
    deepest
}

/// The compressed tree of nodes with up to eight children.
struct Wide {
    bvh: CwBvh,
    bounds: Aabb,
}

impl Wide {
    fn build(request: &BuildRequest) -> Result<Self, BuildError> {
        let mesh = request.mesh;
        refuse_enormous(mesh, ENTRY.name)?;
        let bvh = if mesh.is_empty() {
            CwBvh::default()
        } else {
            let mut time = Duration::ZERO;
            build_cwbvh_from_tris(&triangles(mesh), preset(request.params), &mut time)
        };
        Ok(Self {
            bvh,
            bounds: mesh.bounds(),
        })
    }
}

impl Tree for Wide {
    #[inline(always)]
    fn traverse(&self, ray: &Ray, mut test: impl FnMut(usize) -> Next) {
        if self.bvh.nodes.is_empty() {
            return;
        }
        let (mut ray, start) = crate_ray(ray, &self.bounds);
        let mut state = self.bvh.new_traversal(ray.direction);
        let mut node;
        'done: {
            traverse!(
                self.bvh,
                node,
                state,
                node.intersect_ray(&ray, state.oct_inv4),
                {
                    match test(state.primitive_id as usize) {
                        Next::Continue(limit) => ray.tmax = (limit - start).next_up(),
                        Next::Break(()) => break 'done,
                    }
                }
            );
        }
    }

    fn places(&self) -> Vec<u32> {
        self.bvh.primitive_indices.clone()
    }

    fn stats(&self) -> StructureStats {
        StructureStats {
            cells: self.bvh.nodes.len() as u64,
            references: self.bvh.primitive_indices.len() as u64,
            // Its leaves hold at most three.
            ..StructureStats::default()
        }
    }

    fn memory_bytes(&self) -> u64 {
        size_of_val(self.bvh.nodes.as_slice()) as u64
    }
}
