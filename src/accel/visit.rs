//! Visitors: what a traversal reports to. One visitor bundles the query (closest hit or occlusion), the counter (real or
//! compiled away) and the kernel, so that a traversal is written once.

use crate::geometry::lanes::LaneRay;
use crate::geometry::{Hit, Ray};
use crate::kernel::{Kernel, LaneHit};
use crate::scene::Mesh;

/// What a traversal reports to.
pub trait Visitor {
    /// A cell or node was entered; `entry` and `exit` are the ray's `t` there, `references` is how many triangles it
    /// lists (0 for an interior node) and `leaf` whether it can list any.
    fn step(&mut self, place: u64, leaf: bool, references: u32, entry: f64, exit: f64);

    /// Tests a triangle; returns true when the query is finished and the traversal must return.
    fn test(&mut self, prim: u32) -> bool;

    /// A triangle was not tested, because this ray had tested it before.
    #[inline(always)]
    fn skipped(&mut self, _prim: u32) {}

    /// Nothing that begins beyond this `t` can change the answer; what begins at it still can.
    fn t_limit(&self) -> f32;
}

/// The work of one ray.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Cells or nodes visited.
    pub steps: u64,
    /// Of these, cells or leaves without a reference.
    pub empty_steps: u64,
    /// Ray/triangle tests.
    pub tests: u64,
    /// Of these, tests of a triangle that this ray had tested before.
    pub duplicate_tests: u64,
}

/// Counts, or compiles away.
pub(super) trait Counter {
    /// The next ray begins.
    fn begin(&mut self);
    /// See [`Visitor::step`].
    fn step(&mut self, place: u64, leaf: bool, references: u32, entry: f64, exit: f64);
    /// A triangle was tested: the kernel's `t` where it found a hit, and whether that became the nearest.
    fn test(&mut self, prim: u32, t: Option<f32>, nearest: bool);
    /// See [`Visitor::skipped`].
    #[inline(always)]
    fn skipped(&mut self, _prim: u32) {}
}

/// Counts nothing; every call compiles away.
pub(super) struct Uncounted;

impl Counter for Uncounted {
    #[inline(always)]
    fn begin(&mut self) {}
    #[inline(always)]
    fn step(&mut self, _: u64, _: bool, _: u32, _: f64, _: f64) {}
    #[inline(always)]
    fn test(&mut self, _: u32, _: Option<f32>, _: bool) {}
}

/// Counts the work of one ray after another.
pub(super) struct Counted {
    /// The work of the ray that was begun last.
    pub counts: Counts,
    ray: u32,
    /// For each triangle the number of the ray that tested it last.
    tested_by: Vec<u32>,
}

impl Counted {
    pub fn new(triangles: usize) -> Self {
        Self {
            counts: Counts::default(),
            ray: 0,
            tested_by: vec![0; triangles],
        }
    }
}

impl Counter for Counted {
    fn begin(&mut self) {
        // A batch holds fewer than 2³² rays, so a number never returns.
        self.ray += 1;
        self.counts = Counts::default();
    }

    fn step(&mut self, _: u64, leaf: bool, references: u32, _: f64, _: f64) {
        self.counts.steps += 1;
        self.counts.empty_steps += u64::from(leaf && references == 0);
    }

    fn test(&mut self, prim: u32, _: Option<f32>, _: bool) {
        let last = std::mem::replace(&mut self.tested_by[prim as usize], self.ray);
        self.counts.tests += 1;
        self.counts.duplicate_tests += u64::from(last == self.ray);
    }
}

/// The triangles of a mesh, packed for a kernel one by one.
#[derive(Clone, Copy)]
pub(super) struct PackedMesh<'a, K: Kernel> {
    pub kernel: &'a K,
    pub mesh: &'a Mesh,
    pub triangles: &'a [K::Packed<1>],
}

/// Keeps the nearest hit. `OCCLUSION`: any hit will do.
pub(super) struct Query<'a, K: Kernel, C: Counter, const OCCLUSION: bool> {
    packed: PackedMesh<'a, K>,
    ray: &'a Ray,
    prepared: K::Prepared<1, f32>,
    pub best: Hit,
    limit: f32,
    counter: &'a mut C,
}

impl<'a, K: Kernel, C: Counter, const OCCLUSION: bool> Query<'a, K, C, OCCLUSION> {
    #[inline(always)]
    pub fn new(packed: PackedMesh<'a, K>, ray: &'a Ray, counter: &'a mut C) -> Self {
        counter.begin();
        Self {
            prepared: packed.kernel.prepare(ray, &LaneRay::splat(ray)),
            packed,
            ray,
            best: Hit::MISS,
            limit: ray.t_max,
            counter,
        }
    }

    /// Takes a hit that is nearer, or equally near with a lower index; for occlusion any within the interval. Whether it
    /// was taken.
    #[inline(always)]
    fn offer(&mut self, prim: u32, hit: LaneHit<1, f32>) -> bool {
        let PackedMesh { kernel, mesh, .. } = self.packed;
        let LaneHit { t, u, v, .. } = hit;
        let hit = Hit { t, u, v, prim };
        if !kernel.within(mesh, self.ray, &hit) {
            return false;
        }
        if OCCLUSION {
            self.best.prim = prim;
            return true;
        }
        if kernel.nearer(mesh, self.ray, &hit, &self.best) {
            self.best = hit;
            let error = kernel.t_error(self.ray, &mesh.corners(prim), hit.t);
            self.limit = self.limit.min(hit.t + error);
            return true;
        }
        false
    }
}

impl<K: Kernel, C: Counter, const OCCLUSION: bool> Visitor for Query<'_, K, C, OCCLUSION> {
    #[inline(always)]
    fn step(&mut self, place: u64, leaf: bool, references: u32, entry: f64, exit: f64) {
        self.counter.step(place, leaf, references, entry, exit);
    }

    #[inline(always)]
    fn test(&mut self, prim: u32) -> bool {
        let found = self
            .packed
            .kernel
            .intersect(&self.prepared, &self.packed.triangles[prim as usize]);
        let Some(hit) = found else {
            self.counter.test(prim, None, false);
            return false;
        };
        let taken = self.offer(prim, hit);
        self.counter.test(prim, Some(hit.t), taken);
        OCCLUSION && taken
    }

    #[inline(always)]
    fn skipped(&mut self, prim: u32) {
        self.counter.skipped(prim);
    }

    #[inline(always)]
    fn t_limit(&self) -> f32 {
        self.limit
    }
}
