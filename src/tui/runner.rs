//! The runner thread: performs an experiment that is timed, keeps every finished run in a bundle as it comes, writes the
//! report at the end.

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

use super::app::Message;
use super::state::Experiment;
use super::steering::Steering;
use super::studio::panic_message;
use super::update::Event;
use crate::lab::{self, AccuracyEvent, AccuracyPlan, Control, LabError, Plan};
use crate::report::{self, Bundle, Places, Provenance, Report, ReportError};

/// What a bundle has beside report and journal.
const FORMATS: [&str; 3] = ["svg", "png", "html"];

/// Something that two threads share.
pub(super) type Shared<T> = Arc<Mutex<T>>;

/// Locks; what a panicking thread left is as good as any other value here.
pub(super) fn lock<T>(shared: &Shared<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What experiments told and nobody has read. The UI thread looks here when it draws, so that a sample that ends wakes no
/// one.
pub(super) type Inbox = Shared<Vec<Event>>;

/// What is measured.
#[derive(Debug, Clone, PartialEq)]
pub enum Work {
    /// Speed over a plan.
    Sweep(Plan),
    /// Speed and wrong decisions.
    Accuracy(AccuracyPlan),
}

impl Work {
    /// Which experiment it is.
    #[must_use]
    pub fn experiment(&self) -> Experiment {
        match self {
            Self::Sweep(_) => Experiment::Sweep,
            Self::Accuracy(_) => Experiment::Accuracy,
        }
    }

    /// What is measured and how.
    pub(super) fn plan(&self) -> &Plan {
        match self {
            Self::Sweep(plan) => plan,
            Self::Accuracy(judged) => &judged.plan,
        }
    }

    fn check(&self) -> Result<(), LabError> {
        match self {
            Self::Sweep(plan) => plan.check(),
            Self::Accuracy(plan) => plan.check(),
        }
    }

    fn bundle(&self, dir: &Path, provenance: Provenance) -> Result<Bundle, ReportError> {
        match self {
            Self::Sweep(plan) => Bundle::create(dir, plan, provenance),
            Self::Accuracy(plan) => Bundle::create_judged(dir, plan, provenance),
        }
    }

    /// A report of these runs, which no bundle holds.
    pub(super) fn report(&self, provenance: Provenance, runs: Vec<report::Run>) -> Report {
        Report {
            schema: Report::SCHEMA.to_owned(),
            provenance,
            config: self.plan().clone(),
            judged: match self {
                Self::Sweep(_) => None,
                Self::Accuracy(plan) => Some(Places {
                    offsets: plan.offsets.clone(),
                    scales: plan.scales.clone(),
                }),
            },
            runs,
        }
    }
}

/// What becomes of what is measured.
#[derive(Debug, Clone)]
pub enum Keeping {
    /// The bundle was made there.
    Made(PathBuf),
    /// All is measured; the report is being written.
    Writing,
    /// The bundle is complete, with report and plots.
    Written(PathBuf),
    /// It cannot be written; why.
    Failed(String),
    /// The experiment could not begin, or broke off; why.
    Broken(String),
}

/// An experiment in its thread.
pub(super) struct Runner {
    of: Experiment,
    bundle: Shared<Option<Bundle>>,
    thread: JoinHandle<()>,
}

impl Runner {
    /// Starts an experiment that writes into a new bundle in `results`.
    pub(super) fn spawn(
        work: Work,
        results: PathBuf,
        steering: Steering,
        inbox: Inbox,
        to: Sender<Message>,
    ) -> Self {
        let control = Arc::new(Control::default());
        steering.begin(Arc::clone(&control), true);
        let bundle = Shared::default();
        let of = work.experiment();
        let run = Run {
            work,
            results,
            control,
            steering,
            inbox,
            bundle: Arc::clone(&bundle),
            to,
        };
        let thread = thread::spawn(move || run.perform());
        Self { of, bundle, thread }
    }

    /// Whether experiment and report are done.
    pub(super) fn is_finished(&self) -> bool {
        self.thread.is_finished()
    }

    /// Writes report and plots of what is measured so far, in a thread of its own, while the sweep waits.
    pub(super) fn write(&self, steering: Steering, to: Sender<Message>) {
        let (of, bundle) = (self.of, Arc::clone(&self.bundle));
        thread::spawn(move || {
            let _hold = steering.hold(|| false);
            let event = Event::Kept(of, written(&bundle));
            let _ = to.send(Message::News(event));
        });
    }
}

/// An experiment in the making.
struct Run {
    work: Work,
    results: PathBuf,
    control: Arc<Control>,
    steering: Steering,
    inbox: Inbox,
    bundle: Shared<Option<Bundle>>,
    to: Sender<Message>,
}

impl Run {
    fn perform(self) {
        let measured = catch_unwind(AssertUnwindSafe(|| self.measure()));
        self.steering.end();
        let failed = match measured {
            Ok(Ok(())) => None,
            Ok(Err(why)) => Some(why),
            Err(panic) => Some(panic_message(panic.as_ref())),
        };
        // What waits in the inbox is read before this.
        self.tell(failed.map_or(Keeping::Writing, Keeping::Broken));
        if lock(&self.bundle).is_some() {
            let kept = catch_unwind(AssertUnwindSafe(|| written(&self.bundle)))
                .unwrap_or_else(|panic| Keeping::Failed(panic_message(panic.as_ref())));
            self.tell(kept);
        }
    }

    /// A program that is ending no longer listens.
    fn tell(&self, keeping: Keeping) {
        let event = Event::Kept(self.work.experiment(), keeping);
        let _ = self.to.send(Message::News(event));
    }

    fn measure(&self) -> Result<(), String> {
        self.work.check().map_err(|error| error.to_string())?;
        let command = std::env::args().collect();
        let plan = self.work.plan();
        let provenance = Provenance::gather(plan, command).map_err(|error| error.to_string())?;
        let dir = free_dir(&self.results, &self.work, &provenance.date);
        match self.work.bundle(&dir, provenance) {
            Ok(bundle) => {
                *lock(&self.bundle) = Some(bundle);
                self.tell(Keeping::Made(dir));
            }
            Err(error) => self.tell(Keeping::Failed(error.to_string())),
        }
        let ended = match &self.work {
            Work::Sweep(plan) => {
                let mut sink = |event: lab::Event| {
                    self.keep(|bundle| bundle.note(&event));
                    lock(&self.inbox).push(Event::Lab(event));
                };
                lab::sweep(plan, &BTreeSet::new(), &self.control, &mut sink)
            }
            Work::Accuracy(plan) => {
                let mut sink = |event: AccuracyEvent| {
                    self.keep(|bundle| bundle.note_judged(&event));
                    lock(&self.inbox).push(Event::Judged(event));
                };
                lab::accuracy(plan, &self.control, &mut sink)
            }
        };
        ended.map_err(|error| error.to_string())
    }

    /// Notes in the bundle, while there is one. Where that fails measuring goes on: what is on the screen is better than
    /// nothing.
    fn keep(&self, note: impl FnOnce(&mut Bundle) -> Result<(), ReportError>) {
        let noted = lock(&self.bundle).as_mut().map_or(Ok(()), note);
        if let Err(error) = noted {
            *lock(&self.bundle) = None;
            self.tell(Keeping::Failed(error.to_string()));
        }
    }
}

/// Writes report and plots of a bundle.
fn written(bundle: &Shared<Option<Bundle>>) -> Keeping {
    let (dir, report) = match lock(bundle).as_mut() {
        Some(bundle) => match bundle.finish() {
            Ok(()) => (bundle.dir().to_owned(), bundle.report().clone()),
            Err(error) => return Keeping::Failed(error.to_string()),
        },
        None => return Keeping::Failed("there is no bundle to write to".to_owned()),
    };
    exported(&report, &dir)
}

/// Writes a report that no bundle holds into a new one in `results`.
pub(super) fn save(work: &Work, report: &Report, results: &Path) -> Keeping {
    let dir = free_dir(results, work, &report.provenance.date);
    if let Err(error) = std::fs::create_dir_all(&dir) {
        let dir = dir.display();
        return Keeping::Failed(format!(
            "cannot make '{dir}': {error}; choose another --out"
        ));
    }
    match report.write(&dir.join("report.json")) {
        Ok(()) => exported(report, &dir),
        Err(error) => Keeping::Failed(error.to_string()),
    }
}

fn exported(report: &Report, dir: &Path) -> Keeping {
    for format in FORMATS {
        if let Err(error) = report::export(report, format, dir) {
            return Keeping::Failed(error.to_string());
        }
    }
    Keeping::Written(dir.to_owned())
}

/// A folder in `results` that does not exist: named by start and scenes, `2026-11-22-031244-teapot`.
fn free_dir(results: &Path, work: &Work, date: &str) -> PathBuf {
    let plan = work.plan();
    let digits = |part: &str| {
        part.chars()
            .filter(char::is_ascii_digit)
            .collect::<String>()
    };
    let (day, time) = date.split_once('T').unwrap_or((date, ""));
    let mut name = day.to_owned();
    let time: String = digits(time).chars().take(6).collect();
    for part in std::iter::once(time).chain(plan.scenes.iter().take(2).map(|s| stem(s))) {
        if !part.is_empty() {
            name.push('-');
            name.push_str(&part);
        }
    }
    if plan.scenes.len() > 2 {
        name.push_str("-and-more");
    }
    if work.experiment() == Experiment::Accuracy {
        name.push_str("-accuracy");
    }
    let mut dir = results.join(&name);
    let mut copy = 2;
    while dir.exists() {
        dir = results.join(format!("{name}-{copy}"));
        copy += 1;
    }
    dir
}

/// A scene as part of a file name: `models/my mesh.obj` as `my-mesh`, `soup:10,0.5` as `soup-10-0-5`.
fn stem(scene: &str) -> String {
    let file = scene.rsplit(['/', '\\']).next().unwrap_or(scene);
    let file = file.strip_suffix(".obj").unwrap_or(file);
    let clean: String = file
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .take(40)
        .collect();
    clean.trim_matches('-').to_owned()
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;
    use crate::accel;

    /// A plan that is measured in a moment.
    fn work() -> Work {
        Work::Sweep(plan())
    }

    fn plan() -> Plan {
        let mut plan = Plan::quick();
        plan.scenes = vec!["one".to_owned()];
        plan.accels = vec![accel::parse("brute").unwrap(), accel::parse("bvh").unwrap()];
        plan.ray_count = 256;
        plan.threads = vec![1];
        plan.budget.sample_seconds = 1e-4;
        plan.budget.run_seconds = 1e-3;
        plan
    }

    #[test]
    fn a_sweep_ends_with_a_report_of_all_its_runs_and_its_plots() {
        let results = tempfile::tempdir().unwrap();
        let (to, from) = channel();
        let steering = Steering::default();
        let inbox = Inbox::default();
        let path = results.path().to_owned();
        let _runner = Runner::spawn(work(), path, steering.clone(), Arc::clone(&inbox), to);
        let mut dir = None;
        for message in from {
            if let Message::News(Event::Kept(_, Keeping::Written(path))) = message {
                dir = Some(path);
            }
        }
        assert!(!steering.is_running());
        let report = Report::read(&dir.unwrap()).unwrap();
        assert_eq!(report.runs.len(), 2);
        let told = lock(&inbox).len();
        assert!(told > 4, "{told} events");
    }

    #[test]
    fn what_is_judged_is_told_and_kept_with_its_plots() {
        let results = tempfile::tempdir().unwrap();
        let (to, from) = channel();
        let inbox = Inbox::default();
        let judged = Work::Accuracy(AccuracyPlan {
            plan: Plan {
                rays: vec!["random".to_owned()],
                ..plan()
            },
            offsets: vec![0.0],
            scales: vec![1.0],
        });
        let path = results.path().to_owned();
        let _runner = Runner::spawn(judged, path, Steering::default(), Arc::clone(&inbox), to);
        let written = from.iter().find_map(|message| match message {
            Message::News(Event::Kept(Experiment::Accuracy, Keeping::Written(dir))) => Some(dir),
            _ => None,
        });
        let report = Report::read(&written.unwrap()).unwrap();
        assert_eq!(report.runs.len(), 2);
        assert!(report.runs.iter().all(|run| run.accuracy.is_some()));
        let finished = |e: &&Event| matches!(e, Event::Judged(AccuracyEvent::Finished { .. }));
        assert_eq!(lock(&inbox).iter().filter(finished).count(), 2);
    }

    #[test]
    fn without_a_place_to_write_the_sweep_is_made_and_says_so() {
        let results = tempfile::NamedTempFile::new().unwrap();
        let (to, from) = channel();
        let path = results.path().to_owned();
        let inbox = Inbox::default();
        let steering = Steering::default();
        let _runner = Runner::spawn(work(), path, steering, Arc::clone(&inbox), to);
        let failed = from
            .iter()
            .filter(|m| matches!(m, Message::News(Event::Kept(_, Keeping::Failed(_)))))
            .count();
        assert_eq!(failed, 1);
        let ended = lock(&inbox)
            .iter()
            .any(|e| matches!(e, Event::Lab(lab::Event::Ended { stopped: false })));
        assert!(ended);
    }

    #[test]
    fn a_plan_that_cannot_be_carried_out_says_why() {
        let (to, from) = channel();
        let plan = Plan {
            scenes: vec!["missing.obj".to_owned()],
            ..plan()
        };
        let results = tempfile::tempdir().unwrap();
        let path = results.path().to_owned();
        let _runner = Runner::spawn(
            Work::Sweep(plan),
            path,
            Steering::default(),
            Inbox::default(),
            to,
        );
        let why = from.iter().find_map(|m| match m {
            Message::News(Event::Kept(_, Keeping::Broken(why))) => Some(why),
            _ => None,
        });
        assert!(why.unwrap().contains("missing.obj"));
    }

    #[test]
    fn bundles_are_named_by_start_and_scenes_and_never_share_a_folder() {
        let results = tempfile::tempdir().unwrap();
        let mut plan = Plan {
            scenes: vec!["models/My mesh.obj".to_owned(), "soup:10,0.5".to_owned()],
            ..Plan::default()
        };
        let date = "2026-11-22T03:12:44Z";
        let free = |plan: &Plan| free_dir(results.path(), &Work::Sweep(plan.clone()), date);
        let first = free(&plan);
        assert!(
            first.ends_with("2026-11-22-031244-My-mesh-soup-10-0-5"),
            "{first:?}"
        );
        std::fs::create_dir_all(&first).unwrap();
        assert_ne!(free(&plan), first);
        plan.scenes = ["one", "teapot", "empty"].map(str::to_owned).to_vec();
        let many = free_dir(results.path(), &Work::Sweep(plan.clone()), "");
        assert!(many.ends_with("-one-teapot-and-more"), "{many:?}");
    }
}
