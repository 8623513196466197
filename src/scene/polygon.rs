//! Polygons to triangles.
//!
//! ```text
//!   3───────2        3───────2
//!   │     ╱ │         ╲  4  ╱│      fan where its triangles all turn the polygon's way,
//!   │  ╱    │          ╲╱ ╲╱ │      else ears
//!   0───────1           0────1
//! ```
//!
//! A polygon of n corners gives exactly n − 2 triangles, which use each of its sides once: so a closed surface of
//! polygons stays closed, and a corner in the middle of a straight side, to which a neighbour may be attached, is not
//! lost.
//!
//! **Source:** Newell's normal (Sutherland, Sproull, Schumacker 1974); ears by the crate earcut.
//!
//! **Differs:** the polygon is first flattened along the longest axis of its normal, because that rounds nothing and keeps
//! straight sides straight; only where it is so warped that it crosses itself there, onto the plane across its normal.
//! Corners that earcut drops as collinear are put back.

use std::collections::{HashMap, HashSet};

use earcut::Earcut;

use crate::geometry::DVec3;

/// Cuts polygons; keeps its buffers from one to the next.
pub struct Cutter {
    earcut: Earcut<f64>,
    flat: Vec<[f64; 2]>,
    ears: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

impl Cutter {
    /// Without buffers yet.
    pub fn new() -> Self {
        Self {
            earcut: Earcut::new(),
            flat: Vec::new(),
            ears: Vec::new(),
            triangles: Vec::new(),
        }
    }

    /// The triangles of the polygon over `corners` (three or more), as indices into it, and whether they cover it.
    ///
    /// They do not where it crosses itself or lies on a line; then they are a fan from the first corner.
    pub fn cut(&mut self, corners: &[DVec3]) -> (&[[u32; 3]], bool) {
        let n = corners.len() as u32;
        let normal = newell(corners);
        let mut covered = false;
        for basis in [along_axis(normal), in_plane(normal)] {
            self.flatten(corners, basis);
            self.cut_fan(n);
            if self.triangles.iter().all(|t| turn(&self.flat, *t) > 0.0) {
                return (&self.triangles, true);
            }
            self.cut_ears();
            covered = is_complete(n, &self.triangles);
            if covered {
                break;
            }
        }
        if !covered {
            self.cut_fan(n);
        }
        // Three corners are their own triangle, with or without area.
        (&self.triangles, covered || n == 3)
    }

    /// Flattens the polygon onto two axes.
    fn flatten(&mut self, corners: &[DVec3], [x, y]: [DVec3; 2]) {
        let origin = corners[0];
        let flat = |&p: &DVec3| [(p - origin).dot(x), (p - origin).dot(y)];
        self.flat.clear();
        self.flat.extend(corners.iter().map(flat));
    }

    /// Cuts from the first corner to all others.
    fn cut_fan(&mut self, n: u32) {
        self.triangles.clear();
        self.triangles.extend((1..n - 1).map(|i| [0, i, i + 1]));
    }

    /// Cuts by earcut, in the polygon's direction and with collinear corners put back.
    fn cut_ears(&mut self) {
        self.ears.clear();
        self.earcut
            .earcut(self.flat.iter().copied(), &[], &mut self.ears);
        self.triangles.clear();
        self.triangles.extend(self.ears.as_chunks::<3>().0);
        let area: f64 = self.triangles.iter().map(|t| turn(&self.flat, *t)).sum();
        if area < 0.0 {
            self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        restore(self.flat.len() as u32, &mut self.triangles);
    }
}

/// Newell's normal: twice the area of the polygon in each coordinate plane, whether it is flat or not.
fn newell(corners: &[DVec3]) -> DVec3 {
    let origin = corners[0];
    let sides = corners.iter().zip(corners.iter().cycle().skip(1));
    sides.map(|(a, b)| (*a - origin).cross(*b - origin)).sum()
}

/// The two axes other than the longest of `normal`, in the order in which they turn about it.
fn along_axis(normal: DVec3) -> [DVec3; 2] {
    let size = normal.abs();
    let longest = (0..3).fold(0, |best, a| if size[a] > size[best] { a } else { best });
    let x = DVec3::AXES[(longest + 1) % 3];
    let y = DVec3::AXES[(longest + 2) % 3];
    if normal[longest] < 0.0 {
        [y, x]
    } else {
        [x, y]
    }
}

/// Two axes in the plane across `normal`, in the order in which they turn about it.
fn in_plane(normal: DVec3) -> [DVec3; 2] {
    let normal = normal.normalize_or(DVec3::Z);
    let x = normal.any_orthonormal_vector();
    [x, normal.cross(x)]
}

/// Twice the signed area of a triangle: positive where it turns counter-clockwise.
fn turn(flat: &[[f64; 2]], triangle: [u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|i| flat[i as usize]);
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The directed sides of a triangle.
fn sides([a, b, c]: [u32; 3]) -> [(u32, u32); 3] {
    [(a, b), (b, c), (c, a)]
}

/// Puts corners that no triangle uses back on the side that passes over them.
fn restore(n: u32, triangles: &mut Vec<[u32; 3]>) {
    let mut used = vec![false; n as usize];
    for &i in triangles.iter().flatten() {
        used[i as usize] = true;
    }
    let Some(start) = used.iter().position(|&u| u) else {
        return;
    };
    if used.iter().all(|&u| u) {
        return;
    }
    let mut owner = HashMap::new();
    for (i, t) in triangles.iter().enumerate() {
        owner.extend(sides(*t).map(|side| (side, i)));
    }
    // Around the polygon once, from one used corner to the next.
    let mut from = start as u32;
    let mut run = vec![from];
    for step in 1..=n {
        let corner = (start as u32 + step) % n;
        run.push(corner);
        if !used[corner as usize] {
            continue;
        }
        if let (true, Some(&split)) = (run.len() > 2, owner.get(&(from, corner))) {
            let apex = triangles[split]
                .into_iter()
                .find(|&i| i != from && i != corner);
            let apex = apex.unwrap_or(from);
            for (i, pair) in run.windows(2).enumerate() {
                let part = [pair[0], pair[1], apex];
                let place = if i == 0 { split } else { triangles.len() };
                if i == 0 {
                    triangles[split] = part;
                } else {
                    triangles.push(part);
                }
                owner.extend(sides(part).map(|side| (side, place)));
            }
        }
        run.clear();
        run.push(corner);
        from = corner;
    }
}

/// Whether `triangles` are n − 2, have each side of the polygon once, and meet in all their other sides.
fn is_complete(n: u32, triangles: &[[u32; 3]]) -> bool {
    let mut all = HashSet::new();
    let once = triangles.len() as u32 == n - 2
        && triangles
            .iter()
            .flat_map(|&t| sides(t))
            .all(|side| all.insert(side));
    once && (0..n).all(|i| all.contains(&(i, (i + 1) % n)))
        && all
            .iter()
            .all(|&(a, b)| (a + 1) % n == b || all.contains(&(b, a)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cuts a polygon in z = 0 and checks that the triangles are complete; returns them and the sum of their areas.
    fn cut(points: &[(f64, f64)]) -> (Vec<[u32; 3]>, f64) {
        let corners: Vec<DVec3> = points.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect();
        let mut cutter = Cutter::new();
        let (triangles, covered) = cutter.cut(&corners);
        assert!(covered);
        assert!(is_complete(points.len() as u32, triangles));
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| corners[i as usize]);
            0.5 * (b - a).cross(c - a).z.abs()
        };
        (triangles.to_vec(), triangles.iter().map(area).sum())
    }

    #[test]
    fn a_convex_polygon_is_a_fan_from_its_first_corner() {
        let (triangles, area) = cut(&[(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)]);
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(area, 2.0);
    }

    #[test]
    fn a_concave_polygon_is_covered_without_overlap_whichever_corner_comes_first() {
        // An L of area 3; a fan from most of its corners would cover more.
        let l = [
            (0.0, 0.0),
            (2.0, 0.0),
            (2.0, 1.0),
            (1.0, 1.0),
            (1.0, 2.0),
            (0.0, 2.0),
        ];
        for first in 0..6 {
            let mut turned = l;
            turned.rotate_left(first);
            assert_eq!(cut(&turned).1, 3.0, "from {first}");
            turned.reverse();
            assert_eq!(cut(&turned).1, 3.0, "backwards from {first}");
        }
    }

    #[test]
    fn triangles_turn_the_way_of_their_polygon() {
        let mut arrow = [(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (0.5, 1.0)];
        for sign in [1.0, -1.0] {
            let (triangles, _) = cut(&arrow);
            for t in triangles {
                let [a, b, c] =
                    t.map(|i| DVec3::new(arrow[i as usize].0, arrow[i as usize].1, 0.0));
                assert!((b - a).cross(c - a).z * sign > 0.0);
            }
            arrow.reverse();
        }
    }

    #[test]
    fn corners_in_the_middle_of_straight_sides_are_kept_without_degenerate_triangles() {
        let sides = [
            (0.0, 0.0),
            (1.0, 0.0),
            (2.0, 0.0),
            (2.0, 1.0),
            (2.0, 2.0),
            (1.0, 2.0),
            (0.0, 2.0),
            (0.0, 1.0),
        ];
        for first in 0..8 {
            let mut turned = sides;
            turned.rotate_left(first);
            let (triangles, area) = cut(&turned);
            assert_eq!((triangles.len(), area), (6, 4.0));
            for t in triangles {
                assert!(turn(&turned.map(|(x, y)| [x, y]), t) > 0.0);
            }
        }
    }

    #[test]
    fn a_polygon_on_a_line_or_in_a_point_is_a_fan_of_degenerate_triangles() {
        let mut cutter = Cutter::new();
        for scale in [0.0, 1.0] {
            let line: Vec<DVec3> = [0.0, 1.0, 3.0, 2.0]
                .map(|x| DVec3::splat(x * scale))
                .to_vec();
            let (triangles, covered) = cutter.cut(&line);
            assert_eq!(triangles, [[0, 1, 2], [0, 2, 3]]);
            assert!(!covered);
        }
        let (triangles, covered) = cutter.cut(&[DVec3::ZERO; 3]);
        assert_eq!((triangles, covered), (&[[0, 1, 2]][..], true));
    }

    #[test]
    fn a_repeated_corner_costs_no_triangle_of_the_rest() {
        let (triangles, area) = cut(&[(0.0, 0.0), (0.0, 0.0), (2.0, 0.0), (0.5, 0.5), (0.0, 2.0)]);
        assert_eq!((triangles.len(), area), (3, 1.0));
    }

    #[test]
    fn a_bow_tie_keeps_its_number_of_triangles() {
        let mut cutter = Cutter::new();
        let corners = [(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)];
        let corners = corners.map(|(x, y)| DVec3::new(x, y, 0.0));
        assert_eq!(cutter.cut(&corners).0.len(), 2);
    }

    #[test]
    fn a_strip_that_crosses_itself_along_an_axis_is_cut_in_its_own_plane() {
        // From the staircase: thin, bent, and overlapping itself when seen from above.
        let corners = [
            (7.6584, 158.5416, 3.945),
            (5.4035, 158.5416, 3.9642),
            (5.3848, 158.3766, 4.163),
            (9.9299, 158.3766, 3.6855),
            (12.0492, 158.3766, 2.8071),
            (11.9543, 158.5416, 2.6314),
        ];
        let corners = corners.map(|(x, y, z)| DVec3::new(x, y, z));
        let mut cutter = Cutter::new();
        let (triangles, covered) = cutter.cut(&corners);
        assert!(covered && is_complete(6, triangles));
    }

    #[test]
    fn a_polygon_in_a_slanted_plane_is_covered() {
        // The arrow of four corners in the plane x + y + z = 0, reflex at the last.
        let (u, v) = (DVec3::new(1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, -2.0));
        let corners = [(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (0.5, 1.0)].map(|(x, y)| u * x + v * y);
        let mut cutter = Cutter::new();
        let (triangles, covered) = cutter.cut(&corners);
        assert!(covered);
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| corners[i as usize]);
            0.5 * (b - a).cross(c - a).length()
        };
        let whole = 1.5 * u.length() * v.length();
        assert!((triangles.iter().map(area).sum::<f64>() - whole).abs() < 1e-12);
    }
}
