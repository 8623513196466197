//! Magnitudes: tiny, huge, subnormal, far from the origin, and very different ones in one scene.

use crate::geometry::{DVec3, Ray, Vec3};

use super::shapes::{Soup, at_insides, ball, exact, facing, pick, placed, rounded, soup};
use super::{CaseEntry, Dice, ONE, RAYS, Setting};

/// Rays at insides from `reach` away; every second direction has unit length.
fn of_both_lengths(
    dice: &mut Dice,
    triangles: &[[Vec3; 3]],
    reach: f64,
    outside: bool,
) -> Vec<Ray> {
    let mut rays = at_insides(dice, RAYS, triangles, reach, outside);
    for ray in rays.iter_mut().step_by(2) {
        let dir = ray.dir.as_dvec3();
        ray.dir = (dir / dir.length()).as_vec3();
    }
    rays
}

fn scaled_ball(scale: f64, dice: &mut Dice) -> Setting {
    let triangles = placed(&ball(5), scale, 0.0);
    let rays = of_both_lengths(dice, &triangles, 3.0 * scale, true);
    Setting::new(&triangles, rays)
}

pub(super) const SMALL_SCALES: CaseEntry = CaseEntry {
    name: "small-scales",
    about: "A ball that shrinks to the least normal numbers: products underflow, absolute tolerances swallow it.",
    group: "numbers",
    source: "scenes in kilometres; absolute epsilons on determinants",
    quantity: "scale",
    rungs: &[
        1.0, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 1e-18, 1e-20, 1e-25, 1e-30, 1e-35, 1e-37,
    ],
    params: &[],
    make: scaled_ball,
};

pub(super) const LARGE_SCALES: CaseEntry = CaseEntry {
    name: "large-scales",
    about: "A ball that grows to the greatest numbers: products overflow to infinity and NaN.",
    group: "numbers",
    source: "scenes in nanometres; sky domes",
    quantity: "scale",
    rungs: &[
        1.0, 1e3, 1e6, 1e9, 1e12, 1e15, 1e18, 1e20, 1e25, 1e30, 1e35, 1e37,
    ],
    params: &[],
    make: scaled_ball,
};

pub(super) const DENORMALS: CaseEntry = CaseEntry {
    name: "denormals",
    about: "A ball of subnormal coordinates, of which fewer and fewer bits are left.",
    group: "numbers",
    source: "flush-to-zero modes, and reciprocals that overflow",
    quantity: "scale",
    rungs: &[1e-38, 1e-39, 1e-40, 1e-41, 1e-42, 1e-43],
    params: &[],
    make: scaled_ball,
};

/// Rays at insides of a ball whose directions are `factor` times as long.
fn stretched(factor: f64, dice: &mut Dice) -> Setting {
    let triangles = rounded(&ball(5));
    let rays = of_both_lengths(dice, &triangles, 3.0, true);
    let stretch = |ray: Ray| Ray::new(ray.origin, (ray.dir.as_dvec3() * factor).as_vec3());
    Setting::new(&triangles, rays.into_iter().map(stretch))
}

pub(super) const SHORT_DIRECTIONS: CaseEntry = CaseEntry {
    name: "short-directions",
    about: "Directions far shorter than 1: t becomes huge, and determinants tiny.",
    group: "numbers",
    source: "unnormalised directions: t counts lengths of the direction",
    quantity: "length",
    rungs: &[1.0, 1e-5, 1e-10, 1e-15, 1e-20, 1e-25, 1e-30, 1e-35],
    params: &[],
    make: stretched,
};

pub(super) const LONG_DIRECTIONS: CaseEntry = CaseEntry {
    name: "long-directions",
    about: "Directions far longer than 1: t becomes tiny, and determinants huge.",
    group: "numbers",
    source: "unnormalised directions: t counts lengths of the direction",
    quantity: "length",
    rungs: &[1.0, 1e5, 1e10, 1e15, 1e20, 1e25, 1e30, 1e35, 1e37],
    params: &[],
    make: stretched,
};

pub(super) const FAR_ORIGINS: CaseEntry = CaseEntry {
    name: "far-origins",
    about: "Rays that begin ever farther from a ball at the origin.",
    group: "numbers",
    source: "orthographic cameras placed far away",
    quantity: "distance",
    rungs: &[1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7],
    params: &[],
    make: |distance, dice| {
        let triangles = rounded(&ball(5));
        let rays = of_both_lengths(dice, &triangles, distance, true);
        Setting::new(&triangles, rays)
    },
};

pub(super) const OUTLIER: CaseEntry = CaseEntry {
    name: "outlier",
    about: "A ball and one stray triangle ever farther away, which stretches the box of all.",
    group: "numbers",
    source: "stray geometry in modelled scenes; ruins uniform grids",
    quantity: "distance",
    rungs: &[1e2, 1e4, 1e6, 1e8, 1e12, 1e20],
    params: &[],
    make: |distance, dice| {
        let near = rounded(&ball(5));
        let far = DVec3::X * distance;
        let side = distance * 1e-3;
        let stray = rounded(&[[far, far + DVec3::Y * side, far + DVec3::Z * side]]);
        let mut rays = of_both_lengths(dice, &near, 3.0, true);
        // Every tenth ray aims at the stray.
        for ray in rays.iter_mut().step_by(10) {
            let target = dice.inside(exact(stray[0]));
            *ray = facing(dice, stray[0], target, distance, false);
        }
        Setting::new(&[near, stray].concat(), rays)
    },
};

pub(super) const STADIUM: CaseEntry = CaseEntry {
    name: "stadium",
    about: "A ball in the middle of an ever larger bowl: all detail in one cell, and large triangles behind it.",
    group: "numbers",
    source: "Haines 1988: the teapot in a stadium",
    quantity: "times",
    rungs: &[1.0, 1e1, 1e2, 1e3, 1e4],
    params: &[],
    make: |times, dice| {
        let near = rounded(&ball(5));
        let bowl: Soup = ball(3);
        let bowl = placed(&bowl, 4.0 * times, 0.0);
        let mut rays = of_both_lengths(dice, &near, 3.0, true);
        for ray in rays.iter_mut().step_by(4) {
            let corners = pick(dice, &bowl);
            let target = dice.inside(exact(corners));
            *ray = facing(dice, corners, target, times, false);
        }
        Setting::new(&[near, bowl].concat(), rays)
    },
};

pub(super) const GIANT: CaseEntry = CaseEntry {
    name: "giant",
    about: "Small triangles beside one that is thousands of times larger and passes through all of them.",
    group: "numbers",
    source: "ground planes; a large triangle's edge functions are sums of large numbers",
    quantity: "times",
    rungs: &[1e1, 1e2, 1e3, 1e4, 1e5, 1e6],
    params: &[],
    make: |times, dice| {
        let small = rounded(&soup(dice, 200, 0.1));
        let giant = [
            DVec3::new(-0.5, -0.4, -0.0003) * times,
            DVec3::new(0.7, -0.3, 0.0001) * times,
            DVec3::new(0.0, 0.9, 0.0002) * times,
        ];
        let giant = rounded(&[giant]);
        let mut rays = of_both_lengths(dice, &small, 3.0, false);
        for ray in rays.iter_mut().step_by(3) {
            let at = dice.cube() * DVec3::new(1.0, 1.0, 0.0);
            *ray = facing(dice, giant[0], at, 3.0, false);
        }
        Setting::new(&[small, giant].concat(), rays)
    },
};

pub(super) const ORDINARY: CaseEntry = CaseEntry {
    name: "ordinary",
    about: "A soup of triangles of ordinary size with rays across it: what nothing may fail.",
    group: "numbers",
    source: "the control of this suite",
    quantity: "",
    rungs: ONE,
    params: &[],
    make: |_, dice| {
        let triangles = rounded(&soup(dice, 300, 0.3));
        let rays = at_insides(dice, RAYS, &triangles, 3.0, false);
        Setting::new(&triangles, rays)
    },
};
