//! The picture: what is wished for, what was asked of the picture thread, what it has shown.

use crate::accel::{self, ACCELERATORS};
use crate::kernel;
use crate::lab::{NRule, Place, Plan};
use crate::preview::{Cells, SYMBOLS, Symbols};
use crate::registry::{Choice, Params};
use crate::scene::SCENES;
use crate::shade::{CHANNELS, Channel, Legend};

/// How the view differs from the scene's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// Radians around the scene's up axis.
    pub azimuth: f32,
    /// Radians upwards.
    pub elevation: f32,
    /// Distance over the camera's own.
    pub zoom: f32,
}

impl Orbit {
    /// The scene's own view.
    pub const HOME: Self = Self {
        azimuth: 0.0,
        elevation: 0.0,
        zoom: 1.0,
    };
}

/// What a picture shows and through which structure.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    /// Scene spec.
    pub scene: String,
    /// Where it is, and how large.
    pub place: Place,
    /// From where.
    pub orbit: Orbit,
    /// Accelerator.
    pub accel: Choice,
    /// Resolution, where the accelerator has one.
    pub n: NRule,
    /// Kernel.
    pub kernel: Choice,
    /// Channel.
    pub channel: &'static Channel,
    /// Symbols; they decide how many pixels a cell has.
    pub symbols: Symbols,
}

/// The resolutions that the keys step through; auto first.
pub const N_STEPS: [NRule; 11] = [
    NRule::Auto,
    NRule::Fixed(1),
    NRule::Fixed(2),
    NRule::Fixed(4),
    NRule::Fixed(8),
    NRule::Fixed(16),
    NRule::Fixed(32),
    NRule::Fixed(64),
    NRule::Fixed(128),
    NRule::Fixed(256),
    NRule::Fixed(512),
];

impl Wish {
    /// The first picture of a session: the first scene of the plan through the fastest accelerator there is.
    #[must_use]
    pub fn first(plan: &Plan) -> Self {
        let choice = |name: &str, fallback: &str, parse: fn(&str) -> Option<Choice>| {
            parse(name).or_else(|| parse(fallback)).unwrap_or(Choice {
                name: fallback.to_owned(),
                params: Params::default(),
            })
        };
        Self {
            scene: plan
                .scenes
                .first()
                .cloned()
                .unwrap_or_else(|| SCENES[0].name.to_owned()),
            place: Place::ITS_OWN,
            orbit: Orbit::HOME,
            accel: choice("bvh", ACCELERATORS[0].name, |name| accel::parse(name).ok()),
            n: NRule::Auto,
            kernel: choice("woop", kernel::KERNELS[0].name, |name| {
                kernel::parse(name).ok()
            }),
            channel: &CHANNELS[0],
            symbols: Symbols::default(),
        }
    }

    /// Whether the accelerator has a resolution.
    #[must_use]
    pub fn has_n(&self) -> bool {
        accel::entry(&self.accel.name).is_ok_and(|entry| entry.resolution.is_some())
    }

    /// Takes the accelerator `steps` further round, with its default parameters.
    pub fn step_accel(&mut self, steps: isize) {
        self.accel = next_accel(&self.accel, steps);
    }

    /// Takes the next kernel that is no control, with its default parameters.
    pub fn step_kernel(&mut self) {
        self.kernel = next_kernel(&self.kernel);
    }

    /// Takes a finer or coarser grid; stays at the ends. Returns whether it changed.
    pub fn step_n(&mut self, steps: isize) -> bool {
        let before = self.n;
        self.n = next_n(before, steps);
        self.n != before
    }

    /// Takes the next channel.
    pub fn step_channel(&mut self) {
        self.channel = turned(CHANNELS, |c| *c == *self.channel, 1);
    }

    /// Takes the next kind of symbols.
    pub fn step_symbols(&mut self) {
        self.symbols = *turned(SYMBOLS, |s| *s == self.symbols, 1);
    }

    /// Takes the scene `steps` further round: those of the plan and all of the registry.
    pub fn step_scene(&mut self, plan: &[String], steps: isize) {
        let mut scenes: Vec<&str> = plan.iter().map(String::as_str).collect();
        for row in SCENES {
            if !scenes.contains(&row.name) {
                scenes.push(row.name);
            }
        }
        let scene = (*turned(&scenes, |s| *s == self.scene, steps)).to_owned();
        if scene != self.scene {
            self.scene = scene;
            self.place = Place::ITS_OWN;
            self.orbit = Orbit::HOME;
        }
    }
}

/// The accelerator `steps` further round, with its default parameters.
pub(super) fn next_accel(accel: &Choice, steps: isize) -> Choice {
    let name = turned(ACCELERATORS, |a| a.name == accel.name, steps).name;
    accel::parse(name).unwrap_or_else(|_| accel.clone())
}

/// The next kernel that is no control, with its default parameters.
pub(super) fn next_kernel(kernel: &Choice) -> Choice {
    let methods: Vec<_> = kernel::methods().collect();
    let name = turned(&methods, |k| k.name == kernel.name, 1).name;
    kernel::parse(name).unwrap_or_else(|_| kernel.clone())
}

/// The resolution `steps` further along [`N_STEPS`]; stays at the ends.
pub(super) fn next_n(n: NRule, steps: isize) -> NRule {
    let at = N_STEPS.iter().position(|&step| step == n).unwrap_or(0);
    N_STEPS[at.saturating_add_signed(steps).min(N_STEPS.len() - 1)]
}

/// The element `steps` further round from the one that `is` finds; the first where none is found.
fn turned<T>(all: &[T], is: impl Fn(&T) -> bool, steps: isize) -> &T {
    let to = all.iter().position(is).map_or(0, |at| {
        (at as isize + steps).rem_euclid(all.len() as isize) as usize
    });
    &all[to]
}

/// What is asked of the picture thread.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Grows with each request; answers to older ones are out of date.
    pub serial: u64,
    /// What is to be seen.
    pub wish: Wish,
    /// Columns and rows of cells.
    pub cells: (u16, u16),
}

/// What the structure behind a picture costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// Triangles of the scene.
    pub triangles: u64,
    /// Resolution that was built.
    pub n: Option<u32>,
    /// Build time.
    pub build_ms: f64,
    /// Structure and packed triangles.
    pub memory_bytes: u64,
    /// Speed of the picture's primary rays, all threads; no measurement, but an impression.
    pub mrays_per_s: f64,
    /// Cells or nodes that a primary ray visits, mean; `None` of a peer, which counts nothing.
    pub steps: Option<f64>,
    /// Tests of a primary ray, mean; `None` of a peer.
    pub tests: Option<f64>,
    /// Share of the primary rays that hit.
    pub hit_share: f64,
}

/// What the picture thread tells.
#[derive(Debug, Clone)]
pub enum PictureNews {
    /// What it is doing for a request.
    Doing {
        /// Of the request.
        serial: u64,
        /// E.g. "loading teapot".
        what: String,
    },
    /// A pass is done.
    Shown(Box<Shown>),
    /// The last pass is done.
    Finished {
        /// Of the request.
        serial: u64,
        /// What the structure costs.
        figures: Box<Figures>,
    },
    /// The request cannot be met; why.
    Failed {
        /// Of the request.
        serial: u64,
        /// One sentence.
        why: String,
    },
}

/// The picture that was shown last.
#[derive(Debug, Clone, PartialEq)]
pub struct Shown {
    /// What was asked for.
    pub request: Request,
    /// The picture.
    pub cells: Cells,
    /// What its colours mean, where they stand for numbers.
    pub legend: Option<Legend>,
    /// What the scene was found to need.
    pub found: String,
}

/// The picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// What is wished for.
    pub wish: Wish,
    /// The request that stands.
    pub asked: Option<Request>,
    /// What was shown last, for this request or one before.
    pub shown: Option<Shown>,
    /// What the structure costs, of the last finished picture.
    pub figures: Option<Figures>,
    /// What the picture thread is doing for the request that stands; empty when it is done.
    pub doing: String,
    /// Why the request that stands cannot be met.
    pub error: Option<String>,
    /// The cell of the picture that a ray is chosen by: column and row.
    pub cursor: Option<(u16, u16)>,
}

impl Picture {
    /// No picture yet.
    #[must_use]
    pub fn new(wish: Wish) -> Self {
        Self {
            wish,
            asked: None,
            shown: None,
            figures: None,
            doing: String::new(),
            error: None,
            cursor: None,
        }
    }

    /// The request to be sent when `cells` of the screen show the picture; `None` where the one that stands will do.
    pub fn ask(&mut self, cells: (u16, u16)) -> Option<Request> {
        let stands = |asked: &Request| asked.wish == self.wish && asked.cells == cells;
        if cells.0 == 0 || cells.1 == 0 || self.asked.as_ref().is_some_and(stands) {
            return None;
        }
        let request = Request {
            serial: self.asked.as_ref().map_or(1, |asked| asked.serial + 1),
            wish: self.wish.clone(),
            cells,
        };
        self.asked = Some(request.clone());
        "waiting".clone_into(&mut self.doing);
        self.error = None;
        Some(request)
    }

    /// Takes in what the picture thread tells; what belongs to an older request is dropped.
    pub fn take(&mut self, news: PictureNews) {
        let Some(serial) = self.asked.as_ref().map(|asked| asked.serial) else {
            return;
        };
        match news {
            PictureNews::Doing { serial: of, what } if of == serial => self.doing = what,
            PictureNews::Shown(shown) if shown.request.serial == serial => {
                self.shown = Some(*shown);
            }
            PictureNews::Finished {
                serial: of,
                figures,
            } if of == serial => {
                self.figures = Some(*figures);
                self.doing.clear();
            }
            PictureNews::Failed { serial: of, why } if of == serial => {
                self.doing.clear();
                self.figures = None;
                self.error = Some(why);
            }
            _ => {}
        }
    }

    /// The figures, where they belong to what is wished for now and not to an earlier picture.
    #[must_use]
    pub fn current_figures(&self) -> Option<&Figures> {
        let current =
            self.asked.as_ref().map(|a| a.serial) == self.shown.as_ref().map(|s| s.request.serial);
        self.figures
            .as_ref()
            .filter(|_| current && self.doing.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> Picture {
        Picture::new(Wish::first(&Plan::default()))
    }

    #[test]
    fn a_request_is_sent_once_and_again_when_the_wish_or_the_size_changes() {
        let mut picture = picture();
        assert_eq!(picture.ask((0, 5)), None);
        assert_eq!(picture.ask((10, 5)).map(|r| r.serial), Some(1));
        assert_eq!(picture.ask((10, 5)), None);
        assert_eq!(picture.ask((12, 5)).map(|r| r.serial), Some(2));
        picture.wish.step_channel();
        assert_eq!(picture.ask((12, 5)).map(|r| r.serial), Some(3));
    }

    #[test]
    fn answers_to_older_requests_are_dropped() {
        let mut picture = picture();
        picture.ask((10, 5));
        picture.wish.step_channel();
        picture.ask((10, 5));
        picture.take(PictureNews::Failed {
            serial: 1,
            why: "old".to_owned(),
        });
        assert_eq!(picture.error, None);
        picture.take(PictureNews::Failed {
            serial: 2,
            why: "new".to_owned(),
        });
        assert_eq!(picture.error.as_deref(), Some("new"));
    }

    #[test]
    fn stepping_goes_round_every_accelerator_kernel_and_channel() {
        let mut wish = picture().wish;
        let (accel, kernel, channel) = (wish.accel.clone(), wish.kernel.clone(), wish.channel);
        for _ in 0..ACCELERATORS.len() {
            wish.step_accel(1);
        }
        for _ in kernel::methods() {
            wish.step_kernel();
        }
        for _ in 0..CHANNELS.len() {
            wish.step_channel();
        }
        assert_eq!((wish.accel.clone(), wish.kernel.clone()), (accel, kernel));
        assert_eq!(wish.channel, channel);
        wish.step_accel(1);
        wish.step_accel(-1);
        assert_eq!(wish.accel.name, picture().wish.accel.name);
    }

    #[test]
    fn the_resolution_stays_at_its_ends() {
        let mut wish = picture().wish;
        assert!(!wish.step_n(-1));
        for _ in 0..N_STEPS.len() - 1 {
            assert!(wish.step_n(1));
        }
        assert!(!wish.step_n(1));
    }

    #[test]
    fn another_scene_is_seen_from_its_own_view() {
        let mut wish = picture().wish;
        wish.orbit.zoom = 2.0;
        wish.step_scene(&["mine.obj".to_owned(), wish.scene.clone()], -1);
        assert_eq!(wish.scene, "mine.obj");
        assert_eq!(wish.orbit, Orbit::HOME);
    }
}
