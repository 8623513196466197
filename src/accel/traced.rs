//! A structure bound to a kernel: the one place where traversals meet kernels, queries and counters.

use std::sync::Arc;

use crate::geometry::lanes::{InstructionSet, Isa, Portable, Task};
use crate::geometry::{Hit, Ray};
use crate::kernel::{self, Kernel, KernelUser};
use crate::scene::Mesh;

use super::batch::{Answer, Batch};
use super::behind;
use super::items::{Items, Singles};
use super::query::{Packed, Query};
use super::record::Recorder;
use super::visit::{Counted, Watch};
use super::{Accelerator, BuildError, BuildRequest, Counts, Recording, Structure, StructureStats};

/// Binds `structure`, which lists triangles, to the kernel that `request` names.
///
/// # Errors
/// The kernel is not known.
pub fn finish<S: Structure<Items = Singles>>(
    structure: S,
    request: &BuildRequest,
) -> Result<Box<dyn Accelerator>, BuildError> {
    let slots: Vec<u32> = (0..request.mesh.len() as u32).collect();
    finish_in_order(structure, &slots, request)
}

/// Binds `structure`, whose items hold the triangles with the indices `slots`, to the kernel that `request` names.
///
/// # Errors
/// The kernel is not known.
pub(super) fn finish_in_order<S: Structure>(
    structure: S,
    slots: &[u32],
    request: &BuildRequest,
) -> Result<Box<dyn Accelerator>, BuildError> {
    struct Bind<'a, S> {
        structure: S,
        slots: &'a [u32],
        mesh: Arc<Mesh>,
        set: InstructionSet,
    }
    impl<S: Structure> KernelUser for Bind<'_, S> {
        type Out = Box<dyn Accelerator>;
        fn with<K: Kernel>(self, kernel: K) -> Self::Out {
            Box::new(Traced {
                structure: self.structure,
                packed: Packed {
                    items: S::Items::pack(&kernel, &self.mesh, self.slots),
                    kernel,
                    mesh: self.mesh,
                },
                set: self.set,
            })
        }
    }
    let bind = Bind {
        structure,
        slots,
        mesh: Arc::clone(request.mesh),
        set: request.set,
    };
    Ok(kernel::dispatch(request.kernel, bind)?)
}

struct Traced<S: Structure, K: Kernel> {
    structure: S,
    packed: Packed<S::Items, K>,
    set: InstructionSet,
}

/// A batch that is traced by the instruction set's own function.
struct Trace<'a, S: Structure, K: Kernel, A, const OCCLUSION: bool> {
    traced: &'a Traced<S, K>,
    rays: &'a [Ray],
    answers: &'a mut [A],
}

impl<S: Structure, K: Kernel, A: Answer, const OCCLUSION: bool> Task
    for Trace<'_, S, K, A, OCCLUSION>
{
    type Out = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let structure = &self.traced.structure;
        let mut scratch = structure.scratch();
        let mut batch: Batch<S::Items, K, I, A, OCCLUSION> =
            Batch::new(&self.traced.packed, self.rays, self.answers);
        structure.trace(&mut batch, &mut scratch);
    }
}

impl<S: Structure, K: Kernel> Traced<S, K> {
    fn trace<A: Answer, const OCCLUSION: bool>(&self, rays: &[Ray], answers: &mut [A]) {
        let task: Trace<S, K, A, OCCLUSION> = Trace {
            traced: self,
            rays,
            answers,
        };
        S::Items::run(self.set, task);
    }

    /// Traces one ray, watched.
    fn watched<const OCCLUSION: bool>(
        &self,
        ray: &Ray,
        scratch: &mut S::Scratch,
        watch: &mut dyn Watch,
    ) -> Hit {
        let mut query: Query<S::Items, K, Portable, &mut dyn Watch, OCCLUSION> =
            Query::new(&self.packed, ray, watch);
        behind::lead(&self.structure, ray, scratch, &mut query);
        query.best
    }

    /// Traces one ray after another, counting the work of each.
    fn counted<A: Answer, const OCCLUSION: bool>(
        &self,
        rays: &[Ray],
        answers: &mut [A],
        counts: &mut [Counts],
    ) {
        let counter = Counted::new(self.packed.mesh.len());
        let mut watched = |ray: &Ray, scratch: &mut S::Scratch, watch: &mut dyn Watch| {
            self.watched::<OCCLUSION>(ray, scratch, watch)
        };
        count(
            &self.structure,
            (rays, answers, counts),
            counter,
            &mut watched,
        );
    }
}

/// Traces a ray, watched.
type Watched<'a, S> = dyn FnMut(&Ray, &mut <S as Structure>::Scratch, &mut dyn Watch) -> Hit + 'a;

/// See [`Traced::counted`]. As the next two, compiled once a structure, whatever the kernel.
#[inline(never)]
fn count<S: Structure, A: Answer>(
    structure: &S,
    (rays, answers, counts): (&[Ray], &mut [A], &mut [Counts]),
    mut counter: Counted,
    watched: &mut Watched<S>,
) {
    let mut scratch = structure.scratch();
    for ((ray, answer), count) in rays.iter().zip(answers).zip(counts) {
        counter.begin();
        *answer = A::of(watched(ray, &mut scratch, &mut counter));
        *count = counter.counts;
    }
}

/// See [`Accelerator::inspect`].
#[inline(never)]
fn record<S: Structure>(structure: &S, ray: &Ray, watched: &mut Watched<S>) -> Recording {
    let mut recorder = Recorder::new(structure.leaf());
    let hit = watched(ray, &mut structure.scratch(), &mut recorder);
    let mut visits = recorder.visits;
    for visit in &mut visits {
        visit.bounds = structure.place_bounds(visit.place);
    }
    Recording { visits, hit }
}

/// See [`Accelerator::stats`].
#[inline(never)]
fn stats_of<S: Structure>(structure: &S) -> StructureStats {
    structure.stats()
}

impl<S: Structure, K: Kernel> Accelerator for Traced<S, K> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.trace::<_, false>(rays, hits);
    }

    fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        self.trace::<_, true>(rays, blocked);
    }

    fn closest_counted(&self, rays: &[Ray], hits: &mut [Hit], counts: &mut [Counts]) {
        self.counted::<_, false>(rays, hits, counts);
    }

    fn occluded_counted(&self, rays: &[Ray], blocked: &mut [bool], counts: &mut [Counts]) {
        self.counted::<_, true>(rays, blocked, counts);
    }

    fn inspect(&self, ray: &Ray) -> Recording {
        let mut watched = |ray: &Ray, scratch: &mut S::Scratch, watch: &mut dyn Watch| {
            self.watched::<false>(ray, scratch, watch)
        };
        record(&self.structure, ray, &mut watched)
    }

    fn instruction_set(&self) -> InstructionSet {
        S::Items::instruction_set(self.set)
    }

    fn stats(&self) -> StructureStats {
        stats_of(&self.structure)
    }

    fn memory_bytes(&self) -> u64 {
        self.structure.memory_bytes() + size_of_val(self.packed.items.as_slice()) as u64
    }

    fn validate(&self) -> Result<(), String> {
        let lanes = S::Items::lanes(&self.packed.items);
        self.structure.validate(&self.packed.mesh, &lanes)
    }
}
