//! Rays: in planes, grazing, on surfaces, with zeros of either sign, with intervals that end in a hit.

use crate::geometry::{DVec3, Ray, Vec3};

use super::shapes::{aimed, ball, cells, exact, lattice, pick, placed, rounded, soup};
use super::{CaseEntry, Dice, ONE, RAYS, Setting};

/// A corner of whole numbers, multiples of `step`.
fn whole(dice: &mut Dice, step: i32) -> DVec3 {
    let mut number = || f64::from((dice.below(9) as i32 - 4) * step);
    DVec3::new(number(), number(), number())
}

/// Triangles with corners of whole numbers, multiples of 4, and the sides from their first corner in fourths.
fn whole_triangles(dice: &mut Dice) -> Vec<[DVec3; 3]> {
    (0..150)
        .map(|_| [whole(dice, 4), whole(dice, 4), whole(dice, 4)])
        .collect()
}

pub(super) const IN_PLANE: CaseEntry = CaseEntry {
    name: "in-plane",
    about: "Rays that run exactly in the plane of a triangle, across it: a miss by definition; what else they meet counts.",
    group: "rays",
    source: "determinants that should be 0 and are a rounding error",
    quantity: "",
    rungs: ONE,
    params: &[],
    make: |_, dice| {
        let triangles = whole_triangles(dice);
        let rays: Vec<Ray> = (0..RAYS)
            .map(|_| {
                // All of these numbers are small and whole, so nothing is rounded.
                let [a, b, c] = dice.of(&triangles);
                let (u, v) = ((b - a) * 0.25, (c - a) * 0.25);
                let mut steps = |from: i32, to: u32| f64::from(from + dice.below(to) as i32);
                let dir = u * steps(-3, 7) + v * steps(-3, 7);
                let at = a + u * steps(0, 3) + v * steps(0, 3);
                Ray::new((at - dir * 8.0).as_vec3(), dir.as_vec3())
            })
            .collect();
        Setting::new(&rounded(&triangles), rays)
    },
};

pub(super) const GRAZING: CaseEntry = CaseEntry {
    name: "grazing",
    about: "Rays that meet triangles at ever flatter slopes: t and the edges are hardest to tell.",
    group: "rays",
    source: "terrains and floors seen along the ground",
    quantity: "slope",
    rungs: &[1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6],
    params: &[],
    make: |slope, dice| {
        let triangles = rounded(&soup(dice, 200, 0.5));
        let rays: Vec<Ray> = (0..RAYS)
            .map(|_| {
                let corners = exact(pick(dice, &triangles));
                let [a, b, c] = corners;
                let normal = (b - a).cross(c - a);
                let normal = normal / normal.length();
                let free = dice.direction();
                let along = free - normal * free.dot(normal);
                let away = along / along.length() + normal * (slope * dice.of(&[1.0, -1.0]));
                let target = dice.inside(corners);
                aimed(target + away * 3.0, target)
            })
            .collect();
        Setting::new(&triangles, rays)
    },
};

pub(super) const STARTS_ON_SURFACES: CaseEntry = CaseEntry {
    name: "starts-on-surfaces",
    about: "Rays that begin exactly on a triangle, at its inside, edge or corner: a hit at t = 0.",
    group: "rays",
    source: "closed intervals of t; naive secondary rays",
    quantity: "",
    rungs: ONE,
    params: &[],
    make: |_, dice| {
        let triangles = whole_triangles(dice);
        let rays: Vec<Ray> = (0..RAYS)
            .map(|_| {
                let [a, b, c] = dice.of(&triangles);
                let i = dice.below(5);
                let j = dice.below(5 - i);
                let at = a + (b - a) * (0.25 * f64::from(i)) + (c - a) * (0.25 * f64::from(j));
                Ray::new(at.as_vec3(), dice.direction().as_vec3())
            })
            .collect();
        Setting::new(&rounded(&triangles), rays)
    },
};

pub(super) const STARTS_BESIDE_SURFACES: CaseEntry = CaseEntry {
    name: "starts-beside-surfaces",
    about: "Rays that begin within rounding of a triangle of a moved ball, on one side or the other.",
    group: "rays",
    source: "Wächter and Binder 2019: self-intersection of secondary rays",
    quantity: "offset",
    rungs: &[0.0, 1e2, 1e3, 1e4, 1e5, 1e6],
    params: &[],
    make: |offset, dice| {
        let triangles = placed(&ball(6), 16.0, offset);
        let rays: Vec<Ray> = (0..RAYS)
            .map(|_| {
                let corners = pick(dice, &triangles);
                let at = dice.inside(exact(corners)).as_vec3();
                Ray::new(at, dice.direction().as_vec3())
            })
            .collect();
        Setting::new(&triangles, rays)
    },
};

pub(super) const SIGNED_ZEROS: CaseEntry = CaseEntry {
    name: "signed-zeros",
    about: "Axis-parallel rays, whose other components are zeros of either sign, at balls and squares.",
    group: "rays",
    source: "-0.0 in the octant of a direction; 1/-0 is minus infinity",
    quantity: "",
    rungs: ONE,
    params: &[],
    make: |_, dice| {
        let squares = lattice(cells(3));
        let squares: Vec<_> = squares
            .iter()
            .map(|t| t.map(|p| p * 0.5 - DVec3::splat(0.75)))
            .collect();
        let triangles = rounded(&[ball(4), squares].concat());
        let rays: Vec<Ray> = (0..RAYS)
            .map(|i| {
                let along = dice.axis();
                let corners = pick(dice, &triangles);
                let at = match i % 3 {
                    0 => dice.of(&corners),
                    1 => dice.inside(exact(corners)).as_vec3(),
                    _ => dice.cube().as_vec3(),
                };
                // From outside along the axis; the other coordinates stay as they are, bit for bit.
                let origin = Vec3::select(along.cmpeq(Vec3::ZERO), at, along * -4.0);
                Ray::new(origin, along)
            })
            .collect();
        Setting::new(&triangles, rays)
    },
};

pub(super) const INTERVALS: CaseEntry = CaseEntry {
    name: "intervals",
    about: "Intervals of t that begin or end exactly in a hit, one bit before or behind it, and intervals behind the origin.",
    group: "rays",
    source: "shadow rays that end on their light",
    quantity: "",
    rungs: ONE,
    params: &[],
    make: |_, dice| {
        let triangles = rounded(&lattice(cells(3)));
        let rays: Vec<Ray> = (0..RAYS).map(|i| interval(dice, i)).collect();
        Setting::new(&triangles, rays)
    },
};

/// A ray that meets a plane of whole numbers at a t that `f32` holds exactly, with an interval around it.
fn interval(dice: &mut Dice, i: u32) -> Ray {
    let axis = dice.below(3) as usize;
    let mut eighths = || f64::from(dice.below(24)) * 0.125 + 0.0625;
    let mut at = DVec3::new(eighths(), eighths(), eighths());
    at[axis] = f64::from(dice.below(4));
    let mut component = || dice.of(&[0.25, 0.5, -0.25, -0.5, 1.0, -1.0]);
    let dir = DVec3::new(component(), component(), component());
    let t = dice.of(&[0.5, 1.0, 2.0]);
    let mut ray = Ray::new((at - dir * t).as_vec3(), dir.as_vec3());
    let t = t as f32;
    match i % 8 {
        0 => ray.t_max = t,
        1 => ray.t_max = t.next_down(),
        2 => ray.t_min = t,
        3 => ray.t_min = t.next_up(),
        4 => (ray.t_min, ray.t_max) = (t, t),
        5 => (ray.t_min, ray.t_max) = (f32::NEG_INFINITY, -t),
        6 => ray.t_min = -4.0,
        _ => (ray.t_min, ray.t_max) = (t, 0.5 * t),
    }
    ray
}
