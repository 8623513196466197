//! Sixteen rays of a packet and their answers so far, a lane each.

use crate::geometry::lanes::{HitLanes, Isa, Lane, LaneMask, LaneRay, LaneVec3, Ones, SIXTEEN};
use crate::geometry::{Hit, Ray};
use crate::kernel::{Kernel, LaneHit};

use super::super::items::Items;
use super::super::query::{self, Packed};
use super::Beams;

/// The rays, as the kernel reads them, and what is known of each.
pub struct Vector<K: Kernel, I: Isa> {
    pub(super) prepared: K::Prepared<1, I::Rays>,
    t_min: I::Rays,
    /// Negative infinity where there is no ray.
    t_max: I::Rays,
    /// The nearest hits.
    best: HitLanes<I::Rays>,
    /// What begins beyond these changes nothing.
    pub(super) limit: I::Rays,
    /// The greatest of them; who offers hits sees to it.
    pub(super) farthest: f32,
}

impl<K: Kernel, I: Isa> Vector<K, I> {
    /// The rays of `beams`, which begin where `lead` does.
    #[inline(always)]
    pub(super) fn new(kernel: &K, lead: &Ray, beams: &Beams<I::Rays>) -> Self {
        let lines = LaneRay {
            origin: LaneVec3::splat(lead.origin),
            dir: beams.dirs,
        };
        Self {
            prepared: kernel.prepare(lead, &lines),
            t_min: beams.t_min,
            t_max: beams.t_max,
            best: HitLanes::misses(),
            limit: beams.t_max,
            farthest: beams.t_max.greatest(),
        }
    }

    /// The answers.
    #[inline(always)]
    pub fn hits(&self) -> [Hit; SIXTEEN] {
        let mut hits = [Hit::MISS; SIXTEEN];
        I::hits(&self.best, &mut hits);
        hits
    }

    /// Offers hits with one triangle to the rays, the first of which is that of lane 0; whether any took it.
    #[inline(always)]
    pub fn offer<T: Items>(
        &mut self,
        packed: &Packed<T, K>,
        rays: &[Ray],
        (prim, triangle): (u32, &K::Packed<1>),
        hit: &LaneHit<1, I::Rays, K::Rest<1, I::Rays>>,
    ) -> bool {
        let (mut least, mut most) = (self.t_min, self.best.t.min(self.t_max));
        if K::EXACT_T {
            // More than an ulp wider: there the kernel is asked.
            let ulps = I::Rays::splat(2.0 * f32::EPSILON);
            let least_normal = I::Rays::splat(f32::MIN_POSITIVE);
            least = least - (least.abs() * ulps + least_normal);
            most = most + (most.abs() * ulps + least_normal);
        }
        let near = hit.within(least, most);
        if !near.any() {
            return false;
        }
        if K::EXACT_T {
            self.offer_each(packed, rays, prim, hit, near.bits());
        } else {
            let ties = (near & hit.t.eq(self.best.t)).bits();
            if ties != 0 {
                self.offer_each(packed, rays, prim, hit, ties);
            }
            let nearer = near & hit.t.lt(self.best.t);
            let mut error = K::t_error_bound(&self.prepared, triangle, hit);
            let unknown = (nearer & error.eq(I::Rays::splat(f32::INFINITY))).bits();
            if unknown != 0 {
                error = Self::t_errors(packed, rays, prim, hit, unknown, error);
            }
            let select = I::Rays::select;
            let prim = I::Rays::splat(f32::from_bits(prim));
            self.best = HitLanes {
                t: select(nearer, hit.t, self.best.t),
                u: select(nearer, hit.u, self.best.u),
                v: select(nearer, hit.v, self.best.v),
                prim: select(nearer, prim, self.best.prim),
            };
            let limit = (hit.t + error).min(self.limit);
            self.limit = select(nearer, limit, self.limit);
        }
        true
    }

    /// Bounds on the errors of `t` in the lanes of `unknown`; those of `known` in others.
    #[inline(always)]
    fn t_errors<T: Items>(
        packed: &Packed<T, K>,
        rays: &[Ray],
        prim: u32,
        hit: &LaneHit<1, I::Rays, K::Rest<1, I::Rays>>,
        unknown: u32,
        known: I::Rays,
    ) -> I::Rays {
        let (mut errors, mut hits) = ([0.0; SIXTEEN], [0.0; SIXTEEN]);
        known.write(&mut errors);
        hit.t.write(&mut hits);
        for (lane, error) in errors.iter_mut().enumerate() {
            if unknown >> lane & 1 == 1 {
                *error =
                    query::t_error(&packed.kernel, &packed.mesh, &rays[lane], prim, hits[lane]);
            }
        }
        I::Rays::from_fn(|lane| errors[lane & (SIXTEEN - 1)])
    }

    /// Offers the hits in the lanes of `met` one by one.
    #[inline(always)]
    fn offer_each<T: Items>(
        &mut self,
        packed: &Packed<T, K>,
        rays: &[Ray],
        prim: u32,
        hit: &LaneHit<1, I::Rays, K::Rest<1, I::Rays>>,
        met: u32,
    ) {
        let mut hits = self.hits();
        let mut limits = [0.0; SIXTEEN];
        self.limit.write(&mut limits);
        for lane in Ones(met) {
            let lane = lane & (SIXTEEN - 1);
            let hit = hit.of_lane(lane, prim);
            if !packed.kernel.within(&packed.mesh, &rays[lane], &hit) {
                continue;
            }
            query::take::<K, false>(
                &packed.kernel,
                &packed.mesh,
                &rays[lane],
                hit,
                || f32::INFINITY,
                &mut hits[lane],
                &mut limits[lane],
            );
        }
        let of = |part: fn(&Hit) -> f32| I::Rays::from_fn(|lane| part(&hits[lane & (SIXTEEN - 1)]));
        self.best = HitLanes {
            t: of(|hit| hit.t),
            u: of(|hit| hit.u),
            v: of(|hit| hit.v),
            prim: of(|hit| f32::from_bits(hit.prim)),
        };
        self.limit = I::Rays::from_fn(|lane| limits[lane & (SIXTEEN - 1)]);
    }
}
