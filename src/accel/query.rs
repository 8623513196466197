//! A query of one ray: it keeps the nearest hit of what a traversal offers.

use std::marker::PhantomData;

use crate::geometry::lanes::{Isa, Lane, LaneRay, Task};
use crate::geometry::{Hit, Ray};
use crate::kernel::{Kernel, PreparedRay};
use crate::scene::Mesh;

use super::items::Items;
use super::visit::{Counter, Visitor};

/// The triangles of a mesh, packed for a kernel as a structure lists them.
pub struct Packed<T: Items, K: Kernel> {
    pub kernel: K,
    pub mesh: std::sync::Arc<Mesh>,
    pub items: Vec<T::Item<K>>,
}

/// Keeps the nearest hit. `OCCLUSION`: any hit will do.
pub struct Query<'a, T: Items, K: Kernel, I: Isa, C: Counter, const OCCLUSION: bool> {
    pub packed: &'a Packed<T, K>,
    pub ray: &'a Ray,
    /// Made when the first item is tested, or before; one lane, spread where it is read: to write eight and read them back
    /// took longer.
    prepared: Option<K::Prepared<1, f32>>,
    lanes: PhantomData<I>,
    /// The answer so far.
    pub best: Hit,
    limit: f32,
    /// See [`Visitor::narrow`].
    counts: [f32; 2],
    pub counter: C,
}

impl<'a, T: Items, K: Kernel, I: Isa, C: Counter, const OCCLUSION: bool>
    Query<'a, T, K, I, C, OCCLUSION>
{
    #[inline(always)]
    pub fn new(packed: &'a Packed<T, K>, ray: &'a Ray, counter: C) -> Self {
        Self {
            prepared: None,
            lanes: PhantomData,
            packed,
            ray,
            best: Hit::MISS,
            limit: ray.t_max,
            counts: [f32::NEG_INFINITY, f32::INFINITY],
            counter,
        }
    }

    /// Forgets its ray and begins another.
    #[inline(always)]
    pub fn begin_again(&mut self, ray: &'a Ray) {
        self.prepared = None;
        self.ray = ray;
        self.best = Hit::MISS;
        self.limit = ray.t_max;
        self.counts = [f32::NEG_INFINITY, f32::INFINITY];
    }

    /// The ray in the kernel's form, made in advance or now.
    #[inline(always)]
    pub fn prepared<const W: usize, L: Lane<W>>(&mut self) -> K::Prepared<W, L> {
        let (kernel, ray) = (&self.packed.kernel, self.ray);
        if K::Prepared::<W, L>::CHEAP {
            return kernel.prepare(ray, &LaneRay::splat(ray));
        }
        let prepare = || kernel.prepare(ray, &LaneRay::splat(ray));
        K::Prepared::spread(self.prepared.get_or_insert_with(prepare))
    }

    /// Greatest `t` that can still be preferred, as far as an `f32` tells: the one above it for a kernel that compares more
    /// exactly.
    #[inline(always)]
    pub fn t_most(&self) -> f32 {
        let most = self.best.t.min(self.ray.t_max);
        if K::EXACT_T { most.next_up() } else { most }
    }

    /// Least `t` that can be accepted, likewise.
    #[inline(always)]
    pub fn t_least(&self) -> f32 {
        if K::EXACT_T {
            self.ray.t_min.next_down()
        } else {
            self.ray.t_min
        }
    }

    /// Ends a query that any hit will do; which triangle it was does not matter.
    #[inline(always)]
    pub fn block(&mut self) {
        self.best.prim = 0;
        self.limit = f32::NEG_INFINITY;
    }

    /// Takes a hit on the ray's line if it lies within the interval, and is nearer than the best or equally near with a lower
    /// index; for occlusion any. Whether it was taken. `bound`: see [`take`].
    #[inline(always)]
    pub fn offer(&mut self, hit: Hit, bound: impl FnOnce() -> f32) -> bool {
        let Packed { kernel, mesh, .. } = self.packed;
        kernel.within(mesh, self.ray, &hit) && self.prefer(hit, bound)
    }

    /// As [`Query::offer`], of a hit that lies within the interval as far as an `f32` tells.
    #[inline(always)]
    pub fn offer_met(&mut self, hit: Hit, bound: impl FnOnce() -> f32) -> bool {
        if K::EXACT_T {
            self.offer(hit, bound)
        } else {
            self.prefer(hit, bound)
        }
    }

    #[inline(always)]
    fn prefer(&mut self, hit: Hit, bound: impl FnOnce() -> f32) -> bool {
        let [from, to] = self.counts;
        if !(hit.t >= from && hit.t <= to) {
            return false;
        }
        let Packed { kernel, mesh, .. } = self.packed;
        let (best, limit) = (&mut self.best, &mut self.limit);
        take::<K, OCCLUSION>(kernel, mesh, self.ray, hit, bound, best, limit)
    }
}

/// Puts `hit`, which lies within the interval, into `best` if it is to be preferred, and lowers `limit` accordingly; for
/// occlusion to the least, since nothing more can change the answer. Whether it did. `bound` is one on the error of the hit's
/// `t`; infinite where it is not known.
#[inline(always)]
pub(super) fn take<K: Kernel, const OCCLUSION: bool>(
    kernel: &K,
    mesh: &Mesh,
    ray: &Ray,
    hit: Hit,
    bound: impl FnOnce() -> f32,
    best: &mut Hit,
    limit: &mut f32,
) -> bool {
    if OCCLUSION {
        best.prim = hit.prim;
        *limit = f32::NEG_INFINITY;
        return true;
    }
    if kernel.nearer(mesh, ray, &hit, best) {
        *best = hit;
        let mut error = bound();
        if error == f32::INFINITY {
            error = t_error(kernel, mesh, ray, hit.prim, hit.t);
        }
        *limit = limit.min(hit.t + error);
        return true;
    }
    false
}

/// A bound on the error of a hit's `t`, where the quick one is not known.
#[cold]
#[inline(never)]
pub(super) fn t_error<K: Kernel>(kernel: &K, mesh: &Mesh, ray: &Ray, prim: u32, t: f32) -> f32 {
    kernel.t_error(ray, &mesh.corners(prim), t)
}

/// A test that is compiled for the query's instruction set.
struct TestApart<'q, 'a, T: Items, K: Kernel, I: Isa, C: Counter, const OCCLUSION: bool> {
    query: &'q mut Query<'a, T, K, I, C, OCCLUSION>,
    item: u32,
}

impl<T: Items, K: Kernel, I: Isa, C: Counter, const OCCLUSION: bool> Task
    for TestApart<'_, '_, T, K, I, C, OCCLUSION>
{
    type Out = bool;

    #[inline(always)]
    fn run<Here: Isa>(self) -> bool {
        T::test(self.query, self.item)
    }
}

impl<T: Items, K: Kernel, I: Isa, C: Counter, const OCCLUSION: bool> Visitor
    for Query<'_, T, K, I, C, OCCLUSION>
{
    const WATCHED: bool = C::COUNTS;
    const ORDERED: bool = !OCCLUSION;
    const DIRECT: bool = K::DIRECT;

    #[inline(always)]
    fn prepare(&mut self) {
        if !K::Prepared::<1, f32>::CHEAP {
            let ray = LaneRay::splat(self.ray);
            self.prepared = Some(self.packed.kernel.prepare(self.ray, &ray));
        }
    }

    #[inline(always)]
    fn step(&mut self, place: u64, leaf: bool, references: u32, entry: f64, exit: f64) {
        self.counter.step(place, leaf, references, entry, exit);
    }

    #[inline(always)]
    fn test(&mut self, item: u32) -> bool {
        T::test(self, item)
    }

    fn test_apart(&mut self, item: u32) -> bool {
        I::enter(TestApart { query: self, item })
    }

    #[inline(always)]
    fn skipped(&mut self, prim: u32) {
        self.counter.skipped(prim);
    }

    #[inline(always)]
    fn narrow(&mut self, from: f32, to: f32) {
        self.counts = [from, to];
    }

    #[inline(always)]
    fn t_limit(&self) -> f32 {
        self.limit
    }
}
