//! Boxes that tell everything known of something, e.g. of one run.

use ratatui::layout::Rect;

use crate::lab::Spread;
use crate::report::Run;
use crate::tui::figures::{figure, mebibytes};
use crate::tui::layout;
use crate::tui::overlay::{Facts, Overlay};
use crate::tui::runs::{RunRow, Status};
use crate::tui::state::State;
use crate::tui::view::wrapped;

/// The greatest first line that still fills the box.
#[must_use]
pub fn last_line(state: &State) -> usize {
    let Some(overlay @ Overlay::Details(facts, _)) = state.overlays.last() else {
        return 0;
    };
    let (width, height) = state.size;
    let body = layout::parts(Rect::new(0, 0, width, height)).body;
    let area = layout::overlay(overlay, body);
    text(facts, (area.width as usize).saturating_sub(2))
        .len()
        .saturating_sub((area.height as usize).saturating_sub(2))
}

/// The lines of the box.
#[must_use]
pub fn text(facts: &Facts, width: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for (name, value) in &facts.rows {
        let mut name = name.as_str();
        for part in wrapped(value, width.saturating_sub(17)) {
            lines.push(format!(" {name:<15}{part}"));
            name = "";
        }
    }
    lines
}

/// Everything known of a run.
#[must_use]
pub fn facts(row: &RunRow) -> Facts {
    let run = &row.run;
    let mut facts = Facts::new("run");
    let mut put = |name: &str, value: String| facts.put(name, value);
    put(
        "scene",
        match run.triangles {
            0 => run.scene.clone(),
            n => format!("{}, {n} triangles", run.scene),
        },
    );
    put("accelerator", row.accel.clone());
    put("grid n", row.n_text());
    put("kernel", row.kernel.clone());
    put("rays", format!("{} {}", run.ray_count, run.rays));
    put("threads", run.threads.to_string());
    put(
        "status",
        match &row.status {
            Status::Failed(why) => format!("failed: {why}"),
            other => other.symbol().1.to_owned(),
        },
    );
    let speed = &run.mrays_per_s;
    if row.mrays_per_s().is_some() {
        put(
            "speed",
            format!(
                "{} Mrays/s, 95 % {} to {}, {} samples",
                figure(speed.median),
                figure(speed.lo),
                figure(speed.hi),
                speed.samples.len()
            ),
        );
    }
    if row.is_built() {
        put("build", format!("{} ms", figure(run.build_ms.median)));
        put(
            "memory",
            format!("{} MiB", figure(mebibytes(run.memory_bytes))),
        );
        if let Some(s) = &run.structure {
            put(
                "structure",
                format!(
                    "{} cells or nodes, {} empty, {} references, depth {}, longest list {}",
                    s.cells, s.empty_cells, s.references, s.depth, s.longest_list
                ),
            );
        }
        if let Some(work) = &run.per_ray {
            put("cells a ray", spread(&work.steps));
            put("  empty", spread(&work.empty_steps));
            put("tests a ray", spread(&work.tests));
            put("  duplicate", spread(&work.duplicate_tests));
        }
        if let Some(p) = &run.predicted {
            put(
                "predicted",
                format!(
                    "best n {} ({} to {} as good), {} cells and {} tests a random line",
                    p.n,
                    p.plateau[0],
                    p.plateau[1],
                    figure(p.steps),
                    figure(p.tests)
                ),
            );
        }
        put("answers", verdict(run));
        put("hits", run.checksum.hits.to_string());
    }
    for warning in &run.warnings {
        put("note", warning.clone());
    }
    put("id", run.id.clone());
    facts
}

/// Whether the answers are right; of a peer, which may err, how many of those that were checked are wrong.
fn verdict(run: &Run) -> String {
    let checked = run.checked_rays;
    if let Some(wrong) = run.wrong_answers {
        return format!("a peer's: {wrong} of {checked} checked rays wrong by exact arithmetic");
    }
    let verdict = if run.valid { "right" } else { "WRONG" };
    format!(
        "{verdict}: {checked} rays checked against brute force, {} where the kernel itself errs",
        run.kernel_errors
    )
}

fn spread(s: &Spread) -> String {
    format!(
        "mean {}, median {}, 99 % {}, most {}",
        figure(s.mean),
        s.p50,
        s.p99,
        s.max
    )
}
