//! The nodes that wait while a ray goes down a tree.
//!
//! At most one node waits a level, so a tree no deeper than [`MAX_DEPTH`] never overflows it. The builders keep to that
//! depth and `validate` checks it.

/// No leaf of any tree lies deeper than this. A balanced tree of 2³¹ triangles has depth 31.
pub(super) const MAX_DEPTH: usize = 64;

/// A node that waits, and the ray's interval in it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Waiting {
    pub(super) node: u32,
    pub(super) entry: f32,
    pub(super) exit: f32,
}

/// Room for the nodes that wait: what a thread needs to traverse a tree. Made once a batch, since clearing it for each
/// ray would cost as much as a dozen steps.
pub type Room = [Waiting; MAX_DEPTH];

/// An empty room.
pub(super) fn room() -> Room {
    [Waiting::default(); MAX_DEPTH]
}

/// A stack in a room.
pub(super) struct Stack<'a> {
    room: &'a mut Room,
    waiting: usize,
}

impl<'a> Stack<'a> {
    #[inline(always)]
    pub fn new(room: &'a mut Room) -> Self {
        Self { room, waiting: 0 }
    }

    #[inline(always)]
    pub fn push(&mut self, node: u32, entry: f32, exit: f32) {
        self.room[self.waiting] = Waiting { node, entry, exit };
        self.waiting += 1;
    }

    /// The node pushed last that begins at `limit` or before; those beyond it are dropped.
    #[inline(always)]
    pub fn pop(&mut self, limit: f32) -> Option<Waiting> {
        while self.waiting > 0 {
            self.waiting -= 1;
            let next = self.room[self.waiting];
            if next.entry <= limit {
                return Some(next);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_begins_at_the_limit_is_kept_and_what_begins_beyond_is_dropped() {
        let mut room = room();
        let mut stack = Stack::new(&mut room);
        stack.push(1, 0.5, 9.0);
        stack.push(2, 2.0, 9.0);
        stack.push(3, 1.0, 9.0);
        stack.push(4, 1.0_f32.next_up(), 9.0);
        let popped: Vec<_> = std::iter::from_fn(|| stack.pop(1.0))
            .map(|w| w.node)
            .collect();
        assert_eq!(popped, [3, 1]);
    }
}
