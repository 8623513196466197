//! A case: generated scenes and rays on which methods are known to break, seeded, on a ladder of growing trouble.

use std::sync::Arc;

use serde::Serialize;

use crate::geometry::{Ray, Vec3};
use crate::registry::{ChoiceError, ParamSpec};
use crate::scene::Mesh;

use super::cases;
use super::dice::Dice;

/// A row of the registry of cases.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct CaseEntry {
    /// Kebab-case name.
    pub name: &'static str,
    /// One sentence: what is hard about it.
    pub about: &'static str,
    /// What the case is about: `edges`, `shapes`, `numbers`, `rays`, `cells` or `trees`.
    pub group: &'static str,
    /// Where the trap is known from.
    pub source: &'static str,
    /// What grows from rung to rung: `offset`, `scale`, …; empty where there is one rung only.
    pub quantity: &'static str,
    /// The rungs of the ladder, from harmless to hard.
    pub rungs: &'static [f64],
    /// Parameters; none so far.
    pub params: &'static [ParamSpec],
    /// Makes the scene and the rays of a rung.
    #[serde(skip)]
    pub make: fn(rung: f64, dice: &mut Dice) -> Setting,
}

/// A generated scene with its rays.
#[derive(Debug, Clone)]
pub struct Setting {
    /// The triangles.
    pub mesh: Arc<Mesh>,
    /// The rays, all valid.
    pub rays: Vec<Ray>,
    /// The resolution at which accelerators that have one are built.
    pub n: u32,
}

/// The resolution where a case does not care.
const N: u32 = 8;

impl Setting {
    /// Triangles by their corners, with rays. Triangles and rays whose numbers left the range of `f32` are left out.
    ///
    /// # Panics
    /// Never: what is left is a mesh.
    #[must_use]
    pub fn new(triangles: &[[Vec3; 3]], rays: impl IntoIterator<Item = Ray>) -> Self {
        Self {
            mesh: mesh(triangles),
            rays: rays.into_iter().filter(Ray::is_valid).collect(),
            n: N,
        }
    }

    /// The same at another resolution.
    #[must_use]
    pub fn at(self, n: u32) -> Self {
        Self { n, ..self }
    }
}

/// The mesh of the triangles that are finite.
pub(super) fn mesh(triangles: &[[Vec3; 3]]) -> Arc<Mesh> {
    let vertices: Vec<Vec3> = triangles
        .iter()
        .filter(|corners| corners.iter().all(|p| p.is_finite()))
        .flatten()
        .copied()
        .collect();
    let indices = (0..vertices.len() as u32 / 3)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    Arc::new(Mesh::new(vertices, indices).expect("finite corners, and indices by their count"))
}

impl CaseEntry {
    /// The scene and the rays of a rung. Depends on nothing but the case, the rung and the seed.
    #[must_use]
    pub fn setting(&self, rung: usize, seed: u64) -> Setting {
        (self.make)(self.rungs[rung], &mut Dice::new(seed, self.name, rung))
    }

    /// The rung as people read it: `offset 1e4`; empty where there is one only.
    #[must_use]
    pub fn label(&self, rung: usize) -> String {
        match self.quantity {
            "" => String::new(),
            quantity => format!("{quantity} {}", number(self.rungs[rung])),
        }
    }
}

/// A number as people write it: `0`, `8`, `0.01`, `1e4`, `1e-20`.
fn number(x: f64) -> String {
    if x == 0.0 || (1e-2..1e4).contains(&x.abs()) {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

/// The case named `name`.
///
/// # Errors
/// There is none; the message names the nearest.
pub fn case(name: &str) -> Result<&'static CaseEntry, ChoiceError> {
    let known = || cases::CASES.iter();
    known()
        .find(|c| c.name == name)
        .ok_or_else(|| ChoiceError::unknown("case", name, known().map(|c| c.name)))
}
