//! `bvh-crate`: the binary tree of the crate bvh, with the run's kernel in its leaves.
//!
//! **Source:** S.-H. Haase and A. Dmitriev, crate bvh 0.13: SAH in six buckets, one triangle a leaf.
//! **Differs:** its own triangle test is not used: it culls back faces and takes determinants below an absolute epsilon
//! for parallel, so most answers would be wrong. Triangles are asked for by its iterator of boxes from near to far, until
//! a box begins beyond the nearest hit; its other iterators keep their way in 32 entries and panic on deeper trees. Its
//! box test misses boxes that the ray touches only in the plane of a face.

use ::bvh::aabb::{Aabb as CrateAabb, Bounded};
use ::bvh::bounding_hierarchy::BHShape;
use ::bvh::bvh::{Bvh, rayon_executor};
use ::bvh::ray::Ray as CrateRay;
use nalgebra::{Point3, Vector3};

use crate::accel::{AcceleratorEntry, BuildError, BuildRequest, StructureStats};
use crate::geometry::{Aabb, Ray, Vec3};

use super::tested::{Next, Tree, finish};
use super::{Peer, forward, refuse_enormous};

pub(in crate::accel) const ENTRY: AcceleratorEntry = AcceleratorEntry {
    name: "bvh-crate",
    about: "A peer: the binary tree of the crate bvh.",
    paper: "Haase, Dmitriev 2026, crate bvh 0.13",
    params: &[],
    control: false,
    resolution: None,
    peer: Some(Peer::COMPILED_IN),
    build: |request| finish(Tree3::build(request)?, request),
};

/// A triangle as the crate sees it: a box.
#[derive(Debug, Clone, Copy)]
struct Shape {
    bounds: CrateAabb<f32, 3>,
    prim: u32,
    node: usize,
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> CrateAabb<f32, 3> {
        self.bounds
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, node: usize) {
        self.node = node;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

fn point(p: Vec3) -> Point3<f32> {
    Point3::new(p.x, p.y, p.z)
}

/// The tree with the boxes that its leaves name.
struct Tree3 {
    bvh: Bvh<f32, 3>,
    shapes: Vec<Shape>,
    bounds: Aabb,
}

impl Tree3 {
    fn build(request: &BuildRequest) -> Result<Self, BuildError> {
        let mesh = request.mesh;
        refuse_enormous(mesh, ENTRY.name)?;
        let mut shapes: Vec<Shape> = (0..mesh.len() as u32)
            .map(|prim| {
                let bounds = mesh.triangle_bounds(prim);
                Shape {
                    bounds: CrateAabb::with_bounds(point(bounds.min), point(bounds.max)),
                    prim,
                    node: 0,
                }
            })
            .collect();
        Ok(Self {
            bvh: Bvh::build_with_executor(&mut shapes, rayon_executor),
            shapes,
            bounds: mesh.bounds(),
        })
    }
}

impl Tree for Tree3 {
    #[inline(always)]
    fn traverse(&self, ray: &Ray, mut test: impl FnMut(usize) -> Next) {
        let (ray, start) = forward(ray, &self.bounds);
        // The crate scales directions to unit length, and counts t in lengths.
        let length = ray.dir.length();
        let dir = Vector3::new(ray.dir.x, ray.dir.y, ray.dir.z);
        let crate_ray = CrateRay::new(point(ray.origin), dir);
        let mut limit = ray.t_max * length;
        for shape in self.bvh.nearest_traverse_iterator(&crate_ray, &self.shapes) {
            let entry = crate_ray.intersection_slice_for_aabb(&shape.bounds);
            if entry.is_some_and(|(entry, _)| entry > limit) {
                return;
            }
            match test(shape.prim as usize) {
                Next::Continue(t) => limit = (t - start) * length,
                Next::Break(()) => return,
            }
        }
    }

    fn places(&self) -> Vec<u32> {
        (0..self.shapes.len() as u32).collect()
    }

    fn stats(&self) -> StructureStats {
        StructureStats {
            cells: self.bvh.nodes.len() as u64,
            references: self.shapes.len() as u64,
            longest_list: u32::from(!self.shapes.is_empty()),
            ..StructureStats::default()
        }
    }

    fn memory_bytes(&self) -> u64 {
        let nodes = size_of_val(self.bvh.nodes.as_slice());
        (nodes + size_of_val(self.shapes.as_slice())) as u64
    }
}
