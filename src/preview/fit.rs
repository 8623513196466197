//! The best two colours for the blocks of a cell.
//!
//! Splitting blocks into two sets and giving each its mean colour leaves the squared error Σ|x|² − |S₁|²/n₁ − |S₂|²/n₂,
//! with S the sum and n the number of a set's colours. So the best split is the one where the two quotients add up to
//! most; with eight blocks there are 128 splits, and all are tried.

/// Blocks in the foreground colour as bits, and both colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Fit {
    /// Bit `i`: block `i` has the foreground colour. Bit 0 is never set, so a cell has one way to be written.
    pub pattern: usize,
    /// Foreground; as the background where `pattern` is 0.
    pub fg: [u8; 3],
    /// Background.
    pub bg: [u8; 3],
}

/// The split of at most eight blocks that leaves the least squared error; the lowest pattern of equals.
pub(super) fn fit(blocks: &[[u8; 3]]) -> Fit {
    let total = sum(blocks, usize::MAX);
    let count = blocks.len() as i64;
    let quality = |pattern: usize| {
        let fg = sum(blocks, pattern);
        let n = i64::from(pattern.count_ones());
        let bg: [i64; 3] = std::array::from_fn(|i| total[i] - fg[i]);
        let square = |s: [i64; 3]| s.iter().map(|x| x * x).sum::<i64>();
        // Both quotients over the common denominator, as a fraction.
        if n == 0 {
            (square(bg), count)
        } else {
            (square(fg) * (count - n) + square(bg) * n, n * (count - n))
        }
    };
    let (mut best, mut best_quality) = (0, quality(0));
    for pattern in (2..1 << blocks.len()).step_by(2) {
        let (a, b) = (quality(pattern), best_quality);
        if a.0 * b.1 > b.0 * a.1 {
            (best, best_quality) = (pattern, a);
        }
    }
    let n = i64::from(best.count_ones());
    let fg = sum(blocks, best);
    let bg: [i64; 3] = std::array::from_fn(|i| total[i] - fg[i]);
    let bg = mean(bg, count - n);
    Fit {
        pattern: best,
        fg: if n == 0 { bg } else { mean(fg, n) },
        bg,
    }
}

/// The sum of the colours whose bit is set.
fn sum(blocks: &[[u8; 3]], pattern: usize) -> [i64; 3] {
    let mut sum = [0; 3];
    for (_, block) in (blocks.iter().enumerate()).filter(|(i, _)| pattern >> i & 1 == 1) {
        for (sum, &x) in sum.iter_mut().zip(block) {
            *sum += i64::from(x);
        }
    }
    sum
}

/// The rounded mean of `n > 0` colours with that sum.
fn mean(sum: [i64; 3], n: i64) -> [u8; 3] {
    sum.map(|x| ((2 * x + n) / (2 * n)) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn error(blocks: &[[u8; 3]], fit: &Fit) -> i64 {
        let of = |(i, block): (usize, &[u8; 3])| {
            let shown = if fit.pattern >> i & 1 == 1 {
                fit.fg
            } else {
                fit.bg
            };
            (0..3)
                .map(|c| (i64::from(block[c]) - i64::from(shown[c])).pow(2))
                .sum::<i64>()
        };
        blocks.iter().enumerate().map(of).sum()
    }

    #[test]
    fn two_colours_are_kept_exactly_wherever_they_are() {
        let (a, b) = ([10, 20, 30], [200, 100, 0]);
        let blocks = [a, b, b, a, b, a, a, a];
        let fit = fit(&blocks);
        assert_eq!(
            fit,
            Fit {
                pattern: 0b1_0110,
                fg: b,
                bg: a
            }
        );
    }

    #[test]
    fn one_colour_has_no_foreground() {
        assert_eq!(fit(&[[7; 3]; 6]).pattern, 0);
        assert_eq!(
            fit(&[[7; 3]]),
            Fit {
                pattern: 0,
                fg: [7; 3],
                bg: [7; 3]
            }
        );
    }

    proptest! {
        #[test]
        fn no_other_split_is_better(blocks in prop::collection::vec(any::<[u8; 3]>(), 2..=8)) {
            let best = error(&blocks, &fit(&blocks));
            for pattern in (2..1 << blocks.len()).step_by(2) {
                let n = i64::from(usize::count_ones(pattern));
                let all = (1 << blocks.len()) - 1;
                let fg = mean(sum(&blocks, pattern), n);
                let bg = mean(sum(&blocks, all & !pattern), blocks.len() as i64 - n);
                // Means are rounded: half a step a channel and block is the room for that.
                let room = blocks.len() as i64;
                let other = error(&blocks, &Fit { pattern, fg, bg });
                prop_assert!(best <= other + room);
            }
        }
    }
}
