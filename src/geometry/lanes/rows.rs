//! Rays, which lie in memory one after another, become lanes, and the lanes of their answers hits again.
//!
//! ```text
//! ray 0    | ox oy oz t_min | dx dy dz t_max |               ox    | 0 1 2 … 15 |
//! ray 1    | ox oy oz t_min | dx dy dz t_max |   <------>    oy    | 0 1 2 … 15 |
//! ...                                                        ...
//! ```
//!
//! Quarters of a register hold four numbers of a ray each; four registers of quarters are transposed by eight shuffles,
//! where loads of single numbers would take as many as there are numbers.

use super::{Isa, Lane, LaneRay};
use crate::geometry::{Hit, Ray};

/// Rays of a vector: as many as [`Isa::Rays`] has lanes.
pub const SIXTEEN: usize = 16;

/// Sixteen rays, a lane each.
#[derive(Debug, Clone, Copy)]
pub struct RayLanes<L> {
    /// Their lines.
    pub lines: LaneRay<L>,
    /// Least accepted `t`.
    pub t_min: L,
    /// Greatest accepted `t`.
    pub t_max: L,
}

/// Sixteen hits, a lane each.
#[derive(Debug, Clone, Copy)]
pub struct HitLanes<L> {
    /// Ray parameters.
    pub t: L,
    /// Weights of vertex 1.
    pub u: L,
    /// Weights of vertex 2.
    pub v: L,
    /// The bits of the triangles' indices.
    pub prim: L,
}

impl<L> RayLanes<L> {
    /// From the columns of the rays' rows.
    #[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
    #[inline(always)]
    pub(super) fn of_columns([ox, oy, oz, t_min]: [L; 4], [dx, dy, dz, t_max]: [L; 4]) -> Self {
        let vector = |x, y, z| super::LaneVec3 { x, y, z };
        Self {
            lines: LaneRay {
                origin: vector(ox, oy, oz),
                dir: vector(dx, dy, dz),
            },
            t_min,
            t_max,
        }
    }

    /// Number by number.
    #[inline(always)]
    pub(super) fn gathered(rays: &[Ray; SIXTEEN]) -> Self
    where
        L: Lane<1>,
    {
        Self {
            lines: LaneRay::of(|lane| &rays[lane]),
            t_min: L::from_fn(|lane| rays[lane].t_min),
            t_max: L::from_fn(|lane| rays[lane].t_max),
        }
    }

    /// The rays that `ray` gives for lanes below `count`; lanes beyond repeat the last.
    #[inline(always)]
    pub fn of<'a, I: Isa<Rays = L>>(count: usize, ray: impl Fn(usize) -> &'a Ray) -> Self {
        let mut rays = [*ray(0); SIXTEEN];
        for (lane, place) in rays.iter_mut().enumerate().skip(1) {
            *place = *ray(lane.min(count - 1));
        }
        I::rays(&rays)
    }
}

impl<L: Lane<1>> HitLanes<L> {
    /// Misses.
    #[must_use]
    #[inline(always)]
    pub fn misses() -> Self {
        let miss = Hit::MISS;
        Self {
            t: L::splat(miss.t),
            u: L::splat(miss.u),
            v: L::splat(miss.v),
            prim: L::splat(f32::from_bits(miss.prim)),
        }
    }

    /// Number by number.
    #[inline(always)]
    pub(super) fn scattered(&self, hits: &mut [Hit; SIXTEEN]) {
        let mut columns = [[0.0; SIXTEEN]; 4];
        let [t, u, v, prim] = &mut columns;
        self.t.write(t);
        self.u.write(u);
        self.v.write(v);
        self.prim.write(prim);
        for (lane, hit) in hits.iter_mut().enumerate() {
            let [t, u, v, prim] = [0, 1, 2, 3].map(|column: usize| columns[column][lane]);
            *hit = Hit {
                t,
                u,
                v,
                prim: prim.to_bits(),
            };
        }
    }
}

/// Transposes each quarter of four registers: number `i` of each goes to register `i`, those of the first first.
#[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
macro_rules! transpose_quarters {
    ($unpacklo:ident $unpackhi:ident $shuffle:ident, $a:expr, $b:expr, $c:expr, $d:expr) => {{
        let (a, b, c, d) = ($a, $b, $c, $d);
        let (low_ab, low_cd) = ($unpacklo(a, b), $unpacklo(c, d));
        let (high_ab, high_cd) = ($unpackhi(a, b), $unpackhi(c, d));
        [
            $shuffle::<0b01_00_01_00>(low_ab, low_cd),
            $shuffle::<0b11_10_11_10>(low_ab, low_cd),
            $shuffle::<0b01_00_01_00>(high_ab, high_cd),
            $shuffle::<0b11_10_11_10>(high_ab, high_cd),
        ]
    }};
}

#[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
pub(super) use transpose_quarters;
