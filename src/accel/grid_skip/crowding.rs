//! How crowded the cells of a grid are where rays end: what `n` must be on a mesh whose triangles crowd in few places.
//!
//! ```text
//!   +-------+-------+      mean of the triangles in the cell of a point, over all points of the surface. In a mesh whose
//!   | ····  |       |      triangles are spread over one surface it goes with 1 / n² and is small at the density that suits
//!   | ····  |       |      most; one that repeats itself on many scales has most of its surface in crowded cells
//!   +-------+-------+
//! ```
//!
//! A triangle counts in the cell of its centroid: cells of interest are larger than triangles.

use rayon::prelude::*;

use crate::geometry::{DVec3, Vec3};
use crate::scene::Mesh;

use super::super::parallel::{self, MANY};

/// Triangles in a cell, in the mean over the surface, that are too many: two blocks of eight. Up to there finer cells gain
/// nothing that can be measured and take memory: of the armadillo, which has 15 at the density that suits most, cells 1.2
/// times as fine are 3 % faster, cells 1.7 times as fine 8 % slower for bounce rays, which leave the caches.
const CROWD: f64 = 16.0;

/// Triangles in a cell, in the mean over the surface, that are few enough where there were too many. `sphereflake:4`, which
/// has 26 at n = 231, gets n = 414: with n = 300 primary rays are a tenth slower and bounce rays as much faster, from 414 to
/// 519 both are alike within noise, since cells that are crowded have boxes (see `crowded`).
const FEW: f64 = 8.0;

/// How much n may rise between two looks.
const STEP: f64 = 2.0;

/// The least power of n with which the mean must fall: where triangles cover each other, finer cells do not part them.
const LEAST_POWER: f64 = 0.8;

/// The least number of cells a triangle, from that of `first` cells along each axis on, that leaves few triangles in a cell;
/// fewer where more are in vain or n would be greater than `largest`.
///
/// `dims` gives the cells along each axis at n.
pub(super) fn density(
    mesh: &Mesh,
    first: u32,
    largest: u32,
    dims: &dyn Fn(u32) -> [u32; 3],
) -> f64 {
    let mut n = first;
    let mut crowded = mean(mesh, dims(n));
    let few = if crowded > CROWD { FEW } else { CROWD };
    while crowded > few && n < largest {
        let rise = (crowded / few).sqrt().min(STEP);
        let finer = ((f64::from(n) * rise).ceil() as u32).min(largest);
        let then = mean(mesh, dims(finer));
        let rise = f64::from(finer) / f64::from(n);
        if then > crowded * rise.powf(-LEAST_POWER) {
            break;
        }
        (n, crowded) = (finer, then);
    }
    let cells: f64 = dims(n).iter().map(|&n| f64::from(n)).product();
    cells / (mesh.len().max(1) as f64)
}

/// Triangles in the cell of a point, in the mean over all points of the surface; 0 where there is none.
fn mean(mesh: &Mesh, dims: [u32; 3]) -> f64 {
    let bounds = mesh.bounds();
    let extent = (bounds.max - bounds.min).as_dvec3();
    let cells = DVec3::from_array(dims.map(f64::from));
    let corners = |prim: u32| mesh.corners(prim).map(Vec3::as_dvec3);
    let mut keys = parallel::map(mesh.len(), MANY, |i| {
        let prim = i as u32;
        let [a, b, c] = corners(prim);
        let at = ((a + b + c) / 3.0 - bounds.min.as_dvec3()) / extent * cells;
        // The cast takes NaN, on axes without extent, for 0.
        let cell: [u32; 3] = std::array::from_fn(|a| (at[a] as u32).min(dims[a] - 1));
        ((cell[2] * dims[1] + cell[1]) * dims[0] + cell[0], prim)
    });
    keys.par_sort_unstable();
    let (mut area, mut weighted) = (0.0, 0.0);
    for cell in keys.chunk_by(|a, b| a.0 == b.0) {
        let part: f64 = cell
            .iter()
            .map(|&(_, prim)| {
                let [a, b, c] = corners(prim);
                (b - a).cross(c - a).length()
            })
            .sum();
        area += part;
        weighted += part * cell.len() as f64;
    }
    if area > 0.0 { weighted / area } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::super::testbed::{mesh, sphere};
    use super::*;

    fn cubic(n: u32) -> [u32; 3] {
        [n; 3]
    }

    #[test]
    fn the_mean_is_taken_over_the_surface() {
        // Three small triangles share the cell at one end, one of nine times their area all together lies at the other.
        let tiny = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let large = tiny.map(|p| p * 27_f32.sqrt() + 90.0);
        let mesh = mesh(&[tiny, tiny, tiny, large]);
        let right = (3.0 * 3.0 + 27.0) / 30.0;
        assert!((mean(&mesh, cubic(2)) - right).abs() < 1e-6);
        assert!((mean(&mesh, cubic(1)) - 4.0).abs() < 1e-6);
    }

    #[test]
    fn n_rises_until_cells_hold_few_and_not_where_that_is_in_vain() {
        let sphere = sphere(64);
        let of = |mesh: &Mesh, first: u32, largest: u32| density(mesh, first, largest, &cubic);
        let at = |n: f64, mesh: &Mesh| n * n * n / mesh.len() as f64;
        let found = of(&mesh(&sphere), 4, 1024);
        let n = (found * sphere.len() as f64).cbrt().round();
        assert!(mean(&mesh(&sphere), cubic(n as u32)) <= FEW, "{n}");
        assert!(mean(&mesh(&sphere), cubic(n as u32 / 2)) > FEW, "{n}");
        // Two blocks a cell are no crowd.
        let even = (4..100).find(|&n| mean(&mesh(&sphere), cubic(n)) < CROWD);
        let even = even.unwrap();
        let same = at(f64::from(even), &mesh(&sphere));
        assert_eq!(of(&mesh(&sphere), even, 1024), same);
        assert_eq!(of(&mesh(&sphere), 4, 6), at(6.0, &mesh(&sphere)));
        // A hundred of the same stay together however fine the grid.
        let twins = mesh(&[[Vec3::ZERO, Vec3::X, Vec3::Y]].repeat(100));
        assert_eq!(of(&twins, 4, 1024), at(4.0, &twins));
        assert_eq!(of(&mesh(&[]), 1, 1024), 1.0);
    }
}
