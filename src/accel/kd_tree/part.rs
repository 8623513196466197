//! The parts of triangles in a cell, and the events at which a plane that sweeps across the cell meets and leaves them.

use rayon::prelude::*;

use crate::geometry::Aabb;

/// The part of a triangle inside a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Part {
    pub prim: u32,
    /// Contains the part; within the cell.
    pub bounds: Aabb,
}

impl Part {
    /// Where the part begins and ends along `axis`.
    pub fn interval(&self, axis: usize) -> (f32, f32) {
        (self.bounds.min[axis], self.bounds.max[axis])
    }
}

/// What happens at an event. At one place parts end before others begin, so that what only touches a plane from below
/// is not counted as lying above it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// A part ends.
    End,
    /// A part lies in the plane.
    Planar,
    /// A part begins.
    Start,
}

/// An event of the sweep along one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Event {
    pub place: f32,
    pub kind: Kind,
    /// Index of the part in its cell.
    pub part: u32,
}

impl Event {
    /// The order of the sweep. Total, so sorting gives one order only.
    fn before(&self, other: &Self) -> std::cmp::Ordering {
        self.place
            .total_cmp(&other.place)
            .then(self.kind.cmp(&other.kind))
            .then(self.part.cmp(&other.part))
    }
}

/// The events of a cell along each axis, sorted.
pub(super) type Events = [Vec<Event>; 3];

/// Appends the events of one part along `axis`.
fn append(events: &mut Vec<Event>, axis: usize, part: u32, bounds: &Part) {
    // Adding zero turns -0 into +0, which the total order would tell apart.
    let (start, end) = bounds.interval(axis);
    let (start, end) = (start + 0.0, end + 0.0);
    let mut event = |place, kind| events.push(Event { place, kind, part });
    if start == end {
        event(start, Kind::Planar);
    } else {
        event(start, Kind::Start);
        event(end, Kind::End);
    }
}

/// The sorted events along `axis` of those `parts` that `chosen` lists, or of all where it is `None`.
fn along(parts: &[Part], chosen: Option<&[u32]>, axis: usize) -> Vec<Event> {
    let mut events = Vec::with_capacity(2 * chosen.map_or(parts.len(), <[u32]>::len));
    match chosen {
        Some(chosen) => {
            for &part in chosen {
                append(&mut events, axis, part, &parts[part as usize]);
            }
        }
        None => {
            for (part, bounds) in (0..).zip(parts) {
                append(&mut events, axis, part, bounds);
            }
        }
    }
    events.par_sort_unstable_by(Event::before);
    events
}

/// The events of all `parts`.
pub(super) fn events(parts: &[Part]) -> Events {
    [0, 1, 2].map(|axis| along(parts, None, axis))
}

/// Index of a part that a side does not have.
pub(super) const ABSENT: u32 = u32::MAX;

/// The events of one side of a split: those of `old` whose parts were moved there whole keep their order; the parts in
/// `new` were cut and get new events. `moved` gives the index that an old part has there, or [`ABSENT`].
pub(super) fn inherited(old: &Events, moved: &[u32], parts: &[Part], new: &[u32]) -> Events {
    [0, 1, 2].map(|axis| {
        let mut kept = old[axis].iter().filter_map(|event| {
            let part = moved[event.part as usize];
            (part != ABSENT).then_some(Event { part, ..*event })
        });
        let mut cut = along(parts, Some(new), axis).into_iter();
        let mut merged = Vec::with_capacity(2 * parts.len());
        let (mut a, mut b) = (kept.next(), cut.next());
        loop {
            match (a, b) {
                (Some(x), Some(y)) if y.before(&x).is_lt() => {
                    merged.push(y);
                    b = cut.next();
                }
                (Some(x), _) => {
                    merged.push(x);
                    a = kept.next();
                }
                (None, Some(y)) => {
                    merged.push(y);
                    b = cut.next();
                }
                (None, None) => return merged,
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec3;

    fn part(prim: u32, from: f32, to: f32) -> Part {
        Part {
            prim,
            bounds: Aabb {
                min: Vec3::splat(from),
                max: Vec3::splat(to),
            },
        }
    }

    #[test]
    fn at_one_place_parts_end_before_they_lie_in_it_before_they_begin() {
        let parts = [part(0, 1.0, 2.0), part(1, 1.0, 1.0), part(2, 0.0, 1.0)];
        let kinds: Vec<_> = events(&parts)[0].iter().map(|e| (e.kind, e.part)).collect();
        assert_eq!(
            kinds,
            [
                (Kind::Start, 2),
                (Kind::End, 2),
                (Kind::Planar, 1),
                (Kind::Start, 0),
                (Kind::End, 0)
            ]
        );
    }

    #[test]
    fn zeros_of_both_signs_are_one_place() {
        let events = events(&[part(0, -0.0, 1.0), part(1, -1.0, 0.0)]);
        assert_eq!(events[1][1].kind, Kind::End);
        assert_eq!(events[1][2].kind, Kind::Start);
    }

    #[test]
    fn inherited_events_are_those_of_the_parts() {
        let parts: Vec<_> = (0..20)
            .map(|i| part(i, i as f32, (i * 7 % 31) as f32 + 20.0))
            .collect();
        let moved: Vec<_> = (0..20).map(|i| if i < 15 { i } else { ABSENT }).collect();
        let mut side = parts[..15].to_vec();
        side.push(part(15, 3.0, 9.0));
        side.push(part(16, 9.0, 9.0));
        assert_eq!(
            inherited(&events(&parts), &moved, &side, &[15, 16]),
            events(&side)
        );
    }
}
