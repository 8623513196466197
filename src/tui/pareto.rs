//! The Pareto screen: methods judged by the oracle, their speed against how often they decide wrongly.

use super::plan_editor::PlanEditor;
use super::progress::Progress;
use super::state::{Kept, Opened, Panel, Source};
use crate::accel;
use crate::kernel;
use crate::lab::{AccuracyEvent, AccuracyPlan, Budget, NRule, Place, Plan};
use crate::registry::{Choice, ParamSpec, Params};
use crate::report::Run;
use crate::report::judged::{self, Course, Judged};

/// By what the list is sorted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// The fastest first.
    Speed,
    /// The one with the least share of wrong decisions first; of equals the fastest.
    Wrong,
    /// By name.
    Name,
}

impl Order {
    /// What sorting by it is called.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Wrong => "wrong decisions",
            Self::Name => "name",
        }
    }

    fn next(self) -> Self {
        match self {
            Self::Speed => Self::Wrong,
            Self::Wrong => Self::Name,
            Self::Name => Self::Speed,
        }
    }
}

/// A method on the chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// As the chart shows it.
    pub judged: Judged,
    /// The place of its name among all of the session: its marker and colour.
    pub look: usize,
    /// Everything measured of it.
    pub run: Run,
}

impl Point {
    /// Where it was judged.
    #[must_use]
    pub fn place(&self) -> Place {
        judged::place_of(&self.judged.accuracy)
    }

    /// Accelerator, resolution and kernel.
    #[must_use]
    pub fn configuration(&self) -> (Choice, NRule, Choice) {
        let run = &self.run;
        let auto = run.params.text("n_rule") == "auto";
        let n = run.n.filter(|_| !auto).map_or(NRule::Auto, NRule::Fixed);
        let accel = accel::entry(&run.accel).map_or(&[][..], |entry| entry.params);
        let named = Choice {
            name: run.kernel.clone(),
            params: Params::default(),
        };
        let kernel = kernel::entry(&named).map_or(&[][..], |entry| entry.params);
        (
            choice(&run.accel, accel, &run.params, ""),
            n,
            choice(&run.kernel, kernel, &run.params, "kernel."),
        )
    }
}

/// A choice with those parameters of a run that are its own; one that an accelerator has too is marked by `prefix`.
fn choice(name: &str, specs: &[ParamSpec], of_run: &Params, prefix: &str) -> Choice {
    let mut params = Params::defaults(specs);
    for spec in specs {
        let marked = format!("{prefix}{}", spec.name);
        let find = |key: &str| of_run.iter().find(|(name, _)| *name == key);
        if let Some((_, value)) = find(&marked).or_else(|| find(spec.name)) {
            params.insert(spec.name, value.clone());
        }
    }
    Choice {
        name: name.to_owned(),
        params,
    }
}

/// What of the judged runs is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Shown {
    /// Scene, ray set, threads.
    pub course: Course,
    /// Where the scene is, and how large.
    pub place: Place,
    /// Which of how many courses and, of this one, places it is, from 1.
    pub at: [(usize, usize); 2],
    /// The methods, in the order of the list.
    pub points: Vec<Point>,
}

/// The Pareto screen.
#[derive(Debug, Clone)]
pub struct Pareto {
    /// What is judged next.
    pub plan: PlanEditor,
    /// Which panel has the keys.
    pub panel: Panel,
    /// How far the experiment is.
    pub progress: Progress,
    /// What becomes of it.
    pub kept: Kept,
    /// The plan that ran last.
    pub ran: Option<AccuracyPlan>,
    /// What was judged by it.
    pub runs: Vec<Run>,
    /// Why runs could not be made.
    pub failed: Vec<String>,
    /// Where the points come from.
    pub source: Source,
    /// Which course.
    pub course: usize,
    /// Which place of it.
    pub place: usize,
    /// The order of the list.
    pub order: Order,
    /// The marked point, by its place in the list.
    pub marked: usize,
    /// The configuration that was opened.
    pub opened: Option<Box<Point>>,
    /// What was told while the display was held still.
    held: Vec<AccuracyEvent>,
}

/// Offsets at the start: near the origin, and where world coordinates lose their digits.
const OFFSETS: [f64; 2] = [0.0, 1e4];

impl Pareto {
    /// Every kernel in the default accelerator, on the scenes of `plan`: a first look.
    #[must_use]
    pub fn new(plan: &Plan) -> Self {
        let kernels = kernel::methods().filter_map(|k| kernel::parse(k.name).ok());
        let judged = Plan {
            accels: accel::parse(accel::DEFAULT).into_iter().collect(),
            kernels: kernels.collect(),
            rays: ["edge", "random"].map(str::to_owned).to_vec(),
            budget: Budget::quick(),
            ..plan.clone()
        };
        Self {
            plan: PlanEditor::of_accuracy(&AccuracyPlan {
                plan: judged,
                offsets: OFFSETS.to_vec(),
                scales: vec![1.0],
            }),
            panel: Panel::Plan,
            progress: Progress::idle(),
            kept: Kept::default(),
            ran: None,
            runs: Vec::new(),
            failed: Vec::new(),
            source: Source::Live,
            course: 0,
            place: 0,
            order: Order::Speed,
            marked: 0,
            opened: None,
            held: Vec::new(),
        }
    }

    /// A new experiment begins.
    pub fn begin(&mut self, plan: &AccuracyPlan, clock: f64) {
        self.progress = Progress::beginning(clock);
        self.ran = Some(plan.clone());
        self.kept = Kept::default();
        self.runs.clear();
        self.failed.clear();
        self.held.clear();
        self.look_at(None);
        self.panel = Panel::Runs;
    }

    /// Shows the judged runs of a report that was opened, where it has any; else those of this session.
    pub fn look_at(&mut self, opened: Option<&Opened>) {
        let judged = |opened: &Opened| opened.report.runs.iter().any(|r| r.accuracy.is_some());
        self.source = if opened.is_some_and(judged) {
            self.panel = Panel::Runs;
            Source::Opened
        } else {
            Source::Live
        };
        (self.course, self.place, self.marked) = (0, 0, 0);
        self.opened = None;
    }

    /// Takes in what was told while the display was held still.
    pub fn catch_up(&mut self, clock: f64) {
        for event in std::mem::take(&mut self.held) {
            self.take(event, false, clock);
        }
    }

    /// Takes in what the experiment tells; points that come while the display is `frozen` are shown later.
    pub fn take(&mut self, event: AccuracyEvent, frozen: bool, clock: f64) {
        if frozen && !matches!(event, AccuracyEvent::Ended { .. }) {
            self.held.push(event);
            return;
        }
        match event {
            AccuracyEvent::Doing { done, what } => {
                self.progress.done = done.clamp(0.0, 1.0);
                self.progress.doing = what;
            }
            AccuracyEvent::Finished { record } => {
                self.runs.push(Run::from(record.as_ref()));
            }
            AccuracyEvent::Failed { why } => self.failed.push(why),
            AccuracyEvent::Ended { stopped, .. } => self.progress.end(stopped, clock),
            AccuracyEvent::Sampled { .. } => {}
        }
    }

    /// What is shown of `runs`; `None` where none was judged.
    #[must_use]
    pub fn shown(&self, runs: &[Run]) -> Option<Shown> {
        let courses = judged::courses(runs);
        let at_course = self.course.min(courses.len().checked_sub(1)?);
        let course = courses[at_course].clone();
        let places = judged::places(runs, &course);
        let at_place = self.place.min(places.len().checked_sub(1)?);
        let place = places[at_place];
        let labels = judged::labels(runs);
        let of_chart = runs.iter().filter(|run| {
            let positive = run.mrays_per_s.median.is_finite() && run.mrays_per_s.median > 0.0;
            let here = (run.accuracy.as_ref()).is_some_and(|a| judged::place_of(a) == place);
            positive && here && Course::of(run) == course
        });
        let mut points: Vec<Point> = judged::points(runs, &course, place)
            .into_iter()
            .zip(of_chart)
            .map(|(judged, run)| Point {
                look: labels.iter().position(|l| *l == judged.label).unwrap_or(0),
                judged,
                run: run.clone(),
            })
            .collect();
        self.sort(&mut points);
        Some(Shown {
            course,
            place,
            at: [(at_course + 1, courses.len()), (at_place + 1, places.len())],
            points,
        })
    }

    fn sort(&self, points: &mut [Point]) {
        let rate = |p: &Point| p.judged.accuracy.wrong_rate();
        points.sort_by(|a, b| {
            let by_speed = b.judged.speed[0].total_cmp(&a.judged.speed[0]);
            let by_name = a.judged.label.cmp(&b.judged.label);
            match self.order {
                Order::Speed => by_speed.then(by_name),
                Order::Wrong => rate(a).total_cmp(&rate(b)).then(by_speed).then(by_name),
                Order::Name => by_name,
            }
        });
    }

    /// Sorts by the next order.
    pub fn sort_by_next(&mut self) {
        self.order = self.order.next();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::fixture;

    #[test]
    fn each_course_and_place_has_its_points_in_the_order_of_the_list() {
        let state = fixture::judged();
        let mut pareto = state.pareto;
        let shown = pareto.shown(&pareto.runs).unwrap();
        assert_eq!(shown.at, [(1, 1), (1, 2)]);
        assert_eq!(shown.points.len(), 4);
        let speeds: Vec<f64> = shown.points.iter().map(|p| p.judged.speed[0]).collect();
        assert!(speeds.is_sorted_by(|a, b| a >= b));
        pareto.sort_by_next();
        let shown = pareto.shown(&pareto.runs).unwrap();
        let wrong: Vec<u64> = shown
            .points
            .iter()
            .map(|p| p.judged.accuracy.wrong())
            .collect();
        assert!(wrong.is_sorted());
        pareto.place = 99;
        assert_eq!(pareto.shown(&pareto.runs).unwrap().place.offset, 1e4);
        assert!(pareto.shown(&[]).is_none());
    }

    #[test]
    fn a_run_gives_back_the_configuration_that_it_measured() {
        let state = fixture::judged();
        let shown = state.pareto.shown(&state.pareto.runs).unwrap();
        for point in &shown.points {
            let (accel, _, kernel) = point.configuration();
            assert_eq!(accel::parse(&point.run.accel).unwrap(), accel);
            assert_eq!(kernel::parse(&point.run.kernel).unwrap(), kernel);
        }
        let mut point = shown.points[0].clone();
        point.run.kernel = "sheet-unsigned".to_owned();
        point
            .run
            .params
            .insert("eps", crate::registry::Value::Float(0.25));
        let (_, _, kernel) = point.configuration();
        assert_eq!(kernel.params.number("eps"), Some(0.25));
    }

    #[test]
    fn a_report_without_judged_runs_leaves_the_session_in_view() {
        let mut pareto = fixture::judged().pareto;
        pareto.look_at(None);
        assert_eq!(pareto.source, Source::Live);
    }
}
