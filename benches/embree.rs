//! raylab beside Embree: measures raylab's accelerators and their peers on the same rays, and prints ratios goal by goal.
//!
//! ```text
//! cargo bench --bench embree -- [--quick] [--rays-count N] [--n LIST] [--out DIR] [SCENE…]
//! ```
//!
//! SCENE is what the program takes: a path to an .obj, a bundled name, a family with its size. Without any, `plant`,
//! `sphereflake:4` and `city:300`. Embree must be installed. All structures trace the same rays, whole sets however slow one
//! is, and their samples are interleaved, one thread, default builds; so are those of `bvh-wide` with both kernels, and those
//! of one and two threads, which also time builds. A set has half a million rays, unless `--rays-count` says otherwise; grids
//! are at `--n auto`, or at each n of LIST. The page goes to standard output; with `--out` it is kept as `peers.md`, with all
//! samples in `report.json` beside it.
//!
//! A scene has 120 runs: `--quick` takes two minutes for `plant` on one core and a few more for a million triangles, most of
//! them builds; without it each run is sampled for two to eight seconds longer, a scene for 5 to 15 minutes in all, the three
//! for half an hour or more.
//!
//! What is measured and how is the lab's: this only chooses what to measure, and [`raylab::report`] makes the page.

mod measure;

use std::process::ExitCode;

use raylab::accel;
use raylab::kernel;
use raylab::lab::{self, Budget, Plan};
use raylab::registry::Choice;
use raylab::report;

use measure::Options;

/// A picture of 836 × 627. Packets are rays of neighbouring pixels: the fewer pixels a picture has, the wider its packets are
/// in the scene and the less they gain. `--rays-count` shows how much.
const RAYS: usize = 1 << 19;

/// One share of what is measured, in one sweep: all of it on the same rays of a scene is interleaved.
struct Share {
    accels: Vec<Choice>,
    kernels: &'static [&'static str],
    rays: &'static [&'static str],
    threads: &'static [usize],
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("embree bench: {why}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), String> {
    let options = Options::read(RAYS)?;
    let embree = accel::entry("embree").map_err(|e| e.to_string())?;
    if let Some(why) = embree.standing().unavailable_because {
        return Err(why);
    }
    let plans: Result<Vec<Plan>, String> = shares()?.iter().map(|s| plan(&options, s)).collect();
    let report = measure::measure(&plans?)?;
    print!("{}", report::peers_page(&report));
    measure::keep(&report, "peers", options.out.as_deref())
}

/// Everything that is measured. A watertight kernel stands beside Embree's robust test, the fast one beside its fast test;
/// the promise of coherence is tried where it can pay.
fn shares() -> Result<Vec<Share>, String> {
    const PAIRS: [(&[&str], &str); 2] = [(&["woop"], "on"), (&["moller-trumbore"], "off")];
    const SETS: [(&[&str], &[&str]); 2] = [
        (&["primary", "shadow"], &["single", "packet", "coherent"]),
        (&["bounce", "random"], &["single", "packet"]),
    ];
    let own = [
        "bvh",
        "bvh-wide",
        "grid",
        "grid-skip",
        "grid-2level",
        "kd-tree",
    ]
    .map(str::to_owned)
    .to_vec();
    let mut shares = Vec::new();
    for (kernels, robust) in PAIRS {
        for (rays, modes) in SETS {
            let mut accels = own.clone();
            for quality in ["medium", "high"] {
                accels.extend(
                    modes.iter().map(|mode| {
                        format!("embree:mode={mode}:quality={quality}:robust={robust}")
                    }),
                );
            }
            if kernels == ["woop"] {
                let others = [
                    "obvhs",
                    "obvhs:build=slow",
                    "obvhs:layout=cwbvh",
                    "bvh-crate",
                ];
                accels.extend(others.map(str::to_owned));
            }
            shares.push(share(&accels, kernels, rays, &[1])?);
        }
    }
    // Once more, beside what these ratios are of.
    let rays = &["primary", "bounce"];
    let wide = ["bvh-wide".to_owned()];
    shares.push(share(&wide, &["woop", "moller-trumbore"], rays, &[1])?);
    let two = ["bvh-wide", "embree", "embree:mode=packet"].map(str::to_owned);
    shares.push(share(&two, &["woop"], rays, &[1, 2])?);
    Ok(shares)
}

fn share(
    accels: &[String],
    kernels: &'static [&'static str],
    rays: &'static [&'static str],
    threads: &'static [usize],
) -> Result<Share, String> {
    let accels = accels
        .iter()
        .map(|name| accel::parse(name).map_err(|e| e.to_string()));
    Ok(Share {
        accels: accels.collect::<Result<_, _>>()?,
        kernels,
        rays,
        threads,
    })
}

fn plan(options: &Options, share: &Share) -> Result<Plan, String> {
    let mut scenes = [&options.names[..], &options.scenes[..]].concat();
    if scenes.is_empty() {
        scenes = ["plant", "sphereflake:4", "city:300"]
            .map(str::to_owned)
            .to_vec();
    }
    // Whether two threads get a core each changes within a second where cores are shared with others: longer than that.
    let longer = if share.threads.len() > 1 { 4 } else { 1 };
    let kernels = share.kernels.iter();
    let kernels = kernels.map(|name| kernel::parse(name).map_err(|e| e.to_string()));
    Ok(Plan {
        scenes,
        accels: share.accels.clone(),
        n: lab::parse_n_list(&options.n).map_err(|e| e.to_string())?,
        kernels: kernels.collect::<Result<_, _>>()?,
        rays: share.rays.iter().map(|&rays| rays.to_owned()).collect(),
        threads: share.threads.to_vec(),
        ray_count: options.ray_count,
        seed: 1,
        budget: Budget {
            // Whoever is slow, all get the same rays, and those of a picture stay neighbours.
            whole_sets: true,
            min_samples: longer * options.budget.min_samples,
            max_samples: longer * options.budget.max_samples,
            run_seconds: longer as f64 * options.budget.run_seconds,
            ..options.budget
        },
        // All structures on the same rays must stand in memory together to be sampled in turn.
        memory_limit: 16 << 30,
    })
}
