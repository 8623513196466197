//! `edge`: rays that are aimed at shared edges and vertices, from outside: where methods leak.
//!
//! ```text
//!   ●  origin: two diagonals of the box away from the target (`distance`)
//!    \    (or the centre of the box, `from=centre`: as from inside a closed mesh)
//!  a──x────b    three rays of four: a uniform point of a shared edge; every fourth: one of the edge's ends
//! ```
//!
//! An edge is shared where two triangles or more name the same two points; all shared edges are equally likely. The
//! direction from the target to the origin is cosine-weighted around the normal of one of its triangles, on the side
//! that looks away from the box's centre, so that on a closed mesh mostly the target is what the ray meets first.
//!
//! Origin and direction are rounded to `f32`, the target is not: wherever the mesh lies, a ray passes its edge within an
//! ulp of its length, on either side or exactly through it; what it really hits, the oracle says. `t` is 1 at the target
//! and ends 1/32 of the box's diagonal behind it: a ray that slips through is then a leak, not a hit on the far side.
//!
//! **No rims.** Where the mesh ends as seen along the ray (a silhouette, an open border), less than a rounding decides
//! whether it is met at all, and no method can be blamed. `seam` beside this file tells such targets from those beyond
//! which the surface goes on on every side; only these are kept, so a miss is a true leak.

use rand_core::Rng;
use rand_pcg::Pcg32;

use crate::geometry::{DVec3, Ray, unit_normal};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::Mesh;

use super::sample::{cosine_direction, direction, generator, unit};
use super::seam::{Edge, Seams};
use super::{Query, RayRequest, RaySetEntry, Rays};

pub(super) const ENTRY: RaySetEntry = RaySetEntry {
    name: "edge",
    about: "Rays from outside at shared edges (three of four) and vertices beyond which the surface goes on: where methods leak.",
    query: Query::Closest,
    argument: "",
    params: &[
        ParamSpec {
            name: "at",
            about: "What the rays are aimed at: points of edges, vertices, or both.",
            kind: ParamKind::Choice(&["both", "edge", "vertex"]),
            default: "both",
        },
        ParamSpec {
            name: "distance",
            about: "From origin to target, in diagonals of the box; a shorter one rounds less and may start inside.",
            kind: ParamKind::Float {
                min: 1e-3,
                max: 1e3,
            },
            default: "2",
        },
        ParamSpec {
            name: "from",
            about: "Where rays start: outside, at that distance, or at the centre of the scene's box.",
            kind: ParamKind::Choice(&["outside", "centre"]),
            default: "outside",
        },
    ],
    make: |request| Ok(make(request)),
};

/// How far behind its target a ray ends, in diagonals of the box; …
const BEHIND: f64 = 1.0 / 32.0;
/// … and in its own length beside that, well beyond rounding.
const ROUNDING: f64 = 1.0 / (1 << 16) as f64;

/// Of this many rays one is aimed at a vertex.
const ONE_VERTEX_OF: usize = 4;

/// How often a ray is aimed anew at something else before it is left out.
const TRIES: usize = 64;

fn make(request: &RayRequest) -> Rays {
    let mesh = &request.scene.mesh;
    let seams = Seams::new(mesh);
    let mut random = generator(request.seed, 4);
    let at_vertex = |i: usize| match request.params.text("at") {
        "edge" => false,
        "vertex" => true,
        _ => i % ONE_VERTEX_OF == ONE_VERTEX_OF - 1,
    };
    let from = match request.params.text("from") {
        "centre" => Start::Centre,
        _ => Start::Outside(request.params.number("distance").unwrap_or(2.0) * diagonal(mesh)),
    };
    let mut aim = |edges: &[Edge], tries: usize, checked: bool| -> Vec<Ray> {
        if edges.is_empty() {
            return Vec::new();
        }
        let one = |i| {
            let mut tries = 0..tries;
            tries.find_map(|_| {
                let pick = (u64::from(random.next_u32()) * edges.len() as u64) >> 32;
                let target = Target::of(mesh, &edges[pick as usize], at_vertex(i), &mut random);
                let ray = target.ray(mesh, from, &mut random);
                (ray.is_valid() && (!checked || target.goes_on(&seams, mesh, &ray))).then_some(ray)
            })
        };
        (0..request.count).filter_map(one).collect()
    };
    let rays = aim(seams.shared(), TRIES, true);
    let mut warnings = Vec::new();
    if rays.is_empty() {
        let rays = aim(seams.all(), 1, false);
        warnings.push(if rays.is_empty() {
            "the scene has no triangles, so 'edge' has no rays".to_owned()
        } else {
            "no two triangles share an edge that the surface goes on beyond: 'edge' aims at all edges, and a miss need \
             not be a leak"
                .to_owned()
        });
        return Rays { rays, warnings };
    }
    if rays.len() < request.count {
        let (lost, all) = (request.count - rays.len(), request.count);
        warnings.push(format!(
            "{lost} of {all} rays of 'edge' found no edge that the surface goes on beyond and were left out"
        ));
    }
    Rays { rays, warnings }
}

/// Where rays start.
#[derive(Clone, Copy)]
enum Start {
    /// So far from the target.
    Outside(f64),
    /// At the centre of the box.
    Centre,
}

/// What a ray is aimed at.
struct Target<'a> {
    edge: &'a Edge,
    /// The end of the edge that is aimed at, if not a point between them.
    vertex: Option<u32>,
    point: DVec3,
}

impl<'a> Target<'a> {
    /// A uniform point of `edge`, or one of its ends.
    fn of(mesh: &Mesh, edge: &'a Edge, at_vertex: bool, random: &mut Pcg32) -> Self {
        let [a, b] = edge.ends.map(|v| mesh.vertices()[v as usize].as_dvec3());
        let s = unit(random);
        let first = s < 0.5;
        let point = match (at_vertex, first) {
            (true, true) => a,
            (true, false) => b,
            (false, _) => a + (b - a) * s,
        };
        Self {
            edge,
            vertex: at_vertex.then(|| edge.ends[usize::from(!first)]),
            point,
        }
    }

    /// A ray to it.
    fn ray(&self, mesh: &Mesh, from: Start, random: &mut Pcg32) -> Ray {
        let origin = match from {
            Start::Outside(distance) => (self.point + self.away(mesh, random) * distance).as_vec3(),
            Start::Centre => mesh.bounds().centre(),
        };
        let way = self.point - origin.as_dvec3();
        let bounds = mesh.bounds();
        let extent = (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length();
        // Infinite for a target at the centre: its direction is 0, and the ray is left out.
        let behind = BEHIND * extent / way.length();
        Ray {
            t_max: (1.0 + ROUNDING + behind) as f32,
            ..Ray::new(origin, way.as_vec3())
        }
    }

    /// A direction to the side that looks away from the box's centre.
    fn away(&self, mesh: &Mesh, random: &mut Pcg32) -> DVec3 {
        let Some(normal) = unit_normal(&mesh.corners(self.edge.prim)) else {
            return direction(random);
        };
        let normal = normal.as_dvec3();
        let centre = mesh.bounds().centre().as_dvec3();
        let inwards = normal.dot(self.point - centre) < 0.0;
        cosine_direction(random, if inwards { -normal } else { normal })
    }

    /// Whether the surface goes on on every side of the target as seen along `ray`.
    fn goes_on(&self, seams: &Seams, mesh: &Mesh, ray: &Ray) -> bool {
        match self.vertex {
            Some(vertex) => seams.goes_on_around(mesh, vertex, ray),
            None => self.edge.goes_on_beyond(mesh, ray),
        }
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
    use crate::oracle::Oracle;

    /// Distance of the ray's point at t = 1 from the nearest edge, and from the nearest vertex.
    fn misses(mesh: &Mesh, ray: &Ray) -> (f64, f64) {
        let point = |v: u32| mesh.vertices()[v as usize].as_dvec3();
        let target = ray.at(1.0).as_dvec3();
        let off = |[a, b]: [u32; 2]| {
            let along = point(b) - point(a);
            let s = (target - point(a)).dot(along) / along.length_squared();
            (point(a) + along * s.clamp(0.0, 1.0)).distance(target)
        };
        let seams = Seams::new(mesh);
        let to_edge = seams.all().iter().map(|e| off(e.ends));
        let to_vertex = (0..mesh.vertices().len() as u32).map(|v| point(v).distance(target));
        (
            to_edge.fold(f64::INFINITY, f64::min),
            to_vertex.fold(f64::INFINITY, f64::min),
        )
    }

    #[test]
    fn rays_from_the_centre_of_a_ball_meet_it_at_vertices() {
        let scene = crate::scene::load("shells:1,2").unwrap();
        let rays = ray_set(&scene, "edge:at=vertex:from=centre", 200, 1).unwrap();
        assert_eq!((rays.rays.len(), rays.warnings.len()), (200, 0));
        let oracle = Oracle::new(&scene.mesh);
        for ray in &rays.rays {
            assert_eq!(ray.origin, Vec3::ZERO);
            assert!(misses(&scene.mesh, ray).1 == 0.0 && oracle.truth(ray).is_hit());
        }
    }

    #[test]
    fn every_ray_starts_outside_and_passes_a_shared_edge_and_every_fourth_a_vertex() {
        let scene = fixture::room();
        let bounds = scene.mesh.bounds();
        let rays = ray_set(&scene, "edge", 2000, 1).unwrap().rays;
        assert_eq!(rays.len(), 2000);
        for (i, ray) in (0..).zip(&rays) {
            assert!(ray.origin.cmplt(bounds.min).any() || ray.origin.cmpgt(bounds.max).any());
            let (to_edge, to_vertex) = misses(&scene.mesh, ray);
            assert!(to_edge < 1e-5, "{ray:?}");
            assert!(i % 4 != 3 || to_vertex < 1e-5, "ray {i}");
        }
    }

    #[test]
    fn a_set_is_aimed_only_at_edges_or_only_at_vertices_where_that_is_asked_for() {
        let scene = fixture::room();
        let at_vertices = |spec| {
            let rays = ray_set(&scene, spec, 400, 1).unwrap().rays;
            let near = |ray: &&Ray| misses(&scene.mesh, ray).1 < 1e-5;
            rays.iter().filter(near).count()
        };
        assert_eq!(at_vertices("edge:at=vertex"), 400);
        assert!(at_vertices("edge:at=edge") < 3);
        let why = ray_set(&scene, "edge:at=face", 1, 1).unwrap_err();
        assert!(why.to_string().contains("edge, vertex"), "{why}");
    }

    #[test]
    fn every_ray_at_a_closed_mesh_hits_it_by_the_oracle_wherever_it_lies() {
        for offset in [0.0, 1e2, 1e4] {
            let sphere = crate::scene::load("shells:1").unwrap();
            let scene = fixture::moved(&sphere, Vec3::splat(offset));
            let oracle = Oracle::new(&scene.mesh);
            for at in ["edge:at=edge", "edge:at=vertex"] {
                let rays = ray_set(&scene, at, 3000, 1).unwrap().rays;
                assert_eq!(rays.len(), 3000);
                assert!(rays.iter().all(|ray| oracle.occluded(ray)), "{at} {offset}");
            }
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
