//! Trees: centroids that no split parts, planes on vertices, depth without end, boxes without thickness.

use crate::geometry::{DVec3, Ray, Vec3};

use super::shapes::{aimed, at_insides, cells, exact, facing, lattice, pick, quad, rounded, soup};
use super::{CaseEntry, Dice, ONE, RAYS, Setting};

pub(super) const IDENTICAL_CENTROIDS: CaseEntry = CaseEntry {
    name: "identical-centroids",
    about: "Triangles whose boxes all have one centre, which no split by centres can part.",
    group: "trees",
    source: "binned builders that assume two distinct centroids",
    quantity: "",
    rungs: ONE,
    params: &[],
    make: |_, dice| {
        let arms: Vec<_> = (0..300)
            .map(|_| {
                let arm = dice.cube();
                [arm, -arm, arm * dice.cube()]
            })
            .collect();
        let triangles = rounded(&arms);
        let rays = at_insides(dice, RAYS, &triangles, 3.0, false);
        Setting::new(&triangles, rays)
    },
};

pub(super) const SPLIT_PLANES_ON_VERTICES: CaseEntry = CaseEntry {
    name: "split-planes-on-vertices",
    about: "A raster of squares whose every vertex lies where a tree would split, and rays through these.",
    group: "trees",
    source: "kd-trees that lose triangles in the splitting plane",
    quantity: "",
    rungs: ONE,
    params: &[],
    make: |_, dice| {
        let triangles = rounded(&lattice(cells(4)));
        let rays: Vec<Ray> = (0..2 * RAYS)
            .map(|i| {
                let target = if i % 2 == 0 {
                    // A vertex with squares on all its sides.
                    Vec3::from([(); 3].map(|()| (1 + dice.below(3)) as f32))
                } else {
                    let corners = pick(dice, &triangles);
                    dice.inside(exact(corners)).as_vec3()
                };
                if dice.below(2) == 0 {
                    let along = dice.axis();
                    return Ray::new(target - along * 8.0, along);
                }
                aimed(
                    target.as_dvec3() + dice.direction() * 6.0,
                    target.as_dvec3(),
                )
            })
            .collect();
        Setting::new(&triangles, rays)
    },
};

pub(super) const DEPTH_BOMB: CaseEntry = CaseEntry {
    name: "depth-bomb",
    about: "Triangles that halve in size towards a corner, down to subnormal ones: each split peels off one.",
    group: "trees",
    source: "stacks deeper than their array",
    quantity: "halvings",
    rungs: &[24.0, 60.0, 100.0, 120.0, 149.0],
    params: &[],
    make: |halvings, dice| {
        let mut size = 1.0_f64;
        let halved: Vec<_> = (0..halvings as u32)
            .flat_map(|_| {
                let x = DVec3::X * size;
                let near = [x, x + DVec3::Y * size, x + DVec3::Z * size];
                size *= 0.5;
                [near, near.map(|p| p * 1.25)]
            })
            .collect();
        let triangles = rounded(&halved);
        let rays: Vec<Ray> = (0..RAYS)
            .map(|_| {
                let corners = pick(dice, &triangles);
                let target = dice.inside(exact(corners));
                facing(dice, corners, target, exact(corners)[0].x * 3.0, false)
            })
            .collect();
        Setting::new(&triangles, rays)
    },
};

pub(super) const NESTED_BOXES: CaseEntry = CaseEntry {
    name: "nested-boxes",
    about: "Boxes within boxes, whose faces have centroids in pairs and whose edges lie on one diagonal.",
    group: "trees",
    source: "builders that must fall back where all bins but one are empty",
    quantity: "",
    rungs: ONE,
    params: &[],
    make: |_, dice| {
        let nested = (1..=40).flat_map(|k| cuboid(DVec3::splat(f64::from(k) * 0.05)));
        let triangles = rounded(&nested.collect::<Vec<_>>());
        let rays = at_insides(dice, RAYS, &triangles, 5.0, false);
        Setting::new(&triangles, rays)
    },
};

/// The box from `-half` to `half`: 12 triangles.
fn cuboid(half: DVec3) -> Vec<[DVec3; 3]> {
    let at = |x: f64, y: f64, z: f64| half * DVec3::new(x, y, z);
    let side = |turn: usize, sign: f64| {
        let corner = |u: f64, v: f64| {
            let mut p = [sign, u, v];
            p.rotate_right(turn);
            at(p[0], p[1], p[2])
        };
        quad([
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ])
    };
    (0..3)
        .flat_map(|turn| [side(turn, 1.0), side(turn, -1.0)].concat())
        .collect()
}

/// Triangles across unit cubes with corners of whole numbers: each has the cube as its box.
///
/// ```text
///      .------2
///     /|     /|      0, 1 and 2 are corners of the box; the ray in the face
///    1------' |      z = 1 through the edge from 1 to 2 runs in the face of the box
///    | '----|-'
///    0------'
/// ```
fn across_cubes(dice: &mut Dice) -> Vec<[DVec3; 3]> {
    let corner = |i: u32| DVec3::from_array([0, 1, 2].map(|a| f64::from(i >> a & 1)));
    (0..100)
        .map(|_| {
            let cube = [(); 3].map(|()| f64::from(dice.below(12)) - 6.0);
            let at = DVec3::from_array(cube);
            // Three corners of the cube of which no two share an edge.
            let corners = dice.of(&[
                [0, 3, 5],
                [0, 3, 6],
                [0, 5, 6],
                [3, 5, 6],
                [1, 2, 4],
                [1, 2, 7],
            ]);
            corners.map(|i| at + corner(i))
        })
        .collect()
}

pub(super) const FLAT_BOXES: CaseEntry = CaseEntry {
    name: "flat-boxes",
    about: "Rays that run in a face of the box of the triangle that they meet, with a zero across it.",
    group: "trees",
    source: "Ize 2013: 0 times infinity in the slab test",
    quantity: "",
    rungs: ONE,
    params: &[],
    make: |_, dice| {
        let triangles = across_cubes(dice);
        let rays: Vec<Ray> = (0..RAYS)
            .map(|_| {
                let corners = dice.of(&triangles);
                let first = dice.below(3) as usize;
                let (a, b) = (corners[first], corners[(first + 1) % 3]);
                // The edge lies in a face across the axis that its ends share.
                let axis = (0..3).find(|&i| a[i] == b[i]).unwrap_or(0);
                let target = a + (b - a) * dice.of(&[0.0, 0.25, 0.5, 0.75, 1.0]);
                // Small whole numbers: the ray meets the edge exactly.
                let mut dir = [(); 3].map(|()| f64::from(dice.below(15)) - 7.0);
                dir[axis] = dice.of(&[0.0, -0.0]);
                let dir = DVec3::from_array(dir);
                Ray::new((target - dir * 4.0).as_vec3(), dir.as_vec3())
            })
            .collect();
        Setting::new(&rounded(&triangles), rays)
    },
};

pub(super) const BOX_CORNERS: CaseEntry = CaseEntry {
    name: "box-corners",
    about: "Rays that touch the box of a triangle in one corner only, where the triangle has a vertex.",
    group: "trees",
    source: "Ize 2013: roundings that part the entry from the exit",
    quantity: "",
    rungs: ONE,
    params: &[],
    make: |_, dice| {
        let triangles = across_cubes(dice);
        let rays: Vec<Ray> = (0..RAYS)
            .map(|_| {
                let [a, b, c] = dice.of(&triangles);
                let target = dice.of(&[a, b, c]);
                let centre = (a.min(b).min(c) + a.max(b).max(c)) * 0.5;
                let out = (target - centre) * 2.0;
                // Whole numbers, of which one points out of the box and another into it.
                let mut dir =
                    DVec3::from_array([(); 3].map(|()| f64::from(dice.below(60)) + 1.0)) * out;
                dir[dice.below(3) as usize] *= -1.0;
                Ray::new((target - dir * 2.0).as_vec3(), dir.as_vec3())
            })
            .collect();
        Setting::new(&rounded(&triangles), rays)
    },
};

pub(super) const OVERLAP: CaseEntry = CaseEntry {
    name: "overlap",
    about: "Triangles as large as the scene: every box overlaps every other, and every cell lists them all.",
    group: "trees",
    source: "the worst case of every structure",
    quantity: "",
    rungs: ONE,
    params: &[],
    make: |_, dice| {
        let triangles = rounded(&soup(dice, 200, 2.0));
        let rays = at_insides(dice, RAYS, &triangles, 4.0, false);
        Setting::new(&triangles, rays)
    },
};
