//! A peer's tree whose triangles are tested by the kernel of the run.
//!
//! ```text
//! tree (the peer's)  -- place -->  triangles[place], packed in the tree's own order  -- kernel -->  nearest hit
//!        ^                                                                                   |
//!        '---------------------------- t beyond which nothing matters ----------------------'
//! ```

use std::ops::ControlFlow;
use std::slice::from_ref;
use std::sync::Arc;

use crate::accel::{Accelerator, BuildError, BuildRequest, Counts, Recording, StructureStats};
use crate::geometry::lanes::LaneRay;
use crate::geometry::{Hit, Ray};
use crate::kernel::{self, Kernel, KernelUser, LaneHit};
use crate::scene::Mesh;

/// What a test answers: go on to what begins at or before this `t`, or stop.
pub(super) type Next = ControlFlow<(), f32>;

/// A tree of another library. It offers triangles by their place in an order of its own.
pub(super) trait Tree: Send + Sync + 'static {
    /// Offers the places whose boxes `ray` meets, near ones first where the library can tell.
    fn traverse(&self, ray: &Ray, test: impl FnMut(usize) -> Next);

    /// The triangles by place; one may have several.
    fn places(&self) -> Vec<u32>;

    /// Sizes and shape, as far as the library tells.
    fn stats(&self) -> StructureStats;

    /// Bytes of the tree, without triangles.
    fn memory_bytes(&self) -> u64;
}

/// Binds `tree` to the kernel that `request` names.
pub(super) fn finish<T: Tree>(
    tree: T,
    request: &BuildRequest,
) -> Result<Box<dyn Accelerator>, BuildError> {
    struct Bind<T> {
        tree: T,
        mesh: Arc<Mesh>,
    }
    impl<T: Tree> KernelUser for Bind<T> {
        type Out = Box<dyn Accelerator>;
        fn with<K: Kernel>(self, kernel: K) -> Self::Out {
            let prims = self.tree.places();
            let triangles = prims
                .iter()
                .map(|&prim| kernel.pack(|_| self.mesh.corners(prim)))
                .collect();
            Box::new(Tested {
                tree: self.tree,
                kernel,
                triangles,
                prims,
                mesh: self.mesh,
            })
        }
    }
    let mesh = Arc::clone(request.mesh);
    Ok(kernel::dispatch(request.kernel, Bind { tree, mesh })?)
}

struct Tested<T, K: Kernel> {
    tree: T,
    kernel: K,
    /// By place.
    triangles: Vec<K::Packed<1>>,
    /// Indices in file order, by place.
    prims: Vec<u32>,
    mesh: Arc<Mesh>,
}

impl<T: Tree, K: Kernel> Tested<T, K> {
    /// The nearest hit, or `any`. Which of the two is asked only where a triangle is hit, so one traversal is compiled for both.
    #[inline(never)]
    fn trace(&self, ray: &Ray, any: bool) -> Hit {
        let (kernel, mesh) = (&self.kernel, &*self.mesh);
        let prepared = kernel.prepare::<1, f32>(ray, &LaneRay::splat(ray));
        let mut best = Hit::MISS;
        let mut limit = ray.t_max;
        self.tree.traverse(ray, |place| {
            let Some(found) = kernel.intersect(&prepared, &self.triangles[place]) else {
                return Next::Continue(limit);
            };
            let LaneHit { t, u, v, .. } = found;
            let prim = self.prims[place];
            let hit = Hit { t, u, v, prim };
            if kernel.within(mesh, ray, &hit) && kernel.nearer(mesh, ray, &hit, &best) {
                best = hit;
                if any {
                    return Next::Break(());
                }
                // As with raylab's own: a nearer triangle behind an error of the kernel's is not lost.
                limit = limit.min(t + kernel.t_error(ray, &mesh.corners(prim), t));
            }
            Next::Continue(limit)
        });
        best
    }
}

impl<T: Tree, K: Kernel> Accelerator for Tested<T, K> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.trace(ray, false);
        }
    }

    fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        for (ray, blocked) in rays.iter().zip(blocked) {
            *blocked = self.trace(ray, true).is_hit();
        }
    }

    fn closest_counted(&self, rays: &[Ray], hits: &mut [Hit], _: &mut [Counts]) {
        self.closest(rays, hits);
    }

    fn occluded_counted(&self, rays: &[Ray], blocked: &mut [bool], _: &mut [Counts]) {
        self.occluded(rays, blocked);
    }

    fn inspect(&self, ray: &Ray) -> Recording {
        let mut hit = [Hit::MISS];
        self.closest(from_ref(ray), &mut hit);
        Recording {
            visits: Vec::new(),
            hit: hit[0],
        }
    }

    fn stats(&self) -> StructureStats {
        self.tree.stats()
    }

    fn memory_bytes(&self) -> u64 {
        let triangles = size_of_val(self.triangles.as_slice());
        self.tree.memory_bytes() + (triangles + size_of_val(self.prims.as_slice())) as u64
    }

    fn validate(&self) -> Result<(), String> {
        all_referenced(&self.prims, self.mesh.len())
    }
}

/// Checks that `prims` are triangles of a mesh of so many, and that none is left out.
fn all_referenced(prims: &[u32], triangles: usize) -> Result<(), String> {
    let mut referenced = vec![false; triangles];
    for &prim in prims {
        if let Some(seen) = referenced.get_mut(prim as usize) {
            *seen = true;
        } else {
            return Err(format!("triangle {prim} is not in the mesh"));
        }
    }
    match referenced.iter().position(|seen| !seen) {
        Some(prim) => Err(format!("triangle {prim} is in no leaf")),
        None => Ok(()),
    }
}
