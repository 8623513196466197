//! The scene registry, and the way from a spec to a scene.
//!
//! A spec is a row's name with sizes in the order of its parameters, `soup:1000,0.5`; sizes left out take their
//! defaults. Whatever looks like a file, because it ends in `.obj`, holds a path separator or has a dot in its name, is
//! read as one.

use std::path::Path;

use super::{Scene, SceneEntry, SceneError, bundled, family, obj};
use crate::registry::{ChoiceError, ParamKind, ParamSpec};

/// The most triangles that a procedural scene may have: about 1 GB of mesh, far beyond what is worth waiting for.
pub const MAX_TRIANGLES: u64 = 20_000_000;

/// All bundled scenes and procedural families.
pub const SCENES: &[SceneEntry] = &[
    family::teapot::ROW,
    bundled::CORNELL,
    bundled::CABALLITO,
    bundled::STAIRCASE,
    bundled::PLANT,
    family::sphereflake::ROW,
    family::soup::ROW,
    family::city::ROW,
    family::gears::ROW,
    family::mountain::ROW,
    family::rings::ROW,
    family::tetra::ROW,
    family::tree::ROW,
    family::stadium::ROW,
    family::menger::ROW,
    family::needles::ROW,
    family::nested::SHELLS,
    family::nested::MATRYOSHKA,
    family::plane::ROW,
    family::lattice::ROW,
    family::moved::OFFSET,
    family::moved::OUTLIER,
    family::degenerate::CLUSTER,
    family::degenerate::DUPLICATES,
    family::degenerate::AXIS_LINE,
    family::trivial::ONE,
    family::trivial::EMPTY,
];

/// The sizes of a spec, in the order of the row's parameters, defaults filled in.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes(Vec<Option<f64>>);

impl Sizes {
    /// Reads the part of a spec after its `:`.
    fn parse(row: &SceneEntry, spec: &str, text: Option<&str>) -> Result<Self, SceneError> {
        let written: Vec<&str> = text.map_or_else(Vec::new, |t| t.split(',').collect());
        if written.len() > row.params.len() {
            return Err(SceneError::TooManySizes {
                spec: spec.to_owned(),
                form: row.form(),
            });
        }
        let read = |(i, param): (usize, &ParamSpec)| match written.get(i) {
            Some(text) => number(param, text.trim()).map(Some),
            // A parameter without a default may stay away.
            None if param.default.is_empty() => Ok(None),
            None => number(param, param.default).map(Some),
        };
        let sizes: Result<_, ChoiceError> = row.params.iter().enumerate().map(read).collect();
        sizes.map(Self).map_err(|error| SceneError::Size {
            spec: spec.to_owned(),
            error,
        })
    }

    /// Sizes as a test wants them.
    #[cfg(test)]
    pub(super) fn of(sizes: impl IntoIterator<Item = Option<f64>>) -> Self {
        Self(sizes.into_iter().collect())
    }

    /// The whole number at `index`; 0 where the row has no such parameter.
    #[must_use]
    pub fn int(&self, index: usize) -> u32 {
        self.float(index) as u32
    }

    /// The number at `index`; 0 where the row has no such parameter.
    #[must_use]
    pub fn float(&self, index: usize) -> f64 {
        self.optional(index).unwrap_or(0.0)
    }

    /// The number at `index`; `None` where it was not written and has no default.
    #[must_use]
    pub fn optional(&self, index: usize) -> Option<f64> {
        self.0.get(index).copied().flatten()
    }
}

/// Reads one size by the bounds of its parameter.
fn number(param: &ParamSpec, text: &str) -> Result<f64, ChoiceError> {
    let value = param.parse(text)?;
    match value {
        crate::registry::Value::Int(x) => Ok(x as f64),
        crate::registry::Value::Float(x) => Ok(x),
        crate::registry::Value::Text(_) => Err(ChoiceError::BadValue {
            param: param.name.to_owned(),
            value: text.to_owned(),
            expected: "a number".to_owned(),
        }),
    }
}

impl SceneEntry {
    /// How the row is written: `soup:N[,s]`.
    #[must_use]
    pub fn form(&self) -> String {
        if self.size.is_empty() {
            format!("'{}' alone", self.name)
        } else {
            format!("'{}:{}'", self.name, self.size)
        }
    }
}

/// What a spec names.
enum Source<'a> {
    File(&'a Path),
    Row(&'static SceneEntry, Sizes),
}

/// Whether `spec` names a file rather than a row of the registry.
fn is_file(spec: &str) -> bool {
    let name = spec.split(':').next().unwrap_or_default();
    spec.to_ascii_lowercase().ends_with(".obj")
        || spec.contains(std::path::is_separator)
        || name.contains('.')
}

fn source(spec: &str) -> Result<Source<'_>, SceneError> {
    if is_file(spec) {
        return Ok(Source::File(Path::new(spec)));
    }
    let (name, sizes) = match spec.split_once(':') {
        Some((name, sizes)) => (name.trim(), Some(sizes)),
        None => (spec.trim(), None),
    };
    let row = SCENES
        .iter()
        .find(|row| row.name == name)
        .ok_or_else(|| ChoiceError::unknown("scene", name, SCENES.iter().map(|row| row.name)))?;
    let sizes = Sizes::parse(row, spec, sizes)?;
    let triangles = (row.triangles)(&sizes);
    if triangles > MAX_TRIANGLES {
        return Err(SceneError::TooLarge {
            spec: spec.to_owned(),
            triangles,
            limit: MAX_TRIANGLES,
        });
    }
    Ok(Source::Row(row, sizes))
}

/// Loads the scene that `spec` names.
///
/// # Errors
/// An unknown name (with the nearest known one), a size out of bounds, a predicted triangle count over
/// [`MAX_TRIANGLES`] (found before anything is allocated), a file that cannot be read or holds no triangles.
pub fn load(spec: &str) -> Result<Scene, SceneError> {
    match source(spec)? {
        Source::File(path) => obj::load_file(path),
        Source::Row(row, sizes) => Ok(Scene {
            name: spec.to_owned(),
            about: row.about.to_owned(),
            ..(row.build)(&sizes)?
        }),
    }
}

/// Checks `spec` without building the scene: for a file only that it is there.
///
/// # Errors
/// Those of [`load`] that show without building.
pub fn check(spec: &str) -> Result<(), SceneError> {
    match source(spec)? {
        Source::File(path) => obj::check_file(path),
        Source::Row(..) => Ok(()),
    }
}

/// The family whose sizes `spec` is one of: `soup` for `soup:1000`. Scenes of one family differ in their whole numbers
/// alone; other sizes that are not the default belong to the name: `soup, s = 0.5`.
///
/// `None` for a file, a scene without sizes, and what names no scene.
#[must_use]
pub fn family_of(spec: &str) -> Option<String> {
    let Ok(Source::Row(row, sizes)) = source(spec) else {
        return None;
    };
    let shape = row.params.iter().enumerate().filter_map(|(i, param)| {
        let value = sizes.optional(i)?;
        let usual = number(param, param.default).ok() == Some(value);
        let shape = matches!(param.kind, ParamKind::Float { .. }) && !usual;
        shape.then(|| format!(", {} = {value}", param.name))
    });
    let family = row.name.to_owned() + &shape.collect::<String>();
    (!row.params.is_empty()).then_some(family)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;

    #[test]
    fn a_family_is_a_name_with_what_is_no_number_of_things() {
        for (spec, family) in [
            ("soup:1000", Some("soup")),
            ("soup:1000,1", Some("soup")),
            ("soup:20,0.5", Some("soup, s = 0.5")),
            ("soup", Some("soup")),
            ("sphereflake:2", Some("sphereflake")),
            ("sphereflake:2,3", Some("sphereflake")),
            ("cornell", None),
            ("a/soup:1000.obj", None),
            ("soup:x", None),
            ("broth:9", None),
        ] {
            assert_eq!(family_of(spec).as_deref(), family, "{spec}");
        }
    }

    #[test]
    fn every_row_loads_its_example_with_as_many_triangles_as_predicted() {
        for row in SCENES {
            let Ok(Source::Row(_, sizes)) = source(row.example) else {
                panic!("{} is no row", row.example);
            };
            let scene = load(row.example).unwrap();
            assert_eq!(
                scene.mesh.len() as u64,
                (row.triangles)(&sizes),
                "{}",
                row.name
            );
            assert_eq!(scene.material_of.len(), scene.mesh.len(), "{}", row.name);
            assert!(!scene.materials.is_empty());
            assert!(
                scene
                    .material_of
                    .iter()
                    .all(|&m| (m as usize) < scene.materials.len())
            );
        }
    }

    #[test]
    fn every_row_has_a_camera_that_sees_its_example() {
        for row in SCENES.iter().filter(|row| !row.blind) {
            let scene = load(row.example).unwrap();
            assert!(scene.camera.eye.is_finite() && scene.camera.eye != scene.camera.at);
            let seen = (0..400).any(|i| {
                let ray = scene
                    .camera
                    .ray((i % 20) as f32 + 0.5, (i / 20) as f32 + 0.5, 20, 20);
                hits(&scene, &ray)
            });
            assert!(seen, "{} shows nothing", row.name);
        }
    }

    /// Whether `ray` meets a triangle, by signed volumes in f64.
    fn hits(scene: &Scene, ray: &Ray) -> bool {
        let (o, d) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
        (0..scene.mesh.len() as u32).any(|prim| {
            let [a, b, c] = scene.mesh.corners(prim).map(|p| p.as_dvec3() - o);
            let volumes = [d.dot(a.cross(b)), d.dot(b.cross(c)), d.dot(c.cross(a))];
            let ahead = (a + b + c).dot(d) > 0.0;
            ahead && (volumes.iter().all(|&v| v > 0.0) || volumes.iter().all(|&v| v < 0.0))
        })
    }

    #[test]
    fn names_are_unique_and_kebab_case_and_abouts_are_one_sentence() {
        for (i, row) in SCENES.iter().enumerate() {
            assert!(!SCENES[..i].iter().any(|other| other.name == row.name));
            assert!(row.name.chars().all(|c| c.is_ascii_lowercase() || c == '-'));
            assert!(row.about.ends_with('.'), "{}", row.about);
            assert_eq!(row.about.matches(". ").count(), 0, "{}", row.about);
            assert_eq!(row.size.is_empty(), row.params.is_empty(), "{}", row.name);
            assert!(row.example.starts_with(row.name));
        }
    }

    #[test]
    fn every_name_alone_takes_its_defaults() {
        for row in SCENES {
            assert_eq!(check(row.name), Ok(()), "{}", row.name);
        }
    }

    #[test]
    fn a_misspelt_scene_is_answered_with_the_nearest_and_is_a_usage_error() {
        let error = load("teapto").unwrap_err();
        assert!(error.is_usage());
        assert!(
            error.to_string().contains("did you mean 'teapot'?"),
            "{error}"
        );
    }

    #[test]
    fn sizes_out_of_bounds_too_many_or_not_numbers_are_usage_errors() {
        for spec in [
            "soup:0",
            "soup:-1",
            "soup:x",
            "soup:1,2,3",
            "soup:10,nan",
            "soup:",
            "one:3",
            "soup:1e3",
        ] {
            let error = check(spec).unwrap_err();
            assert!(error.is_usage(), "{spec}: {error}");
            assert!(error.to_string().contains(spec), "{error}");
        }
    }

    #[test]
    fn a_scene_over_the_limit_is_refused_with_its_size_before_it_is_built() {
        let error = load("plane:100000").unwrap_err();
        assert!(error.is_usage());
        assert!(
            error.to_string().contains("20000000000 triangles"),
            "{error}"
        );
    }

    #[test]
    fn what_looks_like_a_file_is_read_as_one_and_its_absence_is_no_usage_error() {
        for spec in ["missing.obj", "missing.OBJ", "dir/missing", "missing.ply"] {
            assert!(!check(spec).unwrap_err().is_usage(), "{spec}");
            assert!(load(spec).unwrap_err().to_string().contains(spec));
        }
    }
}
