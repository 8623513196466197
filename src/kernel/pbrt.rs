//! pbrt's test: watertight as Woop, Benthin and Wald's, with edge functions that are right to the last place but one, and
//! hits refused that are nearer to the ray's origin than the error of their own `t`.
//!
//! ```text
//!     -δt   0   +δt
//! -----[====o====]------------x------->  t      a hit in the bracket could as well lie on the other side of the
//!       refused               taken             origin, so it is taken for the surface that the ray starts on
//! ```
//!
//! **Source:** M. Pharr, W. Jakob and G. Humphreys, "Physically Based Rendering", 4th edition, §6.5.3 and §6.8.7; the edge
//! functions are W. Kahan's difference of products, see C.-P. Jeannerod, N. Louvet and J.-M. Muller, "Further Analysis of
//! Kahan's Algorithm for the Accurate Computation of 2×2 Determinants", 2013.
//! **Differs:** pbrt also refuses `t` behind the origin, which is the interval's part here: a ray with a negative `t_min`
//! sees what lies behind its bracket. A triangle without area is made one point when it is packed.

use crate::geometry::lanes::{Lane, LaneMask, LaneRay, LaneVec3};
use crate::geometry::{Ray, Vec3, gamma};
use crate::registry::Params;

use super::shear::{self, Edge, Prepared, Sheared};
use super::{Corners, Kernel, KernelEntry, LaneHit};

/// The kernel `pbrt`.
#[derive(Debug, Clone, Copy)]
pub struct Pbrt;

impl Pbrt {
    pub(super) const ENTRY: KernelEntry = KernelEntry {
        name: "pbrt",
        about: "Watertight as in pbrt: fused edge functions that err by less than two ulps, and no hit nearer than its own error.",
        paper: "Pharr, Jakob and Humphreys 2023, Physically Based Rendering, 4th edition, §6.5.3",
        watertight: true,
        control: false,
        bytes_per_triangle: 36,
        operations: "18 multiplications, 6 fused multiply-adds, 22 additions; for hits 14 multiplications, 13 additions, 1 division more",
        known_failures: "watertight, not exact: a ray aimed at an edge may report the triangle beside the true one; a triangle within the error of t of the ray's origin is refused, on purpose; triangles below about 1e-19 in size vanish",
        params: &[],
    };

    pub(super) fn from_params(_: &Params) -> Self {
        Self
    }
}

impl Edge for Pbrt {
    /// With an error of at most 1.5 ulps: what the second product lost is added again.
    #[inline(always)]
    fn edge<const W: usize, L: Lane<W>>(a: L, b: L, c: L, d: L) -> L {
        let cd = c * d;
        let lost = (-c).mul_add(d, cd);
        a.mul_add(b, -cd) + lost
    }
}

/// The greatest absolute value of three.
#[inline(always)]
fn largest<const W: usize, L: Lane<W>>([x, y, z]: [L; 3]) -> L {
    LaneVec3 { x, y, z }.largest()
}

/// The bound on the error of `t` that pbrt computes beside each hit.
#[inline(always)]
fn error_of_t<const W: usize, L: Lane<W>>(sheared: &Sheared<L, L::Mask>) -> L {
    let [u, v, w] = sheared.edges;
    let [a, b, c] = sheared.corners;
    let [x, y] = [[a.x, b.x, c.x], [a.y, b.y, c.y]].map(largest);
    let z = largest(sheared.times());
    let e = largest([u, v, w]);
    let (gamma2, gamma3) = (L::splat(gamma(2)), L::splat(gamma(3)));
    let gamma5 = L::splat(gamma(5));
    let dz = gamma3 * z;
    let (dx, dy) = (gamma5 * (x + z), gamma5 * (y + z));
    let de = L::splat(2.0) * (gamma2 * x * y + dy * x + dx * y);
    L::splat(3.0) * (gamma3 * e * z + de * z + dz * e) / sheared.det.abs()
}

impl Kernel for Pbrt {
    type Packed<const W: usize> = Corners<W>;
    type Prepared<const W: usize, L: Lane<W>> = Prepared<L, L::Mask>;
    type Rest<const W: usize, L: Lane<W>> = shear::Rest<L>;

    fn pack<const W: usize>(&self, corners: impl Fn(usize) -> [Vec3; 3]) -> Corners<W> {
        Corners::with_area_or_nan(corners)
    }

    #[inline(always)]
    fn lane(block: &Corners<8>, lane: usize) -> Corners<1> {
        block.lane(lane)
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
        let sheared = shear::test::<W, L, Self>(ray, tri)?;
        let error = error_of_t(&sheared);
        let hit = sheared.hit();
        // NaN is not refused here; the interval refuses it.
        let mask = hit.mask & !hit.t.abs().le(error);
        if !mask.any() {
            return None;
        }
        Some(LaneHit { mask, ..hit })
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
        // Kahan's differences err by 2u of the result, within the γ(2) of the products that the bound allows.
        shear::t_error(ray, corners, t)
    }
}
