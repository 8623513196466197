//! Every kind of lane computes what one number does, on every instruction set that this machine has.

use super::*;
use crate::geometry::Hit;
use proptest::prelude::*;

fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        any::<u32>().prop_map(f32::from_bits),
        (-2i32..=2).prop_map(|i| i as f32),
    ]
}

/// Equal bits, or both NaN: which NaN comes out is not specified.
fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// Checks all operations of one lane type on numbers `xs` and `ys`.
fn check<const W: usize, L: Lane<W>>(xs: &[f32; 16], ys: &[f32; 16]) {
    let (a, b) = (L::from_fn(|i| xs[i]), L::from_fn(|i| ys[i]));
    let lanes = [
        a + b,
        a - b,
        a * b,
        a / b,
        -a,
        a.abs(),
        a.sqrt(),
        a.max(b),
        a.min(b),
        a.mul_add(b, a),
    ];
    let masks = [
        a.lt(b),
        a.le(b),
        a.eq(b),
        a.gt(b),
        a.ge(b),
        !a.lt(b),
        a.same_bits(b),
        a.same_bits(a),
    ];
    let chosen = L::select(a.lt(b), a, b);
    for i in 0..L::N {
        let (x, y) = (xs[i], ys[i]);
        let greater = if x > y { x } else { y };
        let less = if x < y { x } else { y };
        let ones = [
            x + y,
            x - y,
            x * y,
            x / y,
            -x,
            x.abs(),
            x.sqrt(),
            greater,
            less,
            x.mul_add(y, x),
        ];
        for (k, (lane, one)) in lanes.iter().zip(ones).enumerate() {
            assert!(
                same(lane.get(i), one),
                "operation {k}: {} {one}",
                lane.get(i)
            );
        }
        let truths = [
            x < y,
            x <= y,
            x == y,
            x > y,
            x >= y,
            (x >= y) | x.is_nan() | y.is_nan(),
            x.to_bits() == y.to_bits(),
            true,
        ];
        for (k, (mask, truth)) in masks.iter().zip(truths).enumerate() {
            assert_eq!(
                mask.bits() >> i & 1 == 1,
                truth,
                "comparison {k} of {x} and {y}"
            );
        }
        assert!(same(chosen.get(i), if x < y { x } else { y }));
        assert!(same(L::splat(x).get(i), x));
    }
    if xs[..L::N].iter().all(|x| !x.is_nan()) {
        let least = xs[..L::N].iter().copied().fold(f32::INFINITY, f32::min);
        let greatest = xs[..L::N].iter().copied().fold(f32::NEG_INFINITY, f32::max);
        assert_eq!((a.least(), a.greatest()), (least, greatest));
    }
    let all = (1_u32 << L::N) - 1;
    assert_eq!(a.lt(b).any(), (0..L::N).any(|i| xs[i] < ys[i]));
    assert_eq!((a.lt(b) & b.lt(a)).bits() & all, 0);
    assert_eq!(
        (a.lt(b) | a.ge(b)).bits() & all,
        (a.eq(a) & b.eq(b)).bits() & all
    );
}

struct CheckAll<'a>(&'a [f32; 16], &'a [f32; 16]);

impl Task for CheckAll<'_> {
    type Out = ();
    #[inline(always)]
    fn run<I: Isa>(self) {
        check::<8, I::X8>(self.0, self.1);
        check::<1, I::Rays>(self.0, self.1);
        let eight: [f32; 8] = std::array::from_fn(|i| self.0[i]);
        let loaded = <I::X8 as Lane<8>>::load(&eight);
        assert!((0..8).all(|i| same(loaded.get(i), eight[i])));
        assert!(same(
            <I::Rays as Lane<1>>::load(&[self.1[3]]).get(11),
            self.1[3]
        ));
    }
}

struct Sort {
    keys: [f32; 8],
    met: u32,
}

impl Task for Sort {
    type Out = (Vec<u32>, Vec<u32>);
    #[inline(always)]
    fn run<I: Isa>(self) -> Self::Out {
        let values = [10, 11, 12, 13, 14, 15, 16, 17];
        let (mut sorted, mut keys) = ([0; 8], [0.0; 8]);
        I::greatest_first(
            I::X8::load(&self.keys),
            self.met,
            &values,
            &mut sorted,
            &mut keys,
        );
        let count = self.met.count_ones() as usize;
        let keys = keys[..count].iter().map(|k| k.to_bits());
        (sorted[..count].to_vec(), keys.collect())
    }
}

fn sets() -> impl Iterator<Item = InstructionSet> {
    InstructionSet::ALL
        .into_iter()
        .filter(|set| set.is_available())
}

proptest! {
    #[test]
    fn each_lane_computes_what_one_number_does(
        xs in prop::array::uniform16(number()), ys in prop::array::uniform16(number())
    ) {
        check::<1, f32>(&xs, &ys);
        for set in sets() {
            set.run(CheckAll(&xs, &ys));
        }
    }

    #[test]
    fn keys_are_sorted_alike_on_every_instruction_set(
        keys in prop::array::uniform8(prop_oneof![0f32..4.0, Just(0.0), Just(1.0), Just(f32::MAX)]), met in 1_u32..256
    ) {
        // A stable sort of the lanes by their keys without the last three bits, the later of equals first.
        let key = |lane: u32| keys[lane as usize].to_bits() & !7;
        let mut lanes: Vec<u32> = (0..8).filter(|lane| met >> lane & 1 == 1).collect();
        lanes.sort_by_key(|&lane| std::cmp::Reverse((key(lane), lane)));
        for set in sets() {
            let (values, sorted) = set.run(Sort { keys, met });
            prop_assert_eq!(&values, &lanes.iter().map(|lane| lane + 10).collect::<Vec<_>>(), "{}", set);
            prop_assert_eq!(sorted, lanes.iter().map(|&lane| key(lane) | lane).collect::<Vec<_>>(), "{}", set);
        }
    }
}

#[test]
fn the_best_instruction_set_is_available() {
    assert!(InstructionSet::best().is_available());
    assert!(InstructionSet::Portable.is_available());
}

/// Rays that become lanes, and lanes that become hits.
struct Transposed<'a>(&'a [Ray; SIXTEEN]);

impl Task for Transposed<'_> {
    type Out = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let lanes = I::rays(self.0);
        let few = RayLanes::of::<I>(5, |lane| &self.0[lane]);
        let LaneRay { origin, dir } = lanes.lines;
        let answers = HitLanes {
            t: origin.x,
            u: dir.y,
            v: lanes.t_max,
            prim: dir.z,
        };
        let mut hits = [Hit::MISS; SIXTEEN];
        I::hits(&answers, &mut hits);
        for (lane, ray) in self.0.iter().enumerate() {
            let of = |lanes: [I::Rays; 3]| Vec3::from(lanes.map(|row| row.get(lane)));
            assert_eq!(of([origin.x, origin.y, origin.z]), ray.origin);
            assert_eq!(of([dir.x, dir.y, dir.z]), ray.dir);
            assert_eq!(lanes.t_min.get(lane), ray.t_min);
            assert_eq!(lanes.t_max.get(lane), ray.t_max);
            assert_eq!(few.t_max.get(lane), self.0[lane.min(4)].t_max);
            let hit = Hit {
                t: ray.origin.x,
                u: ray.dir.y,
                v: ray.t_max,
                prim: ray.dir.z.to_bits(),
            };
            assert_eq!(hits[lane], hit);
        }
    }
}

#[test]
fn rays_become_lanes_and_lanes_hits() {
    let rays: [Ray; SIXTEEN] = std::array::from_fn(|i| {
        let x = 8.0 * i as f32;
        Ray {
            origin: Vec3::new(x, x + 1.0, x + 2.0),
            t_min: x + 3.0,
            dir: Vec3::new(x + 4.0, x + 5.0, x + 6.0),
            t_max: x + 7.0,
        }
    });
    for set in InstructionSet::ALL {
        set.run(Transposed(&rays));
    }
}

#[test]
fn bits_tell_zeros_apart_and_equal_nans_not() {
    let zeros = F32x8::from_fn(|lane| if lane < 4 { 0.0 } else { -0.0 });
    assert_eq!(zeros.same_bits(F32x8::splat(0.0)).bits(), 0x0f);
    let nans = F32x8::splat(f32::NAN);
    assert_eq!(nans.same_bits(nans).bits(), 0xff);
}
