//! What the oracle says of each ray of a set, kept small: sets have up to tens of millions of rays, and every kernel in
//! every accelerator is judged by the same truths.

use rayon::prelude::*;

use crate::geometry::Ray;
use crate::oracle::Oracle;
use crate::trace::BATCH;

/// The truth of one ray: 16 bytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Truth {
    /// Nearest exact t to about 50 bits; meaningless for a miss.
    pub t: f64,
    /// Lowest index of the tie set; [`Truth::MISS`] where nothing is hit.
    pub first: u32,
    /// Index of the rest of the tie set; [`Truth::ALONE`] where there is none.
    others: u32,
}

impl Truth {
    /// `first` of a ray that misses.
    pub const MISS: u32 = u32::MAX;
    /// `others` of a hit in one triangle.
    const ALONE: u32 = u32::MAX;

    /// Whether anything is hit.
    pub fn is_hit(&self) -> bool {
        self.first != Self::MISS
    }

    /// Whether the nearest hit lies in several triangles.
    pub fn is_tie(&self) -> bool {
        self.others != Self::ALONE
    }
}

/// The truths of a batch of rays.
#[derive(Debug, Default)]
pub(super) struct TruthBatch {
    pub truths: Vec<Truth>,
    /// Tie sets without their lowest index, ascending.
    ties: Vec<Box<[u32]>>,
}

impl TruthBatch {
    /// Asks the oracle.
    pub fn of(oracle: &Oracle, rays: &[Ray]) -> Self {
        let mut batch = Self::default();
        for ray in rays {
            let truth = oracle.truth(ray);
            let known = match (truth.t, truth.tie_set.as_slice()) {
                (Some(t), [first, others @ ..]) => {
                    let index = if others.is_empty() {
                        Truth::ALONE
                    } else {
                        batch.ties.push(others.into());
                        batch.ties.len() as u32 - 1
                    };
                    Truth {
                        t: t.to_f64(),
                        first: *first,
                        others: index,
                    }
                }
                _ => Truth {
                    t: f64::INFINITY,
                    first: Truth::MISS,
                    others: Truth::ALONE,
                },
            };
            batch.truths.push(known);
        }
        batch
    }

    /// Whether `prim` is in the tie set of `truth`, which is one of this batch and a hit.
    pub fn allows(&self, truth: &Truth, prim: u32) -> bool {
        prim == truth.first || self.others(truth).binary_search(&prim).is_ok()
    }

    /// The tie set of `truth`, which is one of this batch and a hit.
    pub fn tie_set(&self, truth: &Truth) -> impl Iterator<Item = u32> {
        std::iter::once(truth.first).chain(self.others(truth).iter().copied())
    }

    fn others(&self, truth: &Truth) -> &[u32] {
        self.ties.get(truth.others as usize).map_or(&[], |o| o)
    }
}

/// Asks the oracle about all rays, in the current rayon pool; one batch for each [`BATCH`] rays.
pub(super) fn batches(oracle: &Oracle, rays: &[Ray]) -> Vec<TruthBatch> {
    rays.par_chunks(BATCH)
        .with_max_len(1)
        .map(|rays| TruthBatch::of(oracle, rays))
        .collect()
}
