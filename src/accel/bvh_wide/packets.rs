//! Rays from one origin go through the tree together, as long as that costs less than going alone.
//!
//! A packet is a run of rays of the batch: 64, which of a picture's rays are a square of 8 × 8 pixels, or 16. Where
//! triangles are smaller than the packet, its rays test each other's triangles, and it collapses: so its work decides how
//! many rays the next one has. Work is counted, not timed, so that a batch is traced alike on every machine.

use std::ops::Range;

use super::super::Rays;
use super::super::packet::{Bundle, MOST, VECTOR, Work};
use super::super::slab::PacketSlabs;
use super::stack::Stacks;
use super::walk::Walk;
use super::{BvhWide, single};
use crate::geometry::lanes::Isa;

/// What an item that is met, with the nodes on the way to it, and a test cost, in nanoseconds of a 3.5 GHz machine; the
/// unit of the other constants.
const ITEM: u32 = 20;
const TEST: u32 = 6;

/// Cost of a ray above which a packet of 64 is no gain over packets of 16.
const TOO_WIDE: u32 = 16;

/// Cost of a ray in a packet of 16 above which it had better go alone.
const TOO_DEAR: u32 = 30;

/// Cost of a ray in a packet of 16 below which 64 may go together.
const CHEAP: u32 = 12;

/// Rays that go alone until a packet is tried again.
const ALONE: usize = 1024;

/// Traces all rays of `batch`.
#[inline(always)]
pub(super) fn trace<'a, R: Rays<'a>>(tree: &BvhWide, batch: &mut R, stacks: &mut Stacks) {
    let count = batch.rays().len();
    let mut start = 0;
    let mut size = VECTOR;
    while start < count {
        let range = start..count.min(start + size);
        let rays = range.len() as u32;
        start = range.end;
        let cost = together(tree, batch, range.clone(), stacks)
            .map(|work| (work.items * ITEM + work.tests * TEST) / rays);
        match cost {
            // Quarters may be of one mind.
            None if size > VECTOR => {
                start = range.start;
                size = VECTOR;
            }
            None => single(tree, batch, range, stacks),
            Some(cost) if size > VECTOR && cost > TOO_WIDE => size = VECTOR,
            Some(cost) if size == VECTOR && cost > TOO_DEAR => {
                let alone = start..count.min(start + ALONE);
                start = alone.end;
                single(tree, batch, alone, stacks);
            }
            // Whole squares only.
            Some(cost) if cost < CHEAP && start.is_multiple_of(MOST) => size = MOST,
            Some(_) => {}
        }
    }
}

/// Traces the rays in `range` as a packet; `None` if they cannot be one.
#[inline(always)]
fn together<'a, R: Rays<'a>>(
    tree: &BvhWide,
    batch: &mut R,
    range: Range<usize>,
    stacks: &mut Stacks,
) -> Option<Work> {
    let first = range.start;
    let bundle = Bundle::new(&batch.rays()[range])?;
    let slabs = PacketSlabs::<<R::Isa as Isa>::X8>::new(&bundle, &tree.bounds)?;
    let mut packet = batch.begin_packet(&bundle, first)?;
    let [stack] = stacks.first(1) else {
        return None;
    };
    let mut walk = Walk::<R::Isa, _>::along(slabs, tree, 0.0);
    while walk.step(tree, stack, &mut packet) {}
    Some(batch.finish_packet(&packet))
}
