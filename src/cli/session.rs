//! What `render`, `inspect` and `trace` share: a scene, one configuration, the structure built for it, and threads.

use std::time::Instant;

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::accel::{self, Accelerator};
use crate::kernel;
use crate::lab::{self, NRule, Plan};
use crate::registry::Choice;
use crate::scene::{self, Camera, Scene};

use super::Failure;
use super::args::{CameraArgs, ConfigArgs};
use super::choices::thread_count;

/// Pixels of a picture when no size is given.
pub const PNG_SIZE: (u32, u32) = (960, 720);

/// One configuration as chosen on the command line.
pub struct Config {
    /// Accelerator with parameters.
    pub accel: Choice,
    /// Kernel with parameters.
    pub kernel: Choice,
    /// Resolution; `None` leaves it to the predictor.
    pub n: Option<u32>,
    /// Threads to trace with.
    pub threads: usize,
}

/// A structure and what it took to build.
pub struct Built {
    /// The structure.
    pub accel: Box<dyn Accelerator>,
    /// The resolution that was built; `None` for structures without one.
    pub n: Option<u32>,
    /// How long the build took.
    pub build_ms: f64,
}

impl Config {
    /// Reads and checks the choices.
    pub fn read(args: &ConfigArgs) -> Result<Self, Failure> {
        let rules = lab::parse_n_list(&args.n).map_err(|e| Failure::Usage(e.to_string()))?;
        let n = match rules.as_slice() {
            [NRule::Auto] => None,
            [NRule::Fixed(n)] => Some(*n),
            _ => {
                return Err(Failure::Usage(format!(
                    "--n {} is a list; give one number, or auto",
                    args.n
                )));
            }
        };
        Ok(Self {
            accel: accel::parse(args.accel.as_deref().unwrap_or(accel::DEFAULT))?,
            kernel: kernel::parse(&args.kernel)?,
            n,
            threads: thread_count(&args.threads)?,
        })
    }

    /// The name of the accelerator with the parameters that are not the defaults.
    pub fn accel_label(&self) -> String {
        let specs = accel::entry(&self.accel.name).map_or(&[][..], |e| e.params);
        self.accel.label(specs)
    }

    /// A pool of as many threads as were asked for.
    pub fn pool(&self) -> Result<ThreadPool, Failure> {
        ThreadPoolBuilder::new()
            .num_threads(self.threads)
            .build()
            .map_err(|e| Failure::Failed(format!("cannot start {} threads: {e}", self.threads)))
    }

    /// Builds the structure in the pool it is called in.
    pub fn build(&self, scene: &Scene) -> Result<Built, Failure> {
        let entry = accel::entry(&self.accel.name)?;
        let n = entry.resolution.map(|r| {
            self.n
                .unwrap_or_else(|| (r.auto)(&scene.mesh, &self.accel.params))
        });
        lab::warm_up();
        let start = Instant::now();
        let accel = accel::build(
            &scene.mesh,
            &self.accel,
            n,
            &self.kernel,
            Plan::default().memory_limit,
        )?;
        Ok(Built {
            accel,
            n,
            build_ms: start.elapsed().as_secs_f64() * 1e3,
        })
    }
}

impl CameraArgs {
    /// The scene's camera with what the command line changes.
    pub fn of(&self, scene: &Scene) -> Camera {
        Camera {
            eye: self.eye.unwrap_or(scene.camera.eye),
            at: self.at.unwrap_or(scene.camera.at),
            fov_deg: self.fov.unwrap_or(scene.camera.fov_deg),
            ..scene.camera
        }
    }
}

/// Loads a scene and says its warnings, unless `quiet`.
pub fn load(spec: &str, quiet: bool) -> Result<Scene, Failure> {
    let scene = scene::load(spec)?;
    if !quiet {
        for warning in &scene.warnings {
            eprintln!("raylab: {spec}: {warning}");
        }
    }
    Ok(scene)
}
