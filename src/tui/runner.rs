//! The runner thread: performs a sweep, keeps every finished run in a bundle as it comes, writes the report at the end.

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

use super::app::Message;
use super::steering::Steering;
use super::studio::panic_message;
use super::update::Event;
use crate::lab::{self, Control, Plan};
use crate::report::{self, Bundle, Provenance, Report};

/// What a bundle has beside report and journal.
const FORMATS: [&str; 3] = ["svg", "png", "html"];

/// Something that two threads share.
pub(super) type Shared<T> = Arc<Mutex<T>>;

/// Locks; what a panicking thread left is as good as any other value here.
pub(super) fn lock<T>(shared: &Shared<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A sweep in its thread.
pub(super) struct Runner {
    /// What it told and nobody has read. The UI thread looks here when it draws, so that a sample that ends wakes no one.
    pub inbox: Shared<Vec<lab::Event>>,
    bundle: Shared<Option<Bundle>>,
    thread: JoinHandle<()>,
}

impl Runner {
    /// Starts a sweep that writes into a new bundle in `results`.
    pub(super) fn spawn(
        plan: Plan,
        results: PathBuf,
        steering: Steering,
        to: Sender<Message>,
    ) -> Self {
        let control = Arc::new(Control::default());
        steering.begin(Arc::clone(&control));
        let inbox = Shared::default();
        let bundle = Shared::default();
        let run = Run {
            plan,
            results,
            control,
            steering,
            inbox: Arc::clone(&inbox),
            bundle: Arc::clone(&bundle),
            to,
        };
        let thread = thread::spawn(move || run.perform());
        Self {
            inbox,
            bundle,
            thread,
        }
    }

    /// Whether sweep and report are done.
    pub(super) fn is_finished(&self) -> bool {
        self.thread.is_finished()
    }

    /// Writes report and plots of what is measured so far, in a thread of its own, while the sweep waits.
    pub(super) fn write(&self, steering: Steering, to: Sender<Message>) {
        let bundle = Arc::clone(&self.bundle);
        thread::spawn(move || {
            let _hold = steering.hold(|| false);
            let event = written(&bundle);
            let _ = to.send(Message::News(event));
        });
    }
}

/// A sweep in the making.
struct Run {
    plan: Plan,
    results: PathBuf,
    control: Arc<Control>,
    steering: Steering,
    inbox: Shared<Vec<lab::Event>>,
    bundle: Shared<Option<Bundle>>,
    to: Sender<Message>,
}

impl Run {
    fn perform(self) {
        let swept = catch_unwind(AssertUnwindSafe(|| self.sweep()));
        self.steering.end();
        let failed = match swept {
            Ok(Ok(())) => None,
            Ok(Err(why)) => Some(why),
            Err(panic) => Some(panic_message(panic.as_ref())),
        };
        if let Some(why) = failed {
            self.tell(Event::SweepFailed(why));
        } else {
            // What waits in the inbox is read before this.
            self.tell(Event::Writing);
        }
        if lock(&self.bundle).is_some() {
            let event = catch_unwind(AssertUnwindSafe(|| written(&self.bundle)))
                .unwrap_or_else(|panic| Event::BundleFailed(panic_message(panic.as_ref())));
            self.tell(event);
        }
    }

    /// A program that is ending no longer listens.
    fn tell(&self, event: Event) {
        let _ = self.to.send(Message::News(event));
    }

    fn sweep(&self) -> Result<(), String> {
        self.plan.check().map_err(|error| error.to_string())?;
        let command = std::env::args().collect();
        let provenance =
            Provenance::gather(&self.plan, command).map_err(|error| error.to_string())?;
        let dir = free_dir(&self.results, &self.plan, &provenance.date);
        match Bundle::create(&dir, &self.plan, provenance) {
            Ok(bundle) => {
                *lock(&self.bundle) = Some(bundle);
                self.tell(Event::BundleMade(dir));
            }
            Err(error) => self.tell(Event::BundleFailed(error.to_string())),
        }
        let mut sink = |event: lab::Event| {
            let noted = match lock(&self.bundle).as_mut() {
                Some(bundle) => bundle.note(&event),
                None => Ok(()),
            };
            if let Err(error) = noted {
                // Measuring goes on: what is on the screen is better than nothing.
                *lock(&self.bundle) = None;
                self.tell(Event::BundleFailed(error.to_string()));
            }
            lock(&self.inbox).push(event);
        };
        lab::sweep(&self.plan, &BTreeSet::new(), &self.control, &mut sink)
            .map_err(|error| error.to_string())
    }
}

/// Writes report and plots of a bundle.
fn written(bundle: &Shared<Option<Bundle>>) -> Event {
    let (dir, report) = match lock(bundle).as_mut() {
        Some(bundle) => match bundle.finish() {
            Ok(()) => (bundle.dir().to_owned(), bundle.report().clone()),
            Err(error) => return Event::BundleFailed(error.to_string()),
        },
        None => return Event::BundleFailed("there is no bundle to write to".to_owned()),
    };
    exported(&report, &dir)
}

/// Writes a report that no bundle holds into a new one in `results`.
pub(super) fn save(report: &Report, results: &Path) -> Event {
    let dir = free_dir(results, &report.config, &report.provenance.date);
    if let Err(error) = std::fs::create_dir_all(&dir) {
        let dir = dir.display();
        return Event::BundleFailed(format!(
            "cannot make '{dir}': {error}; choose another --out"
        ));
    }
    match report.write(&dir.join("report.json")) {
        Ok(()) => exported(report, &dir),
        Err(error) => Event::BundleFailed(error.to_string()),
    }
}

fn exported(report: &Report, dir: &Path) -> Event {
    for format in FORMATS {
        if let Err(error) = report::export(report, format, dir) {
            return Event::BundleFailed(error.to_string());
        }
    }
    Event::BundleWritten(dir.to_owned())
}

/// A folder in `results` that does not exist: named by start and scenes, `2026-11-22-0312-teapot`.
fn free_dir(results: &Path, plan: &Plan, date: &str) -> PathBuf {
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
        let runner = Runner::spawn(plan(), results.path().to_owned(), steering.clone(), to);
        let mut dir = None;
        for message in from {
            if let Message::News(Event::BundleWritten(path)) = message {
                dir = Some(path);
            }
        }
        assert!(!steering.is_running());
        let report = Report::read(&dir.unwrap()).unwrap();
        assert_eq!(report.runs.len(), 2);
        let told = lock(&runner.inbox).len();
        assert!(told > 4, "{told} events");
    }

    #[test]
    fn without_a_place_to_write_the_sweep_is_made_and_says_so() {
        let results = tempfile::NamedTempFile::new().unwrap();
        let (to, from) = channel();
        let path = results.path().to_owned();
        let runner = Runner::spawn(plan(), path, Steering::default(), to);
        let failed = from
            .iter()
            .filter(|m| matches!(m, Message::News(Event::BundleFailed(_))))
            .count();
        assert_eq!(failed, 1);
        let inbox = lock(&runner.inbox);
        let ended = inbox
            .iter()
            .any(|e| matches!(e, lab::Event::Ended { stopped: false }));
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
        let _runner = Runner::spawn(plan, results.path().to_owned(), Steering::default(), to);
        let why = from.iter().find_map(|m| match m {
            Message::News(Event::SweepFailed(why)) => Some(why),
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
        let first = free_dir(results.path(), &plan, date);
        assert!(
            first.ends_with("2026-11-22-031244-My-mesh-soup-10-0-5"),
            "{first:?}"
        );
        std::fs::create_dir_all(&first).unwrap();
        assert_ne!(free_dir(results.path(), &plan, date), first);
        plan.scenes = ["one", "teapot", "empty"].map(str::to_owned).to_vec();
        let many = free_dir(results.path(), &plan, "");
        assert!(many.ends_with("-one-teapot-and-more"), "{many:?}");
    }
}
