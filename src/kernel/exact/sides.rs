//! On which side of each edge the ray's line passes, where `f32` cannot tell.
//!
//! ```text
//! p = corner - origin,  x = p.x·d.z - p.z·d.x,  y = p.y·d.z - p.z·d.y     the sheared corners, times d.z
//! U = c.x·b.y - c.y·b.x,  V, W likewise                                   in f64, each with its own bound
//!   = d.z·det(d, p_c, p_b)                                                on integers, where the bound is too wide
//! ```
//!
//! In `f64` nothing overflows or underflows: differences of `f32` are 0 or between 2⁻¹⁴⁹ and 2¹²⁹, so products of four
//! lie far within the range.

use crate::geometry::exact::{self, Integer, WideInt};
use crate::geometry::{DVec3, Vec3};
use crate::kernel::shear;

/// Nine roundings of `f64`: eight happen, and one is room for the bound's own.
const ROUNDINGS: f64 = 9.0 * 1.110_223_024_625_156_5e-16;

/// The edge functions of one ray and triangle in `f64`.
pub(super) struct Sides {
    values: [f64; 3],
    /// Their signs, where they are sure.
    signs: [Option<i32>; 3],
}

/// A sheared corner: x and y, and the sums of the absolute values of their products.
struct Sheared {
    x: f64,
    y: f64,
    size_x: f64,
    size_y: f64,
}

impl Sheared {
    fn new(p: DVec3, d: DVec3) -> Self {
        let [xz, zx, yz, zy] = [p.x * d.z, p.z * d.x, p.y * d.z, p.z * d.y];
        Self {
            x: xz - zx,
            y: yz - zy,
            size_x: xz.abs() + zx.abs(),
            size_y: yz.abs() + zy.abs(),
        }
    }
}

/// The edge function of two corners, and its sign where it is sure.
fn edge(p: &Sheared, q: &Sheared) -> (f64, Option<i32>) {
    let value = p.x * q.y - p.y * q.x;
    // x and y are off by 3 roundings of their size (a difference, a product, a difference), the two products by one
    // more, and so is their difference.
    let error = ROUNDINGS * (p.size_x * q.size_y + p.size_y * q.size_x);
    let sign = if error == 0.0 {
        // Every product has a factor 0.
        Some(0)
    } else if value.abs() > error {
        Some(if value > 0.0 { 1 } else { -1 })
    } else {
        None
    };
    (value, sign)
}

impl Sides {
    /// What `f64` tells of a line and a triangle.
    pub fn new(origin: Vec3, dir: Vec3, corners: &[Vec3; 3]) -> Self {
        let axes = shear::frame(dir);
        let along = |v: DVec3| {
            let [x, y, z] = axes.map(|axis| v[axis]);
            DVec3 { x, y, z }
        };
        let (o, d) = (along(origin.as_dvec3()), along(dir.as_dvec3()));
        let [a, b, c] = corners.map(|v| Sheared::new(along(v.as_dvec3()) - o, d));
        let edges = [edge(&c, &b), edge(&a, &c), edge(&b, &a)];
        Self {
            values: edges.map(|(value, _)| value),
            signs: edges.map(|(_, sign)| sign),
        }
    }

    fn any(&self, sign: i32) -> bool {
        self.signs.contains(&Some(sign))
    }

    /// Whether `f64` decides between hit and miss.
    pub fn are_known(&self) -> bool {
        (self.any(1) && self.any(-1)) || !self.signs.contains(&None)
    }
}

/// The weights of corners 1 and 2 where the line hits the triangle; `None` where it misses, or lies in its plane, or the
/// triangle has no area.
pub(super) fn weights(origin: Vec3, dir: Vec3, corners: &[Vec3; 3]) -> Option<[f32; 2]> {
    let mut sides = Sides::new(origin, dir, corners);
    if !sides.are_known() {
        exact_signs(&mut sides, origin, dir, corners);
    }
    let (some_left, some_right) = (sides.any(-1), sides.any(1));
    // Neither: all are 0.
    if some_left == some_right {
        return None;
    }
    // What a value says against the sign is a rounding error.
    let sign = if some_right { 1.0 } else { -1.0 };
    let [u, v, w] = [0, 1, 2].map(|i| match sides.signs[i] {
        Some(0) => 0.0,
        _ => (sides.values[i] * sign).max(f64::MIN_POSITIVE),
    });
    let sum = u + v + w;
    Some([(v / sum) as f32, (w / sum) as f32])
}

/// Limbs that hold a determinant whose coordinates, and whose direction, span at most [`NARROW_SPAN`] bits, as nearly all do:
/// 80 + 2·81 + 3 bits.
const NARROW: usize = 4;
const NARROW_SPAN: u32 = 80;
/// Limbs that hold it for any.
const WIDE: usize = 14;

/// Replaces signs that are not sure by exact ones.
#[cold]
fn exact_signs(sides: &mut Sides, origin: Vec3, dir: Vec3, corners: &[Vec3; 3]) {
    let [a, b, c] = *corners;
    let places = [origin, a, b, c];
    let coordinates = || places.iter().flat_map(Vec3::to_array);
    let span = exact::span(coordinates()).max(exact::span(dir.to_array()));
    let unit = exact::common_exponent(coordinates());
    if span <= exact::SMALL_SPAN {
        signs_on_integers::<i128>(sides, dir, &places, unit);
    } else if span <= NARROW_SPAN {
        signs_on_integers::<WideInt<NARROW>>(sides, dir, &places, unit);
    } else {
        signs_on_integers::<WideInt<WIDE>>(sides, dir, &places, unit);
    }
}

/// `places`: the origin and the corners, whole in units of 2^`unit`.
fn signs_on_integers<T: Integer>(sides: &mut Sides, dir: Vec3, places: &[Vec3; 4], unit: i32) {
    let of = |v: Vec3, unit| v.to_array().map(|x| T::of(x, unit));
    let d = of(dir, exact::common_exponent(dir.to_array()));
    let [origin, corners @ ..] = places.map(|v| of(v, unit));
    let [a, b, c] = corners.map(|v| exact::minus(&v, &origin));
    // The edge functions have a factor d.z more, which is not 0, and the frame's axes are a rotation.
    let z = dir[shear::frame(dir)[2]];
    let factor = if z > 0.0 { 1 } else { -1 };
    for (sign, (p, q)) in sides.signs.iter_mut().zip([(&c, &b), (&a, &c), (&b, &a)]) {
        if sign.is_none() {
            *sign = Some(factor * exact::det(&d, p, q).sign());
        }
    }
}
