//! Peers: structures of other libraries, in the same registry and the same sweeps as raylab's own, to be measured
//! against.
//!
//! ```text
//!              tree of      triangles tested by     counts     where
//! obvhs        the crate    the run's kernel        no         everywhere
//! bvh-crate    the crate    the run's kernel        no         everywhere
//! embree       the library  the library             no         where libembree4 or libembree3 is installed
//! ```
//!
//! A peer is bound by no rule of this crate's: its box tests are not conservative, and where it brings its own
//! ray/triangle test no kernel decides. So its answers are judged by the oracle, its wrong ones are counted and shown,
//! and nothing is asserted of them beyond that it does not panic. It counts no work, and what it does not tell stays
//! unknown rather than 0.
//!
//! **Differs** from the libraries' own programs only where their contract is narrower than ours: a ray whose interval
//! begins before 0 is moved forward first ([`forward`]), since all of them leave negative `t` undefined.

#![doc = include_str!("figures.md")]

mod bvh_crate;
mod embree;
mod obvhs;
mod tested;

use serde::Serialize;

use crate::geometry::{Aabb, Ray};
use crate::registry::Params;
use crate::scene::Mesh;

use super::BuildError;

pub(super) use bvh_crate::ENTRY as BVH_CRATE;
pub(super) use embree::ENTRY as EMBREE;
pub(super) use obvhs::ENTRY as OBVHS;

/// Greatest coordinate for builders whose areas overflow beyond, so that they panic or build trees that lead nowhere.
const FARTHEST: f32 = 1e18;

fn refuse_enormous(mesh: &Mesh, accel: &'static str) -> Result<(), BuildError> {
    if mesh.is_empty() || mesh.bounds().max_abs() <= FARTHEST {
        return Ok(());
    }
    Err(BuildError::Unfit {
        accel,
        why: format!("coordinates beyond {FARTHEST:e}, whose areas overflow in it"),
    })
}

/// What sets the structure of another library apart from raylab's own.
#[derive(Debug, Clone, Copy)]
pub struct Peer {
    /// Why it cannot be built on this machine, in one sentence with the remedy; `None` where it can.
    pub unavailable: fn() -> Option<String>,
    /// What the library's own ray/triangle test is called with these parameters; `None` where the run's kernel tests.
    pub own_test: fn(&Params) -> Option<&'static str>,
}

impl Peer {
    /// A peer that is compiled in and has the run's kernel test triangles.
    const COMPILED_IN: Self = Self {
        unavailable: || None,
        own_test: |_| None,
    };
}

/// What `list accels --json` says of a row beside its name, sentence and parameters.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Standing {
    /// Whether it is another library's.
    pub peer: bool,
    /// Whether it can be built on this machine.
    pub available: bool,
    /// Why not, with the remedy.
    pub unavailable_because: Option<String>,
    /// What its own ray/triangle test is called with default parameters, where the run's kernel does not test.
    pub own_test: Option<&'static str>,
}

impl Standing {
    /// That of a row with these parameters; `None`: raylab's own.
    pub(super) fn of(peer: Option<&Peer>, defaults: &Params) -> Self {
        let unavailable_because = peer.and_then(|peer| (peer.unavailable)());
        Self {
            peer: peer.is_some(),
            available: unavailable_because.is_none(),
            unavailable_because,
            own_test: peer.and_then(|peer| (peer.own_test)(defaults)),
        }
    }
}

/// `ray` as it goes on from the first `t` that matters and is not negative, and that `t`: 0, and the ray itself, unless
/// its interval begins before 0.
///
/// The new origin is rounded, so hits of a ray that was moved are off by some units in the last place.
fn forward(ray: &Ray, bounds: &Aabb) -> (Ray, f32) {
    if ray.t_min >= 0.0 {
        return (*ray, 0.0);
    }
    // Nothing lies before the point where the ray enters the sphere around the box, which is finite where `t_min` is not.
    let (origin, dir) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
    let (centre, length) = (bounds.centre().as_dvec3(), dir.length());
    let radius = 0.51 * bounds.extent().as_dvec3().length();
    let enters = ((centre - origin).dot(dir) / length - radius) / length;
    let start = f64::from(ray.t_min).max(enters).min(0.0) as f32;
    if !start.is_finite() {
        return (*ray, 0.0);
    }
    let moved = Ray {
        origin: (origin + dir * f64::from(start)).as_vec3(),
        dir: ray.dir,
        t_min: (ray.t_min - start).max(0.0),
        t_max: ray.t_max - start,
    };
    (moved, start)
}

#[cfg(test)]
mod tests {
    use crate::accel::testbed::{built, mesh, nasty, rays, soup, sphere};
    use crate::accel::{ACCELERATORS, AcceleratorEntry};
    use crate::geometry::{Hit, Vec3};
    use crate::registry::ParamKind;

    use super::*;

    /// Peers that can be built here, and their labels with each word of each parameter.
    fn labels() -> Vec<String> {
        let here = |entry: &&AcceleratorEntry| entry.standing().available;
        let peers = ACCELERATORS.iter().filter(|a| a.peer.is_some());
        peers
            .filter(here)
            .flat_map(|entry| {
                let words = entry.params.iter().flat_map(|spec| match spec.kind {
                    ParamKind::Choice(words) => words
                        .iter()
                        .map(|word| format!("{}:{}={word}", entry.name, spec.name))
                        .collect(),
                    _ => Vec::new(),
                });
                std::iter::once(entry.name.to_owned()).chain(words)
            })
            .collect()
    }

    #[test]
    fn what_cannot_be_built_here_says_what_to_install() {
        for entry in ACCELERATORS.iter().filter(|a| a.peer.is_some()) {
            let standing = entry.standing();
            assert!(standing.peer);
            assert_eq!(standing.available, standing.unavailable_because.is_none());
            if let Some(why) = standing.unavailable_because {
                println!("not tested here: {}: {why}", entry.name);
                assert!(why.contains("install"), "{why}");
            }
        }
        assert!(!ACCELERATORS[0].standing().peer);
    }

    #[test]
    fn across_a_closed_sphere_peers_agree_with_brute_force() {
        let mesh = mesh(&sphere(24));
        let brute = built(&mesh, "brute", "woop");
        // Off the poles' axis and off the planes of symmetry, no ray meets an edge.
        let rays: Vec<Ray> = (0..400)
            .map(|i| {
                let (a, b) = (i as f32 * 0.017 + 0.003, i as f32 * 0.71 + 0.1);
                let eye = 3.0 * Vec3::new(a.cos() * b.sin(), b.cos(), a.sin() * b.sin());
                let mut ray = Ray::new(eye, Vec3::new(0.11, -0.07, 0.05) - eye);
                match i % 4 {
                    0 => ray.t_min = 1.0,
                    1 => ray.t_max = 0.5,
                    2 => ray.t_min = -1.0,
                    _ => {}
                }
                ray
            })
            .collect();
        let mut expected = vec![Hit::MISS; rays.len()];
        brute.closest(&rays, &mut expected);
        assert!(expected.iter().any(Hit::is_hit) && !expected.iter().all(Hit::is_hit));
        for label in labels() {
            let peer = built(&mesh, &label, "woop");
            peer.validate().expect("valid");
            assert!(peer.memory_bytes() > 0, "{label}");
            let mut hits = vec![Hit::MISS; rays.len()];
            let mut blocked = vec![false; rays.len()];
            peer.closest(&rays, &mut hits);
            peer.occluded(&rays, &mut blocked);
            for (i, (hit, want)) in hits.iter().zip(&expected).enumerate() {
                let story = format!("{label}, {:?}: {hit:?} for {want:?}", rays[i]);
                assert_eq!(hit.prim, want.prim, "{story}");
                assert_eq!(blocked[i], want.is_hit(), "{story}");
                if want.is_hit() {
                    assert!((hit.t - want.t).abs() < 1e-5, "{story}");
                    assert!((hit.u - want.u).abs() < 1e-3, "{story}");
                    assert!((hit.v - want.v).abs() < 1e-3, "{story}");
                }
                assert_eq!(peer.inspect(&rays[i]).hit.prim, hit.prim);
            }
        }
    }

    #[test]
    fn batches_of_every_length_are_answered_whole() {
        let mesh = mesh(&soup(300, 0.4, 1));
        let rays = rays(&mesh, 40, 2);
        for label in labels() {
            let peer = built(&mesh, &label, "woop");
            let mut all = vec![Hit::MISS; rays.len()];
            peer.closest(&rays, &mut all);
            for length in [0, 1, 15, 16, 17, 33] {
                let mut hits = vec![Hit::MISS; length];
                peer.closest(&rays[..length], &mut hits);
                let prims = |hits: &[Hit]| hits.iter().map(|h| h.prim).collect::<Vec<_>>();
                assert_eq!(prims(&hits), prims(&all[..length]), "{label}");
            }
        }
    }

    #[test]
    fn traps_are_built_or_refused_and_traced_without_panic() {
        // A build of obvhs takes quadratic time over the thousands of equal triangles.
        for (name, mesh) in nasty().into_iter().filter(|(_, m)| m.len() < 1000) {
            let rays = rays(&mesh, 100, 3);
            for label in labels() {
                let peer = built(&mesh, &label, "woop");
                let mut hits = vec![Hit::MISS; rays.len()];
                peer.closest(&rays, &mut hits);
                let known = |hit: &Hit| !hit.is_hit() || (hit.prim as usize) < mesh.len();
                assert!(hits.iter().all(known), "{name}, {label}");
            }
        }
    }

    #[test]
    fn a_ray_that_begins_before_zero_is_moved_to_where_it_can_first_hit() {
        let bounds = Aabb::of_points([-Vec3::ONE, Vec3::ONE]);
        let mut ray = Ray::new(Vec3::new(10.0, 0.0, 0.0), Vec3::new(2.0, 0.0, 0.0));
        assert_eq!(forward(&ray, &bounds), (ray, 0.0));
        ray.t_min = -1.0;
        ray.t_max = 3.0;
        let (moved, start) = forward(&ray, &bounds);
        assert_eq!(
            (moved.origin.x, start, moved.t_min, moved.t_max),
            (8.0, -1.0, 0.0, 4.0)
        );
        ray.t_min = f32::NEG_INFINITY;
        let (moved, start) = forward(&ray, &bounds);
        // The box's sphere has a radius of √3.
        assert!((-1.8..-1.73).contains(&moved.origin.x), "{moved:?}");
        assert!((-5.9..-5.86).contains(&start));
        assert_eq!(moved.t_min, 0.0);
    }
}
