//! What is inspected: one ray through one scene with one kernel, in two accelerators beside each other.

use std::fmt;
use std::sync::Arc;

use super::picture::{Orbit, next_accel, next_kernel, next_n};
use super::slice::{Plane, Segment};
use crate::accel;
use crate::geometry::{Ray, Vec3};
use crate::lab::{Inspection, NRule, Place};
use crate::registry::Choice;
use crate::scene::Mesh;

/// Where the triangles come from.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// A scene spec, and where the scene is put.
    Spec(String, Place),
    /// A scene that was made for the purpose.
    Made(Made),
}

/// Triangles that have no spec.
#[derive(Clone)]
pub struct Made {
    /// What they are called.
    pub name: String,
    /// The triangles.
    pub mesh: Arc<Mesh>,
}

impl PartialEq for Made {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && Arc::ptr_eq(&self.mesh, &other.mesh)
    }
}

impl fmt::Debug for Made {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Made({})", self.name)
    }
}

impl Source {
    /// What the scene is called.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Spec(spec, _) => spec,
            Self::Made(made) => &made.name,
        }
    }

    /// The same with its place, where that is not its own: `teapot moved by 1e4`.
    #[must_use]
    pub fn title(&self) -> String {
        match self {
            Self::Spec(spec, place) if *place != Place::ITS_OWN => format!("{spec} {place}"),
            other => other.name().to_owned(),
        }
    }
}

/// Which ray.
#[derive(Debug, Clone, PartialEq)]
pub enum Aim {
    /// Through a point of a picture: (0, 0) is its upper left corner, `size` the lower right one.
    Point {
        /// How the view differs from the scene's own.
        orbit: Orbit,
        /// The point.
        at: (f32, f32),
        /// Width and height.
        size: (u32, u32),
    },
    /// This one, which is valid.
    Ray(Ray),
    /// The first of a ray set that the accelerator at the left decides wrongly.
    Wrong {
        /// Ray set spec.
        rays: String,
        /// Rays asked for.
        count: usize,
        /// Seed of the set.
        seed: u64,
    },
}

/// What is looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// The scene.
    pub source: Source,
    /// The ray.
    pub aim: Aim,
    /// Where the ray comes from, in words: `pixel 12,7 of 80x48`.
    pub origin: String,
    /// Kernel.
    pub kernel: Choice,
}

/// One of the two accelerators.
#[derive(Debug, Clone, PartialEq)]
pub struct Side {
    /// The accelerator.
    pub accel: Choice,
    /// Resolution, where it has one.
    pub n: NRule,
}

impl Side {
    fn named(name: &str) -> Self {
        let choice = accel::parse(name).or_else(|_| accel::parse(accel::ACCELERATORS[0].name));
        Self {
            accel: choice.unwrap_or(Choice {
                name: name.to_owned(),
                params: crate::registry::Params::default(),
            }),
            n: NRule::Auto,
        }
    }

    /// Whether the accelerator has a resolution.
    #[must_use]
    pub fn has_n(&self) -> bool {
        accel::entry(&self.accel.name).is_ok_and(|entry| entry.resolution.is_some())
    }
}

/// What is asked of the examiner.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Grows with each request; answers to older ones are out of date.
    pub serial: u64,
    /// What is looked at.
    pub subject: Subject,
    /// Through what.
    pub sides: [Side; 2],
}

/// What a ray did in one accelerator, and what is needed to draw it.
#[derive(Debug, Clone, PartialEq)]
pub struct Examined {
    /// Every step and every test, and whether the answer is right.
    pub inspection: Inspection,
    /// The ray itself.
    pub ray: Ray,
    /// Corners of triangles that were offered, ascending by index: those that were hit, and of the others as many as a
    /// drawing can use.
    pub corners: Vec<(u32, [Vec3; 3])>,
    /// Where each plane through the ray cuts the scene, in the order of [`Plane::ALL`].
    pub outlines: Arc<[Vec<Segment>; 3]>,
    /// From where to where the scene reaches along the ray, in units of length from the ray's origin.
    pub reach: [f64; 2],
}

/// What the examiner tells.
#[derive(Debug, Clone)]
pub enum InspectNews {
    /// What it is doing for a request.
    Doing {
        /// Of the request.
        serial: u64,
        /// E.g. "building bvh".
        what: String,
    },
    /// The ray that was looked for.
    Ray {
        /// Of the request.
        serial: u64,
        /// The ray.
        ray: Ray,
    },
    /// A side is done, or cannot be; why.
    Side {
        /// Of the request.
        serial: u64,
        /// Which side: 0 or 1.
        side: usize,
        /// What was found.
        found: Result<Arc<Examined>, String>,
    },
    /// The request as a whole cannot be met; why.
    Failed {
        /// Of the request.
        serial: u64,
        /// One sentence.
        why: String,
    },
}

/// The inspect screen.
#[derive(Debug, Clone, PartialEq)]
pub struct Inspect {
    /// What is looked at; `None` until a ray was chosen.
    pub subject: Option<Subject>,
    /// The accelerators, left and right.
    pub sides: [Side; 2],
    /// Which side has the keys.
    pub focus: usize,
    /// Which plane through the ray is drawn: the place in the ray's own order of planes.
    pub plane: usize,
    /// 1 shows the whole way, 2 half of it.
    pub zoom: f64,
    /// The request that stands.
    pub asked: Option<Request>,
    /// What the examiner is doing for it; empty when it is done.
    pub doing: String,
    /// Why it cannot be met.
    pub error: Option<String>,
    /// What was found.
    pub found: [Option<Result<Arc<Examined>, String>>; 2],
    /// The marked step of each side.
    pub marked: [usize; 2],
}

/// The greatest zoom: far below it, the last digits of `t` are wider than the screen.
const MOST_ZOOM: f64 = 1e9;

impl Inspect {
    /// No ray; the fastest tree beside the grid.
    #[must_use]
    pub fn new() -> Self {
        Self {
            subject: None,
            sides: [Side::named(accel::DEFAULT), Side::named("grid")],
            focus: 0,
            plane: 0,
            zoom: 1.0,
            asked: None,
            doing: String::new(),
            error: None,
            found: [None, None],
            marked: [0, 0],
        }
    }

    /// Looks at `subject` in `side`, beside the accelerator that stands at the right or, where that is the same, another.
    pub fn open(&mut self, subject: Subject, side: Side) {
        if self.sides[1].accel.name == side.accel.name {
            let grid = Side::named("grid");
            self.sides[1] = if side.accel.name == grid.accel.name {
                Side::named(accel::DEFAULT)
            } else {
                grid
            };
        }
        self.sides[0] = side;
        self.subject = Some(subject);
        self.focus = 0;
        self.plane = 0;
        self.zoom = 1.0;
        self.marked = [0, 0];
    }

    /// The request to be sent; `None` where there is no ray, or the request that stands will do.
    pub fn ask(&mut self) -> Option<Request> {
        let subject = self.subject.as_ref()?;
        let stands = |asked: &Request| asked.subject == *subject && asked.sides == self.sides;
        if self.asked.as_ref().is_some_and(stands) {
            return None;
        }
        let before = self.asked.as_ref();
        for side in 0..2 {
            let same = |asked: &Request| {
                asked.subject == *subject && asked.sides[side] == self.sides[side]
            };
            if !before.is_some_and(same) {
                self.found[side] = None;
            }
        }
        let request = Request {
            serial: before.map_or(1, |asked| asked.serial + 1),
            subject: subject.clone(),
            sides: self.sides.clone(),
        };
        self.asked = Some(request.clone());
        "waiting".clone_into(&mut self.doing);
        self.error = None;
        Some(request)
    }

    /// Takes in what the examiner tells; what belongs to an older request is dropped.
    pub fn take(&mut self, news: InspectNews) {
        let Some(serial) = self.asked.as_ref().map(|asked| asked.serial) else {
            return;
        };
        match news {
            InspectNews::Doing { serial: of, what } if of == serial => self.doing = what,
            InspectNews::Ray { serial: of, ray } if of == serial => self.settle(ray),
            InspectNews::Side {
                serial: of,
                side,
                found,
            } if of == serial && side < 2 => {
                self.found[side] = Some(found);
                if side == 1 {
                    self.doing.clear();
                }
                self.marked[side] = self.marked[side].min(self.steps(side).saturating_sub(1));
                self.follow();
            }
            InspectNews::Failed { serial: of, why } if of == serial => {
                self.doing.clear();
                self.error = Some(why);
            }
            _ => {}
        }
    }

    /// From now on it is this ray, whatever accelerator and kernel are chosen.
    fn settle(&mut self, ray: Ray) {
        let asked = self.asked.as_mut().map(|asked| &mut asked.subject);
        for subject in self.subject.iter_mut().chain(asked) {
            subject.aim = Aim::Ray(ray);
        }
    }

    /// What was found of a side.
    #[must_use]
    pub fn examined(&self, side: usize) -> Option<&Examined> {
        self.found[side].as_ref()?.as_deref().ok()
    }

    fn steps(&self, side: usize) -> usize {
        self.examined(side).map_or(0, |e| e.inspection.steps.len())
    }

    /// Moves the mark of the focused side; the other side's follows.
    pub fn step(&mut self, lines: isize) {
        let last = self.steps(self.focus).saturating_sub(1);
        let marked = &mut self.marked[self.focus];
        *marked = (*marked).min(last).saturating_add_signed(lines).min(last);
        self.follow();
    }

    /// Marks, on the side without the keys, the last step that has begun where the marked one begins.
    fn follow(&mut self) {
        let (focus, other) = (self.focus, 1 - self.focus);
        let entry = self.examined(focus).and_then(|e| {
            let step = e.inspection.steps.get(self.marked[focus])?;
            Some(step.entry)
        });
        let (Some(entry), Some(there)) = (entry, self.examined(other)) else {
            return;
        };
        // Nodes of a tree are not in the order of their entries, so the step that begins latest is looked for.
        let steps = there.inspection.steps.iter().enumerate();
        let latest = steps
            .filter(|(_, step)| step.entry <= entry)
            .max_by(|a, b| a.1.entry.total_cmp(&b.1.entry));
        self.marked[other] = latest.map_or(0, |(i, _)| i);
    }

    /// The plane that is drawn for a ray.
    #[must_use]
    pub fn plane_of(&self, ray: &Ray) -> Plane {
        let planes = Plane::across(ray);
        planes[self.plane % planes.len()]
    }

    /// The next plane.
    pub fn step_plane(&mut self) {
        self.plane = (self.plane + 1) % Plane::ALL.len();
    }

    /// Zooms by a factor; whether that changed anything.
    pub fn step_zoom(&mut self, factor: f64) -> bool {
        let before = self.zoom;
        self.zoom = (self.zoom * factor).clamp(1.0, MOST_ZOOM);
        self.zoom != before
    }

    /// Another accelerator on the focused side.
    pub fn step_accel(&mut self, steps: isize) {
        let side = &mut self.sides[self.focus];
        side.accel = next_accel(&side.accel, steps);
    }

    /// Another resolution on the focused side; whether it changed.
    pub fn step_n(&mut self, steps: isize) -> bool {
        let side = &mut self.sides[self.focus];
        let before = side.n;
        side.n = next_n(before, steps);
        side.n != before
    }

    /// Another kernel on both sides.
    pub fn step_kernel(&mut self) {
        if let Some(subject) = &mut self.subject {
            subject.kernel = next_kernel(&subject.kernel);
        }
    }
}

impl Default for Inspect {
    fn default() -> Self {
        Self::new()
    }
}
