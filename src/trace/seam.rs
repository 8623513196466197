//! Where triangles meet, and whether the surface goes on there as seen along a ray.
//!
//! ```text
//!        c                 along the ray, which passes x:
//!       / \                an edge a b: a triangle on either side of it, and x clear of all their other edges;
//!      a─x─b    w──e──n    a vertex x: the triangles around it cover every direction.
//!       \ /     │╲ │ ╱│
//!        d      s──x──·    seen so, x is inside the covered area whatever less than the margin moves
//! ```
//!
//! Triangles meet where they name points with the same coordinates, whatever their indices. Everything is decided in
//! the plane across the ray, in `f64`, with a margin that no rounding of a `f32` test reaches.
//!
//! **Vertices.** The edges opposite a vertex form its link. Where every corner of the link belongs to an even number of
//! them, a line from x to infinity crosses the link, as seen along the ray, an odd number of times for all directions
//! or for none; odd means covered. Layers that hide each other in pairs count as not covered.

use glam::DVec2;

use crate::geometry::{DVec3, Ray, Vec3};
use crate::scene::Mesh;

/// Rounding of aiming and of a shear onto the ray is within 2⁻²⁰ of the distance to the target; this is eight times it.
const MARGIN: f64 = 1.0 / (1 << 18) as f64;

/// An edge by the indices of its ends, and the triangles that have it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Edge {
    /// The lower index first; of equal points the one with the lowest index stands for all.
    pub ends: [u32; 2],
    /// One of its triangles.
    pub prim: u32,
    /// The third corners of its triangles, each once.
    opposite: Vec<u32>,
}

/// The edges opposite a vertex.
#[derive(Debug, Default)]
struct Link {
    /// Each once, the lower index first.
    edges: Vec<[u32; 2]>,
    /// Whether every corner belongs to an even number of them.
    closed: bool,
}

/// Edges and vertices of a mesh. Triangles that name a point twice have none.
#[derive(Debug)]
pub(super) struct Seams {
    /// Those that at least two triangles share come first; both parts by rising indices.
    edges: Vec<Edge>,
    shared: usize,
    /// One a vertex; empty but for those that stand for all equal ones.
    links: Vec<Link>,
}

/// For each vertex the lowest index of a vertex with the same coordinates.
fn welded(mesh: &Mesh) -> Vec<u32> {
    // 0 and -0 are the same coordinate.
    let key = |v: &Vec3| v.to_array().map(|x| (x + 0.0).to_bits());
    let mut order: Vec<_> = mesh.vertices().iter().map(key).zip(0_u32..).collect();
    order.sort_unstable();
    let mut welded = vec![0; order.len()];
    for same in order.chunk_by(|a, b| a.0 == b.0) {
        for (_, vertex) in same {
            welded[*vertex as usize] = same[0].1;
        }
    }
    welded
}

impl Edge {
    /// Whether `ray`, aimed at a point between the ends with t = 1 there, has a triangle on either side of
    /// the edge, and stays clear of all their other edges.
    pub fn goes_on_beyond(&self, mesh: &Mesh, ray: &Ray) -> bool {
        let view = View::along(mesh, ray);
        let [a, b] = self.ends.map(|v| view.of(v));
        let mut sides = [false; 2];
        for &c in &self.opposite {
            let c = view.of(c);
            let turn = (b - a).perp_dot(c - a);
            let clear = |from: DVec2, to: DVec2| {
                let along = to - from;
                along.perp_dot(-from) * turn.signum() > view.margin * along.length()
            };
            if clear(b, c) && clear(c, a) {
                sides[usize::from(turn > 0.0)] = true;
            }
        }
        sides == [true; 2]
    }
}

impl Seams {
    /// Finds all edges and links; n log n.
    pub fn new(mesh: &Mesh) -> Self {
        let welded = welded(mesh);
        let mut sides = Vec::with_capacity(3 * mesh.len());
        let mut links: Vec<Link> = mesh.vertices().iter().map(|_| Link::default()).collect();
        for (prim, corners) in (0..).zip(mesh.triangles()) {
            let [a, b, c] = corners.map(|v| welded[v as usize]);
            if a == b || b == c || c == a {
                continue;
            }
            for [a, b, c] in [[a, b, c], [b, c, a], [c, a, b]] {
                let ends = [a.min(b), a.max(b)];
                sides.push((ends, c, prim));
                links[c as usize].edges.push(ends);
            }
        }
        for link in &mut links {
            link.edges.sort_unstable();
            link.edges.dedup();
            let mut corners: Vec<u32> = link.edges.iter().flatten().copied().collect();
            corners.sort_unstable();
            link.closed = corners.chunk_by(u32::eq).all(|c| c.len() % 2 == 0);
        }
        sides.sort_unstable();
        let edge = |same: &[([u32; 2], u32, u32)]| {
            let mut opposite: Vec<u32> = same.iter().map(|side| side.1).collect();
            opposite.dedup();
            Edge {
                ends: same[0].0,
                prim: same[0].2,
                opposite,
            }
        };
        let edges = sides.chunk_by(|a, b| a.0 == b.0).map(edge);
        let (mut edges, rest): (Vec<Edge>, Vec<Edge>) = edges.partition(|e| e.opposite.len() > 1);
        let shared = edges.len();
        edges.extend(rest);
        Self {
            edges,
            shared,
            links,
        }
    }

    /// Edges that two different triangles or more have.
    pub fn shared(&self) -> &[Edge] {
        &self.edges[..self.shared]
    }

    /// All edges.
    pub fn all(&self) -> &[Edge] {
        &self.edges
    }

    /// Whether the triangles around `vertex`, at which `ray` is aimed with t = 1 there, cover all directions around it.
    pub fn goes_on_around(&self, mesh: &Mesh, vertex: u32, ray: &Ray) -> bool {
        let link = &self.links[vertex as usize];
        if !link.closed {
            return false;
        }
        let view = View::along(mesh, ray);
        let mut odd = false;
        for ends in &link.edges {
            let [a, b] = ends.map(|v| view.of(v));
            if distance(a, b) <= view.margin {
                return false;
            }
            // Does the link's edge cross the half-line to the right of the ray?
            let rises = b.y > a.y;
            odd ^= (a.y > 0.0) != (b.y > 0.0) && (a.perp_dot(b) > 0.0) == rises;
        }
        odd
    }
}

/// Distance of the point 0 from the segment from `a` to `b`; NaN never.
fn distance(a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let square = along.length_squared();
    let s = if square > 0.0 {
        (-a.dot(along) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (a + along * s).length()
}

/// The plane across a ray, which is its point 0.
struct View<'a> {
    mesh: &'a Mesh,
    origin: DVec3,
    right: DVec3,
    up: DVec3,
    margin: f64,
}

impl<'a> View<'a> {
    fn along(mesh: &'a Mesh, ray: &Ray) -> Self {
        let dir = ray.dir.as_dvec3();
        let length = dir.length();
        let (right, up) = (dir / length).any_orthonormal_pair();
        Self {
            mesh,
            origin: ray.origin.as_dvec3(),
            right,
            up,
            margin: MARGIN * length,
        }
    }

    fn of(&self, vertex: u32) -> DVec2 {
        let p = self.mesh.vertices()[vertex as usize].as_dvec3() - self.origin;
        DVec2::new(p.dot(self.right), p.dot(self.up))
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixture;
    use super::*;

    /// A pyramid over a square around the z axis: points 0 to 3 at z = 0, the apex 4 at `height`.
    fn pyramid(height: f32) -> Mesh {
        let vertices = vec![Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y, Vec3::Z * height];
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        Mesh::new(vertices, triangles).unwrap()
    }

    /// A ray that reaches `target` at t = 1.
    fn aimed(origin: Vec3, target: Vec3) -> Ray {
        Ray::new(origin, target - origin)
    }

    fn edge(seams: &Seams, ends: [u32; 2]) -> &Edge {
        seams.all().iter().find(|e| e.ends == ends).unwrap()
    }

    #[test]
    fn edges_of_a_closed_box_are_shared_and_those_of_a_lone_square_but_its_diagonal_are_not() {
        // A box has 12 edges and 6 diagonals of faces; the square in it shares only its diagonal.
        let seams = Seams::new(&fixture::room().mesh);
        assert_eq!(seams.shared().len(), 12 + 6 + 1);
        assert_eq!(seams.all().len(), 12 + 6 + 5);
    }

    #[test]
    fn points_with_the_same_coordinates_are_one_and_a_triangle_given_twice_shares_nothing() {
        let apart = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X, -Vec3::ZERO, -Vec3::Y];
        let mesh = Mesh::new(apart, vec![[0, 1, 2], [3, 4, 5], [4, 3, 2]]).unwrap();
        let seams = Seams::new(&mesh);
        let shared: Vec<[u32; 2]> = seams.shared().iter().map(|e| e.ends).collect();
        assert_eq!(shared, [[0, 1]]);
        let mesh = Mesh::new(
            vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            vec![[0, 1, 2], [1, 0, 2]],
        );
        assert!(Seams::new(&mesh.unwrap()).shared().is_empty());
    }

    #[test]
    fn an_edge_seen_as_a_silhouette_or_a_border_is_a_rim_and_a_fold_seen_from_above_is_none() {
        let mesh = pyramid(1.0);
        let seams = Seams::new(&mesh);
        let fold = edge(&seams, [0, 4]);
        let middle = Vec3::new(0.5, 0.0, 0.5);
        let sees = |origin| fold.goes_on_beyond(&mesh, &aimed(origin, middle));
        assert!(sees(Vec3::new(0.5, 0.1, 9.0)));
        // From the side, both triangles lie below the edge.
        assert!(!sees(Vec3::new(0.6, 9.0, 0.5)));
        let border = edge(&seams, [0, 1]);
        let ray = aimed(Vec3::new(0.4, 0.4, 9.0), Vec3::new(0.5, 0.5, 0.0));
        assert!(!border.goes_on_beyond(&mesh, &ray));
    }

    #[test]
    fn a_point_of_an_edge_next_to_its_end_is_left_to_the_vertex() {
        let mesh = pyramid(1.0);
        let seams = Seams::new(&mesh);
        let sees = |x: f32| {
            let ray = aimed(Vec3::new(x, 0.0, 9.0), Vec3::new(x, 0.0, 1.0 - x));
            edge(&seams, [0, 4]).goes_on_beyond(&mesh, &ray)
        };
        assert!(sees(1e-3) && !sees(1e-6));
    }

    #[test]
    fn a_vertex_is_covered_where_its_fan_closes_around_the_ray() {
        let mesh = pyramid(1.0);
        let seams = Seams::new(&mesh);
        let sees = |vertex: u32, origin| {
            let target = mesh.vertices()[vertex as usize];
            seams.goes_on_around(&mesh, vertex, &aimed(origin, target))
        };
        assert!(sees(4, Vec3::new(0.1, 0.2, 9.0)));
        // From below the horizon of the apex's fan, the apex is its outermost point.
        assert!(!sees(4, Vec3::new(9.0, 0.2, 1.5)));
        // A corner of the base: its fan is open.
        assert!(!sees(0, Vec3::new(1.0, 0.0, 9.0)));
    }

    #[test]
    fn a_fan_of_two_layers_is_not_taken_for_a_covered_one() {
        // A saddle folded so that it is seen twice or not at all: from the side of a tent without its floor.
        let mesh = pyramid(1e-9);
        let seams = Seams::new(&mesh);
        let ray = aimed(Vec3::new(0.3, 9.0, 0.0), mesh.vertices()[4]);
        assert!(!seams.goes_on_around(&mesh, 4, &ray));
    }
}
