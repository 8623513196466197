//! Woop, Benthin and Wald's watertight test, and the same with fused edge functions, which is no longer watertight.
//!
//! Rounding is monotone, so fl(ab) − fl(cd) has the right sign or is 0, and both triangles at an edge find the same. A
//! fused multiply-add rounds only one of the products: fl(ab − fl(cd)) of one triangle and fl(cd − fl(ab)) of its
//! neighbour may both be negative, and the ray slips through. `FUSED` (the kernel `woop-fma`) shows that, written out,
//! as compilers do it that contract expressions.
//!
//! **Source:** S. Woop, C. Benthin and I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.
//! **Differs:** see [`super::shear`]; a triangle without area is made one point when it is packed.

use crate::geometry::lanes::{Lane, LaneRay, LaneVec3};
use crate::geometry::{Ray, Vec3};
use crate::registry::Params;

use super::shear::{self, Edge, Prepared};
use super::{Corners, Kernel, KernelEntry, LaneHit};

/// The kernel `woop`, or `woop-fma`.
#[derive(Debug, Clone, Copy)]
pub struct Woop<const FUSED: bool>;

impl<const FUSED: bool> Woop<FUSED> {
    pub(super) const ENTRY: KernelEntry = KernelEntry {
        name: if FUSED { "woop-fma" } else { "woop" },
        about: if FUSED {
            "Control: woop with fused multiply-adds in its edge functions, which is no longer watertight."
        } else {
            "Watertight: shears the triangle onto the ray and evaluates edge functions whose signs agree along shared edges."
        },
        paper: "Woop, Benthin and Wald 2013, Watertight Ray/Triangle Intersection",
        watertight: !FUSED,
        control: FUSED,
        bytes_per_triangle: 36,
        operations: if FUSED {
            "18 multiplications, 3 fused multiply-adds, 19 additions, 1 division (hit only)"
        } else {
            "21 multiplications, 22 additions, 1 division (hit only)"
        },
        known_failures: if FUSED {
            "leaks through shared edges where woop does not: a fused product is rounded on one side of the edge only"
        } else {
            "watertight, not exact: a ray aimed at an edge may report the triangle beside the true one; triangles below about 1e-19 in size vanish"
        },
        params: &[],
    };

    pub(super) fn from_params(_: &Params) -> Self {
        Self
    }
}

impl<const FUSED: bool> Edge for Woop<FUSED> {
    #[inline(always)]
    fn edge<const W: usize, L: Lane<W>>(a: L, b: L, c: L, d: L) -> L {
        if FUSED {
            a.mul_add(b, -(c * d))
        } else {
            a * b - c * d
        }
    }
}

impl<const FUSED: bool> Kernel for Woop<FUSED> {
    type Packed<const W: usize> = Corners<W>;
    type Prepared<const W: usize, L: Lane<W>> = Prepared<L, L::Mask>;
    type Rest<const W: usize, L: Lane<W>> = shear::Rest<L>;

    #[inline(always)]
    fn pack<const W: usize>(&self, corners: impl Fn(usize) -> [Vec3; 3]) -> Corners<W> {
        Corners::with_area_or_nan(corners)
    }

    #[inline(always)]
    fn lane(block: &Corners<8>, lane: usize) -> Corners<1> {
        block.lane(lane)
    }

    // A control need not be fast, and is compiled sooner.
    const PACKETS: bool = !FUSED;
    const DIRECT: bool = !FUSED;

    #[inline(always)]
    fn corners<L: Lane<8>>(block: &Corners<8>) -> [LaneVec3<L>; 3] {
        block.load()
    }

    #[inline(always)]
    fn prepare<const W: usize, L: Lane<W>>(
        &self,
        lead: &Ray,
        rays: &LaneRay<L>,
    ) -> Prepared<L, L::Mask> {
        shear::prepare(lead, rays)
    }

    #[inline(always)]
    fn intersect<const W: usize, L: Lane<W>>(
        &self,
        ray: &Prepared<L, L::Mask>,
        tri: &Corners<W>,
    ) -> Option<LaneHit<W, L, shear::Rest<L>>> {
        Some(shear::test::<W, L, Self>(ray, tri)?.hit())
    }

    #[inline(always)]
    fn intersect_within<const W: usize, L: Lane<W>>(
        &self,
        ray: &Prepared<L, L::Mask>,
        tri: &Corners<W>,
        interval: [L; 2],
    ) -> Option<LaneHit<W, L, shear::Rest<L>>> {
        let met = shear::meet::<W, L, Self>(ray, tri);
        met.hit().only_within(interval)
    }

    #[inline(always)]
    fn t_error_bound<const W: usize, L: Lane<W>>(
        ray: &Prepared<L, L::Mask>,
        _: &Corners<W>,
        hit: &LaneHit<W, L, shear::Rest<L>>,
    ) -> L {
        shear::t_error_bound(ray, hit)
    }

    fn t_error(&self, ray: &Ray, corners: &[Vec3; 3], t: f32) -> f32 {
        shear::t_error(ray, corners, t)
    }
}
