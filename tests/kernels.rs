//! What holds for every kernel of the registry: one answer in every lane width, a bound on `t` that the oracle confirms.

use proptest::prelude::*;

use raylab::geometry::lanes::{F32x8, Lane, LaneMask, LaneRay, Pair};
use raylab::geometry::{Hit, Ray, Vec3};
use raylab::kernel::{KERNELS, Kernel, KernelUser, LaneHit, dispatch, entry, methods, parse};
use raylab::oracle;
use raylab::registry::Choice;

/// One kernel's answers for eight triangles: in eight lanes, and one by one.
struct BothWidths<'a> {
    ray: &'a Ray,
    triangles: &'a [[Vec3; 3]; 8],
}

impl BothWidths<'_> {
    fn lane<const W: usize, L: Lane<W>, R>(
        hit: Option<&LaneHit<W, L, R>>,
        lane: usize,
    ) -> Option<[u32; 3]> {
        let hit = hit.filter(|hit| hit.mask.bits() >> lane & 1 == 1)?;
        let of = |x: L| x.get(lane);
        // Which NaN comes out is not specified.
        let bits = |x: f32| if x.is_nan() { u32::MAX } else { x.to_bits() };
        Some([of(hit.t), of(hit.u), of(hit.v)].map(bits))
    }
}

impl KernelUser for BothWidths<'_> {
    type Out = [[Option<[u32; 3]>; 8]; 2];
    fn with<K: Kernel>(self, kernel: K) -> Self::Out {
        let wide_ray = kernel.prepare::<8, F32x8>(self.ray, &LaneRay::splat(self.ray));
        let wide = kernel.pack::<8>(|lane| self.triangles[lane]);
        let wide = kernel.intersect::<8, F32x8>(&wide_ray, &wide);
        let ray = kernel.prepare::<1, f32>(self.ray, &LaneRay::splat(self.ray));
        [
            std::array::from_fn(|lane| Self::lane(wide.as_ref(), lane)),
            std::array::from_fn(|lane| {
                let one = kernel.pack::<1>(|_| self.triangles[lane]);
                Self::lane(kernel.intersect::<1, f32>(&ray, &one).as_ref(), 0)
            }),
        ]
    }
}

/// One kernel's answers for one triangle and the rays of a packet: sixteen at a time, and one by one.
struct BothWays<'a> {
    rays: &'a [Ray; 16],
    corners: &'a [Vec3; 3],
}

impl KernelUser for BothWays<'_> {
    type Out = [[Option<[u32; 3]>; 16]; 2];
    fn with<K: Kernel>(self, kernel: K) -> Self::Out {
        let lanes: LaneRay<Pair<F32x8>> = LaneRay::of(|lane| &self.rays[lane]);
        let packed = kernel.pack::<1>(|_| *self.corners);
        let packet = kernel.prepare::<1, Pair<F32x8>>(&self.rays[0], &lanes);
        let packet = kernel.intersect::<1, Pair<F32x8>>(&packet, &packed);
        [
            std::array::from_fn(|lane| BothWidths::lane(packet.as_ref(), lane)),
            std::array::from_fn(|lane| {
                let ray = &self.rays[lane];
                let ray = kernel.prepare::<1, f32>(ray, &LaneRay::splat(ray));
                BothWidths::lane(kernel.intersect::<1, f32>(&ray, &packed).as_ref(), 0)
            }),
        ]
    }
}

/// A kernel's hit of one triangle, and its bound on the error of t.
struct OneHit<'a> {
    ray: &'a Ray,
    corners: &'a [Vec3; 3],
}

impl KernelUser for OneHit<'_> {
    type Out = Option<(Hit, f32)>;
    fn with<K: Kernel>(self, kernel: K) -> Self::Out {
        let packed = kernel.pack::<1>(|_| *self.corners);
        let ray = kernel.prepare::<1, f32>(self.ray, &LaneRay::splat(self.ray));
        let hit = kernel.intersect::<1, f32>(&ray, &packed)?;
        let LaneHit { mask, t, u, v, .. } = hit;
        mask.then(|| {
            let error = kernel.t_error(self.ray, self.corners, t);
            (Hit { t, u, v, prim: 0 }, error)
        })
    }
}

fn each_kernel() -> impl Iterator<Item = Choice> {
    KERNELS.iter().map(|k| parse(k.name).unwrap())
}

fn one_hit(kernel: &Choice, ray: &Ray, corners: &[Vec3; 3]) -> Option<(Hit, f32)> {
    dispatch(kernel, OneHit { ray, corners }).unwrap()
}

/// Numbers of one magnitude, near an offset: ordinary, tiny, subnormal, huge; whole numbers, which align; or any at all.
fn points(count: usize) -> impl Strategy<Value = Vec<Vec3>> {
    let ordinary = || prop_oneof![-1f32..1.0, (-2i32..=2).prop_map(|i| i as f32)];
    let scaled = prop_oneof![
        4 => Just((1.0, 0.0)),
        1 => Just((1.0, 1e4)),
        1 => Just((1.0, 1e6)),
        1 => Just((1e-3, 1.0)),
        1 => Just((1e-20, 0.0)),
        1 => Just((1e-42, 0.0)),
        1 => Just((1e12, 0.0)),
        1 => Just((1e37, 0.0)),
    ];
    let regular = scaled.prop_flat_map(move |(scale, offset)| {
        prop::collection::vec(prop::array::uniform3(ordinary()), count).prop_map(move |points| {
            let place = |p: [f32; 3]| Vec3::from(p) * scale + Vec3::splat(offset);
            points.into_iter().map(place).collect()
        })
    });
    let any = any::<u32>()
        .prop_map(f32::from_bits)
        .prop_filter("finite", |x| x.is_finite());
    prop_oneof![
        5 => regular,
        1 => prop::collection::vec(prop::array::uniform3(any).prop_map(Vec3::from), count),
    ]
}

/// Eight triangles, of which some are slivers, and a ray aimed at a mix of the first one's corners.
fn settings() -> impl Strategy<Value = (Ray, [[Vec3; 3]; 8])> {
    let weights = prop_oneof![
        prop::array::uniform3(0f32..1.0),
        prop::array::uniform3((0u8..=2).prop_map(f32::from)),
    ];
    (points(25), weights, -3f32..3.0, 1e-7f32..1.0).prop_filter_map(
        "a valid ray",
        |(p, [wa, wb, wc], stretch, narrow)| {
            let mut triangles: [[Vec3; 3]; 8] =
                std::array::from_fn(|i| [p[3 * i], p[3 * i + 1], p[3 * i + 2]]);
            for [a, b, c] in triangles.iter_mut().step_by(2) {
                *c = *a + (*b - *a) * 0.4 + (*c - *a) * narrow;
            }
            let [a, b, c] = triangles[0];
            let target = (a * wa + b * wb + c * wc) / (wa + wb + wc);
            let ray = Ray::new(p[24], (target - p[24]) * stretch);
            let finite = triangles.iter().flatten().all(|v| v.is_finite());
            (finite && ray.is_valid()).then_some((ray, triangles))
        },
    )
}

/// The exact t at which the ray's whole line crosses the plane, if the exact ray hits.
fn exact_t(ray: &Ray, corners: &[Vec3; 3]) -> Option<f64> {
    let line = Ray {
        t_min: f32::NEG_INFINITY,
        ..*ray
    };
    Some(oracle::judge_triangle(&line, corners)?.to_f64())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn one_lane_and_eight_give_the_same_bits((ray, triangles) in settings()) {
        for kernel in each_kernel() {
            let [wide, one] = dispatch(&kernel, BothWidths { ray: &ray, triangles: &triangles }).unwrap();
            prop_assert_eq!(wide, one, "{}", &kernel.name);
        }
    }

    #[test]
    fn a_packet_and_its_rays_alone_give_the_same_bits(
        (ray, triangles) in settings(), spread in 0f32..1.0, origin in any::<bool>()
    ) {
        // Directions towards corners and beside them: some have one longest axis, some not, and few triangles are hit by all.
        let rays: [Ray; 16] = std::array::from_fn(|i| {
            let target = triangles[i % 3][i / 3 % 3];
            let from = if origin { ray.origin } else { triangles[7][i % 3] };
            Ray::new(from, ray.dir + (target - ray.origin - ray.dir) * spread * (i % 5) as f32 * 0.25)
        });
        if rays.iter().all(Ray::is_valid) {
            for kernel in each_kernel() {
                for corners in &triangles[..2] {
                    let [packet, one] = dispatch(&kernel, BothWays { rays: &rays, corners }).unwrap();
                    prop_assert_eq!(packet, one, "{}", &kernel.name);
                }
            }
        }
    }

    #[test]
    fn the_true_t_lies_within_the_error_bound((ray, triangles) in settings()) {
        for corners in &triangles {
            let Some(truth) = exact_t(&ray, corners) else { continue };
            for kernel in each_kernel() {
                let Some((hit, error)) = one_hit(&kernel, &ray, corners) else { continue };
                prop_assert!(!error.is_nan());
                if !hit.t.is_finite() { continue }
                let off = (f64::from(hit.t) - truth).abs();
                let name = &kernel.name;
                prop_assert!(off <= f64::from(error), "{name}: t {}, truth {truth}, error {error}", hit.t);
                prop_assert!(truth <= f64::from(hit.t + error), "{name}: t {} + {error} is rounded below {truth}", hit.t);
            }
        }
    }

    #[test]
    fn triangles_without_area_are_misses(
        p in points(2), whole in prop::array::uniform9(-3i32..=3), shape in 0..5u8, along in -2f32..2.0
    ) {
        let vector = |i: usize| Vec3::new(whole[i] as f32, whole[i + 1] as f32, whole[i + 2] as f32);
        let corners = match shape {
            0 => [p[0]; 3],
            1 => [p[0], p[1], p[0]],
            2 => [p[0], p[1], p[1]],
            3 => [p[0], p[0], p[1]],
            // Three points of one line.
            _ => [vector(0), vector(0) + vector(3), vector(0) - vector(3) * 2.0],
        };
        let origin = vector(6) * p[0].x.abs().max(1.0);
        let ray = Ray::new(origin, corners[0] + (corners[1] - corners[0]) * along - origin);
        if ray.is_valid() {
            for kernel in each_kernel() {
                let hit = one_hit(&kernel, &ray, &corners).filter(|(hit, _)| !hit.t.is_nan());
                prop_assert!(hit.is_none(), "{}: {hit:?}", &kernel.name);
            }
        }
    }
}

/// A fixed triangle that is neither axis-parallel nor symmetric, and the ray at its point with weights u and v.
fn aimed(u: f32, v: f32) -> (Ray, [Vec3; 3]) {
    let corners = [
        Vec3::new(0.1, -0.3, 2.0),
        Vec3::new(1.2, 0.2, 2.5),
        Vec3::new(-0.1, 1.1, 3.0),
    ];
    let target = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
    let origin = Vec3::new(0.4, 0.2, -1.0);
    (Ray::new(origin, (target - origin) * 0.5), corners)
}

#[test]
fn every_kernel_hits_the_interior_at_the_right_t_and_weights() {
    for kernel in each_kernel() {
        for (u, v) in [(0.2, 0.3), (0.6, 0.1), (0.05, 0.9), (1.0 / 3.0, 1.0 / 3.0)] {
            let (ray, corners) = aimed(u, v);
            for winding in [[0, 1, 2], [1, 2, 0], [0, 2, 1]] {
                let turned = winding.map(|i| corners[i]);
                let (hit, error) = one_hit(&kernel, &ray, &turned).expect(&kernel.name);
                assert!((hit.t - 2.0).abs() < 1e-5, "{}", kernel.name);
                assert!(error < 1e-4, "{}: {error}", kernel.name);
                let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
                let wanted = [1.0 - u - v, u, v];
                for (weight, corner) in weights.iter().zip(winding) {
                    assert!((weight - wanted[corner]).abs() < 1e-4, "{}", kernel.name);
                }
            }
        }
    }
}

#[test]
fn every_kernel_misses_outside_and_parallel_to_the_plane() {
    for kernel in each_kernel() {
        for (u, v) in [(-0.1, 0.5), (0.5, -0.1), (0.6, 0.6), (3.0, -1.0)] {
            let (ray, corners) = aimed(u, v);
            assert!(
                one_hit(&kernel, &ray, &corners).is_none(),
                "{}",
                kernel.name
            );
        }
        let flat = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let above = Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::new(1.0, 2.0, -0.0));
        assert!(one_hit(&kernel, &above, &flat).is_none(), "{}", kernel.name);
    }
}

#[test]
fn no_ray_slips_through_a_shared_edge_of_a_watertight_kernel() {
    let (_, [a, b, c]) = aimed(0.3, 0.3);
    let d = Vec3::new(1.4, 1.3, 2.1);
    for kernel in each_kernel().filter(|k| entry(k).unwrap().watertight) {
        for i in 0..2000 {
            let origin = Vec3::new((i % 40) as f32 * 0.037, (i / 40) as f32 * 0.041, -1.0);
            let target = b + (c - b) * ((i * 7 % 2000) as f32 / 2000.0);
            let ray = Ray::new(origin, target - origin);
            let hit = [[a, b, c], [b, d, c]]
                .iter()
                .any(|t| one_hit(&kernel, &ray, t).is_some());
            assert!(hit, "{}: {ray:?}", kernel.name);
        }
    }
}

#[test]
fn the_unsigned_sum_takes_a_wider_rim_with_a_larger_eps() {
    let (ray, corners) = aimed(-1e-3, 0.5);
    let hit = |text| one_hit(&parse(text).unwrap(), &ray, &corners).is_some();
    assert!(!hit("sheet-unsigned"));
    assert!(hit("sheet-unsigned:eps=0.01"));
}

#[test]
fn names_are_unique_and_kebab_case_and_every_row_says_what_it_must() {
    for (i, kernel) in KERNELS.iter().enumerate() {
        let kebab = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        assert!(kernel.name.chars().all(kebab));
        assert!(KERNELS[..i].iter().all(|k| k.name != kernel.name));
        assert!(kernel.about.ends_with('.'), "{}", kernel.name);
        let marked = kernel.about.starts_with("Control: ");
        assert_eq!(marked, kernel.control, "{}", kernel.name);
        assert_eq!(methods().any(|k| k.name == kernel.name), !kernel.control);
        for text in [kernel.paper, kernel.operations, kernel.known_failures] {
            assert!(!text.is_empty(), "{}", kernel.name);
        }
        assert_eq!(
            parse(kernel.name).unwrap().label(kernel.params),
            kernel.name
        );
    }
}

#[test]
fn the_bytes_a_row_states_are_those_a_packed_triangle_takes() {
    struct Size;
    impl KernelUser for Size {
        type Out = usize;
        fn with<K: Kernel>(self, _: K) -> usize {
            size_of::<K::Packed<1>>()
        }
    }
    for kernel in KERNELS {
        let size = dispatch(&parse(kernel.name).unwrap(), Size).unwrap();
        assert_eq!(size, kernel.bytes_per_triangle, "{}", kernel.name);
    }
}

#[test]
fn an_error_bound_is_tight_enough_to_stop_at() {
    let (ray, corners) = aimed(0.3, 0.3);
    for kernel in each_kernel() {
        let (hit, error) = one_hit(&kernel, &ray, &corners).unwrap();
        assert!(error < 2e-5 * hit.t, "{}: {error}", kernel.name);
    }
}
