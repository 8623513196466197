//! The way of one ray through a wide tree, place by place, so that several rays can take turns.

use std::marker::PhantomData;

use crate::geometry::Ray;
use crate::geometry::lanes::{Isa, Lane, LaneMask};

use super::super::Visitor;
use super::super::slab::{Clip, WideSlabRay};
use super::stack::Stack;
use super::{BvhWide, Child};

/// Where a ray, or a packet of them, is.
pub(super) struct Walk<I: Isa, C = WideSlabRay> {
    slabs: C,
    lanes: PhantomData<I>,
    /// What is visited next.
    pub next: Child,
    /// Its entry, or a bound below it.
    entry: f32,
    /// Children on the stack.
    waiting: usize,
}

impl<I: Isa> Walk<I> {
    /// Of a ray, before the root.
    #[inline(always)]
    pub fn new(tree: &BvhWide, ray: &Ray) -> Self {
        Self::along(WideSlabRay::new::<I::X8>(ray, &tree.scene), tree, ray.t_min)
    }
}

impl<I: Isa, C: Clip<I::X8>> Walk<I, C> {
    /// Of whatever `slabs` stand for, from a place on.
    #[inline(always)]
    pub fn from(slabs: C, next: Child) -> Self {
        Self {
            slabs,
            lanes: PhantomData,
            next,
            entry: 0.0,
            waiting: 0,
        }
    }

    /// Of whatever `slabs` stand for, before the root.
    #[inline(always)]
    pub fn along(slabs: C, tree: &BvhWide, entry: f32) -> Self {
        Self {
            slabs,
            lanes: PhantomData,
            next: tree.root,
            entry,
            waiting: 0,
        }
    }

    /// Visits the next place; false when the traversal is over.
    #[inline(always)]
    pub fn step<V: Visitor>(&mut self, tree: &BvhWide, stack: &mut Stack, visitor: &mut V) -> bool {
        if V::WATCHED {
            self.report(tree, visitor);
        }
        if self.next.is_leaf() {
            for block in self.next.blocks() {
                if visitor.test(block) {
                    return false;
                }
            }
        } else {
            let node = &tree.nodes[self.next.0 as usize];
            let (entries, exits) = self.slabs.clip(&node.boxes, visitor.t_limit());
            let met = entries.le(exits).bits();
            if met != 0 {
                if met.is_power_of_two() {
                    let lane = met.trailing_zeros() as usize & 7;
                    self.next = Child(node.children[lane]);
                    if V::WATCHED {
                        self.entry = entries.get(lane);
                    }
                } else {
                    let children = &node.children;
                    self.waiting =
                        stack.push::<I>(self.waiting, entries, met, children, V::ORDERED);
                    (self.next, self.entry) = stack.at(self.waiting);
                }
                return true;
            }
        }
        self.pop::<V>(stack, visitor.t_limit())
    }

    /// Takes the nearest child that waits and begins at `limit` or before; those beyond it are dropped. False if none does.
    /// Where any hit will do the limit stays where it was when they were met.
    #[inline(always)]
    fn pop<V: Visitor>(&mut self, stack: &Stack, limit: f32) -> bool {
        // Keys are entries, but not less than 0.
        let limit = limit.max(0.0);
        while self.waiting > 0 {
            self.waiting -= 1;
            (self.next, self.entry) = stack.at(self.waiting);
            if !V::ORDERED || self.entry <= limit {
                return true;
            }
        }
        false
    }

    fn report<V: Visitor>(&self, tree: &BvhWide, visitor: &mut V) {
        let is_leaf = self.next.is_leaf();
        let references = if is_leaf {
            tree.references(self.next)
        } else {
            0
        };
        let (entry, exit) = (f64::from(self.entry), f64::from(visitor.t_limit()));
        visitor.step(self.next.place(), is_leaf, references, entry, exit);
    }
}
