//! Batches: the rays that a structure traces in the way that suits them, and where their answers go.

use crate::geometry::lanes::{Isa, Lane, LaneMask, Ones, RayLanes, SIXTEEN, prefetch};
use crate::geometry::{Hit, Ray};
use crate::kernel::Kernel;

use super::items::Items;
use super::packet::{Bundle, Packet, Vector};
use super::query::{Packed, Query};
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

    /// Sixteen rays as the kernel reads them.
    type Sixteen;

    /// Rays in lanes, of which `lead` is one; `None` where the kernel wants them one by one.
    fn sixteen(
        &self,
        lead: &Ray,
        lanes: &RayLanes<<Self::Isa as Isa>::Rays>,
    ) -> Option<Self::Sixteen>;

    /// Tests an item against those of sixteen rays whose bit is set, triangle by triangle; each has its visitor.
    fn test_sixteen(
        &self,
        rays: &Self::Sixteen,
        active: u32,
        item: u32,
        visitors: &mut [Self::Visitor],
    );

    /// What a traversal of a packet reports to.
    type Packet<'p>: Visitor
    where
        'a: 'p;

    /// The visitor of a packet, the first ray of which has index `first`; handed back by [`Rays::finish_packet`]. `None`
    /// where the kernel wants its rays one by one. It gives up, and ends the traversal, when its cost exceeds `budget`, about
    /// nanoseconds.
    fn begin_packet<'p>(
        &mut self,
        bundle: &'p Bundle<'a, <Self::Isa as Isa>::Rays>,
        first: usize,
        budget: u32,
    ) -> Option<Self::Packet<'p>>;

    /// Takes the answers of a packet and returns what it cost; `None` if it gave up.
    fn finish_packet(&mut self, packet: Self::Packet<'_>) -> Option<u32>;

    /// Takes the answer of a ray.
    fn finish(&mut self, index: usize, visitor: &Self::Visitor);
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

    type Sixteen = K::Prepared<1, I::Rays>;

    #[inline(always)]
    fn sixteen(&self, lead: &Ray, lanes: &RayLanes<I::Rays>) -> Option<Self::Sixteen> {
        let alike = K::same_frame(lead, &lanes.lines.dir);
        alike.then(
            #[inline(always)]
            || self.packed.kernel.prepare(lead, &lanes.lines),
        )
    }

    #[inline(always)]
    fn test_sixteen(
        &self,
        rays: &Self::Sixteen,
        mut active: u32,
        item: u32,
        visitors: &mut [Self::Visitor],
    ) {
        T::each_triangle(
            &self.packed.items,
            item,
            #[inline(always)]
            |prim, triangle: &K::Packed<1>| {
                let Some(hit) = self.packed.kernel.intersect(rays, triangle) else {
                    return;
                };
                let met = hit.mask.bits() & active;
                if met == 0 {
                    return;
                }
                let bounds = K::t_error_bound(rays, triangle, hit.t);
                for lane in Ones(met) {
                    let visitor = &mut visitors[lane % SIXTEEN];
                    let taken = visitor.offer(prim, &hit, lane, || bounds.get(lane));
                    if OCCLUSION && taken {
                        active &= !(1 << lane);
                    }
                }
            },
        );
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
    ) -> Option<Self::Packet<'p>> {
        if bundle.suits::<K>() {
            let room = std::mem::take(&mut self.vectors);
            Some(Packet::new(self.packed, bundle, first, budget, room))
        } else {
            None
        }
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
