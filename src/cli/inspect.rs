//! `raylab inspect`: every step of one ray, as a table or as JSON.

use crate::accel::{self, Outcome};
use crate::geometry::Ray;
use crate::lab::{self, Inspection, Step, Subject};
use crate::oracle::Oracle;
use crate::scene::Scene;
use crate::trace::files::read_rays;

use super::args::InspectArgs;
use super::session::{Config, PNG_SIZE, load};
use super::table::{
    Side::{Left, Right},
    columns,
};
use super::{Failure, print};

/// Follows the ray and prints its way.
pub fn run(args: &InspectArgs) -> Result<(), Failure> {
    let config = Config::read(&args.config)?;
    // Asked for before the scene is loaded, which may take a while.
    let aimed = Aim::read(args)?;
    let scene = load(&args.scene, args.config.quiet)?;
    let ray = aimed.ray(args, &scene);
    let built = config.pool()?.install(|| config.build(&scene))?;
    let subject = Subject {
        scene: &args.scene,
        accel: &config.accel,
        n: built.n,
        kernel: &config.kernel,
    };
    let oracle = Oracle::new(&scene.mesh);
    let inspection = lab::inspect(&subject, built.accel.as_ref(), &oracle, &ray);
    if args.config.json {
        // Numbers and strings always serialise.
        let json = serde_json::to_string_pretty(&inspection)
            .map_err(|e| Failure::Failed(format!("cannot write the inspection as JSON: {e}")))?;
        return print(&format!("{json}\n"));
    }
    print(&text(&inspection, &aimed))
}

/// Which ray was asked for.
enum Aim {
    /// Through the centre of a pixel of a picture of this size.
    Pixel { at: (u32, u32), size: (u32, u32) },
    /// This one.
    Ray(Ray),
}

impl Aim {
    fn read(args: &InspectArgs) -> Result<Self, Failure> {
        if let Some(path) = &args.rays_file {
            let rays = read_rays(path)?;
            return rays.get(args.ray).copied().map(Self::Ray).ok_or_else(|| {
                Failure::Usage(format!(
                    "{} has no ray {}; the last one is {}",
                    path.display(),
                    args.ray,
                    rays.len() - 1
                ))
            });
        }
        if let (Some(origin), Some(dir)) = (args.origin, args.dir) {
            let ray = Ray::new(origin, dir);
            return if ray.is_valid() {
                Ok(Self::Ray(ray))
            } else {
                Err(Failure::Usage(
                    "--dir 0,0,0 points nowhere; give at least one number that is not 0".to_owned(),
                ))
            };
        }
        let Some(at) = args.pixel else {
            return Err(Failure::Usage(
                "no ray is named; give --pixel X,Y, or --origin X,Y,Z and --dir X,Y,Z, or --rays-file F.rays".to_owned(),
            ));
        };
        let size = args.size.unwrap_or(PNG_SIZE);
        let ((x, y), (width, height)) = (at, size);
        if x < width && y < height {
            Ok(Self::Pixel { at, size })
        } else {
            Err(Failure::Usage(format!(
                "pixel {x},{y} lies outside a picture of {width}x{height}; the last one is {},{}, or give another --size",
                width - 1,
                height - 1,
            )))
        }
    }

    fn ray(&self, args: &InspectArgs, scene: &Scene) -> Ray {
        match *self {
            Self::Ray(ray) => ray,
            Self::Pixel {
                at: (x, y),
                size: (width, height),
            } => {
                let camera = args.camera.of(scene);
                camera.ray(x as f32 + 0.5, y as f32 + 0.5, width, height)
            }
        }
    }
}

/// The way as a table, with what it began with above and what it came to below.
fn text(inspection: &Inspection, aim: &Aim) -> String {
    let n = inspection.n.map_or(String::new(), |n| format!(" n={n}"));
    let pixel = match aim {
        Aim::Pixel { at, size } => {
            format!("pixel {},{} of {}x{}, ", at.0, at.1, size.0, size.1)
        }
        Aim::Ray(_) => String::new(),
    };
    let ray = &inspection.ray;
    let interval = if (ray.t_min, ray.t_max) == (0.0, f32::INFINITY) {
        String::new()
    } else {
        let [from, to] = [ray.t_min, ray.t_max].map(number_text);
        format!(", t from {from} to {to}")
    };
    let mut text = format!(
        "{}: {}{n}, {}\n{pixel}from {} along {}{interval}\n\n",
        inspection.scene,
        inspection.accel,
        inspection.kernel,
        point(ray.origin),
        point(ray.dir),
    );
    if inspection.steps.is_empty() && is_peer(&inspection.accel) {
        text.push_str("a peer tells nothing of its steps\n\n");
    }
    if !inspection.steps.is_empty() {
        let header = [
            "step", "kind", "place", "entry t", "exit t", "refs", "triangle", "test", "t", "bounds",
        ];
        let mut rows = vec![header.map(str::to_owned)];
        for (i, step) in inspection.steps.iter().enumerate() {
            rows.extend(step_rows(i + 1, step));
        }
        let sides = [
            Right, Left, Right, Right, Right, Right, Right, Left, Right, Left,
        ];
        text.push_str(&columns(&rows, &sides));
        text.push('\n');
    }
    text.push_str(&summary(inspection));
    text
}

/// Whether `label` is that of another library's structure.
fn is_peer(label: &str) -> bool {
    accel::parse(label)
        .and_then(|choice| accel::entry(&choice.name))
        .is_ok_and(|entry| entry.peer.is_some())
}

/// A row for the step, and one for each triangle that it offered; the first shares the step's.
fn step_rows(number: usize, step: &Step) -> Vec<[String; 10]> {
    let bounds = step.bounds.map_or_else(
        || "-".to_owned(),
        |[min, max]| format!("{} .. {}", point(min), point(max)),
    );
    let mut first = std::array::from_fn(|_| String::new());
    first[..6].clone_from_slice(&[
        number.to_string(),
        step.kind.name().to_owned(),
        step.place.to_string(),
        number_text(step.entry as f32),
        number_text(step.exit as f32),
        step.references.to_string(),
    ]);
    first[9] = bounds;
    let mut rows = vec![first];
    for (i, test) in step.tests.iter().enumerate() {
        if i > 0 {
            rows.push(std::array::from_fn(|_| String::new()));
        }
        let row = &mut rows[i];
        row[6] = test.prim.to_string();
        test.outcome.name().clone_into(&mut row[7]);
        row[8] = test.t.map_or(String::new(), number_text);
    }
    rows
}

/// Work and answer, and whether it is right.
fn summary(inspection: &Inspection) -> String {
    let offered = inspection.steps.iter().flat_map(|step| &step.tests);
    let outcomes: Vec<Outcome> = offered.map(|test| test.outcome).collect();
    let skipped = outcomes.iter().filter(|o| **o == Outcome::Skipped).count();
    let answer = match &inspection.hit {
        Some(hit) => format!(
            "triangle {} at t = {}, u = {}, v = {}",
            hit.prim,
            number_text(hit.t),
            number_text(hit.u),
            number_text(hit.v)
        ),
        None => "a miss".to_owned(),
    };
    let truth = &inspection.truth;
    let verdict = match (inspection.right, truth.t) {
        (true, _) => "right by exact arithmetic".to_owned(),
        (false, None) => "WRONG: by exact arithmetic nothing is hit".to_owned(),
        (false, Some(t)) => format!(
            "WRONG: by exact arithmetic the nearest is triangle {} at t = {t}",
            truth
                .prims
                .iter()
                .map(u32::to_string)
                .collect::<Vec<_>>()
                .join(" or ")
        ),
    };
    format!(
        "steps {}, tests {}, skipped {}: {answer}; {verdict}\n",
        inspection.steps.len(),
        outcomes.len() - skipped,
        skipped
    )
}

fn point(p: [f32; 3]) -> String {
    format!("({})", p.map(number_text).join(" "))
}

/// As many digits as tell the number from all others; exponents only where plain digits would be long.
fn number_text(x: f32) -> String {
    let magnitude = x.abs();
    if x == 0.0 || (1e-4..1e7).contains(&magnitude) || !x.is_finite() {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{PlaceKind, Test};

    #[test]
    fn a_step_has_a_row_and_each_further_test_one_of_its_own() {
        let test = |prim, outcome, t| Test { prim, outcome, t };
        let mut step = Step {
            kind: PlaceKind::Cell,
            place: 7,
            entry: 0.5,
            exit: f64::INFINITY,
            references: 3,
            bounds: None,
            tests: vec![],
        };
        assert_eq!(step_rows(1, &step).len(), 1);
        step.tests = vec![
            test(4, Outcome::Miss, None),
            test(9, Outcome::Nearest, Some(0.75)),
            test(4, Outcome::Skipped, None),
        ];
        let rows = step_rows(2, &step);
        assert_eq!(
            rows[0].join("|"),
            "2|cell|7|0.5|inf|3|4|miss||-",
            "the first test shares the step's row"
        );
        assert_eq!(rows[1].join("|"), "||||||9|nearest|0.75|");
        assert_eq!(rows[2].join("|"), "||||||4|skipped||");
    }

    #[test]
    fn numbers_tell_themselves_from_all_others_and_stay_short() {
        let texts = [0.1, -2.0, 1e-9, 1e30, 0.0, f32::INFINITY].map(number_text);
        assert_eq!(texts, ["0.1", "-2", "1e-9", "1e30", "0", "inf"]);
    }
}
