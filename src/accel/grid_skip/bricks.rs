//! Where in memory a cell is: cells go in bricks of 4 × 4 × 4, one cache line of distances each.
//!
//! ```text
//!   +---------+---------+      a ray that steps along y or z stays in its line as long as one that steps along x;
//!   | 0 1 2 3 | 64 65 … |      in rows, each such step would be a miss
//!   | 4 5 6 7 | 68      |
//!   +---------+---------+
//! ```

/// Cells along an edge of a brick, as a power of two.
const EDGE_LOG2: u32 = 2;

/// Cells along an edge of a brick.
pub(super) const EDGE: usize = 1 << EDGE_LOG2;

/// Cells of a brick.
pub(super) const BRICK: usize = 1 << (3 * EDGE_LOG2);

/// The bricks over cells; those at the far sides may reach beyond.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bricks {
    /// Cells along each axis.
    dims: [u32; 3],
    /// Bricks along each axis.
    across: [u32; 3],
    /// What a step of a brick along each axis adds to the place of a cell, beyond what its four cells add anyway.
    more: [i32; 3],
}

impl Bricks {
    /// Over so many cells along each axis.
    pub fn new(dims: [u32; 3]) -> Self {
        let bricks = dims.map(|n| n.div_ceil(1 << EDGE_LOG2));
        let brick = BRICK as u32;
        let step = [
            brick,
            brick.wrapping_mul(bricks[0]),
            brick.wrapping_mul(bricks[0]).wrapping_mul(bricks[1]),
        ];
        let more = std::array::from_fn(|a| {
            let within = 1 << (EDGE_LOG2 * (a as u32 + 1));
            step[a].wrapping_sub(within) as i32
        });
        Self {
            dims,
            across: bricks,
            more,
        }
    }

    /// Places of cells, with those that lie beyond the far sides.
    pub fn len(&self) -> usize {
        self.count() as usize
    }

    /// [`Bricks::len`] of however many cells.
    pub fn count(&self) -> u64 {
        let bricks = self.across.map(u64::from);
        (bricks[0] * bricks[1]).saturating_mul(bricks[2] * BRICK as u64)
    }

    /// What number `i` on `axis` adds to the place of a cell.
    #[inline(always)]
    pub fn along(&self, axis: usize, i: i32) -> i32 {
        (i << (EDGE_LOG2 * axis as u32)) + (i >> EDGE_LOG2).wrapping_mul(self.more[axis])
    }

    /// The place of a cell.
    pub fn place(&self, cell: [u32; 3]) -> usize {
        (0..3).map(|a| self.along(a, cell[a] as i32)).sum::<i32>() as usize
    }

    /// The cell at a place; `None` where it lies beyond.
    pub fn cell(&self, place: usize) -> Option<[u32; 3]> {
        let (brick, within) = ((place / BRICK) as u32, place % BRICK);
        let [bx, by, _] = self.across;
        let at = [brick % bx, brick / bx % by, brick / bx / by];
        let cell = std::array::from_fn(|a| {
            (at[a] << EDGE_LOG2) + (within >> (EDGE_LOG2 * a as u32) & 3) as u32
        });
        (0..3).all(|a| cell[a] < self.dims[a]).then_some(cell)
    }

    /// For each four cells of a row along x, of which the last may lie beyond: the number of the first, and its place.
    pub fn row(&self, y: u32, z: u32) -> impl Iterator<Item = (usize, usize)> {
        let first = self.place([0, y, z]);
        (0..self.across[0] as usize).map(move |brick| (brick << EDGE_LOG2, first + brick * BRICK))
    }

    /// The rows of four cells in a brick: for each the bit of its first, that cell, and how many are not beyond.
    pub fn rows(&self, brick: usize) -> impl Iterator<Item = (usize, [u32; 3], u32)> {
        let dims = self.dims;
        let first = self.cell(brick * BRICK).unwrap_or(dims);
        let edge = EDGE as u32;
        let rows = (0..edge).flat_map(move |z| (0..edge).map(move |y| [0, y, z]));
        rows.enumerate().filter_map(move |(i, row)| {
            let cell: [u32; 3] = std::array::from_fn(|a| first[a] + row[a]);
            let count = (dims[0] - first[0]).min(edge);
            (cell[1] < dims[1] && cell[2] < dims[2]).then_some((i << EDGE_LOG2, cell, count))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cell_has_a_place_of_its_own_and_rows_meet_them_in_order() {
        for dims in [[1, 1, 1], [4, 4, 4], [5, 9, 2], [13, 3, 8]] {
            let bricks = Bricks::new(dims);
            let mut met = vec![false; bricks.len()];
            for (y, z) in (0..dims[2]).flat_map(|z| (0..dims[1]).map(move |y| (y, z))) {
                let mut xs = 0..dims[0];
                for (x, place) in bricks.row(y, z) {
                    for k in 0..4.min(dims[0] as usize - x) {
                        assert_eq!(xs.next(), Some((x + k) as u32));
                        let cell = [(x + k) as u32, y, z];
                        assert_eq!(bricks.place(cell), place + k);
                        assert_eq!(bricks.cell(place + k), Some(cell));
                        assert!(!std::mem::replace(&mut met[place + k], true));
                    }
                }
                assert_eq!(xs.next(), None);
            }
            for (place, met) in met.into_iter().enumerate() {
                assert_eq!(bricks.cell(place).is_some(), met, "{dims:?}, {place}");
            }
            for brick in 0..bricks.len() / BRICK {
                let mut cells = vec![None; BRICK];
                for (bit, cell, count) in bricks.rows(brick) {
                    for k in 0..count {
                        cells[bit + k as usize] = Some([cell[0] + k, cell[1], cell[2]]);
                    }
                }
                for (k, cell) in cells.into_iter().enumerate() {
                    assert_eq!(cell, bricks.cell(brick * BRICK + k));
                }
            }
        }
    }
}
