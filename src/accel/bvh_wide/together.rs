//! Packets through a wide tree; see [`super::super::packets`].

use std::ops::Range;

use super::super::Rays;
use super::super::packet::Bundle;
use super::super::packets::{Refused, Together};
use super::super::slab::PacketSlabs;
use super::BvhWide;
use super::stack::Stacks;
use super::walk::Walk;
use super::way;
use crate::geometry::lanes::Isa;

/// Cost of a ray in a packet above which it had better go with a group: on three meshes with many triangles a pixel (city,
/// sphereflake, armadillo) primary rays are a tenth to a fifth faster than with a bound of 120. Bounds from 28 to 55 are alike
/// within a few hundredths.
const TOO_DEAR: u32 = 28;

impl Together for BvhWide {
    #[inline(always)]
    fn together<'a, R: Rays<'a>>(
        &self,
        batch: &mut R,
        range: Range<usize>,
        stacks: &mut Stacks,
    ) -> Result<u32, Refused> {
        let (first, rays) = (range.start, &batch.rays()[range]);
        let budget = TOO_DEAR * rays.len() as u32;
        let stack = stacks.one();
        let bundle = Bundle::new::<R::Isa>(rays);
        let slabs = PacketSlabs::<<R::Isa as Isa>::X8>::new(&bundle, &self.scene.bounds)
            .ok_or(Refused::Unlike)?;
        let mut packet = batch.begin_packet(&bundle, first, budget);
        let mut walk = Walk::<R::Isa, _>::along(slabs, self, 0.0);
        while walk.step(self, stack, &mut packet) {}
        batch.finish_packet(packet).ok_or(Refused::TooDear)
    }

    /// Neighbours may have much of their way in common, even where they are no packet.
    #[inline(always)]
    fn apart<'a, R: Rays<'a>>(&self, batch: &mut R, range: Range<usize>, stacks: &mut Stacks) {
        way::mixed(self, batch, range, stacks, true);
    }
}
