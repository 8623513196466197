use super::super::packet::Bundle;
use super::super::testbed::Dice;
use super::*;
use crate::geometry::Vec3;
use crate::geometry::lanes::{InstructionSet, Isa, Lane, LaneMask, Task};

/// A ray and a box of whole numbers, so that all of it can be judged exactly.
#[derive(Debug, Clone, Copy)]
struct Case {
    origin: [i64; 3],
    dir: [i64; 3],
    least: [i64; 3],
    greatest: [i64; 3],
}

impl Case {
    /// Whether the ray touches the closed box grown by `grown`, by exact fractions.
    fn touches(&self, grown: i64) -> bool {
        // t in [entry, exit], each a fraction with a positive denominator.
        let mut entry = (0_i128, 1_i128);
        let mut exit: Option<(i128, i128)> = None;
        for a in 0..3 {
            let lo = i128::from(self.least[a] - grown - self.origin[a]);
            let hi = i128::from(self.greatest[a] + grown - self.origin[a]);
            let d = i128::from(self.dir[a]);
            if d == 0 {
                if lo > 0 || hi < 0 {
                    return false;
                }
                continue;
            }
            let (near, far) = if d > 0 { (lo, hi) } else { (-hi, -lo) };
            let d = d.abs();
            if near * entry.1 > entry.0 * d {
                entry = (near, d);
            }
            if exit.is_none_or(|e| far * e.1 < e.0 * d) {
                exit = Some((far, d));
            }
        }
        exit.is_none_or(|exit| entry.0 * exit.1 <= exit.0 * entry.1)
    }

    /// Ray and box as floats, everything scaled by powers of two and zeros of one sign.
    fn floats(&self, scale: f32, dir_scale: f32, zero: f32) -> (Ray, Aabb) {
        let float = |v: [i64; 3], s: f32| Vec3::from(v.map(|x| x as f32 * s));
        let signed = |x: f32| if x == 0.0 { zero } else { x };
        let dir = float(self.dir, dir_scale).to_array().map(signed);
        let aabb = Aabb {
            min: float(self.least, scale),
            max: float(self.greatest, scale),
        };
        (Ray::new(float(self.origin, scale), dir.into()), aabb)
    }

    fn corner(&self, dice: &mut Dice, a: usize) -> i64 {
        [self.least[a], self.greatest[a]][dice.below(2) as usize]
    }
}

/// Eight boxes, all but that in `lane` of no child.
fn only(lane: usize, aabb: Aabb) -> WideCorners {
    let mut boxes: WideCorners = [[[f32::INFINITY; 8], [f32::NEG_INFINITY; 8]]; 3];
    for (axis, [least, greatest]) in boxes.iter_mut().enumerate() {
        (least[lane], greatest[lane]) = (aabb.min[axis], aabb.max[axis]);
    }
    boxes
}

/// A box among eight, and a ray among sixteen, in the lanes of an instruction set.
struct InLanes {
    ray: Ray,
    aabb: Aabb,
}

impl Task for InLanes {
    /// Whether the box is met: by the test of eight boxes; by that of sixteen rays, where the ray is plain.
    type Out = (bool, Option<bool>);

    fn run<I: Isa>(self) -> Self::Out {
        let Self { ray, aabb } = self;
        let scene = Scene::new(aabb);
        let boxes = only(3, aabb);
        let wide = WideSlabRay::new::<I::X8>(&ray, &scene);
        let (entry, exit): (I::X8, I::X8) = wide.clip(&boxes, f32::INFINITY);
        let met = entry.le(exit).bits();
        assert_eq!(met & !(1 << 3), 0, "a lane without a box was met");

        let near = ray
            .dir
            .to_array()
            .map(|d| usize::from(d.is_sign_negative()));
        let rays = SlabRays::new(&I::rays(&[ray; 16]), near, &scene);
        let (entry, exit) = rays.clip(&boxes, 3, I::Rays::splat(f32::INFINITY));
        let of_sixteen = entry.le(exit).bits() >> 5 & 1 == 1;
        (met != 0, (rays.plain >> 5 & 1 == 1).then_some(of_sixteen))
    }
}

/// What each test says of a ray and a box.
fn verdicts(ray: &Ray, aabb: Aabb) -> Vec<(String, bool)> {
    let one = SlabRay::new(ray, &aabb).interval(&corners(aabb), f32::INFINITY);
    let mut verdicts = vec![("one box".to_owned(), one.is_some())];
    for set in InstructionSet::ALL
        .into_iter()
        .filter(|set| set.is_available())
    {
        let (wide, of_sixteen) = set.run(InLanes { ray: *ray, aabb });
        verdicts.push((format!("eight boxes, {set}"), wide));
        verdicts.extend(of_sixteen.map(|met| (format!("sixteen rays, {set}"), met)));
    }
    verdicts
}

fn number(dice: &mut Dice, reach: u32) -> i64 {
    i64::from(dice.below(2 * reach + 1)) - i64::from(reach)
}

fn numbers(dice: &mut Dice, reach: u32) -> [i64; 3] {
    [0; 3].map(|_| number(dice, reach))
}

/// 200,000 boxes, some of them flat, each with a ray that `aim` has made from it.
fn never_missed(seed: u64, aim: impl Fn(&mut Dice, &mut Case)) {
    let mut dice = Dice::new(seed);
    let mut touched = 0;
    for _ in 0..200_000 {
        let (a, b) = (numbers(&mut dice, 1 << 20), numbers(&mut dice, 1 << 20));
        let flat = dice.below(16);
        let mut case = Case {
            origin: numbers(&mut dice, 1 << 21),
            dir: numbers(&mut dice, 1 << 10),
            least: [0, 1, 2].map(|i: usize| a[i].min(b[i])),
            greatest: [0, 1, 2].map(|i: usize| {
                if flat >> i & 1 == 1 {
                    a[i].min(b[i])
                } else {
                    a[i].max(b[i])
                }
            }),
        };
        aim(&mut dice, &mut case);
        if case.dir == [0; 3] {
            continue;
        }
        let scale = [1.0, 0.001_953_125, 65_536.0][dice.below(3) as usize];
        let dir_scale = [1.0, 0.001_953_125, 1024.0][dice.below(3) as usize];
        let zero = [0.0, -0.0][dice.below(2) as usize];
        let (ray, aabb) = case.floats(scale, dir_scale, zero);
        for (test, met) in verdicts(&ray, aabb) {
            if case.touches(0) {
                touched += 1;
                assert!(met, "{test}: missed {case:?}");
            } else if !case.touches(1 << 8) {
                // The pad is a few millionths of the way: a box that is missed by more is missed here too.
                assert!(!met, "{test}: phantom {case:?}");
            }
        }
    }
    assert!(touched > 1000, "only {touched} boxes were touched");
}

#[test]
fn a_ray_in_a_face_plane_touches_the_box() {
    never_missed(1, |dice, case| {
        let a = dice.below(3) as usize;
        case.dir[a] = 0;
        case.origin[a] = case.corner(dice, a);
    });
}

#[test]
fn a_ray_through_a_corner_touches_the_box() {
    never_missed(2, |dice, case| {
        let steps = i64::from(dice.below(1024));
        for a in 0..3 {
            case.origin[a] = case.corner(dice, a) - steps * case.dir[a];
        }
    });
}

#[test]
fn axis_parallel_rays_are_judged_right() {
    never_missed(3, |dice, case| {
        let a = dice.below(3) as usize;
        case.dir = [0; 3];
        case.dir[a] = number(dice, 1 << 10);
        case.origin = [0, 1, 2].map(|i| match dice.below(3) {
            0 => case.corner(dice, i),
            1 => number(dice, 1 << 21),
            _ => i64::midpoint(case.least[i], case.greatest[i]),
        });
    });
}

#[test]
fn a_nearly_axis_parallel_ray_touches_what_it_grazes() {
    never_missed(4, |dice, case| {
        let a = dice.below(3) as usize;
        case.dir = numbers(dice, 3);
        case.dir[a] = number(dice, 1 << 20);
        for i in 0..3 {
            case.origin[i] = case.corner(dice, i) - case.dir[i];
        }
    });
}

#[test]
fn any_ray_is_judged_right() {
    never_missed(5, |_, _| {});
}

/// A box and rays from one origin, in the lanes of an instruction set: whether the packet meets the box; `None` where the
/// rays are no packet.
struct Together<'a> {
    rays: &'a [Ray],
    aabb: Aabb,
}

impl Task for Together<'_> {
    type Out = Option<bool>;

    fn run<I: Isa>(self) -> Option<bool> {
        let bundle = Bundle::new::<I>(self.rays);
        let slabs = PacketSlabs::<I::X8>::new(&bundle, &self.aabb)?;
        let boxes = only(6, self.aabb);
        let (entry, exit): (I::X8, I::X8) = slabs.clip(&boxes, f32::INFINITY);
        let met = entry.le(exit).bits();
        assert_eq!(met & !(1 << 6), 0, "a lane without a box was met");
        Some(met != 0)
    }
}

/// Sixteen rays from one octant and a box among eight, in the lanes of an instruction set: whether the hull of those that are
/// plain meets the box, and which of them do.
struct Hulled<'a> {
    rays: &'a [Ray; 16],
    aabb: Aabb,
}

impl Task for Hulled<'_> {
    type Out = (bool, u32, u32);

    fn run<I: Isa>(self) -> Self::Out {
        let Self { rays, aabb } = self;
        let boxes = only(5, aabb);
        let dir = rays[0].dir.to_array();
        let near = dir.map(|d| usize::from(d.is_sign_negative()));
        let rays = SlabRays::new(&I::rays(rays), near, &Scene::new(aabb));
        let (entry, exit): (I::X8, I::X8) = rays.hull.clip(&boxes, f32::INFINITY);
        let met = entry.le(exit).bits();
        assert_eq!(met & !(1 << 5), 0, "a lane without a box was met");
        let (entry, exit) = rays.clip(&boxes, 5, I::Rays::splat(f32::INFINITY));
        (met != 0, entry.le(exit).bits(), rays.plain)
    }
}

#[test]
fn a_hull_meets_what_one_of_its_plain_rays_touches_and_misses_what_is_beside_them_all() {
    let mut dice = Dice::new(9);
    let (mut met, mut missed, mut odd) = (0, 0, 0);
    for _ in 0..20_000 {
        let (a, b) = (numbers(&mut dice, 1 << 12), numbers(&mut dice, 1 << 12));
        let lead = Case {
            origin: numbers(&mut dice, 1 << 13),
            dir: numbers(&mut dice, 1 << 10),
            least: [0, 1, 2].map(|i: usize| a[i].min(b[i])),
            greatest: [0, 1, 2].map(|i: usize| a[i].max(b[i])),
        };
        let [from, turn] = [(); 2].map(|()| [1, 16, 256][dice.below(3) as usize]);
        // Now and then one ray runs across an axis, so it is not plain.
        let across = dice.below(12) as usize;
        let cases: [Case; 16] = std::array::from_fn(|lane| {
            let (from, turn) = (numbers(&mut dice, from), numbers(&mut dice, turn));
            Case {
                origin: [0, 1, 2].map(|i: usize| lead.origin[i] + from[i]),
                // Within the octant.
                dir: [0, 1, 2].map(|i: usize| {
                    let d = (lead.dir[i] + turn[i]).abs().max(1);
                    let d = d * i64::from(lane != 7 || i != across);
                    if lead.dir[i] < 0 { -d } else { d }
                }),
                ..lead
            }
        });
        let rays = cases.each_ref().map(|case| {
            let mut ray = case.floats(1.0, 1.0, 0.0).0;
            for (axis, of) in lead.dir.into_iter().enumerate() {
                ray.dir[axis] = ray.dir[axis].copysign(if of < 0 { -1.0 } else { 1.0 });
            }
            ray
        });
        let aabb = lead.floats(1.0, 1.0, 0.0).1;
        for set in InstructionSet::ALL.into_iter().filter(|s| s.is_available()) {
            let (by_hull, by_rays, plain) = set.run(Hulled { rays: &rays, aabb });
            for (lane, case) in cases.iter().enumerate() {
                let touched = plain >> lane & 1 == 1 && case.touches(0);
                assert!(by_hull || !touched, "{set}: missed {case:?} of {cases:?}");
            }
            assert!(by_hull || by_rays & plain == 0, "{set}: {cases:?}");
            met += u32::from(by_rays & plain != 0);
            missed += u32::from(!by_hull);
            odd += u32::from(plain != 0xffff);
        }
    }
    let all = [met, missed, odd];
    assert!(all.iter().all(|count| *count > 1000), "{all:?}");
}

/// 20,000 boxes, each with the rays of a packet that `make` gives beside it: they have one origin.
fn packets_never_miss(seed: u64, make: impl Fn(&mut Dice) -> Vec<Case>) {
    let mut dice = Dice::new(seed);
    let (mut met, mut missed) = (0, 0);
    for _ in 0..20_000 {
        let mut cases = make(&mut dice);
        cases.retain(|case| case.dir != [0; 3]);
        if cases.is_empty() {
            continue;
        }
        let floats = |case: &Case| case.floats(1.0, 1.0, 0.0);
        let rays: Vec<Ray> = cases.iter().map(|case| floats(case).0).collect();
        let aabb = floats(&cases[0]).1;
        let touched = cases.iter().any(|case| case.touches(0));
        for set in InstructionSet::ALL.into_iter().filter(|s| s.is_available()) {
            let together = set.run(Together { rays: &rays, aabb });
            let together = together.expect("ordinary numbers make a packet");
            assert!(together || !touched, "{set}: missed {cases:?}");
            met += u32::from(touched);
            missed += u32::from(!together);
        }
    }
    assert!(met > 1000 && missed > 1000, "{met} met, {missed} missed");
}

/// The case for each ray of a packet: `lead` with directions that differ from its own by what `apart` gives.
fn packet(dice: &mut Dice, lead: Case, apart: impl Fn(&mut Dice) -> [i64; 3]) -> Vec<Case> {
    (0..=dice.below(20))
        .map(|_| {
            let apart = apart(dice);
            Case {
                dir: [0, 1, 2].map(|i: usize| lead.dir[i] + apart[i]),
                ..lead
            }
        })
        .collect()
}

#[test]
fn a_packet_meets_what_one_of_its_rays_touches() {
    packets_never_miss(7, |dice| {
        let (a, b) = (numbers(dice, 1 << 12), numbers(dice, 1 << 12));
        let lead = Case {
            origin: numbers(dice, 1 << 13),
            // Nearly across an axis as often as not, so that signs differ within a packet.
            dir: numbers(dice, 1 << 10).map(|d| if dice.below(2) == 0 { d } else { d >> 7 }),
            least: [0, 1, 2].map(|i: usize| a[i].min(b[i])),
            greatest: [0, 1, 2].map(|i: usize| a[i].max(b[i])),
        };
        let spread = [1, 16, 128][dice.below(3) as usize];
        packet(dice, lead, |dice| numbers(dice, spread))
    });
}

#[test]
fn a_packet_meets_what_rays_touch_that_run_in_a_face_but_for_less_than_their_cone() {
    // A component of 8 along one axis is a cone's width at 2^23 along another.
    let far = 1 << 23;
    packets_never_miss(8, |dice| {
        let [thin, long, wide] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]][dice.below(3) as usize];
        let origin = numbers(dice, 1 << 20);
        let mut lead = Case {
            origin,
            dir: numbers(dice, 1 << 21),
            least: [-far; 3],
            greatest: [far; 3],
        };
        lead.dir[thin] = number(dice, 16);
        lead.dir[long] = far;
        // A slab beside the origin, by no more than the rays drift on their way through the scene.
        lead.least[thin] = origin[thin] + number(dice, 8);
        lead.greatest[thin] = lead.least[thin] + i64::from(dice.below(4));
        lead.least[long] = number(dice, 1 << 22);
        lead.greatest[wide] = number(dice, 1 << 22);
        let mut cases = packet(dice, lead, |dice| {
            let mut apart = numbers(dice, 1 << 16);
            apart[thin] = number(dice, 4);
            apart
        });
        if dice.below(2) == 0 {
            for case in &mut cases {
                case.dir[long] = -case.dir[long];
            }
        }
        cases
    });
}

#[test]
fn the_entry_is_never_late_and_hardly_early() {
    let mut dice = Dice::new(6);
    let aabb = Aabb {
        min: Vec3::splat(-1.5),
        max: Vec3::splat(1.5),
    };
    for _ in 0..10_000 {
        let from = Vec3::new(-2.5, dice.signed(), dice.signed());
        let ray = Ray::new(from, Vec3::new(1.0, 0.1 * dice.signed(), 0.0));
        let (entry, _) = SlabRay::new(&ray, &aabb)
            .interval(&corners(aabb), f32::INFINITY)
            .expect("aimed at it");
        assert!(entry <= 1.0 && entry > 0.999_99, "{entry}");
    }
}

#[test]
fn a_negative_t_min_reaches_what_lies_behind_the_origin() {
    let aabb = Aabb {
        min: Vec3::splat(-1.0),
        max: Vec3::ONE,
    };
    let met = |ray: &Ray| {
        SlabRay::new(ray, &aabb)
            .interval(&corners(aabb), ray.t_max)
            .is_some()
    };
    for dir in [
        Vec3::X,
        Vec3::new(1.0, 1e-9, 0.3),
        Vec3::new(1.0, -0.3, -0.0),
    ] {
        let mut ray = Ray::new(Vec3::X * 3.0, dir);
        assert!(!met(&ray));
        ray.t_min = f32::NEG_INFINITY;
        assert!(met(&ray));
        ray.t_min = -2.0;
        assert!(met(&ray), "the face at t = -2 is inside the interval");
        ray.t_min = -1.9;
        assert!(!met(&ray));
    }
}

#[test]
fn numbers_at_the_ends_of_the_range_miss_nothing() {
    for scale in [1e-42, 1e-38, 1e-30, 1e-20, 1e20, 1e30, 1e38] {
        for dir_scale in [1e-42, 1e-30, 1.0, 1e30, 1e38] {
            let aabb = Aabb {
                min: Vec3::splat(-scale),
                max: Vec3::splat(scale),
            };
            let dir = Vec3::new(0.1, -0.1, -1.0) * dir_scale;
            let ray = Ray::new(Vec3::new(0.0, 0.0, 3.0 * scale), dir);
            let met = SlabRay::new(&ray, &aabb).interval(&corners(aabb), f32::INFINITY);
            assert!(met.is_some(), "scene {scale}, direction {dir_scale}");
        }
    }
}
