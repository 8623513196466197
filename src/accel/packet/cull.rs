//! Which triangles of a block no ray of a packet can hit, found for all eight at once.

use crate::geometry::Vec3;
use crate::geometry::lanes::{Lane, LaneMask, LaneVec3};

/// Which of eight triangles, given by corners relative to the origin, a ray with a direction between `dirs` can hit, as a
/// bit a lane. Keeps those that it misses by no more than roundings.
#[inline(always)]
pub(in super::super) fn can_hit<L: Lane<8>>(corners: &[LaneVec3<L>; 3], dirs: &[Vec3; 2]) -> u32 {
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
