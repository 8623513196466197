//! Shapes of triangles: thin, flat, without area, many times the same, or nearly so.

use crate::geometry::{DVec3, Ray, Vec3};

use super::shapes::{aimed, at_insides, exact, facing, rounded, soup};
use super::{CaseEntry, ONE, RAYS, Setting};

/// A strip of triangles in zigzag between two lines that are `width` apart.
///
/// ```text
///   b0---b1---b2
///    \ / \ / \ /     width
///     a0--a1--a2
/// ```
fn strip(count: i32, length: f64, width: f64) -> Vec<[DVec3; 3]> {
    let along = DVec3::new(0.8, 0.36, 0.48) * length;
    let across = DVec3::new(-0.6, 0.48, 0.64) * width;
    let at = |i: i32| along * f64::from(i - count / 2);
    (0..count)
        .flat_map(|i| {
            let [a, b] = [at(i), at(i + 1)];
            [[a, b, a + across], [b + across, b, a + across]]
        })
        .collect()
}

pub(super) const SLIVERS: CaseEntry = CaseEntry {
    name: "slivers",
    about: "A strip of triangles that share their long edges, ever narrower.",
    group: "triangles",
    source: "tessellators and boolean operations of CAD programs",
    quantity: "width",
    rungs: &[0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6],
    params: &[],
    make: |width, dice| {
        let triangles = rounded(&strip(40, 0.05, width));
        let rays: Vec<Ray> = (0..2 * RAYS)
            .map(|i| {
                let corners = dice.of(&triangles[2..triangles.len() - 2]);
                let [_, b, c] = exact(corners);
                // The second side of every first triangle of two is shared, and not a rim of the strip.
                let target = if i % 2 == 0 {
                    dice.inside(exact(corners))
                } else {
                    b + (c - b) * (0.1 + 0.8 * dice.unit())
                };
                facing(dice, corners, target, 3.0, false)
            })
            .collect();
        Setting::new(&triangles, rays)
    },
};

pub(super) const NEEDLES: CaseEntry = CaseEntry {
    name: "needles",
    about: "Single triangles as long as the scene and ever thinner, in all directions.",
    group: "triangles",
    source: "hair, grass and wires modelled as triangles",
    quantity: "width",
    rungs: &[0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6],
    params: &[],
    make: |width, dice| {
        let needles: Vec<_> = (0..150)
            .map(|_| {
                let (start, along) = (dice.cube(), dice.cube());
                [
                    start,
                    start + along,
                    start + along * 0.5 + dice.cube() * width,
                ]
            })
            .collect();
        let triangles = rounded(&needles);
        let rays = at_insides(dice, RAYS, &triangles, 3.0, false);
        Setting::new(&triangles, rays)
    },
};

pub(super) const CAPS: CaseEntry = CaseEntry {
    name: "caps",
    about: "Triangles whose third corner lies almost on the opposite edge, ever flatter.",
    group: "triangles",
    source: "Botsch and Kobbelt 2001: needles and caps of CAD data",
    quantity: "height",
    rungs: &[0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6],
    params: &[],
    make: |height, dice| {
        let caps: Vec<_> = (0..150)
            .map(|_| {
                let (a, along) = (dice.cube(), dice.direction());
                let free = dice.direction();
                let up = free - along * free.dot(along);
                [a, a + along, a + along * dice.unit() + up * height]
            })
            .collect();
        let triangles = rounded(&caps);
        let rays = at_insides(dice, RAYS, &triangles, 3.0, false);
        Setting::new(&triangles, rays)
    },
};

pub(super) const ZERO_AREA: CaseEntry = CaseEntry {
    name: "zero-area",
    about: "A soup in which every second triangle is a line or a point: never hit, and never in the way.",
    group: "triangles",
    source: "exporters that collapse edges and keep the faces",
    quantity: "",
    rungs: ONE,
    params: &[],
    make: |_, dice| {
        let mut triangles = rounded(&soup(dice, 240, 0.3));
        for (i, [a, b, c]) in triangles.iter_mut().enumerate() {
            match i % 8 {
                0 => *c = *b,
                2 => (*b, *c) = (*a, *a),
                4 => *b = *a,
                6 => {
                    // On a raster that holds the middle too, so that all three lie on a line exactly.
                    let raster = |p: Vec3| (p * 1024.0).round() / 1024.0;
                    (*a, *b) = (raster(*a), raster(*b));
                    *c = (*a + *b) * 0.5;
                }
                _ => {}
            }
        }
        let rays = at_insides(dice, RAYS, &triangles, 3.0, false);
        Setting::new(&triangles, rays)
    },
};

pub(super) const NOTHING_TO_HIT: CaseEntry = CaseEntry {
    name: "nothing-to-hit",
    about: "No triangle at all, one point many times, or one line many times: boxes without extent.",
    group: "triangles",
    source: "empty files and collapsed groups",
    quantity: "dimensions",
    rungs: &[-1.0, 0.0, 1.0],
    params: &[],
    make: |dimensions, dice| {
        let line = [DVec3::ZERO, DVec3::X, DVec3::X * 0.5];
        let triangles = match dimensions as i32 {
            0 => vec![[DVec3::ONE; 3]; 60],
            1 => vec![line; 60],
            _ => Vec::new(),
        };
        let rays: Vec<Ray> = (0..RAYS)
            .map(|i| match i % 2 {
                0 => aimed(dice.cube() * 3.0, DVec3::ONE),
                _ => aimed(dice.cube() * 3.0, DVec3::X * dice.unit()),
            })
            .collect();
        Setting::new(&rounded(&triangles), rays)
    },
};

pub(super) const DUPLICATES: CaseEntry = CaseEntry {
    name: "duplicates",
    about: "The same triangle many times, wound both ways and begun at each corner: all are equally near.",
    group: "triangles",
    source: "meshes that were merged twice; no split parts them",
    quantity: "copies",
    rungs: &[2.0, 16.0, 128.0, 1024.0],
    params: &[],
    make: |copies, dice| {
        let [a, b, c] = [
            DVec3::new(-0.5, -0.5, 0.25),
            DVec3::new(0.5, -0.25, 0.25),
            DVec3::new(0.0, 0.5, 0.5),
        ];
        let windings = [[a, b, c], [a, c, b], [b, c, a], [c, b, a]];
        let copies: Vec<_> = windings
            .iter()
            .copied()
            .cycle()
            .take(copies as usize)
            .collect();
        let triangles = rounded(&copies);
        let rays = at_insides(dice, RAYS, &triangles, 3.0, false);
        Setting::new(&triangles, rays)
    },
};

pub(super) const COPLANAR: CaseEntry = CaseEntry {
    name: "coplanar",
    about: "Triangles that overlap in one plane, axis-parallel or tilted, with corners on a coarse raster.",
    group: "triangles",
    source: "decals and z-fighting floors",
    quantity: "tilt",
    rungs: &[0.0, 0.25],
    params: &[],
    make: |tilt, dice| {
        let mut corner = || {
            let [x, y] = [(); 2].map(|()| f64::from(dice.below(9)) * 0.25);
            DVec3::new(x, y, 0.5 + (x - 2.0 * y) * tilt)
        };
        let overlapping: Vec<_> = (0..100).map(|_| [(); 3].map(|()| corner())).collect();
        let triangles = rounded(&overlapping);
        let rays = at_insides(dice, RAYS, &triangles, 3.0, false);
        Setting::new(&triangles, rays)
    },
};

pub(super) const CLOSE_LAYERS: CaseEntry = CaseEntry {
    name: "close-layers",
    about: "Sheets one behind another, ever closer, of which the first must win.",
    group: "triangles",
    source: "paper stacks, double walls and decals",
    quantity: "distance",
    rungs: &[1e-2, 1e-3, 1e-4, 1e-5, 1e-6],
    params: &[],
    make: |distance, dice| {
        let normal = DVec3::new(0.36, 0.48, 0.8);
        let (u, v) = (DVec3::new(0.8, -0.6, 0.0), DVec3::new(0.48, 0.64, -0.6));
        let sheet = |i: i32| {
            let middle = normal * (f64::from(i) * distance);
            [
                [middle - u - v, middle + u - v, middle + v],
                [middle + u - v, middle + u + v, middle + v],
            ]
        };
        let triangles = rounded(&(0..8).flat_map(sheet).collect::<Vec<_>>());
        let rays: Vec<Ray> = (0..RAYS)
            .map(|_| {
                let target = (u * dice.signed() + v * dice.signed()) * 0.4;
                let side = if dice.below(2) == 0 { normal } else { -normal };
                aimed(target + (side + dice.direction() * 0.5) * 4.0, target)
            })
            .collect();
        Setting::new(&triangles, rays)
    },
};
