//! Packets: up to 64 rays from one origin that visit the same places, sixteen in a vector of lanes.
//!
//! ```text
//! rays     | 0 … 15 | 16 … 31 | 32 … 47 | 48 … 63 |      each vector meets one triangle at a time,
//!               \        |         |        /            by the kernel's own formula, so with the same bits
//!                one interval of directions: it meets boxes, and whole blocks of triangles before any ray does
//! ```
//!
//! **Source:** I. Wald, S. Boulos and P. Shirley, "Ray Tracing Deformable Scenes using Dynamic Bounding Volume
//! Hierarchies", 2007, for packets with interval arithmetic. **Differs:** the cull of triangles keeps what a kernel's
//! rounding could accept, so a watertight kernel stays so.

use crate::geometry::lanes::{Isa, Lane, LaneRay, LaneVec3};
use crate::geometry::{Hit, Ray, Vec3};
use crate::kernel::Kernel;

use super::items::Items;
use super::query::Packed;
use super::visit::Visitor;

mod cull;
mod vector;

use vector::Vector;

/// Most rays of a packet.
pub const MOST: usize = 64;

/// Rays of a vector.
pub(super) const VECTOR: usize = 16;

/// Vectors of a packet.
const VECTORS: usize = MOST / VECTOR;

/// Rays that share their origin and visit the same places.
pub struct Packet<'a, T: Items, K: Kernel, I: Isa, const OCCLUSION: bool> {
    pub packed: &'a Packed<T, K>,
    rays: &'a [Ray],
    /// Index of the first ray in its batch.
    pub first: usize,
    vectors: [Vector<K, I>; VECTORS],
    /// Greatest of the vectors' limits.
    limit: f32,
    /// Least and greatest components of the directions.
    dirs: [Vec3; 2],
    /// What it did.
    pub work: Work,
    /// The cost beyond which it gives up.
    budget: u32,
}

/// The work of a packet. It is counted, not timed, so that a batch is traced alike on every machine.
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
    /// Their directions, a vector each sixteen; lanes that are left repeat the last ray.
    dirs: [LaneVec3<L>; VECTORS],
    /// Least and greatest components of the directions.
    pub interval: [Vec3; 2],
    /// Least and greatest of the largest components.
    pub longest: [f32; 2],
}

/// A component of the directions of a vector.
#[inline(always)]
fn gather<L: Lane<1>>(rays: &[Ray], vector: usize, part: impl Fn(&Ray) -> f32) -> L {
    let first = vector * VECTOR;
    if let Some(whole) = rays.get(first..first + VECTOR) {
        L::from_fn(|lane| part(&whole[lane & (VECTOR - 1)]))
    } else {
        L::from_fn(|lane| part(&rays[(first + lane).min(rays.len() - 1)]))
    }
}

impl<'a, L: Lane<1>> Bundle<'a, L> {
    /// `None` where the origins differ, or there are no rays or too many.
    #[inline(always)]
    pub fn new(rays: &'a [Ray]) -> Option<Self> {
        let lead = rays.first()?;
        let [x, y, z] = lead.origin.to_array().map(f32::to_bits);
        let mut differing = 0;
        for ray in rays {
            differing |= ray.origin.x.to_bits() ^ x;
            differing |= ray.origin.y.to_bits() ^ y;
            differing |= ray.origin.z.to_bits() ^ z;
        }
        if differing != 0 || rays.len() > MOST {
            return None;
        }
        let mut dirs = [LaneVec3::splat(lead.dir); VECTORS];
        let (mut least, mut greatest) = (dirs[0], dirs[0]);
        let all = L::splat(lead.dir.abs().max_element());
        let mut longest = [all, all];
        for (vector, dirs) in dirs
            .iter_mut()
            .enumerate()
            .take(rays.len().div_ceil(VECTOR))
        {
            let (x, y, z): (L, L, L) = (
                gather(rays, vector, |ray| ray.dir.x),
                gather(rays, vector, |ray| ray.dir.y),
                gather(rays, vector, |ray| ray.dir.z),
            );
            *dirs = LaneVec3 { x, y, z };
            least = LaneVec3 {
                x: least.x.min(x),
                y: least.y.min(y),
                z: least.z.min(z),
            };
            greatest = LaneVec3 {
                x: greatest.x.max(x),
                y: greatest.y.max(y),
                z: greatest.z.max(z),
            };
            let largest = x.abs().max(y.abs()).max(z.abs());
            longest = [longest[0].min(largest), longest[1].max(largest)];
        }
        Some(Self {
            rays,
            dirs,
            interval: [
                Vec3::new(least.x.least(), least.y.least(), least.z.least()),
                Vec3::new(
                    greatest.x.greatest(),
                    greatest.y.greatest(),
                    greatest.z.greatest(),
                ),
            ],
            longest: [longest[0].least(), longest[1].greatest()],
        })
    }

    /// Whether a kernel can test them together.
    #[inline(always)]
    pub fn suits<K: Kernel>(&self) -> bool {
        let mut suits = K::PACKETS;
        for dirs in &self.dirs[..self.rays.len().div_ceil(VECTOR)] {
            suits &= K::same_frame(&self.rays[0], dirs);
        }
        suits
    }
}

impl<'a, T: Items, K: Kernel, I: Isa, const OCCLUSION: bool> Packet<'a, T, K, I, OCCLUSION> {
    /// A packet of the rays of `bundle`, the first of which has index `first` in its batch.
    #[inline(always)]
    pub fn new(
        packed: &'a Packed<T, K>,
        bundle: &Bundle<'a, I::Rays>,
        first: usize,
        budget: u32,
    ) -> Self {
        let rays = bundle.rays;
        let lanes = |vector: usize| LaneRay {
            origin: LaneVec3::splat(rays[0].origin),
            dir: bundle.dirs[vector],
        };
        let lead = Vector::new(&packed.kernel, rays, &lanes(0), 0);
        let mut limit = lead.farthest;
        // Those beyond the rays are never looked at.
        let mut vectors: [Vector<K, I>; VECTORS] = std::array::from_fn(
            #[inline(always)]
            |_| lead.clone(),
        );
        let count = rays.len().div_ceil(VECTOR);
        for (vector, of) in vectors.iter_mut().enumerate().take(count).skip(1) {
            *of = Vector::new(&packed.kernel, rays, &lanes(vector), vector);
            limit = limit.max(of.farthest);
        }
        Self {
            packed,
            rays,
            first,
            vectors,
            limit,
            dirs: bundle.interval,
            work: Work::default(),
            budget,
        }
    }

    /// Which of eight triangles a ray can hit, as a bit a lane.
    #[inline(always)]
    pub fn can_hit(&self, [a, b, c]: [LaneVec3<I::X8>; 3]) -> u32 {
        let origin = LaneVec3::splat(self.rays[0].origin);
        let corners = [a.minus(origin), b.minus(origin), c.minus(origin)];
        cull::can_hit(&corners, &self.dirs)
    }

    /// Whether its work exceeded the budget; then it has no answers.
    #[inline(always)]
    pub fn gave_up(&self) -> bool {
        self.work.cost() > self.budget
    }

    #[inline(always)]
    fn vectors(&self) -> usize {
        self.rays.len().div_ceil(VECTOR)
    }

    /// Hands the answers, one a ray, to `take`.
    #[inline(always)]
    pub fn answer(&self, mut take: impl FnMut(usize, Hit)) {
        for (vector, of) in self.vectors[..self.vectors()].iter().enumerate() {
            let first = vector * VECTOR;
            let hits = of.hits();
            for (lane, hit) in hits.into_iter().take(self.rays.len() - first).enumerate() {
                take(self.first + first + lane, hit);
            }
        }
    }

    /// Tests one triangle against all rays.
    #[inline(always)]
    pub fn test_triangle(&mut self, prim: u32, triangle: &K::Packed<1>) {
        let mut any = false;
        for vector in 0..self.vectors() {
            let (packed, rays) = (self.packed, &self.rays[vector * VECTOR..]);
            let of = &mut self.vectors[vector];
            let found = packed.kernel.intersect(&of.prepared, triangle);
            if let Some(hit) = found {
                any |= of.offer::<T, OCCLUSION>(packed, rays, (prim, triangle), &hit);
            }
        }
        if any {
            self.limit = f32::NEG_INFINITY;
            for of in &self.vectors[..self.rays.len().div_ceil(VECTOR)] {
                self.limit = self.limit.max(of.farthest);
            }
        }
    }
}

impl<T: Items, K: Kernel, I: Isa, const OCCLUSION: bool> Visitor
    for Packet<'_, T, K, I, OCCLUSION>
{
    const WATCHED: bool = false;
    const ORDERED: bool = !OCCLUSION;

    #[inline(always)]
    fn step(&mut self, _: u64, _: bool, _: u32, _: f64, _: f64) {}

    #[inline(always)]
    fn test(&mut self, item: u32) -> bool {
        self.work.items += 1;
        T::test_packet(self, item);
        self.gave_up() || (OCCLUSION && self.limit == f32::NEG_INFINITY)
    }

    #[inline(always)]
    fn t_limit(&self) -> f32 {
        self.limit
    }
}
