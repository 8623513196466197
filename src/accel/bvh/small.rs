//! The build of small subtrees: every split between neighbours along every axis is tried.
//!
//! References are sorted once along each axis; a split keeps the order on both sides, so going down costs no sorting.
//! Of three references each can be the one that is split off.
//!
//! The axes are swept together, so that areas of three boxes are computed at once and the three chains of minima run side by
//! side; one after the other they took half as long again.

use glam::{Mat4, Vec4};

use super::Node;
use super::binned::{Row, may_choose};
use super::reference::{Bounds, Extent, Reference};

/// Most references of a small subtree: one bit each in a `u32`.
pub(super) const MOST: usize = 32;

/// Positions of references in their order along an axis.
type Order = [u8; MOST];

/// The root of a subtree over `references`, at most [`MOST`], at `depth`, after everything below it went to `row`.
pub(super) fn build(
    references: &[Reference],
    extent: &Extent,
    depth: usize,
    row: &mut Row,
) -> Node {
    if references.len() <= row.most() {
        return row.leaf(extent.bounds.aabb(), references.iter().map(Reference::prim));
    }
    let mut boxes = [Bounds::EMPTY; MOST];
    for (bounds, reference) in boxes.iter_mut().zip(references) {
        *bounds = reference.bounds();
    }
    let mut sorted = Sorted {
        references,
        boxes,
        orders: orders(references, extent),
    };
    sorted.split([0, references.len()], &extent.bounds, depth, row)
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

/// Growing boxes, one for each axis along which there is a sweep.
struct Sides([Bounds; 3]);

impl Sides {
    const EMPTY: Self = Self([Bounds::EMPTY; 3]);

    #[inline(always)]
    fn grow(&mut self, [x, y, z]: [&Bounds; 3]) {
        let Self([a, b, c]) = self;
        (*a, *b, *c) = (a.union(*x), b.union(*y), c.union(*z));
    }

    /// As [`Bounds::half_area`], of those along x, y and z; none may be empty.
    #[inline(always)]
    fn half_areas(&self, scale: f32) -> Vec4 {
        let Self([x, y, z]) = self;
        // Edges along one axis together instead of those of one box.
        let edges = Mat4::from_cols(x.extent(), y.extent(), z.extent(), Vec4::ZERO).transpose();
        let (x, y, z) = (
            edges.x_axis * scale,
            edges.y_axis * scale,
            edges.z_axis * scale,
        );
        x * (y + z) + y * z
    }
}

/// The references of a small subtree.
struct Sorted<'a> {
    references: &'a [Reference],
    boxes: [Bounds; MOST],
    /// Their positions, subtree after subtree, each sorted along each axis.
    orders: [Order; 3],
}

impl Sorted<'_> {
    /// The root of a subtree, at `depth`, over the references whose positions are in `range` of the orders.
    fn split(
        &mut self,
        [start, end]: [usize; 2],
        bounds: &Bounds,
        depth: usize,
        row: &mut Row,
    ) -> Node {
        let count = end - start;
        if count <= row.most() {
            let prims = (start..end).map(|i| self.references[self.at(0, i)].prim());
            return row.leaf(bounds.aabb(), prims);
        }
        let middle = start
            + if !may_choose(depth, count) {
                // Below it may be chosen again, along any axis.
                self.order_sides([start, end], 0, count / 2);
                count / 2
            } else if count <= 3 {
                self.split_one_off(start, count)
            } else {
                self.split_best([start, end], bounds.scale())
            };
        row.interior(bounds.aabb(), |row| {
            [[start, middle], [middle, end]].map(|[start, end]| {
                let bounds = (start..end).fold(Bounds::EMPTY, |side, i| {
                    side.union(self.boxes[self.at(0, i)])
                });
                self.split([start, end], &bounds, depth + 1, row)
            })
        })
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
        let mut second = [Vec4::ZERO; MOST];
        let mut sides = Sides::EMPTY;
        for i in (1..count).rev() {
            sides.grow(self.boxes_at(start + i));
            second[i % MOST] = sides.half_areas(scale) * (count - i) as f32;
        }
        let mut sides = Sides::EMPTY;
        let (mut least, mut uneven, mut first) = (Vec4::INFINITY, Vec4::INFINITY, Vec4::ZERO);
        for i in 1..count {
            sides.grow(self.boxes_at(start + i - 1));
            let cost = sides.half_areas(scale) * i as f32 + second[i % MOST];
            let is_uneven = Vec4::splat(i.abs_diff(count - i) as f32);
            let wins = cost.cmplt(least) | (cost.cmpeq(least) & is_uneven.cmplt(uneven));
            least = Vec4::select(wins, cost, least);
            uneven = Vec4::select(wins, is_uneven, uneven);
            first = Vec4::select(wins, Vec4::splat(i as f32), first);
        }
        let mut axis = 0;
        for other in 1..3 {
            let is_less = least[other] < least[axis];
            if is_less || (least[other] == least[axis] && uneven[other] < uneven[axis]) {
                axis = other;
            }
        }
        // None where no cost is a number.
        let first = match first[axis] as usize {
            0 => count / 2,
            first => first,
        };
        self.order_sides([start, end], axis, first);
        first
    }

    /// The boxes of the `i`-th along each axis.
    #[inline(always)]
    fn boxes_at(&self, i: usize) -> [&Bounds; 3] {
        [
            &self.boxes[self.at(0, i)],
            &self.boxes[self.at(1, i)],
            &self.boxes[self.at(2, i)],
        ]
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
