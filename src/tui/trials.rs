//! Threads of the stability suite: the suite itself, and making a failure again from as little as it needs.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::thread;

use super::app::Message;
use super::runner::{Inbox, lock};
use super::stability::{Reproduced, Wanted};
use super::steering::Steering;
use super::studio::panic_message;
use super::update::Event;
use crate::lab::Control;
use crate::lab::stability::{self, StabilityPlan};
use crate::report::stability::write_failure;

/// Starts the suite. What it tells comes to `inbox`, where the UI thread looks when it draws; its end is a message.
pub(super) fn spawn(plan: StabilityPlan, steering: Steering, inbox: Inbox, to: Sender<Message>) {
    let control = Arc::new(Control::default());
    steering.begin(Arc::clone(&control), false);
    thread::spawn(move || {
        let tried = catch_unwind(AssertUnwindSafe(|| {
            stability::stability(&plan, &control, &mut |event| {
                lock(&inbox).push(Event::Trial(event));
            })
        }));
        steering.end();
        let ended = match tried {
            Ok(Ok(map)) => Ok(map.stopped),
            Ok(Err(why)) => Err(why.to_string()),
            Err(panic) => Err(panic_message(panic.as_ref())),
        };
        // A program that is ending no longer listens.
        let _ = to.send(Message::News(Event::TrialsEnded(ended)));
    });
}

/// Starts making a failure again, in a thread of its own: it may take a while.
pub(super) fn reproduce(wanted: Wanted, results: PathBuf, to: Sender<Message>) {
    thread::spawn(move || {
        let made = catch_unwind(AssertUnwindSafe(|| made(&wanted, &results)));
        let news = made.unwrap_or_else(|panic| Reproduced::Failed(panic_message(panic.as_ref())));
        let _ = to.send(Message::News(Event::Reproduced(news)));
    });
}

fn made(wanted: &Wanted, results: &Path) -> Reproduced {
    let Some(least) = stability::reproduce(&wanted.cell, wanted.seed) else {
        return Reproduced::Failed(
            "This cell does not fail: there is nothing to make again.".to_owned(),
        );
    };
    if !wanted.export {
        return Reproduced::Found(Box::new(least));
    }
    match write_failure(&least, &results.join("failures")) {
        Ok(written) => Reproduced::Written(format!(
            "Wrote {} and .rays beside it: {} triangles.",
            written.files[0].display(),
            least.mesh.len()
        )),
        Err(why) => Reproduced::Failed(why.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;
    use crate::tui::fixture;

    fn wanted(export: bool) -> Wanted {
        let mut map = fixture::tried().stability;
        assert!(map.seek(1));
        Wanted {
            cell: map.marked().unwrap().clone(),
            seed: map.seed,
            export,
        }
    }

    fn told(wanted: Wanted, results: &Path) -> Reproduced {
        let (to, from) = channel();
        reproduce(wanted, results.to_owned(), to);
        match from.recv() {
            Ok(Message::News(Event::Reproduced(news))) => news,
            _ => panic!("nothing is told"),
        }
    }

    #[test]
    fn a_failing_cell_is_made_again_with_few_triangles() {
        let results = tempfile::tempdir().unwrap();
        let Reproduced::Found(least) = told(wanted(false), results.path()) else {
            panic!("not found");
        };
        assert!(least.mesh.len() <= 4 && !least.rays.is_empty());
        let mut right = wanted(false);
        right.cell.witness = None;
        assert!(matches!(told(right, results.path()), Reproduced::Failed(_)));
    }

    #[test]
    fn an_export_says_where_it_is_or_why_it_is_not() {
        let results = tempfile::tempdir().unwrap();
        let Reproduced::Written(said) = told(wanted(true), results.path()) else {
            panic!("not written");
        };
        assert!(said.contains(".obj"));
        let files = std::fs::read_dir(results.path().join("failures")).unwrap();
        assert_eq!(files.count(), 2);
        let file = tempfile::NamedTempFile::new().unwrap();
        assert!(matches!(
            told(wanted(true), file.path()),
            Reproduced::Failed(_)
        ));
    }

    #[test]
    fn the_suite_tells_each_cell_and_its_end() {
        let (to, from) = channel();
        let inbox = Inbox::default();
        let plan = StabilityPlan {
            cases: vec!["ordinary"],
            kernels: vec![crate::kernel::parse("woop").unwrap()],
            accels: Vec::new(),
            threads: 1,
            ..StabilityPlan::default()
        };
        let steering = Steering::default();
        spawn(plan, steering.clone(), Arc::clone(&inbox), to);
        let ended = from
            .iter()
            .any(|message| matches!(message, Message::News(Event::TrialsEnded(Ok(false)))));
        assert!(ended && !steering.is_running());
        assert_eq!(lock(&inbox).len(), 1);
    }
}
