//! Meshes and aimed rays that several cases share.

use crate::geometry::{DVec3, Ray, Vec3};

use super::dice::Dice;

/// Corners of triangles before they are rounded to `f32`.
pub(super) type Soup = Vec<[DVec3; 3]>;

/// A closed ball around the origin with radius 1: an octahedron whose faces are cut into n² parts and pushed outwards.
/// 8·n² triangles; corners that are shared are equal bit for bit.
pub(super) fn ball(n: u32) -> Soup {
    let mut triangles = Vec::with_capacity(8 * (n * n) as usize);
    for octant in 0..8_u32 {
        let sign = |bit: u32| if octant >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let signs = DVec3::new(sign(0), sign(1), sign(2));
        let point = |i: u32, j: u32| {
            let p = DVec3::from_array([i, j, n - i - j].map(f64::from));
            p / p.length() * signs
        };
        for i in 0..n {
            for j in 0..n - i {
                triangles.push([point(i, j), point(i + 1, j), point(i, j + 1)]);
                if i + j + 1 < n {
                    triangles.push([point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
                }
            }
        }
    }
    triangles
}

/// Random triangles of a size in the cube from -1 to 1.
pub(super) fn soup(dice: &mut Dice, count: u32, size: f64) -> Soup {
    (0..count)
        .map(|_| {
            let centre = dice.cube();
            [(); 3].map(|()| centre + dice.cube() * size)
        })
        .collect()
}

/// The two triangles of the quadrilateral a, b, c, d.
pub(super) fn quad([a, b, c, d]: [DVec3; 4]) -> [[DVec3; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// Squares of two triangles on three sides of each unit cell of `cells`: everything lies in cell planes.
pub(super) fn lattice(cells: impl IntoIterator<Item = [i32; 3]>) -> Soup {
    let mut triangles = Vec::new();
    for cell in cells {
        let corner = DVec3::from_array(cell.map(f64::from));
        for [u, v] in [
            [DVec3::X, DVec3::Y],
            [DVec3::Y, DVec3::Z],
            [DVec3::Z, DVec3::X],
        ] {
            triangles.extend(quad([corner, corner + u, corner + u + v, corner + v]));
        }
    }
    triangles
}

/// The cells of a box of `n` cells along each axis.
pub(super) fn cells(n: i32) -> impl Iterator<Item = [i32; 3]> {
    (0..n * n * n).map(move |i| [i % n, i / n % n, i / n / n])
}

/// `triangles` scaled, then moved by `offset` along each axis, then rounded to `f32` once.
pub(super) fn placed(triangles: &[[DVec3; 3]], scale: f64, offset: f64) -> Vec<[Vec3; 3]> {
    triangles
        .iter()
        .map(|t| t.map(|p| (p * scale + DVec3::splat(offset)).as_vec3()))
        .collect()
}

/// `triangles` rounded to `f32`.
pub(super) fn rounded(triangles: &[[DVec3; 3]]) -> Vec<[Vec3; 3]> {
    placed(triangles, 1.0, 0.0)
}

/// The corners of a triangle as they were rounded.
pub(super) fn exact(corners: [Vec3; 3]) -> [DVec3; 3] {
    corners.map(Vec3::as_dvec3)
}

/// A ray from `from`, rounded, that passes `target` within an ulp of its length; t is 1 there.
pub(super) fn aimed(from: DVec3, target: DVec3) -> Ray {
    let origin = from.as_vec3();
    Ray::new(origin, (target - origin.as_dvec3()).as_vec3())
}

/// A point of one of the triangle's edges.
pub(super) fn on_edge(dice: &mut Dice, corners: [Vec3; 3]) -> DVec3 {
    let corners = exact(corners);
    let first = dice.below(3) as usize;
    let (a, b) = (corners[first], corners[(first + 1) % 3]);
    a + (b - a) * dice.unit()
}

/// A ray at `target` on the triangle with these corners that meets its plane at more than 37 degrees, so that t is well
/// conditioned: from `reach` away, on the side that looks away from the origin or, if not `outside`, on either side.
pub(super) fn facing(
    dice: &mut Dice,
    corners: [Vec3; 3],
    target: DVec3,
    reach: f64,
    outside: bool,
) -> Ray {
    let [a, b, c] = exact(corners);
    // Of unit length before it is squared, as corners may be as small as numbers are.
    let side = |p: DVec3| p / p.abs().max_element().max(f64::MIN_POSITIVE);
    let normal = side(side(b - a).cross(side(c - a)));
    let normal = normal / normal.length().max(1e-9);
    let turned = if outside {
        normal.dot(target) < 0.0
    } else {
        dice.below(2) == 0
    };
    let away = dice.direction() * 0.8 + if turned { -normal } else { normal };
    aimed(target + away * reach, target)
}

/// Rays at insides of `triangles` that face them, from `reach` away; see [`facing`].
pub(super) fn at_insides(
    dice: &mut Dice,
    count: u32,
    triangles: &[[Vec3; 3]],
    reach: f64,
    outside: bool,
) -> Vec<Ray> {
    (0..count)
        .map(|_| {
            let corners = pick(dice, triangles);
            let target = dice.inside(exact(corners));
            facing(dice, corners, target, reach, outside)
        })
        .collect()
}

/// One of the triangles.
pub(super) fn pick(dice: &mut Dice, triangles: &[[Vec3; 3]]) -> [Vec3; 3] {
    dice.of(triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    #[test]
    fn the_ball_is_closed_wherever_it_is_placed() {
        for (scale, offset) in [(1.0, 0.0), (16.0, 1e7), (1e-30, 0.0)] {
            let mut edges: HashMap<[[u32; 3]; 2], u32> = HashMap::new();
            // Adding 0 makes both zeros the same bits.
            let bits = |p: Vec3| p.to_array().map(|x| (x + 0.0).to_bits());
            for t in placed(&ball(6), scale, offset) {
                for i in 0..3 {
                    let mut ends = [bits(t[i]), bits(t[(i + 1) % 3])];
                    ends.sort_unstable();
                    *edges.entry(ends).or_default() += 1;
                }
            }
            assert!(edges.values().all(|count| count % 2 == 0), "{offset}");
        }
    }
}
