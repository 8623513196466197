//! The format `peers`: raylab's own accelerators against Embree, goal by goal, and every structure mesh by mesh.
//!
//! ```text
//!                      the fastest own run of a goal's accelerators
//! ratio of a scene = ───────────────────────────────────────────────   both of one sweep and on the same rays, so
//!                    the fastest run of Embree that the goal allows     that their samples were interleaved
//! ```
//!
//! A watertight kernel stands against Embree's robust test, Möller and Trumbore's against its fast one. A goal is met
//! where the geometric mean over all scenes and the least of them both reach what it asks.

use super::plot::text::{measured, number};
use super::{Report, Run};
use crate::stats::median;

mod aligned;
mod goals;
mod structures;

/// The page, in Markdown whose columns are aligned, so that it reads as text, too.
#[must_use]
pub fn page(report: &Report) -> String {
    let text = [
        "# raylab beside its peers\n\n",
        "Ratios of median speeds over the same rays, samples of both interleaved: raylab's own over Embree's best. Above 1 \
         raylab is faster. `packets`: the faster of single rays and packets of sixteen, medium and high build; `promised`: also \
         packets whose caller promises that they are coherent; `single`: single rays only; `medium`: medium build only.\n\n",
        &goals::table(report, &scenes(report)),
        &structures(report),
        &rays(report),
    ];
    text.concat()
}

/// Every structure scene by scene, in Markdown: Mrays/s by ray set, build times, memory, wrong answers.
#[must_use]
pub fn structures(report: &Report) -> String {
    let table = |scene: &String| format!("\n## {scene}\n\n{}", structures::table(report, scene));
    scenes(report).iter().map(table).collect()
}

/// How many rays were traced, in a sentence.
fn rays(report: &Report) -> String {
    let counts = || report.runs.iter().map(|run| run.ray_count);
    match (counts().min(), counts().max()) {
        (Some(fewest), Some(most)) => format!(
            "\nMrays/s at one thread; {} to {} rays a set and sample; wrong answers by the oracle, of the rays checked.\n",
            number(fewest as f64),
            number(most as f64)
        ),
        _ => String::new(),
    }
}

/// Scenes in the order in which they first occur.
fn scenes(report: &Report) -> Vec<String> {
    let mut scenes: Vec<String> = Vec::new();
    for run in &report.runs {
        if !scenes.contains(&run.scene) {
            scenes.push(run.scene.clone());
        }
    }
    scenes
}

/// The fastest of the runs that `which` picks, where it has a speed; of those that were made together, if there are several
/// sweeps.
fn fastest(report: &Report, which: impl Fn(&Run) -> bool) -> Option<&Run> {
    let first = report.runs.iter().find(|run| is_timed(run) && which(run))?;
    fastest_of(report, |run| run.sweep == first.sweep && which(run))
}

/// How many times as fast the fastest run that `own` picks is as the fastest that `peer` picks, on the same rays of a scene,
/// where samples of both were interleaved: in the first sweep that has both with equally many rays.
fn ratio(
    report: &Report,
    (scene, rays): (&str, &str),
    own: impl Fn(&Run) -> bool,
    peer: impl Fn(&Run) -> bool,
) -> Option<f64> {
    let here = |run: &Run| run.scene == scene && run.rays == rays;
    let candidates = report.runs.iter().filter(|run| here(run) && own(run));
    candidates.into_iter().find_map(|with| {
        // Subsets of a set are other rays.
        let beside =
            |run: &Run| here(run) && (run.sweep, run.ray_count) == (with.sweep, with.ray_count);
        let own = fastest_of(report, |run| beside(run) && own(run))?;
        let peer = fastest_of(report, |run| beside(run) && peer(run))?;
        Some(own.mrays_per_s.median / peer.mrays_per_s.median)
    })
}

fn fastest_of(report: &Report, which: impl Fn(&Run) -> bool) -> Option<&Run> {
    let measured = report.runs.iter().filter(|run| is_timed(run) && which(run));
    measured.max_by(|a, b| a.mrays_per_s.median.total_cmp(&b.mrays_per_s.median))
}

fn is_timed(run: &Run) -> bool {
    run.mrays_per_s.median > 0.0
}

/// Median of all build times of the runs that `which` picks: whatever rays they were built for.
fn build_ms(
    report: &Report,
    scene: &str,
    threads: usize,
    which: impl Fn(&Run) -> bool,
) -> Option<f64> {
    let runs = report
        .runs
        .iter()
        .filter(|run| run.scene == scene && run.threads == threads && which(run));
    let times: Vec<f64> = runs
        .flat_map(|run| run.build_ms.samples.iter().copied())
        .collect();
    median(&times).filter(|ms| *ms > 0.0)
}

/// A number of three digits, or a dash.
fn cell(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), measured)
}

/// The file's name of a path, the spec of any other scene.
fn short(scene: &str) -> String {
    let name = scene.rsplit(['/', '\\']).next().unwrap_or(scene);
    name.trim_end_matches(".obj").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::{report, run_of};
    use crate::stats::Summary;

    /// A run of `accel` on `rays` at `speed`; Embree's beside `woop`.
    fn measured_run(accel: &str, rays: &str, speed: f64, build: f64) -> Run {
        let choice = crate::accel::parse(accel).unwrap();
        let mut run = run_of("teapot", 6320, rays, 1, &choice.name, None);
        run.params = choice.params;
        run.mrays_per_s = Summary::of(&[speed; 3], 1);
        run.build_ms = Summary::of(&[build; 3], 1);
        if choice.name == "embree" {
            run.kernel = "embree-robust".to_owned();
            run.beside_kernel = Some("woop".to_owned());
            run.wrong_answers = Some(3);
            run.memory_bytes = 1 << 20;
        }
        run
    }

    fn row_of(page: &str, start: &str) -> String {
        let line = page.lines().find(|line| line.starts_with(start));
        line.unwrap_or_else(|| panic!("no '{start}' in {page}"))
            .to_owned()
    }

    #[test]
    fn the_best_allowed_run_of_embree_is_what_a_goal_is_held_against() {
        let page = page(&report(vec![
            measured_run("bvh-wide", "primary", 45.0, 90.0),
            measured_run("kd-tree", "primary", 9.0, 900.0),
            measured_run("embree", "primary", 10.0, 100.0),
            measured_run("embree:mode=packet:quality=high", "primary", 20.0, 300.0),
        ]));
        let wide = row_of(&page, "| bvh-wide, primary ");
        assert!(wide.contains("2.25") && wide.contains("PASS"), "{wide}");
        // Against single rays only.
        let kd = row_of(&page, "| kd-tree, primary ");
        assert!(kd.contains("0.900") && kd.contains("PASS"), "{kd}");
        let build = row_of(&page, "| build of bvh-wide, 1 thread ");
        assert!(build.contains("1.11") && build.contains("PASS"), "{build}");
        let random = row_of(&page, "| bvh-wide, random ");
        assert!(random.contains("not measured"), "{random}");
        assert!(page.contains("3 of "), "{page}");
    }

    #[test]
    fn runs_on_other_rays_are_not_compared() {
        let mut few = measured_run("embree", "primary", 10.0, 100.0);
        few.ray_count = 7;
        let page = page(&report(vec![
            measured_run("bvh-wide", "primary", 45.0, 90.0),
            few,
        ]));
        assert!(row_of(&page, "| bvh-wide, primary ").contains("not measured"));
    }

    #[test]
    fn one_of_a_goal_s_accelerators_on_the_same_rays_is_enough() {
        let mut few = measured_run("grid-skip", "primary", 99.0, 100.0);
        few.ray_count = 7;
        let page = page(&report(vec![
            few,
            measured_run("grid-2level", "primary", 9.0, 100.0),
            measured_run("embree", "primary", 10.0, 100.0),
        ]));
        let row = row_of(&page, "| grid-skip / grid-2level, primary ");
        assert!(row.contains("0.900") && row.contains("MISS"), "{row}");
    }

    #[test]
    fn ratios_are_of_runs_that_one_sweep_has_made() {
        let run = |sweep, accel, kernel: &str, speed| {
            let mut run = measured_run(accel, "bounce", speed, 1.0);
            run.sweep = Some(sweep);
            if accel == "bvh-wide" {
                run.kernel = kernel.to_owned();
            }
            run
        };
        let mut runs = vec![
            run(0, "bvh-wide", "woop", 12.0),
            run(0, "embree", "", 10.0),
            // The machine is three times as slow, and then ten times as fast.
            run(1, "bvh-wide", "moller-trumbore", 4.0),
            run(2, "bvh-wide", "moller-trumbore", 160.0),
            run(2, "bvh-wide", "woop", 120.0),
        ];
        let page = page(&report(runs.clone()));
        let kernels = row_of(&page, "| watertight in bvh-wide, bounce ");
        assert!(kernels.contains("0.750"), "{kernels}");
        let speed = row_of(&page, "| bvh-wide, bounce ");
        assert!(speed.contains("1.20"), "{speed}");
        assert!(page.contains("12.0") && !page.contains("120"), "{page}");
        runs.truncate(3);
        let apart = row_of(
            &super::page(&report(runs)),
            "| watertight in bvh-wide, bounce ",
        );
        assert!(apart.contains("not measured"), "{apart}");
    }

    #[test]
    fn what_is_not_the_default_build_is_not_held_against_the_medium_one() {
        let page = page(&report(vec![
            measured_run("bvh-wide:build=sbvh", "primary", 90.0, 900.0),
            measured_run("bvh-wide", "primary", 45.0, 90.0),
            measured_run("embree", "primary", 10.0, 100.0),
        ]));
        assert!(row_of(&page, "| bvh-wide, primary ").contains("9.00"));
        assert!(row_of(&page, "| build of bvh-wide, 1 thread ").contains("1.11"));
        let all = ["primary", "shadow", "bounce", "random"];
        let runs = all.iter().flat_map(|rays| {
            ["bvh-wide:build=sbvh", "bvh-wide", "embree"]
                .map(|accel| measured_run(accel, rays, accel.len() as f64, 1.0))
        });
        let row = row_of(
            &super::page(&report(runs.collect())),
            "| bvh-wide, primary + shadow ",
        );
        // 8 letters over 6, not 19 over 6.
        assert!(row.contains("1.33"), "{row}");
    }

    #[test]
    fn what_two_threads_give_embree_is_shown_and_nothing_asked() {
        let mut runs = Vec::new();
        for (threads, speeds) in [(1, [10.0, 8.0]), (2, [19.5, 15.0])] {
            for (accel, speed) in ["bvh-wide", "embree"].iter().zip(speeds) {
                let mut run = measured_run(accel, "bounce", speed, 1.0);
                run.threads = threads;
                runs.push(run);
            }
        }
        let page = page(&report(runs));
        let own = row_of(&page, "| two threads in bvh-wide, bounce ");
        assert!(own.contains("1.95") && own.contains("PASS"), "{own}");
        let peer = row_of(&page, "| two threads in embree, bounce ");
        assert!(peer.contains("1.88") && !peer.contains("PASS"), "{peer}");
    }

    #[test]
    fn long_paths_are_short() {
        assert_eq!(short("a/b/bunny.obj"), "bunny");
        assert_eq!(short("city:300"), "city:300");
    }
}
