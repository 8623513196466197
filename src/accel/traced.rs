//! A structure bound to a kernel: the one place where traversals meet kernels, queries and counters.

use std::sync::Arc;

use crate::geometry::{Hit, Ray};
use crate::kernel::{self, Kernel, KernelUser};
use crate::scene::Mesh;

use super::record::Recorder;
use super::visit::{Counted, Counter, PackedMesh, Query, Uncounted};
use super::{Accelerator, BuildError, BuildRequest, Counts, Recording, Structure, StructureStats};

/// Binds `structure` to the kernel that `request` names.
///
/// # Errors
/// The kernel is not known.
pub fn finish<S: Structure>(
    structure: S,
    request: &BuildRequest,
) -> Result<Box<dyn Accelerator>, BuildError> {
    struct Bind<S> {
        structure: S,
        mesh: Arc<Mesh>,
    }
    impl<S: Structure> KernelUser for Bind<S> {
        type Out = Box<dyn Accelerator>;
        fn with<K: Kernel>(self, kernel: K) -> Self::Out {
            let triangles = (0..self.mesh.len() as u32)
                .map(|prim| kernel.pack(|_| self.mesh.corners(prim)))
                .collect();
            Box::new(Traced {
                structure: self.structure,
                kernel,
                triangles,
                mesh: self.mesh,
            })
        }
    }
    let bind = Bind {
        structure,
        mesh: Arc::clone(request.mesh),
    };
    Ok(kernel::dispatch(request.kernel, bind)?)
}

struct Traced<S, K: Kernel> {
    structure: S,
    kernel: K,
    triangles: Vec<K::Packed<1>>,
    mesh: Arc<Mesh>,
}

impl<S: Structure, K: Kernel> Traced<S, K> {
    /// Traces one ray after another and hands each best hit to `done` with the ray's index and the counter.
    #[inline(always)]
    fn each<C: Counter, const OCCLUSION: bool>(
        &self,
        rays: &[Ray],
        mut counter: C,
        mut done: impl FnMut(usize, Hit, &C),
    ) {
        let mut scratch = self.structure.scratch();
        for (i, ray) in rays.iter().enumerate() {
            let packed = PackedMesh {
                kernel: &self.kernel,
                mesh: &self.mesh,
                triangles: &self.triangles,
            };
            let mut query = Query::<K, C, OCCLUSION>::new(packed, ray, &mut counter);
            self.structure.traverse(ray, &mut scratch, &mut query);
            let best = query.best;
            done(i, best, &counter);
        }
    }

    fn counted(&self) -> Counted {
        Counted::new(self.triangles.len())
    }
}

impl<S: Structure, K: Kernel> Accelerator for Traced<S, K> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.each::<_, false>(rays, Uncounted, |i, hit, _| hits[i] = hit);
    }

    fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        self.each::<_, true>(rays, Uncounted, |i, hit, _| blocked[i] = hit.is_hit());
    }

    fn closest_counted(&self, rays: &[Ray], hits: &mut [Hit], counts: &mut [Counts]) {
        self.each::<_, false>(rays, self.counted(), |i, hit, counter| {
            hits[i] = hit;
            counts[i] = counter.counts;
        });
    }

    fn occluded_counted(&self, rays: &[Ray], blocked: &mut [bool], counts: &mut [Counts]) {
        self.each::<_, true>(rays, self.counted(), |i, hit, counter| {
            blocked[i] = hit.is_hit();
            counts[i] = counter.counts;
        });
    }

    fn inspect(&self, ray: &Ray) -> Recording {
        let mut recording = Recording {
            visits: Vec::new(),
            hit: Hit::MISS,
        };
        let recorder = Recorder::new(S::LEAF);
        self.each::<_, false>(std::slice::from_ref(ray), recorder, |_, hit, recorder| {
            recording.hit = hit;
            recording.visits.clone_from(&recorder.visits);
        });
        for visit in &mut recording.visits {
            visit.bounds = self.structure.place_bounds(visit.place);
        }
        recording
    }

    fn stats(&self) -> StructureStats {
        self.structure.stats()
    }

    fn memory_bytes(&self) -> u64 {
        self.structure.memory_bytes() + size_of_val(self.triangles.as_slice()) as u64
    }

    fn validate(&self) -> Result<(), String> {
        self.structure.validate(&self.mesh)
    }
}
