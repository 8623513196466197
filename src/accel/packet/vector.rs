//! Sixteen rays of a packet and their answers so far, a lane each.

use crate::geometry::lanes::{Isa, Lane, LaneMask, LaneRay};
use crate::geometry::{Hit, Ray};
use crate::kernel::{Kernel, LaneHit};

use super::super::items::Items;
use super::super::query::{self, Packed};
use super::{VECTOR, gather};

/// The rays, as the kernel reads them, and what is known of each.
#[derive(Clone)]
pub(super) struct Vector<K: Kernel, I: Isa> {
    pub prepared: K::Prepared<1, I::Rays>,
    t_min: I::Rays,
    /// Negative infinity where there is no ray, or no more of it is asked.
    t_max: I::Rays,
    /// The nearest hits.
    t: I::Rays,
    u: I::Rays,
    v: I::Rays,
    /// The bits of their triangles.
    prim: I::Rays,
    /// What begins beyond these changes nothing.
    limit: I::Rays,
    /// The greatest of them.
    pub farthest: f32,
}

impl<K: Kernel, I: Isa> Vector<K, I> {
    /// The rays of a vector of `rays`, which are also `lanes`.
    #[inline(always)]
    pub fn new(kernel: &K, rays: &[Ray], lanes: &LaneRay<I::Rays>, vector: usize) -> Self {
        let first = vector * VECTOR;
        let t_max: I::Rays = gather(rays, vector, |ray| ray.t_max);
        let t_max = match rays.len() - first {
            count if count < VECTOR => I::Rays::from_fn(|lane| {
                if lane < count {
                    t_max.get(lane)
                } else {
                    f32::NEG_INFINITY
                }
            }),
            _ => t_max,
        };
        let miss = Hit::MISS;
        Self {
            prepared: kernel.prepare(&rays[0], lanes),
            t_min: gather(rays, vector, |ray| ray.t_min),
            t_max,
            t: I::Rays::splat(miss.t),
            u: I::Rays::splat(miss.u),
            v: I::Rays::splat(miss.v),
            prim: I::Rays::splat(f32::from_bits(miss.prim)),
            limit: t_max,
            farthest: t_max.greatest(),
        }
    }

    /// The answers.
    #[inline(always)]
    pub fn hits(&self) -> [Hit; VECTOR] {
        let mut rows = [[0.0; VECTOR]; 4];
        self.t.write(&mut rows[0]);
        self.u.write(&mut rows[1]);
        self.v.write(&mut rows[2]);
        self.prim.write(&mut rows[3]);
        let [t, u, v, prim] = rows;
        std::array::from_fn(
            #[inline(always)]
            |lane| Hit {
                t: t[lane],
                u: u[lane],
                v: v[lane],
                prim: prim[lane].to_bits(),
            },
        )
    }

    /// Offers hits with one triangle to the rays, the first of which is that of lane 0; whether any took it.
    #[inline(always)]
    pub fn offer<T: Items, const OCCLUSION: bool>(
        &mut self,
        packed: &Packed<T, K>,
        rays: &[Ray],
        (prim, triangle): (u32, &K::Packed<1>),
        hit: &LaneHit<1, I::Rays>,
    ) -> bool {
        let (mut least, mut most) = (self.t_min, self.t.min(self.t_max));
        if K::EXACT_T {
            // More than an ulp wider: there the kernel is asked.
            let (ulps, subnormal) = (I::Rays::splat(2.0 * f32::EPSILON), I::Rays::splat(1e-44));
            least = least - (least.abs() * ulps + subnormal);
            most = most + (most.abs() * ulps + subnormal);
        }
        let near = hit.mask & hit.t.ge(least) & hit.t.le(most);
        if !near.any() {
            return false;
        }
        if K::EXACT_T || OCCLUSION {
            self.offer_each::<T, OCCLUSION>(packed, rays, prim, hit, near.bits());
        } else {
            let ties = (near & hit.t.eq(self.t)).bits();
            if ties != 0 {
                self.offer_each::<T, OCCLUSION>(packed, rays, prim, hit, ties);
            }
            let nearer = near & hit.t.lt(self.t);
            let mut error = K::t_error_bound(&self.prepared, triangle, hit.t);
            let unknown = (nearer & error.eq(I::Rays::splat(f32::INFINITY))).bits();
            if unknown != 0 {
                error = Self::t_errors(packed, rays, prim, hit, unknown, error);
            }
            self.t = I::Rays::select(nearer, hit.t, self.t);
            self.u = I::Rays::select(nearer, hit.u, self.u);
            self.v = I::Rays::select(nearer, hit.v, self.v);
            let prim = I::Rays::splat(f32::from_bits(prim));
            self.prim = I::Rays::select(nearer, prim, self.prim);
            let limit = (hit.t + error).min(self.limit);
            self.limit = I::Rays::select(nearer, limit, self.limit);
        }
        self.farthest = self.limit.greatest();
        true
    }

    /// Bounds on the errors of `t` in the lanes of `unknown`; those of `known` in others.
    #[inline(always)]
    fn t_errors<T: Items>(
        packed: &Packed<T, K>,
        rays: &[Ray],
        prim: u32,
        hit: &LaneHit<1, I::Rays>,
        unknown: u32,
        known: I::Rays,
    ) -> I::Rays {
        let (mut errors, mut hits) = ([0.0; VECTOR], [0.0; VECTOR]);
        known.write(&mut errors);
        hit.t.write(&mut hits);
        for (lane, error) in errors.iter_mut().enumerate() {
            if unknown >> lane & 1 == 1 {
                let hit = Hit {
                    t: hits[lane],
                    prim,
                    ..Hit::MISS
                };
                *error = query::t_error(&packed.kernel, &packed.mesh, &rays[lane], &hit);
            }
        }
        I::Rays::from_fn(|lane| errors[lane & (VECTOR - 1)])
    }

    /// Offers the hits in the lanes of `met` one by one.
    #[inline(always)]
    fn offer_each<T: Items, const OCCLUSION: bool>(
        &mut self,
        packed: &Packed<T, K>,
        rays: &[Ray],
        prim: u32,
        hit: &LaneHit<1, I::Rays>,
        mut met: u32,
    ) {
        let mut hits = self.hits();
        let mut limits = [0.0; VECTOR];
        self.limit.write(&mut limits);
        while met != 0 {
            let lane = met.trailing_zeros() as usize & (VECTOR - 1);
            met &= met - 1;
            let hit = Hit {
                t: hit.t.get(lane),
                u: hit.u.get(lane),
                v: hit.v.get(lane),
                prim,
            };
            query::take::<K, OCCLUSION>(
                &packed.kernel,
                &packed.mesh,
                &rays[lane],
                hit,
                || f32::INFINITY,
                &mut hits[lane],
                &mut limits[lane],
            );
        }
        self.t = I::Rays::from_fn(|lane| hits[lane & (VECTOR - 1)].t);
        self.u = I::Rays::from_fn(|lane| hits[lane & (VECTOR - 1)].u);
        self.v = I::Rays::from_fn(|lane| hits[lane & (VECTOR - 1)].v);
        self.prim = I::Rays::from_fn(|lane| f32::from_bits(hits[lane & (VECTOR - 1)].prim));
        self.limit = I::Rays::from_fn(|lane| limits[lane & (VECTOR - 1)]);
        if OCCLUSION {
            // A ray that is known to be blocked takes nothing more.
            self.t_max = self.t_max.min(self.limit);
        }
    }
}
