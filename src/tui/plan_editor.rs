//! The plan as it is edited: each line is a text that a person could have written on the command line; together they
//! are a [`Plan`], or say line by line why not.

pub use super::plan_field::{Field, Offer};
use super::plan_text::{
    MAX_SAMPLES, count, count_text, n_text, numbers, numbers_text, samples, split_specs, threads,
};
use crate::accel;
use crate::kernel;
use crate::lab::stability::{self, CASES, StabilityPlan};
use crate::lab::{self, AccuracyPlan, Plan};
use crate::registry::Choice;
use crate::scene;
use crate::trace;

/// The plan being edited.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanEditor {
    /// Which lines it has, from top to bottom.
    lines: &'static [Field],
    texts: [String; Field::COUNT],
    errors: [Option<String>; Field::COUNT],
    /// What the lines do not say: seed, budget, memory limit.
    base: Plan,
    /// The marked line.
    pub marked: Field,
}

impl PlanEditor {
    /// An editor of the plan of a sweep.
    #[must_use]
    pub fn new(plan: &Plan) -> Self {
        Self::with(Field::OF_SWEEP, plan)
    }

    /// An editor of a plan that is judged by the oracle.
    #[must_use]
    pub fn of_accuracy(plan: &AccuracyPlan) -> Self {
        let mut editor = Self::with(Field::OF_ACCURACY, &plan.plan);
        editor.set(Field::Offsets, &numbers_text(&plan.offsets));
        editor.set(Field::Scales, &numbers_text(&plan.scales));
        editor
    }

    /// An editor of the plan of the stability suite: every case, kernel and accelerator, with the threads of `plan`.
    #[must_use]
    pub fn of_stability(plan: &Plan) -> Self {
        let suite = StabilityPlan::default();
        let all = Plan {
            accels: suite.accels,
            kernels: suite.kernels,
            ..plan.clone()
        };
        let mut editor = Self::with(Field::OF_STABILITY, &all);
        editor.set(Field::Cases, ALL_CASES);
        editor.set(Field::Extent, EXTENTS[0]);
        editor
    }

    fn with(lines: &'static [Field], plan: &Plan) -> Self {
        let labels = |choices: &[Choice], label: fn(&Choice) -> String| {
            choices.iter().map(label).collect::<Vec<_>>().join(", ")
        };
        let threads: Vec<String> = plan.threads.iter().map(usize::to_string).collect();
        let mut editor = Self {
            lines,
            texts: [
                plan.scenes.join(", "),
                labels(&plan.accels, accel_label),
                n_text(&plan.n),
                labels(&plan.kernels, kernel_label),
                plan.rays.join(", "),
                count_text(plan.ray_count),
                threads.join(", "),
                format!("{}..{}", plan.budget.min_samples, plan.budget.max_samples),
                String::new(),
                String::new(),
                String::new(),
                String::new(),
            ],
            errors: Default::default(),
            base: plan.clone(),
            marked: lines[0],
        };
        editor.check();
        editor
    }

    /// Its lines, from top to bottom.
    #[must_use]
    pub fn lines(&self) -> &'static [Field] {
        self.lines
    }

    /// Moves the mark; whether it could.
    pub fn step(&mut self, lines: isize) -> bool {
        let last = self.lines.len() - 1;
        let at = self.lines.iter().position(|&f| f == self.marked);
        let from = at.unwrap_or(0);
        let to = from.saturating_add_signed(lines).min(last);
        self.marked = self.lines[to];
        to != from
    }

    /// What a line says.
    #[must_use]
    pub fn text(&self, field: Field) -> &str {
        &self.texts[field.index()]
    }

    /// Why a line cannot be run.
    #[must_use]
    pub fn error(&self, field: Field) -> Option<&str> {
        self.errors[field.index()].as_deref()
    }

    /// The specs of a list line.
    #[must_use]
    pub fn items(&self, field: Field) -> Vec<String> {
        split_specs(self.text(field))
    }

    /// Sets a line and checks it.
    pub fn set(&mut self, field: Field, text: &str) {
        text.trim().clone_into(&mut self.texts[field.index()]);
        self.check();
    }

    /// Multiplies the numbers of samples; at least 1 and at most 100,000 remain.
    pub fn scale_samples(&mut self, factor: f64) {
        if let Ok((min, max)) = samples(self.text(Field::Samples)) {
            let scaled = |x: usize| ((x as f64 * factor) as usize).clamp(1, MAX_SAMPLES);
            self.set(Field::Samples, &format!("{}..{}", scaled(min), scaled(max)));
        }
    }

    /// The first line that cannot be run.
    #[must_use]
    pub fn first_error(&self) -> Option<(Field, &str)> {
        let mut lines = self.lines.iter();
        lines.find_map(|&field| Some((field, self.error(field)?)))
    }

    /// The plan; `None` while a line cannot be run.
    #[must_use]
    pub fn plan(&self) -> Option<Plan> {
        if self.first_error().is_some() {
            return None;
        }
        let mut plan = self.base.clone();
        let (min_samples, max_samples) = samples(self.text(Field::Samples)).ok()?;
        // The time of a run grows with the samples asked for, else it would end before they are taken.
        let more = max_samples as f64 / self.base.budget.max_samples.max(1) as f64;
        plan.budget.min_samples = min_samples;
        plan.budget.max_samples = max_samples;
        plan.budget.run_seconds *= more.max(1.0);
        plan.scenes = self.items(Field::Scenes);
        plan.accels = choices(&self.items(Field::Accels), accel::parse).ok()?;
        plan.n = lab::parse_n_list(self.text(Field::N)).ok()?;
        plan.kernels = choices(&self.items(Field::Kernels), kernel::parse).ok()?;
        plan.rays = self.items(Field::Rays);
        plan.ray_count = count(self.text(Field::RayCount)).ok()?;
        plan.threads = threads(self.text(Field::Threads)).ok()?;
        Some(plan)
    }

    /// The plan that the oracle judges; `None` while a line cannot be run.
    #[must_use]
    pub fn accuracy_plan(&self) -> Option<AccuracyPlan> {
        Some(AccuracyPlan {
            plan: self.plan()?,
            offsets: numbers(self.text(Field::Offsets), 0.0).ok()?,
            scales: numbers(self.text(Field::Scales), f64::MIN_POSITIVE).ok()?,
        })
    }

    /// The plan of the stability suite; `None` while a line cannot be run.
    #[must_use]
    pub fn stability_plan(&self) -> Option<StabilityPlan> {
        if self.first_error().is_some() {
            return None;
        }
        let threads = threads(self.text(Field::Threads)).ok()?;
        Some(StabilityPlan {
            cases: cases(&self.items(Field::Cases)).ok()?,
            kernels: choices(&self.items(Field::Kernels), kernel::parse).ok()?,
            accels: choices(&self.items(Field::Accels), accel::parse).ok()?,
            quick: self.text(Field::Extent) == EXTENTS[0],
            seed: self.base.seed,
            threads: threads.into_iter().max().unwrap_or(1),
        })
    }

    fn check(&mut self) {
        for &field in self.lines {
            self.errors[field.index()] = self.problem(field);
        }
    }

    /// Why a line cannot be run, one sentence.
    fn problem(&self, field: Field) -> Option<String> {
        let items = self.items(field);
        if items.is_empty() {
            return Some(format!("nothing chosen; write {}", field.form()));
        }
        let text = self.text(field);
        match field {
            Field::Scenes => first_problem(&items, |s| scene::check(s).map_err(|e| e.to_string())),
            Field::Accels => choices(&items, accel::parse).err(),
            Field::Kernels => choices(&items, kernel::parse).err(),
            Field::Rays => first_problem(&items, |r| trace::check(r, 1).map_err(|e| e.to_string())),
            Field::N => lab::parse_n_list(text).err().map(|e| e.to_string()),
            Field::RayCount => count(text).err(),
            Field::Threads => threads(text).err(),
            Field::Samples => samples(text).err(),
            Field::Offsets => numbers(text, 0.0).err(),
            Field::Scales => numbers(text, f64::MIN_POSITIVE).err(),
            Field::Cases => cases(&items).err(),
            Field::Extent => (!EXTENTS.contains(&text)).then(|| {
                let [quick, full] = EXTENTS;
                format!("'{text}' is neither {quick} nor {full}")
            }),
        }
    }
}

/// What stands for every case.
const ALL_CASES: &str = "all";

/// Accelerators with few kernels, or with all.
const EXTENTS: [&str; 2] = ["quick", "full"];

/// The names of cases, `all` for every one.
fn cases(items: &[String]) -> Result<Vec<&'static str>, String> {
    if items.iter().any(|item| item == ALL_CASES) {
        return Ok(CASES.iter().map(|case| case.name).collect());
    }
    let named = items.iter().map(|name| {
        let case = stability::case(name).map_err(|why| why.to_string())?;
        Ok(case.name)
    });
    named.collect()
}

fn first_problem(items: &[String], check: impl Fn(&str) -> Result<(), String>) -> Option<String> {
    items.iter().find_map(|item| check(item).err())
}

fn choices<E: ToString>(
    items: &[String],
    parse: fn(&str) -> Result<Choice, E>,
) -> Result<Vec<Choice>, String> {
    items
        .iter()
        .map(|item| parse(item).map_err(|e| e.to_string()))
        .collect()
}

/// An accelerator as a person would have written it.
#[must_use]
pub fn accel_label(choice: &Choice) -> String {
    accel::entry(&choice.name).map_or_else(|_| choice.name.clone(), |a| choice.label(a.params))
}

/// A kernel as a person would have written it.
#[must_use]
pub fn kernel_label(choice: &Choice) -> String {
    kernel::entry(choice).map_or_else(|| choice.name.clone(), |k| choice.label(k.params))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::NRule;

    fn editor() -> PlanEditor {
        PlanEditor::new(&Plan::default())
    }

    #[test]
    fn an_unedited_plan_is_the_plan_it_was_made_from() {
        assert_eq!(editor().plan(), Some(Plan::default()));
    }

    #[test]
    fn a_bad_line_says_why_and_holds_the_plan_back_until_it_is_mended() {
        for (field, bad, why) in [
            (Field::Scenes, "teapto", "did you mean 'teapot'?"),
            (Field::Scenes, "", "nothing chosen"),
            (Field::Accels, "brtue", "did you mean 'brute'?"),
            (
                Field::Kernels,
                "moller-trumbor",
                "did you mean 'moller-trumbore'?",
            ),
            (Field::Rays, "primry", "primary"),
            (Field::RayCount, "0", "64k"),
            (Field::RayCount, "99999999999999999999", "64k"),
            (Field::Threads, "1, none", "'none'"),
            (Field::Samples, "9..3", "fewest..most"),
            (Field::N, "x", "x"),
        ] {
            let mut editor = editor();
            let good = editor.text(field).to_owned();
            editor.set(field, bad);
            let (at, message) = editor.first_error().unwrap();
            assert_eq!(at, field, "{bad}");
            assert!(message.contains(why), "{message}");
            assert_eq!(editor.plan(), None);
            editor.set(field, &good);
            assert_eq!(editor.first_error(), None);
        }
    }

    #[test]
    fn the_plan_to_be_judged_has_offsets_and_scales() {
        let plan = AccuracyPlan {
            plan: Plan::default(),
            offsets: vec![0.0, 1e4],
            scales: vec![1.0, 1e-30],
        };
        let mut editor = PlanEditor::of_accuracy(&plan);
        assert_eq!(editor.accuracy_plan(), Some(plan));
        for (field, bad) in [
            (Field::Offsets, "-1"),
            (Field::Offsets, "NaN"),
            (Field::Offsets, "1e999"),
            (Field::Scales, "0"),
            (Field::Scales, "one"),
        ] {
            let good = editor.text(field).to_owned();
            editor.set(field, bad);
            assert_eq!(editor.first_error().map(|e| e.0), Some(field), "{bad}");
            editor.set(field, &good);
        }
    }

    #[test]
    fn the_plan_of_the_suite_has_lines_of_its_own() {
        let mut editor = PlanEditor::of_stability(&Plan::default());
        let plan = editor.stability_plan().unwrap();
        assert_eq!(plan.cases.len(), CASES.len());
        assert!(plan.quick && plan.kernels.len() == kernel::KERNELS.len());
        for (field, bad) in [(Field::Cases, "closed-edgs"), (Field::Extent, "some")] {
            let good = editor.text(field).to_owned();
            editor.set(field, bad);
            assert_eq!(editor.first_error().map(|e| e.0), Some(field));
            assert_eq!(editor.stability_plan(), None);
            editor.set(field, &good);
        }
        editor.set(Field::Extent, "full");
        assert!(!editor.stability_plan().unwrap().quick);
    }

    #[test]
    fn edited_lines_reach_the_plan() {
        let mut editor = editor();
        editor.set(Field::RayCount, "4k");
        editor.set(Field::Threads, "1,1,2");
        editor.set(Field::Samples, "7");
        editor.set(Field::N, "8,16");
        let plan = editor.plan().unwrap();
        assert_eq!(plan.ray_count, 4096);
        assert_eq!(plan.threads, [1, 2]);
        assert_eq!((plan.budget.min_samples, plan.budget.max_samples), (7, 7));
        assert_eq!(plan.n, [NRule::Fixed(8), NRule::Fixed(16)]);
    }

    #[test]
    fn more_samples_are_given_the_time_they_need() {
        let mut editor = editor();
        let before = editor.plan().unwrap().budget;
        editor.scale_samples(2.0);
        let after = editor.plan().unwrap().budget;
        assert_eq!(after.max_samples, 2 * before.max_samples);
        assert_eq!(after.run_seconds, 2.0 * before.run_seconds);
        for _ in 0..40 {
            editor.scale_samples(0.5);
        }
        assert_eq!(editor.plan().unwrap().budget.max_samples, 1);
    }
}
