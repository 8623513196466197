//! Sweeps as a whole: what they tell, that they can be stopped and gone on with, and that only speeds vary.

use std::collections::{BTreeMap, BTreeSet};

use raylab::accel;
use raylab::kernel;
use raylab::lab::{
    Budget, Control, Done, Event, NRule, Plan, RunConfig, RunRecord, StopReason, sweep, sweep_from,
};

#[path = "fixture/plan.rs"]
mod plan;

/// Two scenes and three resolutions.
fn plan() -> Plan {
    Plan {
        scenes: vec!["teapot:4".to_owned(), "soup:300".to_owned()],
        n: vec![NRule::Fixed(1), NRule::Fixed(8), NRule::Auto],
        kernels: vec![kernel::parse("woop").unwrap()],
        rays: ["primary", "shadow"].map(str::to_owned).to_vec(),
        ray_count: 1200,
        ..plan::plan()
    }
}

/// The events of a sweep, whatever `steer` does in between.
fn events(plan: &Plan, done: &Done, mut steer: impl FnMut(&Event, &Control)) -> Vec<Event> {
    let control = Control::default();
    let mut events = Vec::new();
    sweep_from(plan, done, &control, &mut |event| {
        steer(&event, &control);
        events.push(event);
    })
    .unwrap();
    events
}

fn finished(events: &[Event]) -> BTreeMap<String, RunRecord> {
    let mut records = BTreeMap::new();
    for event in events {
        if let Event::Finished { record } = event {
            let earlier = records.insert(record.id.clone(), (**record).clone());
            assert!(earlier.is_none(), "{} finished twice", record.id);
        }
    }
    records
}

/// What must not vary: everything but times, threads, and what follows from them.
fn fixed(record: &RunRecord) -> impl PartialEq + std::fmt::Debug + use<> {
    (
        (record.n, record.triangles, record.ray_count),
        (record.per_ray, record.structure, record.predicted),
        (record.checksum, record.valid, record.checked_rays),
        (record.kernel_errors, record.memory_bytes),
    )
}

#[test]
fn every_run_of_a_plan_ends_valid_with_its_samples() {
    let plan = plan();
    let events = events(&plan, &Done::default(), |_, _| ());
    let records = finished(&events);
    let ids: BTreeSet<String> = plan.runs().iter().map(RunConfig::id).collect();
    assert_eq!(ids, records.keys().cloned().collect());
    for record in records.values() {
        assert!(record.valid, "{record:?}");
        assert!(record.mrays_per_s.len() >= 3 && !record.build_ms.is_empty());
        assert!(record.mrays_per_s.iter().all(|s| s.is_finite() && *s > 0.0));
        assert_ne!(record.stopped_by, StopReason::Unfinished);
        assert_eq!(record.checked_rays, 200.min(record.ray_count));
        assert!(record.checksum.hits > 0 && record.wrong_answers.is_none());
        assert!(record.per_ray.is_some_and(|work| work.tests.mean > 0.0));
    }
}

#[test]
fn all_runs_over_the_same_rays_have_the_same_checksum() {
    let records = finished(&events(&plan(), &Done::default(), |_, _| ()));
    let mut sums = BTreeMap::new();
    for record in records.values() {
        let key = (
            record.config.scene.clone(),
            record.config.rays.clone(),
            record.ray_count,
        );
        let first = *sums.entry(key).or_insert(record.checksum);
        assert_eq!(first, record.checksum, "{:?}", record.config);
    }
}

#[test]
fn only_speeds_vary_from_one_sweep_to_the_next_and_with_threads() {
    let by_run = |threads: usize| {
        let plan = Plan {
            threads: vec![threads],
            ..plan()
        };
        finished(&events(&plan, &Done::default(), |_, _| ()))
            .into_values()
            .map(|record| {
                let mut config = record.config.clone();
                config.threads = 0;
                (config.id(), fixed(&record))
            })
            .collect::<BTreeMap<_, _>>()
    };
    let once = by_run(1);
    assert_eq!(once, by_run(1));
    assert_eq!(once, by_run(2));
}

#[test]
fn events_come_in_order_and_the_share_done_rises_to_one() {
    let events = events(&plan(), &Done::default(), |_, _| ());
    assert!(matches!(events.first(), Some(Event::Started { .. })));
    assert!(matches!(
        events.last(),
        Some(Event::Ended { stopped: false })
    ));
    let mut built = BTreeSet::new();
    let mut last = 0.0;
    for event in &events {
        match event {
            Event::Built { record } => {
                assert!(record.mrays_per_s.is_empty() && built.insert(record.id.clone()));
            }
            Event::Sampled {
                id,
                done,
                seconds_left,
                ..
            } => {
                assert!(built.contains(id) && *done >= last && *done <= 1.0);
                assert!(seconds_left.is_finite() && *seconds_left >= 0.0);
                last = *done;
            }
            Event::Finished { record } => assert!(built.contains(&record.id)),
            Event::Failed { why, .. } => panic!("{why}"),
            _ => {}
        }
    }
    assert_eq!(last, 1.0);
}

#[test]
fn samples_of_all_kernels_and_thread_counts_on_the_same_rays_are_interleaved() {
    let mut plan = Plan {
        accels: ["bvh", "brute"].map(|a| accel::parse(a).unwrap()).to_vec(),
        threads: vec![1, 2],
        ..plan()
    };
    plan.scenes.truncate(1);
    plan.budget.max_samples = plan.budget.min_samples;
    let runs: BTreeMap<String, RunConfig> =
        plan.runs().into_iter().map(|run| (run.id(), run)).collect();
    // What is sampled, in the order in which it is.
    let interleaved = |plan: &Plan| {
        let events = events(plan, &Done::default(), |_, _| ());
        let sampled: Vec<&RunConfig> = events
            .iter()
            .filter_map(|event| match event {
                Event::Sampled { id, .. } => Some(&runs[id]),
                _ => None,
            })
            .collect();
        let each = plan.runs().len() / plan.rays.len();
        assert_eq!(
            sampled.len(),
            each * plan.rays.len() * plan.budget.min_samples
        );
        sampled.chunks(each).all(|round| {
            let ids: BTreeSet<String> = round.iter().map(|run| run.id()).collect();
            ids.len() == each && round.iter().all(|run| run.rays == round[0].rays)
        })
    };
    assert!(interleaved(&plan));
    // Without room for more than the largest structure, each is sampled alone.
    let records = finished(&events(&plan, &Done::default(), |_, _| ()));
    plan.memory_limit = records.values().map(|r| r.memory_bytes).max().unwrap();
    assert!(!interleaved(&plan));
}

#[test]
fn a_stopped_sweep_goes_on_without_losing_or_repeating_a_run() {
    let plan = plan();
    let mut left = Done::default();
    let mut all = BTreeMap::new();
    for round in 0..100 {
        let mut samples = 0;
        let events = events(&plan, &left, |event, control| {
            samples += usize::from(matches!(event, Event::Sampled { .. }));
            if samples == 7 {
                control.stop();
            }
        });
        for event in &events {
            if let Event::Sampled {
                id, mrays_per_s, ..
            } = event
            {
                left.samples
                    .entry(id.clone())
                    .or_default()
                    .push(*mrays_per_s);
            }
        }
        for (id, record) in finished(&events) {
            // Every sample that was ever taken of the run is in its record, in order.
            assert_eq!(Some(&record.mrays_per_s), left.samples.get(&id));
            left.finished.insert(id.clone());
            assert!(all.insert(id, record).is_none(), "a run was repeated");
        }
        if matches!(events.last(), Some(Event::Ended { stopped: false })) {
            assert!(round > 1, "the sweep was never stopped");
            break;
        }
    }
    assert_eq!(all.len(), plan.runs().len());
    let whole = finished(&events(&plan, &Done::default(), |_, _| ()));
    for (id, record) in &all {
        assert_eq!(fixed(record), fixed(&whole[id]));
    }
    assert!(
        all.values()
            .any(|r| r.warnings.iter().any(|w| w.contains("interruption")))
    );
}

#[test]
fn a_finished_plan_has_nothing_left_to_do() {
    let plan = plan();
    let finished = plan.runs().iter().map(RunConfig::id).collect();
    let mut events = Vec::new();
    sweep(&plan, &finished, &Control::default(), &mut |event| {
        events.push(event);
    })
    .unwrap();
    assert_eq!(events.len(), 2);
}

#[test]
fn disturbed_samples_are_taken_again_and_kept_with_a_warning_at_last() {
    let control = Control::default();
    let plan = Plan {
        scenes: vec!["one".to_owned()],
        accels: vec![accel::parse("brute").unwrap()],
        rays: vec!["random".to_owned()],
        budget: Budget {
            sample_seconds: 2e-3,
            ..plan().budget
        },
        ..plan()
    };
    let mut record = None;
    let over = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(std::sync::atomic::Ordering::Relaxed) {
                control.disturb();
                std::thread::sleep(std::time::Duration::from_micros(50));
            }
        });
        sweep(&plan, &BTreeSet::new(), &control, &mut |event| {
            if let Event::Finished { record: done } = event {
                record = Some(done);
            }
        })
        .unwrap();
        over.store(true, std::sync::atomic::Ordering::Relaxed);
    });
    let warnings = record.unwrap().warnings;
    assert!(
        warnings.iter().any(|w| w.contains("disturbed")),
        "{warnings:?}"
    );
}

#[test]
fn runs_that_cannot_be_made_are_told_and_the_others_go_on() {
    let plan = Plan {
        scenes: vec!["empty".to_owned(), "one".to_owned()],
        rays: vec!["bounce".to_owned()],
        ..plan()
    };
    let events = events(&plan, &Done::default(), |_, _| ());
    let failed = events
        .iter()
        .filter(|e| matches!(e, Event::Failed { why, .. } if why.contains("no rays")));
    let records = finished(&events);
    assert_eq!(failed.count() + records.len(), plan.runs().len());
    assert!(records.values().all(|r| r.config.scene == "one" && r.valid));
    assert!(!records.is_empty());
}

#[test]
fn rays_that_would_take_too_long_are_sampled_and_the_run_says_so() {
    let mut plan = plan();
    plan.budget.run_seconds = 1e-3;
    plan.scenes.truncate(1);
    let records = finished(&events(&plan, &Done::default(), |_, _| ()));
    let brute = records
        .values()
        .find(|r| r.config.accel.name == "brute")
        .unwrap();
    assert!(brute.ray_count < 1000, "{}", brute.ray_count);
    assert!(
        brute
            .warnings
            .iter()
            .any(|w| w.contains("seeded sample of"))
    );
    assert!(records.values().all(|r| r.valid));
    plan.budget.whole_sets = true;
    let whole = finished(&events(&plan, &Done::default(), |_, _| ()));
    for rays in &plan.rays {
        let of_set = whole.values().filter(|r| r.config.rays == *rays);
        let counts: BTreeSet<u64> = of_set.map(|r| r.ray_count).collect();
        assert!(
            counts.len() == 1 && counts.first() > Some(&brute.ray_count),
            "{counts:?}"
        );
    }
    assert_eq!(whole.len(), records.len());
}
