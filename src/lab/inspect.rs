//! One ray under the magnifying glass: every step and test of a closest-hit query, and what the oracle says of its
//! answer.

use serde::Serialize;

use crate::accel::{self, Accelerator, PlaceKind, Visit};
use crate::geometry::{Aabb, Hit, Ray};
use crate::kernel;
use crate::oracle::{ExactT, Oracle};
use crate::registry::Choice;

/// Whose way through the scene is looked at.
#[derive(Debug, Clone, Copy)]
pub struct Subject<'a> {
    /// Scene spec.
    pub scene: &'a str,
    /// Accelerator and its parameters.
    pub accel: &'a Choice,
    /// The resolution that was built; `None` for accelerators without one.
    pub n: Option<u32>,
    /// Kernel and its parameters.
    pub kernel: &'a Choice,
}

/// What a ray did. In JSON, numbers that are infinite become `null`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Inspection {
    /// Scene spec.
    pub scene: String,
    /// Accelerator, with the parameters that are not the defaults.
    pub accel: String,
    /// The resolution that was built; `None` for accelerators without one.
    pub n: Option<u32>,
    /// Kernel, with the parameters that are not the defaults.
    pub kernel: String,
    /// The ray.
    pub ray: InspectedRay,
    /// The traversal's steps, in order.
    pub steps: Vec<Step>,
    /// Its answer; `None` for a miss.
    pub hit: Option<InspectedHit>,
    /// What the ray really hits.
    pub truth: InspectedTruth,
    /// Whether the answer is a triangle that the ray really hits first, or a miss where it hits nothing.
    pub right: bool,
}

/// A ray as it is reported.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct InspectedRay {
    /// Where `t` is 0.
    pub origin: [f32; 3],
    /// Direction and unit of `t`.
    pub dir: [f32; 3],
    /// Least accepted `t`.
    pub t_min: f32,
    /// Greatest accepted `t`; may be infinite.
    pub t_max: f32,
}

/// A traversal step.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Step {
    /// What was visited.
    pub kind: PlaceKind,
    /// Which one: the index of a cell (x fastest) or of a node.
    pub place: u64,
    /// The ray's `t` where it enters, as the structure computed it.
    pub entry: f64,
    /// The ray's `t` where it leaves; may be infinite.
    pub exit: f64,
    /// Triangles listed there.
    pub references: u32,
    /// Least and greatest corner, where the structure knows them.
    pub bounds: Option<[[f32; 3]; 2]>,
    /// What was offered, in order, until the traversal went on.
    pub tests: Vec<accel::Test>,
}

/// A hit as it is reported.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct InspectedHit {
    /// Triangle index in file order.
    pub prim: u32,
    /// Ray parameter.
    pub t: f32,
    /// Barycentric weight of vertex 1.
    pub u: f32,
    /// Barycentric weight of vertex 2.
    pub v: f32,
}

/// The oracle's answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InspectedTruth {
    /// All triangles hit at the least exact `t`, ascending; empty for a miss.
    pub prims: Vec<u32>,
    /// That `t`, rounded; `None` for a miss.
    pub t: Option<f64>,
}

impl From<Visit> for Step {
    fn from(visit: Visit) -> Self {
        let corners = |b: Aabb| [b.min.to_array(), b.max.to_array()];
        Self {
            kind: visit.kind,
            place: visit.place,
            entry: visit.entry,
            exit: visit.exit,
            references: visit.references,
            bounds: visit.bounds.map(corners),
            tests: visit.tests,
        }
    }
}

impl InspectedHit {
    fn of(hit: &Hit) -> Option<Self> {
        hit.is_hit().then_some(Self {
            prim: hit.prim,
            t: hit.t,
            u: hit.u,
            v: hit.v,
        })
    }
}

/// Follows a valid ray through `accelerator`, which was built as `subject` says, and judges its answer by `oracle`.
#[must_use]
pub fn inspect(
    subject: &Subject,
    accelerator: &dyn Accelerator,
    oracle: &Oracle,
    ray: &Ray,
) -> Inspection {
    let accel_params = accel::entry(&subject.accel.name).map_or(&[][..], |e| e.params);
    let kernel_params = kernel::entry(subject.kernel).map_or(&[][..], |e| e.params);
    let own_test = accel::entry(&subject.accel.name)
        .ok()
        .and_then(|entry| entry.own_test(&subject.accel.params));
    let recording = accelerator.inspect(ray);
    let truth = oracle.truth(ray);
    Inspection {
        scene: subject.scene.to_owned(),
        accel: subject.accel.label(accel_params),
        n: subject.n,
        kernel: match own_test {
            Some(test) => test.to_owned(),
            None => subject.kernel.label(kernel_params),
        },
        ray: InspectedRay {
            origin: ray.origin.to_array(),
            dir: ray.dir.to_array(),
            t_min: ray.t_min,
            t_max: ray.t_max,
        },
        steps: recording.visits.into_iter().map(Step::from).collect(),
        hit: InspectedHit::of(&recording.hit),
        right: truth.allows(&recording.hit),
        truth: InspectedTruth {
            t: truth.t.as_ref().map(ExactT::to_f64),
            prims: truth.tie_set,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec3;
    use crate::scene;

    fn inspected(spec: &str, accel: &str, ray: &Ray) -> Inspection {
        let scene = scene::load(spec).unwrap();
        let (accel, kernel) = (accel::parse(accel).unwrap(), kernel::parse("woop").unwrap());
        let built = accel::build(&scene.mesh, &accel, Some(3), &kernel, u64::MAX).unwrap();
        let subject = Subject {
            scene: spec,
            accel: &accel,
            n: Some(3),
            kernel: &kernel,
        };
        inspect(&subject, &*built, &Oracle::new(&scene.mesh), ray)
    }

    #[test]
    fn a_miss_has_no_hit_and_is_right_where_nothing_is() {
        let away = Ray::new(Vec3::splat(1e3), Vec3::ONE);
        let inspection = inspected("one", "bvh", &away);
        assert!(inspection.steps.is_empty() && inspection.hit.is_none() && inspection.right);
        assert!(inspection.truth.prims.is_empty() && inspection.truth.t.is_none());
    }

    #[test]
    fn steps_of_a_grid_are_adjacent_cells_and_the_hit_agrees_with_the_oracle() {
        let scene = scene::load("teapot:4").unwrap();
        let ray = scene.camera.ray(0.5, 0.5, 1, 1);
        let inspection = inspected("teapot:4", "grid:mailbox=off", &ray);
        assert_eq!(inspection.accel, "grid:mailbox=off");
        assert!(inspection.right);
        let hit = inspection.hit.expect("the camera looks at the teapot");
        assert!(inspection.truth.prims.contains(&hit.prim));
        let t = inspection.truth.t.expect("a hit");
        assert!((t - f64::from(hit.t)).abs() < 1e-4 * t);
        assert!(inspection.steps.iter().all(|s| s.kind == PlaceKind::Cell));
        for pair in inspection.steps.windows(2) {
            assert_eq!(pair[0].exit, pair[1].entry);
        }
    }
}
