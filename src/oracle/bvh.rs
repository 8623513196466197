//! The oracle's own way to find candidates: a median-split tree of boxes, plain and conservative.
//!
//! It shares nothing with the accelerators it judges. Boxes are exact, as the corners are `f32`; the slab test runs in
//! `f64`, where it cannot overflow, and is padded by more than its rounding.

use crate::geometry::{Aabb, DVec3, Ray, Vec3};
use crate::scene::Mesh;

/// Most triangles of a leaf.
const LEAF: usize = 4;

/// Relative padding of a slab's `t`: a difference, an inverse and a product round by 3·2⁻⁵³.
const PAD: f64 = 8.0 * 1.110_223_024_625_156_5e-16;

#[derive(Debug, Clone, Copy)]
struct Node {
    aabb: Aabb,
    /// A leaf's first entry in `prims`; an interior node's second child, the first one being the next node.
    start: u32,
    /// Triangles of a leaf; 0 in an interior node.
    count: u32,
}

/// A tree over the triangles of one mesh.
#[derive(Debug)]
pub(super) struct Bvh {
    nodes: Vec<Node>,
    prims: Vec<u32>,
}

/// A ray as boxes see it. The inverse of the least `f32` is no infinity in `f64`.
struct Line {
    origin: DVec3,
    dir: DVec3,
    inverse: DVec3,
}

/// The interval of `t` in which the line is within the box, padded outwards; `None` if it never is.
fn slabs(aabb: &Aabb, line: &Line) -> Option<(f64, f64)> {
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let (lo, hi) = (f64::from(aabb.min[axis]), f64::from(aabb.max[axis]));
        let o = line.origin[axis];
        if line.dir[axis] == 0.0 {
            if o < lo || o > hi {
                return None;
            }
            continue;
        }
        let inverse = line.inverse[axis];
        let (a, b) = ((lo - o) * inverse, (hi - o) * inverse);
        let (a, b) = if a < b { (a, b) } else { (b, a) };
        near = near.max(a - PAD * a.abs());
        far = far.min(b + PAD * b.abs());
    }
    (near <= far).then_some((near, far))
}

impl Bvh {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let count = mesh.len() as u32;
        let centres: Vec<Vec3> = (0..count)
            .map(|p| mesh.triangle_bounds(p).centre())
            .collect();
        let mut bvh = Self {
            nodes: Vec::with_capacity(mesh.len()),
            prims: (0..count).collect(),
        };
        let mut prims = std::mem::take(&mut bvh.prims);
        if !prims.is_empty() {
            bvh.split(mesh, &centres, &mut prims, 0);
        }
        bvh.prims = prims;
        bvh
    }

    /// Makes the node of `prims`, which begin at `start` in the whole list, and those below it. The median halves the
    /// list, so the depth is the logarithm of its length whatever the triangles are.
    fn split(&mut self, mesh: &Mesh, centres: &[Vec3], prims: &mut [u32], start: usize) {
        let bounds = prims
            .iter()
            .fold(Aabb::EMPTY, |b, &p| b.union(mesh.triangle_bounds(p)));
        let node = self.nodes.len();
        self.nodes.push(Node {
            aabb: bounds,
            start: start as u32,
            count: prims.len() as u32,
        });
        if prims.len() <= LEAF {
            return;
        }
        let axis = Aabb::of_points(prims.iter().map(|&p| centres[p as usize])).longest_axis();
        let middle = prims.len() / 2;
        prims.select_nth_unstable_by(middle, |&p, &q| {
            centres[p as usize][axis].total_cmp(&centres[q as usize][axis])
        });
        let (left, right) = prims.split_at_mut(middle);
        self.split(mesh, centres, left, start);
        self.nodes[node].start = self.nodes.len() as u32;
        self.nodes[node].count = 0;
        self.split(mesh, centres, right, start + middle);
    }

    /// Offers `visit` every triangle whose box the ray meets no later than the `t` that `visit` answered last, nearer
    /// boxes first. Answering negative infinity ends the search.
    pub(super) fn visit(&self, ray: &Ray, mut visit: impl FnMut(u32) -> f64) {
        let t_min = f64::from(ray.t_min);
        let mut limit = f64::from(ray.t_max);
        // Twice the depth of a tree over 2^31 triangles would fit.
        let mut stack = Vec::with_capacity(64);
        let dir = ray.dir.as_dvec3();
        let line = Line {
            origin: ray.origin.as_dvec3(),
            dir,
            inverse: dir.recip(),
        };
        let enter = |node: u32| {
            let (near, far) = slabs(&self.nodes[node as usize].aabb, &line)?;
            (far >= t_min).then_some((near, node))
        };
        stack.extend(self.nodes.first().and_then(|_| enter(0)));
        while let Some((near, index)) = stack.pop() {
            if near > limit {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.count == 0 {
                let children = [enter(index + 1), enter(node.start)];
                match children {
                    [Some(a), Some(b)] if a.0 <= b.0 => stack.extend([b, a]),
                    _ => stack.extend(children.into_iter().flatten()),
                }
                continue;
            }
            let first = node.start as usize;
            for &prim in &self.prims[first..first + node.count as usize] {
                limit = limit.min(visit(prim));
            }
        }
    }
}
