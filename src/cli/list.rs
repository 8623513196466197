//! `raylab list`: prints a registry.

use serde_json::{Value, json};

use crate::accel::ACCELERATORS;
use crate::kernel::KERNELS;
use crate::lab::stability::CASES;
use crate::registry::{ParamKind, ParamSpec};
use crate::report::FORMATS;
use crate::scene::SCENES;
use crate::shade::CHANNELS;
use crate::trace::RAY_SETS;

use super::args::{ListArgs, Registry};
use super::{Failure, print};

/// Prints the registry as a table, or as a JSON array of objects with at least `name`, `about` and `params`.
pub fn run(args: &ListArgs) -> Result<(), Failure> {
    let rows = rows(args.registry);
    if args.json {
        print(&format!("{:#}\n", Value::Array(rows)))
    } else {
        print(&rows.iter().map(describe).collect::<String>())
    }
}

fn rows(registry: Registry) -> Vec<Value> {
    match registry {
        Registry::Accels => ACCELERATORS
            .iter()
            .map(|a| {
                let mut row = with_params(json!(a), a.params);
                row["has_n"] = json!(a.resolution.is_some());
                let standing = a.standing();
                row["peer"] = json!(standing.peer);
                row["available"] = json!(standing.available);
                row["unavailable_because"] = json!(standing.unavailable_because);
                row["own_test"] = json!(standing.own_test);
                row
            })
            .collect(),
        Registry::Kernels => KERNELS
            .iter()
            .map(|k| with_params(json!(k), k.params))
            .collect(),
        Registry::Scenes => SCENES
            .iter()
            .map(|s| with_params(json!(s), s.params))
            .collect(),
        Registry::Channels => CHANNELS
            .iter()
            .map(|c| json!({ "name": c.name, "about": c.about, "params": [] }))
            .collect(),
        Registry::Cases => CASES
            .iter()
            .map(|c| with_params(json!(c), c.params))
            .collect(),
        Registry::Formats => FORMATS
            .iter()
            .map(|f| json!({ "name": f.name, "about": f.about, "params": [] }))
            .collect(),
        Registry::Rays => RAY_SETS
            .iter()
            .map(|r| with_params(json!(r), r.params))
            .collect(),
    }
}

/// `row` with its parameters in the form that all registries share.
fn with_params(mut row: Value, specs: &[ParamSpec]) -> Value {
    row["params"] = params(specs);
    row
}

/// Parameters as objects with `name`, `about`, `default` and what they accept.
fn params(specs: &[ParamSpec]) -> Value {
    specs
        .iter()
        .map(|spec| {
            let mut row =
                json!({ "name": spec.name, "about": spec.about, "default": spec.default });
            match spec.kind {
                ParamKind::Choice(words) => row["choices"] = json!(words),
                ParamKind::Int { min, max } => row["range"] = json!([min, max]),
                ParamKind::Float { min, max } => row["range"] = json!([min, max]),
            }
            row
        })
        .collect()
}

/// A row as text: name and sentence, then each parameter on a line of its own.
fn describe(row: &Value) -> String {
    let text = |key: &str| row[key].as_str().unwrap_or_default();
    let name = match text("size") {
        "" => text("name").to_owned(),
        size => format!("{}:{size}", text("name")),
    };
    let mark = match row["control"].as_bool() {
        Some(true) => "(control) ",
        _ => "",
    };
    let mut lines = vec![format!("{name:<22} {mark}{}", text("about"))];
    if !text("paper").is_empty() {
        lines.push(format!("{:<22}   {}", "", text("paper")));
    }
    if !text("own_test").is_empty() {
        lines.push(format!(
            "{:<22}   hits are decided by its own test, here {}, not by the kernel",
            "",
            text("own_test")
        ));
    }
    if !text("unavailable_because").is_empty() {
        lines.push(format!(
            "{:<22}   not available: {}",
            "",
            text("unavailable_because")
        ));
    }
    for param in row["params"].as_array().into_iter().flatten() {
        let accepts = match (&param["choices"], &param["range"]) {
            (Value::Array(words), _) => {
                let words: Vec<&str> = words.iter().filter_map(Value::as_str).collect();
                words.join("|")
            }
            (_, Value::Array(range)) => format!("{}..{}", range[0], range[1]),
            _ => String::new(),
        };
        let part = |key: &str| param[key].as_str().unwrap_or_default();
        lines.push(format!(
            "{:<22}   {}={accepts} [default: {}]: {}",
            "",
            part("name"),
            part("default"),
            part("about"),
        ));
    }
    lines.join("\n") + "\n"
}
