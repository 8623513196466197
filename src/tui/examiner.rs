//! The examiner thread: follows one ray through two accelerators, and cuts the scene by planes through the ray. While
//! something is measured it works only between samples.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::thread;

use super::app::Message;
use super::cuts::{corners, outlines, reach};
use super::desk::Desk;
use super::inspect::{Aim, Examined, InspectNews, Made, Request, Side, Source};
use super::slice::Segment;
use super::steering::Steering;
use super::studio::panic_message;
use super::update::Event;
use crate::accel::{self, Accelerator};
use crate::geometry::{Ray, Vec3};
use crate::lab::{self, NRule, Place, Subject};
use crate::oracle::Oracle;
use crate::registry::Choice;
use crate::scene::{self, Camera, Material, Scene};

/// Structures that are kept, so that going back to one is quick.
const KEPT: usize = 4;

/// The examiner as others see it.
#[derive(Debug, Clone)]
pub(super) struct Examiner {
    desk: Desk<Request>,
}

impl Examiner {
    /// Starts the thread. It tells `to` what it does.
    pub(super) fn spawn(memory_limit: u64, steering: Steering, to: Sender<Message>) -> Self {
        let desk = Desk::default();
        let worker = Worker {
            desk: desk.clone(),
            memory_limit,
            steering,
            to,
            stage: None,
            structures: Vec::new(),
        };
        thread::spawn(move || worker.run());
        Self { desk }
    }

    /// Asks for a ray instead of the one in work.
    pub(super) fn ask(&self, request: Request) {
        self.desk.ask(request);
    }
}

/// A scene with its oracle.
struct Stage {
    source: Source,
    scene: Scene,
    oracle: Oracle,
}

/// A structure that stands, and for what it was built.
struct Structure {
    side: Side,
    kernel: Choice,
    n: Option<u32>,
    accel: Box<dyn Accelerator>,
}

struct Worker {
    desk: Desk<Request>,
    memory_limit: u64,
    steering: Steering,
    to: Sender<Message>,
    stage: Option<Stage>,
    /// Of the stage's scene, the one used last first.
    structures: Vec<Structure>,
}

impl Worker {
    /// Serves requests for the rest of the program.
    fn run(mut self) {
        loop {
            let request = self.desk.wait();
            let serial = request.serial;
            let served = catch_unwind(AssertUnwindSafe(|| self.serve(&request)));
            let failed = match served {
                Ok(Ok(())) => None,
                Ok(Err(why)) => Some(why),
                Err(panic) => Some(panic_message(panic.as_ref())),
            };
            if let Some(why) = failed {
                self.tell(InspectNews::Failed { serial, why });
            }
        }
    }

    /// A program that is ending no longer listens.
    fn tell(&self, news: InspectNews) {
        let _ = self.to.send(Message::News(Event::Inspect(news)));
    }

    fn doing(&self, request: &Request, what: impl Into<String>) {
        let (serial, what) = (request.serial, what.into());
        self.tell(InspectNews::Doing { serial, what });
    }

    fn serve(&mut self, request: &Request) -> Result<(), String> {
        let steering = self.steering.clone();
        if steering.is_timed() {
            self.doing(request, "waits for a gap in the measurement");
        }
        let Some(_hold) = steering.hold(|| self.desk.cancelled()) else {
            return Ok(());
        };
        self.enter(request)?;
        let Some(stage) = &self.stage else {
            return Ok(());
        };
        let ray = match &request.subject.aim {
            Aim::Ray(ray) => *ray,
            &Aim::Point {
                orbit,
                at: (x, y),
                size: (width, height),
            } => {
                let camera =
                    (stage.scene.camera).orbited(orbit.azimuth, orbit.elevation, orbit.zoom);
                camera.ray(x, y, width, height)
            }
            Aim::Wrong { rays, count, seed } => {
                let (rays, asked) = (rays.clone(), (*count, *seed));
                let Some(ray) = self.wrong(request, &rays, asked)? else {
                    return Ok(());
                };
                self.tell(InspectNews::Ray {
                    serial: request.serial,
                    ray,
                });
                ray
            }
        };
        let Some(stage) = &self.stage else {
            return Ok(());
        };
        if !ray.is_valid() {
            return Err("the view has no ray there; choose another point".to_owned());
        }
        let outlines = Arc::new(outlines(&stage.scene.mesh, &ray));
        for (side, wanted) in request.sides.iter().enumerate() {
            if self.desk.cancelled() {
                return Ok(());
            }
            let found = self.examine(request, wanted, &ray, &outlines);
            self.tell(InspectNews::Side {
                serial: request.serial,
                side,
                found: found.map(Arc::new),
            });
        }
        Ok(())
    }

    /// Makes `self.stage` the scene that is asked for.
    fn enter(&mut self, request: &Request) -> Result<(), String> {
        let source = &request.subject.source;
        if self.stage.as_ref().is_some_and(|s| s.source == *source) {
            return Ok(());
        }
        self.structures.clear();
        self.stage = None;
        let scene = match source {
            Source::Spec(spec, place) => {
                self.doing(request, format!("loading {spec}"));
                let scene = scene::load(spec).map_err(|error| error.to_string())?;
                lab::placed(&scene, *place).map_err(|error| error.to_string())?
            }
            Source::Made(made) => bare(made),
        };
        self.stage = Some(Stage {
            source: source.clone(),
            oracle: Oracle::new(&scene.mesh),
            scene,
        });
        Ok(())
    }

    /// The first ray of a set that the accelerator at the left decides wrongly; `None` when given up.
    fn wrong(
        &mut self,
        request: &Request,
        rays: &str,
        (count, seed): (usize, u64),
    ) -> Result<Option<Ray>, String> {
        self.build(request, &request.sides[0])?;
        self.doing(request, format!("asking the oracle about {rays} rays"));
        let (Some(stage), Some(structure)) = (&self.stage, self.structures.first()) else {
            return Err("there is no scene".to_owned());
        };
        let place = match &stage.source {
            Source::Spec(_, place) => *place,
            Source::Made(_) => Place::ITS_OWN,
        };
        let set = lab::placed_rays(&stage.scene, place, rays, count, seed);
        let set = set.map_err(|error| error.to_string())?;
        let (mesh, accel) = (&stage.scene.mesh, structure.accel.as_ref());
        let given_up = || self.desk.cancelled();
        let found = lab::first_wrong(mesh, &stage.oracle, accel, &set.rays, given_up);
        match found {
            Some(at) => Ok(Some(set.rays[at])),
            None if self.desk.cancelled() => Ok(None),
            None => Err(format!(
                "none of the {rays} rays is decided wrongly here; Esc goes back"
            )),
        }
    }

    /// Follows the ray through one accelerator.
    fn examine(
        &mut self,
        request: &Request,
        side: &Side,
        ray: &Ray,
        outlines: &Arc<[Vec<Segment>; 3]>,
    ) -> Result<Examined, String> {
        self.build(request, side)?;
        let (Some(stage), Some(structure)) = (&self.stage, self.structures.first()) else {
            return Err("there is no scene".to_owned());
        };
        let subject = Subject {
            scene: stage.source.name(),
            accel: &side.accel,
            n: structure.n,
            kernel: &structure.kernel,
        };
        let inspection = lab::inspect(&subject, structure.accel.as_ref(), &stage.oracle, ray);
        Ok(Examined {
            corners: corners(&stage.scene.mesh, &inspection),
            reach: reach(&stage.scene.mesh, ray),
            inspection,
            ray: *ray,
            outlines: Arc::clone(outlines),
        })
    }

    /// Makes the first of `self.structures` the one that is asked for.
    fn build(&mut self, request: &Request, side: &Side) -> Result<(), String> {
        let kernel = &request.subject.kernel;
        let serves = |s: &Structure| s.side == *side && s.kernel == *kernel;
        if let Some(at) = self.structures.iter().position(serves) {
            self.structures[..=at].rotate_right(1);
            return Ok(());
        }
        let Some(stage) = &self.stage else {
            return Ok(());
        };
        self.doing(request, format!("building {}", side.accel.name));
        let entry = accel::entry(&side.accel.name).map_err(|error| error.to_string())?;
        let mesh = &stage.scene.mesh;
        let n = entry.resolution.map(|resolution| match side.n {
            NRule::Auto => (resolution.auto)(mesh, &side.accel.params),
            NRule::Fixed(n) => n,
        });
        let accel = accel::build(mesh, &side.accel, n, kernel, self.memory_limit)
            .map_err(|error| error.to_string())?;
        self.structures.truncate(KEPT - 1);
        let structure = Structure {
            side: side.clone(),
            kernel: kernel.clone(),
            n,
            accel,
        };
        self.structures.insert(0, structure);
        Ok(())
    }
}

/// A scene of triangles alone.
fn bare(made: &Made) -> Scene {
    Scene {
        name: made.name.clone(),
        about: String::new(),
        mesh: Arc::clone(&made.mesh),
        materials: vec![Material::default()],
        material_of: vec![0; made.mesh.len()],
        lights: Vec::new(),
        camera: Camera::framing(made.mesh.bounds(), Vec3::Y),
        background: Vec3::ZERO,
        warnings: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, channel};

    use super::*;
    use crate::lab::Plan;
    use crate::tui::inspect::{Inspect, Subject};
    use crate::tui::picture::{Orbit, Wish};

    fn examiner() -> (Examiner, Receiver<Message>) {
        let (to, from) = channel();
        (Examiner::spawn(1 << 30, Steering::default(), to), from)
    }

    fn request(source: Source, aim: Aim) -> Request {
        Request {
            serial: 1,
            subject: Subject {
                source,
                aim,
                origin: String::new(),
                kernel: Wish::first(&Plan::default()).kernel,
            },
            sides: Inspect::new().sides,
        }
    }

    const MIDDLE: Aim = Aim::Point {
        orbit: Orbit::HOME,
        at: (10.0, 10.0),
        size: (20, 20),
    };

    /// What is told up to the second side or the failure.
    fn told(from: &Receiver<Message>) -> Vec<InspectNews> {
        let mut all = Vec::new();
        while let Ok(Message::News(Event::Inspect(news))) = from.recv() {
            let last = matches!(
                news,
                InspectNews::Side { side: 1, .. } | InspectNews::Failed { .. }
            );
            all.push(news);
            if last {
                break;
            }
        }
        all
    }

    fn found(news: &[InspectNews]) -> Vec<Arc<Examined>> {
        let sides = news.iter().filter_map(|news| match news {
            InspectNews::Side { found, .. } => Some(Arc::clone(found.as_ref().unwrap())),
            _ => None,
        });
        sides.collect()
    }

    #[test]
    fn both_accelerators_follow_the_same_ray_to_the_same_answer() {
        let (examiner, from) = examiner();
        examiner.ask(request(
            Source::Spec("teapot:4".to_owned(), Place::ITS_OWN),
            MIDDLE,
        ));
        let sides = found(&told(&from));
        assert_eq!(sides.len(), 2);
        assert_eq!(sides[0].ray, sides[1].ray);
        assert_eq!(sides[0].inspection.hit, sides[1].inspection.hit);
        assert!(sides[0].inspection.hit.is_some());
        for side in &sides {
            let offered = side.inspection.steps.iter().flat_map(|s| &s.tests);
            for test in offered {
                assert!(
                    side.corners
                        .binary_search_by_key(&test.prim, |c| c.0)
                        .is_ok()
                );
            }
            assert!(side.outlines.iter().all(|outline| !outline.is_empty()));
            let hit = f64::from(side.inspection.hit.unwrap().t);
            assert!((side.reach[0]..side.reach[1]).contains(&hit));
        }
    }

    #[test]
    fn a_scene_that_was_made_needs_no_name_and_one_that_is_missing_says_so() {
        let (examiner, from) = examiner();
        let made = Made {
            name: "case".to_owned(),
            mesh: scene::load("one").unwrap().mesh,
        };
        let ray = Ray::new(Vec3::new(0.1, 0.1, 5.0), Vec3::NEG_Z);
        examiner.ask(request(Source::Made(made), Aim::Ray(ray)));
        let sides = found(&told(&from));
        assert_eq!((sides.len(), sides[0].ray), (2, ray));
        examiner.ask(request(
            Source::Spec("missing.obj".to_owned(), Place::ITS_OWN),
            MIDDLE,
        ));
        let news = told(&from);
        let Some(InspectNews::Failed { why, .. }) = news.last() else {
            panic!("{news:?}");
        };
        assert!(why.contains("missing.obj"));
    }

    #[test]
    fn a_ray_that_is_decided_wrongly_is_found_and_stays_the_ray() {
        let (examiner, from) = examiner();
        let far = Place {
            offset: 1e4,
            scale: 1.0,
        };
        let mut request = request(
            Source::Spec("sphereflake:1".to_owned(), far),
            Aim::Wrong {
                rays: "edge".to_owned(),
                count: 4096,
                seed: 1,
            },
        );
        request.subject.kernel = crate::kernel::parse("sheet-signed").unwrap();
        examiner.ask(request);
        let news = told(&from);
        let ray = news.iter().find_map(|news| match news {
            InspectNews::Ray { ray, .. } => Some(*ray),
            _ => None,
        });
        let sides = found(&news);
        assert_eq!(Some(sides[0].ray), ray);
        assert!(!sides[0].inspection.right);
    }
}
