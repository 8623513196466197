//! The way of one ray, recorded: every place that a traversal visits, and every triangle that it offers there.
//!
//! ```text
//! visits:  | node 0 | node 1 | leaf 4 | leaf 7 |      each with entry and exit t, references, bounds
//!                               |        |
//! tests:                        miss     nearest 1.5 · hit 2.25 · skipped
//! ```
//!
//! The record is a counter as the others are: what is recorded is the traversal that is timed, not a twin of it.

use serde::Serialize;

use crate::geometry::{Aabb, Hit};

use super::visit::Watch;

/// What a traversal visits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlaceKind {
    /// A region of a grid.
    Cell,
    /// An interior node of a tree: lists no triangles.
    Node,
    /// What lists triangles outside grids.
    Leaf,
}

impl PlaceKind {
    /// The field's word for it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Cell => "cell",
            Self::Node => "node",
            Self::Leaf => "leaf",
        }
    }
}

/// How a triangle that was offered fared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// The kernel found no hit.
    Miss,
    /// A hit, but outside the ray's interval or not nearer than the best so far.
    Hit,
    /// A hit that became the nearest.
    Nearest,
    /// Not tested, because this ray had tested it before.
    Skipped,
}

impl Outcome {
    /// One word for it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Miss => "miss",
            Self::Hit => "hit",
            Self::Nearest => "nearest",
            Self::Skipped => "skipped",
        }
    }
}

/// A triangle that a place offered.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Test {
    /// Its index in file order.
    pub prim: u32,
    /// How it fared.
    pub outcome: Outcome,
    /// The kernel's `t`, where it found a hit.
    pub t: Option<f32>,
}

/// A cell or node that the ray visited: one traversal step.
#[derive(Debug, Clone, PartialEq)]
pub struct Visit {
    /// What it is.
    pub kind: PlaceKind,
    /// Which one: the index of a cell (x fastest) or of a node.
    pub place: u64,
    /// The ray's `t` where it enters, as the structure computed it.
    pub entry: f64,
    /// The ray's `t` where it leaves; may be infinite.
    pub exit: f64,
    /// Triangles that it lists.
    pub references: u32,
    /// Its box, where the structure knows it; without the pads that make it conservative.
    pub bounds: Option<Aabb>,
    /// What it offered until the traversal went on, in order.
    pub tests: Vec<Test>,
}

/// All that a closest-hit query did.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// The traversal's steps, in order.
    pub visits: Vec<Visit>,
    /// Its answer.
    pub hit: Hit,
}

/// Records one ray.
pub(super) struct Recorder {
    pub visits: Vec<Visit>,
    /// What this structure's leaves are called.
    leaf: PlaceKind,
}

impl Recorder {
    pub fn new(leaf: PlaceKind) -> Self {
        Self {
            visits: Vec::new(),
            leaf,
        }
    }

    /// Adds to the latest visit; what is offered before any place is visited would belong to none.
    fn offered(&mut self, test: Test) {
        debug_assert!(!self.visits.is_empty(), "a test outside every place");
        if let Some(visit) = self.visits.last_mut() {
            visit.tests.push(test);
        }
    }
}

impl Watch for Recorder {
    fn step(&mut self, place: u64, leaf: bool, references: u32, entry: f64, exit: f64) {
        self.visits.push(Visit {
            kind: if leaf { self.leaf } else { PlaceKind::Node },
            place,
            entry,
            exit,
            references,
            bounds: None,
            tests: Vec::new(),
        });
    }

    fn test(&mut self, prim: u32, t: Option<f32>, nearest: bool) {
        let outcome = match t {
            None => Outcome::Miss,
            Some(_) if nearest => Outcome::Nearest,
            Some(_) => Outcome::Hit,
        };
        self.offered(Test { prim, outcome, t });
    }

    fn skipped(&mut self, prim: u32) {
        self.offered(Test {
            prim,
            outcome: Outcome::Skipped,
            t: None,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::testbed::{built, mesh, nasty, rays, soup, sphere};
    use super::super::{ACCELERATORS, Counts};
    use super::*;

    /// Names of all accelerators of our own, and the grid without mailboxes.
    fn accels() -> impl Iterator<Item = &'static str> {
        ACCELERATORS
            .iter()
            .filter(|a| a.peer.is_none())
            .map(|a| a.name)
            .chain(["grid:mailbox=off"])
    }

    #[test]
    fn what_is_recorded_is_what_is_answered_and_counted() {
        let mut meshes = nasty();
        meshes.push(("sphere", mesh(&sphere(8))));
        // Brute force of the largest would record millions of tests.
        for (name, mesh) in meshes.iter().filter(|(_, m)| m.len() < 1000) {
            for accel in accels() {
                let accelerator = built(mesh, accel, "woop");
                for ray in rays(mesh, 40, 3) {
                    let (mut hit, mut counts) = ([Hit::MISS], [Counts::default()]);
                    accelerator.closest(&[ray], &mut hit);
                    let record = accelerator.inspect(&ray);
                    assert!(record.hit.same_answer(&hit[0]), "{name}, {accel}, {ray:?}");
                    assert_eq!(record.hit.u.to_bits(), hit[0].u.to_bits());
                    assert_eq!(record.hit.v.to_bits(), hit[0].v.to_bits());

                    accelerator.closest_counted(&[ray], &mut hit, &mut counts);
                    let all = || record.visits.iter().flat_map(|v| &v.tests);
                    let tested = all().filter(|t| t.outcome != Outcome::Skipped).count();
                    let empty = |v: &&Visit| v.kind != PlaceKind::Node && v.references == 0;
                    assert_eq!(record.visits.len() as u64, counts[0].steps);
                    assert_eq!(
                        record.visits.iter().filter(empty).count() as u64,
                        counts[0].empty_steps
                    );
                    assert_eq!(tested as u64, counts[0].tests);
                    // The last test that became the nearest is the answer.
                    let last = all().rfind(|t| t.outcome == Outcome::Nearest);
                    assert_eq!(
                        last.map(|t| (t.prim, t.t)),
                        record
                            .hit
                            .is_hit()
                            .then_some((record.hit.prim, Some(record.hit.t)))
                    );
                }
            }
        }
    }

    #[test]
    fn a_mailbox_skips_what_was_tested_and_only_where_it_is_on() {
        // Triangles far larger than a cell lie in many.
        let mesh = mesh(&soup(200, 1.0, 4));
        let skipped = |accel| -> usize {
            let accelerator = built(&mesh, accel, "woop");
            let outcomes = rays(&mesh, 50, 5).into_iter().flat_map(|ray| {
                let tests = accelerator.inspect(&ray).visits.into_iter();
                tests.flat_map(|visit| visit.tests).map(|test| test.outcome)
            });
            outcomes.filter(|o| *o == Outcome::Skipped).count()
        };
        assert!(skipped("grid") > 0);
        assert_eq!(skipped("grid:mailbox=off"), 0);
        assert_eq!(skipped("bvh"), 0);
    }

    #[test]
    fn the_ray_is_within_the_bounds_of_each_place_from_entry_to_exit() {
        let mesh = mesh(&sphere(12));
        for accel in ["grid", "kd-tree", "octree", "bsp-tree", "bvh"] {
            let accelerator = built(&mesh, accel, "woop");
            for ray in rays(&mesh, 200, 6) {
                for visit in accelerator.inspect(&ray).visits {
                    let bounds = visit.bounds.expect("each of these knows its places");
                    // The ends of the interval are computed; its middle, seen from far, is as sure as its point.
                    let middle = visit.entry.midpoint(visit.exit);
                    let point = ray.origin.as_dvec3() + ray.dir.as_dvec3() * middle;
                    let error = 1e-5 * (1.0 + point.abs().max_element());
                    let inside = point.cmpge(bounds.min.as_dvec3() - error)
                        & point.cmple(bounds.max.as_dvec3() + error);
                    assert!(inside.all(), "{accel}, {ray:?}: {visit:?}");
                }
            }
        }
    }
}
