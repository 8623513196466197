//! A scene of the matrix with its rays, and what brute force says of them, made once and shared by all cases.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock};

use raylab::accel::{self, Accelerator};
use raylab::geometry::lanes::InstructionSet;
use raylab::geometry::{DVec3, Hit, Ray, Vec3, gamma};
use raylab::oracle::{self, Oracle};
use raylab::registry::Choice;
use raylab::scene::Mesh;

use crate::{rays, scenes};

/// Ray/triangle tests that brute force may take for the rays of a scene.
const TESTS: usize = 600_000;

/// A scene and its rays.
pub struct Setting {
    pub name: String,
    pub mesh: Arc<Mesh>,
    /// Whether coordinates, and the distances between them, are those of an everyday scene.
    pub ordinary: bool,
    /// Values of n beside the predicted one.
    pub resolutions: &'static [u32],
    rays: OnceLock<Vec<Ray>>,
    oracle: OnceLock<Oracle>,
    brute: Mutex<BTreeMap<String, Arc<Answers>>>,
}

/// What brute force says of all rays.
pub struct Answers {
    pub hits: Vec<Hit>,
    pub blocked: Vec<bool>,
}

impl Setting {
    pub fn new(name: &str, mesh: Arc<Mesh>, ordinary: bool, resolutions: &'static [u32]) -> Self {
        Self {
            name: name.to_owned(),
            mesh,
            ordinary,
            resolutions,
            rays: OnceLock::new(),
            oracle: OnceLock::new(),
            brute: Mutex::new(BTreeMap::new()),
        }
    }

    /// The rays, fewer where the scene has many triangles.
    pub fn rays(&self) -> &[Ray] {
        self.rays.get_or_init(|| {
            let count = (TESTS / self.mesh.len().max(1)).clamp(300, 1400);
            rays::aimed_at(&self.mesh, count as u32, 1)
        })
    }

    /// Whether `ray` runs in the plane of the triangle that `hit` names as far as `f32` can say: then a kernel's
    /// determinant is nothing but a rounding error, and its hit may be anywhere.
    pub fn in_plane(&self, ray: &Ray, hit: &Hit) -> bool {
        if !hit.is_hit() {
            return false;
        }
        let [a, b, c] = self.mesh.corners(hit.prim).map(Vec3::as_dvec3);
        let (e1, e2, dir) = (b - a, c - a, ray.dir.as_dvec3());
        let products = dir.abs().dot(DVec3::new(
            (e1.y * e2.z).abs() + (e1.z * e2.y).abs(),
            (e1.z * e2.x).abs() + (e1.x * e2.z).abs(),
            (e1.x * e2.y).abs() + (e1.y * e2.x).abs(),
        ));
        dir.dot(e1.cross(e2)).abs() <= f64::from(gamma(8)) * products
    }

    /// Whether `kernel` finds anything among the triangles that `ray` really hits.
    pub fn rightly_blocked(&self, kernel: &Choice, ray: &Ray) -> Result<bool, String> {
        let hit: Vec<u32> = (0..self.mesh.len() as u32)
            .filter(|&prim| oracle::judge_triangle(ray, &self.mesh.corners(prim)).is_some())
            .collect();
        let only = scenes::mesh(
            &hit.iter()
                .map(|&p| self.mesh.corners(p))
                .collect::<Vec<_>>(),
        );
        let mut blocked = [false];
        brute(&only, kernel)?.occluded(&[*ray], &mut blocked);
        Ok(blocked[0])
    }

    pub fn oracle(&self) -> &Oracle {
        self.oracle.get_or_init(|| Oracle::new(&self.mesh))
    }

    /// Builds `accel` over the scene.
    pub fn build(
        &self,
        accel: &Choice,
        n: Option<u32>,
        kernel: &Choice,
    ) -> Result<Box<dyn Accelerator>, String> {
        self.build_for(InstructionSet::best(), accel, n, kernel)
    }

    /// As [`Setting::build`], to be traced with an instruction set.
    pub fn build_for(
        &self,
        set: InstructionSet,
        accel: &Choice,
        n: Option<u32>,
        kernel: &Choice,
    ) -> Result<Box<dyn Accelerator>, String> {
        accel::build_for(set, &self.mesh, accel, n, kernel, 4 << 30).map_err(|e| e.to_string())
    }

    /// Whether every answer is the oracle's: the lowest triangle of the nearest hits, `t` next to the true one.
    fn equals_the_truth(&self, answers: &Answers) -> Result<(), String> {
        for (i, ray) in self.rays().iter().enumerate() {
            let (hit, truth) = (&answers.hits[i], self.oracle().truth(ray));
            let prim = hit.is_hit().then_some(hit.prim);
            let near = truth.t.is_none_or(|t| {
                t.cmp_f32(hit.t.next_down()).is_ge() && t.cmp_f32(hit.t.next_up()).is_le()
            });
            if prim != truth.canonical() || !near || answers.blocked[i] != truth.is_hit() {
                return Err(format!(
                    "ray {i} {ray:?}: brute force with exact says {hit:?}, blocked: {}; truth: t {:?}, triangles {:?}",
                    answers.blocked[i],
                    truth.t.map(|t| t.to_f64()),
                    truth.tie_set
                ));
            }
        }
        Ok(())
    }

    /// What brute force with `kernel` answers.
    pub fn brute(&self, kernel: &Choice) -> Result<Arc<Answers>, String> {
        let mut known = self.brute.lock().map_err(|e| e.to_string())?;
        if let Some(answers) = known.get(&kernel.name) {
            return Ok(Arc::clone(answers));
        }
        let brute = brute(&self.mesh, kernel)?;
        let rays = self.rays();
        let mut answers = Answers {
            hits: vec![Hit::MISS; rays.len()],
            blocked: vec![false; rays.len()],
        };
        brute.closest(rays, &mut answers.hits);
        brute.occluded(rays, &mut answers.blocked);
        if kernel.name == crate::EXACT {
            self.equals_the_truth(&answers)?;
        }
        let answers = Arc::new(answers);
        known.insert(kernel.name.clone(), Arc::clone(&answers));
        Ok(answers)
    }
}

fn brute(mesh: &Arc<Mesh>, kernel: &Choice) -> Result<Box<dyn Accelerator>, String> {
    let choice = accel::parse("brute").map_err(|e| e.to_string())?;
    accel::build(mesh, &choice, None, kernel, u64::MAX).map_err(|e| e.to_string())
}
