//! Markdown tables that read as text, too.

/// A table whose columns are aligned in plain text; the first row is the head, the first two columns are words.
pub(super) fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells
            .map(|cell| cell.chars().count())
            .max()
            .unwrap_or(0)
            .max(3)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut lines: Vec<String> = rows
        .iter()
        .map(|row| {
            let cells = row.iter().zip(&widths).enumerate();
            line(
                cells
                    .map(|(column, (cell, &width))| match column {
                        0 | 1 => format!("{cell:<width$}"),
                        _ => format!("{cell:>width$}"),
                    })
                    .collect(),
            )
        })
        .collect();
    let rule = widths
        .iter()
        .enumerate()
        .map(|(column, width)| match column {
            0 | 1 => "-".repeat(*width),
            _ => format!("{}:", "-".repeat(width - 1)),
        });
    lines.insert(1.min(lines.len()), line(rule.collect()));
    lines.concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_equally_long() {
        let table = aligned(
            &[["a", "b", "c"], ["long", "x", "1.5"]].map(|row| row.map(str::to_owned).to_vec()),
        );
        let lengths: Vec<usize> = table.lines().map(|line| line.chars().count()).collect();
        assert_eq!(lengths.len(), 3);
        assert!(
            lengths.iter().all(|length| *length == lengths[0]),
            "{table}"
        );
    }
}
