//! Sixteen rays go down the tree together while several of them visit the same nodes; below that each goes alone.
//!
//! ```text
//! window of 128 rays -> by octant -> groups of 16 -> root: one box at a time, a lane a ray
//!                                                     |   |
//!                                    many lanes go on o   o few lanes go on: each ray walks this subtree alone
//! ```
//!
//! Of a node's eight children a group meets one or two, of a leaf's triangles two or three: a hull around its rays tells
//! which others none of them can meet, eight at once, before any is asked ([`SlabRays`]). What is left of a leaf is tested
//! triangle by triangle, sixteen rays at once, or ray by ray, eight triangles at once, whichever are fewer tests.
//!
//! Measured on seven meshes (`raylab trace`, one thread, this way alone): the hull before boxes makes primary rays a seventh
//! faster and bounce rays a twentieth; before triangles, shadow and bounce rays on large ones (Crytek Sponza) a seventh, on
//! small ones nothing; tests without branches where any hit will do an eighth ([`Kernel::intersect_within`]). To fetch what lies on
//! the stack pays where order counts (a million triangles: a tenth); where any hit will do most is never read.
//!
//! Tried and not kept (the same, an AMD EPYC of the Zen 4 generation): two or four groups in turns, so that the memory fetches for
//! one while the other goes on (bounce rays of `city:300` and `sphereflake:4` are as fast, primary rays 2 to 7 % slower, shadow
//! rays up to a fifth); and all that `moller-trumbore` computes of triangles whatever the direction, once for a block and rays from one
//! point (nothing gained: few triangles of a block are tested).
//!
//! [`Kernel::intersect_within`]: crate::kernel::Kernel::intersect_within
//!
//! **Source:** C. Benthin, I. Wald, S. Woop, M. Ernst and W. Mark, "Combining Single and Packet-Ray Tracing for Arbitrary Ray
//! Distributions on the Intel MIC Architecture", TVCG 2012. **Differs:** rays are grouped by octant first.

use std::ops::Range;

use crate::geometry::Ray;
use crate::geometry::lanes::{Isa, Lane, LaneMask, Ones, RayLanes, SIXTEEN, Task, prefetch};

use super::super::batch::Course;
use super::super::slab::{Clip, SlabRays, WideSlabRay};
use super::super::stack::MAX_DEPTH;
use super::super::{Rays, Visitor};
use super::interleaved::Lines;
use super::stack::{Stack, Stacks};
use super::walk::Walk;
use super::{BvhWide, Child};

/// Rays of a group.
const GROUP: usize = SIXTEEN;

/// Rays that are looked at together to make groups.
pub(super) const WINDOW: usize = 128;

/// Fewer rays than this go alone.
const FEW: u32 = 3;

/// A number for each ray of a group.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Row([f32; GROUP]);

/// A child that waits.
#[derive(Clone, Copy)]
struct Item {
    child: Child,
    /// The rays that visit it, a bit each.
    met: u32,
    /// Where the first of them enters.
    key: f32,
    /// Level and lane: where its entries are kept.
    slot: u32,
}

/// How much of their way rays had in common.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Shared {
    /// Nodes that were visited by a group.
    nodes: u32,
    /// The rays that visited them.
    rays: u32,
}

impl Shared {
    /// Whether a node was visited by so many of a group, in the mean.
    pub fn by_so_many(self, rays: u32) -> bool {
        self.rays >= rays * self.nodes
    }
}

/// The children that wait for a group, and, where order counts, where each ray enters them.
pub struct GroupStack {
    items: [Item; 8 * MAX_DEPTH],
    /// How many wait.
    waits: usize,
    /// What was shared so far.
    shared: Shared,
    entries: Vec<[Row; 8]>,
}

impl Default for GroupStack {
    fn default() -> Self {
        let none = Item {
            child: Child::NONE,
            met: 0,
            key: 0.0,
            slot: 0,
        };
        Self {
            items: [none; 8 * MAX_DEPTH],
            waits: 0,
            shared: Shared::default(),
            entries: vec![[Row([0.0; GROUP]); 8]; MAX_DEPTH],
        }
    }
}

/// Rays go in groups of sixteen while that pays.
pub(super) struct Hybrid;

impl Course<BvhWide> for Hybrid {
    type Out = Shared;

    #[inline(always)]
    fn run<'a, R: Rays<'a>>(
        tree: &BvhWide,
        batch: &mut R,
        range: Range<usize>,
        stacks: &mut Stacks,
    ) -> Shared {
        if range.is_empty() {
            return Shared::default();
        }
        let (stack, waiting) = stacks.with_group();
        waiting.shared = Shared::default();
        let mut visitors = Vec::with_capacity(GROUP);
        while visitors.len() < GROUP {
            visitors.push(batch.begin(range.start));
        }
        let mut start = range.start;
        while start < range.end {
            let mut order = [0_u32; WINDOW];
            let window = start..range.end.min(start + WINDOW);
            start = window.end;
            let next = batch.rays().as_ptr().wrapping_add(start);
            prefetch(next, WINDOW * size_of::<Ray>());
            let octants = Octants::of(batch.rays(), window, &mut order);
            for octant in octants {
                for indices in order[octant].chunks(GROUP) {
                    together(tree, batch, indices, &mut visitors, (stack, waiting));
                }
            }
        }
        waiting.shared
    }
}

/// The rays of a window by the signs of their directions.
struct Octants {
    /// Where each begins.
    starts: [usize; 9],
    next: usize,
}

/// The signs of a direction, a bit each.
#[inline(always)]
fn octant(ray: &Ray) -> usize {
    let sign = |x: f32, bit: u32| (x.to_bits() >> 31) << bit;
    (sign(ray.dir.x, 0) | sign(ray.dir.y, 1) | sign(ray.dir.z, 2)) as usize
}

impl Octants {
    /// Writes the indices of the rays in `window` to `order`, those of an octant together.
    #[inline(always)]
    fn of(rays: &[Ray], window: Range<usize>, order: &mut [u32; WINDOW]) -> Self {
        let mut starts = [0; 9];
        let lead = octant(&rays[window.start]);
        let mut differing = 0;
        for ray in &rays[window.clone()] {
            differing |= octant(ray) ^ lead;
        }
        if differing == 0 {
            for (place, index) in order.iter_mut().zip(window.clone()) {
                *place = index as u32;
            }
            starts[lead + 1..].fill(window.len());
            return Self { starts, next: 0 };
        }
        for ray in &rays[window.clone()] {
            starts[octant(ray) + 1] += 1;
        }
        for i in 1..9 {
            starts[i] += starts[i - 1];
        }
        let mut next = starts;
        for index in window {
            let place = &mut next[octant(&rays[index])];
            order[*place & (WINDOW - 1)] = index as u32;
            *place += 1;
        }
        Self { starts, next: 0 }
    }
}

impl Iterator for Octants {
    type Item = Range<usize>;

    #[inline(always)]
    fn next(&mut self) -> Option<Range<usize>> {
        let next = self.next;
        self.next += 1;
        (next < 8).then(|| self.starts[next & 7]..self.starts[(next & 7) + 1])
    }
}

/// Rays of a group under way: all from one octant.
struct Group<'g, 'a, L, V> {
    tree: &'g BvhWide,
    rays: &'a [Ray],
    /// Which of them, from one to [`GROUP`].
    indices: &'g [u32],
    slabs: SlabRays<L>,
    /// As many as a group has rays at most.
    visitors: &'g mut [V],
    /// What begins beyond these changes nothing.
    limits: [f32; GROUP],
    /// The greatest of them.
    farthest: f32,
    /// Rays whose answers can still change, a bit each.
    open: u32,
}

/// Sixteen numbers in lanes.
#[inline(always)]
fn lanes_of<L: Lane<1>>(row: &[f32; GROUP]) -> L {
    L::from_fn(|lane| row[lane & (GROUP - 1)])
}

/// Traces the rays of a group, all from one octant.
#[inline(always)]
fn together<'a, R: Rays<'a>>(
    tree: &BvhWide,
    batch: &mut R,
    indices: &[u32],
    visitors: &mut [R::Visitor],
    (stack, waiting): (&mut Stack, &mut GroupStack),
) {
    let rays = batch.rays();
    let ray = |lane: usize| &rays[indices[lane] as usize];
    let lanes = RayLanes::of::<R::Isa>(indices.len(), ray);
    let lead = octant(ray(0));
    let near = [lead & 1, lead >> 1 & 1, lead >> 2 & 1];
    for (visitor, index) in visitors.iter_mut().zip(indices) {
        batch.begin_again(*index as usize, visitor);
    }
    let mut limits = [0.0; GROUP];
    lanes.t_max.write(&mut limits);
    let sixteen = batch.sixteen(ray(0), &lanes);
    let all = (1_u32 << indices.len()) - 1;
    let mut group = Group {
        tree,
        rays,
        indices,
        slabs: SlabRays::new(&lanes, near, &tree.scene),
        visitors,
        limits,
        farthest: lanes.t_max.greatest(),
        open: all,
    };
    let lines = Lines::of(tree, batch);
    // Those that are not plain go first, and once.
    let odd = all & !group.slabs.plain;
    if odd != 0 {
        group.apart::<R::Isa>(tree.root, odd, stack);
    }
    let (mut next, mut active, mut level) = (tree.root, all & !odd, 0);
    while active != 0 {
        if active.count_ones() < FEW || level == MAX_DEPTH {
            group.apart::<R::Isa>(next, active, stack);
        } else if next.is_leaf() {
            for block in next.blocks() {
                test::<R>(batch, block, active, &sixteen, &mut group, stack);
            }
        } else {
            waiting.push::<R>(next, level, active, &group, &lines);
        }
        (next, active, level) = waiting.pop(&group);
    }
    for (lane, index) in indices.iter().enumerate() {
        batch.finish(*index as usize, &group.visitors[lane & (GROUP - 1)]);
    }
}

/// Tests the triangles of a block that the `active` rays may meet: one by one, each against sixteen rays, or, where that is
/// fewer tests, all at once against ray after ray.
#[inline(always)]
fn test<'a, R: Rays<'a>>(
    batch: &R,
    block: u32,
    active: u32,
    sixteen: &R::Sixteen,
    group: &mut Group<'_, 'a, <R::Isa as Isa>::Rays, R::Visitor>,
    stack: &mut Stack,
) {
    let open = active & group.open;
    if open == 0 {
        return;
    }
    let met = batch.met_by(block, &group.slabs.hull, group.farthest, &group.tree.scene);
    if met == 0 {
        return;
    }
    if met.count_ones() <= open.count_ones() {
        let taken = batch.test_sixteen(sixteen, open, block, met, group.visitors);
        group.update(taken);
    } else {
        group.apart::<R::Isa>(Child::leaf(block as usize, 1), open, stack);
    }
}

impl<L: Lane<1>, V: Visitor> Group<'_, '_, L, V> {
    /// Leads the `active` rays through what lies below `next`, one after another.
    #[inline(always)]
    fn apart<I: Isa>(&mut self, next: Child, active: u32, stack: &mut Stack) {
        I::enter(Apart {
            group: self,
            next,
            active,
            stack,
        });
    }

    /// Takes over the limits of the rays in these lanes.
    #[inline(always)]
    fn update(&mut self, lanes: u32) {
        if lanes == 0 {
            return;
        }
        for lane in Ones(lanes) {
            let lane = lane % GROUP;
            let limit = self.visitors[lane].t_limit();
            self.limits[lane] = limit;
            self.open &= !(u32::from(limit == f32::NEG_INFINITY) << lane);
        }
        if V::ORDERED {
            self.farthest = lanes_of::<L>(&self.limits).greatest();
        }
    }
}

/// Rays of a group that go one after another; in a function of its own.
struct Apart<'t, 'g, 'a, L, V> {
    group: &'t mut Group<'g, 'a, L, V>,
    next: Child,
    active: u32,
    stack: &'t mut Stack,
}

impl<L: Lane<1>, V: Visitor> Task for Apart<'_, '_, '_, L, V> {
    type Out = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let Group {
            tree,
            rays,
            indices,
            slabs: of_group,
            visitors,
            ..
        } = self.group;
        for lane in Ones(self.active) {
            let lane = lane % GROUP;
            let slabs = if self.next.is_leaf() {
                WideSlabRay::NONE
            } else if of_group.plain >> lane & 1 == 1 {
                of_group.ray(lane)
            } else {
                WideSlabRay::new::<I::X8>(&rays[indices[lane] as usize], &tree.scene)
            };
            let mut walk = Walk::<I>::from(slabs, self.next);
            while walk.step(tree, self.stack, &mut visitors[lane]) {}
        }
        self.group.update(self.active);
    }
}

impl GroupStack {
    /// Puts the children of a node that the `active` rays meet on top: the nearest last where order counts.
    #[inline(always)]
    fn push<'a, R: Rays<'a>>(
        &mut self,
        place: Child,
        level: usize,
        active: u32,
        group: &Group<<R::Isa as Isa>::Rays, R::Visitor>,
        lines: &Lines,
    ) {
        self.shared.nodes += 1;
        self.shared.rays += active.count_ones();
        let node = &group.tree.nodes[place.index()];
        let hull = &group.slabs.hull;
        let (entries, exits): (<R::Isa as Isa>::X8, _) = hull.clip(&node.boxes, group.farthest);
        let limits = lanes_of(&group.limits);
        let first = self.waits;
        for lane in Ones(entries.le(exits).bits()) {
            let child = node.children[lane & 7];
            let (entry, exit) = group.slabs.clip(&node.boxes, lane, limits);
            let met = entry.le(exit).bits() & active;
            let mut item = Item {
                child: Child(child),
                met,
                key: 0.0,
                slot: (level * 8 + lane) as u32,
            };
            let mut place = self.waits;
            if R::Visitor::ORDERED && met != 0 {
                // Rays that any hit will do are often over before they come to it.
                lines.fetch::<R>(item.child);
                let entries = &mut self.entries[level][lane].0;
                entry.write(entries);
                item.key = entries[met.trailing_zeros() as usize & (GROUP - 1)];
                while place > first && self.items[place - 1].key < item.key {
                    self.items[place] = self.items[place - 1];
                    place -= 1;
                }
            }
            self.items[place] = item;
            self.waits += usize::from(met != 0);
        }
    }

    /// The child on top that rays of the group may still find something in, which of them, and its level. None of them: it
    /// is over.
    #[inline(always)]
    fn pop<L: Lane<1>, V: Visitor>(&mut self, group: &Group<L, V>) -> (Child, u32, usize) {
        let limits = lanes_of::<L>(&group.limits);
        while self.waits > 0 {
            self.waits -= 1;
            let item = self.items[self.waits];
            let (level, lane) = (item.slot as usize / 8, item.slot as usize % 8);
            let mut active = item.met & group.open;
            // Where any hit will do a limit does not move until the ray is done.
            if V::ORDERED {
                let entries = lanes_of::<L>(&self.entries[level % MAX_DEPTH][lane].0);
                active &= entries.le(limits).bits();
            }
            if active != 0 {
                return (item.child, active, level + 1);
            }
        }
        (Child::NONE, 0, 0)
    }
}
