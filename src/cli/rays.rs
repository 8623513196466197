//! `raylab rays` and `raylab trace`: ray sets to files, files of rays to files of hits.

use serde_json::json;

use crate::geometry::Hit;
use crate::lab::{self, Budget};
use crate::trace::{self, Query, files};

use super::args::{RaysArgs, TraceArgs};
use super::session::{Config, load};
use super::table::significant;
use super::{Failure, print};

/// Writes a ray set.
pub fn write(args: &RaysArgs) -> Result<(), Failure> {
    trace::parse(&args.rays)?;
    let scene = load(&args.scene, args.quiet)?;
    let set = trace::ray_set(&scene, &args.rays, args.rays_count, args.seed)?;
    files::write_rays(&args.out, &set.rays)?;
    if !args.quiet {
        for warning in &set.warnings {
            eprintln!("raylab: {warning}");
        }
        eprintln!("wrote {} rays to {}", set.rays.len(), args.out.display());
    }
    Ok(())
}

/// Traces the rays of a file, writes the hits and prints the speed.
pub fn trace(args: &TraceArgs) -> Result<(), Failure> {
    let config = Config::read(&args.config)?;
    let rays = files::read_rays(&args.rays_file)?;
    let scene = load(&args.scene, args.config.quiet)?;
    let pool = config.pool()?;
    let built = pool.install(|| config.build(&scene))?;
    let query = if args.occluded {
        Query::Occluded
    } else {
        Query::Closest
    };

    let hits = if args.occluded {
        let blocked = pool.install(|| trace::occluded(built.accel.as_ref(), &rays));
        if let Some(path) = &args.hits {
            files::write_occluded(path, &blocked)?;
        }
        blocked.iter().filter(|b| **b).count()
    } else {
        let hits = pool.install(|| trace::closest(built.accel.as_ref(), &rays));
        if let Some(path) = &args.hits {
            files::write_hits(path, &hits)?;
        }
        hits.iter().filter(|h: &&Hit| h.is_hit()).count()
    };

    let speed = pool.install(|| {
        lab::speed(
            built.accel.as_ref(),
            &rays,
            query,
            &Budget::default(),
            args.config.seed,
        )
    });
    if args.config.json {
        let result = json!({
            "mrays_per_s": speed,
            "build_ms": built.build_ms,
            "hits": hits,
            "rays": rays.len(),
            "accel": config.accel_label(),
            "n": built.n,
            "kernel": config.kernel.name,
            "threads": config.threads,
        });
        return print(&format!("{result:#}\n"));
    }
    let n = built.n.map_or(String::new(), |n| format!(" n={n}"));
    print(&format!(
        "{} Mrays/s (95 %: {} to {}, {} samples), {hits} of {} rays {}, {}{n}, {}, {} threads, built in {} ms\n",
        significant(speed.median),
        significant(speed.lo),
        significant(speed.hi),
        speed.samples.len(),
        rays.len(),
        if args.occluded { "blocked" } else { "hit" },
        config.accel_label(),
        config.kernel.name,
        config.threads,
        significant(built.build_ms),
    ))
}
