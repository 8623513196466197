//! Several rays take turns: while one is at a place, the memory fetches the next places of the others.
//!
//! ```text
//! flights:  ray 0   ray 1   ray 2   ...   ray 15
//!           step -> step -> step -> ... -> step -> step ...      each ends by asking for what it will read next;
//!                                                                a ray that is done makes room for the next of the batch
//! ```
//!
//! **Source:** the idea of hiding a cache miss behind other lookups is that of O. Kocberber, B. Falsafi and B. Grot,
//! "Asynchronous Memory Access Chaining", VLDB 2015. **Differs:** a ray is a state that is stepped, there is no queue.

use crate::geometry::lanes::{Isa, prefetch};

use super::super::Rays;
use super::stack::{FLIGHTS, Stacks};
use super::walk::Walk;
use super::{BvhWide, Child, Node};

/// A ray under way.
struct Flight<I: Isa, V> {
    index: usize,
    /// Which stack is its own.
    stack: usize,
    walk: Walk<I>,
    visitor: V,
}

/// Traces all rays of `batch`.
#[inline(always)]
pub(super) fn trace<'a, R: Rays<'a>>(tree: &BvhWide, batch: &mut R, stacks: &mut Stacks) {
    let count = batch.rays().len();
    let stacks = stacks.first(FLIGHTS);
    let mut waiting = FLIGHTS.min(count)..count;
    let mut flights = Vec::with_capacity(FLIGHTS);
    for index in 0..waiting.start {
        flights.push(Flight {
            index,
            stack: index,
            walk: Walk::<R::Isa>::new(tree, &batch.rays()[index]),
            visitor: batch.begin(index),
        });
    }
    let mut turn = 0;
    while let Some(flight) = flights.get_mut(turn) {
        let goes_on = flight.walk.step(
            tree,
            &mut stacks[flight.stack % FLIGHTS],
            &mut flight.visitor,
        );
        if goes_on {
            fetch(tree, batch, flight.walk.next);
        } else {
            batch.finish(flight.index, &flight.visitor);
            if let Some(index) = waiting.next() {
                flight.index = index;
                flight.walk = Walk::new(tree, &batch.rays()[index]);
                batch.begin_again(index, &mut flight.visitor);
            } else {
                flights.swap_remove(turn);
            }
        }
        turn += 1;
        if turn >= flights.len() {
            turn = 0;
        }
    }
}

/// Asks for what a visit of `child` reads first.
#[inline(always)]
fn fetch<'a, R: Rays<'a>>(tree: &BvhWide, batch: &R, child: Child) {
    if child.is_leaf() {
        batch.prefetch(child.blocks().start);
    } else {
        let node = tree.nodes.as_ptr().wrapping_add(child.0 as usize);
        prefetch(node, size_of::<Node>() / 64);
    }
}
