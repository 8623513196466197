//! Reports that look measured, for tests of what is made from reports. Deterministic: no clock, no random source.

use crate::accel::{Prediction, StructureStats};
use crate::lab::{
    Accuracy, Budget, Checksum, ErrorSpread, NRule, PerRay, Plan, Spread, StopReason,
};
use crate::registry::Params;
use crate::stats::Summary;

use super::{Provenance, Report, Run, SceneFacts};

/// Parameters from written pairs; numbers become numbers.
pub fn params(pairs: &[(&str, &str)]) -> Params {
    let object: serde_json::Map<String, serde_json::Value> = pairs
        .iter()
        .map(|(key, value)| {
            let value = serde_json::from_str(value).unwrap_or_else(|_| (*value).into());
            ((*key).to_owned(), value)
        })
        .collect();
    serde_json::from_value(object.into()).unwrap()
}

/// A number in 0..1 that looks random, the same for the same words.
fn noise(words: &str) -> f64 {
    let hash = words.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |h, b| {
        (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3)
    });
    (hash.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Median and interval around `centre`, as far apart as `relative`.
pub fn summary(centre: f64, relative: f64, words: &str) -> Summary {
    let samples: Vec<f64> = (0..9)
        .map(|i| centre * (1.0 + relative * (noise(&format!("{words}/{i}")) - 0.5) * 2.0))
        .collect();
    let mut sorted = samples.clone();
    sorted.sort_by(f64::total_cmp);
    Summary {
        median: sorted[4],
        lo: sorted[2],
        hi: sorted[6],
        samples,
    }
}

fn spread(mean: f64) -> Spread {
    Spread {
        mean,
        p50: (mean * 0.9) as u64,
        p99: (mean * 4.0) as u64,
        max: (mean * 9.0) as u64,
    }
}

/// A run over the teapot with `woop`, whose figures follow simple cost models of the field.
pub fn run(accel: &str, n: Option<u32>) -> Run {
    run_of("teapot", 6_320, "primary", 1, accel, n)
}

/// A run with the given configuration.
pub fn run_of(
    scene: &str,
    triangles: u64,
    rays: &str,
    threads: usize,
    accel: &str,
    n: Option<u32>,
) -> Run {
    let words = format!("{scene}/{rays}/{threads}/{accel}/{n:?}");
    let count = triangles as f64;
    let model = match (accel, n) {
        ("brute", _) => Model {
            steps: 1.0,
            tests: count,
            build: 0.02,
            bytes: 48.0 * count,
        },
        (_, Some(n)) => grid_model(count, f64::from(n), 0.8 + 0.5 * noise(accel)),
        (name, None) => tree_model(count, 0.7 + 0.9 * noise(name)),
    };
    let nanoseconds = 18.0 + 3.1 * model.steps + 4.4 * model.tests;
    let speed = 1e3 / nanoseconds * threads as f64 * if rays == "random" { 0.7 } else { 1.0 };
    Run {
        id: format!("{:016x}", (noise(&words) * 1.8e19) as u64),
        scene: scene.to_owned(),
        triangles,
        accel: accel.to_owned(),
        params: Params::default(),
        n,
        kernel: "woop".to_owned(),
        beside_kernel: None,
        rays: rays.to_owned(),
        ray_count: 262_144,
        threads,
        build_ms: summary(model.build, 0.08, &format!("{words}/build")),
        memory_bytes: model.bytes as u64,
        mrays_per_s: summary(speed, 0.05, &words),
        stopped_by: StopReason::Interval,
        per_ray: Some(PerRay {
            steps: spread(model.steps),
            empty_steps: spread(model.steps * 0.6),
            tests: spread(model.tests),
            duplicate_tests: spread(model.tests * 0.1),
        }),
        structure: Some(StructureStats {
            cells: n.map_or(1, |n| u64::from(n).pow(3)),
            dims: n.map(|n| [n; 3]),
            ..StructureStats::default()
        }),
        predicted: n.map(|n| predicted(count, f64::from(n))),
        checksum: Checksum {
            hits: 171_023,
            id_sum: 12_345_678,
            t_sum: 1_234.5,
        },
        valid: true,
        checked_rays: 4_096,
        kernel_errors: 0,
        wrong_answers: None,
        sweep: None,
        accuracy: None,
        warnings: Vec::new(),
    }
}

struct Model {
    steps: f64,
    tests: f64,
    build: f64,
    bytes: f64,
}

fn grid_model(count: f64, n: f64, factor: f64) -> Model {
    let references = count + 14.0 * n * count.sqrt() * factor + 1.5 * n * n;
    Model {
        steps: 0.45 + 0.55 * n,
        tests: (references / (n * n)).min(count) * factor + 0.6,
        build: 0.4 + references * 4e-5 + n.powi(3) * 4e-6,
        bytes: 48.0 * count + 4.0 * references + 4.0 * n.powi(3),
    }
}

fn tree_model(count: f64, factor: f64) -> Model {
    Model {
        steps: 2.1 * count.log2() * factor,
        tests: 3.2 * factor,
        build: count * count.log2() * 1.3e-4 * factor,
        bytes: 110.0 * count * factor,
    }
}

fn predicted(count: f64, n: f64) -> Prediction {
    let model = grid_model(count, n, 1.0);
    Prediction {
        n: 30,
        plateau: [22, 41],
        references: count,
        steps: n,
        tests: model.tests * 0.94,
    }
}

/// The n of `sweep --n 1..256`, about two an octave.
pub const N: [u32; 17] = [
    1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64, 91, 128, 181, 200, 256,
];

/// A report of `runs`.
pub fn report(runs: Vec<Run>) -> Report {
    Report {
        schema: Report::SCHEMA.to_owned(),
        judged: None,
        provenance: Provenance {
            version: "0.1.0".to_owned(),
            commit: "4cb6f16d0c1d".to_owned(),
            rustc: "1.95.0".to_owned(),
            target: "x86_64-unknown-linux-gnu".to_owned(),
            profile: "release".to_owned(),
            cpu: "AMD Ryzen 9 7950X 16-Core Processor".to_owned(),
            cores: 32,
            caches: vec![32 << 10, 1 << 20, 32 << 20],
            instruction_set: "avx2".to_owned(),
            os: "Linux 6.12".to_owned(),
            load: 0.12,
            date: "2026-03-01T12:00:00Z".to_owned(),
            command: ["raylab", "sweep", "--scene", "teapot"]
                .map(str::to_owned)
                .to_vec(),
            seed: 1,
            scenes: vec![SceneFacts {
                name: "teapot".to_owned(),
                hash: "9f86d081884c7d659a2feaa0c55ad015".to_owned(),
                triangles: 6_320,
                degenerate: 0,
            }],
            ..Provenance::default()
        },
        config: Plan {
            scenes: vec!["teapot".to_owned()],
            accels: Vec::new(),
            n: vec![NRule::Fixed(8), NRule::Auto],
            kernels: Vec::new(),
            rays: vec!["primary".to_owned()],
            threads: vec![1],
            ray_count: 262_144,
            seed: 1,
            budget: Budget {
                sample_seconds: 0.02,
                min_samples: 5,
                max_samples: 50,
                relative_half_width: 0.02,
                run_seconds: 2.0,
                checked_rays: 4_096,
                whole_sets: false,
            },
            memory_limit: 1 << 32,
        },
        runs,
    }
}

/// The everyday case: one grid over all n beside three accelerators without one.
pub fn teapot() -> Report {
    let mut runs: Vec<Run> = N.iter().map(|&n| run("grid", Some(n))).collect();
    runs.extend(["brute", "kd-tree", "bvh"].map(|accel| run(accel, None)));
    report(runs)
}

/// Three accelerators over four sizes of a soup and three of a sphereflake.
pub fn growing() -> Vec<Run> {
    let scenes = [
        ("soup:1000", 1_000),
        ("soup:10000", 10_000),
        ("soup:100000", 100_000),
        ("soup:1000000", 1_000_000),
        ("sphereflake:1", 12_802),
        ("sphereflake:2", 116_482),
        ("sphereflake:4", 928_000),
    ];
    let mut runs = Vec::new();
    for (scene, triangles) in scenes {
        for (accel, n) in [("grid", Some(32)), ("kd-tree", None), ("bvh", None)] {
            runs.push(run_of(scene, triangles, "primary", 1, accel, n));
        }
    }
    runs
}

/// A run that was judged: `wrong` of 65,536 edge rays, half of them leaks, at this speed.
pub fn judged(kernel: &str, offset: f64, speed: f64, wrong: u64) -> Run {
    let words = format!("{kernel}/{offset}");
    Run {
        id: format!("{:012x}", (noise(&words) * 2.8e14) as u64),
        kernel: kernel.to_owned(),
        ray_count: 65_536,
        mrays_per_s: summary(speed, 0.03, &words),
        accuracy: Some(Accuracy {
            offset,
            rays: 65_536,
            leaks: wrong / 2,
            wrong_surface: wrong - wrong / 2,
            t_ulp: ErrorSpread {
                p50: 0.4,
                p99: 2.0 + wrong as f64,
                max: 9.0 + 3.0 * wrong as f64,
            },
            ..Accuracy::default()
        }),
        ..run_of("teapot", 6_320, "edge", 1, "bvh", None)
    }
}
