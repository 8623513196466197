//! The least scene and the one ray on which a cell still fails: what `inspect` can step through.
//!
//! ```text
//! 300 triangles, ray 17 ──leave out halves, quarters, … single triangles──▶ 1 to 3 triangles, the same fault
//! ```
//!
//! **Source:** A. Zeller and R. Hildebrandt, "Simplifying and Isolating Failure-Inducing Input", IEEE TSE 28(2), 2002.
//! **Differs:** only complements are tried, each once a size: what is left is small, not always the smallest.

use std::sync::Arc;

use crate::accel;
use crate::geometry::Ray;
use crate::kernel;
use crate::registry::Choice;
use crate::scene::Mesh;

use super::case::{Setting, case};
use super::judge::{Answers, Bench};
use super::model::{Cell, Fault, Witness};
use super::run::built;

/// A scene and rays on which a kernel or an accelerator fails.
#[derive(Debug, Clone)]
pub struct Reproducer {
    /// The kernel.
    pub kernel: Choice,
    /// The accelerator; brute force where the kernel itself fails.
    pub accel: Choice,
    /// The case.
    pub case: &'static str,
    /// Its rung, `offset 1e4`; empty where it has one only.
    pub rung: String,
    /// How the answer is wrong.
    pub fault: Fault,
    /// The triangles that are left.
    pub mesh: Arc<Mesh>,
    /// Their indices in the scene of the case.
    pub prims: Vec<u32>,
    /// The ray; all rays of the rung where one alone does not fail.
    pub rays: Vec<Ray>,
    /// The resolution at which accelerators that have one are built.
    pub n: u32,
}

/// Makes the failure of `cell` again, from the same seed as its map, and leaves out what it does not need. `None` where
/// the cell does not fail.
#[must_use]
pub fn reproduce(cell: &Cell, seed: u64) -> Option<Reproducer> {
    let Witness { rung, ray, fault } = cell.witness?;
    let case = case(cell.case).ok()?;
    let setting = case.setting(rung, seed);
    let trial = Trial {
        kernel: kernel::parse(&cell.kernel).ok()?,
        accel: accel::parse(&cell.accel).ok()?,
        fault,
        rays: vec![*setting.rays.get(ray)?],
        setting: &setting,
    };
    let all: Vec<u32> = (0..setting.mesh.len() as u32).collect();
    let (prims, rays) = if trial.fails(&all) {
        (trial.least(all), trial.rays)
    } else {
        (all, setting.rays.clone())
    };
    Some(Reproducer {
        kernel: trial.kernel,
        accel: trial.accel,
        case: case.name,
        rung: case.label(rung),
        fault,
        mesh: part(&setting.mesh, &prims),
        prims,
        rays,
        n: setting.n,
    })
}

/// The triangles with these indices, in this order.
fn part(mesh: &Mesh, prims: &[u32]) -> Arc<Mesh> {
    let corners: Vec<_> = prims.iter().map(|&prim| mesh.corners(prim)).collect();
    super::case::mesh(&corners)
}

/// A failure that is made again with fewer triangles.
struct Trial<'a> {
    kernel: Choice,
    accel: Choice,
    fault: Fault,
    rays: Vec<Ray>,
    setting: &'a Setting,
}

impl Trial<'_> {
    /// Whether these triangles show the fault.
    fn fails(&self, prims: &[u32]) -> bool {
        let bench = Bench::new(Setting {
            mesh: part(&self.setting.mesh, prims),
            rays: self.rays.clone(),
            n: self.setting.n,
        });
        self.fault_on(&bench) == Some(self.fault)
    }

    /// What is wrong on `bench`.
    fn fault_on(&self, bench: &Bench) -> Option<Fault> {
        let brute = Choice {
            name: super::BRUTE.to_owned(),
            ..self.accel.clone()
        };
        let answers = |accel| {
            let built = built(bench, accel, &self.kernel).ok()?;
            let answers = Answers::of(&*built, &bench.setting.rays);
            Some((answers, built.validate().is_err()))
        };
        let (expected, _) = answers(&brute)?;
        let found = if self.accel.name == super::BRUTE {
            bench.judge_kernel(&expected)
        } else {
            let (told, invalid) = answers(&self.accel)?;
            if invalid && self.fault == Fault::Invalid {
                return Some(Fault::Invalid);
            }
            bench.judge_accel(&self.kernel, &expected, &told)
        };
        found.first.map(|(_, fault)| fault)
    }

    /// Leaves out runs of triangles, ever shorter ones, where the rest still fails.
    fn least(&self, mut prims: Vec<u32>) -> Vec<u32> {
        let mut run = prims.len().div_ceil(2);
        while run > 0 {
            let mut start = 0;
            while start < prims.len() && prims.len() > 1 {
                let end = (start + run).min(prims.len());
                let rest = [&prims[..start], &prims[end..]].concat();
                if self.fails(&rest) {
                    prims = rest;
                } else {
                    start = end;
                }
            }
            run /= 2;
        }
        prims
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::Control;
    use crate::lab::stability::{StabilityPlan, stability};

    #[test]
    fn a_leak_of_a_thousand_triangles_is_one_of_a_few() {
        let plan = StabilityPlan {
            cases: vec!["closed-edges"],
            kernels: vec![kernel::parse("moller-trumbore").unwrap()],
            accels: Vec::new(),
            ..StabilityPlan::default()
        };
        let map = stability(&plan, &Control::default(), &mut |_| {}).unwrap();
        let cell = &map.cells[0];
        assert!(cell.faults.leaks > 0);
        let least = reproduce(cell, 1).unwrap();
        assert_eq!((least.fault, least.rays.len()), (Fault::Leak, 1));
        assert!(least.mesh.len() <= 2, "{}", least.mesh.len());
        // By the oracle the ray hits what is left, and the kernel says that it does not.
        let oracle = crate::oracle::Oracle::new(&least.mesh);
        assert!(oracle.occluded(&least.rays[0]));
        let brute = accel::build(&least.mesh, &least.accel, None, &least.kernel, 1 << 20);
        let mut blocked = [true];
        brute.unwrap().occluded(&least.rays, &mut blocked);
        assert!(!blocked[0]);
    }

    #[test]
    fn a_cell_that_is_right_has_nothing_to_reproduce() {
        let plan = StabilityPlan {
            cases: vec!["ordinary"],
            kernels: vec![kernel::parse("woop").unwrap()],
            accels: Vec::new(),
            ..StabilityPlan::default()
        };
        let map = stability(&plan, &Control::default(), &mut |_| {}).unwrap();
        assert!(reproduce(&map.cells[0], 1).is_none());
    }
}
