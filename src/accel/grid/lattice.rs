//! Where the cells are: one boundary function for builder, walk and checks.
//!
//! ```text
//!  lo = b(0)   b(1)   b(2)        b(n) = hi     per axis
//!    |------|------|-- … --|------|             cell i is [b(i), b(i+1)], closed
//!  ..|......|......|.......|......|..           pad: every cell also claims a thin shell around itself
//! ```
//!
//! **Differs** from a grid with half-open cells: every cell is closed and claims a shell of [`Lattice::pad`], so a
//! triangle on a cell plane is listed on both sides, and whichever side the walk takes it meets the triangle.

use crate::geometry::{Aabb, DVec3};

/// How n becomes cells along x, y and z.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::accel) enum Shape {
    /// n on every axis.
    N3,
    /// n on the longest axis, the others so that cells are as cubic as possible.
    Cubic,
}

impl Shape {
    /// Cells along each axis of a box with these edge lengths; an axis without extent has one cell.
    pub fn dims(self, extent: DVec3, n: u32) -> [u32; 3] {
        let longest = extent.max_element();
        extent.to_array().map(|length| match self {
            _ if length <= 0.0 => 1,
            Self::N3 => n.max(1),
            Self::Cubic => (length / longest * f64::from(n)).round().max(1.0) as u32,
        })
    }
}

/// A range of cells, both ends inclusive, on each axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::accel) struct Block {
    pub first: [u32; 3],
    pub last: [u32; 3],
}

impl Block {
    /// How many cells it has.
    pub fn cells(&self) -> u64 {
        (0..3)
            .map(|a| u64::from(self.last[a] - self.first[a]) + 1)
            .product()
    }

    /// Two halves along the axis with the most cells. Meaningful for two cells or more.
    pub fn halves(&self) -> [Self; 2] {
        let across = |a: usize| self.last[a] - self.first[a];
        let axis = (1..3).fold(0, |best, a| if across(a) > across(best) { a } else { best });
        let middle = self.first[axis] + across(axis) / 2;
        let [mut low, mut high] = [*self, *self];
        low.last[axis] = middle;
        high.first[axis] = middle + 1;
        [low, high]
    }
}

/// The cells of a grid.
#[derive(Debug, Clone, Copy)]
pub(in crate::accel) struct Lattice {
    /// Least corner, b(0).
    pub lo: [f64; 3],
    /// Greatest corner, b(n).
    pub hi: [f64; 3],
    /// Edge lengths of a cell; 0 on an axis without extent.
    pub size: [f64; 3],
    /// Reciprocals of `size`; 0 where that is 0.
    pub inv_size: [f64; 3],
    /// Cells along each axis.
    pub dims: [u32; 3],
    /// How far beyond its planes a cell still claims triangles.
    ///
    /// 2⁻²⁰ of the longest edge plus 2⁻⁴⁶ of the greatest coordinate. The second term covers what the walk, the planes
    /// and the overlap tests err in `f64`: below 2⁻⁵⁰ of the greatest coordinate each. The first, eight units in the
    /// last place of an `f32` as large as the box, is there for kernels: near an edge an `f32` kernel may accept a
    /// triangle that the exact ray passes at a distance of its rounding errors. Brute force reports that triangle, so
    /// the cells that the ray touches must list it. At n = 1024 the shell is a thousandth of a cell.
    pub pad: f64,
}

impl Lattice {
    /// Divides `bounds` into `dims` cells. The empty box gives cells around the origin, which no triangle is in.
    pub fn new(bounds: Aabb, dims: [u32; 3]) -> Self {
        let [min, max] = if bounds.is_empty() {
            [DVec3::ZERO; 2]
        } else {
            [bounds.min.as_dvec3(), bounds.max.as_dvec3()]
        };
        let size = (max - min) / DVec3::from_array(dims.map(f64::from));
        Self {
            lo: min.to_array(),
            hi: max.to_array(),
            size: size.to_array(),
            inv_size: size
                .to_array()
                .map(|s| if s > 0.0 { s.recip() } else { 0.0 }),
            dims,
            pad: pad(min, max),
        }
    }

    /// The plane between cells `i - 1` and `i` of `axis`: b(i), for `i` from 0 to the number of cells.
    ///
    /// The one boundary function: not decreasing in `i`, and exactly the box at both ends.
    #[inline(always)]
    pub fn plane(&self, axis: usize, i: u32) -> f64 {
        if i == self.dims[axis] {
            self.hi[axis]
        } else {
            (self.lo[axis] + f64::from(i) * self.size[axis]).min(self.hi[axis])
        }
    }

    /// Number of cells.
    pub fn len(&self) -> u64 {
        self.dims.iter().map(|&n| u64::from(n)).product()
    }

    /// The place of a cell in the lists: x fastest.
    #[inline(always)]
    pub fn index(&self, cell: [u32; 3]) -> u32 {
        (cell[2] * self.dims[1] + cell[1]) * self.dims[0] + cell[0]
    }

    /// The cell at a place in the lists; `None` beyond the last.
    pub fn cell(&self, place: u64) -> Option<[u32; 3]> {
        let [nx, ny, _] = self.dims.map(u64::from);
        let cell = [place % nx, place / nx % ny, place / (nx * ny)];
        (place < self.len()).then_some(cell.map(|i| i as u32))
    }

    /// Centre and half edge lengths of a block of cells, grown by `pad` on all sides.
    #[inline(always)]
    pub fn padded(&self, block: &Block, pad: f64) -> (DVec3, DVec3) {
        let low = DVec3::from_array(std::array::from_fn(|a| self.plane(a, block.first[a])));
        let high = DVec3::from_array(std::array::from_fn(|a| self.plane(a, block.last[a] + 1)));
        ((low + high) * 0.5, (high - low) * 0.5 + DVec3::splat(pad))
    }

    /// All cells whose shell the closed box [`min`, `max`], within the grid, touches.
    pub fn block(&self, min: DVec3, max: DVec3) -> Block {
        let clear = |axis: usize, x: f64| self.clear(axis, x);
        Block {
            first: std::array::from_fn(|a| {
                clear(a, min[a]).unwrap_or_else(|| self.first(a, min[a]))
            }),
            last: std::array::from_fn(|a| clear(a, max[a]).unwrap_or_else(|| self.last(a, max[a]))),
        }
    }

    /// The only cell of `axis` whose shell reaches `x`, where division tells: where `x` lies so far from planes that no
    /// rounding matters. What the quotient errs in cells is below 2⁻⁴⁰, and below the pad, which covers what planes err.
    #[inline(always)]
    fn clear(&self, axis: usize, x: f64) -> Option<u32> {
        const ROUNDING: f64 = 1.0 / (1_u64 << 30) as f64;
        let place = (x - self.lo[axis]) * self.inv_size[axis];
        let cell = place as u32;
        let rim = 2.0 * self.pad * self.inv_size[axis] + ROUNDING;
        let within = place - f64::from(cell);
        (within > rim && within < 1.0 - rim && cell < self.dims[axis]).then_some(cell)
    }

    /// The first cell of `axis` whose upper plane, padded, reaches up to `x`.
    fn first(&self, axis: usize, x: f64) -> u32 {
        let mut i = self.guess(axis, x - self.pad);
        // The quotient may be a cell off; the planes decide.
        while i > 0 && self.plane(axis, i) + self.pad >= x {
            i -= 1;
        }
        while i + 1 < self.dims[axis] && self.plane(axis, i + 1) + self.pad < x {
            i += 1;
        }
        i
    }

    /// The last cell of `axis` whose lower plane, padded, reaches down to `x`.
    fn last(&self, axis: usize, x: f64) -> u32 {
        let mut i = self.guess(axis, x + self.pad);
        while i + 1 < self.dims[axis] && self.plane(axis, i + 1) - self.pad <= x {
            i += 1;
        }
        while i > 0 && self.plane(axis, i) - self.pad > x {
            i -= 1;
        }
        i
    }

    /// The cell that division finds, within the grid.
    fn guess(&self, axis: usize, x: f64) -> u32 {
        // A float-to-integer cast saturates: below the box gives 0.
        (((x - self.lo[axis]) * self.inv_size[axis]) as u32).min(self.dims[axis] - 1)
    }
}

/// See [`Lattice::pad`].
pub(super) fn pad(min: DVec3, max: DVec3) -> f64 {
    let longest = (max - min).max_element();
    let greatest = min.abs().max(max.abs()).max_element();
    longest / f64::from(1 << 20) + greatest / (1_u64 << 46) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec3;

    fn cube(n: u32) -> Lattice {
        let bounds = Aabb {
            min: Vec3::splat(-1.0),
            max: Vec3::splat(0.1),
        };
        Lattice::new(bounds, [n; 3])
    }

    #[test]
    fn planes_begin_and_end_with_the_box_and_never_decrease() {
        for n in [1, 3, 7, 512, 1024] {
            let lattice = cube(n);
            assert_eq!(lattice.plane(0, 0), -1.0);
            assert_eq!(lattice.plane(0, n), f64::from(0.1_f32));
            assert!((0..n).all(|i| lattice.plane(0, i) < lattice.plane(0, i + 1)));
        }
    }

    #[test]
    fn an_axis_without_extent_has_one_cell_in_both_shapes() {
        let extent = DVec3::new(4.0, 1.0, 0.0);
        assert_eq!(Shape::N3.dims(extent, 8), [8, 8, 1]);
        assert_eq!(Shape::Cubic.dims(extent, 8), [8, 2, 1]);
        assert_eq!(Shape::N3.dims(DVec3::ZERO, 8), [1, 1, 1]);
        assert_eq!(
            Shape::Cubic.dims(DVec3::new(1e3, 1.0, 1.0), 8),
            [8, 1, 1],
            "a thin axis keeps a cell"
        );
    }

    #[test]
    fn what_division_tells_is_what_planes_decide() {
        for n in [1, 3, 7, 100, 1024] {
            let lattice = cube(n);
            let mut told = 0;
            for i in 0..4000_u32 {
                // Everywhere, and near planes.
                let plane = lattice.plane(0, i % (n + 1));
                let near = plane + lattice.pad * (f64::from(i) / 400.0 - 5.0);
                for x in [near, -1.0 + f64::from(i) * 1.1 / 4000.0] {
                    if let Some(cell) = lattice.clear(0, x) {
                        assert_eq!(
                            [cell; 2],
                            [lattice.first(0, x), lattice.last(0, x)],
                            "{n}, {x}"
                        );
                        told += 1;
                    }
                }
            }
            assert!(told > 3900, "{n}: {told}");
        }
    }

    #[test]
    fn a_point_on_a_plane_touches_the_cells_of_both_sides() {
        let lattice = cube(8);
        let on = DVec3::splat(lattice.plane(0, 3));
        let block = lattice.block(on, on);
        assert_eq!(block.first, [2; 3]);
        assert_eq!(block.last, [3; 3]);
        assert_eq!(block.cells(), 8);
    }

    #[test]
    fn a_block_is_exactly_the_cells_whose_padded_planes_enclose_the_point() {
        for n in [1, 5, 64, 333] {
            let lattice = cube(n);
            for k in 0..2000 {
                let x = -1.0 + 1.1 * f64::from(k) / 1999.0;
                let block = lattice.block(DVec3::splat(x), DVec3::splat(x));
                let touches = |i: u32| {
                    lattice.plane(0, i) - lattice.pad <= x
                        && lattice.plane(0, i + 1) + lattice.pad >= x
                };
                let cells: Vec<u32> = (0..n).filter(|&i| touches(i)).collect();
                assert_eq!(block.first[0], cells[0], "n {n}, x {x}");
                assert_eq!(block.last[0], *cells.last().unwrap(), "n {n}, x {x}");
            }
        }
    }

    #[test]
    fn halves_share_no_cell_and_lose_none() {
        let block = Block {
            first: [2, 0, 5],
            last: [4, 6, 5],
        };
        let [low, high] = block.halves();
        assert_eq!(low.cells() + high.cells(), block.cells());
        assert_eq!(low.last[1] + 1, high.first[1]);
    }

    #[test]
    fn denormal_and_huge_boxes_have_finite_cells() {
        for (min, max) in [(0.0, 1e-45), (-f32::MAX, f32::MAX), (1e6, 1e6 + 1.0)] {
            let bounds = Aabb {
                min: Vec3::splat(min),
                max: Vec3::splat(max),
            };
            let lattice = Lattice::new(bounds, [1024; 3]);
            assert!(lattice.inv_size[0].is_finite() && lattice.size[0] > 0.0);
            assert!((0..1024).all(|i| lattice.plane(0, i) <= lattice.plane(0, i + 1)));
            assert_eq!(
                lattice
                    .block(DVec3::splat(f64::from(max)), DVec3::splat(f64::from(max)))
                    .last,
                [1023; 3]
            );
        }
    }
}
