//! Tables in Markdown (GitHub's dialect): the fastest run of each accelerator, then what a reader must know.

use super::Report;
use super::judged::courses;
use super::scaling;
use super::series::panels;
use super::table::{self, Table, WORDS};

/// The page.
pub(super) fn page(report: &Report) -> String {
    let mut text = vec!["# raylab report\n".to_owned()];
    for key in panels(&report.runs) {
        let runs = table::runs(report, &key);
        let fastest = table::table(&table::fastest(&runs), &runs);
        text.push(format!("\n## {}\n\n", escaped(&key.to_string())));
        text.push("The fastest run of each accelerator.\n\n".to_owned());
        text.push(tabulated(&fastest));
    }
    let growths = scaling::growths(&report.runs);
    for setting in scaling::settings(&report.runs) {
        let title = escaped(&setting.to_string());
        text.push(format!("\n## How costs grow with triangles: {title}\n\n"));
        text.push(format!("{}\n\n", scaling::table::WORDS));
        text.push(tabulated(&scaling::table::table(&growths, &setting)));
    }
    for course in courses(&report.runs) {
        let title = escaped(&course.to_string());
        text.push(format!("\n## Accuracy beside speed: {title}\n\n"));
        text.push(tabulated(&table::accuracy(report, &course)));
        text.push("\n".to_owned());
        text.push(tabulated(&table::errors(report, &course)));
    }
    let warnings = table::warnings(report);
    if !warnings.is_empty() {
        text.push("\n## Warnings\n\n".to_owned());
        for (who, what) in warnings {
            text.push(format!("- {}: {}\n", escaped(&who), escaped(&what)));
        }
    }
    text.push("\n## How it was measured\n\n".to_owned());
    for sentence in table::method(report) {
        text.push(format!("- {}\n", escaped(&sentence)));
    }
    text.push("\n## Provenance\n\n".to_owned());
    for (name, value) in table::provenance(report) {
        text.push(format!("- {name}: {}\n", escaped(&value)));
    }
    let scenes = table::scenes(report);
    if !scenes.rows.is_empty() {
        text.push("\n".to_owned());
        text.push(tabulated(&scenes));
    }
    text.concat()
}

/// `table` in Markdown.
pub(super) fn tabulated(table: &Table) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut text = vec![line(table.head.iter().map(|&h| h.to_owned()).collect())];
    let rule = (0..table.head.len()).map(|i| if i < WORDS { "---" } else { "---:" }.to_owned());
    text.push(line(rule.collect()));
    for row in &table.rows {
        text.push(line(row.iter().map(|cell| escaped(cell)).collect()));
    }
    text.concat()
}

/// `text` on one line, its markup taken as letters.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '\\' | '`' | '*' | '_' | '|' | '<' | '>' | '[' | ']' => {
                out.push('\\');
                out.push(c);
            }
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::{report, run, teapot};

    #[test]
    fn the_fastest_run_of_each_accelerator_stands_in_order() {
        let page = page(&teapot());
        let at = |name: &str| page.find(&format!("\n| {name} |")).unwrap();
        assert!(at("kd-tree") < at("bvh") && at("bvh") < at("grid") && at("grid") < at("brute"));
        assert!(page.contains("| grid | 64 | 4.17 |"), "{page}");
    }

    #[test]
    fn rows_are_as_long_as_the_head_and_names_cannot_break_them() {
        let mut one = run("grid", Some(4));
        one.accel = "a|b\n*c*".to_owned();
        let page = page(&report(vec![one]));
        let row = page.lines().find(|l| l.contains("a\\|b")).unwrap();
        let bars = row.replace("\\|", "").matches('|').count();
        let head = page
            .lines()
            .find(|l| l.starts_with("| accelerator"))
            .unwrap();
        assert_eq!(bars, head.matches('|').count());
    }

    #[test]
    fn wrong_answers_and_warnings_are_named() {
        let mut one = run("grid", Some(4));
        one.valid = false;
        one.warnings.push("load above 1".to_owned());
        let page = page(&report(vec![one]));
        assert!(page.contains("wrong answers") && page.contains("load above 1"));
    }
}
