//! A scene of Embree's: built once, then traced by any number of threads.

use std::ffi::{CString, c_int, c_void};
use std::ptr::{self, NonNull};
use std::sync::atomic::{AtomicI64, Ordering};

use crate::scene::Mesh;

use super::library::{
    Arguments4, Context3, Embree, HIGH, Handle, INDICES, MEDIUM, Packet, Queries, ROBUST, RayHit,
    TRIANGLES, VERTICES, Valid, library,
};

/// What a scene is built for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settings {
    /// Threads that build.
    pub threads: usize,
    /// Whether tests of boxes and triangles are the robust ones.
    pub robust: bool,
    /// Whether the build takes longer for a faster tree, with spatial splits.
    pub high_quality: bool,
    /// Whether packets are promised to be coherent.
    pub coherent: bool,
}

/// A committed scene with its device.
#[derive(Debug)]
pub(super) struct Scene {
    embree: &'static Embree,
    device: NonNull<c_void>,
    handle: NonNull<c_void>,
    coherent: bool,
    /// Bytes that the device holds; the device's callback points here, so it is boxed and outlives the device.
    held: Box<AtomicI64>,
    /// Bytes of the vertices and indices that the scene was given.
    given: i64,
}

// SAFETY: a device's objects may be used from any thread, and a scene that is committed and never changed again may be
// traced by many at once; both are the library's documented contract, and nothing here changes a built scene.
unsafe impl Send for Scene {}
// SAFETY: see above.
unsafe impl Sync for Scene {}

/// Adds up what the device allocates and frees.
unsafe extern "C" fn note_memory(held: *mut c_void, bytes: isize, _after: bool) -> bool {
    // SAFETY: `held` is the address of `Scene::held`, which lives until after the device is released.
    let held = unsafe { &*held.cast::<AtomicI64>() };
    held.fetch_add(bytes as i64, Ordering::Relaxed);
    true
}

impl Scene {
    /// Builds a scene of one geometry, the triangles of `mesh` in their order.
    ///
    /// # Errors
    /// One sentence: the library is missing, or it refuses.
    pub fn build(mesh: &Mesh, settings: Settings) -> Result<Self, String> {
        let embree = library()?;
        let config = CString::new(format!("threads={}", settings.threads)).unwrap_or_default();
        // SAFETY: `config` is a string that ends with 0.
        let device = unsafe { (embree.new_device)(config.as_ptr()) };
        let device = NonNull::new(device).ok_or("embree gives no device; its library is broken")?;
        let held = Box::new(AtomicI64::new(0));
        let monitored = ptr::from_ref(&*held).cast_mut().cast();
        // SAFETY: `device` is a device; `held` outlives it, see `Drop`.
        let scene = unsafe {
            (embree.set_memory_monitor)(device.as_ptr(), note_memory, monitored);
            (embree.new_scene)(device.as_ptr())
        };
        let Some(scene) = NonNull::new(scene) else {
            // SAFETY: `device` is a device that nothing else refers to.
            unsafe { (embree.release_device)(device.as_ptr()) };
            return Err("embree gives no scene; its library is broken".to_owned());
        };
        let mut built = Self {
            embree,
            device,
            handle: scene,
            coherent: settings.coherent,
            held,
            given: 0,
        };
        built.fill(mesh, settings)?;
        Ok(built)
    }

    /// Gives the scene its triangles and commits it.
    fn fill(&mut self, mesh: &Mesh, settings: Settings) -> Result<(), String> {
        let embree = self.embree;
        let (device, scene) = (self.device.as_ptr(), self.handle.as_ptr());
        let flags = if settings.robust { ROBUST } else { 0 };
        let quality = if settings.high_quality { HIGH } else { MEDIUM };
        // SAFETY: `scene` is a scene, the values are among those that the library documents.
        unsafe {
            (embree.set_scene_flags)(scene, flags);
            (embree.set_scene_quality)(scene, quality);
        }
        if !mesh.is_empty() {
            // SAFETY: `device` is a device.
            let geometry = unsafe { (embree.new_geometry)(device, TRIANGLES) };
            let copied = self.copy(geometry, VERTICES, mesh.vertices())
                && self.copy(geometry, INDICES, mesh.triangles());
            self.given = self.held.load(Ordering::Relaxed);
            if copied {
                // SAFETY: the geometry has both of its buffers, filled; the scene keeps it after this reference to it.
                unsafe {
                    (embree.commit_geometry)(geometry);
                    (embree.attach_geometry)(scene, geometry);
                }
            }
            // SAFETY: `geometry` was made above; null is let pass by the library as an error of its own.
            unsafe { (embree.release_geometry)(geometry) };
        }
        // SAFETY: `scene` is a scene that no other thread knows yet.
        unsafe { (embree.commit_scene)(scene) };
        // SAFETY: `device` is a device.
        match unsafe { (embree.device_error)(device) } {
            0 => Ok(()),
            4 => Err("embree ran out of memory; choose a smaller scene".to_owned()),
            code => Err(format!("embree refused the scene with its error {code}")),
        }
    }

    /// Copies `items` into a new buffer of `geometry`; whether there was one.
    fn copy<T: Copy>(&self, geometry: Handle, (kind, format): (c_int, c_int), items: &[T]) -> bool {
        // SAFETY: kind and format belong together and fit `T`: three numbers of 4 bytes. The library pads its own
        // buffers as it needs.
        let buffer = unsafe {
            (self.embree.new_buffer)(geometry, kind, 0, format, size_of::<T>(), items.len())
        };
        if buffer.is_null() {
            return false;
        }
        // SAFETY: the buffer was made for `items.len()` items of this size, and nothing else refers to it yet.
        unsafe { ptr::copy_nonoverlapping(items.as_ptr(), buffer.cast::<T>(), items.len()) };
        true
    }

    /// Bytes that the build has left behind, without the vertices and indices that it was given.
    pub fn bytes(&self) -> u64 {
        (self.held.load(Ordering::Relaxed) - self.given).max(0) as u64
    }

    /// How version 3 is told what to expect.
    fn context(&self) -> Context3 {
        Context3 {
            flags: c_int::from(self.coherent),
            filter: ptr::null(),
            instance: [super::library::INVALID; 8],
        }
    }

    /// How version 4 is told what to expect.
    fn arguments(&self) -> Arguments4 {
        Arguments4 {
            flags: c_int::from(self.coherent) << 16,
            features: u32::MAX,
            context: ptr::null(),
            filter: ptr::null(),
            callback: ptr::null(),
            more: [0; 2],
        }
    }

    /// Traces one ray after another: `next` gives a ray to fill in, `done` takes what became of it.
    #[inline(always)]
    pub fn single<const OCCLUSION: bool>(
        &self,
        count: usize,
        mut next: impl FnMut(usize) -> RayHit,
        mut done: impl FnMut(usize, &RayHit),
    ) {
        let scene = self.handle.as_ptr();
        // SAFETY (all calls below): the scene is committed; the ray, aligned and as long as the library's, is ours, and
        // so is what tells the query how to run.
        match self.embree.queries {
            Queries::V3(queries) => {
                let query = if OCCLUSION {
                    queries.occluded
                } else {
                    queries.intersect
                };
                let mut context = self.context();
                for i in 0..count {
                    let mut ray = next(i);
                    // SAFETY: see above.
                    unsafe { query(scene, &raw mut context, &raw mut ray) };
                    done(i, &ray);
                }
            }
            Queries::V4(queries) => {
                let query = if OCCLUSION {
                    queries.occluded
                } else {
                    queries.intersect
                };
                let mut arguments = self.arguments();
                for i in 0..count {
                    let mut ray = next(i);
                    // SAFETY: see above.
                    unsafe { query(scene, &raw mut ray, &raw mut arguments) };
                    done(i, &ray);
                }
            }
        }
    }

    /// Traces a packet of the rays that `valid` names.
    #[inline(always)]
    pub fn packet<const OCCLUSION: bool>(&self, valid: &Valid, rays: &mut Packet) {
        let scene = self.handle.as_ptr();
        match self.embree.queries {
            Queries::V3(queries) => {
                let query = if OCCLUSION {
                    queries.occluded_packet
                } else {
                    queries.intersect_packet
                };
                let mut context = self.context();
                // SAFETY: the scene is committed; mask, rays and context are aligned, as long as the library's, and ours.
                unsafe { query(valid, scene, &raw mut context, rays) };
            }
            Queries::V4(queries) => {
                let query = if OCCLUSION {
                    queries.occluded_packet
                } else {
                    queries.intersect_packet
                };
                let mut arguments = self.arguments();
                // SAFETY: as above.
                unsafe { query(valid, scene, rays, &raw mut arguments) };
            }
        }
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: both were made in `build`, are released once, and are not used again; `held` still lives.
        unsafe {
            (self.embree.release_scene)(self.handle.as_ptr());
            (self.embree.release_device)(self.device.as_ptr());
        }
    }
}
