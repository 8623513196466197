//! The build with spatial splits: where the sides of the best object split overlap, a plane may cut the references that
//! it meets, so that a triangle is referenced on both sides, each time with the box of its part there.
//!
//! ```text
//!   object split:  +--------+          spatial split:  +-----:-----+     a long triangle across the plane is
//!                  |  +-----|---+                      |     :     |     referenced twice, and the boxes no
//!                  +--|-----+   |                      |     :     |     longer overlap
//!                     +---------+                      +-----:-----+
//! ```
//!
//! First the top of the tree is decided, as far down as references may be added; then it is known how many there are,
//! and what is below is built as by the binned build.
//!
//! **Source:** M. Stich, H. Friedrich and A. Dietrich, "Spatial Splits in Bounding Volume Hierarchies", HPG 2009.
//! **Differs:** references are bounded by a part of the triangles ([`Effort`]); the allowance goes down the tree in proportion to
//! the areas of boxes.

use crate::geometry::Aabb;
use crate::scene::Mesh;

use super::super::clip::clipped_halves;
use super::super::parallel;
use super::super::sah::half_area;
use super::binned::{self, Limb, PARALLEL, Place};
use super::chop::{self, Plane, Search};
use super::loops::Loops;
use super::partition::Task;
use super::reference::{Bounds, Extent, Reference};
use super::{BinaryTree, small};

/// Where one reference may be added to more than so many, little is to be gained.
const CROWDED: usize = 64;

/// How far spatial splits go.
#[derive(Debug, Clone, Copy)]
pub(super) struct Effort {
    /// References that may be added, as a part of the triangles.
    more: f64,
    /// Sides that overlap by less than this part of the root's area are left alone (Stich et al., §4.1).
    overlap: f64,
    /// Nodes with no more references are left to the binned build.
    least: usize,
    search: Search,
}

impl Effort {
    /// What makes the cheapest tree.
    pub const FULL: Self = Self {
        more: 0.5,
        overlap: 1e-5,
        least: small::MOST,
        search: Search::FULL,
    };

    /// Few splits where they save most. Measured on the two-cylinder engine with `bvh-wide`, bounce and random rays, against
    /// [`Effort::FULL`] in leaves of eight: 0 to 5 % more nodes are visited, and the tree takes 10 % less memory and its top
    /// much less time. A search on all axes and among all references visits as many nodes and takes three times as
    /// long; an overlap of 0.03 visits 3 % more.
    pub const TOP: Self = Self {
        more: 0.2,
        overlap: 0.01,
        least: 256,
        search: Search {
            sample: 256,
            longest_only: true,
        },
    };
}

/// A tree over `mesh` whose leaves hold at most `most` references each.
pub(super) fn build(mesh: &Mesh, effort: Effort, most: usize) -> BinaryTree {
    let count = mesh.len();
    let more = (effort.more * count as f64) as usize;
    let mut references = binned::references_before(mesh, more);
    let mut spare = parallel::filled(count + more, Reference::NONE);
    let builder = Builder {
        mesh,
        overlap: effort.overlap * half_area(&mesh.bounds()),
        effort,
        loops: Loops::best(),
    };
    let top = builder.top(Task::new(&mut references, &mut spare, count), 0);
    binned::grow(top.count(), most, |place| top.limb(place, builder.loops))
}

/// The top of a tree.
enum Top<'a> {
    /// To be built without spatial splits.
    Rest(Task<'a>),
    Split {
        bounds: Bounds,
        /// References below.
        count: usize,
        sides: Box<[Top<'a>; 2]>,
    },
}

impl Top<'_> {
    fn count(&self) -> usize {
        match self {
            Top::Rest(task) => task.len(),
            Top::Split { count, .. } => *count,
        }
    }

    /// The tree below, complete.
    fn limb(self, place: Place, loops: Loops) -> Limb {
        let (bounds, count, [first, second]) = match self {
            Top::Rest(task) => return binned::split(task, place, loops),
            Top::Split {
                bounds,
                count,
                sides,
            } => (bounds.aabb(), count, *sides),
        };
        let [a_place, b_place] = place.split(first.count());
        let (a, b) = join(
            count,
            || first.limb(a_place, loops),
            || second.limb(b_place, loops),
        );
        Limb::Fork {
            bounds,
            sides: Box::new([a, b]),
        }
    }
}

/// Both, in parallel where there is much to do.
fn join<A: Send, B: Send>(
    count: usize,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if count >= PARALLEL {
        rayon::join(a, b)
    } else {
        (a(), b())
    }
}

struct Builder<'a> {
    mesh: &'a Mesh,
    /// Least half area of an overlap that is worth a spatial split.
    overlap: f64,
    effort: Effort,
    loops: Loops,
}

impl Builder<'_> {
    /// The top of the tree over what `task` holds, at `depth`.
    fn top<'a>(&self, task: Task<'a>, depth: usize) -> Top<'a> {
        let count = task.len();
        // References that are added below may need one more level each time they double.
        let is_deep = !binned::may_choose(depth + 1, 2 * count);
        if count <= self.effort.least || task.room() * CROWDED < count || is_deep {
            return Top::Rest(task);
        }
        let bounds = task.extent.bounds;
        let [first, second] = self.divided(task);
        let sides = join(
            count,
            || self.top(first, depth + 1),
            || self.top(second, depth + 1),
        );
        Top::Split {
            bounds,
            count: sides.0.count() + sides.1.count(),
            sides: Box::new([sides.0, sides.1]),
        }
    }

    /// Both sides of the better split.
    fn divided<'a>(&self, task: Task<'a>) -> [Task<'a>; 2] {
        let object = task.choose(self.loops);
        let overlaps = object.as_ref().is_none_or(|choice| {
            let [a, b] = choice.split.sides.map(|side| side.aabb());
            half_area(&a.intersection(b)) > self.overlap
        });
        let least = object.as_ref().map_or(f32::INFINITY, |c| c.split.cost);
        let plane = overlaps
            .then(|| chop::best(self.mesh, &task, self.effort.search))
            .flatten()
            .filter(|plane| plane.cost < least);
        let task = match plane {
            Some(plane) => match self.cut(task, &plane) {
                Ok(sides) => return sides,
                Err(task) => task,
            },
            None => task,
        };
        match object {
            Some(choice) => task.divided(self.loops, &choice),
            None => task.halved(),
        }
    }

    /// Both sides of `plane`; the task itself where there is no room or a side would be empty.
    fn cut<'a>(&self, mut task: Task<'a>, plane: &Plane) -> Result<[Task<'a>; 2], Task<'a>> {
        let cut = task
            .references()
            .iter()
            .filter(|reference| plane.cuts(&reference.bounds()))
            .count();
        if cut > task.room() {
            return Err(task);
        }
        let (references, to) = task.parts();
        let mut sides = Sides::new(to, plane);
        for reference in references {
            let bounds = reference.bounds();
            if plane.cuts(&bounds) {
                let [first, second] = self.pieces(reference, plane);
                sides.add_cut(reference, first, second);
            } else {
                sides.add(plane.is_beyond(&bounds), *reference);
            }
        }
        let (counts, extents) = (sides.counts, sides.extents);
        if counts.contains(&0) {
            return Err(task);
        }
        Ok(task.moved(counts, extents))
    }

    /// The boxes of what a reference has on both sides of a plane.
    fn pieces(&self, reference: &Reference, plane: &Plane) -> [Option<Aabb>; 2] {
        let corners = self.mesh.corners(reference.prim());
        let whole = reference.bounds().aabb();
        clipped_halves(&corners, &whole, plane.axis, plane.place)
    }
}

/// The two sides of a plane while they are filled, from both ends of a room.
struct Sides<'a> {
    to: &'a mut [Reference],
    counts: [usize; 2],
    extents: [Extent; 2],
    /// What the sides are expected to be in the end.
    expected: [(Bounds, f32); 2],
    scale: f32,
}

impl<'a> Sides<'a> {
    fn new(to: &'a mut [Reference], plane: &Plane) -> Self {
        let [a, b] = plane.sides;
        Self {
            to,
            counts: [0; 2],
            extents: [Extent::EMPTY; 2],
            expected: [(a, plane.counts[0] as f32), (b, plane.counts[1] as f32)],
            scale: a.union(b).scale(),
        }
    }

    fn add(&mut self, second: bool, reference: Reference) {
        let side = usize::from(second);
        let at = if second {
            self.to.len() - 1 - self.counts[1]
        } else {
            self.counts[0]
        };
        self.to[at] = reference;
        self.counts[side] += 1;
        self.extents[side] = self.extents[side].grown(&reference);
    }

    /// Adds the two pieces of a reference, or the whole of it to one side where that costs less.
    fn add_cut(&mut self, whole: &Reference, first: Option<Aabb>, second: Option<Aabb>) {
        let (Some(first), Some(second)) = (first, second) else {
            // All of the triangle's part in the box is on one side.
            let (side, piece) = (first.is_none(), first.or(second));
            let kept = piece.map_or(*whole, |piece| Reference::new(piece, whole.prim()));
            self.add(side, kept);
            return;
        };
        let area = |bounds: Bounds| bounds.half_area(self.scale);
        let [(a, a_count), (b, b_count)] = self.expected;
        let (a_area, b_area) = (area(a), area(b));
        let (a_grown, b_grown) = (a.union(whole.bounds()), b.union(whole.bounds()));
        let cut = a_area * a_count + b_area * b_count;
        let into_first = area(a_grown) * a_count + b_area * (b_count - 1.0);
        let into_second = a_area * (a_count - 1.0) + area(b_grown) * b_count;
        if cut <= into_first.min(into_second) {
            self.add(false, Reference::new(first, whole.prim()));
            self.add(true, Reference::new(second, whole.prim()));
        } else if into_first <= into_second {
            self.expected = [(a_grown, a_count), (b, b_count - 1.0)];
            self.add(false, *whole);
        } else {
            self.expected = [(a, a_count - 1.0), (b_grown, b_count)];
            self.add(true, *whole);
        }
    }
}
