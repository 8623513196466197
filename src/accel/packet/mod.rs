//! Packets: up to 64 rays from one origin that visit the same places, sixteen in a vector of lanes.
//!
//! ```text
//! rays     | 0 … 15 | 16 … 31 | 32 … 47 | 48 … 63 |      each vector meets one triangle at a time,
//!               \        |         |        /            by the kernel's own formula, so with the same bits
//!                one interval of directions: it meets boxes, and whole blocks of triangles before any ray does
//! ```
//!
//! What a test costs decides little: most triangles of a block are missed by all sixteen rays of a vector, and three dot products
//! tell so (see [`cull`]). Setting sixteen rays up and handing their answers out cost as much as their tests until both were
//! transposed ([`Isa::rays`], [`Isa::hits`]), and are left out for packets that meet no triangle.
//!
//! **Source:** I. Wald, S. Boulos and P. Shirley, "Ray Tracing Deformable Scenes using Dynamic Bounding Volume
//! Hierarchies", 2007, for packets with interval arithmetic. **Differs:** the cull of triangles keeps what a kernel's
//! rounding could accept, so a watertight kernel stays so.

use crate::geometry::lanes::{Isa, Lane, LaneMask, LaneVec3, Ones, RayLanes, SIXTEEN};
use crate::geometry::{Hit, Ray, Vec3};
use crate::kernel::Kernel;

use super::batch::Answer;
use super::items::Items;
use super::query::Packed;
use super::visit::Visitor;

mod cull;
mod vector;

use cull::Seen;

pub(super) use vector::Vector;

/// Most rays of a packet.
pub const MOST: usize = 64;

/// Rays of a vector.
pub(super) const VECTOR: usize = SIXTEEN;

/// Vectors of a packet.
const VECTORS: usize = MOST / VECTOR;

/// Rays that share their origin and visit the same places.
pub struct Packet<'a, 'p, T: Items, K: Kernel, I: Isa> {
    pub packed: &'a Packed<T, K>,
    bundle: &'p Bundle<'a, I::Rays>,
    /// Index of the first ray in its batch.
    first: usize,
    /// Made when the first triangle is tested: many packets meet none.
    vectors: Vec<Vector<K, I>>,
    /// Greatest of the vectors' limits.
    limit: f32,
    /// What it did.
    work: Work,
    /// The cost beyond which it gives up.
    budget: u32,
}

/// The work of a packet. It is counted, not timed, so that a batch is traced alike whatever else the machine does.
#[derive(Debug, Clone, Copy, Default)]
pub struct Work {
    /// Items that were met.
    items: u32,
    /// Tests of a triangle against a vector of rays.
    tests: u32,
}

impl Work {
    /// What it costs, about in nanoseconds of a 3.5 GHz machine: an item with the nodes on the way to it, and a test.
    #[inline(always)]
    pub fn cost(self) -> u32 {
        25 * self.items + 15 * self.tests
    }
}

/// What the rays of a packet have in common: a common origin, and an interval of directions.
pub struct Bundle<'a, L> {
    /// From one to [`MOST`] of them.
    pub rays: &'a [Ray],
    lanes: [Beams<L>; VECTORS],
    /// Least and greatest components of the directions.
    pub interval: [Vec3; 2],
    /// Least and greatest of the largest components.
    pub longest: [f32; 2],
    /// Least of the rays.
    pub t_min: f32,
    /// Greatest of the rays.
    t_max: f32,
    /// Whether all origins are the same, bit for bit. Where not, nothing else holds.
    pub share_origin: bool,
}

/// Sixteen rays without the origin that they share. Lanes that are left repeat the last ray, with a `t_max` of negative
/// infinity.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beams<L> {
    pub dirs: LaneVec3<L>,
    pub t_min: L,
    pub t_max: L,
}

/// The rays of a vector, and whether all begin at `origin`, bit for bit.
#[inline(always)]
fn beams<I: Isa>(rays: &[Ray], vector: usize, origin: LaneVec3<I::Rays>) -> (Beams<I::Rays>, bool) {
    let lanes = lanes::<I>(rays, vector);
    let own = &lanes.lines.origin;
    let same = own.x.same_bits(origin.x) & own.y.same_bits(origin.y) & own.z.same_bits(origin.z);
    let beams = Beams {
        dirs: lanes.lines.dir,
        t_min: lanes.t_min,
        t_max: lanes.t_max,
    };
    (beams, same.bits() == 0xffff)
}

/// The rays of a vector: sixteen, or those that are left.
#[inline(always)]
fn lanes<I: Isa>(rays: &[Ray], vector: usize) -> RayLanes<I::Rays> {
    let rest = &rays[vector * VECTOR..];
    if let Some(whole) = rest.first_chunk() {
        return I::rays(whole);
    }
    let lanes = RayLanes::of::<I>(rest.len(), |lane| &rest[lane]);
    RayLanes {
        t_max: I::Rays::from_fn(|lane| {
            if lane < rest.len() {
                lanes.t_max.get(lane)
            } else {
                f32::NEG_INFINITY
            }
        }),
        ..lanes
    }
}

impl<'a, L: Lane<1>> Bundle<'a, L> {
    /// Of from one to [`MOST`] rays.
    #[inline(always)]
    pub fn new<I: Isa<Rays = L>>(rays: &'a [Ray]) -> Self {
        let origin = LaneVec3::splat(rays[0].origin);
        let (first, mut alike) = beams::<I>(rays, 0, origin);
        let mut all = [first; VECTORS];
        let (mut least, mut greatest) = (first.dirs, first.dirs);
        let mut longest = [least.largest(); 2];
        let (mut t_min, mut t_max) = (first.t_min, first.t_max);
        let vectors = rays.len().div_ceil(VECTOR);
        for (vector, of) in all.iter_mut().enumerate().take(vectors).skip(1) {
            let same;
            (*of, same) = beams::<I>(rays, vector, origin);
            alike &= same;
            least = each(&least, &of.dirs, L::min);
            greatest = each(&greatest, &of.dirs, L::max);
            let size = of.dirs.largest();
            longest = [longest[0].min(size), longest[1].max(size)];
            (t_min, t_max) = (t_min.min(of.t_min), t_max.max(of.t_max));
        }
        Self {
            rays,
            lanes: all,
            interval: [
                Vec3::new(least.x.least(), least.y.least(), least.z.least()),
                Vec3::new(
                    greatest.x.greatest(),
                    greatest.y.greatest(),
                    greatest.z.greatest(),
                ),
            ],
            longest: [longest[0].least(), longest[1].greatest()],
            t_min: t_min.least(),
            t_max: t_max.greatest(),
            share_origin: alike,
        }
    }

    /// Least and greatest component along `axis` for each one along `main`, as rounded.
    #[inline(always)]
    pub fn slopes(&self, axis: usize, main: usize) -> [f32; 2] {
        let slope = |beams: &Beams<L>| {
            let dirs = beams.dirs.permuted([axis, main, main]);
            dirs.x / dirs.y
        };
        let first = slope(&self.lanes[0]);
        let (mut least, mut greatest) = (first, first);
        for beams in &self.lanes[1..self.vectors()] {
            let slope = slope(beams);
            (least, greatest) = (least.min(slope), greatest.max(slope));
        }
        [least.least(), greatest.greatest()]
    }

    /// Its vectors.
    #[inline(always)]
    fn vectors(&self) -> usize {
        self.rays.len().div_ceil(VECTOR)
    }
}

/// `choose` of each component.
#[inline(always)]
fn each<L: Lane<1>>(a: &LaneVec3<L>, b: &LaneVec3<L>, choose: fn(L, L) -> L) -> LaneVec3<L> {
    LaneVec3 {
        x: choose(a.x, b.x),
        y: choose(a.y, b.y),
        z: choose(a.z, b.z),
    }
}

impl<'a, 'p, T: Items, K: Kernel, I: Isa> Packet<'a, 'p, T, K, I> {
    /// A packet of the rays of `bundle`, the first of which has index `first` in its batch. `room` is used again.
    #[inline(always)]
    pub fn new(
        packed: &'a Packed<T, K>,
        bundle: &'p Bundle<'a, I::Rays>,
        first: usize,
        budget: u32,
        mut room: Vec<Vector<K, I>>,
    ) -> Self {
        room.clear();
        Self {
            packed,
            first,
            vectors: room,
            limit: bundle.t_max,
            bundle,
            work: Work::default(),
            budget,
        }
    }

    /// Eight triangles as the packet sees them, and which of them it can hit.
    #[inline(always)]
    pub(super) fn see(&self, [a, b, c]: [LaneVec3<I::X8>; 3]) -> Seen {
        let origin = LaneVec3::splat(self.bundle.rays[0].origin);
        let corners = [a.minus(origin), b.minus(origin), c.minus(origin)];
        Seen::new(&corners, &self.bundle.interval)
    }

    /// What it cost; `None` if that exceeded the budget: then it has no answers.
    #[inline(always)]
    pub fn cost(&self) -> Option<u32> {
        let cost = self.work.cost();
        (cost <= self.budget).then_some(cost)
    }

    /// Writes the answers of its rays to the batch's.
    #[inline(always)]
    pub(super) fn answer<A: Answer>(&self, answers: &mut [A]) {
        let answers = &mut answers[self.first..self.first + self.bundle.rays.len()];
        if self.vectors.is_empty() {
            answers.fill(A::of(Hit::MISS));
            return;
        }
        for (answers, of) in answers.chunks_mut(VECTOR).zip(&self.vectors) {
            for (answer, hit) in answers.iter_mut().zip(of.hits()) {
                *answer = A::of(hit);
            }
        }
    }

    /// The room it was given.
    #[inline(always)]
    pub fn into_room(self) -> Vec<Vector<K, I>> {
        self.vectors
    }

    /// Tests triangles against all rays, a vector after the other: those in the lanes of `met` that `can_be_hit` does not
    /// rule out for a vector with these directions.
    #[inline(always)]
    pub fn test_triangles(
        &mut self,
        met: u32,
        can_be_hit: impl Fn(usize, &LaneVec3<I::Rays>) -> bool,
        triangle: impl Fn(usize) -> (u32, K::Packed<1>),
    ) {
        let (bundle, packed) = (self.bundle, self.packed);
        if self.vectors.is_empty() {
            for beams in &bundle.lanes[..bundle.vectors()] {
                let vector = Vector::new(&packed.kernel, &bundle.rays[0], beams);
                self.vectors.push(vector);
            }
        }
        let mut limit = f32::NEG_INFINITY;
        for (vector, of) in self.vectors.iter_mut().enumerate() {
            let dirs = &bundle.lanes[vector].dirs;
            let mut any = false;
            for lane in Ones(met) {
                if !can_be_hit(lane, dirs) {
                    continue;
                }
                self.work.tests += 1;
                let (prim, triangle) = triangle(lane);
                if let Some(hit) = packed.kernel.intersect(&of.prepared, &triangle) {
                    let rays = &bundle.rays[vector * VECTOR..];
                    any |= of.offer(packed, rays, (prim, &triangle), &hit);
                }
            }
            if any {
                of.farthest = of.limit.greatest();
            }
            limit = limit.max(of.farthest);
        }
        self.limit = limit;
    }
}

impl<T: Items, K: Kernel, I: Isa> Visitor for Packet<'_, '_, T, K, I> {
    const WATCHED: bool = false;

    #[inline(always)]
    fn step(&mut self, _: u64, _: bool, _: u32, _: f64, _: f64) {}

    #[inline(always)]
    fn test(&mut self, item: u32) -> bool {
        self.work.items += 1;
        T::test_packet(self, item);
        self.cost().is_none()
    }

    #[inline(always)]
    fn t_limit(&self) -> f32 {
        self.limit
    }
}
