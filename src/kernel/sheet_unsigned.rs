//! The sheet's unsigned test: the crossing lies inside where the areas of the three sub-triangles add up to the whole.
//!
//! ```text
//!        v2            inside:  |(v0,v1,p)| + |(v1,v2,p)| + |(v2,v0,p)| = |(v0,v1,v2)|
//!       /| \           outside: the sum is larger
//!      / p  \
//!    v0 ---- v1        equal means: within eps of the whole
//! ```
//!
//! **Source:** the exercise sheet that raylab grew from.
//! **Differs:** twice the areas are compared; the tolerance is relative to the whole area. `LOCAL` (the kernel
//! `sheet-unsigned-local`) works relative to the ray's origin.

use crate::geometry::lanes::{Lane, LaneMask, LaneRay};
use crate::geometry::{Ray, Vec3};
use crate::registry::{ParamKind, ParamSpec, Params};

use super::sheet::{self, Packed};
use super::{Kernel, KernelEntry, LaneHit};

/// The kernel `sheet-unsigned`, or `sheet-unsigned-local`.
#[derive(Debug, Clone, Copy)]
pub struct SheetUnsigned<const LOCAL: bool> {
    /// Relative tolerance of the comparison of areas.
    eps: f32,
}

/// The tolerance that rejects few interior hits near the world's origin; no value is good everywhere.
const EPS: &str = "1e-5";

impl<const LOCAL: bool> SheetUnsigned<LOCAL> {
    pub(super) const ENTRY: KernelEntry = KernelEntry {
        name: if LOCAL {
            "sheet-unsigned-local"
        } else {
            "sheet-unsigned"
        },
        about: if LOCAL {
            "The sheet's sum of areas, relative to the ray's origin."
        } else {
            "The sheet's other method: the areas of three sub-triangles must add up to the whole."
        },
        paper: "the exercise sheet",
        watertight: false,
        control: false,
        bytes_per_triangle: 52,
        operations: "42 multiplications, 38 additions, 3 divisions, 3 square roots",
        known_failures: if LOCAL {
            "phantoms in a rim around each triangle as wide as eps allows; too small an eps rejects true hits"
        } else {
            "phantoms in a rim around each triangle as wide as eps allows (edge-aimed rays report the neighbour); no eps is good: a small one rejects interior hits, and far from the origin every one does; `raylab accuracy` measures how often"
        },
        params: &[ParamSpec {
            name: "eps",
            about: "Relative tolerance when the sum of the sub-areas is compared with the whole area.",
            kind: ParamKind::Float { min: 0.0, max: 1.0 },
            default: EPS,
        }],
    };

    pub(super) fn from_params(params: &Params) -> Self {
        Self {
            eps: params.number("eps").unwrap_or(1e-5) as f32,
        }
    }
}

impl<const LOCAL: bool> Kernel for SheetUnsigned<LOCAL> {
    type Packed<const W: usize> = Packed<W>;
    type Prepared<const W: usize, L: Lane<W>> = LaneRay<L>;
    type Rest<const W: usize, L: Lane<W>> = ();

    fn pack<const W: usize>(&self, corners: impl Fn(usize) -> [Vec3; 3]) -> Packed<W> {
        sheet::pack(corners)
    }

    #[inline(always)]
    fn lane(block: &Packed<8>, lane: usize) -> Packed<1> {
        sheet::lane(block, lane)
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
        let crossing = sheet::cross::<W, LOCAL, L>(ray, tri)?;
        let [a, b, c] = crossing.to_corners;
        // Each area stands opposite the corner whose weight it is.
        let wa = b.cross(c).length();
        let wb = c.cross(a).length();
        let wc = a.cross(b).length();
        let excess = (wa + wb + wc - crossing.area).abs();
        let mask = crossing.mask & excess.le(L::splat(self.eps) * crossing.area);
        if !mask.any() {
            return None;
        }
        Some(LaneHit::new(
            mask,
            crossing.t,
            wb / crossing.area,
            wc / crossing.area,
        ))
    }

    fn t_error(&self, ray: &Ray, corners: &[Vec3; 3], t: f32) -> f32 {
        sheet::t_error(ray, corners, t)
    }
}
