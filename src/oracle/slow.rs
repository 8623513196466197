//! The slow judge of the oracle's own tests: Cramer's rule on big rationals, over all triangles, and the adversarial
//! numbers it is asked about. Another formula than the oracle's, on another library's integers.

use num_bigint::BigInt;
use num_rational::BigRational;
use proptest::prelude::*;

use crate::geometry::{Ray, Vec3};

type Vector = [BigRational; 3];

fn vector(v: Vec3) -> Vector {
    v.to_array().map(|x| BigRational::from_float(x).unwrap())
}

fn minus(a: &Vector, b: &Vector) -> Vector {
    [0, 1, 2].map(|i| &a[i] - &b[i])
}

fn det(a: &Vector, b: &Vector, c: &Vector) -> BigRational {
    let minor = |i: usize, j: usize| &b[i] * &c[j] - &b[j] * &c[i];
    &a[0] * minor(1, 2) + &a[1] * minor(2, 0) + &a[2] * minor(0, 1)
}

/// The exact `t` of a hit: o + t·d = v0 + u·e1 + v·e2, solved for t, u and v.
pub fn judge_triangle(ray: &Ray, corners: &[Vec3; 3]) -> Option<BigRational> {
    let zero = BigRational::from_integer(BigInt::from(0));
    let one = BigRational::from_integer(BigInt::from(1));
    let [a, b, c] = corners.map(vector);
    let (e1, e2) = (minus(&b, &a), minus(&c, &a));
    let (s, d) = (minus(&vector(ray.origin), &a), vector(ray.dir).map(|x| -x));
    let whole = det(&d, &e1, &e2);
    if whole == zero {
        return None;
    }
    let t = det(&s, &e1, &e2) / &whole;
    let u = det(&d, &s, &e2) / &whole;
    let v = det(&d, &e1, &s) / &whole;
    let above = BigRational::from_float(ray.t_min).is_none_or(|bound| t >= bound);
    let below = BigRational::from_float(ray.t_max).is_none_or(|bound| t <= bound);
    (u >= zero && v >= zero && u + v <= one && above && below).then_some(t)
}

/// The least `t` over all triangles, and who has it.
pub fn truth(ray: &Ray, triangles: &[[Vec3; 3]]) -> Option<(BigRational, Vec<u32>)> {
    let hits: Vec<_> = (0..)
        .zip(triangles)
        .filter_map(|(prim, corners)| Some((judge_triangle(ray, corners)?, prim)))
        .collect();
    let least = hits.iter().map(|(t, _)| t).min()?.clone();
    let ties = hits.iter().filter(|(t, _)| *t == least);
    Some((least.clone(), ties.map(|&(_, prim)| prim).collect()))
}

/// Coordinates of one kind: small whole numbers, which meet and align often; those far from the origin, tiny, or huge;
/// subnormal ones; ordinary ones; any at all.
fn coordinates() -> impl Strategy<Value = BoxedStrategy<f32>> {
    let small = || (-3i32..=3).prop_map(|i| i as f32);
    prop_oneof![
        Just(small().boxed()),
        Just(small().prop_map(|x| x + 1e6).boxed()),
        Just(small().prop_map(|x| x * 1e-38).boxed()),
        Just(small().prop_map(|x| x * 1e30).boxed()),
        Just((-3i32..=3).prop_map(|i| i as f32 * 1e-45).boxed()),
        Just((-1f32..1.0).boxed()),
        Just(prop_oneof![small(), (-1f32..1.0), Just(1e-30), Just(-3e30), Just(-0.0)].boxed()),
        Just(
            any::<u32>()
                .prop_map(f32::from_bits)
                .prop_filter("finite", |x| x.is_finite())
                .boxed()
        ),
    ]
}

fn point(of: BoxedStrategy<f32>) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(of).prop_map(Vec3::from_array)
}

/// Triangles of one kind of coordinates, and a ray that is aimed at a corner, at an edge, along the first triangle's
/// plane, or anywhere.
pub fn settings(triangles: usize) -> impl Strategy<Value = (Ray, Vec<[Vec3; 3]>)> {
    coordinates()
        .prop_flat_map(move |of| {
            let triangle = || prop::array::uniform3(point(of.clone()));
            (
                prop::collection::vec(triangle(), triangles),
                prop::array::uniform2(point(of.clone())),
                0..5u8,
                prop_oneof![Just(0.0), Just(-1.0), Just(f32::NEG_INFINITY), 0f32..2.0],
                prop_oneof![Just(f32::INFINITY), Just(1.0), Just(1e-3), 0f32..9.0],
            )
        })
        .prop_filter_map(
            "a valid ray",
            |(mesh, [origin, free], aim, t_min, t_max)| {
                let [a, b, c] = mesh[0];
                let dir = match aim {
                    0 => a - origin,
                    1 => (a + b) * 0.5 - origin,
                    2 => c - b,
                    3 => free,
                    _ => Vec3::new(free.x, 0.0, -0.0),
                };
                let ray = Ray {
                    origin,
                    t_min,
                    dir,
                    t_max,
                };
                ray.is_valid().then_some((ray, mesh))
            },
        )
}
