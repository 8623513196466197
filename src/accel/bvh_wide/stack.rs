//! The children that wait while a ray goes down a wide tree, each with its key.

use crate::geometry::lanes::{Isa, Lane};

use super::super::stack::MAX_DEPTH;
use super::Child;
use super::hybrid::GroupStack;

/// Most children that wait: seven a level, and room for a whole vector behind the last.
const ROOM: usize = 7 * MAX_DEPTH + 8;

/// Room for the children that wait for one ray.
pub struct Stack {
    children: [u32; ROOM],
    keys: [f32; ROOM],
}

/// The bits of a key that are an entry's; the others are the lane's number.
const ENTRY_BITS: u32 = !7;

/// Rays that are interleaved.
pub(super) const FLIGHTS: usize = 16;

/// Stacks for the rays that are under way: what a thread needs to traverse a wide tree.
#[derive(Default)]
pub struct Stacks {
    single: Vec<Stack>,
    group: Option<Box<GroupStack>>,
}

impl Stacks {
    /// The first `count` stacks, made where there are fewer.
    #[inline(always)]
    pub(super) fn first(&mut self, count: usize) -> &mut [Stack] {
        while self.single.len() < count {
            self.single.push(Stack::new());
        }
        &mut self.single[..count]
    }

    /// A stack for one ray.
    #[inline(always)]
    pub(super) fn one(&mut self) -> &mut Stack {
        &mut self.first(1)[0]
    }

    /// A stack for one ray, and one for a group.
    pub(super) fn with_group(&mut self) -> (&mut Stack, &mut GroupStack) {
        self.first(1);
        (&mut self.single[0], self.group.get_or_insert_default())
    }
}

impl Stack {
    fn new() -> Self {
        Self {
            children: [Child::NONE.0; ROOM],
            keys: [0.0; ROOM],
        }
    }

    /// Room for eight above the first `waiting`: for children, and for keys.
    #[inline(always)]
    fn above(&mut self, waiting: usize) -> Option<(&mut [u32; 8], &mut [f32; 8])> {
        let places = waiting..waiting + 8;
        Some((
            self.children[places.clone()].first_chunk_mut()?,
            self.keys[places].first_chunk_mut()?,
        ))
    }

    /// Puts those of `children` whose bit is set in `met` above the first `waiting`, the nearest on top if they are to be
    /// `ordered`; returns the place of the one on top.
    #[inline(always)]
    pub(super) fn push<I: Isa>(
        &mut self,
        waiting: usize,
        entries: I::X8,
        met: u32,
        children: &[u32; 8],
        ordered: bool,
    ) -> usize {
        let Some((above, keys)) = self.above(waiting) else {
            return waiting;
        };
        let positive = entries.max(I::X8::splat(0.0));
        if ordered {
            I::greatest_first(positive, met, children, above, keys);
        } else {
            I::compress(positive, met, children, above, keys);
        }
        waiting + met.count_ones() as usize - 1
    }

    /// The child at a place, and a bound on its entry: not later than that, where that is positive.
    #[inline(always)]
    pub(super) fn at(&self, place: usize) -> (Child, f32) {
        let key = self.keys[place].to_bits() & ENTRY_BITS;
        (Child(self.children[place]), f32::from_bits(key))
    }
}
