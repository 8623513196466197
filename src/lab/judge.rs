//! Whether answers are right: brute force with the same kernel on the same rays, and the oracle where they differ.

use std::sync::Arc;

use rayon::prelude::*;

use crate::accel::{self, Accelerator, BuildError};
use crate::geometry::Ray;
use crate::oracle::Oracle;
use crate::registry::Choice;
use crate::scene::Mesh;
use crate::trace::RaySet;

use super::Budget;
use super::accuracy::Truths;
use super::answers::{Answers, Findings};
use super::subset::{checked, stratified};

/// Most rays looked at where counted and timed answers differ: one would do to call a run invalid.
const MOST_DIFFERENCES: usize = 256;

/// The answers of brute force to some rays of a set, shared by all runs with the same scene, kernel and rays.
pub(super) struct Judge {
    mesh: Arc<Mesh>,
    oracle: Arc<Oracle>,
    brute: Box<dyn Accelerator>,
    set: Arc<RaySet>,
    /// Indices of the checked rays in the set, ascending.
    indices: Vec<usize>,
    rays: Vec<Ray>,
    answers: Answers,
}

impl Judge {
    /// Traces the checked rays by brute force, in the current rayon pool.
    pub fn new(
        mesh: &Arc<Mesh>,
        oracle: &Arc<Oracle>,
        kernel: &Choice,
        set: &Arc<RaySet>,
        budget: &Budget,
        seed: u64,
    ) -> Result<Self, BuildError> {
        let brute = accel::build(mesh, &accel::parse("brute")?, None, kernel, u64::MAX)?;
        let count = checked(set.rays.len(), mesh.len(), budget);
        let indices = stratified(set.rays.len(), count, seed);
        let rays: Vec<Ray> = indices.iter().map(|i| set.rays[*i]).collect();
        let answers = Answers::of(&*brute, set.query, &rays);
        Ok(Self {
            mesh: Arc::clone(mesh),
            oracle: Arc::clone(oracle),
            brute,
            set: Arc::clone(set),
            indices,
            rays,
            answers,
        })
    }

    /// How many rays are checked.
    pub fn checked_rays(&self) -> u64 {
        self.rays.len() as u64
    }

    /// Bytes that it holds in memory beside scene and ray set.
    pub fn bytes(&self) -> u64 {
        // An index at 8 bytes, a ray at 32 and a hit at 16.
        self.brute.memory_bytes() + 56 * self.rays.len() as u64
    }

    /// Judges `accel`: its answers to the whole set where it gave them, else it is asked for the checked rays.
    pub fn check(&self, accel: &dyn Accelerator, whole_set: Option<&Answers>) -> Findings {
        let others = match whole_set {
            Some(answers) => answers.pick(&self.indices),
            None => Answers::of(accel, self.set.query, &self.rays),
        };
        self.answers.judge(&self.oracle, &self.rays, &others)
    }

    /// On how many of the checked rays `accel`, which is bound by no rule, is wrong by the oracle: leaks, phantoms and
    /// wrong surfaces. Its answers to the whole set are taken where it gave them.
    pub fn wrong_answers(&self, accel: &dyn Accelerator, whole_set: Option<&Answers>) -> u64 {
        let answers = match whole_set {
            Some(answers) => answers.pick(&self.indices),
            None => Answers::of(accel, self.set.query, &self.rays),
        };
        match answers {
            Answers::Hits(hits) => {
                let truths = Truths::new(&self.oracle, &self.mesh, &self.rays);
                truths.wrong(&self.rays, &hits)
            }
            Answers::Blocked(blocked) => {
                let pairs = self.rays.par_iter().zip(&blocked);
                let wrong = pairs.filter(|(ray, blocked)| self.oracle.occluded(ray) != **blocked);
                wrong.count() as u64
            }
        }
    }

    /// Judges two lists of answers to `rays` where they differ, e.g. timed and counted ones: each must obey the rule.
    pub fn check_differences(&self, rays: &[Ray], a: &Answers, b: &Answers) -> Findings {
        let mut differences = a.differences(b);
        differences.truncate(MOST_DIFFERENCES);
        let mut findings = Findings::default();
        if !differences.is_empty() {
            let rays: Vec<Ray> = differences.iter().map(|i| rays[*i]).collect();
            let brute = Answers::of(&*self.brute, self.set.query, &rays);
            for answers in [a, b] {
                let others = answers.pick(&differences);
                findings.merge(brute.judge(&self.oracle, &rays, &others));
            }
        }
        findings
    }
}
