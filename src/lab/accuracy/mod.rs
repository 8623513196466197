//! Accuracy beside speed: what a method decides wrongly by the oracle, and what it costs, on the same rays.
//!
//! ```text
//! scene ─┬─ place 0 (offset, scale) ─┬─ rays ─── oracle: truths ─┐
//!        └─ place 1                  └─ …                        ├─▶ Accuracy
//!                                       kernel × accelerator ────┤      +
//!                                                                └─▶ RunRecord (built, counted, checked and timed as in a sweep)
//! ```
//!
//! The scene is scaled and moved first and rounded to `f32`; the rays are made there. So the oracle judges the numbers
//! that the method sees, and an error is never one of the input. What counts as what: the tables in `judge` and `probe`.
//! Samples of all runs on the same rays are interleaved in seeded random order, as in a sweep; judging stands between
//! building and timing.
//!
//! **A row** is one [`AccuracyRecord`]: one configuration (scene, accelerator with n, kernel, ray set, threads) at one
//! [`Place`], with its speed and one [`Accuracy`]. In a report it is a run whose `accuracy` is present, which holds the
//! place as `offset` and `scale`. Every rate counts all rays of the set; the speed is measured on as many of them as
//! fit into a sample. Rows stand in the order of [`AccuracyPlan::runs`], whatever the order in which they ended.
//!
//! **How much is kept.** 32 bytes a ray and 16 a truth, for one ray set at a time: the oracle is asked once for all kernels
//! in all accelerators. Answers are judged batch by batch and forgotten; percentiles come from histograms.
//!
//! **Known bias.** What is judged is kernel and accelerator together; with an accelerator that obeys its rule it is the
//! kernel, except that a phantom outside its triangle's cell may be met by one structure and not by another.

#![doc = include_str!("figures.md")]

mod experiment;
mod first_wrong;
pub(in crate::lab) mod judge;
mod place;
mod probe;
mod record;
mod starts;
mod truth;

pub(super) use judge::Truths;

pub use experiment::{accuracy, accuracy_from};
pub use first_wrong::first_wrong;
pub use place::{Place, rays as placed_rays, scene as placed};
pub use record::{Accuracy, AccuracyBounds, ErrorSpread, Fallbacks, Rate, SelfHits};
pub use starts::StartRule;

use super::{LabError, Plan, RunConfig, RunRecord};

/// What is judged: the runs of a plan, at each place.
#[derive(Debug, Clone, PartialEq)]
pub struct AccuracyPlan {
    /// Scenes, accelerators, kernels, ray sets and how they are timed.
    pub plan: Plan,
    /// How far the scene is moved along each axis: finite, not negative.
    pub offsets: Vec<f64>,
    /// Factors by which the scene is scaled about the world's origin, before it is moved: finite, positive.
    pub scales: Vec<f64>,
}

/// A configuration in a place.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedRun {
    /// Hash of configuration and place: that of the configuration itself in the scene's own place.
    pub id: String,
    /// Where.
    pub place: Place,
    /// What.
    pub config: RunConfig,
}

/// A run that was judged and timed.
#[derive(Debug, Clone, PartialEq)]
pub struct AccuracyRecord {
    /// As of a sweep; its id knows the place.
    pub run: RunRecord,
    /// What the oracle found.
    pub accuracy: Accuracy,
}

/// How much was judged, and how fast.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Judging {
    /// Rays that the oracle was asked about, and the seconds that took on all cores.
    pub truths: (u64, f64),
    /// Rays whose answers of both queries were traced and judged, and the seconds.
    pub answers: (u64, f64),
}

/// What a running experiment tells.
#[derive(Debug, Clone)]
pub enum AccuracyEvent {
    /// Something goes on: share done, 0 to 1, and what.
    Doing {
        /// Share of the runs that are complete.
        done: f64,
        /// What is done now.
        what: String,
    },
    /// A sample was taken.
    Sampled {
        /// The run.
        id: String,
        /// Its speed.
        mrays_per_s: f64,
    },
    /// A run is complete.
    Finished {
        /// Everything found.
        record: Box<AccuracyRecord>,
    },
    /// A run could not be made; the experiment goes on.
    Failed {
        /// Why, one sentence.
        why: String,
    },
    /// The experiment has ended, complete or stopped.
    Ended {
        /// Whether it was stopped.
        stopped: bool,
        /// How much was judged.
        judging: Judging,
    },
}

impl AccuracyPlan {
    /// Checks everything that can be checked before the first run.
    ///
    /// # Errors
    /// As [`Plan::check`]; no offset or scale, one that is out of bounds or no number.
    pub fn check(&self) -> Result<(), LabError> {
        for (what, list) in [("offset", &self.offsets), ("scale", &self.scales)] {
            if list.is_empty() {
                return Err(LabError::Nothing { what });
            }
        }
        let offset = |o: &&f64| !(o.is_finite() && **o >= 0.0);
        if let Some(bad) = self.offsets.iter().find(offset) {
            return Err(LabError::Offset(bad.to_string()));
        }
        let scale = |s: &&f64| !(s.is_finite() && **s > 0.0);
        if let Some(bad) = self.scales.iter().find(scale) {
            return Err(LabError::Scale(bad.to_string()));
        }
        self.plan.check()
    }

    /// All places: for each scale each offset, each once.
    #[must_use]
    pub fn places(&self) -> Vec<Place> {
        let mut places: Vec<Place> = Vec::new();
        for &scale in &self.scales {
            for &offset in &self.offsets {
                let place = Place { offset, scale };
                if !places.contains(&place) {
                    places.push(place);
                }
            }
        }
        places
    }

    /// Its runs: by scene, place, rays, kernel, threads, accelerator, n.
    #[must_use]
    pub fn runs(&self) -> Vec<PlacedRun> {
        let (runs, places) = (self.plan.runs(), self.places());
        let placed = |place: Place, config: &RunConfig| PlacedRun {
            id: id(config, place),
            place,
            config: config.clone(),
        };
        runs.chunk_by(|a, b| a.scene == b.scene)
            .flat_map(|of_scene| {
                let at = |place: &Place| of_scene.iter().map(|run| placed(*place, run)).collect();
                places.iter().map(at).collect::<Vec<Vec<PlacedRun>>>()
            })
            .flatten()
            .collect()
    }
}

/// The hash of a configuration in its place.
fn id(run: &RunConfig, place: Place) -> String {
    if place == Place::ITS_OWN {
        return run.id();
    }
    let mut moved = run.clone();
    if place.scale != 1.0 {
        moved.rays = format!("{} scaled by {}", moved.rays, place.scale);
    }
    if place.offset != 0.0 {
        moved.rays = format!("{} moved by {}", moved.rays, place.offset);
    }
    moved.id()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::kernel;
    use crate::lab::{Budget, Control, Done};

    fn plan(kernels: &[&str], offsets: &[f64]) -> AccuracyPlan {
        AccuracyPlan {
            plan: Plan {
                scenes: vec!["shells:1,3".to_owned()],
                accels: vec![crate::accel::parse("bvh").unwrap()],
                kernels: kernels.iter().map(|k| kernel::parse(k).unwrap()).collect(),
                rays: vec!["edge".to_owned()],
                threads: vec![1],
                ray_count: 2000,
                budget: Budget {
                    sample_seconds: 1e-4,
                    min_samples: 1,
                    run_seconds: 1e-3,
                    checked_rays: 64,
                    ..Budget::quick()
                },
                ..Plan::default()
            },
            offsets: offsets.to_vec(),
            scales: vec![1.0],
        }
    }

    fn found(plan: &AccuracyPlan) -> Vec<AccuracyRecord> {
        let mut records = Vec::new();
        accuracy(plan, &Control::default(), &mut |event| match event {
            AccuracyEvent::Finished { record } => records.push(*record),
            AccuracyEvent::Failed { why } => panic!("{why}"),
            _ => {}
        })
        .unwrap();
        records
    }

    #[test]
    fn far_from_the_origin_the_sheet_decides_more_edges_wrongly_than_woop() {
        let records = found(&plan(&["woop", "sheet-signed"], &[1e4]));
        let [woop, sheet] = ["woop", "sheet-signed"].map(|kernel| {
            let is = |r: &&AccuracyRecord| r.run.config.kernel.name == kernel;
            records.iter().find(is).unwrap().accuracy
        });
        assert_eq!((woop.rays, woop.offset), (2000, 1e4));
        assert_eq!(woop.wrong(), 0, "{woop:?}");
        assert!(woop.upper95.leaks < 3.0 / 2000.0);
        assert!(sheet.wrong() > 20, "{sheet:?}");
        assert_eq!(woop.self_hits.unwrap()[4].rate.seen, 0);
    }

    #[test]
    fn every_run_has_an_id_of_its_own_and_samples() {
        let records = found(&plan(&["woop", "moller-trumbore"], &[0.0, 1.0]));
        let ids: BTreeSet<&str> = records.iter().map(|r| r.run.id.as_str()).collect();
        assert_eq!((records.len(), ids.len()), (4, 4));
        assert!(
            records
                .iter()
                .all(|r| !r.run.mrays_per_s.is_empty() && r.run.valid)
        );
    }

    #[test]
    fn a_scene_of_any_size_is_judged_the_same_as_long_as_f32_holds_it() {
        let mut plan = plan(&["woop", "moller-trumbore"], &[0.0]);
        // At 2^-40 the determinants of Möller and Trumbore would already be subnormal.
        plan.scales = vec![2_f64.powi(-20), 1.0, 2_f64.powi(20)];
        let records = found(&plan);
        assert_eq!(records.len(), 6);
        for of_kernel in ["woop", "moller-trumbore"] {
            let of = records
                .iter()
                .filter(|r| r.run.config.kernel.name == of_kernel);
            let wrong: BTreeSet<u64> = of.map(|r| r.accuracy.wrong()).collect();
            assert_eq!(wrong.len(), 1, "{of_kernel} {wrong:?}");
        }
    }

    #[test]
    fn runs_stand_by_scene_place_and_kernel_and_finished_ones_are_not_made_again() {
        let mut plan = plan(&["woop", "moller-trumbore"], &[0.0, 1.0]);
        plan.scales.push(2.0);
        let runs = plan.runs();
        let places: Vec<(f64, f64)> = runs
            .iter()
            .map(|r| (r.place.scale, r.place.offset))
            .collect();
        let expected = [(1.0, 0.0), (1.0, 1.0), (2.0, 0.0), (2.0, 1.0)];
        assert_eq!(places, expected.map(|p| [p; 2]).concat());
        let mut finished: BTreeSet<String> = runs.iter().map(|r| r.id.clone()).collect();
        assert_eq!(finished.len(), 8);
        finished.remove(&runs[5].id);
        let samples = [(runs[5].id.clone(), vec![3.5])].into();
        let mut made = Vec::new();
        let done = Done { finished, samples };
        accuracy_from(&plan, &done, &Control::default(), &mut |event| {
            if let AccuracyEvent::Finished { record } = event {
                made.push(record);
            }
        })
        .unwrap();
        assert_eq!(made.len(), 1);
        assert_eq!(
            (&made[0].run.id, made[0].run.mrays_per_s[0]),
            (&runs[5].id, 3.5)
        );
    }

    #[test]
    fn a_stopped_experiment_tells_so_and_impossible_offsets_are_refused() {
        let control = Control::default();
        control.stop();
        let mut told = None;
        accuracy(&plan(&["woop"], &[0.0]), &control, &mut |event| {
            if let AccuracyEvent::Ended { stopped, .. } = event {
                told = Some(stopped);
            }
        })
        .unwrap();
        assert_eq!(told, Some(true));
        for (offsets, part) in [(vec![], "no offset"), (vec![f64::NAN], "NaN")] {
            let why = plan(&["woop"], &offsets).check().unwrap_err().to_string();
            assert!(why.contains(part), "{why}");
        }
        for (scales, part) in [(vec![], "no scale"), (vec![0.0], "by 0")] {
            let mut plan = plan(&["woop"], &[0.0]);
            plan.scales = scales;
            let why = plan.check().unwrap_err().to_string();
            assert!(why.contains(part), "{why}");
        }
    }
}
