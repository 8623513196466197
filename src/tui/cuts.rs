//! What a drawing of a ray needs of the scene: where planes through the ray cut it, how far it reaches, the triangles that
//! were offered.

use std::collections::BTreeSet;

use super::slice::{Frame, Plane, Segment};
use crate::geometry::{Ray, Vec3};
use crate::lab::Inspection;
use crate::scene::Mesh;

/// Most triangles whose corners are kept for the drawing, beside those that were hit: brute force offers all.
const MOST_CORNERS: usize = 4096;

/// Most segments of an outline: more than a large terminal has dots to show.
const MOST_SEGMENTS: usize = 20_000;

/// Where the planes through the ray cut the scene; empty for an axis along the ray.
pub(super) fn outlines(mesh: &Mesh, ray: &Ray) -> [Vec<Segment>; 3] {
    Plane::ALL.map(|plane| {
        Frame::new(ray, plane).map_or_else(Vec::new, |frame| {
            let all = 0..mesh.len() as u32;
            let cuts = all.flat_map(|prim| frame.cut(&mesh.corners(prim)));
            cuts.take(MOST_SEGMENTS).collect()
        })
    })
}

/// From where to where the scene reaches along the ray; a length of 1 for a scene without any.
pub(super) fn reach(mesh: &Mesh, ray: &Ray) -> [f64; 2] {
    let plane = Plane::across(ray).first().copied();
    let Some(frame) = plane.and_then(|plane| Frame::new(ray, plane)) else {
        return [0.0, 1.0];
    };
    let corners = mesh.bounds().corners();
    let along = corners.iter().map(|corner| frame.along(*corner));
    let (lo, hi) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| {
        (lo.min(x), hi.max(x))
    });
    if mesh.is_empty() || hi <= lo {
        let middle = if lo.is_finite() { lo } else { 0.5 };
        [middle - 0.5, middle + 0.5]
    } else {
        [lo, hi]
    }
}

/// The corners of what was offered: all that was hit, and of the rest what came first.
pub(super) fn corners(mesh: &Mesh, inspection: &Inspection) -> Vec<(u32, [Vec3; 3])> {
    let tests = || inspection.steps.iter().flat_map(|step| &step.tests);
    let hit = tests().filter(|test| test.t.is_some());
    let mut prims: BTreeSet<u32> = hit.take(MOST_CORNERS).map(|test| test.prim).collect();
    for test in tests() {
        if prims.len() >= MOST_CORNERS {
            break;
        }
        prims.insert(test.prim);
    }
    prims.extend(inspection.truth.prims.iter().take(MOST_CORNERS));
    prims
        .into_iter()
        .map(|prim| (prim, mesh.corners(prim)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel;
    use crate::lab::{self, Plan};
    use crate::oracle::Oracle;
    use crate::scene;
    use crate::tui::picture::Wish;

    #[test]
    fn brute_force_keeps_what_was_hit_and_no_more_than_can_be_drawn() {
        let scene = scene::load("soup:20000").unwrap();
        let ray = scene.camera.ray(0.5, 0.5, 1, 1);
        let brute = accel::parse("brute").unwrap();
        let kernel = Wish::first(&Plan::default()).kernel;
        let built = accel::build(&scene.mesh, &brute, None, &kernel, u64::MAX).unwrap();
        let subject = lab::Subject {
            scene: "soup:20000",
            accel: &brute,
            n: None,
            kernel: &kernel,
        };
        let inspection = lab::inspect(&subject, &*built, &Oracle::new(&scene.mesh), &ray);
        let kept = corners(&scene.mesh, &inspection);
        assert!(kept.len() <= 2 * MOST_CORNERS);
        let hit = inspection.hit.unwrap().prim;
        assert!(kept.iter().any(|(prim, _)| *prim == hit));
    }

    #[test]
    fn an_empty_scene_has_a_reach_that_can_be_drawn() {
        let scene = scene::load("empty").unwrap();
        let [lo, hi] = reach(&scene.mesh, &Ray::new(Vec3::ZERO, Vec3::X));
        assert!(lo < hi && (hi - lo).is_finite());
    }
}
