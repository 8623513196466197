//! Puts what cells list into blocks of eight triangles; cells that together list at most eight share one.
//!
//! ```text
//!  +----+----+
//!  | a  | ab |      a, b, c, d: one block | a b c d d d d d |, listed by all four cells
//!  +----+----+
//!  | ac | cd |      a ray that goes on in it tests it once
//!  +----+----+
//! ```
//!
//! A test costs the same whether a block is full or not, so sharing costs a ray nothing; blocks get fuller, so they are
//! fewer and stay in the caches. Whoever calls hands in cells one beside another, so that a block's triangles are near
//! each other.

use std::ops::Range;

use super::items::{LANES, fill};

/// Blocks that a cell lists.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Span {
    pub first: u32,
    pub count: u32,
}

impl Span {
    /// The blocks.
    #[inline(always)]
    pub fn blocks(self) -> Range<u32> {
        self.first..self.first + self.count
    }

    /// As [`Span::blocks`], of an array.
    fn places(self) -> Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }

    /// The triangles in the lanes of its blocks, of those of all blocks.
    pub fn lanes(self, all: &[u32]) -> &[u32] {
        let blocks = self.places();
        &all[blocks.start * LANES..blocks.end * LANES]
    }

    /// Triangles in the blocks, of which each holds as many as `filled` says.
    pub fn references(self, filled: &[u8]) -> u32 {
        let blocks = self.places();
        filled[blocks].iter().map(|count| u32::from(*count)).sum()
    }
}

/// Bytes of a block: its triangles as most kernels keep them, and their indices twice, since they are known before they
/// are packed.
pub(super) const BLOCK_BYTES: u64 = LANES as u64 * (48 + 2 * size_of::<u32>() as u64);

/// Triangles in blocks.
#[derive(Debug, Default)]
pub(super) struct Shared {
    /// The triangle in each lane.
    pub slots: Vec<u32>,
    /// Triangles in each block; the rest of its lanes repeat the last.
    pub filled: Vec<u8>,
    /// The span of each cell, by the key with which it was handed in.
    pub spans: Vec<(u32, Span)>,
}

impl Shared {
    /// Puts what these cells list into blocks: each has a key, and lists at least one
    /// triangle, in ascending order.
    pub fn put<'a>(&mut self, cells: impl Iterator<Item = (u32, &'a [u32])>) {
        let mut open: Vec<u32> = Vec::with_capacity(LANES);
        let mut sharing = Vec::new();
        for (key, list) in cells {
            if list.len() > LANES {
                let span = self.close(list);
                self.spans.push((key, span));
                continue;
            }
            let is_new = |open: &[u32], prim: &&u32| !open.contains(prim);
            let new = list.iter().filter(|prim| is_new(&open, prim)).count();
            if open.len() + new > LANES {
                self.close_for(&open, &mut sharing);
                open.clear();
            }
            for prim in list {
                if is_new(&open, &prim) {
                    open.push(*prim);
                }
            }
            sharing.push(key);
        }
        self.close_for(&open, &mut sharing);
    }

    /// Takes over the blocks of `part`, and its spans with keys that are greater by `first_key`.
    pub fn append(&mut self, part: Self, first_key: u32) {
        let first_block = self.filled.len() as u32;
        self.slots.extend(part.slots);
        self.filled.extend(part.filled);
        self.spans.extend(part.spans.iter().map(|(key, span)| {
            let first = first_block + span.first;
            (first_key + key, Span { first, ..*span })
        }));
    }

    /// Bytes of the blocks when they are packed.
    pub fn bytes(&self) -> u64 {
        self.filled.len() as u64 * BLOCK_BYTES
    }

    /// Makes a block of `open` and gives it to the cells that share it.
    fn close_for(&mut self, open: &[u32], sharing: &mut Vec<u32>) {
        if sharing.is_empty() {
            return;
        }
        let span = self.close(open);
        self.spans.extend(sharing.drain(..).map(|key| (key, span)));
    }

    /// Makes blocks of `prims`, of which there is at least one.
    fn close(&mut self, prims: &[u32]) -> Span {
        let first = self.filled.len() as u32;
        fill(&mut self.slots, prims);
        let filled = prims.chunks(LANES).map(|lanes| lanes.len() as u8);
        self.filled.extend(filled);
        let count = self.filled.len() as u32 - first;
        Span { first, count }
    }
}

/// Whether all of `spans` lie among the blocks, and these among `lanes`.
///
/// # Errors
/// A sentence that names the first broken promise.
pub(super) fn validate(
    filled: &[u8],
    lanes: &[u32],
    mut spans: impl Iterator<Item = Span>,
) -> Result<(), String> {
    let blocks = filled.len();
    if lanes.len() != blocks * LANES {
        return Err(format!("{} lanes do not fill {blocks} blocks", lanes.len()));
    }
    let is_beyond = |span: &Span| u64::from(span.first) + u64::from(span.count) > blocks as u64;
    if let Some(span) = spans.find(is_beyond) {
        return Err(format!("{span:?} is not among the {blocks} blocks"));
    }
    for (block, (count, lanes)) in filled.iter().zip(lanes.as_chunks::<LANES>().0).enumerate() {
        let count = usize::from(*count);
        let is_filled = (1..=LANES).contains(&count)
            && lanes[..count].windows(2).all(|pair| pair[0] != pair[1])
            && lanes[count..].iter().all(|prim| *prim == lanes[count - 1]);
        if !is_filled {
            return Err(format!("block {block} does not hold {count} triangles"));
        }
    }
    Ok(())
}

/// Whether the blocks of `span` hold `prim`. A list of several blocks ascends, as it was handed in.
pub(super) fn holds(span: Span, lanes: &[u32], prim: u32) -> bool {
    let lanes = span.lanes(lanes);
    if span.count > 1 {
        lanes.binary_search(&prim).is_ok()
    } else {
        lanes.contains(&prim)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_share_a_block_until_it_is_full_and_long_lists_have_their_own() {
        let long: Vec<u32> = (100..117).collect();
        let cells: [(u32, &[u32]); 5] = [
            (10, &[1, 2, 3]),
            (11, &[2, 3, 4, 5, 6]),
            (12, &long),
            (13, &[1, 7, 8]),
            (14, &[8, 9]),
        ];
        let mut shared = Shared::default();
        shared.put(cells.into_iter());
        let of = |key: u32| {
            let found = shared.spans.iter().find(|(k, _)| *k == key);
            found.map(|(_, span)| *span).unwrap()
        };
        assert_eq!(of(10), of(11));
        assert_eq!(
            of(10),
            of(13),
            "a long list between them keeps nothing apart"
        );
        assert_ne!(of(10), of(14), "a ninth triangle needs another block");
        assert_eq!(of(12).count, 3);
        assert_eq!(of(12).references(&shared.filled), 17);
        assert_eq!(of(10).references(&shared.filled), 8);
        for (key, list) in cells {
            assert!(list.iter().all(|prim| holds(of(key), &shared.slots, *prim)));
        }
        let spans = || shared.spans.iter().map(|(_, span)| *span);
        validate(&shared.filled, &shared.slots, spans()).unwrap();
        assert!(validate(&shared.filled[1..], &shared.slots[LANES..], spans()).is_err());
        assert!(validate(&[8, 8, 8, 8, 2], &shared.slots, spans()).is_err());
    }

    #[test]
    fn what_is_appended_keeps_its_triangles() {
        let (mut all, mut part) = (Shared::default(), Shared::default());
        all.put([(0, [5_u32, 6].as_slice())].into_iter());
        part.put([(0, [7_u32].as_slice())].into_iter());
        all.append(part, 1);
        let (key, span) = all.spans[1];
        assert_eq!(key, 1);
        assert!(holds(span, &all.slots, 7) && !holds(span, &all.slots, 5));
    }
}
