//! The exact sweep: every place along an axis where a part begins or ends is tried.

use crate::geometry::Aabb;

use super::super::plane_tree::{Part, Plane};
use super::cost::Splits;

/// A plane and what the cell costs that it splits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Priced {
    pub plane: Plane,
    pub cost: f64,
}

/// The cheaper of two, the first of equals.
pub(super) fn cheaper(a: Option<Priced>, b: Option<Priced>) -> Option<Priced> {
    match (a, b) {
        (Some(a), Some(b)) if b.cost < a.cost => Some(b),
        (a, b) => a.or(b),
    }
}

/// A number of which the order is that of the places. Zeros of both signs are one place.
fn key(place: f32) -> u32 {
    let bits = (place + 0.0).to_bits();
    if bits >> 31 == 1 {
        !bits
    } else {
        bits | 1 << 31
    }
}

/// The place of a key.
fn place(key: u32) -> f32 {
    f32::from_bits(if key >> 31 == 1 {
        key & !(1 << 31)
    } else {
        !key
    })
}

/// How many parts begin, end, and lie in a plane.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Count {
    pub started: usize,
    pub ended: usize,
    pub planar: usize,
}

/// The places where parts begin, end, and lie in a plane, sorted. Kept, so that its room is.
#[derive(Debug, Default)]
pub(in super::super) struct Events {
    starts: Vec<u32>,
    ends: Vec<u32>,
    planar: Vec<u32>,
}

impl Events {
    /// Takes the events of `parts` along `axis` within the interval.
    fn gather(&mut self, parts: &[Part], axis: usize, within: &std::ops::RangeInclusive<f32>) {
        for part in parts {
            let (start, end) = part.interval(axis);
            if start == end {
                if within.contains(&start) {
                    self.planar.push(key(start));
                }
                continue;
            }
            if within.contains(&start) {
                self.starts.push(key(start));
            }
            if within.contains(&end) {
                self.ends.push(key(end));
            }
        }
    }

    /// The cheapest plane at an event, the first of equals; `None` where none is strictly inside the cell. `before` counts
    /// what lies before all events; `all` counts all parts that are not planar as `ended`, and those that are as `planar`.
    fn sweep(&mut self, splits: &Splits, axis: usize, before: Count, all: Count) -> Option<Priced> {
        for keys in [&mut self.starts, &mut self.ends, &mut self.planar] {
            keys.sort_unstable();
        }
        let (starts, ends, planars) = (&self.starts, &self.ends, &self.planar);
        let mut best: Option<Priced> = None;
        let (mut i, mut j, mut k) = (0, 0, 0);
        loop {
            let first = |keys: &[u32], at: usize| keys.get(at).copied().unwrap_or(u32::MAX);
            let next = first(starts, i).min(first(ends, j)).min(first(planars, k));
            if next == u32::MAX {
                return best;
            }
            let (started, passed) = (before.started + i, before.planar + k);
            while first(ends, j) == next {
                j += 1;
            }
            let planar_from = k;
            while first(planars, k) == next {
                k += 1;
            }
            while first(starts, i) == next {
                i += 1;
            }
            let planar = k - planar_from;
            let at = place(next);
            if !splits.is_inside(at) {
                continue;
            }
            let below = started + passed;
            let above = (all.ended - before.ended - j) + (all.planar - passed - planar);
            let mut try_with = |planar_below: bool| {
                let (below, above) = if planar_below {
                    (below + planar, above)
                } else {
                    (below, above + planar)
                };
                let cost = splits.cost(at, below, above);
                let plane = Plane {
                    axis,
                    place: at,
                    planar_below,
                };
                best = cheaper(best, Some(Priced { plane, cost }));
            };
            try_with(true);
            if planar > 0 {
                try_with(false);
            }
        }
    }

    fn clear(&mut self) {
        for keys in [&mut self.starts, &mut self.ends, &mut self.planar] {
            keys.clear();
        }
    }

    /// The cheapest plane across `cell` along `axis`.
    fn along(&mut self, cell: &Aabb, parts: &[Part], axis: usize) -> Option<Priced> {
        let splits = Splits::new(cell, axis)?;
        self.clear();
        self.gather(parts, axis, &(f32::NEG_INFINITY..=f32::INFINITY));
        let all = Count {
            started: self.starts.len(),
            ended: self.ends.len(),
            planar: self.planar.len(),
        };
        self.sweep(&splits, axis, Count::default(), all)
    }

    /// The cheapest plane strictly inside `cell`, the first of equals; `None` where there is none or the cell has no area.
    pub fn best(&mut self, cell: &Aabb, parts: &[Part]) -> Option<Priced> {
        (0..3).fold(None, |best, axis| {
            cheaper(best, self.along(cell, parts, axis))
        })
    }

    /// The cheapest plane at an event within an interval.
    pub fn best_within(
        parts: &[Part],
        cell: &Aabb,
        axis: usize,
        within: &std::ops::RangeInclusive<f32>,
    ) -> Option<Priced> {
        let splits = Splits::new(cell, axis)?;
        let mut events = Self::default();
        let (mut before, mut all) = (Count::default(), Count::default());
        for part in parts {
            let (start, end) = part.interval(axis);
            if start == end {
                all.planar += 1;
                before.planar += usize::from(start < *within.start());
            } else {
                all.ended += 1;
                before.started += usize::from(start < *within.start());
                before.ended += usize::from(end < *within.start());
            }
        }
        events.gather(parts, axis, within);
        events.sweep(&splits, axis, before, all)
    }
}
