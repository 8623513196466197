//! Truth on the given `f32` numbers: what a ray really hits.
//!
//! A triangle is hit where the ray's line passes all its edges on one side or through them, in one point, with `t` in
//! `[t_min, t_max]`. In-plane rays and triangles without area are misses by definition. The nearest hits are found by
//! exact comparison; all triangles of equal least `t` are the *tie set*, and each of them is right.
//!
//! ```text
//! Oracle::truth(ray) -> Truth { t, tie_set }      [bvh]: candidates      [triangle]: exact judgement
//! arbitrate(brute, other) -> Verdict              the rule of the accelerators, as code
//! ```
//!
//! Independent of every kernel and accelerator: it shares no formula, box test or tree with them.

use std::cmp::Ordering;
use std::sync::{Arc, OnceLock};

use crate::geometry::{Hit, Ray};
use crate::scene::Mesh;

mod arbitrate;
mod bvh;
#[cfg(test)]
mod slow;
mod triangle;

pub use arbitrate::{Verdict, arbitrate, arbitrate_occluded};
pub use triangle::{ExactT, judge_triangle};

/// The exact truth about rays through one mesh.
#[derive(Debug)]
pub struct Oracle {
    mesh: Arc<Mesh>,
    /// Made when the first ray is judged: most checks never need one.
    bvh: OnceLock<bvh::Bvh>,
}

/// What a ray really hits.
#[derive(Debug, Clone)]
pub struct Truth {
    /// The least exact `t`; `None` for a miss.
    pub t: Option<ExactT>,
    /// All triangles hit at it, ascending; empty for a miss.
    pub tie_set: Vec<u32>,
}

impl Truth {
    /// The canonical answer: the lowest index of the tie set; `None` for a miss.
    #[must_use]
    pub fn canonical(&self) -> Option<u32> {
        self.tie_set.first().copied()
    }

    /// Whether anything is hit.
    #[must_use]
    pub fn is_hit(&self) -> bool {
        self.t.is_some()
    }

    /// Whether `hit` names a triangle of the tie set, or misses where nothing is hit. Its `t` is not looked at.
    #[must_use]
    pub fn allows(&self, hit: &Hit) -> bool {
        if hit.is_hit() {
            self.tie_set.binary_search(&hit.prim).is_ok()
        } else {
            !self.is_hit()
        }
    }
}

impl Oracle {
    /// The oracle of `mesh`. Costs nothing until the first ray is judged.
    #[must_use]
    pub fn new(mesh: &Arc<Mesh>) -> Self {
        Self {
            mesh: Arc::clone(mesh),
            bvh: OnceLock::new(),
        }
    }

    fn bvh(&self) -> &bvh::Bvh {
        self.bvh.get_or_init(|| bvh::Bvh::new(&self.mesh))
    }

    /// The nearest exact hits of a valid ray.
    #[must_use]
    pub fn truth(&self, ray: &Ray) -> Truth {
        let mut truth = Truth {
            t: None,
            tie_set: Vec::new(),
        };
        self.bvh().visit(ray, |prim| {
            if let Some(t) = judge_triangle(ray, &self.mesh.corners(prim)) {
                let order = truth.t.as_ref().map_or(Ordering::Less, |best| t.cmp(best));
                if order == Ordering::Less {
                    truth.t = Some(t);
                    truth.tie_set.clear();
                }
                if order != Ordering::Greater {
                    truth.tie_set.push(prim);
                }
            }
            truth.t.map_or(f64::INFINITY, |best| best.bounds().1)
        });
        truth.tie_set.sort_unstable();
        truth
    }

    /// Whether a valid ray hits anything within its interval.
    #[must_use]
    pub fn occluded(&self, ray: &Ray) -> bool {
        let mut blocked = false;
        self.bvh().visit(ray, |prim| {
            blocked = blocked || judge_triangle(ray, &self.mesh.corners(prim)).is_some();
            if blocked {
                f64::NEG_INFINITY
            } else {
                f64::INFINITY
            }
        });
        blocked
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::Vec3;

    fn oracle(triangles: &[[Vec3; 3]]) -> Oracle {
        let vertices = triangles.iter().flatten().copied().collect();
        let indices = (0..triangles.len() as u32)
            .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
            .collect();
        Oracle::new(&Arc::new(Mesh::new(vertices, indices).unwrap()))
    }

    #[test]
    fn nothing_is_hit_in_an_empty_mesh() {
        let empty = oracle(&[]);
        let ray = Ray::new(Vec3::ZERO, Vec3::X);
        assert!(!empty.truth(&ray).is_hit());
        assert!(!empty.occluded(&ray));
        assert!(empty.truth(&ray).allows(&Hit::MISS));
    }

    #[test]
    fn duplicates_are_one_tie_set_and_its_lowest_index_is_canonical() {
        let twice = oracle(&[[Vec3::ZERO, Vec3::X, Vec3::Y]; 7]);
        let truth = twice.truth(&Ray::new(Vec3::new(0.1, 0.3, 1.0), -Vec3::Z));
        assert_eq!(truth.tie_set, [0, 1, 2, 3, 4, 5, 6]);
        assert_eq!(truth.canonical(), Some(0));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1500))]

        #[test]
        fn the_truth_agrees_with_brute_force_on_big_rationals((ray, mesh) in slow::settings(30)) {
            let oracle = oracle(&mesh);
            let truth = oracle.truth(&ray);
            let ties = slow::truth(&ray, &mesh).map_or(Vec::new(), |(_, ties)| ties);
            prop_assert_eq!(oracle.occluded(&ray), !ties.is_empty());
            prop_assert_eq!(truth.is_hit(), !ties.is_empty());
            prop_assert_eq!(truth.tie_set, ties);
        }
    }
}
