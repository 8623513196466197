//! One self-contained page: figures, tables, provenance, warnings. It opens without a network and follows the reader's
//! preference for light or dark.

use super::judged::{Course, courses, drifts, places, tuned};
use super::plot::text::{css, escape};
use super::plot::{self, Kind, Subject};
use super::scaling;
use super::series::panels;
use super::table::{self, Table, WORDS};
use super::{ExportError, Report};

/// Colours are those of the figures, so a figure has no visible edge.
const STYLE: &str = "\
:root{color-scheme:light dark;--ground:#fff;--ink:#1b1f24;--muted:#5b636d;--rule:#e7e9ec}\
@media (prefers-color-scheme:dark){:root{--ground:#0f1318;--ink:#e8ecf0;--muted:#9ca6b0;--rule:#252b33}}\
body{margin:2rem auto;padding:0 1rem;max-width:60rem;background:var(--ground);color:var(--ink);\
font:15px/1.5 Inter,system-ui,Helvetica,Arial,sans-serif}\
h1{font-size:1.6rem}h2{font-size:1.2rem;margin-top:3rem;border-top:1px solid var(--rule);padding-top:1rem}\
svg{display:block;max-width:100%;height:auto;margin:1.2rem 0}\
.wide{overflow-x:auto}\
table{border-collapse:collapse;font-size:.87rem;font-variant-numeric:tabular-nums;margin:.6rem 0}\
th,td{padding:.22rem .7rem;border-bottom:1px solid var(--rule);text-align:right;white-space:nowrap}\
th{color:var(--muted);font-weight:600}th.w,td.w{text-align:left;padding-left:0}\
summary{cursor:pointer;color:var(--muted)}\
dl{display:grid;grid-template-columns:max-content 1fr;gap:.15rem 1.2rem;font-size:.87rem}\
dt{color:var(--muted)}dd{margin:0;overflow-wrap:anywhere}\
ul{padding-left:1.1rem}a{color:inherit}nav ul{columns:2}";

/// The page.
///
/// # Errors
/// A figure that cannot be drawn.
pub(super) fn page(report: &Report) -> Result<String, ExportError> {
    let keys = panels(&report.runs);
    let scenes: Vec<&str> = report.config.scenes.iter().map(String::as_str).collect();
    let title = escape(&format!("raylab: {}", scenes.join(", ")));
    let mut html = vec![format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>{}{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n",
        css()
    )];
    html.push(warnings(report));
    if keys.len() > 1 {
        html.push("<nav><ul>\n".to_owned());
        for (i, key) in keys.iter().enumerate() {
            let name = escape(&key.to_string());
            html.push(format!("<li><a href=\"#p{i}\">{name}</a></li>\n"));
        }
        html.push("</ul></nav>\n".to_owned());
    }
    html.extend(plot::svg(report, &Subject::Overview)?);
    let growths = scaling::growths(&report.runs);
    for setting in scaling::settings(&report.runs) {
        let title = escape(&setting.to_string());
        html.push(format!("<h2>How costs grow with triangles: {title}</h2>\n"));
        html.extend(plot::svg(report, &Subject::Scaling(setting.clone()))?);
        html.push(tabulated(&scaling::table::table(&growths, &setting)));
        html.push(format!(
            "<p>{}</p>\n",
            scaling::table::WORDS.replace('*', "")
        ));
    }
    for course in courses(&report.runs) {
        html.push(accuracy(report, &course)?);
    }
    if report.runs.is_empty() {
        html.push("<p>No runs.</p>\n".to_owned());
    }
    for (i, key) in keys.iter().enumerate() {
        html.push(format!(
            "<h2 id=\"p{i}\">{}</h2>\n",
            escape(&key.to_string())
        ));
        for kind in Kind::ALL {
            let subject = Subject::One(key.clone(), kind);
            html.extend(plot::svg(report, &subject)?);
        }
        let runs = table::runs(report, key);
        html.push("<h3>The fastest run of each accelerator</h3>\n".to_owned());
        html.push(tabulated(&table::table(&table::fastest(&runs), &runs)));
        html.push(format!(
            "<details><summary>All {} runs</summary>\n",
            runs.len()
        ));
        html.push(tabulated(&table::table(&runs, &runs)));
        html.push("</details>\n".to_owned());
    }
    html.push(background(report));
    html.push("</body>\n</html>\n".to_owned());
    Ok(html.concat())
}

/// The charts and the table of one course that the oracle judged.
fn accuracy(report: &Report, course: &Course) -> Result<String, ExportError> {
    let title = escape(&course.to_string());
    let mut html = vec![format!("<h2>Accuracy beside speed: {title}</h2>\n")];
    let runs = &report.runs;
    let subjects = places(runs, course)
        .into_iter()
        .map(|place| Subject::Pareto(course.clone(), place))
        .chain(
            drifts(runs, course)
                .into_iter()
                .map(|along| Subject::Drift(course.clone(), along)),
        )
        .chain(
            tuned(runs, course)
                .into_iter()
                .map(|tuned| Subject::Tuned(course.clone(), tuned)),
        );
    for subject in subjects {
        html.extend(plot::svg(report, &subject)?);
    }
    html.push(tabulated(&table::accuracy(report, course)));
    html.push(tabulated(&table::errors(report, course)));
    Ok(html.concat())
}

/// What a reader must know of single runs; empty where there is nothing.
fn warnings(report: &Report) -> String {
    let warnings = table::warnings(report);
    if warnings.is_empty() {
        return String::new();
    }
    let mut html = vec![format!(
        "<details open><summary>Warnings: {}</summary><ul>\n",
        warnings.len()
    )];
    for (who, what) in warnings {
        html.push(format!(
            "<li>{}: <b>{}</b></li>\n",
            escape(&who),
            escape(&what)
        ));
    }
    html.push("</ul></details>\n".to_owned());
    html.concat()
}

/// Method, provenance and scenes.
fn background(report: &Report) -> String {
    let mut html = vec!["<h2>How it was measured</h2>\n<ul>\n".to_owned()];
    for sentence in table::method(report) {
        html.push(format!("<li>{}</li>\n", escape(&sentence)));
    }
    html.push("</ul>\n<h2>Provenance</h2>\n<dl>\n".to_owned());
    for (name, value) in table::provenance(report) {
        html.push(format!("<dt>{name}</dt><dd>{}</dd>\n", escape(&value)));
    }
    html.push("</dl>\n".to_owned());
    let scenes = table::scenes(report);
    if !scenes.rows.is_empty() {
        html.push(tabulated(&scenes));
    }
    html.concat()
}

fn tabulated(table: &Table) -> String {
    let class = |i: usize| if i < WORDS { " class=\"w\"" } else { "" };
    let mut html = vec!["<div class=\"wide\"><table>\n<thead><tr>".to_owned()];
    for (i, head) in table.head.iter().enumerate() {
        html.push(format!("<th scope=\"col\"{}>{head}</th>", class(i)));
    }
    html.push("</tr></thead>\n<tbody>\n".to_owned());
    for row in &table.rows {
        html.push("<tr>".to_owned());
        for (i, cell) in row.iter().enumerate() {
            html.push(format!("<td{}>{}</td>", class(i), escape(cell)));
        }
        html.push("</tr>\n".to_owned());
    }
    html.push("</tbody></table></div>\n".to_owned());
    html.concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::{report, run, teapot};

    #[test]
    fn the_page_holds_every_figure_and_loads_nothing() {
        let page = page(&teapot()).unwrap();
        assert_eq!(page.matches("<svg ").count(), Kind::ALL.len());
        let outside = page
            .replace("http://www.w3.org/2000/svg", "")
            .replace("src:url(data:font/otf;base64,", "");
        for word in [
            "http:", "https:", "src=", "@import", "url(", "<script", "<link",
        ] {
            assert!(!outside.contains(word), "{word}");
        }
    }

    #[test]
    fn every_run_stands_in_a_table() {
        let report = teapot();
        let page = page(&report).unwrap();
        let rows = page.matches("<tr><td").count();
        // All runs, the fastest of each of four accelerators, one scene.
        assert_eq!(rows, report.runs.len() + 4 + 1);
    }

    #[test]
    fn names_cannot_become_markup() {
        let mut one = run("grid", Some(4));
        one.scene = "<script>alert(1)</script>".to_owned();
        one.warnings.push("<b>&".to_owned());
        let page = page(&report(vec![one])).unwrap();
        assert!(!page.contains("<script") && page.contains("&lt;b&gt;&amp;"));
    }

    #[test]
    fn a_report_without_runs_is_a_page_too() {
        assert!(page(&report(Vec::new())).unwrap().contains("No runs."));
    }
}
