//! The small print of a figure: how it was measured, what its signs mean, on what machine.

use std::collections::BTreeSet;

use crate::report::{Provenance, Run};

use super::canvas::{Anchor, Canvas, Face};
use super::figure::{Kind, MARGIN, quiet_face};
use super::theme::Theme;

/// Pixels an em.
pub(super) const SMALL: f64 = 9.5;
/// From one line to the next.
pub(super) const PITCH: f64 = 12.5;

/// The lines of `note` below a figure, beginning at `top`.
pub(super) fn draw(canvas: &mut Canvas, theme: &Theme, note: &[String], top: f64) {
    let face = Face {
        size: SMALL,
        ..quiet_face(theme)
    };
    for (i, line) in note.iter().enumerate() {
        let y = top + (i as f64 + 0.8) * PITCH;
        canvas.text(line, (MARGIN, y), Anchor::Start, face);
    }
}

/// How it was measured, what the signs mean, and on what machine.
pub(super) fn note(
    runs: &[&Run],
    provenance: &Provenance,
    kind: Kind,
    interval: &str,
    legend: &[&str],
) -> String {
    let mut parts: Vec<String> = vec![match kind {
        Kind::Speed => format!(
            "Median of {} a point; {}: 95 % bootstrap interval of the median.",
            samples(runs.iter().map(|r| r.mrays_per_s.samples.len())),
            interval
        ),
        Kind::Work => {
            "Means over the rays of the set, counted in a separate pass: exact, no interval.".into()
        }
        Kind::Cost => format!(
            "Build time: median of {}; {}: 95 % bootstrap interval. Memory: structure and packed triangles.",
            samples(runs.iter().map(|r| r.build_ms.samples.len())),
            interval
        ),
    }];
    parts.extend(legend.iter().map(|&sentence| sentence.to_owned()));
    let wrong = runs.iter().filter(|run| run.is_broken()).count();
    if wrong > 0 {
        parts.push(format!(
            "Attention: {wrong} of {} runs gave answers that are not valid.",
            runs.len()
        ));
    }
    parts.push(machine(provenance));
    parts.join(" ")
}

/// `9 samples`, `9 to 12 samples`.
fn samples(counts: impl Iterator<Item = usize>) -> String {
    let counts: BTreeSet<usize> = counts.filter(|c| *c > 0).collect();
    match (counts.first(), counts.last()) {
        (Some(1), Some(1)) => "1 sample".to_owned(),
        (Some(least), Some(most)) if least == most => format!("{least} samples"),
        (Some(least), Some(most)) => format!("{least} to {most} samples"),
        _ => "the samples".to_owned(),
    }
}

/// Machine, program and day, as far as they are known.
pub(super) fn machine(p: &Provenance) -> String {
    let commit: String = p.commit.chars().take(7).collect();
    let program = match (commit.as_str(), p.dirty) {
        _ if p.version.is_empty() => "raylab".to_owned(),
        ("", _) => format!("raylab {}", p.version),
        (commit, false) => format!("raylab {} ({commit})", p.version),
        (commit, true) => format!("raylab {} ({commit}, modified)", p.version),
    };
    let day: String = p.date.chars().take(10).collect();
    [
        p.cpu.clone(),
        p.instruction_set.clone(),
        p.os.clone(),
        program,
        day,
    ]
    .into_iter()
    .map(|part| part.trim().to_owned())
    .filter(|part| !part.is_empty())
    .collect::<Vec<_>>()
    .join(", ")
        + "."
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::{report, run};

    #[test]
    fn the_note_says_how_many_samples_and_warns_of_wrong_answers() {
        let mut runs = [run("grid", Some(4)), run("grid", Some(8))];
        runs[1].mrays_per_s.samples.pop();
        runs[1].valid = false;
        let report = report(runs.to_vec());
        let runs: Vec<&Run> = report.runs.iter().collect();
        let text = note(&runs, &report.provenance, Kind::Speed, "band", &["A sign."]);
        for part in [
            "8 to 9 samples",
            "A sign.",
            "1 of 2 runs",
            "Ryzen",
            "raylab 0.1.0 (4cb6f16)",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }
}
