//! The way of one ray through a wide tree, place by place, so that several rays can take turns.

use std::marker::PhantomData;

use crate::geometry::Ray;
use crate::geometry::lanes::{Isa, Lane, LaneMask};

use super::super::Visitor;
use super::super::slab::{Clip, WideSlabRay};
use super::stack::Stack;
use super::{BvhWide, Child, Node};

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
            entry,
            ..Self::from(slabs, tree.root)
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
            let node = self.node(tree);
            let (entries, met) = self.meet(node, visitor);
            if met != 0 {
                if met.is_power_of_two() {
                    let lane = met.trailing_zeros() as usize & 7;
                    self.next = Child(node.children[lane]);
                    if V::WATCHED {
                        self.entry = entries.get(lane);
                    }
                } else {
                    self.push::<V>(node, entries, met, stack);
                    self.pop(stack);
                }
                return true;
            }
        }
        // Keys are entries, but not less than 0. Where any hit will do the limit stays where it was when they were met.
        let limit = visitor.t_limit().max(0.0);
        while self.waiting > 0 {
            self.pop(stack);
            if !V::ORDERED || self.entry <= limit {
                return true;
            }
        }
        false
    }

    /// Visits a node in the same way whether no child is met or several; for [`Walk::visit_leaf`].
    #[inline(always)]
    pub fn visit_node<V: Visitor>(&mut self, tree: &BvhWide, stack: &mut Stack, visitor: &V) {
        let node = self.node(tree);
        let (entries, met) = self.meet(node, visitor);
        self.push::<V>(node, entries, met, stack);
        self.take(stack);
    }

    /// Visits a leaf; of what waits, what begins beyond the hit that it may have is dropped at once. Where none is left,
    /// [`Child::END`] is next.
    #[inline(always)]
    pub fn visit_leaf<V: Visitor>(&mut self, stack: &mut Stack, visitor: &mut V) {
        let limit = visitor.t_limit();
        for block in self.next.blocks() {
            if visitor.test(block) {
                self.next = Child::END;
                return;
            }
        }
        let now = visitor.t_limit();
        if V::ORDERED && now < limit {
            self.waiting = stack.keep::<I>(self.waiting, now);
        }
        self.take(stack);
    }

    #[inline(always)]
    fn node<'t>(&self, tree: &'t BvhWide) -> &'t Node {
        &tree.nodes[self.next.0 as usize]
    }

    /// Where the children of a node are entered, and a bit for each that is met.
    #[inline(always)]
    fn meet<V: Visitor>(&self, node: &Node, visitor: &V) -> (I::X8, u32) {
        let (entries, exits) = self.slabs.clip(&node.boxes, visitor.t_limit());
        (entries, entries.le(exits).bits())
    }

    /// Puts the children of `node` that are `met` on the stack.
    #[inline(always)]
    fn push<V: Visitor>(&mut self, node: &Node, entries: I::X8, met: u32, stack: &mut Stack) {
        self.waiting = stack.push::<I>(self.waiting, entries, met, &node.children, V::ORDERED);
    }

    /// Takes the child on top, or [`Child::END`] where none waits.
    #[inline(always)]
    fn take(&mut self, stack: &Stack) {
        self.next = stack.top(self.waiting);
        self.waiting = self.waiting.saturating_sub(1);
    }

    /// Takes the child on top, and its entry.
    #[inline(always)]
    fn pop(&mut self, stack: &Stack) {
        (self.next, self.entry) = (stack.top(self.waiting), stack.top_entry(self.waiting));
        self.waiting -= 1;
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
