//! Which triangles of a block a packet may hit: first all eight at once for all of its rays, then one for sixteen rays.
//!
//! ```text
//!          b              seen from the origin each edge is a plane through it; a ray hits only if it runs on the same
//!         / \             side of all three. The planes' normals a x b, b x c, c x a serve every ray of the packet:
//!        / . \            the interval of directions first, then sixteen directions by three dot products.
//!       a --- c
//! ```
//!
//! Both keep what is missed by no more than rounding could make of it, of their own planes' and of a kernel's.

use crate::geometry::Vec3;
use crate::geometry::lanes::{Lane, LaneMask, LaneVec3};

/// Products of three coordinates beyond this could overflow on their way; then nothing is left out.
const RANGE: f32 = 1e36;

/// Eight triangles as seen from the origin of a packet.
pub(in super::super) struct Seen {
    /// Which of them a ray of the packet can hit, a bit each.
    pub met: u32,
    /// Normals of the planes through the origin and an edge: for each edge and axis eight numbers.
    normals: [[[f32; 8]; 3]; 3],
    /// How far a ray may be on the wrong side.
    slack: [f32; 8],
}

impl Seen {
    /// The triangles with these corners relative to the origin, for rays with directions between `dirs`.
    #[inline(always)]
    pub fn new<L: Lane<8>>([a, b, c]: &[LaneVec3<L>; 3], dirs: &[Vec3; 2]) -> Self {
        let far = a.largest().max(b.largest()).max(c.largest());
        let fast = dirs[0].abs().max(dirs[1].abs()).max_element();
        // 48 roundings of a product of two distances and a direction's component, for each of three components. If all of them
        // added up, these sides were off by 14 (two corners, the products, a difference, the dot product; 17 where a corner is
        // a sum), so no triangle is left out that a ray meets. What is over keeps those that a kernel lets it meet by rounding:
        // if all added up, the shear's edge functions were off by 21, a weight of `moller-trumbore` by 28 (six products of a
        // distance, a direction and an edge of up to twice a distance, seven roundings each), which makes 45 in all.
        // The last term is more than underflow can take, of coordinates and of directions; a normal number, since others are
        // added a hundred times slower.
        let slack = far * far * L::splat(fast * 144.0 * 0.5 * f32::EPSILON)
            + L::splat((fast + 1.0) * f32::MIN_POSITIVE);
        let in_range = (far * far * L::splat(fast)).lt(L::splat(RANGE));
        let slack = L::select(in_range, slack, L::splat(f32::INFINITY));
        let normals = [a.cross(*b), b.cross(*c), c.cross(*a)];
        let [ab, bc, ca] = [
            reach::<L>(&normals[0], dirs),
            reach::<L>(&normals[1], dirs),
            reach::<L>(&normals[2], dirs),
        ];
        // Written so that NaN keeps a triangle.
        let below = ab[1].lt(-slack) | bc[1].lt(-slack) | ca[1].lt(-slack);
        let above = ab[0].gt(slack) | bc[0].gt(slack) | ca[0].gt(slack);
        let mut seen = Self {
            met: !(below & above).bits() & 0xff,
            normals: [[[0.0; 8]; 3]; 3],
            slack: [0.0; 8],
        };
        if seen.met != 0 {
            for (rows, normal) in seen.normals.iter_mut().zip(&normals) {
                normal.x.write(&mut rows[0]);
                normal.y.write(&mut rows[1]);
                normal.z.write(&mut rows[2]);
            }
            slack.write(&mut seen.slack);
        }
        seen
    }

    /// Whether one of the rays with these directions can hit the triangle in `lane`.
    #[inline(always)]
    pub fn can_be_hit<L: Lane<1>>(&self, lane: usize, dirs: &LaneVec3<L>) -> bool {
        let slack = self.slack[lane & 7];
        let [ab, bc, ca] = [
            self.side(0, lane, dirs),
            self.side(1, lane, dirs),
            self.side(2, lane, dirs),
        ];
        let apart =
            ab.min(bc).min(ca).lt(L::splat(-slack)) & ab.max(bc).max(ca).gt(L::splat(slack));
        (!apart).bits() & 0xffff != 0
    }

    /// On which side of an edge's plane the rays run, and how far. In the range in which it is asked for nothing overflows.
    #[inline(always)]
    fn side<L: Lane<1>>(&self, edge: usize, lane: usize, dirs: &LaneVec3<L>) -> L {
        let [x, y, z] = &self.normals[edge];
        let [x, y, z] = [x[lane & 7], y[lane & 7], z[lane & 7]];
        let yz = dirs.y.mul_add_freely(L::splat(y), dirs.z * L::splat(z));
        dirs.x.mul_add_freely(L::splat(x), yz)
    }
}

/// Least and greatest dot product of `normal` with a direction between `dirs`.
#[inline(always)]
fn reach<L: Lane<8>>(normal: &LaneVec3<L>, dirs: &[Vec3; 2]) -> [L; 2] {
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
