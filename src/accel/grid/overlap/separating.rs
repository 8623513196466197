//! `overlap=sat`: thirteen separating axes of a triangle and a box.
//!
//! **Source:** T. Akenine-Möller, "Fast 3D Triangle-Box Overlap Testing", JGT 6(1), 2001.
//! **Differs:** in `f64`; comparisons are closed, and the plane test adds a bound on its own error, because the normal
//! of a sliver may be all rounding. (The pad alone covers the other axes: their error is a tiny share of the axis
//! itself, however the triangle is shaped.) In `f32` the published form loses a triangle on a cell plane from both cells.

use crate::geometry::DVec3;

use super::Overlap;

/// A triangle for the separating axes.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Separating {
    corners: [DVec3; 3],
    edges: [DVec3; 3],
    normal: DVec3,
    /// Sums of absolute products instead of the normal's differences: what the normal's rounding errors scale with.
    permanent: DVec3,
}

impl Overlap for Separating {
    #[inline(always)]
    fn new(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let edges = [b - a, c - b, a - c];
        let [p, q] = [edges[0].abs(), edges[1].abs()];
        Self {
            corners,
            edges,
            normal: edges[0].cross(edges[1]),
            permanent: DVec3::new(
                p.y * q.z + p.z * q.y,
                p.z * q.x + p.x * q.z,
                p.x * q.y + p.y * q.x,
            ),
        }
    }

    #[inline(always)]
    fn touches(&self, centre: DVec3, half: DVec3) -> bool {
        let corners = self.corners.map(|v| v - centre);
        self.plane_touches(&corners, half)
            && corners_touch(&corners, half)
            && (0..3).all(|i| cross_axes_touch(&corners, i, self.edges[i], half))
    }
}

impl Separating {
    #[inline(always)]
    fn plane_touches(&self, corners: &[DVec3; 3], half: DVec3) -> bool {
        // Fewer than 16 roundings, each within 2^-53 of a term of the permanent.
        let error = self.permanent.dot(corners[0].abs()) * (8.0 * f64::EPSILON);
        self.normal.dot(corners[0]).abs() <= self.normal.abs().dot(half) + error
    }
}

/// The box's own three axes.
#[inline(always)]
fn corners_touch(corners: &[DVec3; 3], half: DVec3) -> bool {
    let [a, b, c] = *corners;
    a.min(b).min(c).cmple(half).all() && a.max(b).max(c).cmpge(-half).all()
}

/// The three axes `e_i` × edge. The edge's two corners project to one point, so one of them and the third are compared.
#[inline(always)]
fn cross_axes_touch(corners: &[DVec3; 3], i: usize, edge: DVec3, half: DVec3) -> bool {
    let on = corners[i].cross(edge);
    let off = corners[(i + 2) % 3].cross(edge);
    let e = edge.abs();
    let radius = DVec3::new(
        half.y * e.z + half.z * e.y,
        half.z * e.x + half.x * e.z,
        half.x * e.y + half.y * e.x,
    );
    on.min(off).cmple(radius).all() && on.max(off).cmpge(-radius).all()
}

#[cfg(test)]
mod tests {
    use super::super::exact;
    use super::*;

    #[test]
    fn separating_axes_in_f64_equal_exact_ones_on_small_integers() {
        exact::compare::<Separating>();
    }
}
