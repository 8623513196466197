//! raylab beside Embree: measures raylab's accelerators and their peers on the same rays, and prints ratios goal by goal.
//!
//! ```text
//! cargo bench --bench embree -- [--quick] [--rays-count N] [--n LIST] [--out DIR] [SCENE…]
//! ```
//!
//! SCENE is what the program takes: a path to an .obj, a bundled name, a family with its size. Without any, `plant`,
//! `sphereflake:4` and `city:300`. Embree must be installed. Samples of all structures on the same rays are interleaved,
//! one thread, default builds; a second, shorter run with two threads times builds and how speed grows. The page goes
//! to standard output; with `--out` it is kept as `peers.md`, with all samples in `report.json` beside it.
//!
//! What is measured and how is the lab's: this only chooses what to measure, and [`raylab::report`] makes the page.

use std::path::Path;
use std::process::ExitCode;

use raylab::accel::{self, ACCELERATORS};
use raylab::kernel;
use raylab::lab::{self, Budget, Control, Event, Plan};
use raylab::registry::Choice;
use raylab::report::{self, Provenance, Report, Run};

/// What the command line asks for.
struct Asked {
    scenes: Vec<String>,
    ray_count: usize,
    n: String,
    out: Option<String>,
    budget: Budget,
}

/// One share of what is measured: accelerators and a kernel on some ray sets.
struct Share {
    accels: Vec<Choice>,
    kernel: &'static str,
    rays: &'static [&'static str],
    threads: usize,
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
    let asked = read(std::env::args().skip(1))?;
    let embree = accel::entry("embree").map_err(|e| e.to_string())?;
    if let Some(why) = embree.standing().unavailable_because {
        return Err(why);
    }
    let mut report: Option<Report> = None;
    for share in shares()? {
        let plan = plan(&asked, &share)?;
        let runs = measure(&plan)?;
        if let Some(report) = &mut report {
            report.runs.extend(runs);
            continue;
        }
        let command = std::env::args().collect();
        let provenance = Provenance::gather(&plan, command).map_err(|e| e.to_string())?;
        report = Some(Report {
            schema: Report::SCHEMA.to_owned(),
            judged: None,
            provenance,
            config: plan,
            runs,
        });
    }
    let report = report.ok_or("there is nothing to measure")?;
    print!("{}", report::peers_page(&report));
    if let Some(out) = &asked.out {
        report::export(&report, "peers", Path::new(out)).map_err(|e| e.to_string())?;
        let path = Path::new(out).join("report.json");
        report.write(&path).map_err(|e| e.to_string())?;
        eprintln!("wrote peers.md and report.json to {out}");
    }
    Ok(())
}

/// Reads the command line.
fn read(arguments: impl Iterator<Item = String>) -> Result<Asked, String> {
    let mut asked = Asked {
        scenes: Vec::new(),
        ray_count: 1 << 17,
        n: "auto".to_owned(),
        out: None,
        budget: Budget {
            sample_seconds: 0.02,
            min_samples: 9,
            max_samples: 21,
            relative_half_width: 0.01,
            run_seconds: 2.0,
            checked_rays: 512,
        },
    };
    let mut arguments = arguments;
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
        match argument.as_str() {
            // Given by `cargo bench` itself.
            "--bench" => {}
            "--quick" => {
                asked.ray_count = 1 << 15;
                asked.budget = Budget {
                    checked_rays: 128,
                    ..Budget::quick()
                };
            }
            "--rays-count" => {
                let text = value()?;
                asked.ray_count = text
                    .parse()
                    .map_err(|_| format!("'{text}' is no number of rays"))?;
            }
            "--n" => asked.n = value()?,
            "--out" => asked.out = Some(value()?),
            option if option.starts_with('-') => return Err(format!("'{option}' is no option")),
            scene => asked.scenes.push(scene.to_owned()),
        }
    }
    if asked.scenes.is_empty() {
        asked.scenes = ["plant", "sphereflake:4", "city:300"]
            .map(str::to_owned)
            .to_vec();
    }
    Ok(asked)
}

/// Everything that is measured. A watertight kernel stands beside Embree's robust test, the fast one beside its fast test;
/// the promise of coherence is tried where it can pay.
fn shares() -> Result<Vec<Share>, String> {
    const PAIRS: [(&str, &str); 2] = [("woop", "on"), ("moller-trumbore", "off")];
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
    ];
    let own = own
        .iter()
        .filter(|name| ACCELERATORS.iter().any(|a| a.name == **name));
    let own: Vec<String> = own.map(|name| (*name).to_owned()).collect();
    let mut shares = Vec::new();
    for (kernel, robust) in PAIRS {
        for (rays, modes) in SETS {
            let mut accels = own.clone();
            for quality in ["medium", "high"] {
                accels.extend(
                    modes.iter().map(|mode| {
                        format!("embree:mode={mode}:quality={quality}:robust={robust}")
                    }),
                );
            }
            if kernel == "woop" {
                let others = [
                    "obvhs",
                    "obvhs:build=slow",
                    "obvhs:layout=cwbvh",
                    "bvh-crate",
                ];
                accels.extend(others.map(str::to_owned));
            }
            shares.push(share(&accels, kernel, rays, 1)?);
        }
    }
    let two = ["bvh-wide", "embree", "embree:mode=packet"].map(str::to_owned);
    shares.push(share(&two, "woop", &["primary", "bounce"], 2)?);
    Ok(shares)
}

fn share(
    accels: &[String],
    kernel: &'static str,
    rays: &'static [&'static str],
    threads: usize,
) -> Result<Share, String> {
    let accels = accels
        .iter()
        .map(|name| accel::parse(name).map_err(|e| e.to_string()));
    Ok(Share {
        accels: accels.collect::<Result<_, _>>()?,
        kernel,
        rays,
        threads,
    })
}

fn plan(asked: &Asked, share: &Share) -> Result<Plan, String> {
    Ok(Plan {
        scenes: asked.scenes.clone(),
        accels: share.accels.clone(),
        n: lab::parse_n_list(&asked.n).map_err(|e| e.to_string())?,
        kernels: vec![kernel::parse(share.kernel).map_err(|e| e.to_string())?],
        rays: share.rays.iter().map(|&rays| rays.to_owned()).collect(),
        threads: vec![share.threads],
        ray_count: asked.ray_count,
        seed: 1,
        budget: asked.budget,
        // All structures on the same rays must stand in memory together to be sampled in turn.
        memory_limit: 16 << 30,
    })
}

/// Carries `plan` out; a run that cannot be made is told and left out.
fn measure(plan: &Plan) -> Result<Vec<Run>, String> {
    let mut runs = Vec::new();
    lab::sweep(
        plan,
        &<_>::default(),
        &Control::default(),
        &mut |event| match event {
            Event::Finished { record } => {
                let run = Run::from(record.as_ref());
                eprintln!(
                    "{:<40} {:<16} {:<8} {:>9.3} Mrays/s",
                    report::series::accel_label(&run),
                    run.scene.rsplit('/').next().unwrap_or_default(),
                    run.rays,
                    run.mrays_per_s.median
                );
                runs.push(run);
            }
            Event::Failed { why, .. } => eprintln!("left out: {why}"),
            _ => {}
        },
    )
    .map_err(|e| e.to_string())?;
    Ok(runs)
}
