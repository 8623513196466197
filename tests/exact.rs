//! The kernel `exact` is never wrong: its hits, intervals, order and `t` are those of the oracle, on settings that are made
//! to deceive it.

use std::cmp::Ordering;

use proptest::prelude::*;

use raylab::geometry::lanes::{F32x8, LaneMask, LaneRay};
use raylab::geometry::{Hit, Ray, Vec3};
use raylab::kernel::exact::{Stage, stage};
use raylab::kernel::{Exact, Kernel, LaneHit};
use raylab::oracle::{self, ExactT};
use raylab::scene::Mesh;

type Corners = [Vec3; 3];

/// What the kernel says of one triangle: the hit on the line, and whether it lies in the interval.
fn asked(ray: &Ray, corners: &Corners) -> Option<(Hit, bool)> {
    let packed = Exact.pack::<1>(|_| *corners);
    let prepared = Exact.prepare::<1, f32>(ray, &LaneRay::splat(ray));
    let LaneHit { mask, t, u, v, .. } = Exact.intersect::<1, f32>(&prepared, &packed)?;
    let hit = Hit { t, u, v, prim: 0 };
    mask.then(|| (hit, Exact.within(&mesh(&[*corners]), ray, &hit)))
}

fn mesh(triangles: &[Corners]) -> Mesh {
    let vertices = triangles.iter().flatten().copied().collect();
    let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    Mesh::new(vertices, indices.collect()).unwrap()
}

fn whole_line(ray: &Ray) -> Ray {
    Ray {
        t_min: f32::NEG_INFINITY,
        t_max: f32::INFINITY,
        ..*ray
    }
}

/// Whether `t` is the true one or one of the two numbers beside it.
fn is_faithful(t: f32, truth: &ExactT) -> bool {
    truth.cmp_f32(t.next_down()) == Ordering::Greater
        && truth.cmp_f32(t.next_up()) == Ordering::Less
        || truth.cmp_f32(t) == Ordering::Equal
        || t.is_infinite()
}

/// Checks one ray and triangle.
fn check(ray: &Ray, corners: &Corners) -> Result<(), TestCaseError> {
    let line = oracle::judge_triangle(&whole_line(ray), corners);
    let in_interval = oracle::judge_triangle(ray, corners).is_some();
    let asked = asked(ray, corners);
    let story = format!("{ray:?} {corners:?} {asked:?}");
    prop_assert_eq!(asked.is_some(), line.is_some(), "hit: {}", &story);
    if let (Some((hit, within)), Some(truth)) = (asked, line) {
        prop_assert_eq!(within, in_interval, "interval: {}", &story);
        prop_assert!(
            is_faithful(hit.t, &truth),
            "t: {} {}",
            truth.to_f64(),
            &story
        );
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        prop_assert!(
            weights.iter().all(|w| (-1e-3..=1.001).contains(w)),
            "weights: {}",
            &story
        );
    }
    Ok(())
}

/// A number as it comes: ordinary, whole, or any at all.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -1f32..1.0,
        4 => (-4i32..=4).prop_map(|i| i as f32),
        1 => prop::sample::select(vec![0.0, -0.0, 1e-45, -1e-45, f32::MIN_POSITIVE, f32::MAX, -f32::MAX]),
        1 => any::<u32>().prop_map(f32::from_bits).prop_filter("finite", |x| x.is_finite()),
    ]
}

fn point() -> impl Strategy<Value = Vec3> {
    let plain = || prop_oneof![-1f32..1.0, (-4i32..=4).prop_map(|i| i as f32)];
    prop_oneof![
        6 => prop::array::uniform3(plain()).prop_map(Vec3::from),
        1 => prop::array::uniform3(number()).prop_map(Vec3::from),
    ]
}

/// Where a scene is and how large: scale and offset.
fn place() -> impl Strategy<Value = (f32, f32)> {
    prop::sample::select(vec![
        (1.0, 0.0),
        (1.0, 1.0),
        (1.0, 1e2),
        (1.0, 1e4),
        (1.0, 1e6),
        (1e-3, 1.0),
        (1e-6, 1e3),
        (1e-15, 0.0),
        (1e-16, 0.0),
        (1e-20, 0.0),
        (1e-30, 0.0),
        (1e-38, 0.0),
        (1e-42, 0.0),
        (1e9, 0.0),
        (1e17, 0.0),
        (1e18, 0.0),
        (1e19, 0.0),
        (1e30, 0.0),
        (5e37, 0.0),
    ])
}

/// A ray at a place that is hard to judge: a corner, an edge, the plane, a rim within an ulp.
fn settings() -> impl Strategy<Value = (Ray, Vec<Corners>)> {
    let weights = prop_oneof![
        2 => prop::array::uniform3(0f32..1.0),
        3 => prop::array::uniform3((0u8..=2).prop_map(f32::from)),
        // Beside the rim by little.
        2 => (0f32..1.0, -1e-6f32..1e-6).prop_map(|(a, b)| [a, 1.0 - a - b, b]),
    ];
    let aim = (
        weights,
        prop::sample::select(vec![1.0, 0.5, 3.0, -1.0, 1e-20, 1e10, 1e-3]),
        0..8u8,
    );
    let interval = (prop::sample::select(vec![0, 1, 2, 3]), -2i32..=2, 0f32..2.0);
    let points = prop::collection::vec(point(), 13);
    (points, place(), aim, interval).prop_filter_map(
        "a valid ray",
        |(p, (scale, offset), ([wa, wb, wc], stretch, kind), (end, ulps, far))| {
            let p: Vec<Vec3> = p
                .into_iter()
                .map(|v| v * scale + Vec3::splat(offset))
                .collect();
            let [a, b, c] = [p[0], p[1], p[2]];
            let target = (a * wa + b * wb + c * wc) / (wa + wb + wc);
            let (origin, dir) = match kind {
                0 => (a, b - a),
                1 => (p[3], b - a),
                2 => (target, p[3] - target),
                3 => (
                    Vec3::new(target.x, target.y, p[3].z),
                    Vec3::new(0.0, -0.0, target.z - p[3].z),
                ),
                _ => (p[3], target - p[3]),
            };
            let mut ray = Ray::new(origin, dir * stretch);
            let near = ((target - origin).length() / ray.dir.length()).to_bits() as i32 + ulps;
            let near = f32::from_bits(near.max(0) as u32);
            match end {
                0 => {}
                1 => ray.t_max = near,
                2 => ray.t_min = near,
                _ => (ray.t_min, ray.t_max) = (-far, far),
            }
            // Neighbours that share the edge that is aimed at, a copy, and others.
            let triangles = vec![
                [a, b, c],
                [b, a, p[4]],
                [c, b, p[5]],
                [a, c, p[6]],
                [c, a, b],
                [a, b, (a + b) * 0.5],
                [p[7], p[8], p[9]],
                [a, p[10], p[11]],
            ];
            let finite = triangles.iter().flatten().all(|v| v.is_finite());
            (finite && ray.is_valid()).then_some((ray, triangles))
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, max_global_rejects: 200_000, ..ProptestConfig::default() })]

    #[test]
    fn hits_intervals_and_t_are_those_of_the_oracle((ray, triangles) in settings()) {
        for corners in &triangles {
            check(&ray, corners)?;
        }
    }

    #[test]
    fn anything_that_an_f32_can_be_is_judged_right(xs in prop::collection::vec(number(), 15)) {
        let v = |i: usize| Vec3::new(xs[i], xs[i + 1], xs[i + 2]);
        let ray = Ray::new(v(0), v(3));
        if ray.is_valid() {
            check(&ray, &[v(6), v(9), v(12)])?;
        }
    }

    #[test]
    fn of_two_hits_the_nearer_is_preferred_and_of_ties_the_lower_index((ray, triangles) in settings()) {
        let mesh = mesh(&triangles);
        let line = whole_line(&ray);
        let hits: Vec<(Hit, ExactT)> = (0..triangles.len()).filter_map(|i| {
            let (hit, _) = asked(&line, &triangles[i])?;
            let truth = oracle::judge_triangle(&line, &triangles[i])?;
            Some((Hit { prim: i as u32, ..hit }, truth))
        }).collect();
        for (new, new_t) in &hits {
            prop_assert!(Exact.nearer(&mesh, &line, new, &Hit::MISS));
            for (best, best_t) in &hits {
                let wanted = new_t.cmp(best_t).then(new.prim.cmp(&best.prim)) == Ordering::Less;
                prop_assert_eq!(Exact.nearer(&mesh, &line, new, best), wanted, "{:?} {:?} {:?}", ray, new, best);
            }
        }
    }

    #[test]
    fn what_the_filter_cannot_tell_is_right_beside_what_it_can((ray, triangles) in settings()) {
        let packed = Exact.pack::<8>(|lane| triangles[lane]);
        let prepared = Exact.prepare::<8, F32x8>(&ray, &LaneRay::splat(&ray));
        let hit = Exact.intersect::<8, F32x8>(&prepared, &packed);
        let bits = hit.map_or(0, |hit| hit.mask.bits());
        for (lane, corners) in triangles.iter().enumerate() {
            let truth = oracle::judge_triangle(&whole_line(&ray), corners).is_some();
            prop_assert_eq!(bits >> lane & 1 == 1, truth, "{:?} {:?}", ray, corners);
        }
    }
}

#[test]
fn the_filters_decide_what_is_plain_and_leave_what_is_not() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let at = |x: f32, y: f32| {
        stage(
            &Ray::new(Vec3::new(0.3, 0.2, 2.0), Vec3::new(x - 0.3, y - 0.2, -2.0)),
            &corners,
        )
    };
    assert_eq!(at(0.25, 0.25), Stage::F32);
    assert_eq!(at(2.0, 1.0), Stage::F32);
    assert_eq!(at(0.25, 1e-8), Stage::F64);
    assert_eq!(at(0.0, 0.0), Stage::Integers);
    assert_eq!(
        stage(&Ray::new(Vec3::ONE, -Vec3::ONE), &[Vec3::X; 3]),
        Stage::F32
    );
}
