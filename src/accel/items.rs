//! Items: how the triangles of a structure lie in memory, one by one or in blocks of eight.
//!
//! ```text
//! Singles   | 0 | 1 | 2 | ...                   one a triangle, in file order; a structure lists indices
//! Blocks    | 7 2 9 9 9 9 9 9 | 0 4 4 4 4 4 4 4 |   eight lanes a block, in the structure's order
//! ```
//!
//! A block is tested by one instruction stream for all its lanes, compiled for the instruction set of the processor. Lanes
//! that are left repeat the last triangle: its hit is offered again and is not preferred to itself.

use crate::geometry::lanes::{InstructionSet, Isa, Lane, LaneMask, Ones, Portable, Task};
use crate::kernel::Kernel;
use crate::scene::Mesh;

use super::packet::Packet;
use super::parallel;
use super::query::Query;
use super::slab::{Clip, Scene, WideSlabRay};
use super::visit::Counter;

/// Lanes of a block.
pub(super) const LANES: usize = 8;

/// More than a kernel's corners are off, in units of the scene's largest coordinate: 3u, of which an edge's rounding is two.
const CORNER_PAD: f32 = 2.0 * f32::EPSILON;

/// How a structure's triangles lie in memory.
pub trait Items: Sized + Send + Sync + 'static {
    /// Whether an item holds a triangle a lane.
    const LANES: bool;
    /// What is tested at once.
    type Item<K: Kernel>: Send + Sync;

    /// Packs the triangles with these indices, in this order; for blocks whole ones, see `fill`.
    fn pack<K: Kernel>(kernel: &K, mesh: &Mesh, slots: &[u32]) -> Vec<Self::Item<K>>;

    /// The triangle in each lane of each block.
    fn lanes<K: Kernel>(_items: &[Self::Item<K>]) -> Vec<u32> {
        Vec::new()
    }

    /// Tests an item; returns true when the query is finished.
    fn test<K: Kernel, I: Isa, C: Counter, const OCCLUSION: bool>(
        query: &mut Query<'_, Self, K, I, C, OCCLUSION>,
        item: u32,
    ) -> bool;

    /// The triangles of an item of `scene` whose boxes `ray` meets until `limit`, a bit each.
    fn met_by<K: Kernel, I: Isa>(
        item: &Self::Item<K>,
        ray: &WideSlabRay,
        limit: f32,
        scene: &Scene,
    ) -> u32;

    /// The triangle in a lane of an item, and its index; `index` is the item's.
    fn triangle<K: Kernel>(item: &Self::Item<K>, index: u32, lane: usize) -> (u32, K::Packed<1>);

    /// Tests an item against the rays of a packet.
    fn test_packet<K: Kernel, I: Isa>(packet: &mut Packet<'_, '_, Self, K, I>, item: u32);

    /// `set` where these items use lanes, else none.
    fn instruction_set(set: InstructionSet) -> InstructionSet;

    /// Runs `task` with the lanes of `set` where these items use lanes, else without any.
    fn run<T: Task>(set: InstructionSet, task: T) -> T::Out;
}

/// One triangle an item, in file order.
#[derive(Debug, Clone, Copy)]
pub struct Singles;

/// Eight triangles an item.
#[derive(Debug, Clone, Copy)]
pub struct Blocks;

/// Eight triangles and their indices.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub struct Block<P> {
    triangles: P,
    prims: [u32; LANES],
}

impl<P> Block<P> {
    /// The lanes that hold a triangle of their own, a bit each: those that are left over repeat the last.
    #[inline(always)]
    fn filled_lanes(&self) -> u32 {
        let mut own = 1;
        for lane in 1..LANES {
            own |= u32::from(self.prims[lane - 1] != self.prims[lane]) << lane;
        }
        own
    }

    /// As numbers.
    #[inline(always)]
    fn filled(&self) -> Ones {
        Ones(self.filled_lanes())
    }
}

/// Appends whole blocks with these triangles, of which there is at least one, to `slots`.
pub(super) fn fill(slots: &mut Vec<u32>, prims: &[u32]) {
    slots.extend_from_slice(prims);
    if let Some(last) = prims.last() {
        slots.resize(slots.len().next_multiple_of(LANES), *last);
    }
}

/// So many blocks before one is packed the corners of its triangles are fetched, and what names these as long before that.
/// Triangles that are neighbours in space are often not so in memory: without it packing took a third of the build of
/// `bvh-wide` over `soup:1000000`, and a tenth over other meshes.
const AHEAD: usize = 4;

impl Items for Singles {
    const LANES: bool = false;
    type Item<K: Kernel> = K::Packed<1>;

    fn pack<K: Kernel>(kernel: &K, mesh: &Mesh, slots: &[u32]) -> Vec<K::Packed<1>> {
        let pack = |prim: &u32| kernel.pack(|_| mesh.corners(*prim));
        slots.iter().map(pack).collect()
    }

    #[inline(always)]
    fn test<K: Kernel, I: Isa, C: Counter, const OCCLUSION: bool>(
        query: &mut Query<'_, Self, K, I, C, OCCLUSION>,
        prim: u32,
    ) -> bool {
        let (packed, prepared) = (query.packed, query.prepared::<1, f32>());
        let found = packed
            .kernel
            .intersect(&prepared, &packed.items[prim as usize]);
        let Some(hit) = found else {
            query.counter.test(prim, None, false);
            return false;
        };
        let bound = || K::t_error_bound(&prepared, &packed.items[prim as usize], &hit);
        let taken = query.offer(hit.of_lane(0, prim), bound);
        query.counter.test(prim, Some(hit.t), taken);
        OCCLUSION && taken
    }

    #[inline(always)]
    fn met_by<K: Kernel, I: Isa>(_: &K::Packed<1>, _: &WideSlabRay, _: f32, _: &Scene) -> u32 {
        1
    }

    #[inline(always)]
    fn triangle<K: Kernel>(triangle: &K::Packed<1>, prim: u32, _: usize) -> (u32, K::Packed<1>) {
        (prim, triangle.clone())
    }

    #[inline(always)]
    fn test_packet<K: Kernel, I: Isa>(packet: &mut Packet<'_, '_, Self, K, I>, prim: u32) {
        let packed = packet.packed;
        packet.test_triangles(
            1,
            |_, _| true,
            #[inline(always)]
            |lane| Self::triangle::<K>(&packed.items[prim as usize], prim, lane),
        );
    }

    fn instruction_set(_: InstructionSet) -> InstructionSet {
        InstructionSet::Portable
    }

    #[inline]
    fn run<T: Task>(_: InstructionSet, task: T) -> T::Out {
        task.run::<Portable>()
    }
}

impl Items for Blocks {
    const LANES: bool = true;
    type Item<K: Kernel> = Block<K::Packed<LANES>>;

    fn pack<K: Kernel>(kernel: &K, mesh: &Mesh, slots: &[u32]) -> Vec<Self::Item<K>> {
        let (whole, _) = slots.as_chunks::<LANES>();
        parallel::map(whole.len(), parallel::MANY, |i| {
            for prim in whole.get(i + 2 * AHEAD).into_iter().flatten() {
                mesh.prefetch_triangle(*prim);
            }
            for prim in whole.get(i + AHEAD).into_iter().flatten() {
                mesh.prefetch_corners(*prim);
            }
            let prims = whole[i];
            Block {
                triangles: kernel.pack(|lane| mesh.corners(prims[lane])),
                prims,
            }
        })
    }

    fn lanes<K: Kernel>(items: &[Self::Item<K>]) -> Vec<u32> {
        items.iter().flat_map(|block| block.prims).collect()
    }

    #[inline(always)]
    fn test<K: Kernel, I: Isa, C: Counter, const OCCLUSION: bool>(
        query: &mut Query<'_, Self, K, I, C, OCCLUSION>,
        item: u32,
    ) -> bool {
        let (packed, prepared) = (query.packed, query.prepared::<LANES, I::X8>());
        let block = &packed.items[item as usize];
        if C::COUNTS {
            let found = packed.kernel.intersect(&prepared, &block.triangles);
            let mut finished = false;
            for lane in block.filled() {
                let prim = block.prims[lane];
                let hit = found
                    .as_ref()
                    .filter(|hit| hit.mask.bits() >> lane & 1 == 1);
                let taken = hit.is_some_and(|hit| {
                    let bound = || K::t_error_bound(&prepared, &block.triangles, hit).get(lane);
                    !finished && query.offer(hit.of_lane(lane, prim), bound)
                });
                query
                    .counter
                    .test(prim, hit.map(|hit| hit.t.get(lane)), taken);
                finished |= OCCLUSION && taken;
            }
            return finished;
        }
        let interval = [query.t_least(), query.t_most()].map(I::X8::splat);
        let found = packed
            .kernel
            .intersect_within(&prepared, &block.triangles, interval);
        let Some(hit) = found else {
            return false;
        };
        let bounds = K::t_error_bound(&prepared, &block.triangles, &hit);
        for lane in Ones(hit.mask.bits()) {
            let lane = lane & (LANES - 1);
            let hit = hit.of_lane(lane, block.prims[lane]);
            if query.offer_met(hit, || bounds.get(lane)) && OCCLUSION {
                return true;
            }
        }
        false
    }

    #[inline(always)]
    fn met_by<K: Kernel, I: Isa>(
        block: &Self::Item<K>,
        ray: &WideSlabRay,
        limit: f32,
        scene: &Scene,
    ) -> u32 {
        let [a, b, c] = K::corners::<I::X8>(&block.triangles);
        let pad = I::X8::splat(CORNER_PAD * scene.largest);
        let bounds = |a: I::X8, b: I::X8, c: I::X8| {
            let mut bounds = [[0.0; LANES]; 2];
            (a.min(b).min(c) - pad).write(&mut bounds[0]);
            (a.max(b).max(c) + pad).write(&mut bounds[1]);
            bounds
        };
        let boxes = [
            bounds(a.x, b.x, c.x),
            bounds(a.y, b.y, c.y),
            bounds(a.z, b.z, c.z),
        ];
        let (entry, exit): (I::X8, I::X8) = ray.clip(&boxes, limit);
        entry.le(exit).bits() & block.filled_lanes()
    }

    #[inline(always)]
    fn triangle<K: Kernel>(block: &Self::Item<K>, _: u32, lane: usize) -> (u32, K::Packed<1>) {
        let lane = lane & (LANES - 1);
        (block.prims[lane], K::lane(&block.triangles, lane))
    }

    #[inline(always)]
    fn test_packet<K: Kernel, I: Isa>(packet: &mut Packet<'_, '_, Self, K, I>, item: u32) {
        let packed = packet.packed;
        let block = &packed.items[item as usize];
        let seen = packet.see(K::corners(&block.triangles));
        if seen.met == 0 {
            return;
        }
        packet.test_triangles(
            block.filled_lanes() & seen.met,
            #[inline(always)]
            |lane, dirs| seen.can_be_hit(lane, dirs),
            #[inline(always)]
            |lane| Self::triangle::<K>(block, item, lane),
        );
    }

    fn instruction_set(set: InstructionSet) -> InstructionSet {
        set
    }

    #[inline]
    fn run<T: Task>(set: InstructionSet, task: T) -> T::Out {
        set.run(task)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testbed::{Dice, mesh};
    use super::*;
    use crate::geometry::lanes::LaneRay;
    use crate::geometry::{Ray, Vec3};
    use crate::kernel::{self, KernelUser};

    /// A ray and a block of triangles: which of them the kernel hits, and the boxes of which are met.
    struct Asked<'a, K: Kernel> {
        kernel: &'a K,
        mesh: &'a Mesh,
        ray: Ray,
    }

    impl<K: Kernel> Asked<'_, K> {
        fn block(&self) -> Block<K::Packed<LANES>> {
            Blocks::pack(self.kernel, self.mesh, &[0, 1, 2, 3, 4, 5, 5, 5]).remove(0)
        }

        fn prepared<L: Lane<LANES>>(&self) -> K::Prepared<LANES, L> {
            self.kernel.prepare(&self.ray, &LaneRay::splat(&self.ray))
        }
    }

    impl<K: Kernel> Task for Asked<'_, K> {
        type Out = (u32, u32);

        fn run<I: Isa>(self) -> Self::Out {
            let (block, prepared) = (&self.block(), self.prepared::<I::X8>());
            let Self { kernel, mesh, ray } = self;
            let hit = kernel.intersect(&prepared, &block.triangles);
            let scene = Scene::new(mesh.bounds());
            let slabs = WideSlabRay::new::<I::X8>(&ray, &scene);
            let met = Blocks::met_by::<K, I>(block, &slabs, f32::INFINITY, &scene);
            (hit.map_or(0, |hit| hit.mask.bits()), met)
        }
    }

    /// Six small triangles far from zero, so that the edges that a kernel keeps are rounded, and a ray from nearby along the
    /// rim of one: no triangle that is hit is left out, none is met twice, and most of the others are not met.
    struct NoHitIsLeftOut;

    impl KernelUser for NoHitIsLeftOut {
        type Out = ();

        fn with<K: Kernel>(self, kernel: K) {
            let mut dice = Dice::new(3);
            let (mut hits, mut met, mut asked) = (0, 0, 0);
            for _ in 0..2_000 {
                let at = 1e4 * dice.vector();
                let corner = |dice: &mut Dice| at + 8.0 * dice.vector();
                let triangles: Vec<[Vec3; 3]> = (0..6)
                    .map(|_| {
                        let first = corner(&mut dice);
                        [first, first + dice.vector(), first + dice.vector()]
                    })
                    .collect();
                let mesh = mesh(&triangles);
                let [a, b, _] = triangles[dice.below(6) as usize];
                let rim = a.lerp(b, [0.0, 0.5, 1.0][dice.below(3) as usize]);
                let from = rim + 0.25 * dice.vector();
                let ray = Ray::new(from, rim - from);
                if !ray.is_valid() {
                    continue;
                }
                for set in InstructionSet::ALL.into_iter().filter(|s| s.is_available()) {
                    let mesh = &mesh;
                    let (of_kernel, of_boxes) = set.run(Asked {
                        kernel: &kernel,
                        mesh,
                        ray,
                    });
                    let ahead = of_kernel & 0b11_1111;
                    let ahead = ahead & in_front(mesh, &ray);
                    assert_eq!(ahead & !of_boxes, 0, "{set}: {ray:?}, {triangles:?}");
                    assert_eq!(of_boxes & !0b11_1111, 0, "{set}: a lane that is left over");
                    hits += ahead.count_ones();
                    met += of_boxes.count_ones();
                    asked += 6;
                }
            }
            assert!(
                hits > 1000 && 4 * met < asked,
                "{hits} hits, {met} met of {asked}"
            );
        }
    }

    /// That what is hit within an interval is what is hit and lies within it, ends included, in every lane of every set.
    struct WithinIsHitAndWithin;

    /// A ray and a block of triangles: asks where it is hit within intervals, and gives in how many lanes it is hit at all.
    struct Within<'a, K: Kernel>(Asked<'a, K>);

    impl<K: Kernel> Task for Within<'_, K> {
        type Out = u32;

        fn run<I: Isa>(self) -> u32 {
            let (block, prepared) = (&self.0.block().triangles, self.0.prepared::<I::X8>());
            let Asked { kernel, ray, .. } = self.0;
            let found = kernel.intersect(&prepared, block);
            let within = |interval: [f32; 2]| {
                let of_both = interval.map(I::X8::splat);
                let expected = found.map_or(0, |hit| hit.within(of_both[0], of_both[1]).bits());
                let hit = kernel.intersect_within(&prepared, block, of_both);
                assert_eq!(hit.map_or(0, |hit| hit.mask.bits()), expected, "{ray:?}");
                expected
            };
            within([f32::NEG_INFINITY, f32::INFINITY]);
            let Some(hit) = found else {
                return 0;
            };
            for lane in Ones(hit.mask.bits()) {
                let t = hit.t.get(lane);
                assert_eq!(within([t, t]) >> lane & 1, 1, "{ray:?} at {t}");
                for beside in [
                    [t.next_up(), f32::INFINITY],
                    [f32::NEG_INFINITY, t.next_down()],
                ] {
                    assert_eq!(within(beside) >> lane & 1, 0, "{ray:?} at {t}");
                }
            }
            hit.mask.bits().count_ones()
        }
    }

    impl KernelUser for WithinIsHitAndWithin {
        type Out = u32;

        fn with<K: Kernel>(self, kernel: K) -> u32 {
            let mut dice = Dice::new(5);
            let mut hits = 0;
            for _ in 0..300 {
                let triangles: Vec<[Vec3; 3]> = (0..6)
                    .map(|_| [dice.vector(), dice.vector(), dice.vector()])
                    .collect();
                let mesh = mesh(&triangles);
                let ray = Ray::new(dice.vector(), dice.vector());
                let kernel = &kernel;
                for set in InstructionSet::ALL.into_iter().filter(|s| s.is_available()) {
                    let mesh = &mesh;
                    hits += set.run(Within(Asked { kernel, mesh, ray }));
                }
            }
            hits
        }
    }

    #[test]
    fn every_kernel_hits_within_an_interval_what_it_hits_and_lies_there() {
        for entry in kernel::KERNELS {
            let kernel = kernel::parse(entry.name).expect("a kernel");
            let hits = kernel::dispatch(&kernel, WithinIsHitAndWithin).expect("a kernel");
            assert!(hits > 100, "{}: {hits}", entry.name);
        }
    }

    /// The triangles of a mesh that have no corner behind a ray's origin, a bit each.
    fn in_front(mesh: &Mesh, ray: &Ray) -> u32 {
        let ahead = |corner: &Vec3| (*corner - ray.origin).dot(ray.dir) > 0.0;
        let all = |prim: u32| mesh.corners(prim).iter().all(ahead);
        (0..mesh.len() as u32).fold(0, |bits, prim| bits | u32::from(all(prim)) << prim)
    }

    #[test]
    fn boxes_of_a_blocks_triangles_leave_out_no_hit() {
        for name in ["moller-trumbore", "woop"] {
            let kernel = kernel::parse(name).expect("a kernel");
            kernel::dispatch(&kernel, NoHitIsLeftOut).expect("a kernel");
        }
    }
}
