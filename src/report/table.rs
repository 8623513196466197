//! What pages of a report tabulate: runs, provenance, how it was measured. Texts without markup; the formats add theirs.

use super::judged::{Course, Judged, places, points};
use super::plot::text::{measured, number};
use super::series::{PanelKey, accel_label};
use super::{ErrorSpread, Place, Rate, Report, Run, StartRule};

/// Rows under a head; all rows are as long as the head.
pub(super) struct Table {
    pub head: Vec<&'static str>,
    pub rows: Vec<Vec<String>>,
}

/// How many leading columns of a run's table are words; the rest are numbers.
pub(super) const WORDS: usize = 1;

const HEAD: [&str; 10] = [
    "accelerator",
    "n",
    "Mrays/s",
    "95 % interval",
    "of fastest",
    "build ms",
    "memory MiB",
    "steps/ray",
    "tests/ray",
    "valid",
];

/// The runs of one panel in the order of the report.
pub(super) fn runs<'a>(report: &'a Report, key: &PanelKey) -> Vec<&'a Run> {
    report
        .runs
        .iter()
        .filter(|run| PanelKey::of(run) == *key)
        .collect()
}

/// The fastest run of each accelerator, the fastest first.
pub(super) fn fastest<'a>(runs: &[&'a Run]) -> Vec<&'a Run> {
    let mut best: Vec<&Run> = Vec::new();
    for &run in runs {
        match best.iter_mut().find(|b| accel_label(b) == accel_label(run)) {
            Some(b) if speed(run) > speed(b) => *b = run,
            Some(_) => {}
            None => best.push(run),
        }
    }
    best.sort_by(|a, b| speed(b).total_cmp(&speed(a)));
    best
}

/// Median speed; 0 where there is none.
fn speed(run: &Run) -> f64 {
    let median = run.mrays_per_s.median;
    if median.is_finite() { median } else { 0.0 }
}

/// `shown` as a table; shares are of the fastest of `all`.
pub(super) fn table(shown: &[&Run], all: &[&Run]) -> Table {
    let top = all.iter().map(|run| speed(run)).fold(0.0, f64::max);
    Table {
        head: HEAD.to_vec(),
        rows: shown.iter().map(|run| row(run, top)).collect(),
    }
}

fn row(run: &Run, top: f64) -> Vec<String> {
    let speed = speed(run);
    let (share, interval) = if speed > 0.0 && top > 0.0 {
        (
            format!("{} %", measured(100.0 * speed / top)),
            format!(
                "{} – {}",
                value(run.mrays_per_s.lo),
                value(run.mrays_per_s.hi)
            ),
        )
    } else {
        (String::new(), String::new())
    };
    vec![
        accel_label(run),
        run.n
            .map_or_else(|| "–".to_owned(), |n| number(f64::from(n))),
        if speed > 0.0 {
            measured(speed)
        } else {
            "–".to_owned()
        },
        interval,
        share,
        value(run.build_ms.median),
        value(run.memory_bytes as f64 / f64::from(1 << 20)),
        value(run.steps().unwrap_or(f64::NAN)),
        value(run.tests().unwrap_or(f64::NAN)),
        verdict(run),
    ]
}

/// Whether the answers are right; of a peer, how many of those that were checked are wrong.
fn verdict(run: &Run) -> String {
    match (run.wrong_answers, run.valid) {
        (Some(wrong), _) if wrong > 0 => format!("{} wrong", number(wrong as f64)),
        (_, true) => "yes".to_owned(),
        (_, false) => "NO".to_owned(),
    }
}

/// What the oracle found on one course: rates in percent with their upper 95 % bounds, one row a method and place.
pub(super) fn accuracy(report: &Report, course: &Course) -> Table {
    let head = vec![
        "kernel",
        "place",
        "Mrays/s",
        "leaks %",
        "phantoms %",
        "wrong surface %",
        "neighbour swaps %",
        "occlusion differs %",
        "t ulp p50 / p99 / max",
    ];
    let row = |point: Judged, place: Place| {
        let a = point.accuracy;
        let rate = |seen: u64| percent(Rate::of(seen, a.rays));
        vec![
            point.label,
            written(place),
            measured(point.speed[0]),
            rate(a.leaks),
            rate(a.phantoms),
            rate(a.wrong_surface),
            rate(a.neighbour_swaps),
            rate(a.occlusion_disagreements),
            spread(Some(a.t_ulp)),
        ]
    };
    Table {
        head,
        rows: by_place(report, course, row),
    }
}

/// How far right hits are off on one course, what secondary rays do, and what answers change with.
pub(super) fn errors(report: &Report, course: &Course) -> Table {
    let head = vec![
        "kernel",
        "place",
        "to plane / scene p50 / p99 / max",
        "barycentric p50 / p99 / max",
        "self-hits % naive",
        "n·1e-4",
        "t_min 1e-4",
        "integer",
        "bound",
        "vertex rotation %",
        "translation %",
    ];
    let row = |point: Judged, place: Place| {
        let a = point.accuracy;
        let or_dash = |rate: Option<Rate>| rate.map_or_else(|| "–".to_owned(), percent);
        let mut row = vec![
            point.label,
            written(place),
            spread(a.plane),
            spread(a.barycentric),
        ];
        let rules = 0..StartRule::ALL.len();
        row.extend(rules.map(|rule| or_dash(a.self_hits.map(|rules| rules[rule].rate))));
        row.push(or_dash(a.vertex_rotation));
        row.push(or_dash(a.translation));
        row
    };
    Table {
        head,
        rows: by_place(report, course, row),
    }
}

/// One row a method and place.
fn by_place(
    report: &Report,
    course: &Course,
    row: impl Fn(Judged, Place) -> Vec<String>,
) -> Vec<Vec<String>> {
    let places = places(&report.runs, course).into_iter();
    let rows = places.flat_map(|place| {
        let points = points(&report.runs, course, place).into_iter();
        points.map(move |point| (point, place))
    });
    rows.map(|(point, place)| row(point, place)).collect()
}

/// `0`, `10,000`, `0 × 10⁻³⁰`: the offset, and the scale where it is another.
fn written(place: Place) -> String {
    if place.scale == 1.0 {
        number(place.offset)
    } else {
        format!("{} × {}", number(place.offset), number(place.scale))
    }
}

/// A rate and its upper bound, in percent.
fn percent(rate: Rate) -> String {
    let bound = measured(100.0 * rate.upper95);
    format!("{} (≤ {bound})", measured(100.0 * rate.share()))
}

fn spread(spread: Option<ErrorSpread>) -> String {
    spread.map_or_else(
        || "–".to_owned(),
        |s| [s.p50, s.p99, s.max].map(measured).join(" / "),
    )
}

/// A measured number, or a dash where it is none.
fn value(x: f64) -> String {
    if x.is_finite() {
        measured(x)
    } else {
        "–".to_owned()
    }
}

/// What program measured on what machine, as pairs; what is not known is left out.
pub(super) fn provenance(report: &Report) -> Vec<(&'static str, String)> {
    let p = &report.provenance;
    let modified = if p.dirty {
        ", with uncommitted changes"
    } else {
        ""
    };
    let caches: Vec<String> = p
        .caches
        .iter()
        .map(|bytes| format!("{} KiB", number((bytes >> 10) as f64)))
        .collect();
    let positive = |x: f64, text: String| if x >= 0.0 { text } else { String::new() };
    [
        ("command", p.command.join(" ")),
        ("date", p.date.clone()),
        ("program", format!("raylab {}", p.version)),
        (
            "commit",
            if p.commit.is_empty() {
                String::new()
            } else {
                format!("{}{modified}", p.commit)
            },
        ),
        (
            "compiler",
            [&p.rustc, &p.target, &p.profile]
                .map(String::as_str)
                .join(" ")
                .trim()
                .to_owned(),
        ),
        ("CPU", p.cpu.clone()),
        (
            "cores",
            if p.cores > 0 {
                p.cores.to_string()
            } else {
                String::new()
            },
        ),
        ("caches", caches.join(", ")),
        ("instruction set", p.instruction_set.clone()),
        ("system", p.os.clone()),
        ("load when it began", positive(p.load, measured(p.load))),
        ("seed", p.seed.to_string()),
    ]
    .into_iter()
    .filter(|(_, value)| !value.is_empty())
    .collect()
}

/// The scenes of the report.
pub(super) fn scenes(report: &Report) -> Table {
    let row = |s: &super::SceneFacts| {
        vec![
            s.name.clone(),
            number(s.triangles as f64),
            number(s.degenerate as f64),
            s.hash.chars().take(16).collect(),
        ]
    };
    Table {
        head: vec!["scene", "triangles", "without area", "SHA-256"],
        rows: report.provenance.scenes.iter().map(row).collect(),
    }
}

/// How the figures came about, a sentence each.
pub(super) fn method(report: &Report) -> Vec<String> {
    let b = &report.config.budget;
    vec![
        "All accelerators trace the same rays; samples of all configurations are interleaved in seeded random order."
            .to_owned(),
        format!(
            "A sample traces whole ray sets for at least {} ms. A run takes {} to {} samples, until the interval is \
             within {} % of the median or {} s have passed.",
            measured(b.sample_seconds * 1e3),
            b.min_samples,
            b.max_samples,
            measured(b.relative_half_width * 100.0),
            measured(b.run_seconds)
        ),
        "Speeds are medians; intervals are 95 % bootstrap intervals of the median.".to_owned(),
        "Steps and tests are means over the set, counted in a separate pass; timed runs count nothing.".to_owned(),
        format!(
            "A run is valid when {} checked rays or all of them agree with brute force wherever brute force is right.",
            number(b.checked_rays as f64)
        ),
    ]
}

/// What a reader must know of single runs: `which run: what`.
pub(super) fn warnings(report: &Report) -> Vec<(String, String)> {
    let mut all = Vec::new();
    for run in &report.runs {
        let n = run.n.map(|n| format!(" · n = {n}")).unwrap_or_default();
        let who = format!("{} · {}{n}", PanelKey::of(run), accel_label(run));
        if run.is_broken() {
            all.push((
                who.clone(),
                "some checked rays got wrong answers".to_owned(),
            ));
        }
        if let Some(wrong) = run.wrong_answers.filter(|&wrong| wrong > 0) {
            let what = format!(
                "this peer answers {} of {} checked rays wrongly by the oracle",
                number(wrong as f64),
                number(run.checked_rays as f64)
            );
            all.push((who.clone(), what));
        }
        if run.kernel_errors > 0 {
            let what = format!(
                "on {} of {} checked rays the kernel itself errs and answers differ",
                number(run.kernel_errors as f64),
                number(run.checked_rays as f64)
            );
            all.push((who.clone(), what));
        }
        all.extend(run.warnings.iter().map(|w| (who.clone(), w.clone())));
    }
    all
}
