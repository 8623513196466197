//! Peers over every scene. They are bound by no rule, so what is checked is that they build or say why not, that they
//! answer every ray with a triangle of the mesh within its interval, and that nothing panics; how often they are wrong is
//! counted and told.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use raylab::accel::{self, AcceleratorEntry, BuildError};
use raylab::kernel;
use raylab::registry::Choice;
use raylab::trace;

use crate::setting::Setting;

/// For each peer the wrong answers, and all of them.
pub type Wrong = Arc<Mutex<BTreeMap<String, (u64, u64)>>>;

/// One peer over one scene.
pub struct PeerCase {
    pub scene: Arc<Setting>,
    pub entry: &'static AcceleratorEntry,
    pub accel: Choice,
}

impl PeerCase {
    /// The peer with its parameters.
    pub fn label(&self) -> String {
        self.accel.label(self.entry.params)
    }
}

/// Checks what the head of this file promises.
pub fn check(case: &PeerCase, wrong: &Wrong) -> Result<(), String> {
    if let Some(why) = case.entry.standing().unavailable_because {
        // Told once at the end, by the row without rays.
        note(
            wrong,
            &format!("{} (not checked: {why})", case.accel.name),
            0,
            0,
        );
        return Ok(());
    }
    let woop = kernel::parse("woop").map_err(|e| e.to_string())?;
    let mesh = &case.scene.mesh;
    let built = match accel::build(mesh, &case.accel, None, &woop, 4 << 30) {
        Ok(built) => built,
        Err(BuildError::Unfit { why, .. }) if !why.is_empty() => return Ok(()),
        Err(why) => return Err(why.to_string()),
    };
    built.validate()?;
    let rays = case.scene.rays();
    let (hits, blocked) = (
        trace::closest(&*built, rays),
        trace::occluded(&*built, rays),
    );
    let oracle = case.scene.oracle();
    let mut mistakes = 0;
    for ((ray, hit), blocked) in rays.iter().zip(&hits).zip(blocked) {
        // Where the interval begins before 0, the ray was moved, and t is rounded.
        let within = hit.t >= ray.t_min && hit.t <= ray.t_max || ray.t_min < 0.0;
        if hit.is_hit() && (hit.prim as usize >= mesh.len() || !within) {
            return Err(format!("{ray:?} is answered with {hit:?}"));
        }
        mistakes += u64::from(!oracle.truth(ray).allows(hit));
        mistakes += u64::from(oracle.occluded(ray) != blocked);
    }
    note(wrong, &case.label(), mistakes, 2 * rays.len() as u64);
    Ok(())
}

fn note(wrong: &Wrong, label: &str, mistakes: u64, answers: u64) {
    if let Ok(mut wrong) = wrong.lock() {
        let row = wrong.entry(label.to_owned()).or_default();
        row.0 += mistakes;
        row.1 += answers;
    }
}
