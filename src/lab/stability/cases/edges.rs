//! Edges and vertices that triangles share: where rays slip between them.
//!
//! ```text
//!     .--+--.        rays from inside a closed mesh: whatever a ray meets,
//!   +     o--->+     it must meet something, so every miss is a leak
//!     '--+--'
//! ```

use crate::geometry::{DVec3, Ray, Vec3};

use super::shapes::{aimed, ball, exact, on_edge, pick, placed, rounded};
use super::{CaseEntry, Dice, ONE, RAYS, Setting};

/// Offsets of a ball of radius 16: at the last, neighbouring `f32` are 1 apart.
const OFFSETS: &[f64] = &[0.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7];

/// Of the ball.
const RADIUS: f64 = 16.0;

/// Rays from inside a moved ball at what `target` gives of one of its triangles.
fn inside_ball(
    offset: f64,
    dice: &mut Dice,
    target: impl Fn(&mut Dice, [Vec3; 3]) -> DVec3,
) -> Setting {
    let triangles = placed(&ball(6), RADIUS, offset);
    let rays: Vec<Ray> = (0..2 * RAYS)
        .map(|_| {
            let corners = pick(dice, &triangles);
            let from = dice.cube() * (0.4 * RADIUS) + DVec3::splat(offset);
            aimed(from, target(dice, corners))
        })
        .collect();
    Setting::new(&triangles, rays)
}

pub(super) const CLOSED_EDGES: CaseEntry = CaseEntry {
    name: "closed-edges",
    about: "Rays from inside a closed ball at its edges, moved from the origin: a miss is a leak.",
    group: "edges",
    source: "Woop, Benthin and Wald 2013",
    quantity: "offset",
    rungs: OFFSETS,
    params: &[],
    make: |offset, dice| inside_ball(offset, dice, on_edge),
};

pub(super) const CLOSED_VERTICES: CaseEntry = CaseEntry {
    name: "closed-vertices",
    about: "Rays from inside a closed ball at its vertices, moved from the origin: a miss is a leak.",
    group: "edges",
    source: "Woop, Benthin and Wald 2013",
    quantity: "offset",
    rungs: OFFSETS,
    params: &[],
    make: |offset, dice| inside_ball(offset, dice, |dice, corners| dice.of(&corners).as_dvec3()),
};

pub(super) const CLOSED_FACES: CaseEntry = CaseEntry {
    name: "closed-faces",
    about: "Rays from inside a closed ball at the insides of its triangles, moved from the origin.",
    group: "edges",
    source: "plane forms, whose d - n·o cancels far from the origin",
    quantity: "offset",
    rungs: OFFSETS,
    params: &[],
    make: |offset, dice| inside_ball(offset, dice, |dice, corners| dice.inside(exact(corners))),
};

pub(super) const SILHOUETTES: CaseEntry = CaseEntry {
    name: "silhouettes",
    about: "Rays that touch a ball at edges and vertices of its outline, where the mesh ends as the ray sees it.",
    group: "edges",
    source: "the promise of watertight tests ends here",
    quantity: "",
    rungs: ONE,
    params: &[],
    make: |_, dice| {
        let triangles = rounded(&ball(6));
        let rays: Vec<Ray> = (0..2 * RAYS)
            .map(|i| {
                let corners = pick(dice, &triangles);
                let target = if i % 4 == 0 {
                    dice.of(&corners).as_dvec3()
                } else {
                    on_edge(dice, corners)
                };
                // Tangential to the sphere.
                let free = dice.direction();
                let out = target / target.length();
                aimed(target + (free - out * free.dot(out)) * 3.0, target)
            })
            .collect();
        Setting::new(&triangles, rays)
    },
};

pub(super) const FAN: CaseEntry = CaseEntry {
    name: "fan",
    about: "A hub where hundreds of triangles meet, and the spokes around it: as from inside a tent, no ray escapes.",
    group: "edges",
    source: "poles of spheres and tips of cones in modelled meshes",
    quantity: "valence",
    rungs: &[8.0, 32.0, 128.0, 512.0],
    params: &[],
    make: |valence, dice| {
        let count = valence as u32;
        let rim: Vec<DVec3> = (0..count).map(|i| rim(i, count)).collect();
        let hub = DVec3::new(0.1, -0.2, 0.3);
        let spokes = (0..rim.len()).map(|i| [hub, rim[i], rim[(i + 1) % rim.len()]]);
        let triangles = rounded(&spokes.collect::<Vec<_>>());
        let rays: Vec<Ray> = (0..2 * RAYS)
            .map(|i| {
                let [hub, at, _] = exact(pick(dice, &triangles));
                let target = if i % 2 == 0 {
                    hub
                } else {
                    hub + (at - hub) * (0.9 * dice.unit())
                };
                aimed(target + DVec3::Z * 3.0 + dice.cube(), target)
            })
            .collect();
        Setting::new(&triangles, rays)
    },
};

/// A point of the unit circle, by the rational parametrisation of its quarters; the points are not evenly spaced.
fn rim(i: u32, count: u32) -> DVec3 {
    let quarter = count / 4;
    let s = f64::from(i % quarter) / f64::from(quarter);
    let (x, y) = ((1.0 - s * s) / (1.0 + s * s), 2.0 * s / (1.0 + s * s));
    let (x, y) = match i / quarter {
        0 => (x, y),
        1 => (-y, x),
        2 => (-x, -y),
        _ => (y, -x),
    };
    DVec3::new(x, y, if i.is_multiple_of(2) { 0.05 } else { -0.05 })
}
