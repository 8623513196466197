//! What is wrong with answers: a kernel's by the oracle, an accelerator's by brute force where that is right.

use crate::accel::{self, Accelerator};
use crate::geometry::{Hit, Ray};
use crate::lab::accuracy::judge::{Truths, Worth};
use crate::oracle::{self, Oracle, Verdict, judge_triangle};
use crate::registry::Choice;

use super::case::{Setting, mesh};
use super::model::{Fault, Faults};

/// A scene and its rays with the truth about them.
#[derive(Debug)]
pub(super) struct Bench {
    pub setting: Setting,
    oracle: Oracle,
    truths: Truths,
}

/// Answers to both queries about the rays of a bench.
#[derive(Debug, Clone)]
pub(super) struct Answers {
    hits: Vec<Hit>,
    blocked: Vec<bool>,
}

/// What is wrong with answers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Found {
    pub faults: Faults,
    /// The first ray with a fault.
    pub first: Option<(usize, Fault)>,
}

impl Found {
    fn add(&mut self, ray: usize, fault: Fault) {
        self.faults.add(fault);
        self.first.get_or_insert((ray, fault));
    }

    /// A structure that breaks its promises.
    pub fn invalid(mut self) -> Self {
        self.faults.add(Fault::Invalid);
        self.first.get_or_insert((0, Fault::Invalid));
        self
    }
}

impl Answers {
    /// Asks `accel` both queries in one batch.
    pub fn of(accel: &dyn Accelerator, rays: &[Ray]) -> Self {
        let mut answers = Self {
            hits: vec![Hit::MISS; rays.len()],
            blocked: vec![false; rays.len()],
        };
        accel.closest(rays, &mut answers.hits);
        accel.occluded(rays, &mut answers.blocked);
        answers
    }
}

impl Bench {
    /// Asks the oracle.
    pub fn new(setting: Setting) -> Self {
        let oracle = Oracle::new(&setting.mesh);
        let truths = Truths::new(&oracle, &setting.mesh, &setting.rays);
        Self {
            setting,
            oracle,
            truths,
        }
    }

    /// Judges brute force: the kernel itself.
    pub fn judge_kernel(&self, answers: &Answers) -> Found {
        let mut found = Found::default();
        for (i, ray) in self.setting.rays.iter().enumerate() {
            let hit = &answers.hits[i];
            if let Some(fault) = self.fault(i, ray, hit) {
                found.add(i, fault);
            } else if hit.is_hit() != answers.blocked[i] {
                found.add(i, Fault::Occlusion);
            }
        }
        found
    }

    /// What is wrong with a nearest hit by the oracle. A neighbour beside the true triangle at the same place is not.
    fn fault(&self, i: usize, ray: &Ray, hit: &Hit) -> Option<Fault> {
        match self.truths.worth_of(i, ray, hit) {
            Worth::Leak => Some(Fault::Leak),
            Worth::Phantom => Some(Fault::Phantom),
            Worth::WrongSurface => Some(Fault::WrongSurface),
            Worth::Right => self.truths.astray(i, ray, hit).then_some(Fault::Astray),
            Worth::RightMiss | Worth::NeighbourSwap => None,
        }
    }

    /// Judges an accelerator by brute force with the same kernel.
    pub fn judge_accel(&self, kernel: &Choice, brute: &Answers, other: &Answers) -> Found {
        let mut found = Found::default();
        for (i, ray) in self.setting.rays.iter().enumerate() {
            let (hit, expected) = (&other.hits[i], &brute.hits[i]);
            let closest = oracle::arbitrate(&self.oracle, ray, expected, hit);
            let occlusion =
                self.arbitrate_occluded(kernel, ray, brute.blocked[i], other.blocked[i]);
            let erred = [closest, occlusion].contains(&Verdict::KernelError);
            if closest == Verdict::Broken {
                found.add(i, self.fault(i, ray, hit).unwrap_or(Fault::Differs));
            } else if occlusion == Verdict::Broken || (!erred && other.blocked[i] != hit.is_hit()) {
                found.add(i, Fault::Occlusion);
            }
        }
        found
    }

    /// As [`oracle::arbitrate_occluded`]; but brute force that says "blocked" is right only if the kernel finds something
    /// among what is really hit, and not a phantom instead.
    fn arbitrate_occluded(&self, kernel: &Choice, ray: &Ray, brute: bool, other: bool) -> Verdict {
        let verdict = oracle::arbitrate_occluded(&self.oracle, ray, brute, other);
        if verdict == Verdict::Broken && brute && !self.rightly_blocked(kernel, ray) {
            Verdict::KernelError
        } else {
            verdict
        }
    }

    /// Whether `kernel` finds anything among the triangles that `ray` really hits.
    fn rightly_blocked(&self, kernel: &Choice, ray: &Ray) -> bool {
        let mesh = &self.setting.mesh;
        let corners = (0..mesh.len() as u32).map(|prim| mesh.corners(prim));
        let hit: Vec<_> = corners
            .filter(|c| judge_triangle(ray, c).is_some())
            .collect();
        let mut blocked = [false];
        if let Ok(brute) = accel::parse(super::BRUTE)
            && let Ok(brute) = accel::build(&self::mesh(&hit), &brute, None, kernel, u64::MAX)
        {
            brute.occluded(&[*ray], &mut blocked);
        }
        blocked[0]
    }
}
