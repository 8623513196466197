//! Several rays take turns: while one is at a place, the memory fetches the next places of the others, and the processor
//! computes for several at once.
//!
//! ```text
//! round:  rays that are over     begin anew with the next of the batch
//!         rays at nodes          \  each ends its visit by asking for what it will read next
//!         rays at leaves         /
//! ```
//!
//! The processor has the operations of several rays under way only as long as it guesses right what comes next. So no branch
//! depends on where a ray goes: what kind of place is next sets a bit; children are put on the stack and the next is taken
//! from it, whether none is met or several; and what begins beyond a hit is dropped when it is found, not when it is taken.
//! Without that a round was no quicker than one ray after another, on trees that stay in the caches slower; with it, by a
//! quarter to two thirds (`raylab trace`, one thread, eight meshes from 6 thousand to a million triangles).
//!
//! Tried and not kept: lists of rays in place of bits (two fifths slower: what was just written in bytes is read as a
//! vector), sorting eight keys where four are met (7 %), preparing sixteen rays at once in lanes (3 %: taking one out
//! costs as much as preparing it), and meeting the children of all rays' nodes before any are put on a stack (alike, random rays of
//! `city:300` 7 % slower). Eight rays are 5 % slower than sixteen, and those 2 % slower than 32.
//!
//! **Source:** the idea of hiding a cache miss behind other lookups is that of O. Kocberber, B. Falsafi and B. Grot,
//! "Asynchronous Memory Access Chaining", VLDB 2015. **Differs:** a ray is a state that is stepped, there is no queue.

use std::ops::Range;

use crate::geometry::lanes::{Isa, Ones, prefetch};

use super::super::batch::Course;
use super::super::{Rays, Visitor};
use super::stack::{FLIGHTS, Stacks};
use super::walk::Walk;
use super::{BvhWide, Child, Node};

/// Rays take turns.
pub(super) struct Interleaved;

/// A ray under way.
struct Flight<I: Isa, V> {
    index: usize,
    walk: Walk<I>,
    visitor: V,
}

/// What kind of place flights are at, a bit for each; the others under way are at nodes.
#[derive(Default)]
struct Kinds {
    leaves: u32,
    over: u32,
}

impl Kinds {
    #[inline(always)]
    fn note(&mut self, flight: usize, next: Child) {
        let over = u32::from(next == Child::END);
        self.over |= over << flight;
        self.leaves |= (u32::from(next.is_leaf()) ^ over) << flight;
    }
}

impl Course<BvhWide> for Interleaved {
    type Out = ();

    #[inline(always)]
    fn run<'a, R: Rays<'a>>(
        tree: &BvhWide,
        batch: &mut R,
        mut waiting: Range<usize>,
        stacks: &mut Stacks,
    ) {
        let stacks = stacks.first(FLIGHTS);
        let lines = Lines::of(tree, batch);
        let mut flights = Vec::with_capacity(FLIGHTS);
        let mut kinds = Kinds::default();
        let mut under_way = 0_u32;
        for (flight, index) in waiting.by_ref().take(FLIGHTS).enumerate() {
            let mut visitor = batch.begin(index);
            visitor.prepare();
            flights.push(Flight {
                index,
                walk: Walk::<R::Isa>::new(tree, &batch.rays()[index]),
                visitor,
            });
            kinds.note(flight, tree.root);
            under_way |= 1 << flight;
        }
        while under_way != 0 {
            for number in Ones(std::mem::take(&mut kinds.over)) {
                let flight = &mut flights[number];
                batch.finish(flight.index, &flight.visitor);
                if let Some(index) = waiting.next() {
                    flight.index = index;
                    flight.walk = Walk::new(tree, &batch.rays()[index]);
                    batch.begin_again(index, &mut flight.visitor);
                    flight.visitor.prepare();
                    kinds.note(number, tree.root);
                } else {
                    under_way &= !(1 << number);
                }
            }
            for number in Ones(under_way & !kinds.leaves & !kinds.over) {
                let Flight { walk, visitor, .. } = &mut flights[number];
                walk.visit_node(tree, &mut stacks[number], visitor);
                lines.fetch::<R>(walk.next);
                kinds.note(number, walk.next);
            }
            for number in Ones(std::mem::take(&mut kinds.leaves)) {
                let Flight { walk, visitor, .. } = &mut flights[number];
                walk.visit_leaf(&mut stacks[number], visitor);
                lines.fetch::<R>(walk.next);
                kinds.note(number, walk.next);
            }
        }
    }
}

/// Where nodes and blocks lie in memory, and the bytes of one.
pub(super) struct Lines([(*const u8, usize); 2]);

impl Lines {
    pub(super) fn of<'a, R: Rays<'a>>(tree: &BvhWide, batch: &R) -> Self {
        let nodes = (tree.nodes.as_ptr().cast(), size_of::<Node>());
        Self([nodes, (batch.items(), R::ITEM_BYTES)])
    }

    /// Asks for what a visit of `child` reads first; for as much where it is a node, since a branch would be guessed wrong.
    #[inline(always)]
    pub(super) fn fetch<'a, R: Rays<'a>>(&self, child: Child) {
        let (base, bytes) = self.0[usize::from(child.is_leaf())];
        prefetch(base.wrapping_add(child.index() * bytes), R::ITEM_BYTES);
    }
}
