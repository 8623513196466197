//! The build of small subtrees: every split between neighbours along every axis is tried.
//!
//! References are sorted once along each axis; a split keeps the order on both sides, so going down costs no sorting.
//! Of three references each can be the one that is split off.

use super::Node;
use super::binned::Place;
use super::reference::{Bounds, Extent, Reference};

/// Most references of a small subtree: one bit each in a `u32`.
pub(super) const MOST: usize = 32;

/// Positions of references in their order along an axis.
type Order = [u8; MOST];

/// Fills `node` and everything below it; there are at most [`MOST`] references.
pub(super) fn build(node: &mut Node, references: &[Reference], extent: &Extent, place: Place) {
    let mut boxes = [Bounds::EMPTY; MOST];
    for (bounds, reference) in boxes.iter_mut().zip(references) {
        *bounds = reference.bounds();
    }
    let mut sorted = Sorted {
        references,
        boxes,
        orders: orders(references, extent),
    };
    let count = references.len();
    sorted.split([0, count], &extent.bounds, node, place);
}

/// The references sorted by their centroids along each axis.
fn orders(references: &[Reference], extent: &Extent) -> [Order; 3] {
    // Numbers that are not negative are ordered as their bits are. The lowest bits make all keys different.
    let mut keys = [[i32::MAX; MOST]; 3];
    for (i, reference) in references.iter().enumerate() {
        let along = reference.centroid() - extent.centroids.min;
        for (keys, place) in keys.iter_mut().zip(along.to_array()) {
            keys[i] = (place.abs().to_bits() & !(MOST as u32 - 1)) as i32 | i as i32;
        }
    }
    keys.map(|keys| {
        let mut order = [0; MOST];
        for i in 0..references.len() {
            // How many come before it, without a branch.
            let rank: i32 = keys.iter().map(|&key| i32::from(key < keys[i])).sum();
            order[rank as usize % MOST] = i as u8;
        }
        order
    })
}

/// The references of a small subtree.
struct Sorted<'a> {
    references: &'a [Reference],
    boxes: [Bounds; MOST],
    /// Their positions, subtree after subtree, each sorted along each axis.
    orders: [Order; 3],
}

impl Sorted<'_> {
    /// Fills `node` and what is below it with the references whose positions are in `range` of the orders.
    fn split(&mut self, [start, end]: [usize; 2], bounds: &Bounds, node: &mut Node, place: Place) {
        let count = end - start;
        if count == 1 {
            place.prims[0] = self.references[self.at(0, start)].prim();
            *node = Node::leaf(bounds.aabb(), place.first_reference, 1);
            return;
        }
        *node = Node::interior(bounds.aabb(), place.first_node);
        let middle = start
            + if !place.may_choose(count) {
                count / 2
            } else if count <= 3 {
                self.split_one_off(start, count)
            } else {
                self.split_best([start, end], bounds.scale())
            };
        let sides = [[start, middle], [middle, end]].map(|[start, end]| {
            (start..end).fold(Bounds::EMPTY, |side, i| {
                side.union(self.boxes[self.at(0, i)])
            })
        });
        let (children, [a_place, b_place]) = place.split(middle - start);
        let (a, b) = children.split_at_mut(1);
        self.split([start, middle], &sides[0], &mut a[0], a_place);
        self.split([middle, end], &sides[1], &mut b[0], b_place);
    }

    /// Which reference is the `i`-th along `axis`.
    #[inline(always)]
    fn at(&self, axis: usize, i: usize) -> usize {
        self.orders[axis][i % MOST] as usize % MOST
    }

    /// Brings one of two or three references to the front and returns 1.
    fn split_one_off(&mut self, start: usize, count: usize) -> usize {
        if count == 3 {
            let [a, b, c] = [0, 1, 2].map(|i| self.boxes[self.at(0, start + i)]);
            let scale = a.union(b).union(c).scale();
            let cost = |one: Bounds, p: Bounds, q: Bounds| {
                one.half_area(scale) + 2.0 * p.union(q).half_area(scale)
            };
            let costs = [cost(a, b, c), cost(b, a, c), cost(c, a, b)];
            let one = (1..3).fold(0, |best, i| if costs[i] < costs[best] { i } else { best });
            self.orders[0].swap(start, start + one);
        }
        1
    }

    /// Brings the first side of the cheapest split to the front of all orders and returns its size. Among equals the
    /// most even split wins.
    fn split_best(&mut self, [start, end]: [usize; 2], scale: f32) -> usize {
        let count = end - start;
        // The cost, how uneven the split is, its axis and its size in one number, so that the least is found without
        // a branch: numbers that are not negative are ordered as their bits are.
        let mut best = u64::MAX;
        for axis in 0..3 {
            let mut second = [0.0; MOST];
            let mut side = Bounds::EMPTY;
            for i in (1..count).rev() {
                side = side.union(self.boxes[self.at(axis, start + i)]);
                second[i % MOST] = side.half_area(scale) * (count - i) as f32;
            }
            side = Bounds::EMPTY;
            for i in 1..count {
                side = side.union(self.boxes[self.at(axis, start + i - 1)]);
                let cost = side.half_area(scale) * i as f32 + second[i % MOST];
                let uneven = i.abs_diff(count - i);
                let key = u64::from(cost.to_bits()) << 32 | (uneven << 16 | axis << 8 | i) as u64;
                best = best.min(key);
            }
        }
        let (axis, first) = ((best >> 8) as usize % 256, best as usize % 256);
        let (axis, first) = if axis < 3 {
            (axis, first)
        } else {
            (0, count / 2)
        };
        self.order_sides([start, end], axis, first);
        first
    }

    /// Brings the first so many along `axis` to the front of the other orders, each side sorted as it was.
    fn order_sides(&mut self, [start, end]: [usize; 2], axis: usize, first: usize) {
        if first.max(end - start - first) <= 3 {
            // Nothing below is sorted any more.
            let chosen = self.orders[axis];
            self.orders[0][start..end].copy_from_slice(&chosen[start..end]);
            return;
        }
        let bits = (start..start + first).fold(0_u32, |bits, i| bits | 1 << self.at(axis, i));
        for other in (0..3).filter(|&other| other != axis) {
            let mut sorted: Order = [0; MOST];
            let mut next = [start, start + first];
            for i in start..end {
                let at = self.at(other, i);
                let side = usize::from(bits >> at & 1 == 0);
                sorted[next[side] % MOST] = at as u8;
                next[side] += 1;
            }
            self.orders[other][start..end].copy_from_slice(&sorted[start..end]);
        }
    }
}
