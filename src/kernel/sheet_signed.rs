//! The sheet's signed test: the crossing lies inside where the three sub-triangles have the triangle's orientation.
//!
//! ```text
//!        v2            areas against n: (v0, v1, p), (v1, v2, p), (v2, v0, p)
//!       /| \           all >= 0: inside
//!      / p  \
//!    v0 ---- v1
//! ```
//!
//! **Source:** the exercise sheet that raylab grew from; the method is common lore, e.g. Glassner (ed.), "An
//! Introduction to Ray Tracing", 1989, ch. 2.
//! **Differs:** twice the areas are compared, as only their signs and ratios count. `LOCAL` (the kernel
//! `sheet-signed-local`) works relative to the ray's origin, which loses the error that grows with the distance from the
//! world's.

use crate::geometry::lanes::{Lane, LaneMask, LaneRay};
use crate::geometry::{Ray, Vec3};
use crate::registry::Params;

use super::sheet::{self, Packed};
use super::{Kernel, KernelEntry, LaneHit};

/// The kernel `sheet-signed`, or `sheet-signed-local`.
#[derive(Debug, Clone, Copy)]
pub struct SheetSigned<const LOCAL: bool>;

impl<const LOCAL: bool> SheetSigned<LOCAL> {
    pub(super) const ENTRY: KernelEntry = KernelEntry {
        name: if LOCAL {
            "sheet-signed-local"
        } else {
            "sheet-signed"
        },
        about: if LOCAL {
            "The sheet's signed areas, relative to the ray's origin: the cure of its error far from the world's."
        } else {
            "The sheet's method: plane in normal form, then the signs of three sub-triangle areas."
        },
        paper: "the exercise sheet; Glassner 1989, An Introduction to Ray Tracing, ch. 2",
        watertight: false,
        control: false,
        bytes_per_triangle: 52,
        operations: "45 multiplications, 44 additions, 2 divisions",
        known_failures: if LOCAL {
            "leaks through shared edges and vertices; `raylab accuracy` measures how often"
        } else {
            "leaks through shared edges and vertices, since the crossing is rounded in world space; `raylab accuracy` measures how often"
        },
        params: &[],
    };

    pub(super) fn from_params(_: &Params) -> Self {
        Self
    }
}

impl<const LOCAL: bool> Kernel for SheetSigned<LOCAL> {
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
        let zero = L::splat(0.0);
        let crossing = sheet::cross::<W, LOCAL, L>(ray, tri)?;
        let [a, b, c] = crossing.to_corners;
        // Each area stands opposite the corner whose weight it is.
        let wa = b.cross(c).dot(crossing.normal);
        let wb = c.cross(a).dot(crossing.normal);
        let wc = a.cross(b).dot(crossing.normal);
        let sum = wa + wb + wc;
        let mask = crossing.mask & wa.ge(zero) & wb.ge(zero) & wc.ge(zero) & sum.gt(zero);
        if !mask.any() {
            return None;
        }
        Some(LaneHit::new(mask, crossing.t, wb / sum, wc / sum))
    }

    fn t_error(&self, ray: &Ray, corners: &[Vec3; 3], t: f32) -> f32 {
        sheet::t_error(ray, corners, t)
    }
}
