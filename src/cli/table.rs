//! Runs as a table for people.

use crate::report::Run;

/// One row a run: configuration, speed with its interval, work a ray, build, memory, and whether the answers are right.
pub fn runs(runs: &[Run]) -> String {
    let header = [
        "scene", "accel", "n", "kernel", "rays", "thr", "Mrays/s", "95 %", "steps", "tests",
        "build ms", "MB", "valid",
    ];
    let mut rows: Vec<Vec<String>> = vec![header.map(str::to_owned).to_vec()];
    rows.extend(runs.iter().map(row));
    let widths: Vec<usize> = (0..header.len())
        .map(|column| {
            rows.iter()
                .map(|row| row[column].chars().count())
                .max()
                .unwrap_or(0)
        })
        .collect();
    rows.iter().map(|row| aligned(row, &widths)).collect()
}

fn row(run: &Run) -> Vec<String> {
    let speed = &run.mrays_per_s;
    vec![
        run.scene.clone(),
        run.accel.clone(),
        run.n.map_or_else(|| "-".to_owned(), |n| n.to_string()),
        run.kernel.clone(),
        run.rays.clone(),
        run.threads.to_string(),
        significant(speed.median),
        format!("{}..{}", significant(speed.lo), significant(speed.hi)),
        significant(run.per_ray.steps.mean),
        significant(run.per_ray.tests.mean),
        significant(run.build_ms.median),
        significant(run.memory_bytes as f64 / 1e6),
        match (run.valid, run.kernel_errors) {
            (true, 0) => "yes".to_owned(),
            (true, errors) => format!("yes, {errors} kernel errors"),
            (false, _) => "NO".to_owned(),
        },
    ]
}

/// Words to the left, numbers to the right.
fn aligned(row: &[String], widths: &[usize]) -> String {
    let cells = row
        .iter()
        .zip(widths)
        .enumerate()
        .map(|(column, (cell, &width))| match column {
            0 | 1 | 3 | 4 | 12 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
    let line = cells.collect::<Vec<_>>().join("  ");
    format!("{}\n", line.trim_end())
}

/// Three significant digits, without exponents.
pub fn significant(x: f64) -> String {
    let magnitude = x.abs();
    match magnitude {
        m if m >= 100.0 => format!("{x:.0}"),
        m if m >= 10.0 => format!("{x:.1}"),
        m if m >= 1.0 => format!("{x:.2}"),
        m if m >= 0.001 => format!("{x:.4}"),
        0.0 => "0".to_owned(),
        _ => format!("{x:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_three_digits() {
        let texts = [1234.5, 12.34, 1.2345, 0.01234, 0.0].map(significant);
        assert_eq!(texts, ["1234", "12.3", "1.23", "0.0123", "0"]);
    }

    #[test]
    fn columns_are_aligned() {
        let text = aligned(
            &["a".to_owned(), "bb".to_owned(), "7".to_owned()],
            &[3, 2, 4],
        );
        assert_eq!(text, "a    bb     7\n");
    }
}
