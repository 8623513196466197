//! The format `peers`: raylab's own accelerators against Embree, goal by goal, and every structure mesh by mesh.
//!
//! ```text
//!                      the fastest own run of a goal's accelerators
//! ratio of a scene = ───────────────────────────────────────────────   same rays, kernel's company and threads, so
//!                    the fastest run of Embree that the goal allows     that samples of both were interleaved
//! ```
//!
//! A watertight kernel stands against Embree's robust test, Möller and Trumbore's against its fast one. A goal is met
//! where the geometric mean over all scenes and the least of them both reach what it asks.

use super::plot::text::measured;
use super::series::{PanelKey, accel_label};
use super::{Report, Run};
use crate::stats::median;

/// Which runs of Embree a goal allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Against {
    /// Single rays or packets, medium or high quality.
    Any,
    /// Single rays, medium or high quality.
    Single,
    /// Single rays or packets over the tree of medium quality.
    Medium,
}

/// What is asked of some accelerators on one ray set.
struct Goal {
    /// Of these, the fastest run counts on each scene.
    own: &'static [&'static str],
    rays: &'static [&'static str],
    against: Against,
    /// Asked of the geometric mean over scenes.
    mean: f64,
    /// Asked of each scene.
    least: Option<f64>,
}

const WIDE: &[&str] = &["bvh-wide"];
const GRIDS: &[&str] = &["grid", "grid-skip", "grid-2level"];
const KD: &[&str] = &["kd-tree"];

#[rustfmt::skip]
const GOALS: &[Goal] = &[
    Goal { own: WIDE, rays: &["primary"], against: Against::Any, mean: 2.0, least: Some(1.4) },
    Goal { own: WIDE, rays: &["shadow"], against: Against::Any, mean: 1.2, least: Some(1.0) },
    Goal { own: WIDE, rays: &["bounce"], against: Against::Any, mean: 1.25, least: Some(1.05) },
    Goal { own: WIDE, rays: &["random"], against: Against::Any, mean: 1.5, least: Some(1.1) },
    Goal { own: GRIDS, rays: &["primary"], against: Against::Single, mean: 0.95, least: Some(0.7) },
    Goal { own: GRIDS, rays: &["bounce"], against: Against::Single, mean: 0.8, least: Some(0.6) },
    Goal { own: KD, rays: &["primary"], against: Against::Single, mean: 0.9, least: None },
    Goal { own: KD, rays: &["bounce"], against: Against::Single, mean: 0.45, least: None },
    // What is built must trace as fast as what it is compared with.
    Goal { own: WIDE, rays: &["primary", "shadow", "bounce", "random"], against: Against::Medium, mean: 1.0, least: None },
];

/// A kernel, and Embree's test of the same kind.
const PAIRS: [(&str, &str); 2] = [
    ("woop", "embree-robust"),
    ("moller-trumbore", "embree-fast"),
];

/// The structure whose builds, threads, memory and kernels are compared.
const FAST: &str = "bvh-wide";

/// A line of the table of goals.
struct Row {
    what: String,
    beside: String,
    mean: f64,
    least: Option<f64>,
    /// By scene; `None` where a run is missing.
    ratios: Vec<Option<f64>>,
}

/// Whether a goal is met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Pass,
    Miss,
    /// Runs are missing.
    Open,
}

impl Row {
    fn geometric_mean(&self) -> Option<f64> {
        let logs: Option<Vec<f64>> = self.ratios.iter().map(|r| Some(r.as_ref()?.ln())).collect();
        let logs = logs.filter(|logs| !logs.is_empty())?;
        Some((logs.iter().sum::<f64>() / logs.len() as f64).exp())
    }

    fn least_ratio(&self) -> Option<f64> {
        self.ratios.iter().flatten().copied().min_by(f64::total_cmp)
    }

    fn verdict(&self) -> Verdict {
        let (Some(mean), Some(least)) = (self.geometric_mean(), self.least_ratio()) else {
            return Verdict::Open;
        };
        if mean >= self.mean && self.least.is_none_or(|asked| least >= asked) {
            Verdict::Pass
        } else {
            Verdict::Miss
        }
    }
}

/// The page, in Markdown whose columns are aligned, so that it reads as text, too.
#[must_use]
pub fn page(report: &Report) -> String {
    let scenes = scenes(report);
    let mut text = vec![
        "# raylab beside its peers\n\n".to_owned(),
        "Ratios of median speeds over the same rays, measured in one run with interleaved samples: raylab's own over \
         Embree's best. Above 1 raylab is faster. `any`: the faster of single rays and packets, medium and high build; \
         `single`: single rays only; `medium`: medium build only.\n\n"
            .to_owned(),
        goals(&rows(report, &scenes), &scenes),
    ];
    for scene in &scenes {
        text.push(format!("\n## {scene}\n\n"));
        text.push(everything(report, scene));
    }
    text.concat()
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

/// All goals with their ratios.
fn rows(report: &Report, scenes: &[String]) -> Vec<Row> {
    let mut rows = Vec::new();
    for goal in GOALS {
        for (kernel, test) in PAIRS {
            let against = match goal.against {
                Against::Any => "any",
                Against::Single => "single",
                Against::Medium => "medium",
            };
            let ratio = |scene: &String| {
                let of_rays = goal
                    .rays
                    .iter()
                    .map(|rays| speed_ratio(report, scene, goal, rays, (kernel, test)));
                of_rays
                    .collect::<Option<Vec<f64>>>()
                    .map(|all| geometric(&all))
            };
            rows.push(Row {
                what: format!("{}, {}", goal.own.join(" / "), goal.rays.join(" + ")),
                beside: format!("{kernel} : {test}, {against}"),
                mean: goal.mean,
                least: goal.least,
                ratios: scenes.iter().map(ratio).collect(),
            });
        }
    }
    for threads in [1, 2] {
        let ratio = |scene: &String| {
            let own = build_ms(report, scene, threads, |run| {
                run.accel == FAST && run.kernel == "woop"
            })?;
            let peer = build_ms(report, scene, threads, |run| {
                run.kernel == "embree-robust" && run.params.text("quality") == "medium"
            })?;
            Some(peer / own)
        };
        rows.push(Row {
            what: format!(
                "build of {FAST}, {threads} thread{}",
                if threads == 1 { "" } else { "s" }
            ),
            beside: "woop : embree-robust, medium".to_owned(),
            mean: 0.9,
            least: Some(0.7),
            ratios: scenes.iter().map(ratio).collect(),
        });
    }
    rows.extend(own_rows(report, scenes));
    rows
}

/// Goals that raylab's own structures have among themselves, and of memory.
fn own_rows(report: &Report, scenes: &[String]) -> Vec<Row> {
    let own = |scene: &str, kernel: &str, rays: &str, threads: usize| {
        fastest(report, |run| {
            run.accel == FAST
                && run.kernel == kernel
                && run.scene == scene
                && run.rays == rays
                && run.threads == threads
        })
        .map(|run| run.mrays_per_s.median)
    };
    let row = |what: String, beside: &str, mean: f64, ratio: &dyn Fn(&str) -> Option<f64>| Row {
        what,
        beside: beside.to_owned(),
        mean,
        least: None,
        ratios: scenes.iter().map(|scene| ratio(scene)).collect(),
    };
    let mut rows: Vec<Row> = ["primary", "bounce"]
        .iter()
        .map(|rays| {
            row(
                format!("watertight in {FAST}, {rays}"),
                "woop : moller-trumbore",
                0.9,
                &|scene| {
                    Some(own(scene, "woop", rays, 1)? / own(scene, "moller-trumbore", rays, 1)?)
                },
            )
        })
        .collect();
    rows.extend(["primary", "bounce"].iter().map(|rays| {
        row(
            format!("two threads in {FAST}, {rays}"),
            "2 threads : 1 thread",
            1.9,
            &|scene| Some(own(scene, "woop", rays, 2)? / own(scene, "woop", rays, 1)?),
        )
    }));
    rows.push(row(
        format!("memory of {FAST}"),
        "leanest peer : woop",
        1.0 / 1.2,
        &|scene| {
            let here = |run: &&Run| run.scene == scene && run.memory_bytes > 0;
            let own = report
                .runs
                .iter()
                .filter(here)
                .find(|run| run.accel == FAST && run.kernel == "woop")?;
            let peers = report
                .runs
                .iter()
                .filter(here)
                .filter(|run| run.wrong_answers.is_some());
            let leanest = peers.map(|run| run.memory_bytes).min()?;
            Some(leanest as f64 / own.memory_bytes as f64)
        },
    ));
    rows
}

/// How many times as fast as Embree a goal's accelerators are on one scene and ray set, one thread.
fn speed_ratio(
    report: &Report,
    scene: &str,
    goal: &Goal,
    rays: &str,
    (kernel, test): (&str, &str),
) -> Option<f64> {
    let own = fastest(report, |run| {
        goal.own.contains(&run.accel.as_str())
            && run.kernel == kernel
            && (run.scene.as_str(), run.rays.as_str(), run.threads) == (scene, rays, 1)
    })?;
    let key = PanelKey::of(own);
    let peer = fastest(report, |run| {
        let params = &run.params;
        run.kernel == test
            && PanelKey::of(run) == key
            && (goal.against != Against::Single || params.text("mode") == "single")
            && (goal.against != Against::Medium || params.text("quality") == "medium")
    })?;
    // Other rays are no comparison.
    (own.ray_count == peer.ray_count).then(|| own.mrays_per_s.median / peer.mrays_per_s.median)
}

/// The fastest of the runs that `which` picks, where it has a speed.
fn fastest(report: &Report, which: impl Fn(&Run) -> bool) -> Option<&Run> {
    let speed = |run: &Run| run.mrays_per_s.median;
    let measured = report
        .runs
        .iter()
        .filter(|run| speed(run) > 0.0 && which(run));
    measured.max_by(|a, b| speed(a).total_cmp(&speed(b)))
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

fn geometric(values: &[f64]) -> f64 {
    (values.iter().map(|x| x.ln()).sum::<f64>() / values.len().max(1) as f64).exp()
}

/// A number of three digits, or a dash.
fn cell(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), measured)
}

/// The table of goals.
fn goals(rows: &[Row], scenes: &[String]) -> String {
    let mut head = [
        "goal",
        "own : peer",
        "mean",
        "asked",
        "least",
        "asked",
        "verdict",
    ]
    .map(str::to_owned)
    .to_vec();
    head.extend(scenes.iter().map(|scene| short(scene)));
    let mut table = vec![head];
    for row in rows {
        let mut line = vec![
            row.what.clone(),
            row.beside.clone(),
            cell(row.geometric_mean()),
            measured(row.mean),
            cell(row.least_ratio()),
            cell(row.least),
            match row.verdict() {
                Verdict::Pass => "PASS",
                Verdict::Miss => "MISS",
                Verdict::Open => "not measured",
            }
            .to_owned(),
        ];
        line.extend(row.ratios.iter().map(|ratio| cell(*ratio)));
        table.push(line);
    }
    aligned(&table)
}

/// Every structure on one scene: speeds of its fastest n by ray set at one thread, build times, memory, wrong answers.
fn everything(report: &Report, scene: &str) -> String {
    const SETS: [&str; 4] = ["primary", "shadow", "bounce", "random"];
    let head = [
        "accelerator",
        "kernel",
        "primary",
        "shadow",
        "bounce",
        "random",
        "build ms",
        "2 threads",
        "MiB",
        "wrong",
    ];
    let mut table = vec![head.map(str::to_owned).to_vec()];
    let mut seen: Vec<(String, String)> = Vec::new();
    for run in report.runs.iter().filter(|run| run.scene == scene) {
        let key = (accel_label(run), PanelKey::of(run).kernel);
        if seen.contains(&key) {
            continue;
        }
        let same = |other: &Run| {
            other.scene == scene && (accel_label(other), PanelKey::of(other).kernel) == key
        };
        let mut line = vec![run.accel.clone(), run.kernel.clone()];
        line[0] = accel_label(run).replace(&format!(" ({})", run.kernel), "");
        for set in SETS {
            let best = fastest(report, |other| {
                same(other) && other.rays == set && other.threads == 1
            });
            line.push(cell(best.map(|run| run.mrays_per_s.median)));
        }
        line.push(cell(build_ms(report, scene, 1, same)));
        line.push(cell(build_ms(report, scene, 2, same)));
        line.push(measured(run.memory_bytes as f64 / f64::from(1 << 20)));
        let all = report.runs.iter().filter(|other| same(other));
        let (wrong, checked) = all.fold((0, 0), |(wrong, checked), run| {
            (
                wrong + run.wrong_answers.unwrap_or(u64::from(!run.valid)),
                checked + run.checked_rays,
            )
        });
        line.push(format!("{wrong} of {checked}"));
        table.push(line);
        seen.push(key);
    }
    aligned(&table)
}

/// The file's name of a path, the spec of any other scene.
fn short(scene: &str) -> String {
    let name = scene.rsplit(['/', '\\']).next().unwrap_or(scene);
    name.trim_end_matches(".obj").to_owned()
}

/// A Markdown table whose columns are aligned in plain text.
fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells
            .map(|cell| cell.chars().count())
            .max()
            .unwrap_or(0)
            .max(3)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut lines: Vec<String> = rows
        .iter()
        .map(|row| {
            let cells = row.iter().zip(&widths).enumerate();
            line(
                cells
                    .map(|(column, (cell, &width))| match column {
                        0 | 1 => format!("{cell:<width$}"),
                        _ => format!("{cell:>width$}"),
                    })
                    .collect(),
            )
        })
        .collect();
    let rule = widths
        .iter()
        .enumerate()
        .map(|(column, width)| match column {
            0 | 1 => "-".repeat(*width),
            _ => format!("{}:", "-".repeat(width - 1)),
        });
    lines.insert(1.min(lines.len()), line(rule.collect()));
    lines.concat()
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
    fn a_goal_is_missed_by_its_mean_or_by_one_scene() {
        let row = |ratios: &[f64]| Row {
            what: String::new(),
            beside: String::new(),
            mean: 2.0,
            least: Some(1.4),
            ratios: ratios.iter().map(|r| Some(*r)).collect(),
        };
        assert_eq!(row(&[1.5, 3.0]).verdict(), Verdict::Pass);
        assert_eq!(row(&[1.5, 2.5]).verdict(), Verdict::Miss);
        assert_eq!(row(&[1.3, 9.0]).verdict(), Verdict::Miss);
        assert_eq!(row(&[]).verdict(), Verdict::Open);
        let mut gap = row(&[3.0, 3.0]);
        gap.ratios[1] = None;
        assert_eq!(gap.verdict(), Verdict::Open);
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
    fn columns_are_aligned_and_long_paths_are_short() {
        assert_eq!(short("a/b/bunny.obj"), "bunny");
        assert_eq!(short("city:300"), "city:300");
        let table = aligned(
            &[["a", "b", "c"], ["long", "x", "1.5"]].map(|row| row.map(str::to_owned).to_vec()),
        );
        let lengths: Vec<usize> = table.lines().map(|line| line.chars().count()).collect();
        assert!(
            lengths.iter().all(|length| *length == lengths[0]),
            "{table}"
        );
    }
}
