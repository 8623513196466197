//! Rays that are written, traced and inspected.

use std::fs;

use serde_json::Value;

use super::succeed;

#[test]
fn a_ray_set_is_written_and_traced_alike_by_every_accelerator() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    let dir = dir.path();
    succeed(
        dir,
        &[
            "rays",
            "teapot:4",
            "--rays",
            "bounce",
            "--rays-count",
            "2000",
            "--out",
            "b.rays",
            "--quiet",
        ],
    );
    assert_eq!(
        fs::metadata(dir.join("b.rays")).expect("written").len() % 32,
        0
    );
    let mut answers = Vec::new();
    for accel in ["brute", "grid", "kd-tree", "octree", "bsp-tree", "bvh"] {
        let args = [
            "trace",
            "teapot:4",
            "--rays-file",
            "b.rays",
            "--hits",
            "b.hits",
            "--accel",
            accel,
            "--json",
        ];
        let result: Value = serde_json::from_str(&succeed(dir, &args)).expect("JSON");
        assert!(
            result["mrays_per_s"]["median"]
                .as_f64()
                .is_some_and(|m| m > 0.0),
            "{result}"
        );
        assert!(
            result["mrays_per_s"]["samples"]
                .as_array()
                .is_some_and(|s| !s.is_empty())
        );
        assert_eq!(result["accel"], accel);
        answers.push((
            result["hits"].as_u64(),
            fs::read(dir.join("b.hits")).expect("written"),
        ));
    }
    assert!(answers[0].0.is_some_and(|hits| hits > 0));
    assert!(
        answers.iter().all(|a| *a == answers[0]),
        "accelerators differ"
    );

    let blocked = [
        "trace",
        "teapot:4",
        "--rays-file",
        "b.rays",
        "--hits",
        "o.hits",
        "--occluded",
        "--json",
        "--quiet",
    ];
    let result: Value = serde_json::from_str(&succeed(dir, &blocked)).expect("JSON");
    assert_eq!(
        result["hits"].as_u64(),
        answers[0].0,
        "occlusion differs from closest hit"
    );
}

#[test]
fn every_accelerator_is_inspected_to_the_answer_that_trace_gives() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    let dir = dir.path();
    // Twelve rays are a picture of 4 × 3.
    let rays = [
        "rays",
        "teapot:4",
        "--rays",
        "primary",
        "--rays-count",
        "12",
        "--out",
        "p.rays",
        "--quiet",
    ];
    succeed(dir, &rays);
    let trace = [
        "trace",
        "teapot:4",
        "--rays-file",
        "p.rays",
        "--hits",
        "p.hits",
        "--quiet",
    ];
    succeed(dir, &trace);
    let read = |file: &str, at: usize| {
        let bytes = fs::read(dir.join(file)).expect("written");
        <[u8; 4]>::try_from(&bytes[4 * at..4 * at + 4]).expect("four bytes")
    };
    let rays: Vec<f32> = (0..96)
        .map(|i| f32::from_le_bytes(read("p.rays", i)))
        .collect();
    let float = |value: &Value| value.as_f64().expect("a number") as f32;
    let pixels = ["1,1", "2,1"];
    for (accel, kind) in [
        ("brute", "leaf"),
        ("grid", "cell"),
        ("kd-tree", "node"),
        ("octree", "node"),
        ("bsp-tree", "node"),
        ("bvh", "node"),
    ] {
        for pixel in pixels {
            let args = [
                "inspect", "teapot:4", "--pixel", pixel, "--size", "4x3", "--accel", accel,
                "--json",
            ];
            let seen: Value = serde_json::from_str(&succeed(dir, &args)).expect("JSON");
            let dir_of_ray: Vec<f32> = (0..3).map(|a| float(&seen["ray"]["dir"][a])).collect();
            let ray = (0..12)
                .find(|i| rays[8 * i + 4..8 * i + 7] == dir_of_ray)
                .expect("the pixel's ray is in the set");
            let prim = u32::from_le_bytes(read("p.hits", 2 * ray));
            let t = f32::from_le_bytes(read("p.hits", 2 * ray + 1));
            assert_eq!(seen["hit"]["prim"], prim, "{accel}: {seen}");
            assert_eq!(float(&seen["hit"]["t"]).to_bits(), t.to_bits(), "{accel}");
            assert_eq!(seen["right"], true);
            assert_eq!(seen["accel"], accel);
            assert_eq!(seen["ray"]["t_max"], Value::Null, "infinite");
            let steps = seen["steps"].as_array().expect("steps");
            assert_eq!(steps[0]["kind"], kind, "{accel}");
            assert_eq!(steps[0]["bounds"].is_null(), accel == "brute");
            let mut tests = steps
                .iter()
                .flat_map(|s| s["tests"].as_array().expect("tests"));
            let nearest = tests.rfind(|test| test["outcome"] == "nearest");
            assert_eq!(nearest.expect("a hit")["prim"], prim);
        }
    }
}

#[test]
fn an_inspected_ray_is_a_table_that_ends_in_its_answer() {
    let dir = tempfile::tempdir().expect("a folder can be made");
    let args = [
        "inspect",
        "plane:2",
        "--origin",
        "0.3,0.2,5",
        "--dir",
        "0,0,-1",
        "--accel",
        "grid",
        "--n",
        "4",
    ];
    let text = succeed(dir.path(), &args);
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].starts_with("plane:2: grid n=4, woop"), "{text}");
    assert!(
        lines[3].contains("entry t") && lines[4].contains("cell"),
        "{text}"
    );
    let last = lines.last().expect("an answer");
    assert!(
        last.contains("triangle") && last.contains("right by exact arithmetic"),
        "{text}"
    );

    let away = [
        "inspect",
        "plane:2",
        "--accel",
        "bvh",
        "--origin",
        "0.3,0.2,5",
        "--dir",
        "0,0,1",
    ];
    let text = succeed(dir.path(), &away);
    assert!(
        text.ends_with("steps 0, tests 0, skipped 0: a miss; right by exact arithmetic\n"),
        "{text}"
    );
}
