//! The structure that is predicted to be the fastest for a mesh, chosen by looking at its triangles once.
//!
//! ```text
//! triangles        at most 1 ───────────────────────────────────────────▶ brute
//! B, the large     at most 1: triangles are small beside their distances ▶ bvh-wide, build=presplit
//! boxes            at most 4: some are large, and in the way             ▶ bvh-wide, build=reinsert
//!                  more: large ones lie across each other                ▶ bvh-wide, build=sbvh-reinsert
//! ```
//!
//! With A half the surface of the scene's box and N triangles, a box is large whose half surface is more than 64 A / N, that is
//! where its edges are eight times as long as if all boxes shared the scene's surface. B is the sum of the half surfaces of
//! the large ones, in units of A: as many of them does a random line through the scene meet. Where that is much, boxes of
//! nodes overlap however triangles are sorted; to cut triangles and to move subtrees then costs several builds' time
//! and saves more, where rays are many.
//!
//! **Source:** none. The limits 64, 1 and 4 were fitted by measuring, on scenes of which some stand below; so it is no proof
//! for others.
//!
//! **Regret:** by how much the best of `bvh-wide` with any `build`, `grid-skip` and, up to four triangles, `brute` was faster
//! than the pick; and the pick's speed to that of `bvh-wide` with its defaults. One thread, kernel `woop`, geometric means of
//! rays a second of CPU time over primary, bounce and random; differences below 2 % are noise. `kd-tree` was never near.
//!
//! | scene | picked | best | regret | to the defaults |
//! |---|---|---|---|---|
//! | `one` | `brute` | `brute` | 0 % | 1.56 |
//! | `soup:2`, `soup:4` | `presplit` | all alike | 1 %, 2 % | 1 |
//! | `soup:10000` | `presplit` | all alike | 1 % | 1 |
//! | Stanford bunny | `presplit` | `sbvh` | 2 % | 1 |
//! | `teapot` | `presplit` | all alike | 1 % | 1 |
//! | `cornell` | `reinsert` | all alike | 0 % | 1.01 |
//! | `caballito` | `reinsert` | `sbvh-reinsert` | 3 % | 1.06 |
//! | `city:100` | `reinsert` | `reinsert` | 0 % | 1.04 |
//! | `sphereflake:3` | `reinsert` | all alike | 0 % | 1.00 |
//! | `tree:10` | `reinsert` | `sbvh` | 5 % | 0.98 |
//! | `staircase` | `sbvh-reinsert` | `sbvh` | 1 % | 1.07 |
//! | `plant` | `sbvh-reinsert` | `grid-skip` | 1 % | 1.23 |
//! | `lattice:20` | `sbvh-reinsert` | all alike | 0 % | 1.01 |
//! | two-cylinder engine | `sbvh-reinsert` | `sbvh` | 0 % | 1.21 |
//! | kitchen | `sbvh-reinsert` | `sbvh-reinsert` | 0 % | 1.17 |
//! | CAD counter | `sbvh-reinsert` | `sbvh` | 3 % | 1.10 |
//! | Crytek Sponza | `sbvh-reinsert` | `sbvh-reinsert` | 0 % | 1.05 |
//!
//! Build time is not weighed: `bvh-wide` with its defaults is what is soonest built.

use crate::registry::{Choice, Params, Value};
use crate::scene::Mesh;

use super::parallel;
use super::sah::half_area;
use super::{AcceleratorEntry, BuildRequest, brute, bvh_wide};

pub(super) const ENTRY: AcceleratorEntry = AcceleratorEntry {
    name: "auto",
    about: "The structure that is predicted to trace this scene fastest, picked by the number and the sizes of its triangles.",
    paper: "",
    params: &[],
    control: false,
    resolution: None,
    peer: None,
    build: |request| {
        let pick = Pick::of(request.mesh);
        let choice = pick.choice();
        (pick.entry().build)(&BuildRequest {
            params: &choice.params,
            ..*request
        })
    },
};

/// Up to this many triangles no structure pays: two are tested at once by a block of `bvh-wide`.
const FEW: usize = 1;

/// How much larger than its share of the scene's surface a large box is.
const LARGE: f64 = 64.0;

/// From so many large boxes across a random line on, subtrees are moved; and triangles cut.
const MOVE: f64 = 1.0;
const CUT: f64 = 4.0;

/// Triangles whose sizes are summed by one thread: the sums do not depend on how many threads there are.
const CHUNK: usize = 1 << 14;

/// What can be picked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pick {
    Brute,
    Wide(&'static str),
}

impl Pick {
    /// The pick for `mesh`, in time O(N).
    fn of(mesh: &Mesh) -> Self {
        if mesh.len() <= FEW {
            return Self::Brute;
        }
        let large = large_boxes(mesh);
        // NaN, of a scene without a surface, is none of both.
        Self::Wide(if large > CUT {
            "sbvh-reinsert"
        } else if large > MOVE {
            "reinsert"
        } else {
            "presplit"
        })
    }

    fn entry(self) -> &'static AcceleratorEntry {
        match self {
            Self::Brute => &brute::ENTRY,
            Self::Wide(_) => &bvh_wide::ENTRY,
        }
    }

    fn choice(self) -> Choice {
        let entry = self.entry();
        let mut choice = Choice {
            name: entry.name.to_owned(),
            params: Params::defaults(entry.params),
        };
        if let Self::Wide(build) = self {
            choice.params.insert("build", Value::Text(build.to_owned()));
        }
        choice
    }
}

/// What `auto` picks for `mesh`, as it is written on the command line; `None` where `accel` is another accelerator.
#[must_use]
pub fn picked(accel: &Choice, mesh: &Mesh) -> Option<String> {
    let pick = (accel.name == ENTRY.name).then(|| Pick::of(mesh))?;
    Some(pick.choice().label(pick.entry().params))
}

/// The half surfaces of all large boxes, in units of the scene's: B above. NaN where the scene's box has no surface.
fn large_boxes(mesh: &Mesh) -> f64 {
    let scene = half_area(&mesh.bounds());
    let least = LARGE * scene / mesh.len() as f64;
    let sums = parallel::ranges(mesh.len(), CHUNK, |prims| {
        prims
            .map(|prim| half_area(&mesh.triangle_bounds(prim as u32)))
            .filter(|area| *area > least)
            .sum::<f64>()
    });
    sums.iter().sum::<f64>() / scene
}

#[cfg(test)]
mod tests {
    use super::super::testbed::{
        assert_agrees_on_nasty, assert_same_on_threads, built, mesh, nasty, soup, sphere,
    };
    use super::super::{ACCELERATORS, parse};
    use super::*;
    use crate::geometry::Vec3;

    fn pick(mesh: &Mesh) -> String {
        picked(&parse("auto").expect("known"), mesh).expect("auto picks")
    }

    /// `count` squares of two triangles across the whole scene, slightly turned, so that their boxes overlap.
    fn walls(count: u32) -> Vec<[Vec3; 3]> {
        let corner = |i: u32, x: f32, y: f32| {
            let z = i as f32 / count as f32;
            Vec3::new(x, y, z + 0.3 * x - 0.3 * y)
        };
        (0..count)
            .flat_map(|i| {
                let [a, b, c, d] =
                    [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| corner(i, x, y));
                [[a, b, c], [a, c, d]]
            })
            .collect()
    }

    #[test]
    fn the_number_and_the_sizes_of_triangles_decide() {
        assert_eq!(pick(&mesh(&[])), "brute");
        assert_eq!(pick(&mesh(&soup(1, 0.5, 1))), "brute");
        assert_eq!(pick(&mesh(&soup(2, 0.5, 1))), "bvh-wide");
        // Even triangles, however many and however small.
        assert_eq!(pick(&mesh(&sphere(64))), "bvh-wide");
        assert_eq!(pick(&mesh(&soup(5000, 0.01, 1))), "bvh-wide");
        // Two, and four, walls of a room full of small things.
        let furnished = |count| {
            let mut triangles = walls(count);
            triangles.extend(sphere(64).iter().map(|t| t.map(|p| 0.4 * (p + Vec3::ONE))));
            pick(&mesh(&triangles))
        };
        assert_eq!(furnished(2), "bvh-wide:build=reinsert");
        assert_eq!(furnished(8), "bvh-wide:build=sbvh-reinsert");
    }

    #[test]
    fn what_is_built_is_what_is_picked() {
        let mut triangles = walls(8);
        triangles.extend(sphere(64));
        for mesh in [mesh(&triangles), mesh(&soup(1, 0.5, 1)), mesh(&sphere(32))] {
            let [auto, picked] = ["auto", &pick(&mesh)].map(|accel| built(&mesh, accel, "woop"));
            assert_eq!(auto.stats(), picked.stats());
            assert_eq!(auto.memory_bytes(), picked.memory_bytes());
        }
    }

    #[test]
    fn only_auto_picks_and_picks_by_the_mesh_alone() {
        let mesh = mesh(&walls(30_000));
        assert_same_on_threads(|| (pick(&mesh), large_boxes(&mesh).to_bits()));
        for entry in ACCELERATORS.iter().filter(|a| a.name != "auto") {
            assert_eq!(picked(&parse(entry.name).expect("known"), &mesh), None);
        }
    }

    #[test]
    fn a_scene_without_a_surface_is_no_trap() {
        for (name, mesh) in nasty() {
            let picked = parse(&pick(&mesh)).unwrap_or_else(|why| panic!("{name}: {why}"));
            assert_ne!(picked.name, "auto");
        }
    }

    #[test]
    fn nasty_meshes_are_answered_as_by_brute_force() {
        assert_agrees_on_nasty("auto");
    }
}
