//! How far a ray may leap: for each cell and each of eight directions, the edge of the empty cube ahead of it, in cells.
//!
//! ```text
//!   +---+---+---+---+---+
//!   | 3 | 3 | 2 | 1 | # |      towards +x +y, `#` lists triangles: from `3` a ray may leave
//!   +---+---+---+---+---+      the 3 × 3 cells up and to the right at once
//!   | 4 | 3 | 2 | 1 | 1 |
//!   +---+---+---+---+---+      towards -x the same cells have other numbers: behind `#` they are large at once
//! ```
//!
//! **Source:** D. Cohen and Z. Sheffer, "Proximity clouds: an acceleration technique for 3D grid traversal", The Visual
//! Computer 11, 1994, for the chessboard distance; A. Es and V. İşler, "Accelerated regular grid traversals using extended
//! anisotropic chessboard distance fields on a parallel stream processor", JPDC 67, 2007, for one distance a direction.
//! **Differs:** a row of cells is found at once, by doubling its steps.

use rayon::prelude::*;

use crate::geometry::lanes::{InstructionSet, Isa, Task};

use super::super::pages;
use super::bricks::{Bricks, EDGE};
use super::cells::Cells;

/// Directions: bit a is set where a ray goes down axis a.
pub(super) const OCTANTS: usize = 8;

/// Greatest distance; what is farther, and what lies outside the grid, counts as this.
const FAR: u8 = u8::MAX;

/// The distances of all cells, direction after direction. 0: the cell lists triangles.
pub(super) fn distances(cells: &Cells, bricks: &Bricks, dims: [u32; 3]) -> Vec<u8> {
    let count = bricks.len();
    let mut all = pages::zeroed(OCTANTS * count);
    let set = InstructionSet::best();
    all.par_chunks_mut(count.max(1))
        .enumerate()
        .for_each(|(octant, distances)| {
            set.run(Fill {
                octant,
                distances,
                cells,
                bricks,
                dims,
            });
        });
    all
}

/// Fills in the distances of one direction, from the far end of the grid to the near one.
struct Fill<'a> {
    octant: usize,
    distances: &'a mut [u8],
    cells: &'a Cells,
    bricks: &'a Bricks,
    dims: [u32; 3],
}

impl Task for Fill<'_> {
    type Out = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let [nx, ny, nz] = self.dims.map(|n| n as usize);
        // Rows have whole bricks. What lies beyond the grid is never listed, and nothing is listed behind it.
        let nx = nx.next_multiple_of(EDGE);
        let down = |axis: usize| self.octant >> axis & 1 == 1;
        // Rows run with the ray: place c is cell c, or cell nx - 1 - c. Behind the last row and column lies the outside.
        let outside = vec![FAR; nx];
        let mut behind = vec![FAR; nx * ny];
        let mut ahead = vec![FAR; nx * ny];
        for z in (0..nz).map(|k| if down(2) { k } else { nz - 1 - k }) {
            for k in 0..ny {
                let y = if down(1) { k } else { ny - 1 - k };
                let (before, row) = ahead.split_at_mut(k * nx);
                let row = &mut row[..nx];
                let in_plane = if k > 0 {
                    &before[(k - 1) * nx..]
                } else {
                    &outside
                };
                let across = if k > 0 {
                    &behind[(k - 1) * nx..k * nx]
                } else {
                    &outside
                };
                nearest(row, in_plane, &behind[k * nx..(k + 1) * nx], across);
                let place = |x: usize| if down(0) { nx - EDGE - x } else { x };
                let turned = |mut four: [u8; EDGE]| {
                    if down(0) {
                        four.reverse();
                    }
                    four
                };
                for (x, cell) in self.bricks.row(y as u32, z as u32) {
                    let four = self.cells.four(cell);
                    if four != 0 {
                        let empty = turned(std::array::from_fn(|k| (!four >> k & 1) as u8));
                        let distances = row[place(x)..].iter_mut();
                        distances.zip(empty).for_each(|(d, empty)| *d *= empty);
                    }
                }
                run(row);
                let (fours, _) = row.as_chunks();
                for (x, cell) in self.bricks.row(y as u32, z as u32) {
                    let four = turned(fours[place(x) / EDGE]);
                    self.distances[cell..cell + EDGE].copy_from_slice(&four);
                }
            }
            std::mem::swap(&mut behind, &mut ahead);
        }
    }
}

/// One more than the least distance among the neighbours of each cell in three rows: beside it and one on.
#[inline(always)]
fn nearest(row: &mut [u8], a: &[u8], b: &[u8], c: &[u8]) {
    for (((d, a), b), c) in row.iter_mut().zip(a).zip(b).zip(c) {
        *d = (*a).min(*b).min(*c);
    }
    for x in 0..row.len().saturating_sub(1) {
        row[x] = row[x].min(row[x + 1]);
    }
    for d in row {
        *d = d.saturating_add(1);
    }
}

/// Lets each cell be no farther than the ones on from it in its row are, plus the way there.
#[inline(always)]
fn run(row: &mut [u8]) {
    let mut step = 1;
    while step < row.len() && step < usize::from(FAR) {
        for x in 0..row.len() - step {
            row[x] = row[x].min(row[x + step].saturating_add(step as u8));
        }
        step *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::testbed::Dice;
    use super::super::bricks::BRICK;
    use super::*;

    /// The largest empty cube ahead of a cell, by looking at all of it.
    fn judged(listed: &[bool], dims: [u32; 3], cell: [i64; 3], octant: usize) -> u8 {
        let sign = |axis: usize| if octant >> axis & 1 == 1 { -1 } else { 1 };
        let lists = |at: [i64; 3]| {
            let inside = (0..3).all(|a| at[a] >= 0 && at[a] < i64::from(dims[a]));
            inside
                && listed
                    [((at[2] * i64::from(dims[1]) + at[1]) * i64::from(dims[0]) + at[0]) as usize]
        };
        let is_empty = |edge: i64| {
            (0..edge * edge * edge).all(|k| {
                let step = [k % edge, k / edge % edge, k / edge / edge];
                !lists(std::array::from_fn(|a| cell[a] + sign(a) * step[a]))
            })
        };
        let longest = i64::from(*dims.iter().max().unwrap());
        (0..=longest)
            .take_while(|&edge| is_empty(edge))
            .last()
            .map_or(0, |edge| if edge == longest { FAR } else { edge as u8 })
    }

    #[test]
    fn distances_are_those_of_a_slow_judge_in_every_direction() {
        let mut dice = Dice::new(4);
        for dims in [[1, 1, 1], [5, 1, 3], [7, 6, 5], [9, 9, 9], [2, 11, 1]] {
            for rarity in [1, 2, 20, 200, 100_000] {
                let count = dims.iter().product::<u32>();
                let listed: Vec<bool> = (0..count).map(|_| dice.below(rarity) == 0).collect();
                let bricks = Bricks::new(dims);
                let number = |[x, y, z]: [u32; 3]| ((z * dims[1] + y) * dims[0] + x) as usize;
                let lists = |place| bricks.cell(place).is_some_and(|cell| listed[number(cell)]);
                let bits = |brick: usize| {
                    let cells = (0..BRICK).filter(|k| lists(brick * BRICK + k));
                    cells.fold(0, |bits, k| bits | 1 << k)
                };
                let cells = Cells::new(bricks.len() / BRICK, bits);
                let all = distances(&cells, &bricks, dims);
                for octant in 0..OCTANTS {
                    for k in 0..count {
                        let cell = [k % dims[0], k / dims[0] % dims[1], k / dims[0] / dims[1]];
                        let right = judged(&listed, dims, cell.map(i64::from), octant);
                        let found = all[octant * bricks.len() + bricks.place(cell)];
                        let longest = *dims.iter().max().unwrap() as u8;
                        // Beyond the longest axis there is nothing, however far.
                        let found = if found >= longest { FAR } else { found };
                        let right = if right >= longest { FAR } else { right };
                        assert_eq!(found, right, "{dims:?}, {cell:?}, octant {octant}");
                    }
                }
            }
        }
    }
}
