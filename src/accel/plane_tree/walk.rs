//! The way of a ray, or of a packet of them, from leaf to leaf. Nothing here knows the kernel, so it is compiled once.

use std::ops::Range;

use super::super::Visitor;
use super::super::stack::{Room, Stack};
use super::PlaneTree;
use super::cut::Cut;
use super::node::Node;

/// Who is told of every node that is visited.
pub(super) trait Report {
    /// `node` with index `place` is visited.
    fn visit(&mut self, tree: &PlaneTree, place: u32, node: Node, entry: f32, exit: f32);
}

/// Nobody.
pub(super) struct Nobody;

impl Report for Nobody {
    #[inline(always)]
    fn visit(&mut self, _: &PlaneTree, _: u32, _: Node, _: f32, _: f32) {}
}

/// A visitor that watches.
pub(super) struct Watched<'a, V>(pub &'a mut V);

impl<V: Visitor> Report for Watched<'_, V> {
    fn visit(&mut self, tree: &PlaneTree, place: u32, node: Node, entry: f32, exit: f32) {
        if node.is_step() {
            let is_leaf = node.is_leaf();
            let references = if is_leaf { tree.references(node) } else { 0 };
            let (entry, exit) = (f64::from(entry), f64::from(exit));
            self.0
                .step(u64::from(place), is_leaf, references, entry, exit);
        }
    }
}

/// Where a ray, or a packet, is: what is left to be visited waits on its stack.
pub(super) struct Walk<'a, C> {
    cuts: C,
    stack: Stack<'a>,
}

impl<'a, C: Cut> Walk<'a, C> {
    /// Before the root.
    #[inline(always)]
    pub fn new(cuts: C, tree: &PlaneTree, room: &'a mut Room, limit: f32) -> Self {
        let (entry, exit) = cuts.interval(&tree.bounds, limit);
        let mut stack = Stack::new(room);
        if entry <= exit {
            stack.push(0, entry, exit);
        }
        Self { cuts, stack }
    }

    /// The blocks of the next leaf that has any and begins at `limit` or before; `None` where there is none.
    #[inline(always)]
    pub fn next<R: Report>(
        &mut self,
        tree: &PlaneTree,
        limit: f32,
        report: &mut R,
    ) -> Option<Range<u32>> {
        loop {
            // What waits below a dropped node may begin earlier than it, by the pad, so all are looked at.
            let waiting = self.stack.pop(limit)?;
            let (mut place, entry, mut exit) = (waiting.node, waiting.entry, waiting.exit);
            let blocks = loop {
                let node = tree.nodes[place as usize];
                report.visit(tree, place, node, entry, exit);
                let (pair, (leave, enter, near));
                if let Some(axis) = node.split_axis() {
                    pair = node.pair();
                    (leave, enter, near) = self.cuts.axis(axis, node.place());
                } else if let Some(index) = node.as_oblique() {
                    let plane = &tree.obliques[index as usize];
                    pair = plane.pair;
                    (leave, enter, near) = self.cuts.oblique(plane);
                } else {
                    break node.blocks();
                }
                // Written so that NaN constrains nothing.
                let near_exit = if leave < exit { leave } else { exit };
                let far_entry = if enter > entry { enter } else { entry };
                let far = pair + (near ^ 1);
                if near_exit < entry {
                    place = far;
                } else {
                    if far_entry <= exit {
                        self.stack.push(far, far_entry, exit);
                    }
                    (place, exit) = (pair + near, near_exit);
                }
            };
            if !blocks.is_empty() {
                return Some(blocks);
            }
        }
    }
}
