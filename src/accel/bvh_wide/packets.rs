//! Rays from one origin go through the tree together, as long as that costs less than going alone.
//!
//! A packet is a run of rays of the batch: 64, which of a picture's rays are a square of 8 × 8 pixels, or 16. Where
//! triangles are smaller than the packet, its rays test each other's triangles, and it collapses: then it gives up, its
//! rays go alone, and so do others after it. What it cost decides how many rays the next one has.

use std::ops::Range;

use super::super::Rays;
use super::super::Structure;
use super::super::packet::{Bundle, MOST, VECTOR};
use super::super::slab::PacketSlabs;
use super::BvhWide;
use super::stack::Stacks;
use super::walk::Walk;
use crate::geometry::lanes::Isa;

/// Cost of a ray in a packet of 64, about in nanoseconds, above which packets of 16 are better.
const TOO_WIDE: u32 = 20;

/// Cost of a ray in a packet above which it had better go alone: half of what that costs.
const TOO_DEAR: u32 = 40;

/// Cost of a ray in a packet of 16 below which 64 may go together.
const CHEAP: u32 = 15;

/// Rays that go alone until a packet is tried again.
const ALONE: usize = 256;

/// Traces all rays of `batch`, as packets where `packets` asks for them.
#[inline(always)]
pub(super) fn trace<'a, R: Rays<'a>>(
    tree: &BvhWide,
    batch: &mut R,
    stacks: &mut Stacks,
    packets: bool,
) {
    let count = batch.rays().len();
    let mut start = 0;
    let mut size = VECTOR;
    while start < count {
        let mut alone = start..count;
        if R::PACKETS && packets {
            let range = start..count.min(start + size);
            let rays = range.len() as u32;
            if let Some(cost) = together(tree, batch, range.clone(), stacks) {
                start = range.end;
                if cost > TOO_WIDE * rays {
                    size = VECTOR;
                } else if cost < CHEAP * rays && start.is_multiple_of(MOST) {
                    // Whole squares only.
                    size = MOST;
                }
                continue;
            }
            if size > VECTOR {
                // Quarters may be of one mind.
                size = VECTOR;
                continue;
            }
            alone.end = count.min(start + ALONE);
        }
        start = alone.end;
        for index in alone {
            let mut visitor = batch.begin(index);
            let ray = batch.rays()[index];
            tree.traverse::<R::Isa, _>(&ray, stacks, &mut visitor);
            batch.finish(index, &visitor);
        }
    }
}

/// Traces the rays in `range` as a packet and returns what it cost; `None` if they cannot be one, or had better not.
#[inline(always)]
fn together<'a, R: Rays<'a>>(
    tree: &BvhWide,
    batch: &mut R,
    range: Range<usize>,
    stacks: &mut Stacks,
) -> Option<u32> {
    let first = range.start;
    let bundle = Bundle::new(&batch.rays()[range])?;
    let slabs = PacketSlabs::<<R::Isa as Isa>::X8>::new(&bundle, &tree.bounds)?;
    let budget = TOO_DEAR * bundle.rays.len() as u32;
    let mut packet = batch.begin_packet(&bundle, first, budget)?;
    let [stack] = stacks.first(1) else {
        return None;
    };
    let mut walk = Walk::<R::Isa, _>::along(slabs, tree, 0.0);
    while walk.step(tree, stack, &mut packet) {}
    batch.finish_packet(&packet)
}
