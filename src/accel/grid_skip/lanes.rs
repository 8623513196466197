//! Thirty-two rays of a batch go through the grid side by side, each at its own pace.
//!
//! ```text
//! lanes:   ray 0   ray 1   ...   ray 31
//!          where?  where?        where?      distances are read for all: their misses of a cache overlap
//!                   test          test       the blocks of those in listed cells were asked for before the first test
//!          step    step          step        one instruction stream for all; a ray that is done makes room for the next
//! ```
//!
//! Thirty-two are 2 to 4 % faster than sixteen on `city:300`, on the bunny and `sphereflake:4` alike. Tried and not kept: the first
//! block of each ray's cell, then the second of those that have one, and so on, in place of ray after ray (3 to 5 % slower).

use std::ops::Range;

use crate::geometry::lanes::Ones;

use super::super::batch::{Course, run_apart};
use super::super::share::Span;
use super::super::{Rays, Visitor};
use super::GridSkip;
use super::walk::{Frame, Ways};

/// Rays side by side.
const LANES: usize = 32;

/// A ray under way.
struct Flight<V> {
    index: usize,
    visitor: V,
    frame: Frame,
    /// Where the distances of its direction begin.
    direction: usize,
    /// What the last cell lists that it was in and that lists any.
    span: Span,
}

/// Before the first such cell.
const NOWHERE: Span = Span {
    first: u32::MAX,
    count: 0,
};

/// Traces the rays in `range`.
#[inline(always)]
pub(super) fn trace<'a, R: Rays<'a>>(grid: &GridSkip, batch: &mut R, range: Range<usize>) {
    run_apart::<SideBySide, GridSkip, R>(grid, batch, range, &mut ());
}

/// Rays go side by side.
struct SideBySide;

impl Course<GridSkip> for SideBySide {
    type Out = ();

    #[inline(always)]
    fn run<'a, R: Rays<'a>>(grid: &GridSkip, batch: &mut R, range: Range<usize>, (): &mut ()) {
        go(grid, batch, range);
    }
}

/// See [`trace`].
#[inline(always)]
fn go<'a, R: Rays<'a>>(grid: &GridSkip, batch: &mut R, mut waiting: Range<usize>) {
    if waiting.is_empty() {
        return;
    }
    let mut ways = Ways::<LANES>::none();
    let mut flights = Vec::with_capacity(LANES);
    let mut under_way = 0_u32;
    for lane in 0..LANES {
        flights.push(Flight {
            index: 0,
            visitor: batch.begin(0),
            frame: Frame::NONE,
            direction: 0,
            span: NOWHERE,
        });
        if board(
            grid,
            batch,
            &mut waiting,
            &mut ways,
            lane,
            &mut flights[lane],
        ) {
            under_way |= 1 << lane;
        }
    }
    while under_way != 0 {
        let mut listed = 0;
        for (lane, flight) in flights.iter().enumerate() {
            let leap = grid.distances[flight.direction + ways.cell[lane] as usize];
            ways.leap[lane] = i32::from(leap);
            listed |= u32::from(leap == 0) << lane;
        }
        let mut to_test = 0_u32;
        for lane in Ones(listed & under_way) {
            let lane = lane % LANES;
            let span = grid.cells.span(ways.cell[lane] as usize);
            // Not a branch: neighbours share blocks as often as not.
            to_test |= u32::from(span.first != flights[lane].span.first) << lane;
            flights[lane].span = span;
            batch.prefetch(span.first);
        }
        for lane in Ones(to_test) {
            let lane = lane % LANES;
            let flight = &mut flights[lane];
            let ray = &batch.rays()[flight.index];
            grid.test::<R::Isa, _>(flight.span, ray, &mut flight.visitor);
            ways.stop[lane] = flight.frame.stop(flight.visitor.t_limit());
        }
        for lane in Ones(ways.advance(grid.dims, &grid.bricks) & under_way) {
            let lane = lane % LANES;
            let flight = &mut flights[lane];
            batch.finish(flight.index, &flight.visitor);
            if !board(grid, batch, &mut waiting, &mut ways, lane, flight) {
                under_way &= !(1 << lane);
            }
        }
    }
}

/// Puts the next ray that enters the grid into a lane; those before it that do not are answered. False if none is left.
#[inline(always)]
fn board<'a, R: Rays<'a>>(
    grid: &GridSkip,
    batch: &mut R,
    waiting: &mut Range<usize>,
    ways: &mut Ways<LANES>,
    lane: usize,
    flight: &mut Flight<R::Visitor>,
) -> bool {
    for index in waiting {
        let entered = ways.put(lane, &grid.lattice, &grid.bricks, &batch.rays()[index]);
        batch.begin_again(index, &mut flight.visitor);
        if let Some((frame, octant)) = entered {
            flight.index = index;
            flight.frame = frame;
            flight.direction = grid.direction(octant);
            flight.span = NOWHERE;
            flight.visitor.prepare();
            ways.stop[lane] = frame.stop(flight.visitor.t_limit());
            return true;
        }
        batch.finish(index, &flight.visitor);
    }
    false
}
