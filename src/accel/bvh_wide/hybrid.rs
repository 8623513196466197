//! Sixteen rays go down the tree together while several of them visit the same nodes; below that each goes alone.
//!
//! ```text
//! window of 128 rays -> by octant -> groups of 16 -> root: one box at a time, a lane a ray
//!                                                     |   |
//!                                    many lanes go on o   o few lanes go on: each ray walks this subtree alone
//! ```
//!
//! A node costs sixteen rays together about twice what it costs one, and nothing that was predicted wrong. A leaf is tested
//! ray by ray, eight triangles at once, or triangle by triangle, sixteen rays at once, whichever are fewer tests.
//!
//! **Source:** C. Benthin, I. Wald, S. Woop, M. Ernst and W. Mark, "Combining Single and Packet-Ray Tracing for Arbitrary Ray
//! Distributions on the Intel MIC Architecture", TVCG 2012. **Differs:** rays are grouped by octant first.

use std::marker::PhantomData;
use std::ops::Range;

use crate::geometry::Ray;
use crate::geometry::lanes::{Isa, Lane, LaneMask, Ones, RayLanes, SIXTEEN, Task};

use super::super::slab::{SlabRays, WideSlabRay};
use super::super::stack::MAX_DEPTH;
use super::super::{Rays, Visitor};
use super::stack::{Stack, Stacks};
use super::walk::Walk;
use super::{BvhWide, Child, Node};

/// Rays of a group.
const GROUP: usize = SIXTEEN;

/// Rays that are looked at together to make groups.
pub(super) const WINDOW: usize = 128;

/// So many rays of a group at a node, in the mean, cost less together than in turns: as measured with shadow rays, which
/// share 12 or 13 of 16 where groups win, and bounce rays, which share 10 where both are alike.
const MANY: u32 = 11;

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
    /// Whether that was enough for a group to pay.
    pub fn pays(self) -> bool {
        self.rays >= MANY * self.nodes
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

/// Traces the rays of `batch` in `range`.
#[inline(always)]
pub(super) fn trace<'a, R: Rays<'a>>(
    tree: &BvhWide,
    batch: &mut R,
    range: Range<usize>,
    stacks: &mut Stacks,
) -> Shared {
    R::Isa::enter(Hybrid {
        tree,
        batch,
        range,
        stacks,
        lifetime: PhantomData,
    })
}

/// Rays that are traced in groups, in a function of its own; see [`super::super::packets`].
struct Hybrid<'t, 'a, R: Rays<'a>> {
    tree: &'t BvhWide,
    batch: &'t mut R,
    range: Range<usize>,
    stacks: &'t mut Stacks,
    lifetime: PhantomData<&'a ()>,
}

impl<'a, R: Rays<'a>> Task for Hybrid<'_, 'a, R> {
    type Out = Shared;

    #[inline(always)]
    fn run<I: Isa>(self) -> Shared {
        if self.range.is_empty() {
            return Shared::default();
        }
        let (tree, batch) = (self.tree, self.batch);
        let (stack, waiting) = self.stacks.with_group();
        waiting.shared = Shared::default();
        let mut visitors = Vec::with_capacity(GROUP);
        while visitors.len() < GROUP {
            visitors.push(batch.begin(self.range.start));
        }
        let mut start = self.range.start;
        while start < self.range.end {
            let mut order = [0_u32; WINDOW];
            let window = start..self.range.end.min(start + WINDOW);
            start = window.end;
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

/// Rays of a group under way.
struct Group<'v, L, V> {
    slabs: SlabRays<L>,
    /// Which of them `slabs` holds for.
    plain: u32,
    /// As many as a group has rays at most.
    visitors: &'v mut [V],
    /// What begins beyond these changes nothing.
    limits: [f32; GROUP],
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
    let (slabs, plain) = SlabRays::new(&lanes, near, &tree.scene);
    for (visitor, index) in visitors.iter_mut().zip(indices) {
        batch.begin_again(*index as usize, visitor);
    }
    let all = (1_u32 << indices.len()) - 1;
    let mut limits = [0.0; GROUP];
    lanes.t_max.write(&mut limits);
    let sixteen = batch.sixteen(ray(0), &lanes);
    let mut group = Group {
        slabs,
        plain,
        visitors,
        limits,
        open: all,
    };
    let (mut next, mut level, mut together) = (tree.root, 0, all & plain);
    let mut apart = all & !plain;
    // Those that are not plain go first, and once.
    while together | apart != 0 {
        if apart == 0 && !next.is_leaf() && together.count_ones() >= FEW && level < MAX_DEPTH {
            waiting.push(&tree.nodes[next.0 as usize], level, together, &group);
        } else if let Some(sixteen) = &sixteen
            && apart == 0
            && pays_together(tree, next, together)
        {
            for block in next.blocks() {
                let open = together & group.open;
                batch.test_sixteen(sixteen, open, block, group.visitors);
                for lane in Ones(open) {
                    group.update(lane % GROUP);
                }
            }
        } else {
            let active = if apart == 0 { together } else { apart };
            R::Isa::enter(Apart {
                tree,
                group: &mut group,
                next,
                active,
                ray,
                stack,
            });
            if std::mem::take(&mut apart) != 0 {
                continue;
            }
        }
        (next, together, level) = waiting.pop(&group);
    }
    for (lane, index) in indices.iter().enumerate() {
        batch.finish(*index as usize, &group.visitors[lane & (GROUP - 1)]);
    }
}

/// Whether to test the triangles of a leaf one by one, each against sixteen rays, costs less than to test the `active` rays
/// one by one, each against blocks of eight triangles.
#[inline(always)]
fn pays_together(tree: &BvhWide, next: Child, active: u32) -> bool {
    next.is_leaf() && tree.references(next) < active.count_ones() * next.blocks().len() as u32
}

impl<L, V: Visitor> Group<'_, L, V> {
    /// Takes over the limit of the ray in a lane.
    #[inline(always)]
    fn update(&mut self, lane: usize) {
        let limit = self.visitors[lane].t_limit();
        self.limits[lane] = limit;
        self.open &= !(u32::from(limit == f32::NEG_INFINITY) << lane);
    }
}

/// Leads the `active` rays of a group through what lies below `next`, one after another.
struct Apart<'t, 'v, L, V, F> {
    tree: &'t BvhWide,
    group: &'t mut Group<'v, L, V>,
    next: Child,
    active: u32,
    /// The ray in a lane.
    ray: F,
    stack: &'t mut Stack,
}

impl<'r, L: Lane<1>, V: Visitor, F: Fn(usize) -> &'r Ray> Task for Apart<'_, '_, L, V, F> {
    type Out = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let Self { tree, group, .. } = self;
        for lane in Ones(self.active) {
            let lane = lane % GROUP;
            let slabs = if self.next.is_leaf() {
                WideSlabRay::NONE
            } else if group.plain >> lane & 1 == 1 {
                group.slabs.ray(lane)
            } else {
                WideSlabRay::new::<I::X8>((self.ray)(lane), &tree.scene)
            };
            let visitor = &mut group.visitors[lane];
            let mut walk = Walk::<I>::from(slabs, self.next);
            while walk.step(tree, self.stack, visitor) {}
            group.update(lane);
        }
    }
}

impl GroupStack {
    /// Puts the children of a node that the `active` rays meet on top: the nearest last where order counts.
    #[inline(always)]
    fn push<L: Lane<1>, V: Visitor>(
        &mut self,
        node: &Node,
        level: usize,
        active: u32,
        group: &Group<L, V>,
    ) {
        self.shared.nodes += 1;
        self.shared.rays += active.count_ones();
        let limits = lanes_of(&group.limits);
        let first = self.waits;
        for (lane, child) in node.children.iter().enumerate() {
            let (entry, exit) = group.slabs.clip(&node.boxes, lane, limits);
            let met = entry.le(exit).bits() & active;
            let mut item = Item {
                child: Child(*child),
                met,
                key: 0.0,
                slot: (level * 8 + lane) as u32,
            };
            let mut place = self.waits;
            if V::ORDERED && met != 0 {
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
