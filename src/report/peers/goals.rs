//! What is asked of raylab's accelerators beside Embree, and whether it is reached.

use crate::report::series::{PanelKey, accel_label};
use crate::report::{Report, Run};

use super::aligned::aligned;
use super::{build_ms, cell, ratio, short};

/// Which runs of Embree a goal allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Against {
    /// Single rays or packets, medium or high quality; also packets whose caller promises that they are coherent.
    Promised,
    /// Single rays or packets, medium or high quality.
    Packets,
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
    /// Asked of the geometric mean over scenes; `None` where it is there for comparison.
    mean: Option<f64>,
    /// Asked of each scene.
    least: Option<f64>,
}

impl Against {
    fn allows(self, run: &Run) -> bool {
        let mode = run.params.text("mode");
        match self {
            Self::Promised => true,
            Self::Packets => mode != "coherent",
            Self::Single => mode == "single",
            Self::Medium => mode != "coherent" && run.params.text("quality") == "medium",
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Promised => "promised",
            Self::Packets => "packets",
            Self::Single => "single",
            Self::Medium => "medium",
        }
    }
}

const WIDE: &[&str] = &["bvh-wide"];
const GRIDS: &[&str] = &["grid-skip", "grid-2level"];
const KD: &[&str] = &["kd-tree"];

#[rustfmt::skip]
const GOALS: &[Goal] = &[
    Goal { own: WIDE, rays: &["primary"], against: Against::Packets, mean: Some(2.0), least: Some(1.4) },
    Goal { own: WIDE, rays: &["primary"], against: Against::Promised, mean: None, least: None },
    Goal { own: WIDE, rays: &["shadow"], against: Against::Packets, mean: Some(1.2), least: Some(1.0) },
    Goal { own: WIDE, rays: &["shadow"], against: Against::Promised, mean: None, least: None },
    Goal { own: WIDE, rays: &["bounce"], against: Against::Packets, mean: Some(1.25), least: Some(1.05) },
    Goal { own: WIDE, rays: &["random"], against: Against::Packets, mean: Some(1.5), least: Some(1.1) },
    Goal { own: GRIDS, rays: &["primary"], against: Against::Single, mean: Some(0.95), least: Some(0.7) },
    Goal { own: GRIDS, rays: &["bounce"], against: Against::Single, mean: Some(0.8), least: Some(0.6) },
    Goal { own: KD, rays: &["primary"], against: Against::Single, mean: Some(0.9), least: None },
    Goal { own: KD, rays: &["bounce"], against: Against::Single, mean: Some(0.45), least: None },
    // What is built must trace as fast as what its build is compared with.
    Goal { own: WIDE, rays: &["primary", "shadow", "bounce", "random"], against: Against::Medium, mean: Some(1.0), least: None },
];

/// A kernel, and Embree's test of the same kind.
const PAIRS: [(&str, &str); 2] = [
    ("woop", "embree-robust"),
    ("moller-trumbore", "embree-fast"),
];

/// The structure whose builds, threads, memory and kernels are compared.
const FAST: &str = "bvh-wide";

/// A line of the table of goals.
pub(super) struct Row {
    pub what: String,
    pub beside: String,
    /// Asked of the geometric mean; `None` where the row is there for comparison.
    pub mean: Option<f64>,
    /// Asked of each scene.
    pub least: Option<f64>,
    /// By scene; `None` where a run is missing.
    pub ratios: Vec<Option<f64>>,
}

/// Whether a goal is met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    Pass,
    Miss,
    /// Runs are missing.
    Open,
    /// Nothing is asked.
    Shown,
}

impl Row {
    fn geometric_mean(&self) -> Option<f64> {
        let all: Option<Vec<f64>> = self.ratios.iter().copied().collect();
        all.filter(|all| !all.is_empty()).map(|all| geometric(&all))
    }

    fn least_ratio(&self) -> Option<f64> {
        self.ratios.iter().flatten().copied().min_by(f64::total_cmp)
    }

    pub fn verdict(&self) -> Verdict {
        let (Some(mean), Some(least)) = (self.geometric_mean(), self.least_ratio()) else {
            return Verdict::Open;
        };
        let Some(asked) = self.mean else {
            return Verdict::Shown;
        };
        if mean >= asked && self.least.is_none_or(|asked| least >= asked) {
            Verdict::Pass
        } else {
            Verdict::Miss
        }
    }
}

/// The table of goals.
pub(super) fn table(report: &Report, scenes: &[String]) -> String {
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
    let rows = [
        speeds(report, scenes),
        builds(report, scenes),
        kernels(report, scenes),
        threads(report, scenes),
        memory(report, scenes),
    ];
    table.extend(rows.iter().flatten().map(line));
    aligned(&table)
}

fn line(row: &Row) -> Vec<String> {
    let mut line = vec![
        row.what.clone(),
        row.beside.clone(),
        cell(row.geometric_mean()),
        cell(row.mean),
        cell(row.least_ratio()),
        cell(row.least),
        match row.verdict() {
            Verdict::Pass => "PASS",
            Verdict::Miss => "MISS",
            Verdict::Open => "not measured",
            Verdict::Shown => "–",
        }
        .to_owned(),
    ];
    line.extend(row.ratios.iter().map(|ratio| cell(*ratio)));
    line
}

/// The goals of speed, by kernel.
fn speeds(report: &Report, scenes: &[String]) -> Vec<Row> {
    let row = |goal: &Goal, (kernel, test): (&str, &str)| {
        let ratio = |scene: &String| {
            let of_rays = goal.rays.iter();
            let of_rays =
                of_rays.map(|rays| speed_ratio(report, scene, goal, rays, (kernel, test)));
            let all: Option<Vec<f64>> = of_rays.collect();
            all.map(|all| geometric(&all))
        };
        Row {
            what: format!("{}, {}", goal.own.join(" / "), goal.rays.join(" + ")),
            beside: format!("{kernel} : {test}, {}", goal.against.name()),
            mean: goal.mean,
            least: goal.least,
            ratios: scenes.iter().map(ratio).collect(),
        }
    };
    GOALS
        .iter()
        .flat_map(|goal| PAIRS.map(|pair| row(goal, pair)))
        .collect()
}

/// How many times as fast as Embree a goal's accelerators are on one scene and ray set, one thread.
fn speed_ratio(
    report: &Report,
    scene: &str,
    goal: &Goal,
    rays: &str,
    (kernel, test): (&str, &str),
) -> Option<f64> {
    let beside = |run: &Run| run.threads == 1 && PanelKey::of(run).kernel == kernel;
    let own = |run: &Run| {
        goal.own.contains(&run.accel.as_str())
            && beside(run)
            // What traces as fast as Embree's medium build must be what is built as fast.
            && (goal.against != Against::Medium || is_default(run))
    };
    let peer = |run: &Run| run.kernel == test && beside(run) && goal.against.allows(run);
    ratio(report, (scene, rays), own, peer)
}

/// Whether no parameter of the accelerator differs from its default.
fn is_default(run: &Run) -> bool {
    accel_label(run) == run.accel
}

/// Build speeds at one and two threads.
fn builds(report: &Report, scenes: &[String]) -> Vec<Row> {
    let row = |threads: usize| {
        let ratio = |scene: &String| {
            let own = build_ms(report, scene, threads, |run| {
                run.accel == FAST && run.kernel == "woop" && is_default(run)
            })?;
            let peer = build_ms(report, scene, threads, |run| {
                run.kernel == "embree-robust" && run.params.text("quality") == "medium"
            })?;
            Some(peer / own)
        };
        let plural = if threads == 1 { "" } else { "s" };
        Row {
            what: format!("build of {FAST}, {threads} thread{plural}"),
            beside: "woop : embree-robust, medium".to_owned(),
            mean: Some(0.9),
            least: Some(0.7),
            ratios: scenes.iter().map(ratio).collect(),
        }
    };
    [1, 2].map(row).into()
}

/// What a watertight kernel costs.
fn kernels(report: &Report, scenes: &[String]) -> Vec<Row> {
    let row = |rays: &str| {
        let of = |kernel: &str| {
            let kernel = kernel.to_owned();
            move |run: &Run| run.accel == FAST && run.kernel == kernel && run.threads == 1
        };
        let ratio =
            |scene: &String| ratio(report, (scene, rays), of("woop"), of("moller-trumbore"));
        Row {
            what: format!("watertight in {FAST}, {rays}"),
            beside: "woop : moller-trumbore".to_owned(),
            mean: Some(0.9),
            least: None,
            ratios: scenes.iter().map(ratio).collect(),
        }
    };
    ["primary", "bounce"].map(row).into()
}

/// What two threads give, and what they give Embree on the same machine.
fn threads(report: &Report, scenes: &[String]) -> Vec<Row> {
    let row = |accel: &str, rays: &str| {
        let with = |threads: usize| {
            move |run: &Run| {
                run.accel == accel
                    && run.threads == threads
                    && ["woop", "embree-robust"].contains(&run.kernel.as_str())
            }
        };
        let ratio = |scene: &String| ratio(report, (scene, rays), with(2), with(1));
        Row {
            what: format!("two threads in {accel}, {rays}"),
            beside: "2 threads : 1 thread".to_owned(),
            mean: (accel == FAST).then_some(1.9),
            least: None,
            ratios: scenes.iter().map(ratio).collect(),
        }
    };
    [FAST, "embree"]
        .iter()
        .flat_map(|accel| ["primary", "bounce"].map(|rays| row(accel, rays)))
        .collect()
}

/// Memory beside the peer that takes least, and beside that of those whose boxes are not compressed.
fn memory(report: &Report, scenes: &[String]) -> Vec<Row> {
    let row = |beside: &str, counts: fn(&Run) -> bool| {
        let ratio = |scene: &String| {
            let runs = report.runs.iter();
            let here: Vec<&Run> = runs
                .filter(|run| run.scene == *scene && run.memory_bytes > 0)
                .collect();
            let own = |run: &&&Run| run.accel == FAST && run.kernel == "woop" && is_default(run);
            let own = here.iter().find(own)?.memory_bytes;
            let peers = here.iter().filter(|run| run.wrong_answers.is_some());
            let leanest = peers.filter(|run| counts(run)).map(|run| run.memory_bytes);
            Some(leanest.min()? as f64 / own as f64)
        };
        Row {
            what: format!("memory of {FAST}"),
            beside: format!("{beside} : woop"),
            mean: Some(1.0 / 1.2),
            least: None,
            ratios: scenes.iter().map(ratio).collect(),
        }
    };
    let uncompressed = |run: &Run| run.params.text("layout") != "cwbvh";
    vec![
        row("leanest peer", |_| true),
        row("leanest uncompressed peer", uncompressed),
    ]
}

fn geometric(values: &[f64]) -> f64 {
    (values.iter().map(|x| x.ln()).sum::<f64>() / values.len().max(1) as f64).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_goal_is_missed_by_its_mean_or_by_one_scene() {
        let row = |ratios: &[f64]| Row {
            what: String::new(),
            beside: String::new(),
            mean: Some(2.0),
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
}
