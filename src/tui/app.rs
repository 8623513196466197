//! The loop that owns terminal, threads and channel: events go into the state, effects come out and are performed here.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread;
use std::time::{Duration, Instant};

use super::examiner::Examiner;
use super::pacer::Pacer;
use super::runner::{self, Inbox, Keeping, Runner, Work, lock};
use super::signals::{self, Signal, Signals};
use super::state::{Experiment, State};
use super::steering::Steering;
use super::studio::Studio;
use super::tty::Tty;
use super::update::{Effect, Event, update};
use super::{TuiError, input, shelf, trials};
use crate::lab::Plan;
use crate::preview::ColorMode;
use crate::report::Provenance;

/// What wakes the UI thread.
pub(super) enum Message {
    /// A key, a paste, another size.
    Input(Event),
    /// The terminal gives no more keys.
    InputLost(io::Error),
    /// A signal.
    Signal(Signal),
    /// News of another thread.
    News(Event),
}

/// How often a running sweep is looked at.
const GLANCE: Duration = Duration::from_millis(250);

/// How long quitting waits for the sample in progress and the report.
const PATIENCE: Duration = Duration::from_secs(15);

/// How long after a suspension the signal that ended it may still be told.
const ECHO: Duration = Duration::from_secs(1);

/// How the loop goes on.
enum Next {
    Stay,
    Quit,
    Ended(i32),
}

/// Runs the lab in a claimed terminal until it is quit.
pub(super) fn run(
    plan: &Plan,
    results: PathBuf,
    colors: ColorMode,
    signals: Signals,
    tty: &mut Tty,
) -> Result<(), TuiError> {
    let start = Instant::now();
    let size = tty.size()?;
    let mut state = State::new(plan, results, colors, (size.width, size.height));
    // The first frame comes before anything else is begun.
    tty.draw(&state)?;
    let (to, from) = mpsc::channel();
    let steering = Steering::default();
    let mut app = App {
        start,
        studio: Studio::spawn(colors, plan.memory_limit, steering.clone(), to.clone()),
        examiner: Examiner::spawn(plan.memory_limit, steering.clone(), to.clone()),
        steering,
        to: to.clone(),
        runners: Vec::new(),
        inbox: Inbox::default(),
        pacer: Pacer::new(),
        resumed: None,
    };
    input::spawn(signals, to);
    let first = update(&mut state, Event::Resize(size.width, size.height));
    app.perform_all(&mut state, first, tty)?;
    let next = app.turn(&mut state, &from, tty);
    app.close(&state);
    match next? {
        Next::Ended(signal) => Err(TuiError::Ended { signal }),
        Next::Stay | Next::Quit => Ok(()),
    }
}

struct App {
    start: Instant,
    studio: Studio,
    examiner: Examiner,
    steering: Steering,
    to: Sender<Message>,
    /// The last experiment of each kind.
    runners: Vec<(Experiment, Work, Runner)>,
    inbox: Inbox,
    pacer: Pacer,
    /// When the program went on after it had suspended itself.
    resumed: Option<Instant>,
}

impl App {
    /// Turns events into frames until the end.
    fn turn(
        &mut self,
        state: &mut State,
        from: &Receiver<Message>,
        tty: &mut Tty,
    ) -> Result<Next, TuiError> {
        loop {
            let running = self.steering.is_running();
            let due = self.pacer.wait(Instant::now(), running);
            let wait = match due {
                Some(wait) if !state.frozen => wait,
                Some(wait) if wait.is_zero() => wait,
                _ if running => GLANCE,
                _ => Duration::from_hours(1),
            };
            match from.recv_timeout(wait) {
                Ok(message) => {
                    self.read_inbox(state);
                    let next = self.take(state, message, tty)?;
                    if !matches!(next, Next::Stay) {
                        return Ok(next);
                    }
                    // All that came meanwhile is one frame.
                    for message in from.try_iter() {
                        let next = self.take(state, message, tty)?;
                        if !matches!(next, Next::Stay) {
                            return Ok(next);
                        }
                    }
                }
                Err(RecvTimeoutError::Timeout) => self.read_inbox(state),
                Err(RecvTimeoutError::Disconnected) => return Ok(Next::Quit),
            }
            let now = Instant::now();
            if self.pacer.wait(now, self.steering.is_running()) == Some(Duration::ZERO) {
                tty.draw(state)?;
                self.pacer.drawn(now);
            }
        }
    }

    /// Takes in what the sweep told since the last look.
    fn read_inbox(&mut self, state: &mut State) {
        let events = std::mem::take(&mut *lock(&self.inbox));
        let seconds = self.start.elapsed().as_secs_f64();
        // While a sweep runs its clock goes on, whether it tells something or not.
        let ticked = state.running().is_some() && seconds - state.clock >= GLANCE.as_secs_f64();
        if ticked || !events.is_empty() {
            update(state, Event::Clock(seconds));
            for event in events {
                update(state, event);
            }
            if !state.frozen {
                self.pacer.stale();
            }
        }
    }

    fn take(
        &mut self,
        state: &mut State,
        message: Message,
        tty: &mut Tty,
    ) -> Result<Next, TuiError> {
        match message {
            Message::Input(event) => {
                self.steering.disturb();
                update(state, Event::Clock(self.start.elapsed().as_secs_f64()));
                let effects = update(state, event);
                self.pacer.urgent();
                self.perform_all(state, effects, tty)
            }
            Message::News(event) => {
                let effects = update(state, event);
                self.pacer.stale();
                self.perform_all(state, effects, tty)
            }
            Message::Signal(Signal::End(signal)) => Ok(Next::Ended(signal)),
            Message::Signal(Signal::Suspend) => {
                self.suspend(state, tty)?;
                Ok(Next::Stay)
            }
            Message::Signal(Signal::Resumed) => {
                // The signal that ends our own suspension is old news.
                if self.resumed.take().is_none_or(|at| at.elapsed() > ECHO) {
                    self.repaint(state, tty)?;
                }
                Ok(Next::Stay)
            }
            Message::InputLost(error) => Err(error.into()),
        }
    }

    fn perform_all(
        &mut self,
        state: &mut State,
        effects: Vec<Effect>,
        tty: &mut Tty,
    ) -> Result<Next, TuiError> {
        for effect in effects {
            match effect {
                Effect::Quit => return Ok(Next::Quit),
                Effect::Suspend => self.suspend(state, tty)?,
                Effect::Repaint => self.repaint(state, tty)?,
                other => self.perform(state, other),
            }
        }
        Ok(Next::Stay)
    }

    fn perform(&mut self, state: &State, effect: Effect) {
        match effect {
            Effect::Start(work) => {
                let of = work.experiment();
                self.runners.retain(|(runner_of, ..)| *runner_of != of);
                let runner = Runner::spawn(
                    (*work).clone(),
                    state.results.clone(),
                    self.steering.clone(),
                    Arc::clone(&self.inbox),
                    self.to.clone(),
                );
                self.runners.push((of, *work, runner));
            }
            Effect::TryAll(plan) => trials::spawn(
                *plan,
                self.steering.clone(),
                Arc::clone(&self.inbox),
                self.to.clone(),
            ),
            Effect::Reproduce(wanted) => {
                trials::reproduce(*wanted, state.results.clone(), self.to.clone());
            }
            Effect::Pause(paused) => self.steering.pause(paused),
            Effect::Stop => self.steering.stop(),
            Effect::Write(of) => self.write(state, of),
            Effect::Render(request) => self.studio.ask(*request),
            Effect::Inspect(request) => self.examiner.ask(*request),
            Effect::List => shelf::list(state.results.clone(), self.to.clone()),
            Effect::Read(path) => shelf::read(path, self.to.clone()),
            Effect::Quit | Effect::Suspend | Effect::Repaint => {}
        }
    }

    /// Writes what an experiment has measured so far: into its bundle, or into a new one where that failed.
    fn write(&self, state: &State, of: Experiment) {
        let (steering, to) = (self.steering.clone(), self.to.clone());
        let Some((_, work, runner)) = self.runners.iter().find(|(o, ..)| *o == of) else {
            return;
        };
        let (kept, runs) = match of {
            Experiment::Accuracy => (&state.pareto.kept, state.pareto.runs.clone()),
            _ => (&state.sweep.kept, state.sweep.runs.complete()),
        };
        if kept.unsaved.is_none() {
            runner.write(steering, to);
            return;
        }
        let (work, results) = (work.clone(), state.results.clone());
        thread::spawn(move || {
            let _hold = steering.hold(|| false);
            let command = std::env::args().collect();
            let keeping = match Provenance::gather(work.plan(), command) {
                Ok(provenance) => {
                    let report = work.report(provenance, runs);
                    runner::save(&work, &report, &results)
                }
                Err(error) => Keeping::Failed(error.to_string()),
            };
            let _ = to.send(Message::News(Event::Kept(of, keeping)));
        });
    }

    /// Hands the terminal back, stops, and claims it again when the shell lets the program go on.
    fn suspend(&mut self, state: &mut State, tty: &mut Tty) -> Result<(), TuiError> {
        self.steering.disturb();
        Tty::release();
        signals::stop()?;
        self.resumed = Some(Instant::now());
        self.repaint(state, tty)
    }

    /// Claims the terminal anew and draws everything, in the size that it has now.
    fn repaint(&mut self, state: &mut State, tty: &mut Tty) -> Result<(), TuiError> {
        self.steering.disturb();
        tty.reclaim()?;
        let size = tty.size()?;
        let effects = update(state, Event::Resize(size.width, size.height));
        for effect in effects {
            self.perform(state, effect);
        }
        self.pacer.urgent();
        Ok(())
    }

    /// Gives the terminal back and lets the sweep end: its sample, its report.
    fn close(&self, state: &State) {
        Tty::release();
        self.steering.stop();
        let finished = || self.runners.iter().all(|(.., runner)| runner.is_finished());
        let begin = Instant::now();
        if !finished() {
            eprintln!("raylab: writing the report ...");
        }
        while !finished() && begin.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(10));
        }
        for kept in [&state.sweep.kept, &state.pareto.kept] {
            if let Some(dir) = &kept.bundle {
                eprintln!("raylab: the report is in {}", dir.display());
            }
        }
    }
}
