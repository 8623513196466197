//! Rays from one origin go through a structure together, as long as that costs less than going alone.
//!
//! A packet is a run of rays of the batch: 64, which of a picture's rays are a square of 8 × 8 pixels, or 16. Where
//! triangles are smaller than the packet, its rays test each other's triangles, and it collapses: then it gives up, its
//! rays go alone, and so do others after it. What it cost decides how many rays the next one has.

use std::ops::Range;

use crate::geometry::Ray;
use crate::geometry::lanes::prefetch;

use super::batch::{Course, run_apart};
use super::packet::{MOST, VECTOR};
use super::{Rays, Structure, Visitor};

/// Cost of a ray in a packet of 64, about in nanoseconds, above which packets of 16 are better.
const TOO_WIDE: u32 = 15;

/// Cost of a ray in a packet of 16 below which 64 may go together.
const CHEAP: u32 = 12;

/// Rays that go alone until a packet is tried again: at first, and most, where it was tried in vain again and again.
const ALONE: Range<usize> = 256..8192;

/// Why rays are no packet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Refused {
    /// Their origins or what a kernel or structure asks of their directions differ, or numbers are at the ends of their range:
    /// others may be one.
    Unlike,
    /// They were, and it cost too much: so it will for their neighbours.
    TooDear,
}

/// A structure that packets can go through.
pub(super) trait Together: Structure {
    /// Traces the rays in `range` as a packet and returns what it cost.
    ///
    /// # Errors
    /// They cannot be one, or had better not.
    fn together<'a, R: Rays<'a>>(
        &self,
        batch: &mut R,
        range: Range<usize>,
        scratch: &mut Self::Scratch,
    ) -> Result<u32, Refused>;

    /// Traces the rays in `range` without making a packet of them: one after another.
    #[inline(always)]
    fn apart<'a, R: Rays<'a>>(
        &self,
        batch: &mut R,
        range: Range<usize>,
        scratch: &mut Self::Scratch,
    ) where
        Self: Sized,
    {
        alone(self, batch, range, scratch);
    }
}

/// Whether the rays of a sample start at one point.
pub(super) fn share_origin(rays: &[Ray]) -> bool {
    let mut sample = rays.iter().step_by(16);
    rays.len() > 1 && sample.all(|ray| ray.origin == rays[0].origin)
}

/// Traces all rays of `batch`, as packets where `packets` asks for them.
#[inline(always)]
pub(super) fn trace<'a, S: Together, R: Rays<'a>>(
    structure: &S,
    batch: &mut R,
    scratch: &mut S::Scratch,
    packets: bool,
) {
    let count = batch.rays().len();
    // Rays that ask only whether they are blocked rarely start at one point.
    if !(R::WAYS && R::Visitor::ORDERED && packets) {
        return alone(structure, batch, 0..count, scratch);
    }
    let mut start = 0;
    let mut size = VECTOR;
    let mut in_vain = ALONE.start;
    while start < count {
        let range = start..count.min(start + size);
        let rays = range.len() as u32;
        // The next packet's; the memory has time while this one is traced.
        let next = batch.rays().as_ptr().wrapping_add(range.end);
        prefetch(next, size * size_of::<Ray>());
        match structure.together(batch, range.clone(), scratch) {
            Ok(cost) => {
                start = range.end;
                in_vain = ALONE.start;
                if cost > TOO_WIDE * rays {
                    size = VECTOR;
                } else if cost < CHEAP * rays && start.is_multiple_of(MOST) {
                    // Whole squares only.
                    size = MOST;
                }
            }
            // Quarters may be of one mind.
            Err(_) if size > VECTOR => size = VECTOR,
            Err(Refused::Unlike) => {
                start = range.end;
                structure.apart(batch, range, scratch);
            }
            Err(Refused::TooDear) => {
                let apart = start..count.min(start + in_vain);
                in_vain = ALONE.end.min(2 * in_vain);
                start = apart.end;
                structure.apart(batch, apart, scratch);
            }
        }
    }
}

/// Traces the rays in `range` one after another.
#[inline(always)]
pub(super) fn alone<'a, S: Structure, R: Rays<'a>>(
    structure: &S,
    batch: &mut R,
    range: Range<usize>,
    scratch: &mut S::Scratch,
) {
    run_apart::<Alone, S, R>(structure, batch, range, scratch);
}

/// Rays go one after another.
struct Alone;

impl<S: Structure> Course<S> for Alone {
    type Out = ();

    #[inline(always)]
    fn run<'a, R: Rays<'a>>(
        structure: &S,
        batch: &mut R,
        range: Range<usize>,
        scratch: &mut S::Scratch,
    ) {
        for index in range {
            let mut visitor = batch.begin(index);
            let ray = &batch.rays()[index];
            structure.lead::<R::Isa, _>(ray, scratch, &mut visitor);
            batch.finish(index, &visitor);
        }
    }
}
