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
use crate::kernel::{Kernel, LaneHit};

use super::items::Items;
use super::query::{self, Packed};
use super::visit::Visitor;

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
    pub prepared: [K::Prepared<1, I::Rays>; VECTORS],
    t_min: [I::Rays; VECTORS],
    t_most: [I::Rays; VECTORS],
    /// The answers so far.
    pub best: [Hit; MOST],
    limits: [f32; MOST],
    /// Greatest of a vector's limits.
    vector_limits: [f32; VECTORS],
    limit: f32,
    /// Least and greatest components of the directions.
    pub dirs: [Vec3; 2],
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
        let lead = &self.rays[0];
        let mut suits = K::PACKETS;
        for vector in 0..self.rays.len().div_ceil(VECTOR) {
            suits &= K::same_frame(lead, &self.dirs[vector]);
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
        let origin = LaneVec3::splat(rays[0].origin);
        let none = I::Rays::splat(f32::NEG_INFINITY);
        let lanes = LaneRay {
            origin,
            dir: bundle.dirs[0],
        };
        let mut packet = Self {
            prepared: [packed.kernel.prepare(&rays[0], &lanes); VECTORS],
            t_min: [none; VECTORS],
            t_most: [none; VECTORS],
            packed,
            rays,
            first,
            best: [Hit::MISS; MOST],
            limits: [f32::NEG_INFINITY; MOST],
            vector_limits: [f32::NEG_INFINITY; VECTORS],
            limit: f32::NEG_INFINITY,
            dirs: bundle.interval,
            work: Work::default(),
            budget,
        };
        for (limit, ray) in packet.limits.iter_mut().zip(rays) {
            *limit = ray.t_max;
        }
        for vector in 0..packet.vectors() {
            let lanes = LaneRay {
                origin,
                dir: bundle.dirs[vector],
            };
            packet.prepared[vector] = packed.kernel.prepare(&rays[0], &lanes);
            packet.t_min[vector] = gather(rays, vector, |ray| ray.t_min);
            let t_most: I::Rays = gather(rays, vector, |ray| ray.t_max);
            packet.t_most[vector] = t_most;
            packet.vector_limits[vector] = t_most.greatest();
        }
        let [a, b, c, d] = packet.vector_limits;
        packet.limit = a.max(b).max(c.max(d));
        packet
    }

    /// Whether its work exceeded the budget; then it has no answers.
    #[inline(always)]
    pub fn gave_up(&self) -> bool {
        self.work.cost() > self.budget
    }

    /// The origin of all rays.
    #[inline(always)]
    pub fn origin(&self) -> Vec3 {
        self.rays[0].origin
    }

    /// How many answers there are.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.rays.len()
    }

    #[inline(always)]
    fn vectors(&self) -> usize {
        self.rays.len().div_ceil(VECTOR)
    }

    /// Tests one triangle against all rays; whether any took its hit.
    #[inline(always)]
    pub fn test_triangle(&mut self, prim: u32, triangle: &K::Packed<1>) {
        for vector in 0..self.vectors() {
            if self.vector_limits[vector] == f32::NEG_INFINITY {
                continue;
            }
            let found = self
                .packed
                .kernel
                .intersect(&self.prepared[vector], triangle);
            if let Some(hit) = found {
                self.offer(vector, prim, &hit);
            }
        }
    }

    /// Offers the hits of a vector to its rays.
    #[inline(always)]
    fn offer(&mut self, vector: usize, prim: u32, hit: &LaneHit<1, I::Rays>) {
        use crate::geometry::lanes::LaneMask;
        let (mut least, mut most) = (self.t_min[vector], self.t_most[vector]);
        if K::EXACT_T {
            // More than an ulp wider: there the kernel is asked.
            let (ulps, subnormal) = (I::Rays::splat(2.0 * f32::EPSILON), I::Rays::splat(1e-44));
            least = least - (least.abs() * ulps + subnormal);
            most = most + (most.abs() * ulps + subnormal);
        }
        let mask = hit.mask & hit.t.ge(least) & hit.t.le(most);
        let first = vector * VECTOR;
        let mut met = mask.bits() & ((1_u64 << (self.rays.len() - first).min(VECTOR)) - 1) as u32;
        if met == 0 {
            return;
        }
        let mut any = false;
        while met != 0 {
            let lane = met.trailing_zeros() as usize;
            met &= met - 1;
            let index = first + lane;
            let Packed { kernel, mesh, .. } = self.packed;
            let hit = Hit {
                t: hit.t.get(lane),
                u: hit.u.get(lane),
                v: hit.v.get(lane),
                prim,
            };
            any |= query::take::<K, OCCLUSION>(
                kernel,
                mesh,
                &self.rays[index],
                hit,
                &mut self.best[index],
                &mut self.limits[index],
            );
        }
        if any {
            self.refresh(vector);
        }
    }

    /// Makes a vector's bounds agree with its rays' answers.
    #[inline(always)]
    fn refresh(&mut self, vector: usize) {
        let first = vector * VECTOR;
        let mut most = f32::NEG_INFINITY;
        for limit in &self.limits[first..first + VECTOR] {
            most = if *limit > most { *limit } else { most };
        }
        self.vector_limits[vector] = most;
        let (best, rays, limits) = (&self.best, self.rays, &self.limits);
        self.t_most[vector] = I::Rays::from_fn(|lane| {
            let index = first + lane;
            // A ray that is known to be blocked takes nothing more.
            let t_max = rays.get(index).map_or(f32::NEG_INFINITY, |ray| ray.t_max);
            if OCCLUSION {
                limits[index].min(t_max)
            } else {
                best[index].t.min(t_max)
            }
        });
        let [a, b, c, d] = self.vector_limits;
        self.limit = a.max(b).max(c.max(d));
    }
}

impl<T: Items, K: Kernel, I: Isa, const OCCLUSION: bool> Visitor
    for Packet<'_, T, K, I, OCCLUSION>
{
    const WATCHED: bool = false;

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

/// Which of eight triangles, given by corners relative to the origin, a ray with a direction between `dirs` can hit, as a
/// bit a lane. Keeps those that it misses by no more than roundings.
#[inline(always)]
pub(super) fn can_hit<L: Lane<8>>(corners: &[LaneVec3<L>; 3], dirs: &[Vec3; 2]) -> u32 {
    use crate::geometry::lanes::LaneMask;
    let [a, b, c] = corners;
    let far = largest(a).max(largest(b)).max(largest(c));
    let fast = dirs[0].abs().max(dirs[1].abs()).max_element();
    // A kernel's edge functions are off by less than 20 roundings of products of two distances and a direction's
    // component, these here by less than 10 more, of each of three components.
    // The last term is what underflow can lose, of coordinates and of directions.
    let slack =
        far * far * L::splat(fast * 96.0 * 0.5 * f32::EPSILON) + L::splat(fast * 1e-43 + 1e-43);
    let [ab, bc, ca] = [
        reach::<L>(a.cross(*b), dirs),
        reach::<L>(b.cross(*c), dirs),
        reach::<L>(c.cross(*a), dirs),
    ];
    // Written so that NaN keeps a triangle.
    let below = ab[1].lt(-slack) | bc[1].lt(-slack) | ca[1].lt(-slack);
    let above = ab[0].gt(slack) | bc[0].gt(slack) | ca[0].gt(slack);
    !(below & above).bits() & 0xff
}

/// Largest component.
#[inline(always)]
fn largest<L: Lane<8>>(v: &LaneVec3<L>) -> L {
    v.x.abs().max(v.y.abs()).max(v.z.abs())
}

/// Least and greatest dot product of `normal` with a direction between `dirs`.
#[inline(always)]
fn reach<L: Lane<8>>(normal: LaneVec3<L>, dirs: &[Vec3; 2]) -> [L; 2] {
    let (x0, x1) = (
        normal.x * L::splat(dirs[0].x),
        normal.x * L::splat(dirs[1].x),
    );
    let (y0, y1) = (
        normal.y * L::splat(dirs[0].y),
        normal.y * L::splat(dirs[1].y),
    );
    let (z0, z1) = (
        normal.z * L::splat(dirs[0].z),
        normal.z * L::splat(dirs[1].z),
    );
    [
        x0.min(x1) + y0.min(y1) + z0.min(z1),
        x0.max(x1) + y0.max(y1) + z0.max(z1),
    ]
}
