//! Comma-separated values: one line a run, all figures, units in the names of the columns (RFC 4180).

use crate::accel::StructureStats;
use crate::lab::PerRay;

use super::series::{accel_label, kernel_label};
use super::{Accuracy, ErrorSpread, Fallbacks, Rate, Report, Run};

/// Name of a column and what a run has there.
type Column = (&'static str, fn(&Run) -> String);

const COLUMNS: &[Column] = &[
    ("id", |r| r.id.clone()),
    ("scene", |r| r.scene.clone()),
    ("triangles", |r| r.triangles.to_string()),
    ("accel", |r| r.accel.clone()),
    ("accel_with_params", accel_label),
    ("n", |r| r.n.map(|n| n.to_string()).unwrap_or_default()),
    ("kernel", |r| r.kernel.clone()),
    ("kernel_with_params", kernel_label),
    ("beside_kernel", |r| {
        r.beside_kernel.clone().unwrap_or_default()
    }),
    ("params", |r| {
        let pairs: Vec<String> = r.params.iter().map(|(k, v)| format!("{k}={v}")).collect();
        pairs.join(";")
    }),
    ("rays", |r| r.rays.clone()),
    ("ray_count", |r| r.ray_count.to_string()),
    ("threads", |r| r.threads.to_string()),
    ("mrays_per_s", |r| real(r.mrays_per_s.median)),
    ("mrays_per_s_lo", |r| real(r.mrays_per_s.lo)),
    ("mrays_per_s_hi", |r| real(r.mrays_per_s.hi)),
    ("mrays_per_s_samples", |r| {
        r.mrays_per_s.samples.len().to_string()
    }),
    ("build_ms", |r| real(r.build_ms.median)),
    ("build_ms_lo", |r| real(r.build_ms.lo)),
    ("build_ms_hi", |r| real(r.build_ms.hi)),
    ("build_ms_samples", |r| r.build_ms.samples.len().to_string()),
    ("memory_bytes", |r| r.memory_bytes.to_string()),
    ("steps_mean", |r| counted(r, |w| real(w.steps.mean))),
    ("steps_p50", |r| counted(r, |w| w.steps.p50.to_string())),
    ("steps_p99", |r| counted(r, |w| w.steps.p99.to_string())),
    ("steps_max", |r| counted(r, |w| w.steps.max.to_string())),
    ("empty_steps_mean", |r| {
        counted(r, |w| real(w.empty_steps.mean))
    }),
    ("tests_mean", |r| counted(r, |w| real(w.tests.mean))),
    ("tests_p50", |r| counted(r, |w| w.tests.p50.to_string())),
    ("tests_p99", |r| counted(r, |w| w.tests.p99.to_string())),
    ("tests_max", |r| counted(r, |w| w.tests.max.to_string())),
    ("duplicate_tests_mean", |r| {
        counted(r, |w| real(w.duplicate_tests.mean))
    }),
    ("cells", |r| shape(r, |s| s.cells.to_string())),
    ("empty_cells", |r| shape(r, |s| s.empty_cells.to_string())),
    ("references", |r| shape(r, |s| s.references.to_string())),
    ("depth", |r| shape(r, |s| s.depth.to_string())),
    ("longest_list", |r| shape(r, |s| s.longest_list.to_string())),
    ("predicted_n", |r| {
        r.predicted.map(|p| p.n.to_string()).unwrap_or_default()
    }),
    ("predicted_n_least", |r| {
        r.predicted
            .map(|p| p.plateau[0].to_string())
            .unwrap_or_default()
    }),
    ("predicted_n_most", |r| {
        r.predicted
            .map(|p| p.plateau[1].to_string())
            .unwrap_or_default()
    }),
    ("predicted_references", |r| {
        r.predicted.map(|p| real(p.references)).unwrap_or_default()
    }),
    ("predicted_steps", |r| {
        r.predicted.map(|p| real(p.steps)).unwrap_or_default()
    }),
    ("predicted_tests", |r| {
        r.predicted.map(|p| real(p.tests)).unwrap_or_default()
    }),
    ("hits", |r| r.checksum.hits.to_string()),
    ("id_sum", |r| r.checksum.id_sum.to_string()),
    ("t_sum", |r| real(r.checksum.t_sum)),
    ("valid", |r| r.valid.to_string()),
    ("checked_rays", |r| r.checked_rays.to_string()),
    ("kernel_errors", |r| r.kernel_errors.to_string()),
    ("wrong_answers", |r| {
        r.wrong_answers.map(|n| n.to_string()).unwrap_or_default()
    }),
    ("offset", |r| judged(r, |a| a.offset.to_string())),
    ("scale", |r| judged(r, |a| a.scale.to_string())),
    ("judged_rays", |r| judged(r, |a| a.rays.to_string())),
    ("leaks", |r| judged(r, |a| a.leaks.to_string())),
    ("phantoms", |r| judged(r, |a| a.phantoms.to_string())),
    ("wrong_surface", |r| {
        judged(r, |a| a.wrong_surface.to_string())
    }),
    ("neighbour_swaps", |r| {
        judged(r, |a| a.neighbour_swaps.to_string())
    }),
    ("occlusion_disagreements", |r| {
        judged(r, |a| a.occlusion_disagreements.to_string())
    }),
    ("t_ulp_p50", |r| judged(r, |a| real(a.t_ulp.p50))),
    ("t_ulp_p99", |r| judged(r, |a| real(a.t_ulp.p99))),
    ("t_ulp_max", |r| judged(r, |a| real(a.t_ulp.max))),
    ("ties", |r| judged(r, |a| a.ties.to_string())),
    ("plane_p50", |r| judged(r, |a| spread(a.plane, |s| s.p50))),
    ("plane_p99", |r| judged(r, |a| spread(a.plane, |s| s.p99))),
    ("plane_max", |r| judged(r, |a| spread(a.plane, |s| s.max))),
    ("barycentric_p50", |r| {
        judged(r, |a| spread(a.barycentric, |s| s.p50))
    }),
    ("barycentric_p99", |r| {
        judged(r, |a| spread(a.barycentric, |s| s.p99))
    }),
    ("barycentric_max", |r| {
        judged(r, |a| spread(a.barycentric, |s| s.max))
    }),
    ("self_hits_naive", |r| judged(r, |a| self_hits(a, 0))),
    ("self_hits_normal", |r| judged(r, |a| self_hits(a, 1))),
    ("self_hits_t_min", |r| judged(r, |a| self_hits(a, 2))),
    ("self_hits_integer", |r| judged(r, |a| self_hits(a, 3))),
    ("self_hits_error_bound", |r| judged(r, |a| self_hits(a, 4))),
    ("vertex_rotation", |r| {
        judged(r, |a| share(a.vertex_rotation))
    }),
    ("translation", |r| judged(r, |a| share(a.translation))),
    ("decided_in_f64", |r| {
        judged(r, |a| of_tests(a.fallbacks, |f| f.f64))
    }),
    ("decided_on_integers", |r| {
        judged(r, |a| of_tests(a.fallbacks, |f| f.integers))
    }),
    ("warnings", |r| r.warnings.join("; ")),
];

/// All runs of `report`; numbers are written so that reading them gives the same f64, what is not finite is empty.
pub(super) fn table(report: &Report) -> String {
    let head: Vec<&str> = COLUMNS.iter().map(|(name, _)| *name).collect();
    let mut text = head.join(",") + "\r\n";
    for run in &report.runs {
        let cells: Vec<String> = COLUMNS.iter().map(|(_, cell)| quoted(&cell(run))).collect();
        text.push_str(&cells.join(","));
        text.push_str("\r\n");
    }
    text
}

/// A count of work; empty where none was counted.
fn counted(run: &Run, figure: fn(&PerRay) -> String) -> String {
    run.per_ray.as_ref().map(figure).unwrap_or_default()
}

/// A figure of the structure; empty where a peer tells nothing.
fn shape(run: &Run, figure: fn(&StructureStats) -> String) -> String {
    run.structure.as_ref().map(figure).unwrap_or_default()
}

/// A figure of the oracle's; empty where the run was not judged.
fn judged(run: &Run, figure: fn(&Accuracy) -> String) -> String {
    run.accuracy.as_ref().map(figure).unwrap_or_default()
}

fn spread(spread: Option<ErrorSpread>, figure: fn(&ErrorSpread) -> f64) -> String {
    spread.as_ref().map(|s| real(figure(s))).unwrap_or_default()
}

/// The rate of self-hits by the rule of this index.
fn self_hits(accuracy: &Accuracy, rule: usize) -> String {
    share(accuracy.self_hits.map(|rules| rules[rule].rate))
}

fn of_tests(fallbacks: Option<Fallbacks>, count: fn(Fallbacks) -> u64) -> String {
    let share = |f: Fallbacks| real(count(f) as f64 / f.tests.max(1) as f64);
    fallbacks.map(share).unwrap_or_default()
}

fn share(rate: Option<Rate>) -> String {
    rate.map(|rate| real(rate.share())).unwrap_or_default()
}

fn real(x: f64) -> String {
    if x.is_finite() {
        x.to_string()
    } else {
        String::new()
    }
}

fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\r', '\n']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::{report, run, teapot};

    #[test]
    fn every_run_has_one_line_with_every_column() {
        let report = teapot();
        let text = table(&report);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), report.runs.len() + 1);
        for line in lines {
            assert_eq!(line.split(',').count(), COLUMNS.len());
        }
    }

    #[test]
    fn a_number_reads_back_as_itself_and_no_number_is_empty() {
        let mut one = run("grid", Some(3));
        one.mrays_per_s.median = 0.1 + 0.2;
        one.build_ms.median = f64::NAN;
        let text = table(&report(vec![one]));
        let (head, row) = text.split_once("\r\n").unwrap();
        let at = |name| head.split(',').position(|c| c == name).unwrap();
        let cells: Vec<&str> = row.trim_end().split(',').collect();
        assert_eq!(cells[at("mrays_per_s")].parse(), Ok(0.1 + 0.2));
        assert_eq!(cells[at("build_ms")], "");
    }

    #[test]
    fn commas_and_quotes_are_quoted() {
        assert_eq!(quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
    }
}
