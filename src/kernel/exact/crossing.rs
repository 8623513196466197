//! Where a line crosses a triangle's plane: `t` to the nearest `f32` but one, and exact comparisons.
//!
//! ```text
//! t = N / D,   N = det(v0 - origin, e1, e2),   D = det(dir, e1, e2)
//! ```

use std::cmp::Ordering;

use crate::geometry::exact::{self, ExactInt, Integer, WideInt};
use crate::geometry::{DVec3, Hit, Ray, Vec3};
use crate::kernel::error;
use crate::scene::Mesh;

/// Where a determinant exceeds this part of the product of its rows' greatest elements, its 8 roundings of 6 products are
/// less than 2⁻²⁷ of it, and `t` is off by less than a fifth of an ulp of `f32` before it is rounded.
const CLEAR: f64 = 1.0 / 1_048_576.0;

/// Roundings of a determinant in `f64` in units of its permanent: eight, with room for the permanent's own.
const ROUNDINGS: f64 = 9.0 * 1.110_223_024_625_156_5e-16;

/// Limbs that hold a product of a numerator and a denominator whose coordinates span at most [`NARROW_SPAN`] bits, as nearly
/// all do: (3·81 + 3) + (80 + 2·81 + 3) bits.
const NARROW: usize = 8;
const NARROW_SPAN: u32 = 80;
/// Limbs that hold it for any.
const WIDE: usize = 28;

/// 2⁻²⁶: with such an error a quotient is still rounded to one of the two `f32` beside the true one.
const ENOUGH: f64 = 1.490_116_119_384_765_6e-8;

/// `t` where the line crosses the plane: one of the two `f32` beside the true one, or it. The line is not parallel to the
/// plane.
#[inline]
pub(super) fn time(origin: Vec3, dir: Vec3, corners: &[Vec3; 3]) -> f32 {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let (a, e1, e2, dir64) = (a - origin.as_dvec3(), b - a, c - a, dir.as_dvec3());
    let normal = e1.cross(e2);
    let (n, d) = (a.dot(normal), dir64.dot(normal));
    let size = CLEAR * largest(e1) * largest(e2);
    if n.abs() > size * largest(a) && d.abs() > size * largest(dir64) {
        return (n / d) as f32;
    }
    Crossing {
        origin,
        dir,
        corners: *corners,
    }
    .time()
}

/// The greatest absolute value of a component, none of which is NaN.
#[inline(always)]
fn largest(v: DVec3) -> f64 {
    let v = v.abs();
    let xy = if v.x > v.y { v.x } else { v.y };
    if xy > v.z { xy } else { v.z }
}

/// Whether the corners lie on one line.
#[cold]
pub(super) fn without_area(corners: &[Vec3; 3]) -> bool {
    let unit = exact::common_exponent(corners.iter().flat_map(Vec3::to_array));
    let [a, b, c] = corners.map(|v| integers::<WideInt<WIDE>>(v, unit));
    let (p, q) = (exact::minus(&b, &a), exact::minus(&c, &a));
    [(0, 1), (1, 2), (2, 0)]
        .iter()
        .all(|&(i, j)| (p[i] * q[j] - p[j] * q[i]).signum() == 0)
}

/// The components in units of 2^`unit`.
fn integers<T: Integer>(v: Vec3, unit: i32) -> [T; 3] {
    v.to_array().map(|x| T::of(x, unit))
}

/// A line that crosses a triangle's plane in one point.
#[derive(Clone, Copy)]
pub(super) struct Crossing {
    origin: Vec3,
    dir: Vec3,
    corners: [Vec3; 3],
}

impl Crossing {
    /// That of a hit.
    #[cold]
    pub fn new(mesh: &Mesh, ray: &Ray, hit: &Hit) -> Self {
        Self {
            origin: ray.origin,
            dir: ray.dir,
            corners: mesh.corners(hit.prim),
        }
    }

    /// `t` in `f64`, and a bound on its relative error; `None` where the numerator or denominator may be 0.
    fn approximate(&self) -> Option<(f64, f64)> {
        let [a, e1, e2] = {
            let [a, b, c] = self.corners.map(Vec3::as_dvec3);
            [a - self.origin.as_dvec3(), b - a, c - a]
        };
        let dir = self.dir.as_dvec3();
        let normal = e1.cross(e2);
        let (n, d) = (a.dot(normal), dir.dot(normal));
        let errors = [(n, a), (d, dir)]
            .map(|(value, row)| ROUNDINGS * error::permanent(row, e1, e2) / value.abs());
        // 1 / (1 - e) <= 1 + 2e for e <= 1/2; the quotient rounds once more.
        let relative = errors[0] + 2.0 * errors[1] + 2.0 * errors[0] * errors[1] + f64::EPSILON;
        (errors[0] < 0.5 && errors[1] < 0.5).then_some((n / d, relative))
    }

    /// See [`time`].
    #[cold]
    fn time(&self) -> f32 {
        if let Some((t, error)) = self.approximate()
            && error <= ENOUGH
        {
            return t as f32;
        }
        if self.span() <= NARROW_SPAN {
            self.fraction::<NARROW>(self.unit()).quotient()
        } else {
            self.fraction::<WIDE>(self.unit()).quotient()
        }
    }

    /// Bits that the coordinates span, and those of the direction.
    fn span(&self) -> u32 {
        let dir = exact::span(self.dir.to_array());
        dir.max(exact::span(self.coordinates()))
    }

    fn coordinates(&self) -> impl Iterator<Item = f32> {
        let [a, b, c] = self.corners;
        [self.origin, a, b, c]
            .into_iter()
            .flat_map(|v| v.to_array())
    }
    /// The exponent in which the corners and the origin are whole.
    fn unit(&self) -> i32 {
        exact::common_exponent(self.coordinates())
    }

    /// `t` as a fraction, of corners and origin in units of 2^`unit`.
    fn fraction<const N: usize>(&self, unit: i32) -> Fraction<N> {
        // What lies below the coordinates' own unit makes their integers longer.
        let below = (self.unit() - unit).unsigned_abs();
        let (n, d) = if self.span() + below <= exact::SMALL_SPAN {
            let (n, d) = self.determinants::<i128>(unit);
            (n.into(), d.into())
        } else {
            self.determinants::<WideInt<N>>(unit)
        };
        let (numerator, denominator) = if d.signum() < 0 { (-n, -d) } else { (n, d) };
        Fraction {
            numerator,
            denominator,
            exponent: unit - self.dir_unit(),
        }
    }

    /// The exponent in which the direction is whole.
    fn dir_unit(&self) -> i32 {
        exact::common_exponent(self.dir.to_array())
    }

    /// N and D, of corners and origin in units of 2^`unit`.
    fn determinants<T: Integer>(&self, unit: i32) -> (T, T) {
        let [a, b, c] = self.corners.map(|v| integers::<T>(v, unit));
        let (e1, e2) = (exact::minus(&b, &a), exact::minus(&c, &a));
        let a = exact::minus(&a, &integers(self.origin, unit));
        let n = exact::det(&a, &e1, &e2);
        let d = exact::det(&integers(self.dir, self.dir_unit()), &e1, &e2);
        (n, d)
    }

    /// Compares `t` with an end of an interval, which may be infinite.
    fn compare_with(&self, end: f32) -> Ordering {
        if end == 0.0 && self.span() <= NARROW_SPAN {
            return self
                .fraction::<NARROW>(self.unit())
                .numerator
                .signum()
                .cmp(&0);
        }
        if end.is_infinite() {
            return 0.0_f32.total_cmp(&end);
        }
        if let Some((t, error)) = self.approximate() {
            let (off, room) = (t - f64::from(end), 2.0 * error * t.abs());
            if off.abs() > room + f64::EPSILON * f64::from(end).abs() {
                return off.total_cmp(&0.0);
            }
        }
        let Fraction {
            numerator,
            denominator,
            exponent,
        } = self.fraction::<WIDE>(self.unit());
        // n·2^exponent against m·2^e·d.
        let e = exact::decompose(end).1;
        let (left, right) = (numerator, ExactInt::of(end, e) * denominator);
        let shift = exponent - e;
        if shift >= 0 {
            left.shifted(shift as u32).cmp(&right)
        } else {
            left.cmp(&right.shifted(-shift as u32))
        }
    }

    /// Whether `t` lies within the ray's interval, both ends included.
    #[cold]
    pub fn is_within(&self, ray: &Ray) -> bool {
        self.compare_with(ray.t_min).is_ge() && self.compare_with(ray.t_max).is_le()
    }

    /// Compares two `t` of one line.
    #[cold]
    pub fn compare(&self, other: &Self) -> Ordering {
        // One triangle, or copies of it wound or begun otherwise.
        if self.corners.iter().all(|v| other.corners.contains(v)) {
            return Ordering::Equal;
        }
        if let (Some((t, error)), Some((s, other_error))) =
            (self.approximate(), other.approximate())
        {
            let room = 2.0 * (error * t.abs() + other_error * s.abs());
            if (t - s).abs() > room {
                return t.total_cmp(&s);
            }
        }
        let unit = self.unit().min(other.unit());
        let span = exact::span(self.coordinates().chain(other.coordinates()));
        if span.max(exact::span(self.dir.to_array())) <= NARROW_SPAN {
            self.fraction::<NARROW>(unit).compare(&other.fraction(unit))
        } else {
            self.fraction::<WIDE>(unit).compare(&other.fraction(unit))
        }
    }
}

/// `numerator / denominator · 2^exponent`, the denominator positive.
struct Fraction<const N: usize> {
    numerator: WideInt<N>,
    denominator: WideInt<N>,
    exponent: i32,
}

impl<const N: usize> Fraction<N> {
    fn quotient(&self) -> f32 {
        let ((n, en), (d, ed)) = (
            self.numerator.to_scaled_f64(),
            self.denominator.to_scaled_f64(),
        );
        // t lies between 2⁻⁸³⁷ and 2⁸³⁷ or is 0.
        (n / d * 2_f64.powi(en - ed + self.exponent)) as f32
    }

    /// Compares two fractions of one exponent.
    fn compare(&self, other: &Self) -> Ordering {
        (self.numerator * other.denominator).cmp(&(other.numerator * self.denominator))
    }
}
