//! Möller and Trumbore's test: the ray is moved into the triangle's barycentric frame by Cramer's rule.
//!
//! **Source:** T. Möller and B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", JGT 2(1), 1997.
//! **Differs:** no epsilon on the determinant: an absolute one rejects every edge-aimed ray on a small mesh; a zero
//! determinant, of a ray parallel to the triangle, is a miss, nothing else is. A triangle without area is made one point
//! when it is packed, since its determinant would be a rounding error. `EPS` (the kernel `moller-trumbore-eps`) shows what
//! the original's absolute epsilon does.

use crate::geometry::lanes::{Lane, LaneMask, LaneRay, LaneVec3};
use crate::geometry::{DVec3, Ray, Vec3};
use crate::registry::{ParamKind, ParamSpec, Params};

use super::error::{self, HUGE, QuickBound, Quotient, TINY, gamma};
use super::{Kernel, KernelEntry, LaneHit};

/// The kernel `moller-trumbore`, or `moller-trumbore-eps`.
#[derive(Debug, Clone, Copy)]
pub struct MollerTrumbore<const EPS: bool> {
    /// Least determinant that is no miss; 0 without `EPS`.
    eps: f32,
}

impl<const EPS: bool> MollerTrumbore<EPS> {
    pub(super) const ENTRY: KernelEntry = KernelEntry {
        name: if EPS {
            "moller-trumbore-eps"
        } else {
            "moller-trumbore"
        },
        about: if EPS {
            "Control: moller-trumbore with an absolute epsilon on the determinant, which rejects small triangles."
        } else {
            "Cramer's rule in the triangle's own frame; the common fast test."
        },
        paper: "Möller and Trumbore 1997, Fast, Minimum Storage Ray/Triangle Intersection",
        watertight: false,
        control: EPS,
        bytes_per_triangle: 36,
        operations: "27 multiplications, 18 additions, 1 division",
        known_failures: if EPS {
            "every triangle whose determinant, twice its area times the length of the direction at most, is below eps: small meshes vanish"
        } else {
            "leaks through shared edges and vertices; `raylab accuracy` measures how often"
        },
        params: if EPS {
            &[ParamSpec {
                name: "eps",
                about: "Determinants of a smaller absolute value are misses.",
                kind: ParamKind::Float { min: 0.0, max: 1.0 },
                default: "1e-6",
            }]
        } else {
            &[]
        },
    };

    pub(super) fn from_params(params: &Params) -> Self {
        Self {
            eps: params.number("eps").unwrap_or(0.0) as f32,
        }
    }
}

/// Vertex 0 and the edges to vertices 1 and 2.
#[derive(Debug, Clone, Copy)]
pub struct Packed<const W: usize> {
    v0: [[f32; W]; 3],
    e1: [[f32; W]; 3],
    e2: [[f32; W]; 3],
}

/// Sum of the absolute values of the components.
#[inline(always)]
fn size<const W: usize, L: Lane<W>>(v: LaneVec3<L>) -> L {
    v.x.abs() + v.y.abs() + v.z.abs()
}

impl<const EPS: bool> MollerTrumbore<EPS> {
    /// The test, whether a lane is hit or none.
    #[inline(always)]
    fn meet<const W: usize, L: Lane<W>>(self, ray: &LaneRay<L>, tri: &Packed<W>) -> LaneHit<W, L> {
        let zero = L::splat(0.0);
        let one = L::splat(1.0);
        let e1 = LaneVec3::load(&tri.e1);
        let e2 = LaneVec3::load(&tri.e2);
        let p = ray.dir.cross(e2);
        let det = e1.dot(p);
        let inv_det = one / det;
        let s = ray.origin.minus(LaneVec3::load(&tri.v0));
        let u = s.dot(p) * inv_det;
        let q = s.cross(e1);
        let v = ray.dir.dot(q) * inv_det;
        // A zero determinant makes u, v and t infinite or NaN; `u + v <= 1` alone would let -inf + inf through.
        let sound = if EPS {
            det.abs().ge(L::splat(self.eps)) & !det.eq(zero)
        } else {
            !det.eq(zero)
        };
        let mask = sound & u.ge(zero) & v.ge(zero) & (u + v).le(one);
        LaneHit::new(mask, e2.dot(q) * inv_det, u, v)
    }
}

impl<const EPS: bool> Kernel for MollerTrumbore<EPS> {
    type Packed<const W: usize> = Packed<W>;
    type Prepared<const W: usize, L: Lane<W>> = LaneRay<L>;
    type Rest<const W: usize, L: Lane<W>> = ();

    #[inline(always)]
    fn pack<const W: usize>(&self, corners: impl Fn(usize) -> [Vec3; 3]) -> Packed<W> {
        let [v0, e1, e2] = super::rows_of(
            #[inline(always)]
            |lane| {
                let [a, b, c] = super::with_area(corners(lane));
                [a, b - a, c - a]
            },
        );
        Packed { v0, e1, e2 }
    }

    #[inline(always)]
    fn lane(block: &Packed<8>, lane: usize) -> Packed<1> {
        Packed {
            v0: super::lane_of(&block.v0, lane),
            e1: super::lane_of(&block.e1, lane),
            e2: super::lane_of(&block.e2, lane),
        }
    }

    // A control need not be fast, and is compiled sooner.
    const PACKETS: bool = !EPS;
    const DIRECT: bool = !EPS;

    #[inline(always)]
    fn corners<L: Lane<8>>(block: &Packed<8>) -> [LaneVec3<L>; 3] {
        let v0 = LaneVec3::load(&block.v0);
        let one = L::splat(1.0);
        [
            v0,
            v0.add_scaled(LaneVec3::load(&block.e1), one),
            v0.add_scaled(LaneVec3::load(&block.e2), one),
        ]
    }

    #[inline(always)]
    fn prepare<const W: usize, L: Lane<W>>(&self, _: &Ray, rays: &LaneRay<L>) -> LaneRay<L> {
        *rays
    }

    #[inline(always)]
    fn intersect<const W: usize, L: Lane<W>>(
        &self,
        ray: &LaneRay<L>,
        tri: &Packed<W>,
    ) -> Option<LaneHit<W, L>> {
        let hit = self.meet(ray, tri);
        hit.mask.any().then_some(hit)
    }

    #[inline(always)]
    fn intersect_within<const W: usize, L: Lane<W>>(
        &self,
        ray: &LaneRay<L>,
        tri: &Packed<W>,
        interval: [L; 2],
    ) -> Option<LaneHit<W, L>> {
        self.meet(ray, tri).only_within(interval)
    }

    #[inline(always)]
    fn t_error_bound<const W: usize, L: Lane<W>>(
        ray: &LaneRay<L>,
        tri: &Packed<W>,
        hit: &LaneHit<W, L>,
    ) -> L {
        let (e1, e2) = (LaneVec3::load(&tri.e1), LaneVec3::load(&tri.e2));
        let from = ray.origin.minus(LaneVec3::load(&tri.v0));
        let (a, b, c, dir) = (size(from), size(e1), size(e2), size(ray.dir));
        // The permanents of `t_error` are at most products of sums.
        let (edges, t) = (b * c, hit.t.abs());
        let inv_det = (L::splat(1.0) / e1.dot(ray.dir.cross(e2))).abs();
        let underflow = L::splat(error::UNDERFLOW);
        let det_error = L::splat(error::wide_gamma(7)) * dir * edges + underflow;
        let numerator = L::splat(error::wide_gamma(8)) * a * edges + underflow;
        let det_error = det_error * inv_det;
        QuickBound {
            inv_det,
            det_error,
            error: t.mul_add_freely(det_error, numerator * inv_det),
            besides: L::splat(error::wide_gamma(4)) * t,
            largest: a + b + (c + dir),
        }
        .get()
    }

    fn t_error(&self, ray: &Ray, corners: &[Vec3; 3], t: f32) -> f32 {
        let [a, b, c] = error::relative(corners, ray.origin);
        let (e1, e2, dir) = (b - a, c - a, ray.dir.as_dvec3());
        // Sums of six products of three factors, each a difference: eight roundings, seven where the direction is exact.
        let numerator = error::permanent(a, e1, e2);
        let denominator = error::permanent(dir, e1, e2);
        if numerator.max(denominator) > HUGE {
            return f32::INFINITY;
        }
        let underflow = |v: DVec3| TINY * (3.0 + 2.0 * v.abs().element_sum());
        Quotient {
            numerator_error: gamma(8) * numerator + underflow(e2),
            denominator: e1.dot(dir.cross(e2)),
            denominator_error: gamma(7) * denominator + underflow(e1),
            t: f64::from(t),
            roundings: 2,
        }
        .t_error()
    }
}
