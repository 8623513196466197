//! The picture thread: loads scenes, builds structures, renders pass by pass. A newer request ends an older one within a
//! tile; while a sweep runs, a picture is made only between its samples.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::thread;
use std::time::{Duration, Instant};

use super::app::Message;
use super::desk::Desk;
use super::picture::{Figures, PictureNews, Request, Shown, Wish};
use super::steering::Steering;
use super::update::Event;
use crate::accel::{self, Accelerator};
use crate::geometry::{Hit, Ray};
use crate::lab::{self, NRule, Place};
use crate::preview::{Cells, ColorMode, pixel_size};
use crate::scene::{self, Scene};
use crate::shade::{PASSES, Pass, View};
use crate::trace;

/// Scenes that are kept, so that going back to one is quick.
const KEPT_SCENES: usize = 3;

/// How long the speed of a picture is measured: an impression, not a measurement.
const IMPRESSION: Duration = Duration::from_millis(60);

/// Rays a thread that are traced before anyone asks whether to go on, at first.
const FIRST_SLICE: usize = 256;

/// Where a slice took less than this, the next has twice as many.
const SOON: Duration = Duration::from_millis(5);

/// Most rays whose work is counted: brute force on a large scene should not hold the picture up.
const MOST_COUNTED: usize = 4096;

/// The picture thread as others see it.
#[derive(Debug, Clone)]
pub(super) struct Studio {
    desk: Desk<Request>,
}

impl Studio {
    /// Starts the thread. It tells `to` what it does.
    pub(super) fn spawn(
        mode: ColorMode,
        memory_limit: u64,
        steering: Steering,
        to: Sender<Message>,
    ) -> Self {
        let desk = Desk::default();
        let worker = Worker {
            desk: desk.clone(),
            mode,
            memory_limit,
            steering,
            to,
            scenes: Vec::new(),
            structure: None,
        };
        thread::spawn(move || worker.run());
        Self { desk }
    }

    /// Asks for a picture instead of the one in work.
    pub(super) fn ask(&self, request: Request) {
        self.desk.ask(request);
    }
}

/// A structure that stands, and for what it was built.
struct Structure {
    /// Whether it counts work: peers do not.
    counts: bool,
    wish: Wish,
    n: Option<u32>,
    build_ms: f64,
    accel: Box<dyn Accelerator>,
}

impl Structure {
    /// Whether it is what `wish` asks for.
    fn serves(&self, wish: &Wish) -> bool {
        let same_n = self.n.is_none() || self.wish.n == wish.n;
        self.wish.scene == wish.scene
            && self.wish.place == wish.place
            && self.wish.accel == wish.accel
            && self.wish.kernel == wish.kernel
            && same_n
    }
}

struct Worker {
    desk: Desk<Request>,
    mode: ColorMode,
    memory_limit: u64,
    steering: Steering,
    to: Sender<Message>,
    scenes: Vec<(String, Place, Arc<Scene>)>,
    structure: Option<Structure>,
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
                self.tell(PictureNews::Failed { serial, why });
            }
        }
    }

    fn cancelled(&self) -> bool {
        self.desk.cancelled()
    }

    /// A program that is ending no longer listens.
    fn tell(&self, news: PictureNews) {
        let _ = self.to.send(Message::News(Event::Picture(news)));
    }

    fn doing(&self, request: &Request, what: impl Into<String>) {
        self.tell(PictureNews::Doing {
            serial: request.serial,
            what: what.into(),
        });
    }

    fn serve(&mut self, request: &Request) -> Result<(), String> {
        let steering = self.steering.clone();
        if steering.is_timed() {
            self.doing(request, "waits for a gap in the sweep");
        }
        let Some(_hold) = steering.hold(|| self.cancelled()) else {
            return Ok(());
        };
        let wish = &request.wish;
        let scene = self.scene(request)?;
        if self.cancelled() {
            return Ok(());
        }
        self.build(request, &scene)?;
        let Some(structure) = &self.structure else {
            return Ok(());
        };
        self.doing(request, "rendering");
        let camera =
            scene
                .camera
                .orbited(wish.orbit.azimuth, wish.orbit.elevation, wish.orbit.zoom);
        let (columns, rows) = request.cells;
        let (width, height) = pixel_size(columns, rows, &wish.symbols);
        let view = View {
            scene: &scene,
            camera: &camera,
            accel: structure.accel.as_ref(),
            channel: wish.channel,
            width,
            height,
        };
        for pass in PASSES {
            if !self.show(request, &view, pass) {
                return Ok(());
            }
        }
        let rays: Vec<Ray> = (0..width * height)
            .map(|i| {
                let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
                camera.ray(x, y, width, height)
            })
            .collect();
        if let Some(figures) = self.figures(&scene, structure, &rays) {
            let (serial, figures) = (request.serial, Box::new(figures));
            self.tell(PictureNews::Finished { serial, figures });
        }
        Ok(())
    }

    /// Renders and shows one pass; whether it was not cancelled.
    fn show(&self, request: &Request, view: &View, pass: Pass) -> bool {
        let Some(rendered) = view.pass(pass, self.desk.cancel()) else {
            return false;
        };
        let (columns, rows) = request.cells;
        let symbols = &request.wish.symbols;
        let mut cells = Cells::of(&rendered.image, columns, rows, symbols, self.mode);
        if self.mode == ColorMode::True {
            // Fewer bytes to send, hardly a difference to see.
            cells = cells.coarsened();
        }
        self.tell(PictureNews::Shown(Box::new(Shown {
            request: request.clone(),
            cells,
            legend: rendered.legend,
            found: rendered.stats.found,
        })));
        true
    }

    fn scene(&mut self, request: &Request) -> Result<Arc<Scene>, String> {
        let (name, place) = (&request.wish.scene, request.wish.place);
        let kept = |(of, at, _): &(String, Place, Arc<Scene>)| of == name && *at == place;
        if let Some(at) = self.scenes.iter().position(kept) {
            self.scenes[..=at].rotate_right(1);
            return Ok(Arc::clone(&self.scenes[0].2));
        }
        self.doing(request, format!("loading {name}"));
        let scene = scene::load(name).map_err(|error| error.to_string())?;
        let placed = lab::placed(&scene, place).map_err(|error| error.to_string())?;
        let scene = Arc::new(placed);
        self.scenes
            .insert(0, (name.clone(), place, Arc::clone(&scene)));
        self.scenes.truncate(KEPT_SCENES);
        Ok(scene)
    }

    /// Makes `self.structure` the one that is wished for.
    fn build(&mut self, request: &Request, scene: &Scene) -> Result<(), String> {
        let wish = &request.wish;
        if self.structure.as_ref().is_some_and(|s| s.serves(wish)) {
            return Ok(());
        }
        // The old one goes first: two large ones might not fit.
        self.structure = None;
        self.doing(request, format!("building {}", wish.accel.name));
        let entry = accel::entry(&wish.accel.name).map_err(|error| error.to_string())?;
        let n = entry.resolution.map(|resolution| match wish.n {
            NRule::Auto => (resolution.auto)(&scene.mesh, &wish.accel.params),
            NRule::Fixed(n) => n,
        });
        let start = Instant::now();
        let accel = accel::build(&scene.mesh, &wish.accel, n, &wish.kernel, self.memory_limit)
            .map_err(|error| error.to_string())?;
        self.structure = Some(Structure {
            counts: entry.peer.is_none(),
            wish: wish.clone(),
            n,
            build_ms: start.elapsed().as_secs_f64() * 1e3,
            accel,
        });
        Ok(())
    }

    /// What the structure costs on these rays; `None` when cancelled first.
    fn figures(&self, scene: &Scene, structure: &Structure, rays: &[Ray]) -> Option<Figures> {
        let accel = structure.accel.as_ref();
        let mut hits = vec![Hit::MISS; rays.len()];
        let (mut traced, mut seconds) = (0, 0.0);
        // Few rays at first, at most a batch a thread, so that a slow structure is given up soon.
        let threads = rayon::current_num_threads();
        let (mut slice, most) = (FIRST_SLICE * threads, trace::BATCH * threads);
        // The whole picture at least once: its parts differ in what they cost.
        while seconds < IMPRESSION.as_secs_f64() && !rays.is_empty() {
            let mut from = 0;
            while from < rays.len() {
                if self.cancelled() {
                    return None;
                }
                let range = from..rays.len().min(from + slice);
                let start = Instant::now();
                trace::closest_into(accel, &rays[range.clone()], &mut hits[range.clone()]);
                let took = start.elapsed();
                seconds += took.as_secs_f64();
                traced += range.len();
                from = range.end;
                if took < SOON {
                    slice = most.min(2 * slice);
                }
            }
        }
        // Every k-th ray, so that the counted part stands for the whole picture.
        let step = (rays.len() / MOST_COUNTED).max(1);
        let some: Vec<Ray> = rays.iter().step_by(step).copied().collect();
        let (mut steps, mut tests, mut hit) = (0.0, 0.0, 0);
        for rays in some.chunks(slice) {
            if self.cancelled() {
                return None;
            }
            let (hits, counts) = trace::closest_counted(accel, rays);
            steps += counts.iter().map(|c| c.steps as f64).sum::<f64>();
            tests += counts.iter().map(|c| c.tests as f64).sum::<f64>();
            hit += hits.iter().filter(|hit| hit.is_hit()).count();
        }
        let count = some.len().max(1) as f64;
        Some(Figures {
            triangles: scene.mesh.len() as u64,
            n: structure.n,
            build_ms: structure.build_ms,
            memory_bytes: accel.memory_bytes(),
            mrays_per_s: traced as f64 / seconds.max(1e-9) / 1e6,
            steps: structure.counts.then_some(steps / count),
            tests: structure.counts.then_some(tests / count),
            hit_share: hit as f64 / count,
        })
    }
}

/// What a caught panic said.
pub(super) fn panic_message(panic: &(dyn Any + Send)) -> String {
    let what = panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("no message");
    format!("internal error, please report it: {what}")
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, channel};

    use super::*;
    use crate::lab::Plan;

    fn studio() -> (Studio, Receiver<Message>) {
        let (to, from) = channel();
        let studio = Studio::spawn(ColorMode::True, 1 << 30, Steering::default(), to);
        (studio, from)
    }

    fn request(scene: &str, serial: u64) -> Request {
        let mut wish = Wish::first(&Plan::default());
        scene.clone_into(&mut wish.scene);
        Request {
            serial,
            wish,
            cells: (20, 10),
        }
    }

    /// What is told of the request `serial`, up to its end.
    fn told(from: &Receiver<Message>, serial: u64) -> Vec<PictureNews> {
        let mut all = Vec::new();
        while let Ok(Message::News(Event::Picture(news))) = from.recv() {
            let (of, last) = match &news {
                PictureNews::Doing { serial, .. } => (*serial, false),
                PictureNews::Shown(shown) => (shown.request.serial, false),
                PictureNews::Finished { serial, .. } | PictureNews::Failed { serial, .. } => {
                    (*serial, true)
                }
            };
            if of == serial {
                all.push(news);
                if last {
                    break;
                }
            }
        }
        all
    }

    #[test]
    fn a_picture_comes_in_passes_and_ends_with_figures() {
        let (studio, from) = studio();
        studio.ask(request("teapot", 1));
        let news = told(&from, 1);
        let shown: Vec<&Shown> = news
            .iter()
            .filter_map(|n| match n {
                PictureNews::Shown(shown) => Some(shown.as_ref()),
                _ => None,
            })
            .collect();
        assert_eq!(shown.len(), PASSES.len());
        assert!(
            shown
                .iter()
                .all(|s| (s.cells.columns, s.cells.rows) == (20, 10))
        );
        let Some(PictureNews::Finished { figures, .. }) = news.last() else {
            panic!("{news:?}");
        };
        assert!(figures.triangles > 1000 && figures.hit_share > 0.05);
        assert!(
            figures.steps > Some(0.0) && figures.tests > Some(0.0) && figures.mrays_per_s > 0.0
        );
    }

    #[test]
    fn a_scene_that_is_not_there_is_told_and_the_next_one_comes() {
        let (studio, from) = studio();
        studio.ask(request("missing.obj", 1));
        let news = told(&from, 1);
        assert!(
            matches!(news.last(), Some(PictureNews::Failed { why, .. }) if why.contains("missing.obj"))
        );
        studio.ask(request("one", 2));
        assert!(matches!(
            told(&from, 2).last(),
            Some(PictureNews::Finished { .. })
        ));
    }

    #[test]
    fn the_request_that_came_last_is_served_whatever_came_before() {
        let (studio, from) = studio();
        for serial in 1..=20 {
            studio.ask(request("teapot", serial));
        }
        assert!(matches!(
            told(&from, 20).last(),
            Some(PictureNews::Finished { .. })
        ));
    }

    #[test]
    fn a_panic_is_told_in_a_sentence() {
        let caught = catch_unwind(|| panic!("cell 7")).unwrap_err();
        assert!(panic_message(caught.as_ref()).contains("cell 7"));
    }
}
