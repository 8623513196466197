//! Which cells list triangles, and in which blocks these are.
//!
//! ```text
//! words   | …0010000100… , 7 before |   a bit a cell, and how many bits are set in the words before
//!                 |
//! spans   | … | block 41, 2 of them | …   one a listed cell, in the order of cells
//! ```

use std::ops::Range;

use super::super::parallel::{self, MANY};
use super::super::share::Span;
use super::bricks::BRICK;

/// The cells whose bits are here.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(16))]
struct Word {
    listed: u64,
    before: u32,
}

/// Cells of a word, which are those of a brick.
const CELLS: usize = BRICK;

/// The listed cells, and the span of each.
#[derive(Debug)]
pub(super) struct Cells {
    words: Vec<Word>,
    pub spans: Vec<Span>,
}

impl Cells {
    /// The cells of `count` bricks, of each of which `listed` gives the bits, still without spans.
    pub fn new(count: usize, listed: impl Fn(usize) -> u64 + Sync) -> Self {
        let word = |brick| Word {
            listed: listed(brick),
            before: 0,
        };
        let mut words = parallel::map(count, MANY, word);
        let mut before = 0;
        for word in &mut words {
            word.before = before;
            before += word.listed.count_ones();
        }
        Self {
            words,
            spans: vec![Span::default(); before as usize],
        }
    }

    /// The place of a cell in the spans; `None` if it lists nothing.
    pub fn rank(&self, cell: usize) -> Option<usize> {
        let word = self.words[cell / CELLS];
        (word.listed >> (cell % CELLS) & 1 == 1).then(|| word.rank(cell))
    }

    /// The span of a cell that lists triangles; that of some other where it does not.
    #[inline(always)]
    pub fn span(&self, cell: usize) -> Span {
        self.spans[self.words[cell / CELLS].rank(cell)]
    }

    /// Which of the four cells from this one on list triangles, a bit each.
    #[inline(always)]
    pub fn four(&self, cell: usize) -> u32 {
        (self.words[cell / CELLS].listed >> (cell % CELLS)) as u32 & 15
    }

    /// Calls `found` with every cell in `range` that lists triangles.
    pub fn each_listed(&self, range: Range<usize>, mut found: impl FnMut(usize)) {
        let mut cell = range.start;
        while cell < range.end {
            let rest = self.words[cell / CELLS].listed >> (cell % CELLS);
            let next = cell + rest.trailing_zeros() as usize;
            if rest == 0 {
                cell = (cell / CELLS + 1) * CELLS;
            } else if next < range.end {
                found(next);
                cell = next + 1;
            } else {
                return;
            }
        }
    }

    /// Bytes of both arrays.
    pub fn bytes(&self) -> u64 {
        (size_of_val(self.words.as_slice()) + size_of_val(self.spans.as_slice())) as u64
    }
}

impl Word {
    #[inline(always)]
    fn rank(self, cell: usize) -> usize {
        let below = self.listed & !(u64::MAX << (cell % CELLS));
        (self.before + below.count_ones()) as usize
    }
}

/// Bytes of the bits of this many cells.
pub(super) fn bytes(cells: u64) -> u64 {
    cells
        .div_ceil(CELLS as u64)
        .saturating_mul(size_of::<Word>() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn listed_cells_are_numbered_in_order_and_the_others_are_none() {
        let listed = |cell: usize| cell % 7 == 3 || (64..140).contains(&cell);
        for count in [0, 1, 63, 64, 65, 128, 1000] {
            let bits = |word: usize| {
                let cells = word * CELLS..count.min((word + 1) * CELLS);
                cells.fold(0, |bits, c| bits | u64::from(listed(c)) << (c % CELLS))
            };
            let cells = Cells::new(count.div_ceil(CELLS), bits);
            let right: Vec<usize> = (0..count).filter(|c| listed(*c)).collect();
            let mut found = Vec::new();
            cells.each_listed(0..count, |cell| found.push(cell));
            assert_eq!(found, right);
            assert_eq!(cells.spans.len(), right.len());
            for cell in 0..count {
                assert_eq!(cells.rank(cell), right.iter().position(|c| *c == cell));
                let four = (0..4).filter(|k| cell % 4 == 0 && listed(cell + k) && cell + k < count);
                let four = four.fold(0, |bits, k| bits | 1 << k);
                assert!(cell % 4 != 0 || cells.four(cell) == four);
            }
            for (start, end) in [(3, 64), (64, 90), (65, 66), (70, 300)] {
                let mut found = Vec::new();
                let range = start.min(count)..end.min(count);
                cells.each_listed(range.clone(), |cell| found.push(cell));
                let right = right.iter().copied().filter(|c| range.contains(c));
                assert!(right.eq(found.iter().copied()), "{range:?}");
            }
        }
    }
}
