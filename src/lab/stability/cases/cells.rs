//! Cells of grids: rays along their faces and edges and through their corners, triangles on their planes.
//!
//! ```text
//!   +---+---+---+---+      the box is 8 cells wide; a small triangle in its
//!   |   |   |  /|   |      far corner keeps it so
//!   +===+===+=/=+===+ →    along a face
//!   |   |   |/  |   |
//!   +---+---o---+---+      through a corner
//! ```

use crate::geometry::{DVec3, Ray, Vec3};

use super::shapes::{aimed, at_insides, cells, exact, facing, lattice, quad, rounded, soup};
use super::{CaseEntry, Dice, ONE, RAYS, Setting};

/// Cells along each axis.
const N: u32 = 8;

/// Edge lengths of a cell: planes that `f32` holds exactly, and planes that it does not.
const SIZES: &[f64] = &[1.0, 0.7, 0.1];

/// A soup, with squares on cell planes if `squares`, in a box of [`N`] cells of this size.
fn crossed(size: f64, dice: &mut Dice, squares: bool) -> Vec<[Vec3; 3]> {
    let mut triangles = if squares {
        lattice(cells(3))
    } else {
        Vec::new()
    };
    // One triangle in each of two corners, so that the box ends there.
    let top = DVec3::splat(f64::from(N));
    triangles.extend([
        [top, top - DVec3::X, top - DVec3::Y],
        [DVec3::ZERO, DVec3::X, DVec3::Y],
    ]);
    let half = f64::from(N) * 0.5;
    let between = soup(dice, 80, 0.3)
        .into_iter()
        .map(|t| t.map(|p| (DVec3::splat(half) + p * half).clamp(DVec3::ZERO, top)));
    triangles.extend(between);
    let scaled: Vec<_> = triangles.iter().map(|t| t.map(|p| p * size)).collect();
    rounded(&scaled)
}

/// A point of the box, in cells, on the planes of `axes` axes.
fn on_planes(dice: &mut Dice, axes: u32) -> [f64; 3] {
    let mut point = [(); 3].map(|()| dice.unit() * f64::from(N));
    let first = dice.below(3);
    for k in 0..axes {
        point[((first + k) % 3) as usize] = f64::from(dice.below(N + 1));
    }
    point
}

/// The coordinates, times the size of a cell, as `f32`: those on planes are the planes, rounded.
fn place(point: [f64; 3], size: f64) -> Vec3 {
    (DVec3::from_array(point) * size).as_vec3()
}

fn along(size: f64, dice: &mut Dice, axes: u32) -> Setting {
    let triangles = crossed(size, dice, true);
    let rays: Vec<Ray> = (0..RAYS)
        .map(|_| {
            let point = on_planes(dice, axes);
            let on: Vec<usize> = (0..3).filter(|&a| point[a].fract() == 0.0).collect();
            let mut dir = (dice.direction() * size).as_vec3();
            for &axis in &on {
                dir[axis] = dice.of(&[0.0, -0.0]);
            }
            let mut origin = place(point, size) - dir * 20.0;
            for &axis in &on {
                origin[axis] = (point[axis] * size) as f32;
            }
            Ray::new(origin, dir)
        })
        .collect();
    Setting::new(&triangles, rays).at(N)
}

pub(super) const ALONG_CELL_FACES: CaseEntry = CaseEntry {
    name: "along-cell-faces",
    about: "Rays that run in the planes between cells, with a zero of either sign across them.",
    group: "cells",
    source: "0 times infinity in digital differential analysers",
    quantity: "cell",
    rungs: SIZES,
    params: &[],
    make: |size, dice| along(size, dice, 1),
};

pub(super) const ALONG_CELL_EDGES: CaseEntry = CaseEntry {
    name: "along-cell-edges",
    about: "Rays that run along the edges of cells, in four cells at once.",
    group: "cells",
    source: "ties between the crossings of two axes",
    quantity: "cell",
    rungs: SIZES,
    params: &[],
    make: |size, dice| along(size, dice, 2),
};

pub(super) const THROUGH_CELL_CORNERS: CaseEntry = CaseEntry {
    name: "through-cell-corners",
    about: "Rays from one corner of a cell to another, through all corners between them.",
    group: "cells",
    source: "ties between the crossings of three axes",
    quantity: "cell",
    rungs: SIZES,
    params: &[],
    make: |size, dice| {
        let triangles = crossed(size, dice, true);
        let rays: Vec<Ray> = (0..RAYS)
            .map(|_| {
                let (from, to) = (
                    place(on_planes(dice, 3), size),
                    place(on_planes(dice, 3), size),
                );
                let back = dice.of(&[0.0, 1.0]);
                Ray::new(from - (to - from) * back, to - from)
            })
            .collect();
        Setting::new(&triangles, rays).at(N)
    },
};

pub(super) const STARTS_ON_CELL_FACES: CaseEntry = CaseEntry {
    name: "starts-on-cell-faces",
    about: "Rays that begin on faces, edges and corners of cells, so that any of several cells could hold their start.",
    group: "cells",
    source: "truncation of a coordinate to a cell",
    quantity: "cell",
    rungs: SIZES,
    params: &[],
    make: |size, dice| {
        let triangles = crossed(size, dice, false);
        let rays: Vec<Ray> = (0..RAYS)
            .map(|i| {
                let origin = place(on_planes(dice, 1 + i % 3), size);
                Ray::new(origin, dice.direction().as_vec3())
            })
            .collect();
        Setting::new(&triangles, rays).at(N)
    },
};

pub(super) const TRIANGLES_ON_CELL_PLANES: CaseEntry = CaseEntry {
    name: "triangles-on-cell-planes",
    about: "Squares on the planes between cells of boxes of odd sizes, which no cell may lose.",
    group: "cells",
    source: "the f32 separating-axis test in centre and half-extent form loses them from both cells",
    quantity: "n",
    rungs: &[2.0, 3.0, 5.0, 7.0, 8.0, 13.0, 31.0],
    params: &[],
    make: |n, dice| {
        let low = dice.cube();
        let extent = DVec3::new(dice.unit(), dice.unit(), dice.unit()) + DVec3::splat(0.5);
        let high = (low + extent).as_vec3().as_dvec3();
        let low = low.as_vec3().as_dvec3();
        let size = (high - low) / n;
        let (u, v) = (dice.unit() * 0.2, 0.7 + dice.unit() * 0.3);
        let mut triangles = vec![[low, low, high], [high, high, low]];
        for axis in 0..3 {
            for i in 1..n as u32 {
                let corner = |s: f64, t: f64| {
                    let mut p = low;
                    p[axis] += f64::from(i) * size[axis];
                    p[(axis + 1) % 3] += s * (high - low)[(axis + 1) % 3];
                    p[(axis + 2) % 3] += t * (high - low)[(axis + 2) % 3];
                    p
                };
                triangles.extend(quad([
                    corner(u, u),
                    corner(v, u),
                    corner(v, v),
                    corner(u, v),
                ]));
            }
        }
        let triangles = rounded(&triangles);
        let rays: Vec<Ray> = (0..RAYS)
            .map(|_| {
                let corners = dice.of(&triangles[2..]);
                let target = dice.inside(exact(corners));
                // A short ray: what it starts behind cannot hide the square.
                facing(dice, corners, target, size.min_element() * 0.4, false)
            })
            .collect();
        Setting::new(&triangles, rays).at(n as u32)
    },
};

pub(super) const FLAT_SCENES: CaseEntry = CaseEntry {
    name: "flat-scenes",
    about: "All triangles in one plane, across an axis or tilted: cells and boxes without thickness.",
    group: "cells",
    source: "cells of size 0; diagonals that lie in the plane of the triangle",
    quantity: "plane",
    rungs: &[0.0, 1.0, 2.0, 3.0],
    params: &[],
    make: |plane, dice| {
        let square = |i: u32| {
            let (x, y) = (f64::from(i % 8) * 0.1, f64::from(i / 8) * 0.1);
            let corner = |dx: f64, dy: f64| match plane as u32 {
                0 => DVec3::new(0.3, x + dx, y + dy),
                1 => DVec3::new(y + dy, 0.3, x + dx),
                2 => DVec3::new(x + dx, y + dy, 0.3),
                _ => DVec3::new(x + dx, y + dy, 0.3 + 0.25 * (x + dx) - 0.5 * (y + dy)),
            };
            quad([
                corner(0.0, 0.0),
                corner(0.1, 0.0),
                corner(0.1, 0.1),
                corner(0.0, 0.1),
            ])
        };
        let triangles = rounded(&(0..64).flat_map(square).collect::<Vec<_>>());
        let rays = at_insides(dice, RAYS, &triangles, 2.0, false);
        Setting::new(&triangles, rays).at(N)
    },
};

pub(super) const DIAGONAL_NEEDLES: CaseEntry = CaseEntry {
    name: "diagonal-needles",
    about: "Thin triangles along the diagonal of the box, in nearly empty boxes of their own.",
    group: "cells",
    source: "Dammertz and Keller 2008: boxes that are almost empty",
    quantity: "",
    rungs: ONE,
    params: &[],
    make: |_, dice| {
        let needles: Vec<_> = (0..200)
            .map(|_| {
                let start = dice.cube();
                let end = start + DVec3::splat(0.8) + dice.cube() * 0.02;
                [start, end, start + dice.cube() * 1e-3]
            })
            .collect();
        let triangles = rounded(&needles);
        let rays = at_insides(dice, RAYS, &triangles, 3.0, false);
        Setting::new(&triangles, rays).at(N)
    },
};

pub(super) const FINE_CELLS: CaseEntry = CaseEntry {
    name: "fine-cells",
    about: "Specks just inside the edges of cells, hit by rays that have crossed ever more cells before.",
    group: "cells",
    source: "incremental walks that add t_delta: errors grow with each step",
    quantity: "n",
    rungs: &[4.0, 16.0, 64.0, 200.0],
    params: &[],
    make: |n, dice| {
        let top = DVec3::ONE;
        let mut triangles = vec![
            [DVec3::ZERO, DVec3::X * 1e-3, DVec3::Y * 1e-3],
            [top, top - DVec3::X * 1e-3, top - DVec3::Y * 1e-3],
        ];
        let rays: Vec<Ray> = (0..500)
            .map(|_| {
                let (speck, ray) = speck(n, dice);
                triangles.push(speck);
                ray
            })
            .collect();
        Setting::new(&rounded(&triangles), rays).at(n as u32)
    },
};

/// A speck beside an edge of a cell of the unit cube, and a ray from the cube's near side that passes through the
/// speck's cell only there.
///
/// ```text
///        |  /
///     ---+-/--      the ray is in the lower right cell for some millionths of its way:
///        |/ .        a walk that takes the crossings in the wrong order never enters it
///       /|
/// ```
fn speck(n: f64, dice: &mut Dice) -> ([DVec3; 3], Ray) {
    let first = dice.below(3) as usize;
    let (a, b, c) = (first, (first + 1) % 3, (first + 2) % 3);
    let mut along = dice.direction().abs() + DVec3::splat(0.3);
    along /= along.length();
    // Beyond one plane and before the other by little more than cells claim beyond their planes.
    let mut beyond = || (1.3 + 1.2 * dice.unit()) * 1e-6;
    let (da, db) = (beyond(), beyond());
    let mut plane = || f64::from(1 + dice.below(n as u32 - 1)) / n;
    let (pa, pb) = (plane(), plane());
    let mut at = DVec3::ZERO;
    at[a] = pa + da;
    at[b] = pb - db;
    at[c] = 0.1 + 0.8 * dice.unit();
    let (u, v) = along.any_orthonormal_pair();
    let size = 0.3e-6;
    let corners = [
        at - u * size - v * size,
        at + u * size - v * size,
        at + v * size,
    ];
    let back = at / along;
    (corners, aimed(at - along * back.min_element(), at))
}
