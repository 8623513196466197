//! Reports of every shape that plots must cope with.

use crate::lab::PerRay;
use crate::registry::Value;
use crate::report::Report;
use crate::report::Run;
use crate::report::fixture::{N, growing, judged, params, report, run, run_of, summary, teapot};
use crate::stats::Summary;

/// Named reports, from the everyday to the nasty.
pub(super) fn all() -> Vec<(&'static str, Report)> {
    vec![
        ("everyday", teapot()),
        ("single-run", report(vec![run("grid", Some(16))])),
        ("single-tree", report(vec![run("bvh", None)])),
        ("one-line", report(over_n("grid", &N))),
        ("two-points", report(over_n("grid", &[16, 32]))),
        (
            "trees-only",
            report(
                ["brute", "kd-tree", "bvh", "bvh-wide", "octree"]
                    .map(|a| run(a, None))
                    .to_vec(),
            ),
        ),
        ("parameters", parameters()),
        ("many", many()),
        ("crossing", crossing()),
        ("narrow", narrow()),
        ("zeros", zeros()),
        ("huge", huge()),
        ("missing", missing()),
        ("long-names", long_names()),
        ("short-lines", short_lines()),
        ("combinations", combinations()),
        ("growing", report(growing())),
        ("growing-many", growing_many()),
        ("judged", judged_methods()),
        ("tuned", tuned()),
        ("judged-alone", report(vec![judged("woop", 1e4, 3.0, 0)])),
    ]
}

/// Nine accelerators of one family, some without steps, one with values far off.
fn growing_many() -> Report {
    let mut runs = Vec::new();
    for (size, triangles) in [(10, 1_002), (32, 10_242), (100, 100_002), (316, 998_562)] {
        for i in 0..9 {
            let accel = format!("accelerator-{i}");
            let scene = format!("city:{size}");
            let mut run = run_of(&scene, triangles, "random", 2, &accel, None);
            scale(&mut run.mrays_per_s, 1.0 + 0.02 * f64::from(i));
            if i % 3 == 1 {
                run.per_ray = None;
            }
            if i == 8 && size > 30 {
                run.build_ms = summary(1e9, 0.1, &run.id);
            }
            runs.push(run);
        }
    }
    report(runs)
}

/// Methods of two offsets, many with the same rate and nearly the same speed.
fn judged_methods() -> Report {
    let names = [
        "woop",
        "exact",
        "moller-trumbore",
        "plucker",
        "badouel",
        "baldwin-weber",
        "havel-herout",
        "kensler-shirley",
        "pbrt",
        "sheet-signed",
        "sheet-signed-local",
        "sheet-unsigned",
        "sheet-unsigned-local",
        "moller-trumbore-f64",
    ];
    let wrong = [
        0, 0, 1147, 0, 3473, 2686, 2883, 196, 0, 1507, 1441, 28_835, 0, 1,
    ];
    let mut runs = Vec::new();
    for (i, (name, wrong)) in names.iter().zip(wrong).enumerate() {
        let speed = 10.0 + (i * 5 % 7) as f64 * 0.4;
        runs.push(judged(name, 0.0, speed, wrong));
        let far = if wrong > 1000 {
            (wrong * 8).min(61_000)
        } else {
            wrong
        };
        runs.push(judged(name, 1e4, speed * 0.98, far));
        runs.push(judged(name, 1e6, speed * 0.98, far));
    }
    report(runs)
}

/// A kernel with several values of its parameter, at two offsets and two scales.
fn tuned() -> Report {
    let mut runs = Vec::new();
    for (i, eps) in [1e-7, 1e-5, 1e-3].into_iter().enumerate() {
        for (offset, scale) in [(0.0, 1.0), (1e4, 1.0), (0.0, 1e-30)] {
            let mut run = judged("sheet-unsigned", offset, 3.0, 900 * i as u64);
            run.params.insert("eps", Value::Float(eps));
            if let Some(accuracy) = &mut run.accuracy {
                accuracy.scale = scale;
            }
            runs.push(run);
        }
    }
    report(runs)
}

fn over_n(accel: &str, n: &[u32]) -> Vec<Run> {
    n.iter().map(|&n| run(accel, Some(n))).collect()
}

/// Four grids with other parameters and two trees.
fn parameters() -> Report {
    let mut runs = Vec::new();
    for (i, overlap) in ["three-test", "sat", "bbox"].iter().enumerate() {
        for mut r in over_n("grid", &N[..15]) {
            r.params = params(&[("overlap-rule", overlap), ("mailbox-kind", "off")]);
            let factor = 1.0 - 0.11 * i as f64;
            scale(&mut r.mrays_per_s, factor);
            scale(&mut r.build_ms, 1.0 / factor);
            if let Some(p) = &mut r.predicted {
                p.n += 4 * i as u32;
                p.plateau[0] += 3 * i as u32;
            }
            runs.push(r);
        }
    }
    runs.extend(["kd-tree", "bvh"].map(|a| run(a, None)));
    report(runs)
}

fn scale(s: &mut Summary, factor: f64) {
    for x in [&mut s.median, &mut s.lo, &mut s.hi] {
        *x *= factor;
    }
}

/// Twelve lines over n and eight without.
fn many() -> Report {
    let mut runs = Vec::new();
    for i in 0..12 {
        for mut r in over_n(&format!("grid-{i}"), &N) {
            scale(&mut r.mrays_per_s, 1.0 + 0.09 * f64::from(i));
            runs.push(r);
        }
    }
    for i in 0..8 {
        runs.push(run(&format!("tree-{i}"), None));
    }
    report(runs)
}

/// Lines that cross twice and end at nearly the same place.
fn crossing() -> Report {
    let mut runs = Vec::new();
    for (k, accel) in ["grid", "grid-skip", "grid-2level", "octree-n"]
        .iter()
        .enumerate()
    {
        for mut r in over_n(accel, &N) {
            let x = f64::from(r.n.unwrap()).log2();
            let y = 6.0 + (x * 0.9 + k as f64).sin() * 3.0 * (8.0 - x) / 8.0;
            r.mrays_per_s = summary(y, 0.12, &format!("{accel}{x}"));
            runs.push(r);
        }
    }
    report(runs)
}

/// The counted work of a run of raylab's own.
fn work(run: &mut Run) -> &mut PerRay {
    run.per_ray.as_mut().expect("counted")
}

/// Everything within one percent.
fn narrow() -> Report {
    let mut report = teapot();
    for (i, r) in report.runs.iter_mut().enumerate() {
        r.mrays_per_s = summary(10.0 + 0.01 * i as f64, 0.002, &r.id);
        r.build_ms = summary(3.0, 0.001, &r.id);
        work(r).steps.mean = 5.0 + 0.001 * i as f64;
    }
    report
}

/// Counts that are zero at places, or everywhere.
fn zeros() -> Report {
    let mut report = teapot();
    for (i, r) in report.runs.iter_mut().enumerate() {
        work(r).tests.mean = 0.0;
        if i % 5 == 0 {
            work(r).steps.mean = 0.0;
            r.build_ms = Summary::default();
        }
    }
    report
}

/// Twenty decades.
fn huge() -> Report {
    let mut report = teapot();
    for (i, r) in report.runs.iter_mut().enumerate() {
        r.mrays_per_s = summary(10.0_f64.powi(i as i32 - 8), 0.3, &r.id);
        work(r).tests.mean = 10.0_f64.powi(2 * i as i32);
        r.memory_bytes = u64::MAX >> (2 * i);
    }
    report
}

/// Values that are absent or no numbers.
fn missing() -> Report {
    let mut report = teapot();
    for (i, r) in report.runs.iter_mut().enumerate() {
        match i % 4 {
            0 => r.mrays_per_s = Summary::default(),
            1 => r.build_ms.median = f64::NAN,
            2 => r.mrays_per_s.lo = f64::NEG_INFINITY,
            _ => work(r).steps.mean = f64::INFINITY,
        }
        r.predicted = None;
        r.valid = i != 3;
    }
    report.provenance = crate::report::Provenance::default();
    report
}

fn long_names() -> Report {
    let scene = "/data/models/architecture/2026-03/a-very-long-folder/sponza <atrium> & \"courtyard\".final.obj";
    let mut runs: Vec<Run> = Vec::new();
    for &n in &N[..13] {
        let mut r = run_of(
            scene,
            262_267,
            "file:/data/rays/bounce-of-sponza-at-noon.rays",
            64,
            "grid",
            Some(n),
        );
        r.params = params(&[
            ("overlap", "a-rule-with-a-long-name"),
            ("traversal", "incremental-in-f64"),
            ("zeta", "0.000001"),
        ]);
        runs.push(r);
    }
    runs.push(run_of(
        scene,
        262_267,
        "file:/data/rays/bounce-of-sponza-at-noon.rays",
        64,
        "bvh",
        None,
    ));
    report(runs)
}

/// Lines that end long before the axis does.
fn short_lines() -> Report {
    let mut runs = over_n("grid", &N);
    runs.extend(over_n("grid-2level", &N[..8]));
    runs.extend(over_n("grid-skip", &N[2..3]));
    runs.push(run("bvh", None));
    report(runs)
}

/// Two scenes, two ray sets, two thread counts.
fn combinations() -> Report {
    let mut runs = Vec::new();
    for (scene, triangles) in [("teapot", 6_320), ("caballito", 148_000)] {
        for rays in ["primary", "random"] {
            for threads in [1, 2] {
                for n in N {
                    runs.push(run_of(scene, triangles, rays, threads, "grid", Some(n)));
                }
                for accel in ["brute", "kd-tree", "bvh"] {
                    runs.push(run_of(scene, triangles, rays, threads, accel, None));
                }
            }
        }
    }
    report(runs)
}
