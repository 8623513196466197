//! The fitted laws as tables: for pages, and as JSON.

use serde::Serialize;

use crate::report::plot::text::{measured, number};
use crate::report::series::Quantity;
use crate::report::table::Table;
use crate::report::{Report, Run};

use super::{Curve, Law, Setting, curves, families, settings};

/// How the costs of an accelerator grow over the sizes of one family.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Growth {
    /// Kernel, ray set and threads.
    #[serde(flatten)]
    pub setting: Setting,
    /// Family of scenes.
    pub family: String,
    /// Accelerator, with those of its parameters that differ from their defaults.
    pub accel: String,
    /// How many sizes were measured.
    pub sizes: usize,
    /// Triangles of the least and of the greatest of them.
    pub triangles: [u64; 2],
    /// Of the build, in ms.
    pub build_ms: Option<Laws>,
    /// Of a ray, in ns.
    pub ns_per_ray: Option<Laws>,
    /// Of cells or nodes that a ray visits.
    pub steps_per_ray: Option<Laws>,
}

/// Both laws of one cost.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Laws {
    /// e of the power `c · N^e`.
    pub exponent: f64,
    /// Share of the variance of the logarithms that the power explains.
    pub exponent_r2: f64,
    /// b of the logarithm `a + b · log2 N`: what each doubling of the scene adds.
    pub a_doubling: f64,
    /// Share of the variance that the logarithm explains.
    pub a_doubling_r2: f64,
    /// The law that is off by less, relatively; `None` where both are by as much.
    pub nearer: Option<Law>,
}

impl Laws {
    fn of(curve: &Curve) -> Option<Self> {
        let (power, logarithm) = (curve.power()?, curve.logarithm()?);
        Some(Self {
            exponent: power.slope,
            exponent_r2: power.r2,
            a_doubling: logarithm.slope,
            a_doubling_r2: logarithm.r2,
            nearer: curve.nearer(),
        })
    }
}

/// All accelerators that were run on enough sizes of a family: by setting, family and accelerator, in the order in which
/// they first occur.
#[must_use]
pub fn growths(runs: &[Run]) -> Vec<Growth> {
    let settings = settings(runs).into_iter();
    settings
        .flat_map(|setting| {
            let families = families(runs, &setting).into_iter();
            families.flat_map(move |family| of_family(runs, &setting, &family))
        })
        .collect()
}

fn of_family(runs: &[Run], setting: &Setting, family: &str) -> Vec<Growth> {
    let [build, time, steps] = [Quantity::Build, Quantity::Time, Quantity::Steps]
        .map(|cost| curves(runs, setting, family, cost));
    let mut found: Vec<Growth> = Vec::new();
    for curve in build.iter().chain(&time).chain(&steps) {
        if found.iter().any(|growth| growth.accel == curve.label) {
            continue;
        }
        let laws = |curves: &[Curve]| {
            let same = curves.iter().find(|other| other.label == curve.label);
            same.and_then(Laws::of)
        };
        let end = |at: usize| curve.points[at].n as u64;
        found.push(Growth {
            setting: setting.clone(),
            family: family.to_owned(),
            accel: curve.label.clone(),
            sizes: curve.points.len(),
            triangles: [end(0), end(curve.points.len() - 1)],
            build_ms: laws(&build),
            ns_per_ray: laws(&time),
            steps_per_ray: laws(&steps),
        });
    }
    found
}

impl Law {
    /// As tables write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Power => "power",
            Self::Logarithm => "log",
        }
    }
}

/// The laws of one setting, a row an accelerator and family.
pub(in crate::report) fn table(growths: &[Growth], setting: &Setting) -> Table {
    let rows = growths.iter().filter(|g| g.setting == *setting);
    Table {
        head: vec![
            "accelerator",
            "family",
            "triangles",
            "build N^ (R²)",
            "ns/ray N^ (R²)",
            "ns/ray a doubling (R²)",
            "nearer",
            "steps N^ (R²)",
            "steps a doubling (R²)",
            "nearer",
        ],
        rows: rows.map(row).collect(),
    }
}

fn row(growth: &Growth) -> Vec<String> {
    let [least, most] = growth.triangles.map(|n| number(n as f64));
    let mut row = vec![
        growth.accel.clone(),
        growth.family.clone(),
        format!("{least} – {most}, {} sizes", growth.sizes),
        exponent(growth.build_ms),
    ];
    for laws in [growth.ns_per_ray, growth.steps_per_ray] {
        let nearer = laws.and_then(|l| l.nearer).map_or("–", Law::name);
        row.extend([exponent(laws), a_doubling(laws), nearer.to_owned()]);
    }
    row
}

/// `1.04 (0.999)`: exponent and share explained.
fn exponent(laws: Option<Laws>) -> String {
    laws.map_or_else(
        || "–".to_owned(),
        |l| with_share(&exponent_text(l.exponent), l.exponent_r2),
    )
}

/// `2.41 (0.999)`: what a doubling adds, and share explained.
fn a_doubling(laws: Option<Laws>) -> String {
    laws.map_or_else(
        || "–".to_owned(),
        |l| with_share(&measured(l.a_doubling).replace('-', "−"), l.a_doubling_r2),
    )
}

fn with_share(value: &str, r2: f64) -> String {
    format!("{value} ({r2:.3})")
}

/// An exponent in two decimals, 0 without a sign.
pub(in crate::report) fn exponent_text(exponent: f64) -> String {
    // The sum makes a zero of a negative one.
    let rounded = (exponent * 100.0).round() / 100.0 + 0.0;
    format!("{rounded:.2}").replace('-', "−")
}

/// What the columns mean, a sentence each.
pub(in crate::report) const WORDS: &str = "\
N: triangles. *Build N^*: exponent of the power of N that is nearest to the build times, by least squares of the logarithms. \
The time and the steps of a ray are fitted twice: as a power of N, and as a logarithm, of which each doubling of N adds the \
same. *Nearer*: which of the two is off by less, relatively. R²: the share of the variance that a law explains.";

/// The page of tables, in Markdown.
pub(in crate::report) fn page(report: &Report) -> String {
    let growths = growths(&report.runs);
    let mut text = vec![format!(
        "# How costs grow with the number of triangles\n\n{WORDS}\n"
    )];
    if growths.is_empty() {
        text.push("\nNo accelerator was run on three sizes of a family of scenes.\n".to_owned());
    }
    for setting in settings(&report.runs) {
        text.push(format!("\n## {setting}\n\n"));
        text.push(crate::report::markdown::tabulated(&table(
            &growths, &setting,
        )));
    }
    text.push("\n".to_owned());
    for (name, value) in crate::report::table::provenance(report) {
        text.push(format!("- {name}: {value}\n"));
    }
    text.concat()
}

/// All fitted laws as JSON: an array of objects.
pub(in crate::report) fn json(report: &Report) -> String {
    let growths = serde_json::json!(growths(&report.runs));
    format!("{growths:#}\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::{growing, report};

    #[test]
    fn every_accelerator_has_a_row_a_family_with_the_laws_of_its_curves() {
        let runs = growing();
        let growths = growths(&runs);
        let names: Vec<(&str, &str)> = growths
            .iter()
            .map(|g| (g.family.as_str(), g.accel.as_str()))
            .collect();
        let accels = ["grid", "kd-tree", "bvh"];
        let expected = ["soup", "sphereflake"].map(|family| accels.map(|accel| (family, accel)));
        assert_eq!(names, expected.as_flattened());
        let bvh = &growths[2];
        assert_eq!((bvh.sizes, bvh.triangles), (4, [1_000, 1_000_000]));
        // The fixture's trees are built in N log N and traced in log N.
        let build = bvh.build_ms.unwrap();
        assert!((build.exponent - 1.1).abs() < 0.05 && build.exponent_r2 > 0.99);
        let steps = bvh.steps_per_ray.unwrap();
        assert_eq!(steps.nearer, Some(Law::Logarithm));
        assert!(steps.a_doubling_r2 > 0.999 && steps.exponent < 0.15);
    }

    #[test]
    fn page_and_json_hold_every_row() {
        let report = report(growing());
        let page = page(&report);
        assert!(
            page.contains("\n## woop · primary rays · 1 thread\n"),
            "{page}"
        );
        let rows = page.lines().filter(|line| line.starts_with("| bvh |"));
        assert_eq!(rows.count(), 2);
        assert!(page.contains("1,000 – 10⁶, 4 sizes"), "{page}");
        let json: serde_json::Value = serde_json::from_str(&json(&report)).unwrap();
        assert_eq!(json.as_array().unwrap().len(), 6);
        assert_eq!(json[2]["kernel"], "woop");
        assert_eq!(json[2]["steps_per_ray"]["nearer"], "logarithm");
    }

    #[test]
    fn exponents_have_two_decimals_and_zero_no_sign() {
        let texts = [1.049, -0.004, -0.1, 0.0].map(exponent_text);
        assert_eq!(texts, ["1.05", "0.00", "−0.10", "0.00"]);
    }

    #[test]
    fn a_report_without_families_says_so() {
        let page = page(&report(Vec::new()));
        assert!(page.contains("No accelerator was run on three sizes"));
    }
}
