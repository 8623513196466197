//! What the benches share: their options, plans carried out by the lab and told line by line, and what is kept.

use std::path::Path;

use raylab::lab::{self, Budget, Control, Event, Plan};
use raylab::report::{self, Provenance, Report, Run, series};

/// What the command line asks for.
pub struct Options {
    /// What stands without an option before it.
    pub names: Vec<String>,
    /// `--scene`: scenes, separated by blanks or given several times.
    pub scenes: Vec<String>,
    /// `--rays-count`: rays of a set.
    pub ray_count: usize,
    /// `--n`: resolutions of grids.
    pub n: String,
    /// `--out`: a folder for the report.
    pub out: Option<String>,
    /// When sampling stops; `--quick` ends it early.
    pub budget: Budget,
}

impl Options {
    /// Reads the command line, with `ray_count` rays where it does not say.
    ///
    /// # Errors
    /// An unknown option, or one without its value.
    pub fn read(ray_count: usize) -> Result<Self, String> {
        let mut options = Self {
            names: Vec::new(),
            scenes: Vec::new(),
            ray_count,
            n: "auto".to_owned(),
            out: None,
            budget: Budget {
                min_samples: 9,
                max_samples: 21,
                checked_rays: 512,
                ..Budget::default()
            },
        };
        let mut arguments = std::env::args().skip(1);
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
            match argument.as_str() {
                // Given by `cargo bench` itself.
                "--bench" => {}
                "--quick" => {
                    options.budget = Budget {
                        checked_rays: 128,
                        ..Budget::quick()
                    };
                }
                "--rays-count" => {
                    let text = value()?;
                    let count = text.parse().ok().filter(|&count| count > 0);
                    options.ray_count =
                        count.ok_or_else(|| format!("'{text}' is no number of rays"))?;
                }
                "--n" => options.n = value()?,
                "--scene" => {
                    let text = value()?;
                    options
                        .scenes
                        .extend(text.split_whitespace().map(str::to_owned));
                }
                "--out" => options.out = Some(value()?),
                option if option.starts_with('-') => {
                    return Err(format!("'{option}' is no option"));
                }
                name => options.names.push(name.to_owned()),
            }
        }
        Ok(options)
    }
}

/// Carries `plans` out, one sweep after the other, as one report. A run that cannot be made is told and left out.
///
/// # Errors
/// There is no plan, or one cannot be carried out at all.
pub fn measure(plans: &[Plan]) -> Result<Report, String> {
    let first = plans.first().ok_or("there is nothing to measure")?;
    let command = std::env::args().collect();
    let provenance = Provenance::gather(first, command).map_err(|e| e.to_string())?;
    let mut runs = Vec::new();
    for (number, plan) in plans.iter().enumerate() {
        let told = &mut |event| match event {
            Event::Finished { record } => {
                let run = Run {
                    sweep: (plans.len() > 1).then_some(number as u32),
                    ..Run::from(record.as_ref())
                };
                eprintln!("{}", line(&run));
                runs.push(run);
            }
            Event::Failed { why, .. } => eprintln!("left out: {why}"),
            _ => {}
        };
        lab::sweep(plan, &<_>::default(), &Control::default(), told).map_err(|e| e.to_string())?;
    }
    Ok(Report {
        schema: Report::SCHEMA.to_owned(),
        judged: None,
        provenance,
        config: first.clone(),
        runs,
    })
}

/// Writes `report` into the folder `out`, if there is one: as it is, and in `format`.
///
/// # Errors
/// A file cannot be written.
pub fn keep(report: &Report, format: &str, out: Option<&str>) -> Result<(), String> {
    let Some(out) = out.map(Path::new) else {
        return Ok(());
    };
    report::export(report, format, out).map_err(|e| e.to_string())?;
    let path = out.join("report.json");
    report.write(&path).map_err(|e| e.to_string())?;
    eprintln!("wrote report.json and '{format}' to {}", out.display());
    Ok(())
}

/// A run as a line: scene, rays, accelerator, what decided hits, speed with its interval, build time.
fn line(run: &Run) -> String {
    let speed = &run.mrays_per_s;
    format!(
        "{:<16} {:<8} {:<52} {:<16} {:>9.3} Mrays/s ({:.3} to {:.3}) {:>9.1} ms",
        run.scene.rsplit('/').next().unwrap_or_default(),
        run.rays,
        series::accel_label(run),
        run.kernel,
        speed.median,
        speed.lo,
        speed.hi,
        run.build_ms.median
    )
}
