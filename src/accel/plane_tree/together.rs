//! Packets through a tree of planes; see [`super::super::packets`].

use std::ops::Range;

use super::super::packet::Bundle;
use super::super::packets::{Refused, Together};
use super::super::slab::Pencil;
use super::super::stack::Room;
use super::super::{Rays, Visitor};
use super::PlaneTree;
use super::cut::PacketCut;
use super::walk::{Nobody, Walk};

#[inline(never)]
fn begin<'a>(
    tree: &PlaneTree,
    pencil: Pencil,
    room: &'a mut Room,
    limit: f32,
) -> Walk<'a, PacketCut> {
    Walk::new(PacketCut::new(pencil), tree, room, limit)
}

/// The walk of a packet, compiled once for all kernels.
#[inline(never)]
fn next(walk: &mut Walk<PacketCut>, tree: &PlaneTree, limit: f32) -> Option<Range<u32>> {
    walk.next(tree, limit, &mut Nobody)
}

/// Cost of a ray in a packet above which it had better go alone.
const TOO_DEAR: u32 = 120;

impl Together for PlaneTree {
    #[inline(always)]
    fn together<'a, R: Rays<'a>>(
        &self,
        batch: &mut R,
        range: Range<usize>,
        room: &mut Room,
    ) -> Result<u32, Refused> {
        let first = range.start;
        let bundle = Bundle::new::<R::Isa>(&batch.rays()[range]);
        let pencil = Pencil::new(&bundle, &self.bounds).ok_or(Refused::Unlike)?;
        let budget = TOO_DEAR * bundle.rays.len() as u32;
        let mut packet = batch.begin_packet(&bundle, first, budget);
        let mut walk = begin(self, pencil, room, packet.t_limit());
        while let Some(blocks) = next(&mut walk, self, packet.t_limit()) {
            for block in blocks {
                if packet.test(block) {
                    return batch.finish_packet(packet).ok_or(Refused::TooDear);
                }
            }
        }
        batch.finish_packet(packet).ok_or(Refused::TooDear)
    }
}
