//! States and events that tests draw and act on.

use std::path::PathBuf;
use std::sync::OnceLock;

use super::app::Message;
use super::examiner::Examiner;
use super::keymap::Key;
use super::runner::Keeping;
use super::runs::Runs;
use super::state::{Experiment, Phase, Screen, State, Sweep};
use super::steering::Steering;
use super::update::{Effect, Event, update};
use crate::accel::{self, StructureStats};
use crate::kernel;
use crate::lab::stability::{StabilityEvent, StabilityPlan, stability};
use crate::lab::{
    self, Checksum, Control, NRule, PerRay, Plan, RunConfig, RunRecord, Spread, StopReason,
};
use crate::preview::ColorMode;

/// A state at the start, without colour, in a small terminal.
pub fn state() -> State {
    State::new(
        &Plan::default(),
        PathBuf::from("results"),
        ColorMode::None,
        (80, 24),
    )
}

/// The same in a terminal of that size.
pub fn sized(columns: u16, rows: u16) -> State {
    let mut state = state();
    update(&mut state, Event::Resize(columns, rows));
    state
}

fn config(accel: &str, n: Option<u32>) -> RunConfig {
    let mut choice = accel::parse("brute").unwrap();
    accel.clone_into(&mut choice.name);
    RunConfig {
        scene: "teapot".to_owned(),
        accel: choice,
        n: n.map(NRule::Fixed),
        kernel: kernel::parse("woop").unwrap(),
        rays: "primary".to_owned(),
        threads: 1,
        ray_count: 65_536,
        seed: 1,
    }
}

/// Brute force, four grids, a tree, and a grid that cannot be made.
pub fn configs() -> Vec<(String, RunConfig)> {
    let mut runs = vec![config("brute", None)];
    runs.extend([1, 8, 32, 128].map(|n| config("grid", Some(n))));
    runs.push(config("bvh", None));
    runs.push(config("grid", Some(1024)));
    runs.into_iter().map(|run| (run.id(), run)).collect()
}

fn spread(mean: f64) -> Spread {
    Spread {
        mean,
        p50: mean as u64,
        p99: mean as u64 * 3,
        max: mean as u64 * 5,
    }
}

fn record(id: &str, config: &RunConfig, speeds: &[f64]) -> Box<RunRecord> {
    let n = match config.n {
        Some(NRule::Fixed(n)) => Some(n),
        _ => None,
    };
    let cells = f64::from(n.unwrap_or(12));
    Box::new(RunRecord {
        id: id.to_owned(),
        config: config.clone(),
        n,
        picked: None,
        triangles: 6320,
        ray_count: 65_536,
        build_ms: vec![1.5 * cells],
        memory_bytes: (cells * 100_000.0) as u64,
        mrays_per_s: speeds.to_vec(),
        stopped_by: StopReason::Interval,
        per_ray: Some(PerRay {
            steps: spread(cells),
            empty_steps: spread(cells / 2.0),
            tests: spread(6320.0 / cells),
            duplicate_tests: spread(0.0),
        }),
        structure: Some(StructureStats::default()),
        predicted: None,
        checksum: Checksum::default(),
        valid: true,
        checked_rays: 4096,
        kernel_errors: 0,
        wrong_answers: None,
        warnings: Vec::new(),
    })
}

/// What a sweep over [`configs`] tells, up to the end of its last run.
pub fn events() -> Vec<lab::Event> {
    let runs = configs();
    let mut events = vec![lab::Event::Started { runs: runs.clone() }];
    for (i, (id, config)) in runs.iter().enumerate() {
        events.push(lab::Event::Building { id: id.clone() });
        if i + 1 == runs.len() {
            events.push(lab::Event::Failed {
                id: id.clone(),
                why: "grid at n = 1024 would take about 5000 MB".to_owned(),
            });
            continue;
        }
        let speed = [0.02, 0.05, 3.1, 11.5, 6.3, 9.8][i];
        events.push(lab::Event::Built {
            record: record(id, config, &[]),
        });
        for k in 0..3 {
            events.push(lab::Event::Sampled {
                id: id.clone(),
                mrays_per_s: speed * (1.0 + 0.01 * f64::from(k)),
                done: (i as f64 + f64::from(k) / 3.0) / runs.len() as f64,
                seconds_left: 30.0 - i as f64,
            });
        }
        events.push(lab::Event::Finished {
            record: record(id, config, &[speed, speed * 1.01, speed * 1.02]),
        });
    }
    events
}

/// The runs of [`events`].
pub fn finished() -> Runs {
    let mut runs = Runs::default();
    for event in events() {
        runs.take(&event);
    }
    runs
}

/// A sweep in the middle: `state` after Enter and some of [`events`].
pub fn running(mut state: State) -> State {
    state.sweep = Sweep::beginning(0.0);
    state.panel = super::state::Panel::Runs;
    update(&mut state, Event::Clock(12.0));
    for event in events().into_iter().take(24) {
        update(&mut state, Event::Lab(event));
    }
    state
}

/// A sweep that is complete and written.
pub fn complete(state: State) -> State {
    let mut state = running(state);
    for event in events().into_iter().skip(24) {
        update(&mut state, Event::Lab(event));
    }
    update(&mut state, Event::Lab(lab::Event::Ended { stopped: false }));
    update(
        &mut state,
        Event::Kept(
            Experiment::Sweep,
            Keeping::Written(PathBuf::from("results/2026-11-22-teapot")),
        ),
    );
    assert_eq!(state.sweep.phase, Phase::Complete);
    state
}

/// The inspector with a ray through the teapot, in a tree and in a grid.
pub fn inspected() -> State {
    inspected_in(sized(120, 40))
}

/// The same in `state`'s terminal.
pub fn inspected_in(mut state: State) -> State {
    let (to, from) = std::sync::mpsc::channel();
    let examiner = Examiner::spawn(1 << 30, Steering::default(), to);
    "teapot:4".clone_into(&mut state.picture.wish.scene);
    let effects = update(&mut state, Event::Key(Key::char('3').event()));
    for effect in effects {
        if let Effect::Inspect(request) = effect {
            examiner.ask(*request);
        }
    }
    while state.inspect.examined(1).is_none() {
        let Ok(Message::News(event)) = from.recv() else {
            panic!("the examiner tells nothing");
        };
        update(&mut state, event);
    }
    state
}

/// The stability screen with a map of two kernels in two accelerators on three cases, made once for all tests.
pub fn tried() -> State {
    tried_in(sized(120, 40))
}

/// The same in `state`'s terminal.
pub fn tried_in(mut state: State) -> State {
    static TOLD: OnceLock<Vec<StabilityEvent>> = OnceLock::new();
    let plan = StabilityPlan {
        cases: vec!["ordinary", "closed-edges", "duplicates"],
        kernels: ["woop", "moller-trumbore"]
            .map(|k| kernel::parse(k).unwrap())
            .to_vec(),
        accels: vec![accel::parse("grid").unwrap()],
        threads: 1,
        ..StabilityPlan::default()
    };
    let told = TOLD.get_or_init(|| {
        let mut told = Vec::new();
        stability(&plan, &Control::default(), &mut |event| told.push(event)).unwrap();
        told
    });
    state.screen = Screen::Stability;
    state.stability.begin(&plan, 0.0);
    for event in told {
        update(&mut state, Event::Trial(event.clone()));
    }
    update(&mut state, Event::TrialsEnded(Ok(false)));
    state
}

/// The Pareto screen with four kernels judged at two offsets.
pub fn judged() -> State {
    judged_in(sized(120, 40))
}

/// The same in `state`'s terminal.
pub fn judged_in(mut state: State) -> State {
    state.screen = Screen::Pareto;
    let plan = state.pareto.plan.accuracy_plan().unwrap();
    state.pareto.begin(&plan, 0.0);
    for offset in [0.0, 1e4] {
        for (kernel, speed, wrong) in [
            ("woop", 10.0, 0),
            ("moller-trumbore", 12.0, 300),
            ("sheet-signed", 9.0, 400),
            ("sheet-unsigned", 9.5, 0),
        ] {
            let wrong = wrong + u64::from(offset > 0.0 && kernel != "woop") * 5000;
            let run = crate::report::fixture::judged(kernel, offset, speed, wrong);
            state.pareto.runs.push(run);
        }
    }
    state.pareto.progress.end(false, 9.0);
    state
}
