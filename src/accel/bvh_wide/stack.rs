//! The children that wait while a ray goes down a wide tree, each with its key.

use crate::geometry::lanes::{Isa, Lane, LaneMask};

use super::super::stack::MAX_DEPTH;
use super::Child;
use super::hybrid::GroupStack;

/// Most children that wait: seven a level, below them what ends a walk, and room for a whole vector behind the last.
const ROOM: usize = 7 * MAX_DEPTH + 9;

/// Room for the children that wait for one ray. Below them all lies [`Child::END`], so that what is taken last ends its
/// walk.
pub struct Stack {
    children: [u32; ROOM],
    keys: [f32; ROOM],
}

/// The bits of a key that are an entry's; the others are the lane's number.
const ENTRY_BITS: u32 = !7;

/// Rays that are interleaved: no more than a word has bits.
pub(super) const FLIGHTS: usize = 32;

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
            children: [Child::END.0; ROOM],
            keys: [0.0; ROOM],
        }
    }

    /// Room for eight above the `waiting`: for children, and for keys.
    #[inline(always)]
    fn above(&mut self, waiting: usize) -> Option<(&mut [u32; 8], &mut [f32; 8])> {
        let places = waiting + 1..waiting + 9;
        Some((
            self.children[places.clone()].first_chunk_mut()?,
            self.keys[places].first_chunk_mut()?,
        ))
    }

    /// Puts those of `children` whose bit is set in `met` above the `waiting`, the nearest on top if they are to be
    /// `ordered`; returns how many wait then.
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
        waiting + met.count_ones() as usize
    }

    /// Drops what begins beyond `limit`, which is finite, of the `waiting`; returns how many stay.
    #[inline(always)]
    pub(super) fn keep<I: Isa>(&mut self, waiting: usize, limit: f32) -> usize {
        // Keys are entries, but not less than 0, and lanes in their last bits.
        let limit = I::X8::splat(f32::from_bits(limit.max(0.0).to_bits() | !ENTRY_BITS));
        let (mut kept, mut seen) = (0, 0);
        while seen < waiting {
            let Some((children, keys)) = self.above(seen) else {
                break;
            };
            let (children, keys) = (*children, I::X8::load(keys));
            let within = keys.le(limit).bits() & ((1 << (waiting - seen).min(8)) - 1);
            if let Some((children_kept, keys_kept)) = self.above(kept) {
                I::compress(keys, within, &children, children_kept, keys_kept);
            }
            kept += within.count_ones() as usize;
            seen += 8;
        }
        kept
    }

    /// The child on top of the `waiting`.
    #[inline(always)]
    pub(super) fn top(&self, waiting: usize) -> Child {
        Child(self.children[waiting])
    }

    /// A bound on its entry: not later than that, where that is positive.
    #[inline(always)]
    pub(super) fn top_entry(&self, waiting: usize) -> f32 {
        f32::from_bits(self.keys[waiting].to_bits() & ENTRY_BITS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::lanes::{InstructionSet, Task};

    /// Puts 30 children on a stack, eight at a time and each with its key, drops those beyond a limit and gives the rest.
    struct Kept {
        limit: f32,
    }

    impl Task for Kept {
        type Out = Vec<(u32, f32)>;

        #[inline(always)]
        fn run<I: Isa>(self) -> Self::Out {
            let mut stack = Stack::new();
            let mut waiting = 0;
            for group in 0..5_u32 {
                let children = [0, 1, 2, 3, 4, 5, 6, 7].map(|lane| 8 * group + lane);
                // From -2 on, so that some entries are negative.
                let keys = I::X8::from_fn(|lane| (7 * (lane + group as usize) % 11) as f32 - 2.0);
                waiting = stack.push::<I>(waiting, keys, 0b0111_1011, &children, true);
            }
            let kept = stack.keep::<I>(waiting, self.limit);
            let all = (1..=kept).map(|place| (stack.top(place).0, stack.top_entry(place)));
            assert_eq!(stack.top(0), Child::END);
            all.collect()
        }
    }

    #[test]
    fn what_begins_beyond_a_limit_is_dropped_and_the_rest_keeps_its_order() {
        let sets = InstructionSet::ALL.into_iter();
        for set in sets.filter(|set| set.is_available()) {
            let all = set.run(Kept { limit: 100.0 });
            assert_eq!(all.len(), 30);
            for limit in [-1.0, 0.0, 0.5, 3.0, 7.5, 8.0, f32::MAX] {
                let kept = set.run(Kept { limit });
                let least = limit.max(0.0);
                let expected: Vec<_> = all.iter().filter(|(_, key)| *key <= least).collect();
                assert!(kept.iter().eq(expected), "{set}, {limit}");
            }
        }
    }
}
