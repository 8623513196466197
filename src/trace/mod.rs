//! Ray sets, and tracing them in batches over threads.
//!
//! ```text
//! scene + spec + count + seed ──ray_set──▶ RaySet ──closest / occluded──▶ hits / blocked
//!                                             │
//!                                             └────── files: .rays, .hits
//! ```
//!
//! A set depends on nothing but the scene, the spec, the count and the seed: whatever the machine and the number of
//! threads, its rays are the same, bit for bit, as long as the camera's field of view gives the same tangent. Random
//! sets use only operations that IEEE 754 rounds correctly (no sine, no logarithm).
//!
//! To add one: a file here with an `ENTRY`, and a row in [`RAY_SETS`].

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::accel::BuildError;
use crate::geometry::Ray;
use crate::registry::{Choice, ChoiceError, ParamSpec, Params};
use crate::scene::Scene;

mod ao;
mod batch;
mod bounce;
mod edge;
pub mod files;
mod first_hit;
#[cfg(test)]
mod fixture;
mod grazing;
mod primary;
mod random;
mod sample;
mod seam;
mod shadow;

pub(crate) use sample::{cosine_direction, generator};

pub use batch::{
    BATCH, closest, closest_counted, closest_into, occluded, occluded_counted, occluded_into,
};

/// What is asked of each ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Query {
    /// The nearest hit.
    Closest,
    /// Whether anything is hit.
    Occluded,
}

/// Rays to trace, all of them valid.
#[derive(Debug, Clone, PartialEq)]
pub struct RaySet {
    /// The spec it was made from: `primary`, `shadow`, …, `file:PATH`.
    pub name: String,
    /// What is asked of each ray.
    pub query: Query,
    /// The rays; neighbours in the list are neighbours in space where the set has any order.
    pub rays: Vec<Ray>,
    /// What a reader of figures from this set should know, one sentence each.
    pub warnings: Vec<String>,
}

/// What a ray set is made from.
#[derive(Debug, Clone, Copy)]
pub struct RayRequest<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// What follows the name and its `:` in the spec; empty where nothing does.
    pub argument: &'a str,
    /// The set's parameters, all set.
    pub params: &'a Params,
    /// How many rays are wanted; a set holds at most as many, `file` as many as the file.
    pub count: usize,
    /// Seed of what is random.
    pub seed: u64,
}

/// A row of the ray set registry.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct RaySetEntry {
    /// Kebab-case name.
    pub name: &'static str,
    /// One sentence.
    pub about: &'static str,
    /// What is asked of each ray.
    pub query: Query,
    /// What follows the name after a `:`, e.g. `PATH`; empty where nothing does.
    pub argument: &'static str,
    /// Parameters, written `name:key=value`; none where the set has an argument.
    pub params: &'static [ParamSpec],
    /// Makes the set.
    #[serde(skip)]
    pub make: fn(&RayRequest) -> Result<Rays, RayError>,
}

/// Rays with what a reader should know of them: what a row of the registry makes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rays {
    /// The rays.
    pub rays: Vec<Ray>,
    /// One sentence each.
    pub warnings: Vec<String>,
}

/// All ray sets, in the order in which they are listed.
pub const RAY_SETS: &[RaySetEntry] = &[
    primary::ENTRY,
    shadow::ENTRY,
    ao::ENTRY,
    bounce::ENTRY,
    random::ENTRY,
    grazing::ENTRY,
    edge::ENTRY,
    files::ENTRY,
];

/// Most rays of a set: 4 GiB of them.
pub const MAX_RAYS: usize = 1 << 27;

/// Why there is no ray set.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum RayError {
    /// The spec names no set.
    #[error(transparent)]
    Unknown(#[from] ChoiceError),
    /// A spec with an argument where the set takes none, or without one where it needs one.
    #[error("'{spec}' is not a ray set; write {expected}")]
    Argument {
        /// What was written.
        spec: String,
        /// How it is written.
        expected: String,
    },
    /// No rays, or more than fit.
    #[error("{0} rays were asked for; ask for 1 to {MAX_RAYS}")]
    Count(usize),
    /// The structure that finds the first hits was not built.
    #[error("the first hits that secondary rays start from could not be found: {0}")]
    FirstHits(#[from] BuildError),
    /// A file that cannot be read or written.
    #[error("cannot {action} {}: {why}; check the path and its permissions", path.display())]
    File {
        /// "read" or "write".
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// What the system says.
        why: String,
    },
    /// A `.rays` file whose length is no multiple of a record.
    #[error(
        "{} ends in the middle of a ray: {bytes} bytes are not a multiple of 32; write it again", path.display()
    )]
    Truncated {
        /// The file.
        path: PathBuf,
        /// Its length.
        bytes: u64,
    },
    /// A `.rays` file without a ray.
    #[error("{} holds no ray; a .rays file has 32 bytes a ray", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// A record that is not a ray.
    #[error("ray {record} of {} is not valid: {why}; is it a .rays file of little-endian f32?", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Index of the record, from 0.
        record: usize,
        /// What is wrong with it.
        why: &'static str,
    },
}

/// The row that `spec` names, its argument, and its parameters, all set.
///
/// # Errors
/// An unknown name or parameter; an argument too many or missing.
pub fn parse(spec: &str) -> Result<(&'static RaySetEntry, &str, Params), RayError> {
    let (name, argument) = spec.split_once(':').unwrap_or((spec, ""));
    let entry = RAY_SETS
        .iter()
        .find(|s| s.name == name)
        .ok_or_else(|| ChoiceError::unknown("ray set", name, RAY_SETS.iter().map(|s| s.name)))?;
    if !entry.params.is_empty() {
        let rows = RAY_SETS.iter().map(|s| (s.name, s.params));
        return Ok((entry, "", Choice::parse("ray set", spec, rows)?.params));
    }
    if argument.is_empty() == entry.argument.is_empty() {
        return Ok((entry, argument, Params::default()));
    }
    let expected = match entry.argument {
        "" => format!("'{name}'"),
        argument => format!("'{name}:{argument}'"),
    };
    Err(RayError::Argument {
        spec: spec.to_owned(),
        expected,
    })
}

/// Checks what can be checked of a set without its scene; of a file that all its rays are valid.
///
/// # Errors
/// Those of [`ray_set`] that do not depend on the scene.
pub fn check(spec: &str, count: usize) -> Result<(), RayError> {
    let (entry, argument, _) = parse(spec)?;
    if count == 0 || count > MAX_RAYS {
        return Err(RayError::Count(count));
    }
    if entry.name == files::ENTRY.name {
        files::read_rays(std::path::Path::new(argument))?;
    }
    Ok(())
}

/// Makes the set that `spec` names: at most `count` rays over `scene`, all valid, the same for the same arguments.
///
/// A set may hold fewer rays, even none (`bounce` where nothing is hit); its warnings say so.
///
/// # Errors
/// An unknown spec, a count of 0 or beyond [`MAX_RAYS`], a ray file that cannot be read.
pub fn ray_set(scene: &Scene, spec: &str, count: usize, seed: u64) -> Result<RaySet, RayError> {
    let (entry, argument, params) = parse(spec)?;
    if count == 0 || count > MAX_RAYS {
        return Err(RayError::Count(count));
    }
    let mut made = (entry.make)(&RayRequest {
        scene,
        argument,
        params: &params,
        count,
        seed,
    })?;
    // Scenes at the end of the range of f32 give directions that overflow; no such ray may reach a structure.
    let before = made.rays.len();
    made.rays.retain(Ray::is_valid);
    if made.rays.len() < before {
        made.warnings.push(format!(
            "{} rays of '{spec}' overflow f32 and were left out",
            before - made.rays.len()
        ));
    }
    Ok(RaySet {
        name: spec.to_owned(),
        query: entry.query,
        rays: made.rays,
        warnings: made.warnings,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_kebab_case() {
        for (i, set) in RAY_SETS.iter().enumerate() {
            assert!(set.name.chars().all(|c| c.is_ascii_lowercase() || c == '-'));
            assert!(set.about.ends_with('.') && !set.about.contains(". "));
            assert!(RAY_SETS[i + 1..].iter().all(|other| other.name != set.name));
        }
    }

    #[test]
    fn every_set_is_valid_and_the_same_for_the_same_seed() {
        let scene = fixture::room();
        for set in RAY_SETS.iter().filter(|s| s.argument.is_empty()) {
            let once = ray_set(&scene, set.name, 3000, 7).unwrap();
            assert_eq!(once, ray_set(&scene, set.name, 3000, 7).unwrap());
            assert!(
                once.rays.len() > 500 && once.rays.len() <= 3000,
                "{}",
                set.name
            );
            assert!(once.rays.iter().all(Ray::is_valid));
        }
    }

    #[test]
    fn another_seed_gives_other_random_rays() {
        let scene = fixture::room();
        for name in ["ao", "bounce", "random", "grazing", "edge"] {
            let [a, b] = [1, 2].map(|seed| ray_set(&scene, name, 1000, seed).unwrap().rays);
            assert_ne!(a, b, "{name}");
        }
    }

    #[test]
    fn a_scene_without_triangles_gives_sets_without_panic() {
        let scene = fixture::empty();
        for set in RAY_SETS.iter().filter(|s| s.argument.is_empty()) {
            let made = ray_set(&scene, set.name, 100, 1).unwrap();
            let aimed = matches!(set.name, "shadow" | "ao" | "bounce" | "grazing" | "edge");
            assert_eq!(made.rays.is_empty(), aimed, "{}", set.name);
            assert!(!aimed || !made.warnings.is_empty());
        }
    }

    #[test]
    fn scenes_at_the_end_of_the_range_give_only_valid_rays() {
        for scale in [1e-38, 1e-30, 1e30, 3e38] {
            let scene = fixture::scaled(&fixture::room(), scale);
            for set in RAY_SETS.iter().filter(|s| s.argument.is_empty()) {
                let made = ray_set(&scene, set.name, 100, 1).unwrap();
                assert!(
                    made.rays.iter().all(Ray::is_valid),
                    "{} at {scale}",
                    set.name
                );
            }
        }
    }

    #[test]
    fn unknown_names_and_odd_arguments_are_refused_with_a_hint() {
        let scene = fixture::empty();
        let why = |spec| ray_set(&scene, spec, 10, 1).unwrap_err().to_string();
        assert!(why("primry").contains("did you mean 'primary'?"));
        assert!(why("primary:3").contains("write 'primary'"));
        assert!(why("file").contains("write 'file:PATH'"));
        assert!(ray_set(&scene, "random", 0, 1).is_err());
        assert!(ray_set(&scene, "random", usize::MAX, 1).is_err());
    }
}
