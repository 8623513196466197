//! `embree`: Intel's ray tracing kernels, loaded at run time where libembree4 or libembree3 is installed.
//!
//! ```text
//! single    rtcIntersect1 / rtcOccluded1, one ray after another
//! packet    rtcIntersect16 / rtcOccluded16, sixteen rays in the order in which they come
//! coherent  the same with the promise that the rays of a packet run alike
//! ```
//!
//! Its own ray/triangle test decides hits: a Plücker test where `robust=on`, Möller and Trumbore's where `robust=off`.
//!
//! **Source:** I. Wald et al., "Embree: A Kernel Framework for Efficient CPU Ray Tracing", SIGGRAPH 2014.
//! **Differs:** nothing is set that its users would not set: huge pages, instruction set and node layout are its own
//! choice, build threads are those of the pool that the build is called in. Its manual advises to let the processor
//! flush subnormal numbers to zero; that is not done, since results of raylab's own would change with it, and on
//! ordinary scenes it makes no difference that shows. Its intervals are open at `t_min`, where raylab's are closed.

use crate::accel::{
    Accelerator, AcceleratorEntry, BuildError, BuildRequest, Counts, Recording, StructureStats,
};
use crate::geometry::{Aabb, Hit, Ray};
use crate::registry::{ParamKind, ParamSpec};

use super::{Peer, forward};

#[expect(
    unsafe_code,
    reason = "a library that is loaded at run time is called through pointers"
)]
mod library;
#[expect(
    unsafe_code,
    reason = "a library that is loaded at run time is called through pointers"
)]
mod scene;

use library::{INVALID, Packet, RayHit, Valid, WIDTH};
use scene::{Scene, Settings};

pub(in crate::accel) const ENTRY: AcceleratorEntry = AcceleratorEntry {
    name: "embree",
    about: "A peer: Intel's Embree, version 4 or 3, where its library is installed.",
    paper: "Wald, Woop, Benthin, Johnson, Ernst 2014, Embree: A Kernel Framework for Efficient CPU Ray Tracing",
    params: &[
        ParamSpec {
            name: "mode",
            about: "Single rays, packets of 16, or packets that are promised to be coherent.",
            kind: ParamKind::Choice(&["single", "packet", "coherent"]),
            default: "single",
        },
        ParamSpec {
            name: "quality",
            about: "How long the build looks for a fast tree; `high` splits triangles.",
            kind: ParamKind::Choice(&["medium", "high"]),
            default: "medium",
        },
        ParamSpec {
            name: "robust",
            about: "Its watertight tests, or its fast ones.",
            kind: ParamKind::Choice(&["on", "off"]),
            default: "on",
        },
    ],
    control: false,
    resolution: None,
    peer: Some(Peer {
        unavailable: || library::library().err().map(str::to_owned),
        own_test: |params| {
            Some(match params.text("robust") {
                "off" => "embree-fast",
                _ => "embree-robust",
            })
        },
    }),
    build,
};

fn build(request: &BuildRequest) -> Result<Box<dyn Accelerator>, BuildError> {
    let mode = request.params.text("mode");
    let settings = Settings {
        threads: rayon::current_num_threads(),
        robust: request.params.text("robust") != "off",
        high_quality: request.params.text("quality") == "high",
        coherent: mode == "coherent",
    };
    let scene = Scene::build(request.mesh, settings).map_err(BuildError::Unavailable)?;
    Ok(Box::new(Traced {
        scene,
        packets: mode != "single",
        bounds: request.mesh.bounds(),
    }))
}

struct Traced {
    scene: Scene,
    packets: bool,
    bounds: Aabb,
}

impl Traced {
    /// Hands the answer to each ray to `done`, with the ray's index.
    #[inline(always)]
    fn each<const OCCLUSION: bool>(&self, rays: &[Ray], mut done: impl FnMut(usize, Hit)) {
        if self.packets {
            for (first, rays) in rays.chunks(WIDTH).enumerate() {
                self.packet::<OCCLUSION>(rays, |lane, hit| done(WIDTH * first + lane, hit));
            }
            return;
        }
        let next = |i: usize| {
            let (ray, _) = forward(&rays[i], &self.bounds);
            RayHit {
                origin: ray.origin.to_array(),
                t_near: ray.t_min,
                dir: ray.dir.to_array(),
                t_far: ray.t_max,
                mask: u32::MAX,
                geometry: INVALID,
                ..RayHit::default()
            }
        };
        self.scene
            .single::<OCCLUSION>(rays.len(), next, |i, found| {
                let hit = if OCCLUSION {
                    answer_of_occlusion(found.t_far)
                } else if found.geometry == INVALID {
                    Hit::MISS
                } else {
                    self.answer(&rays[i], [found.t_far, found.u, found.v], found.prim)
                };
                done(i, hit);
            });
    }

    /// As [`Traced::each`], of up to 16 rays at once.
    #[inline(always)]
    fn packet<const OCCLUSION: bool>(&self, rays: &[Ray], mut done: impl FnMut(usize, Hit)) {
        let mut packet = NO_RAYS;
        let mut valid = Valid([0; WIDTH]);
        for (lane, ray) in rays.iter().enumerate() {
            let (ray, _) = forward(ray, &self.bounds);
            for axis in 0..3 {
                packet.origin[axis][lane] = ray.origin[axis];
                packet.dir[axis][lane] = ray.dir[axis];
            }
            packet.t_near[lane] = ray.t_min;
            packet.t_far[lane] = ray.t_max;
            valid.0[lane] = -1;
        }
        self.scene.packet::<OCCLUSION>(&valid, &mut packet);
        for (lane, ray) in rays.iter().enumerate() {
            let hit = if OCCLUSION {
                answer_of_occlusion(packet.t_far[lane])
            } else if packet.geometry[lane] == INVALID {
                Hit::MISS
            } else {
                let found = [packet.t_far[lane], packet.u[lane], packet.v[lane]];
                self.answer(ray, found, packet.prim[lane])
            };
            done(lane, hit);
        }
    }

    /// What was found on `ray` moved forward, on the ray itself. A t that is no number is no hit.
    #[inline(always)]
    fn answer(&self, ray: &Ray, [t, u, v]: [f32; 3], prim: u32) -> Hit {
        let t = t + forward(ray, &self.bounds).1;
        if t.is_nan() {
            Hit::MISS
        } else {
            Hit { t, u, v, prim }
        }
    }
}

/// Sixteen rays that are not there.
const NO_RAYS: Packet = Packet {
    origin: [[0.0; WIDTH]; 3],
    t_near: [0.0; WIDTH],
    dir: [[0.0; WIDTH]; 3],
    time: [0.0; WIDTH],
    t_far: [0.0; WIDTH],
    mask: [u32::MAX; WIDTH],
    id: [0; WIDTH],
    flags: [0; WIDTH],
    normal: [[0.0; WIDTH]; 3],
    u: [0.0; WIDTH],
    v: [0.0; WIDTH],
    prim: [INVALID; WIDTH],
    geometry: [INVALID; WIDTH],
    instance: [[INVALID; WIDTH]; 2],
};

/// A hit of no matter what where the library says so: it sets the end of a blocked ray to minus infinity.
#[inline(always)]
fn answer_of_occlusion(t_far: f32) -> Hit {
    if t_far == f32::NEG_INFINITY {
        Hit {
            prim: 0,
            ..Hit::MISS
        }
    } else {
        Hit::MISS
    }
}

impl Accelerator for Traced {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.each::<false>(rays, |i, hit| hits[i] = hit);
    }

    fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        self.each::<true>(rays, |i, hit| blocked[i] = hit.is_hit());
    }

    fn closest_counted(&self, rays: &[Ray], hits: &mut [Hit], _: &mut [Counts]) {
        self.closest(rays, hits);
    }

    fn occluded_counted(&self, rays: &[Ray], blocked: &mut [bool], _: &mut [Counts]) {
        self.occluded(rays, blocked);
    }

    fn inspect(&self, ray: &Ray) -> Recording {
        let mut hit = [Hit::MISS];
        self.closest(std::slice::from_ref(ray), &mut hit);
        Recording {
            visits: Vec::new(),
            hit: hit[0],
        }
    }

    fn stats(&self) -> StructureStats {
        // The library tells nothing of its tree.
        StructureStats::default()
    }

    fn memory_bytes(&self) -> u64 {
        self.scene.bytes()
    }

    fn validate(&self) -> Result<(), String> {
        Ok(())
    }
}
