//! `overlap=three-test`, the sheet's: a triangle belongs to a cell if a vertex lies inside, an edge crosses its
//! surface, or one of its four main diagonals crosses the triangle.
//!
//! ```text
//!   +-------+     +-------+     +-------+
//!   |   .---+--   | \   / |     |\      |
//!   |  /    |     |  \ /  |   --+-\-----+--   a triangle that only its inside touches
//!   | '     |     +---V---+     |  \    |     cuts the cell across, and so meets a diagonal
//!   +-------+        \/ an edge +---\---+
//! ```
//!
//! **Source:** the sheet of the assignment raylab grew from. The three tests are exact: if triangle T meets box C, no
//! vertex is in C and no edge meets C, then the plane's whole section S of C lies inside T. With C centred at 0 and
//! half extents h, the diagonal from -v to v with `v_i = sign(n_i)·h_i` spans the whole range of n·x over C, so it meets
//! the plane in C: in S, hence in T. For the edge test: an edge that meets C has an end inside or meets its surface.
//!
//! **Differs:** only that one diagonal is tested, since the other three decide nothing. A diagonal that lies in the
//! plane (a cell without thickness) meets it everywhere; its middle is taken, where naive forms report a miss.
//!
//! Errors in `f64`: an edge d is tested by separating axes of the form `|m_y·d_z − m_z·d_y| ≤ h_y·|d_z| + h_z·|d_y|`.
//! Their error, 2⁻⁵⁰ of the box's size times `|d_y| + |d_z|`, is far below what the pad adds on the right. If only T's
//! inside touches the unpadded cell and no edge touches the padded one, then T is wider than the pad, so its normal is
//! good to 2⁻²⁹, and the diagonal meets T at least one pad away from every edge: too far for rounding to turn a sign.

use crate::geometry::DVec3;

use super::Overlap;

/// A triangle for the three tests.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct ThreeTest {
    corners: [DVec3; 3],
    edges: [DVec3; 3],
    normal: DVec3,
}

impl Overlap for ThreeTest {
    #[inline(always)]
    fn new(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let edges = [b - a, c - b, a - c];
        Self {
            corners,
            edges,
            normal: edges[0].cross(edges[1]),
        }
    }

    #[inline(always)]
    fn touches(&self, centre: DVec3, half: DVec3) -> bool {
        let corners = self.corners.map(|v| v - centre);
        corners.iter().any(|v| v.abs().cmple(half).all())
            || (0..3).any(|i| edge_touches(corners[i], self.edges[i], half))
            || self.diagonal_crosses(&corners, half)
    }
}

impl ThreeTest {
    /// Whether the diagonal that spans the normal's range crosses the triangle with these corners around the centre.
    #[inline(always)]
    fn diagonal_crosses(&self, corners: &[DVec3; 3], half: DVec3) -> bool {
        if self.normal == DVec3::ZERO {
            return false; // Without area it is its edges, and they were tested.
        }
        let reach = self.normal.abs().dot(half);
        let distance = self.normal.dot(corners[0]);
        if distance.abs() > reach {
            return false;
        }
        // A plane whose normal's range over the cell is the point 0 contains the cell: any point of it will do.
        let along = if reach > 0.0 { distance / reach } else { 0.0 };
        let diagonal = half * self.normal.signum();
        let point = diagonal * along;
        (0..3).all(|i| self.edges[i].cross(point - corners[i]).dot(self.normal) >= 0.0)
    }
}

/// Whether the segment from `from` along `edge` touches the box around 0: separating axes of a segment and a box.
#[inline(always)]
fn edge_touches(from: DVec3, edge: DVec3, half: DVec3) -> bool {
    let d = edge * 0.5;
    let m = from + d;
    let (ad, am) = (d.abs(), m.abs());
    if !am.cmple(half + ad).all() {
        return false;
    }
    let cross = m.cross(d).abs();
    // The radius of the box along each axis e_i × d.
    let radius = DVec3::new(
        half.y * ad.z + half.z * ad.y,
        half.z * ad.x + half.x * ad.z,
        half.x * ad.y + half.y * ad.x,
    );
    cross.cmple(radius).all()
}

#[cfg(test)]
mod tests {
    use super::super::exact;
    use super::*;

    #[test]
    fn a_flat_cell_inside_a_triangle_of_its_plane_is_touched() {
        // REFERENCE, section 3: a diagonal parallel to the plane must not count as a miss.
        let triangle = ThreeTest::new([DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0)]);
        let centre = DVec3::new(0.5625, 0.3125, 0.0);
        let half = DVec3::new(0.0625, 0.0625, 0.0);
        assert!(triangle.touches(centre, half));
        assert!(!triangle.touches(DVec3::new(0.3125, 0.5625, 0.0), half));
    }

    #[test]
    fn diagonals_alone_decide_a_triangle_that_cuts_across() {
        let triangle = [
            DVec3::new(-40.0, -40.0, 1.0),
            DVec3::new(40.0, -40.0, 1.0),
            DVec3::new(0.0, 80.0, 1.0),
        ];
        assert!(ThreeTest::new(triangle).touches(DVec3::ZERO, DVec3::splat(1.0)));
        assert!(!ThreeTest::new(triangle).touches(DVec3::ZERO, DVec3::splat(0.5)));
    }

    #[test]
    fn three_tests_equal_exact_separating_axes_on_small_integers() {
        exact::compare::<ThreeTest>();
    }
}
