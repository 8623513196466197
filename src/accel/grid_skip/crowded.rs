//! Cells that list many triangles: of their blocks a ray tests those whose boxes it meets, eight boxes at once.
//!
//! ```text
//!   +-----------------+      a mesh that repeats itself on many scales has cells with hundreds of triangles whatever n is:
//!   | [..]   [....]   |      made finer until these are few, the grid would have a hundred cells a triangle. A box takes
//!   |  [.]o========   |      24 bytes, and eight are tested in a fraction of the time that a block takes to come from the
//!   +-----------------+      memory
//! ```
//!
//! The triangles of such a cell are parted at their middle, across the longest side of the box of their centroids, until eight
//! are left, so that those of a block are near each other.
//!
//! Measured on `sphereflake:4` (`raylab trace`, one thread, moller-trumbore, million rays/s): bounce rays 2.16 to 2.27 with half
//! of the cells, primary rays alike; with the cells of an even mesh, an eleventh as many, primary rays 1.9 to 3.6. Tried and not
//! kept, each with this test inlined into the loop over rays: a cell is crowded from 16 or 32 triangles on (other meshes lose 2 to
//! 17 and 2 to 12 %, a few rays gain a tenth); from 16 on, the nearest box first (7 to 12 % slower: sorting costs more than the
//! tests it spares), and boxes of all sixteen rays before any block (bounce rays alike, primary rays 4 % slower).

use std::marker::PhantomData;
use std::ops::Range;

use crate::geometry::Aabb;
use crate::geometry::lanes::{Isa, Lane, LaneMask, Ones, Task};
use crate::scene::Mesh;

use super::super::Visitor;
use super::super::items::LANES;
use super::super::parallel::{self, MANY};
use super::super::share::Span;
use super::super::slab::{Clip, NO_BOXES, Scene, WideCorners, box_in, put_box};

/// Triangles that a cell lists at most without being crowded.
const FEW: usize = 8 * LANES;

/// Boxes tested at once.
const BOXES: usize = 8;

/// The blocks of crowded cells, which come after all others.
#[derive(Debug)]
pub(super) struct Crowded {
    /// The first of them.
    first: u32,
    /// Their boxes.
    boxes: Vec<WideCorners>,
    scene: Scene,
}

impl Crowded {
    /// Of blocks from `first` on, of all whose triangles are `slots`.
    pub fn new(mesh: &Mesh, first: u32, slots: &[u32]) -> Self {
        let crowded = slots.get(first as usize * LANES..).unwrap_or_default();
        let groups = crowded.len().div_ceil(BOXES * LANES);
        let boxes = parallel::map(groups, MANY, |group| {
            let blocks = &crowded[group * BOXES * LANES..];
            let mut boxes = NO_BOXES;
            for (lane, block) in blocks.chunks(LANES).take(BOXES).enumerate() {
                let bounds = block.iter().map(|&prim| mesh.triangle_bounds(prim));
                put_box(&mut boxes, lane, &bounds.fold(Aabb::EMPTY, Aabb::union));
            }
            boxes
        });
        Self {
            first,
            boxes,
            scene: Scene::new(mesh.bounds()),
        }
    }

    /// Whether these are the blocks of a crowded cell.
    #[inline(always)]
    pub fn holds(&self, span: Span) -> bool {
        span.first >= self.first
    }

    /// Tests the blocks of a crowded cell that are met by what `slabs` gives; true when the query is finished.
    #[inline(always)]
    pub fn test<I: Isa, C: Clip<I::X8>, V: Visitor>(
        &self,
        span: Span,
        slabs: impl Fn() -> C,
        visitor: &mut V,
    ) -> bool {
        I::enter(Met {
            crowded: self,
            span,
            slabs,
            visitor,
            lanes: PhantomData::<I>,
        })
    }

    /// What holds all boxes.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Bytes of the boxes.
    pub fn bytes(&self) -> u64 {
        size_of_val(self.boxes.as_slice()) as u64
    }

    /// Whether there is a box for each block, of which `lanes` are the triangles, and holds all of these.
    ///
    /// # Errors
    /// A sentence that names the first broken promise.
    pub fn validate(&self, mesh: &Mesh, lanes: &[u32]) -> Result<(), String> {
        let (blocks, _) = lanes.as_chunks::<LANES>();
        for (place, block) in blocks.iter().skip(self.first as usize).enumerate() {
            let bounds = self.boxes.get(place / BOXES);
            let bounds = bounds.map_or(Aabb::EMPTY, |boxes| box_in(boxes, place % BOXES));
            let is_in = |prim: &u32| bounds.union(mesh.triangle_bounds(*prim)) == bounds;
            if !block.iter().all(is_in) {
                return Err(format!(
                    "the box of crowded block {place} leaves a triangle out"
                ));
            }
        }
        Ok(())
    }
}

/// A ray or a packet in a crowded cell; in a function of its own, so that it takes no registers from the loop over rays. Other
/// meshes were up to a tenth slower with it in that loop, for cells of more than 32; apart they are as much slower for these
/// (primary rays of `plant` and `city:300` 8 and 10 %, the sphereflake's 2 % faster), and for more than 64 they are not, but bounce
/// rays of `plant` with moller-trumbore.
struct Met<'t, I, S, V> {
    crowded: &'t Crowded,
    span: Span,
    slabs: S,
    visitor: &'t mut V,
    lanes: PhantomData<I>,
}

impl<I: Isa, C: Clip<I::X8>, S: Fn() -> C, V: Visitor> Task for Met<'_, I, S, V> {
    type Out = bool;

    #[inline(always)]
    fn run<Here: Isa>(self) -> bool {
        let Crowded { first, boxes, .. } = self.crowded;
        let slabs = (self.slabs)();
        let Range { mut start, end } = self.span.blocks();
        while start < end {
            let place = (start - first) as usize;
            let (group, lane) = (place / BOXES, place % BOXES);
            let (entry, exit): (I::X8, I::X8) = slabs.clip(&boxes[group], self.visitor.t_limit());
            let next = end.min(start + (BOXES - lane) as u32);
            let met = entry.le(exit).bits() >> lane & ((1 << (next - start)) - 1);
            for block in Ones(met) {
                if self.visitor.test(start + block as u32) {
                    return true;
                }
            }
            start = next;
        }
        false
    }
}

/// Whether a cell that lists these is crowded.
pub(super) fn is_crowd(list: &[u32]) -> bool {
    list.len() > FEW
}

/// The same triangles; those that are near each other in the same eight.
pub(super) fn clustered(mesh: &Mesh, list: &[u32]) -> Vec<u32> {
    let mut list = list.to_vec();
    cluster(mesh, &mut list);
    list
}

/// Puts triangles that are near each other into the same eight.
fn cluster(mesh: &Mesh, prims: &mut [u32]) {
    if prims.len() <= LANES {
        return;
    }
    let centre = |prim: u32| {
        let [a, b, c] = mesh.corners(prim);
        (a + b + c) / 3.0
    };
    let axis = Aabb::of_points(prims.iter().map(|&prim| centre(prim))).longest_axis();
    // Less than all, since these are more than eight; whole blocks, so that no block has triangles of both parts.
    let middle = (prims.len() / 2).next_multiple_of(LANES);
    prims.select_nth_unstable_by(middle, |&p, &q| {
        centre(p)[axis].total_cmp(&centre(q)[axis]).then(p.cmp(&q))
    });
    let (near, far) = prims.split_at_mut(middle);
    cluster(mesh, near);
    cluster(mesh, far);
}

#[cfg(test)]
mod tests {
    use super::super::super::testbed::{mesh, soup};
    use super::*;

    #[test]
    fn clusters_hold_the_same_triangles_near_each_other() {
        let mesh = mesh(&soup(200, 0.01, 3));
        let list: Vec<u32> = (0..200).filter(|prim| prim % 7 != 0).collect();
        let clustered = clustered(&mesh, &list);
        let mut sorted = clustered.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, list);
        let surface = |prims: &[u32]| -> f32 {
            let area = |block: &[u32]| {
                let boxes = block.iter().map(|&prim| mesh.triangle_bounds(prim));
                boxes.fold(Aabb::EMPTY, Aabb::union).half_area()
            };
            prims.chunks(LANES).map(area).sum()
        };
        assert!(surface(&clustered) < 0.3 * surface(&list));
    }

    #[test]
    fn a_box_that_leaves_a_triangle_out_is_found() {
        let mesh = mesh(&soup(100, 0.01, 3));
        let slots = clustered(&mesh, &(0..96).collect::<Vec<u32>>());
        let mut crowded = Crowded::new(&mesh, 2, &slots);
        crowded.validate(&mesh, &slots).unwrap();
        assert!(!crowded.holds(Span { first: 1, count: 1 }));
        assert!(crowded.holds(Span { first: 2, count: 1 }));
        crowded.boxes[1][2][1][1] *= 0.5;
        let broken = crowded.validate(&mesh, &slots).unwrap_err();
        assert!(broken.contains("crowded block 9"), "{broken}");
    }
}
