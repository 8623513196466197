//! Every accelerator on every class of rays, over a bundled scene and a procedural one, by the lab's own measuring.
//!
//! ```text
//! cargo bench --bench accelerators -- [--quick] [--scene SCENE]… [--rays-count N] [--n LIST] [--out DIR] [ACCEL…]
//! ```
//!
//! ACCEL is written as on the command line, e.g. `grid:overlap=sat`; without any, all but brute force and exhibits, and
//! of the peers those that are here. Samples of all of them on the same rays are interleaved; one thread, kernel `woop`.
//! A table a scene goes to standard output: Mrays/s by class of rays, build time, memory, and how many of the checked
//! answers were wrong.

mod measure;

use std::process::ExitCode;

use raylab::accel::{self, ACCELERATORS, AcceleratorEntry};
use raylab::kernel;
use raylab::lab::{self, Plan};
use raylab::report;

use measure::Options;

/// A picture of 591 × 443: large enough for packets to be formed as in a picture.
const RAYS: usize = 1 << 18;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("accelerators bench: {why}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), String> {
    let options = Options::read(RAYS)?;
    let report = measure::measure(&[plan(&options)?])?;
    print!("{}", report::structures_page(&report));
    measure::keep(&report, "md", options.out.as_deref())
}

fn plan(options: &Options) -> Result<Plan, String> {
    let names = match options.names.as_slice() {
        [] => all(),
        names => names.to_vec(),
    };
    let scenes = match options.scenes.as_slice() {
        [] => ["caballito", "soup:100000"].map(str::to_owned).to_vec(),
        scenes => scenes.to_vec(),
    };
    let accels: Result<_, _> = names.iter().map(|name| accel::parse(name)).collect();
    Ok(Plan {
        scenes,
        accels: accels.map_err(|e| e.to_string())?,
        n: lab::parse_n_list(&options.n).map_err(|e| e.to_string())?,
        kernels: vec![kernel::parse("woop").map_err(|e| e.to_string())?],
        rays: ["primary", "shadow", "bounce", "random"]
            .map(str::to_owned)
            .to_vec(),
        threads: vec![1],
        ray_count: options.ray_count,
        budget: options.budget,
        // All structures must stand in memory together to be sampled in turn.
        memory_limit: 16 << 30,
        ..Plan::default()
    })
}

/// All that are sound, and fast enough to wait for.
fn all() -> Vec<String> {
    let wanted = |a: &&AcceleratorEntry| a.name != "brute" && !a.control && a.standing().available;
    let wanted = ACCELERATORS.iter().filter(wanted);
    wanted.map(|a| a.name.to_owned()).collect()
}
