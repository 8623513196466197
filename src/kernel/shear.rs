//! What the watertight kernels share: the triangle is sheared so that the ray runs along an axis from the origin, and
//! three edge functions are evaluated in the plane across it.
//!
//! ```text
//!      y ^   C            edge functions: U = C x B, V = A x C, W = B x A,
//!        |  / \           evaluated at the ray, which is the point 0;
//!        | / 0 \          each shared edge gives both its triangles the same product, so the same sign
//!        |A ---- B
//!        +--------> x
//! ```
//!
//! Kernels differ in how an edge function is computed; one that is 0 is computed again in `f64`, lane by lane, unless two
//! others have opposite signs.
//!
//! **Source:** S. Woop, C. Benthin and I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.
//! **Differs:** no back-face culling, so the winding is not kept by swapping axes.

use crate::geometry::lanes::{Lane, LaneMask, LaneRay, LaneVec3};
use crate::geometry::{DVec3, Ray, Vec3};

use super::error::{self, HUGE, QuickBound, TINY, gamma};
use super::prepared::{self, PreparedRay};
use super::{Corners, LaneHit};

/// The axes in the order x, y, z of the sheared frame, and the shear; `M` are truth values, one a lane.
#[derive(Debug, Clone, Copy)]
pub struct Prepared<L, M> {
    axes: [usize; 3],
    /// Where not all rays have those axes: whose z is x, and whose is y.
    turned: Option<[M; 2]>,
    pub(super) origin: LaneVec3<L>,
    shear: LaneVec3<L>,
}

impl<const W: usize, L: Lane<W>> PreparedRay<W, L, Prepared<f32, bool>> for Prepared<L, L::Mask> {
    #[inline(always)]
    fn spread(one: &Prepared<f32, bool>) -> Self {
        Self {
            axes: one.axes,
            turned: None,
            origin: prepared::spread(one.origin),
            shear: prepared::spread(one.shear),
        }
    }
}

/// How a kernel computes an edge function.
pub(super) trait Edge {
    /// a·b − c·d.
    fn edge<const W: usize, L: Lane<W>>(a: L, b: L, c: L, d: L) -> L;
}

/// Triangles of which some lane may be hit.
pub(super) struct Sheared<L, M> {
    /// Which lanes are hit.
    pub mask: M,
    /// U, V and W: the weights of corners 0, 1 and 2, not yet divided by their sum.
    pub edges: [L; 3],
    /// U + V + W.
    pub det: L,
    /// The sheared corners.
    pub corners: [LaneVec3<L>; 3],
    /// What makes a `t` of their z.
    pub scale: L,
}

/// What a test leaves for [`t_error_bound`].
#[derive(Debug, Clone, Copy)]
pub struct Rest<L> {
    corners: [LaneVec3<L>; 3],
    inv_det: L,
}

/// The frame's axes for a direction: z is the axis of its largest component, the last of equals.
pub(super) fn frame(dir: Vec3) -> [usize; 3] {
    const FRAMES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];
    let d = dir.abs();
    let is_y = d.y >= d.x;
    let most = if is_y { d.y } else { d.x };
    FRAMES[if d.z >= most { 2 } else { usize::from(is_y) }]
}

/// Whose frame's z is x, and whose is y, unless [`frame`] says the same of all.
#[inline(always)]
fn turns<const W: usize, L: Lane<W>>(z: usize, dirs: &LaneVec3<L>) -> Option<[L::Mask; 2]> {
    // Lanes of triangles all have the same ray.
    if L::N == W {
        return None;
    }
    let (x, y, z_size) = (dirs.x.abs(), dirs.y.abs(), dirs.z.abs());
    let from_z = z_size.ge(x) & z_size.ge(y);
    let along = [!from_z & x.gt(y), !from_z & y.ge(x)];
    let alike = match z {
        0 | 1 => !(!along[z]).any(),
        _ => !(!from_z).any(),
    };
    (!alike).then_some(along)
}

/// A vector in the frames of rays that differ.
#[inline(always)]
fn turned<const W: usize, L: Lane<W>>([by_x, by_y]: [L::Mask; 2], v: LaneVec3<L>) -> LaneVec3<L> {
    let pick = |along_x: L, along_y: L, along_z: L| {
        L::select(by_x, along_x, L::select(by_y, along_y, along_z))
    };
    LaneVec3 {
        x: pick(v.y, v.z, v.x),
        y: pick(v.z, v.x, v.y),
        z: pick(v.x, v.y, v.z),
    }
}

/// The lanes of `zero` again in `f64`, where both products are exact.
#[cold]
fn edge_exact<const W: usize, L: Lane<W>>(zero: u32, rounded: L, a: L, b: L, c: L, d: L) -> L {
    L::from_fn(|lane| {
        if zero >> lane & 1 == 1 {
            let [a, b, c, d] = [a, b, c, d].map(|x| f64::from(x.get(lane)));
            (a * b - c * d) as f32
        } else {
            rounded.get(lane)
        }
    })
}

/// The rays as the test reads them.
#[inline(always)]
pub(super) fn prepare<const W: usize, L: Lane<W>>(
    lead: &Ray,
    rays: &LaneRay<L>,
) -> Prepared<L, L::Mask> {
    let axes = frame(lead.dir);
    let turns = turns(axes[2], &rays.dir);
    let (origin, dir) = match turns {
        None => (rays.origin.permuted(axes), rays.dir.permuted(axes)),
        Some(turns) => (turned(turns, rays.origin), turned(turns, rays.dir)),
    };
    Prepared {
        axes,
        turned: turns,
        origin,
        shear: LaneVec3 {
            x: dir.x / dir.z,
            y: dir.y / dir.z,
            z: L::splat(1.0) / dir.z,
        },
    }
}

/// The corners relative to the ray's origin, in the frame in which the ray runs along z.
#[inline(always)]
pub(super) fn sheared<const W: usize, L: Lane<W>>(
    ray: &Prepared<L, L::Mask>,
    tri: &Corners<W>,
) -> [LaneVec3<L>; 3] {
    let [a, b, c] = &tri.0;
    [corner(ray, a), corner(ray, b), corner(ray, c)]
}

/// One of the three.
#[inline(always)]
fn corner<const W: usize, L: Lane<W>>(
    ray: &Prepared<L, L::Mask>,
    rows: &[[f32; W]; 3],
) -> LaneVec3<L> {
    let corner = match ray.turned {
        None => LaneVec3 {
            x: L::load(&rows[ray.axes[0]]),
            y: L::load(&rows[ray.axes[1]]),
            z: L::load(&rows[ray.axes[2]]),
        },
        Some(turns) => turned(turns, LaneVec3::load(rows)),
    };
    let z = corner.z - ray.origin.z;
    LaneVec3 {
        x: corner.x - ray.origin.x - ray.shear.x * z,
        y: corner.y - ray.origin.y - ray.shear.y * z,
        z,
    }
}

/// As [`meet`]; `None` if none is hit.
#[inline(always)]
pub(super) fn test<const W: usize, L: Lane<W>, E: Edge>(
    ray: &Prepared<L, L::Mask>,
    tri: &Corners<W>,
) -> Option<Sheared<L, L::Mask>> {
    let sheared = meet::<W, L, E>(ray, tri);
    sheared.mask.any().then_some(sheared)
}

/// Shears the triangles and tests which are hit, with the kernel's edge functions.
#[inline(always)]
pub(super) fn meet<const W: usize, L: Lane<W>, E: Edge>(
    ray: &Prepared<L, L::Mask>,
    tri: &Corners<W>,
) -> Sheared<L, L::Mask> {
    let zero = L::splat(0.0);
    let [a, b, c] = sheared(ray, tri);
    let mut u = E::edge(c.x, b.y, c.y, b.x);
    let mut v = E::edge(a.x, c.y, a.y, c.x);
    let mut w = E::edge(b.x, a.y, b.y, a.x);
    let [mut least, mut most] = extremes([u, v, w]);
    // Opposite signs are right, so a miss is sure; else a 0 may hide a sign.
    let on_edge = (least.eq(zero) | most.eq(zero)).bits();
    if on_edge != 0 {
        u = edge_exact(on_edge, u, c.x, b.y, c.y, b.x);
        v = edge_exact(on_edge, v, a.x, c.y, a.y, c.x);
        w = edge_exact(on_edge, w, b.x, a.y, b.y, a.x);
        [least, most] = extremes([u, v, w]);
    }
    let det = u + v + w;
    // NaN has no size.
    let mask = !(least.lt(zero) & most.gt(zero)) & det.abs().gt(zero);
    Sheared {
        mask,
        edges: [u, v, w],
        det,
        corners: [a, b, c],
        scale: ray.shear.z,
    }
}

/// The least and the greatest of three, where none is NaN.
#[inline(always)]
fn extremes<const W: usize, L: Lane<W>>([x, y, z]: [L; 3]) -> [L; 2] {
    [x.min(y).min(z), x.max(y).max(z)]
}

impl<L: Copy, M> Sheared<L, M> {
    /// The `t` of each corner, were the ray to meet it.
    #[inline(always)]
    pub fn times<const W: usize>(&self) -> [L; 3]
    where
        L: Lane<W, Mask = M>,
    {
        let [a, b, c] = self.corners;
        [self.scale * a.z, self.scale * b.z, self.scale * c.z]
    }

    /// The hits: `t` is the mean of the corners', weighted by the edge functions.
    #[inline(always)]
    pub fn hit<const W: usize>(self) -> LaneHit<W, L, Rest<L>>
    where
        L: Lane<W, Mask = M>,
    {
        let ([u, v, w], [a, b, c]) = (self.edges, self.times());
        let inv_det = L::splat(1.0) / self.det;
        LaneHit {
            mask: self.mask,
            t: (u * a + v * b + w * c) * inv_det,
            u: v * inv_det,
            v: w * inv_det,
            rest: Rest {
                corners: self.corners,
                inv_det,
            },
        }
    }
}

/// A bound as that of [`t_error`], for hits of each lane: of few operations, since a test has not many more.
///
/// With q = m + 2·r, m the greatest sheared |x| or |y| and r the greatest |z| before it is scaled: a shear is at most 1, so
/// the corners before they were sheared are at most q away, and sheared ones are off by γ(5)·q. Then an edge function is off
/// by de = 2·(γ(2)·X + 2·γ(5)·q)·X, where X = m + γ(5)·q. As the edge functions have one sign, `t` lies between the corners' z,
/// which are two ranges of z from it, together. So with dz, the error of a z and of the roundings that follow, that of `t` is
///
/// ```text
/// (de·(2·range + 3·dz) + dz·det) / (det - 12·de)  =  de·(2·range + 15·dz) / (det - 12·de) + dz
/// ```
///
/// Of twelve, three are the edges' errors, two at most what the roundings of their sum take, six those of [`t_error`].
#[inline(always)]
pub(super) fn t_error_bound<const W: usize, L: Lane<W>>(
    ray: &Prepared<L, L::Mask>,
    hit: &LaneHit<W, L, Rest<L>>,
) -> L {
    const GAMMA5: f32 = error::wide_gamma(5);
    const EDGE: f32 = 4.0 * GAMMA5 + 2.0 * error::wide_gamma(2);
    let [a, b, c] = hit.rest.corners;
    let across = |p: LaneVec3<L>| p.x.abs().max(p.y.abs());
    let most = across(a).max(across(b)).max(across(c));
    let [least_z, most_z] = extremes([a.z, b.z, c.z]);
    let reach = most_z.max(-least_z);
    let q = reach + reach + most;
    let x = q.mul_add_freely(L::splat(GAMMA5), most);
    let inv_det = hit.rest.inv_det.abs();
    let de = x * q * L::splat(EDGE) * inv_det;
    let scale = ray.shear.z.abs();
    let z = scale * reach;
    // What underflows is a small part of what is rounded, but in z.
    let underflow = L::splat(error::UNDERFLOW);
    let dz = z.mul_add_freely(
        L::splat(error::wide_gamma(14)),
        reach.mul_add_freely(underflow, underflow),
    );
    let range = scale * (most_z - least_z);
    let spread = dz.mul_add_freely(L::splat(15.0), range + range);
    QuickBound {
        inv_det,
        det_error: L::splat(12.0) * de,
        error: de * spread,
        besides: dz,
        largest: q + z,
    }
    .get()
}

/// A bound on the error of `t`, for edge functions that are within γ(2) of the two products' size.
pub(super) fn t_error(ray: &Ray, corners: &[Vec3; 3], t: f32) -> f32 {
    let [kx, ky, kz] = frame(ray.dir);
    let dir = ray.dir.as_dvec3();
    let raw = error::relative(corners, ray.origin).map(|p| DVec3::new(p[kx], p[ky], p[kz]));
    let shear = DVec3::new(dir[kx], dir[ky], dir[kz]) / dir[kz];
    let reach = raw.iter().fold(DVec3::ZERO, |m, p| m.max(p.abs()));
    // Each sheared coordinate: a difference, a quotient, a product and a difference; shear.z is 1 here.
    let dx = gamma(4) * (reach.x + shear.x.abs() * reach.z) + TINY * (1.0 + reach.z);
    let dy = gamma(4) * (reach.y + shear.y.abs() * reach.z) + TINY * (1.0 + reach.z);
    let [a, b, c] =
        raw.map(|p| DVec3::new(p.x - shear.x * p.z, p.y - shear.y * p.z, p.z / dir[kz]));
    let most = |f: fn(&DVec3) -> f64| f(&a).abs().max(f(&b).abs()).max(f(&c).abs());
    let (x, y, z) = (most(|p| p.x) + dx, most(|p| p.y) + dy, most(|p| p.z));
    // Both products of an edge function: of wrong factors, and rounded themselves.
    let de = 2.0 * (gamma(2) * x * y + dx * y + dy * x + TINY);
    let edges = [
        c.x * b.y - c.y * b.x,
        a.x * c.y - a.y * c.x,
        b.x * a.y - b.y * a.x,
    ];
    let det: f64 = edges.iter().sum();
    let rest = det.abs() - 3.0 * de;
    if rest <= 3.0 * de || reach.max_element().max(6.0 * x * y * z.max(1.0)) > HUGE {
        return f32::INFINITY;
    }
    // The edge functions of a hit have one sign, so t is a mean of the corners' z, weighted by them: their errors
    // move it by the spread of z, those of z by themselves.
    let t = f64::from(t);
    let spread = (a.z - t).abs() + (b.z - t).abs() + (c.z - t).abs();
    let dz = gamma(3) * z + TINY * (1.0 + reach.z);
    let rounding = gamma(8) * z + 3.0 * TINY * z.max(1.0) / rest;
    let known = dz + rounding;
    // E <= de·(spread + 3·E) / rest + known, solved for the error E; the last term is the rounding of t + E.
    error::round_up((de * spread + known * rest) / (rest - 3.0 * de) + gamma(1) * t.abs())
}
