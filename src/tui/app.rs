//! The loop that owns terminal, threads and channel: events go into the state, effects come out and are performed here.

use std::io;
use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread;
use std::time::{Duration, Instant};

use super::examiner::Examiner;
use super::pacer::Pacer;
use super::runner::{self, Runner, lock};
use super::signals::{self, Signal, Signals};
use super::state::State;
use super::steering::Steering;
use super::studio::Studio;
use super::tty::Tty;
use super::update::{Effect, Event, update};
use super::{TuiError, input, shelf};
use crate::lab::Plan;
use crate::preview::ColorMode;
use crate::report::{Provenance, Report};

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
    tty: &mut Tty,
) -> Result<(), TuiError> {
    let start = Instant::now();
    let size = tty.size()?;
    let mut state = State::new(plan, results, colors, (size.width, size.height));
    // The first frame comes before anything else is begun.
    tty.draw(&state)?;
    let signals = Signals::register()?;
    let (to, from) = mpsc::channel();
    let steering = Steering::default();
    let mut app = App {
        start,
        studio: Studio::spawn(colors, plan.memory_limit, steering.clone(), to.clone()),
        examiner: Examiner::spawn(plan.memory_limit, steering.clone(), to.clone()),
        steering,
        to: to.clone(),
        runner: None,
        plan: plan.clone(),
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
    runner: Option<Runner>,
    /// The plan of the last sweep.
    plan: Plan,
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
        let Some(runner) = &self.runner else {
            return;
        };
        let events = std::mem::take(&mut *lock(&runner.inbox));
        let seconds = self.start.elapsed().as_secs_f64();
        // While a sweep runs its clock goes on, whether it tells something or not.
        let ticked = state.sweep.is_running() && seconds - state.clock >= GLANCE.as_secs_f64();
        if ticked || !events.is_empty() {
            update(state, Event::Clock(seconds));
            for event in events {
                update(state, Event::Lab(event));
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
            Effect::Start(plan) => {
                self.plan = (*plan).clone();
                self.runner = Some(Runner::spawn(
                    *plan,
                    state.results.clone(),
                    self.steering.clone(),
                    self.to.clone(),
                ));
            }
            Effect::Pause(paused) => self.steering.pause(paused),
            Effect::Stop => self.steering.stop(),
            Effect::Write => self.write(state),
            Effect::Render(request) => self.studio.ask(*request),
            Effect::Inspect(request) => self.examiner.ask(*request),
            Effect::List => shelf::list(state.results.clone(), self.to.clone()),
            Effect::Read(path) => shelf::read(path, self.to.clone()),
            Effect::Quit | Effect::Suspend | Effect::Repaint => {}
        }
    }

    /// Writes what is measured so far: into the bundle, or into a new one where that failed.
    fn write(&self, state: &State) {
        let (steering, to) = (self.steering.clone(), self.to.clone());
        if let Some(runner) = &self.runner
            && state.sweep.unsaved.is_none()
        {
            runner.write(steering, to);
            return;
        }
        let runs = state.sweep.runs.complete();
        let (plan, results) = (self.plan.clone(), state.results.clone());
        thread::spawn(move || {
            let _hold = steering.hold(|| false);
            let command = std::env::args().collect();
            let event = match Provenance::gather(&plan, command) {
                Ok(provenance) => {
                    let report = Report {
                        schema: Report::SCHEMA.to_owned(),
                        judged: None,
                        provenance,
                        config: plan,
                        runs,
                    };
                    runner::save(&report, &results)
                }
                Err(error) => Event::BundleFailed(error.to_string()),
            };
            let _ = to.send(Message::News(event));
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
        let Some(runner) = &self.runner else {
            return;
        };
        let begin = Instant::now();
        if !runner.is_finished() {
            eprintln!("raylab: writing the report ...");
        }
        while !runner.is_finished() && begin.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(10));
        }
        if let Some(dir) = &state.sweep.bundle {
            eprintln!("raylab: the report is in {}", dir.display());
        }
    }
}
