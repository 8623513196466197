//! The best split plane of a cell: one sweep over the sorted events of each axis.

use crate::geometry::Aabb;

use super::super::sah::{Costs, half_area};
use super::part::{Event, Events, Kind};

/// Wald and Havran's measured costs.
pub(super) const COSTS: Costs = Costs {
    step: 15.0,
    test: 20.0,
};

/// A split that cuts off empty space costs this part of what it would (Wald and Havran, §3.3).
const EMPTY_BONUS: f64 = 0.8;

/// The part of a cell's extent that must be empty for the bonus. Without this a leaf of four triangles around a vertex
/// is trimmed by ever thinner slivers, since the bonus alone pays for each of them.
const LEAST_EMPTY: f64 = 0.1;

/// Above this many events the axes are swept in parallel.
const PARALLEL: usize = 8192;

/// A plane across a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plane {
    pub axis: usize,
    pub place: f32,
    /// Whether parts in the plane belong to the side below it.
    pub planar_below: bool,
    /// Expected cost of the cell if it is split here.
    pub cost: f64,
}

/// The cheapest plane strictly inside `cell`, the first of equals; `None` where there is none or the cell has no area.
pub(super) fn best(cell: &Aabb, parts: usize, events: &Events) -> Option<Plane> {
    let sweep = |axis: usize| sweep(cell, axis, parts, &events[axis]);
    let [x, y, z] = if events[0].len() < PARALLEL {
        [0, 1, 2].map(sweep)
    } else {
        let (x, (y, z)) = rayon::join(|| sweep(0), || rayon::join(|| sweep(1), || sweep(2)));
        [x, y, z]
    };
    let cheaper = |a: Option<Plane>, b: Option<Plane>| match (a, b) {
        (Some(a), Some(b)) if b.cost < a.cost => Some(b),
        (a, b) => a.or(b),
    };
    cheaper(cheaper(x, y), z)
}

/// The cheapest plane across `axis`.
fn sweep(cell: &Aabb, axis: usize, parts: usize, events: &[Event]) -> Option<Plane> {
    let area = half_area(cell);
    if area <= 0.0 {
        return None;
    }
    let (start, end) = (cell.min[axis], cell.max[axis]);
    let extent = |axis: usize| f64::from(cell.max[axis]) - f64::from(cell.min[axis]);
    let (u, v) = (extent((axis + 1) % 3), extent((axis + 2) % 3));
    // What the cell costs if it is split at `place` into sides with so many parts: the probability that a line through
    // the cell meets a side, times the tests there.
    let whole = extent(axis);
    let cost = |place: f32, below_count: usize, above_count: usize| {
        let below = f64::from(place) - f64::from(start);
        let above = f64::from(end) - f64::from(place);
        let tests = (u * v + below * (u + v)) * below_count as f64
            + (u * v + above * (u + v)) * above_count as f64;
        let empty = (below_count == 0 && below >= LEAST_EMPTY * whole)
            || (above_count == 0 && above >= LEAST_EMPTY * whole);
        let bonus = if empty { EMPTY_BONUS } else { 1.0 };
        bonus * (COSTS.step + COSTS.test * tests / area)
    };

    let mut best: Option<Plane> = None;
    let (mut below_count, mut above_count) = (0, parts);
    let mut rest = events;
    while let Some(first) = rest.first() {
        // All events at one place, in the order end, planar, start.
        let place = first.place;
        let mut take = |kind: Kind| {
            let count = rest
                .iter()
                .take_while(|e| e.place == place && e.kind == kind)
                .count();
            rest = &rest[count..];
            count
        };
        let (ended, planar, started) = (take(Kind::End), take(Kind::Planar), take(Kind::Start));
        above_count -= planar + ended;
        if place > start && place < end {
            let sides = [
                (true, cost(place, below_count + planar, above_count)),
                (false, cost(place, below_count, above_count + planar)),
            ];
            for (planar_below, cost) in sides {
                if best.is_none_or(|b| cost < b.cost) {
                    best = Some(Plane {
                        axis,
                        place,
                        planar_below,
                        cost,
                    });
                }
            }
        }
        below_count += planar + started;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::super::part::{Part, events};
    use super::*;
    use crate::geometry::Vec3;

    fn slab(prim: u32, from: f32, to: f32) -> Part {
        Part {
            prim,
            bounds: Aabb {
                min: Vec3::new(from, 0.0, 0.0),
                max: Vec3::new(to, 1.0, 1.0),
            },
        }
    }

    fn best_of(parts: &[Part]) -> Option<Plane> {
        let cell = Aabb {
            min: Vec3::ZERO,
            max: Vec3::new(10.0, 1.0, 1.0),
        };
        best(&cell, parts.len(), &events(parts))
    }

    #[test]
    fn empty_space_is_cut_off() {
        let plane = best_of(&[slab(0, 6.0, 10.0), slab(1, 6.0, 10.0)]).expect("a plane");
        assert_eq!((plane.axis, plane.place), (0, 6.0));
        // 0.8 (15 + 20 · 2 · (1 + 4 · 2) / 21)
        assert!((plane.cost - 0.8 * (15.0 + 40.0 * 9.0 / 21.0)).abs() < 1e-9);
    }

    #[test]
    fn parts_in_the_plane_go_to_the_cheaper_side() {
        let mut parts = vec![slab(0, 2.0, 2.0); 5];
        parts.push(slab(5, 9.5, 10.0));
        let plane = best_of(&parts).expect("a plane");
        assert_eq!((plane.place, plane.planar_below), (2.0, true));
        let mut parts = vec![slab(0, 8.0, 8.0); 5];
        parts.push(slab(5, 0.0, 0.5));
        let plane = best_of(&parts).expect("a plane");
        assert_eq!((plane.place, plane.planar_below), (8.0, false));
    }

    #[test]
    fn planes_on_the_faces_of_the_cell_are_none() {
        assert_eq!(best_of(&[slab(0, 0.0, 10.0)]), None);
        assert_eq!(best_of(&[slab(0, 0.0, 0.0), slab(1, 10.0, 10.0)]), None);
    }
}
