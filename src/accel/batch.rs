//! Batches: the rays that a structure traces in the way that suits them, and where their answers go.

use std::marker::PhantomData;
use std::ops::Range;

use crate::geometry::lanes::{Isa, Lane, LaneMask, Ones, RayLanes, SIXTEEN, Task, prefetch};
use crate::geometry::{Hit, Ray};
use crate::kernel::Kernel;

use super::Structure;
use super::items::Items;
use super::packet::{Bundle, Packet, Vector};
use super::query::{Packed, Query};
use super::slab::{Scene, WideSlabRay};
use super::visit::{Uncounted, Visitor};

/// What is kept of a query.
pub(super) trait Answer: Copy {
    /// The answer that the query's best hit gives.
    fn of(best: Hit) -> Self;
}

impl Answer for Hit {
    #[inline(always)]
    fn of(best: Hit) -> Self {
        best
    }
}

impl Answer for bool {
    #[inline(always)]
    fn of(best: Hit) -> Self {
        best.is_hit()
    }
}

/// The rays of a batch and a visitor for each.
pub trait Rays<'a> {
    /// The lanes to trace with.
    type Isa: Isa;
    /// What a traversal of one ray reports to.
    type Visitor: Visitor;

    /// The rays.
    fn rays(&self) -> &'a [Ray];

    /// The visitor of the ray with this index, which is handed back by [`Rays::finish`] when the traversal is over.
    fn begin(&self, index: usize) -> Self::Visitor;

    /// As [`Rays::begin`], in the place of the visitor of a ray that is done: what it holds is moved nowhere.
    fn begin_again(&self, index: usize, visitor: &mut Self::Visitor);

    /// Where the items lie in memory.
    fn items(&self) -> *const u8;

    /// The bytes of one.
    const ITEM_BYTES: usize;

    /// Asks the memory for an item that will be tested soon.
    #[inline(always)]
    fn prefetch(&self, item: u32) {
        let place = item as usize * Self::ITEM_BYTES;
        prefetch(self.items().wrapping_add(place), Self::ITEM_BYTES);
    }

    /// Whether its kernel is worth compiling every way of tracing a batch for: where not, rays go one by one.
    const WAYS: bool;

    /// Whether one triangle is tested against sixteen rays. Where any hit will do, a kernel that compares hits more exactly than
    /// their `t` tells goes ray by ray: on four of seven meshes that is faster, up to twice, on three slower, by up to a quarter.
    const GROUPS: bool;

    /// Sixteen rays as the kernel reads them.
    type Sixteen;

    /// Rays in lanes, of which `lead` is one.
    fn sixteen(&self, lead: &Ray, lanes: &RayLanes<<Self::Isa as Isa>::Rays>) -> Self::Sixteen;

    /// The triangles of an item of `scene` whose boxes `ray` meets until `limit`, a bit each.
    fn met_by(&self, item: u32, ray: &WideSlabRay, limit: f32, scene: &Scene) -> u32;

    /// Tests those triangles of an item whose bit is set in `met`, one by one, against those of sixteen rays whose bit is set
    /// in `active`; each has its visitor. Returns a bit for each that took a hit. Asked only where [`Rays::GROUPS`] is set.
    fn test_sixteen(
        &self,
        rays: &Self::Sixteen,
        active: u32,
        item: u32,
        met: u32,
        visitors: &mut [Self::Visitor],
    ) -> u32;

    /// What a traversal of a packet reports to.
    type Packet<'p>: Visitor
    where
        'a: 'p;

    /// The visitor of a packet, the first ray of which has index `first`; handed back by [`Rays::finish_packet`]. It gives up,
    /// and ends the traversal, when its cost exceeds `budget`, about nanoseconds.
    fn begin_packet<'p>(
        &mut self,
        bundle: &'p Bundle<'a, <Self::Isa as Isa>::Rays>,
        first: usize,
        budget: u32,
    ) -> Self::Packet<'p>;

    /// Takes the answers of a packet and returns what it cost; `None` if it gave up.
    fn finish_packet(&mut self, packet: Self::Packet<'_>) -> Option<u32>;

    /// Takes the answer of a ray.
    fn finish(&mut self, index: usize, visitor: &Self::Visitor);
}

/// How the rays of a batch are traced through a structure, or some of them.
pub(super) trait Course<S: Structure> {
    /// What is learnt on the way.
    type Out;

    /// Traces the rays in `range`.
    fn run<'a, R: Rays<'a>>(
        structure: &S,
        batch: &mut R,
        range: Range<usize>,
        scratch: &mut S::Scratch,
    ) -> Self::Out;
}

/// Runs `C` in a function of its own: within a larger one the compiler keeps less in registers.
#[inline(always)]
pub(super) fn run_apart<'a, C: Course<S>, S: Structure, R: Rays<'a>>(
    structure: &S,
    batch: &mut R,
    range: Range<usize>,
    scratch: &mut S::Scratch,
) -> C::Out {
    R::Isa::enter(OnCourse::<C, S, R> {
        structure,
        batch,
        range,
        scratch,
        course: PhantomData,
    })
}

/// Rays on a course.
struct OnCourse<'t, 'a, C, S: Structure, R: Rays<'a>> {
    structure: &'t S,
    batch: &'t mut R,
    range: Range<usize>,
    scratch: &'t mut S::Scratch,
    course: PhantomData<(C, &'a ())>,
}

impl<'a, C: Course<S>, S: Structure, R: Rays<'a>> Task for OnCourse<'_, 'a, C, S, R> {
    type Out = C::Out;

    #[inline(always)]
    fn run<I: Isa>(self) -> C::Out {
        C::run(self.structure, self.batch, self.range, self.scratch)
    }
}

/// Sixteen rays as the kernel reads them.
pub struct Sixteen<K: Kernel, I: Isa> {
    prepared: K::Prepared<1, I::Rays>,
    t_min: I::Rays,
    t_max: I::Rays,
}

/// Rays bound to a kernel and a query.
pub(super) struct Batch<'a, T: Items, K: Kernel, I: Isa, A, const OCCLUSION: bool> {
    packed: &'a Packed<T, K>,
    rays: &'a [Ray],
    answers: &'a mut [A],
    /// Room for the vectors of a packet.
    vectors: Vec<Vector<K, I>>,
}

impl<'a, T: Items, K: Kernel, I: Isa, A, const OCCLUSION: bool> Batch<'a, T, K, I, A, OCCLUSION> {
    /// `answers` are as many as `rays`.
    pub fn new(packed: &'a Packed<T, K>, rays: &'a [Ray], answers: &'a mut [A]) -> Self {
        Self {
            packed,
            rays,
            answers,
            vectors: Vec::new(),
        }
    }
}

impl<'a, T: Items, K: Kernel, I: Isa, A: Answer, const OCCLUSION: bool> Rays<'a>
    for Batch<'a, T, K, I, A, OCCLUSION>
{
    type Isa = I;
    type Visitor = Query<'a, T, K, I, Uncounted, OCCLUSION>;

    #[inline(always)]
    fn rays(&self) -> &'a [Ray] {
        self.rays
    }

    #[inline(always)]
    fn begin(&self, index: usize) -> Self::Visitor {
        Query::new(self.packed, &self.rays[index], Uncounted)
    }

    #[inline(always)]
    fn begin_again(&self, index: usize, visitor: &mut Self::Visitor) {
        visitor.begin_again(&self.rays[index]);
    }

    #[inline(always)]
    fn items(&self) -> *const u8 {
        self.packed.items.as_ptr().cast()
    }

    const ITEM_BYTES: usize = size_of::<T::Item<K>>();

    const WAYS: bool = K::PACKETS && I::SIXTEEN;

    const GROUPS: bool = Self::WAYS && !(OCCLUSION && K::EXACT_T);

    type Sixteen = Sixteen<K, I>;

    #[inline(always)]
    fn sixteen(&self, lead: &Ray, lanes: &RayLanes<I::Rays>) -> Self::Sixteen {
        Sixteen {
            prepared: self.packed.kernel.prepare(lead, &lanes.lines),
            t_min: lanes.t_min,
            t_max: lanes.t_max,
        }
    }

    #[inline(always)]
    fn met_by(&self, item: u32, ray: &WideSlabRay, limit: f32, scene: &Scene) -> u32 {
        T::met_by::<K, I>(&self.packed.items[item as usize], ray, limit, scene)
    }

    #[inline(always)]
    fn test_sixteen(
        &self,
        rays: &Self::Sixteen,
        active: u32,
        item: u32,
        met: u32,
        visitors: &mut [Self::Visitor],
    ) -> u32 {
        let kernel = &self.packed.kernel;
        let items = &self.packed.items[item as usize];
        let mut taken = 0;
        let interval = if K::EXACT_T {
            // What lies outside may be for the kernel to say.
            [f32::NEG_INFINITY, f32::INFINITY].map(I::Rays::splat)
        } else {
            [rays.t_min, rays.t_max]
        };
        if OCCLUSION {
            for place in Ones(met) {
                let (_, triangle) = T::triangle::<K>(items, item, place);
                let found = kernel.intersect_within(&rays.prepared, &triangle, interval);
                // Not a branch: where none is hit no bit is set.
                taken |= found.map_or(0, |hit| hit.mask.bits());
            }
            taken &= active;
            for lane in Ones(taken) {
                visitors[lane % SIXTEEN].block();
            }
            return taken;
        }
        for place in Ones(met) {
            let (prim, triangle) = T::triangle::<K>(items, item, place);
            let found = kernel.intersect_within(&rays.prepared, &triangle, interval);
            let Some(hit) = found else {
                continue;
            };
            let hit_by = hit.mask.bits() & active;
            if hit_by == 0 {
                continue;
            }
            let bounds = K::t_error_bound(&rays.prepared, &triangle, &hit);
            for lane in Ones(hit_by) {
                let visitor = &mut visitors[lane % SIXTEEN];
                let takes = visitor.offer_met(hit.of_lane(lane, prim), || bounds.get(lane));
                taken |= u32::from(takes) << lane;
            }
        }
        taken
    }

    type Packet<'p>
        = Packet<'a, 'p, T, K, I>
    where
        'a: 'p;

    #[inline(always)]
    fn begin_packet<'p>(
        &mut self,
        bundle: &'p Bundle<'a, I::Rays>,
        first: usize,
        budget: u32,
    ) -> Self::Packet<'p> {
        let room = std::mem::take(&mut self.vectors);
        Packet::new(self.packed, bundle, first, budget, room)
    }

    #[inline(always)]
    fn finish_packet(&mut self, packet: Self::Packet<'_>) -> Option<u32> {
        let cost = packet.cost();
        if cost.is_some() {
            packet.answer(self.answers);
        }
        self.vectors = packet.into_room();
        cost
    }

    #[inline(always)]
    fn finish(&mut self, index: usize, visitor: &Self::Visitor) {
        self.answers[index] = A::of(visitor.best);
    }
}
