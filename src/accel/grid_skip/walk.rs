//! The ways of rays through the cells, several rays at once: each step leaves the empty cube ahead of a ray, or one cell.
//!
//! ```text
//!   +---+---+---+---+---+         a ray crosses plane m of an axis at  t(m) = start + m·rate,  m counted from the side
//!   |   .   |   |   |  /|         where it enters. The cube of edge e ahead ends at plane m + e - 1 of some axis, at the
//!   +---+-.-+---+---/---+         least such t; at this t the other axes have passed  place + t·speed  planes.
//!   | o...|..../|   |   |
//!   +---+---+---+---+---+
//! ```
//!
//! **Source:** J. Amanatides and A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics 1987; A. Es and
//! V. İşler 2007 for leaps (see `distances`). **Differs:** several rays in lanes, in `f32`, with a bound on the error.
//!
//! **Why nothing is missed.** A ray is put into a frame of its own, in `f64`: its t is 0 where it enters the padded box
//! and 1 where it leaves, and lengths on each axis are cells, of which there are N. From there on it is `f32`, whose
//! rounding errs by u = 2⁻²⁴. The end of each step is the next one's entry, so the steps cover the way from 0 to 1
//! without a gap, whatever t they have; what matters is that at each t of a step the exact ray lies, axis by axis, between
//! the planes that the step claims. Axis a claims from plane m - 1 on: either t(m - 1) was passed, or the position put the
//! ray beyond that plane. And it claims up to plane m + e - 1, since the step ends at its t at the latest.
//!
//! - t(k) has three roundings and errs by u·(|start| + 2·k·rate + t) in t, so on its own axis, where 1/rate cells pass in
//!   a unit of t, by 4·u·N cells at most, however slow the axis is.
//! - the position has four roundings, of numbers below N + 1: 4·u·N cells too.
//!
//! So the exact ray is never farther than 2⁻²² of the box's edge outside of what is claimed, and [`PAD`] adds twice that
//! to the shell of every cell. An axis on which a ray passes less than 2⁻³⁰ cells counts as none: that moves the ray by
//! less. On an axis much thinner than the shell, N is the shell's thickness in cells, and the bound is the same in lengths.

use crate::geometry::Ray;

use super::super::grid::lattice::Lattice;
use super::super::grid::walk::{T_ERROR, clip};
use super::bricks::Bricks;

/// The shell of a cell, in shells of the uniform grid's: half a shell is 2⁻²¹ of the longest edge.
pub(super) const PAD: f64 = 1.5;

/// Fewer cells than this, on the whole way, are none.
const SLOW: f64 = 1.0 / (1 << 30) as f64;

/// Least length of a way in the ray's t, so that dividing by it does not overflow.
const SHORT: f64 = 1e-290;

/// Added to a number below 2²² and subtracted again, this rounds to a whole number.
const WHOLE: f32 = (1 << 23) as f32;

/// How the t of a ray's way is the ray's own.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    /// The ray's own t where it enters.
    from: f64,
    /// The ray's own t from there to where it leaves.
    unit: f64,
    per_unit: f64,
    /// More than `from` may be off.
    slack: f64,
}

impl Frame {
    /// Of no ray.
    pub const NONE: Self = Self {
        from: 0.0,
        unit: 1.0,
        per_unit: 1.0,
        slack: 0.0,
    };

    /// The ray's own t at `t` of its way.
    pub fn t(&self, t: f32) -> f64 {
        self.from + f64::from(t.clamp(0.0, 1.0)) * self.unit
    }

    /// The t on the way beyond which nothing can change the answer when nothing beyond the ray's own t `limit` can; 1 at
    /// most.
    #[inline(always)]
    pub fn stop(&self, limit: f32) -> f32 {
        let limit = (f64::from(limit) - self.from + self.slack) * self.per_unit;
        let up = (limit as f32).next_up();
        if up < 1.0 { up } else { 1.0 }
    }
}

/// Ways of `W` rays, field by field.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(super) struct Ways<const W: usize> {
    start: [[f32; W]; 3],
    rate: [[f32; W]; 3],
    /// Cells passed in a unit of t.
    speed: [[f32; W]; 3],
    /// Cells passed at t = 0, and a half, so that rounding gives the number of the next plane.
    place: [[f32; W]; 3],
    /// Number of the next plane.
    next: [[f32; W]; 3],
    /// All bits set where the ray goes down the axis.
    down: [[i32; W]; 3],
    /// Added to the number of the next plane, where the ray goes down its complement, this gives the cell's.
    before: [[i32; W]; 3],
    /// The ray is done when a step ends here or later: see [`Frame::stop`].
    pub stop: [f32; W],
    /// Where the last step ended.
    pub exit: [f32; W],
    /// Edge of the empty cube ahead, in cells; 0 for a cell that is not empty.
    pub leap: [i32; W],
    /// The cell.
    pub cell: [i32; W],
}

impl<const W: usize> Ways<W> {
    /// Of no rays.
    pub fn none() -> Self {
        Self {
            start: [[0.0; W]; 3],
            rate: [[0.0; W]; 3],
            speed: [[0.0; W]; 3],
            place: [[0.0; W]; 3],
            next: [[1.0; W]; 3],
            down: [[0; W]; 3],
            before: [[-1; W]; 3],
            stop: [1.0; W],
            exit: [0.0; W],
            leap: [0; W],
            cell: [0; W],
        }
    }

    /// Puts a ray into a lane, before the cell in which it enters; `None`, and nothing done, where it passes by the grid
    /// within its interval. The ray must not stop before [`Ways::stop`] is set.
    ///
    /// Out of line, so that it is compiled once for all kernels.
    #[inline(never)]
    pub fn put(
        &mut self,
        lane: usize,
        lattice: &Lattice,
        bricks: &Bricks,
        ray: &Ray,
    ) -> Option<(Frame, usize)> {
        let [from, end] = clip(lattice, ray)?;
        // Of the origin moved by a t of 24 bits each coordinate is rounded once.
        let base = f64::from_bits(from.to_bits() & !0x1FFF_FFFF);
        let unit = (end - from).max(SHORT);
        let (mut cell, mut octant) = (0, 0);
        for a in 0..3 {
            let d = f64::from(ray.dir[a]);
            let at = (f64::from(ray.origin[a]) + base * d) + (from - base) * d;
            let cells = lattice.dims[a] as i32;
            // Cells passed since the side where rays of this direction enter.
            let (passed, down, before) = if d >= 0.0 {
                (at - lattice.lo[a], 0, -1)
            } else {
                octant |= 1 << a;
                (lattice.hi[a] - at, -1, cells + 1)
            };
            let passed = passed * lattice.inv_size[a];
            // The cast saturates and so clamps what rounding put outside.
            let next = (passed as u32).min(lattice.dims[a] - 1) as i32 + 1;
            let speed = unit * d.abs() * lattice.inv_size[a];
            let is_slow = speed <= SLOW;
            let rate = speed.recip();
            self.start[a][lane] = if is_slow {
                f32::INFINITY
            } else {
                (-passed * rate) as f32
            };
            self.rate[a][lane] = if is_slow { 0.0 } else { rate as f32 };
            self.speed[a][lane] = if is_slow { 0.0 } else { speed as f32 };
            self.place[a][lane] = passed as f32 + 0.5;
            self.next[a][lane] = next as f32;
            self.down[a][lane] = down;
            self.before[a][lane] = before;
            cell += bricks.along(a, (next ^ down) + before);
        }
        self.cell[lane] = cell;
        self.exit[lane] = 0.0;
        let frame = Frame {
            from,
            unit,
            per_unit: unit.recip(),
            slack: from.abs() * T_ERROR,
        };
        Some((frame, octant))
    }

    /// Lets every ray leave the cube ahead, in a grid of so many cells along each axis, and enter a cell, which is one of
    /// the grid even where the ray was done before. The bits of those that are done are set.
    #[inline(always)]
    pub fn advance(&mut self, cells: [f32; 3], bricks: &Bricks) -> u32 {
        for l in 0..W {
            // A loop over the lanes, with no branch that depends on numbers, becomes vector instructions.
            let ahead = self.leap[l].max(1) as f32 - 1.0;
            let mut last = [0.0; 3];
            let mut at = [0.0; 3];
            let mut exit = f32::INFINITY;
            for a in 0..3 {
                last[a] = self.next[a][l] + ahead;
                let t = self.start[a][l] + last[a] * self.rate[a][l];
                // Beyond the last plane of the grid there is only the shell.
                at[a] = if last[a] < cells[a] { t } else { f32::INFINITY };
                exit = if at[a] < exit { at[a] } else { exit };
            }
            let mut cell = 0_i32;
            for a in 0..3 {
                let crossed = if at[a] == exit {
                    last[a] + 1.0
                } else {
                    self.next[a][l]
                };
                // NaN, on axes that are not passed, is not greater.
                let passed = exit * self.speed[a][l] + self.place[a][l];
                let next = (passed + WHOLE) - WHOLE;
                let next = if next > crossed { next } else { crossed };
                let next = if next < cells[a] { next } else { cells[a] };
                self.next[a][l] = next;
                let number = (next + WHOLE).to_bits() as i32 - WHOLE.to_bits() as i32;
                let number = (number ^ self.down[a][l]) + self.before[a][l];
                cell = cell.wrapping_add(bricks.along(a, number));
            }
            self.cell[l] = cell;
            self.exit[l] = exit;
        }
        let mut done = 0;
        for l in 0..W {
            done |= u32::from(self.exit[l] >= self.stop[l]) << l;
        }
        done
    }
}
