//! `teapot:N`: Newell's teapot, every Bézier patch cut into N×N quadrilaterals.
//!
//! **Source:** Martin Newell, 1975: 28 patches, and 4 added later for the bottom. Heights are those of the pot on
//! Newell's screen, as everyone knows it: three quarters of the clay pot's.
//!
//! **Differs:** triangles that collapse at the poles of lid and bottom are dropped, points that patches share are
//! shared bit for bit (the Bézier sum is symmetric under reversal), and all normals point outwards.

use std::collections::HashMap;

use super::{Draft, draft::matte};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Camera, Scene, SceneEntry, SceneError, Sizes};

const PATCHES: &str = include_str!("../../../scenes/teapot_patches.txt");

/// The family's row.
pub const ROW: SceneEntry = SceneEntry {
    name: "teapot",
    about: "Newell's teapot, a curved mesh with an open rim and spout, good for a first look and for shading.",
    size: "N",
    params: &[ParamSpec {
        name: "N",
        about: "Quadrilaterals along each side of a patch.",
        kind: ParamKind::Int { min: 1, max: 550 },
        default: "16",
    }],
    example: "teapot:4",
    blind: false,
    triangles: |sizes| triangles(u64::from(sizes.int(0))),
    build,
};

/// 32 patches of 2n² triangles, less those of one side of each of the eight patches around the two poles.
fn triangles(n: u64) -> u64 {
    64 * n * n - 8 * n
}

fn build(sizes: &Sizes) -> Result<Scene, SceneError> {
    let mut draft = Draft::new(Vec3::Z);
    let (points, triangles) = pot(sizes.int(0));
    draft.vertices = points.iter().map(|p| p.as_vec3()).collect();
    draft.triangles = triangles;
    draft.paint(glaze());
    draft.camera = Some(Camera {
        eye: Vec3::new(3.6, -8.6, 5.2),
        at: Vec3::new(0.1, 0.0, 1.45),
        up: Vec3::Z,
        fov_deg: 34.0,
    });
    draft.finish()
}

/// The teapot's own colour.
pub(super) fn glaze() -> crate::scene::Material {
    matte("glaze", 0.72, 0.42, 0.26)
}

/// Points (distinct, bit for bit) and triangles of the pot: z up, base in z = 0, 6.43 long, 3.15 high.
pub(super) fn pot(n: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (patches, control) = patches();
    let mut points = Vec::new();
    let mut index_of = HashMap::new();
    let mut triangles = Vec::with_capacity(triangles_of(n));
    for patch in patches {
        let net = patch.map(|i| control[i]);
        let mut grid = Vec::with_capacity((n as usize + 1).pow(2));
        for row in 0..=n {
            for column in 0..=n {
                let point = point(&net, weights(row, n), weights(column, n));
                let index = *index_of
                    .entry(point.to_array().map(f64::to_bits))
                    .or_insert_with(|| {
                        points.push(point);
                        points.len() as u32 - 1
                    });
                grid.push(index);
            }
        }
        let at = |row: u32, column: u32| grid[(row * (n + 1) + column) as usize];
        for row in 0..n {
            for column in 0..n {
                let [a, b] = [at(row, column), at(row, column + 1)];
                let [d, c] = [at(row + 1, column), at(row + 1, column + 1)];
                for t in [[a, b, c], [a, c, d]] {
                    if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
                        triangles.push(t);
                    }
                }
            }
        }
    }
    (points, triangles)
}

/// The pot at length 1, standing on z = 0, its box centred about the z axis.
pub(super) fn unit_pot(n: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (mut points, triangles) = pot(n);
    let least = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let most = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let middle = ((least + most) * 0.5).with_z(least.z);
    for point in &mut points {
        *point = (*point - middle) / (most.x - least.x) + DVec3::ZERO;
    }
    (points, triangles)
}

fn triangles_of(n: u32) -> usize {
    triangles(u64::from(n)) as usize
}

/// Control point indices of each patch, four rows of four, and the control points.
fn patches() -> (Vec<[usize; 16]>, Vec<DVec3>) {
    let mut patches = Vec::new();
    let mut points = Vec::new();
    for line in PATCHES.lines().filter(|l| !l.starts_with('#')) {
        let numbers: Vec<f64> = line.split(' ').filter_map(|w| w.parse().ok()).collect();
        match numbers[..] {
            [x, y, z] => points.push(DVec3::new(x, y, z)),
            _ => patches.extend(<[f64; 16]>::try_from(numbers).map(|p| p.map(|i| i as usize))),
        }
    }
    (patches, points)
}

/// The four Bernstein polynomials at i/n. Those of (n − i)/n are these in reverse, bit for bit.
fn weights(i: u32, n: u32) -> [f64; 4] {
    let (t, s) = (f64::from(i) / f64::from(n), f64::from(n - i) / f64::from(n));
    [s * s * s, 3.0 * (s * s * t), 3.0 * (t * t * s), t * t * t]
}

/// The patch's point for the given weights of rows and columns. −0 becomes +0, so that equal points have equal bits.
fn point(net: &[DVec3; 16], rows: [f64; 4], columns: [f64; 4]) -> DVec3 {
    // Paired from the ends inwards, so that the sum is the same from either end: patches that share a border run
    // along it in either direction.
    let mix = |p: [DVec3; 4], w: [f64; 4]| {
        if p == [p[0]; 4] {
            // A pole: rounding must not spread it over a circle.
            return p[0];
        }
        (p[0] * w[0] + p[3] * w[3]) + (p[1] * w[1] + p[2] * w[2])
    };
    let row = |r: usize| {
        mix(
            [net[4 * r], net[4 * r + 1], net[4 * r + 2], net[4 * r + 3]],
            columns,
        )
    };
    mix([row(0), row(1), row(2), row(3)], rows) + DVec3::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pot_of_n_has_64_n_squared_less_8_n_triangles() {
        for n in [1, 2, 3, 7, 16] {
            let expected = 64 * n as usize * n as usize - 8 * n as usize;
            assert_eq!(pot(n).1.len(), expected, "{n}");
        }
    }

    #[test]
    fn neighbouring_patches_share_their_border_and_face_the_same_way() {
        let (_, triangles) = pot(5);
        let mut edges = HashMap::new();
        for t in &triangles {
            for i in 0..3 {
                *edges.entry((t[i], t[(i + 1) % 3])).or_insert(0) += 1;
            }
        }
        assert!(
            edges.values().all(|&uses| uses == 1),
            "an edge is used twice in one direction"
        );
        let open = edges
            .keys()
            .filter(|&&(a, b)| !edges.contains_key(&(b, a)))
            .count();
        // Open are the rim and the lid's edge, of four patches each, and both ends of handle and spout, of two each.
        assert_eq!(open, (4 + 4 + 2 * 2 + 2 * 2) * 5);
    }

    #[test]
    fn normals_of_the_body_point_away_from_the_axis() {
        let (points, triangles) = pot(8);
        let mut checked = 0;
        for t in triangles {
            let [a, b, c] = t.map(|i| points[i as usize]);
            let (normal, middle) = ((b - a).cross(c - a), (a + b + c) / 3.0);
            // The belly: far from the axis's ends, nearer than handle and spout.
            if (0.5..2.0).contains(&middle.z)
                && middle.truncate().length() > 1.5
                && middle.truncate().length() < 2.01
                && middle.y.abs() > 0.8
            {
                assert!(normal.truncate().dot(middle.truncate()) > 0.0);
                checked += 1;
            }
        }
        assert!(checked > 100, "{checked}");
    }
}
