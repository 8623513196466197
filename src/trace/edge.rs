//! `edge`: rays that are aimed at shared edges and vertices, from outside: where methods leak.
//!
//! ```text
//!   ●  origin: two diagonals of the box away from the target
//!    \
//!  a──x────b    three rays of four: a uniform point of a shared edge; every fourth: one of the edge's ends
//! ```
//!
//! An edge is shared where two triangles or more name the same two vertices; all shared edges are equally likely. The
//! direction from the target to the origin is cosine-weighted around the normal of one of its triangles, on the side
//! that looks away from the box's centre, so that on a closed mesh mostly the target is what the ray meets first.
//!
//! Origin and direction are rounded to `f32`, the target is not: wherever the mesh lies, a ray passes its edge within an
//! ulp of its length, on either side or exactly through it; what it really hits, the oracle says. `t` is 1 at the target
//! and ends at 1 + 1/64: a ray that slips through is then a leak, not a hit on the far side.
//!
//! Some edges and vertices are rims as seen along their ray (silhouettes, open borders): there the mesh ends, and which
//! side a ray passes is decided by less than rounding. A watertight method may miss what the ray touches there, as its
//! promise is about edges with a triangle on either side; such misses are leaks by definition, a few in a thousand.

use rand_core::Rng;
use rand_pcg::Pcg32;

use crate::geometry::{DVec3, Ray, unit_normal};
use crate::scene::Mesh;

use super::sample::{cosine_direction, direction, generator, unit};
use super::{Query, RaySetEntry, Rays};

pub(super) const ENTRY: RaySetEntry = RaySetEntry {
    name: "edge",
    about: "Rays from outside at shared edges (three of four) and their vertices: where methods leak.",
    query: Query::Closest,
    argument: "",
    params: &[],
    make: |request| {
        let mesh = &request.scene.mesh;
        let mut warnings = Vec::new();
        let mut edges = edges(mesh, 2);
        if edges.is_empty() {
            edges = self::edges(mesh, 1);
            warnings.push(match edges.as_slice() {
                [] => "the scene has no triangles, so 'edge' has no rays".to_owned(),
                _ => "no two triangles share an edge: 'edge' aims at all edges".to_owned(),
            });
        }
        let mut random = generator(request.seed, 4);
        let count = if edges.is_empty() { 0 } else { request.count };
        let rays = (0..count)
            .map(|i| {
                let pick = (u64::from(random.next_u32()) * edges.len() as u64) >> 32;
                aimed(mesh, &edges[pick as usize], i % 4 == 3, &mut random)
            })
            .collect();
        Ok(Rays { rays, warnings })
    },
};

/// Where a ray ends: 1/32 of the box's diagonal behind its target.
const BEHIND: f32 = 1.0 + 1.0 / 64.0;

/// An edge by the indices of its ends, the lower first, and one of its triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    ends: [u32; 2],
    prim: u32,
}

/// All edges that at least `shared` triangles have, by rising indices of their ends.
fn edges(mesh: &Mesh, shared: usize) -> Vec<Edge> {
    let mut all: Vec<Edge> = (0..)
        .zip(mesh.triangles())
        .flat_map(|(prim, &[a, b, c])| {
            [[a, b], [b, c], [c, a]].map(|[a, b]| Edge {
                ends: [a.min(b), a.max(b)],
                prim,
            })
        })
        .filter(|edge| edge.ends[0] != edge.ends[1])
        .collect();
    all.sort_unstable();
    all.chunk_by(|a, b| a.ends == b.ends)
        .filter(|same| same.len() >= shared)
        .map(|same| same[0])
        .collect()
}

/// A ray from outside at a point of `edge`, or at one of its ends.
fn aimed(mesh: &Mesh, edge: &Edge, at_vertex: bool, random: &mut Pcg32) -> Ray {
    let [a, b] = edge.ends.map(|v| mesh.vertices()[v as usize].as_dvec3());
    let s = unit(random);
    let target = match (at_vertex, s < 0.5) {
        (true, true) => a,
        (true, false) => b,
        (false, _) => a + (b - a) * s,
    };
    let bounds = mesh.bounds();
    let away = match unit_normal(&mesh.corners(edge.prim)) {
        Some(normal) => {
            let normal = normal.as_dvec3();
            let inwards = normal.dot(target - bounds.centre().as_dvec3()) < 0.0;
            cosine_direction(random, if inwards { -normal } else { normal })
        }
        None => direction(random),
    };
    let origin = (target + away * (2.0 * diagonal(mesh))).as_vec3();
    Ray {
        t_max: BEHIND,
        ..Ray::new(origin, (target - origin.as_dvec3()).as_vec3())
    }
}

/// Length of the diagonal of the scene's box; of one that survives rounding where it is a point.
pub(super) fn diagonal(mesh: &Mesh) -> f64 {
    let bounds = mesh.bounds();
    let extent: DVec3 = bounds.max.as_dvec3() - bounds.min.as_dvec3();
    let least = f64::from(bounds.max_abs()) * 1e-3;
    extent.length().max(least).max(f64::from(f32::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::super::{fixture, ray_set};
    use super::*;
    use crate::geometry::Vec3;

    #[test]
    fn edges_of_a_closed_box_are_shared_and_those_of_a_lone_square_but_its_diagonal_are_not() {
        // A box has 12 edges and 6 diagonals of faces; the square in it shares only its diagonal.
        let scene = fixture::room();
        assert_eq!(edges(&scene.mesh, 2).len(), 12 + 6 + 1);
        assert_eq!(edges(&scene.mesh, 1).len(), 12 + 6 + 5);
    }

    #[test]
    fn every_ray_starts_outside_and_passes_a_shared_edge_and_every_fourth_a_vertex() {
        let scene = fixture::room();
        let bounds = scene.mesh.bounds();
        let edges = edges(&scene.mesh, 2);
        let point = |v: u32| scene.mesh.vertices()[v as usize].as_dvec3();
        for (i, ray) in (0..).zip(ray_set(&scene, "edge", 2000, 1).unwrap().rays) {
            assert!(ray.origin.cmplt(bounds.min).any() || ray.origin.cmpgt(bounds.max).any());
            let target = ray.at(1.0).as_dvec3();
            let off = |[a, b]: [u32; 2]| {
                let along = point(b) - point(a);
                let s = (target - point(a)).dot(along) / along.length_squared();
                (point(a) + along * s.clamp(0.0, 1.0)).distance(target)
            };
            assert!(edges.iter().any(|e| off(e.ends) < 1e-5), "{ray:?}");
            let at_vertex = (0..12).any(|v| point(v).distance(target) < 1e-5);
            assert!(i % 4 != 3 || at_vertex, "ray {i}");
        }
    }

    #[test]
    fn without_shared_edges_all_edges_are_aimed_at_and_a_warning_says_so() {
        let mut scene = fixture::empty();
        let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        scene.mesh = std::sync::Arc::new(Mesh::new(vertices, vec![[0, 1, 2]]).unwrap());
        let set = ray_set(&scene, "edge", 10, 1).unwrap();
        assert_eq!(set.rays.len(), 10);
        assert!(set.warnings[0].contains("no two triangles share an edge"));
    }
}
