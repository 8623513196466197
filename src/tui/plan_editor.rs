//! The plan as it is edited: each line is a text that a person could have written on the command line; together they
//! are a [`Plan`], or say line by line why not.

use super::plan_text::{MAX_SAMPLES, count, count_text, n_text, samples, split_specs, threads};
use crate::accel;
use crate::kernel;
use crate::lab::{self, Plan};
use crate::registry::Choice;
use crate::scene::{self, SCENES};
use crate::trace::{self, RAY_SETS};

/// A line of the plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Field {
    /// Scene specs.
    Scenes,
    /// Accelerators.
    Accels,
    /// Grid resolutions.
    N,
    /// Kernels.
    Kernels,
    /// Ray sets.
    Rays,
    /// Rays of a set.
    RayCount,
    /// Thread counts.
    Threads,
    /// Fewest and most samples of a run.
    Samples,
}

/// What can be chosen in a line, with a sentence on it.
pub type Offer = (String, String);

impl Field {
    /// All lines from top to bottom.
    pub const ALL: [Self; 8] = [
        Self::Scenes,
        Self::Accels,
        Self::N,
        Self::Kernels,
        Self::Rays,
        Self::RayCount,
        Self::Threads,
        Self::Samples,
    ];

    /// Its name on the screen.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Scenes => "scenes",
            Self::Accels => "accelerators",
            Self::N => "grid n",
            Self::Kernels => "kernels",
            Self::Rays => "rays",
            Self::RayCount => "rays a set",
            Self::Threads => "threads",
            Self::Samples => "samples a run",
        }
    }

    /// How the line is written.
    #[must_use]
    pub fn form(self) -> &'static str {
        match self {
            Self::Scenes => "names, sizes or files: teapot, soup:5000, my/mesh.obj",
            Self::Accels => "names with parameters: grid, grid:overlap=sat, bvh",
            Self::N => "a range or a list: 1..128, or 8,16,32,auto",
            Self::Kernels => "names with parameters: woop, sheet-unsigned:eps=1e-4",
            Self::Rays => "names or files: primary, random, file:my.rays",
            Self::RayCount => "a number: 65536, 64k or 1M",
            Self::Threads => "a list: 1, 2, max",
            Self::Samples => "fewest..most: 5..30",
        }
    }

    /// What the list of choices offers; empty for lines that are typed.
    #[must_use]
    pub fn offers(self) -> Vec<Offer> {
        let offer = |name: &str, about: &str| (name.to_owned(), about.to_owned());
        match self {
            Self::Scenes => SCENES.iter().map(|s| offer(s.name, s.about)).collect(),
            Self::Accels => accel::ACCELERATORS
                .iter()
                .map(|a| offer(a.name, a.about))
                .collect(),
            Self::Kernels => kernel::KERNELS
                .iter()
                .map(|k| offer(k.name, k.about))
                .collect(),
            // A file of rays has no name to choose; it is typed.
            Self::Rays => RAY_SETS
                .iter()
                .filter(|r| r.argument.is_empty())
                .map(|r| offer(r.name, r.about))
                .collect(),
            Self::N | Self::RayCount | Self::Threads | Self::Samples => Vec::new(),
        }
    }

    /// Whether the line is a list of specs.
    #[must_use]
    pub fn is_list(self) -> bool {
        matches!(
            self,
            Self::Scenes | Self::Accels | Self::Kernels | Self::Rays
        )
    }

    fn index(self) -> usize {
        self as usize
    }
}

/// The plan being edited.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanEditor {
    texts: [String; 8],
    errors: [Option<String>; 8],
    /// What the lines do not say: seed, budget, memory limit.
    base: Plan,
    /// The marked line.
    pub marked: Field,
}

impl PlanEditor {
    /// An editor that shows `plan`.
    #[must_use]
    pub fn new(plan: &Plan) -> Self {
        let labels = |choices: &[Choice], label: fn(&Choice) -> String| {
            choices.iter().map(label).collect::<Vec<_>>().join(", ")
        };
        let threads: Vec<String> = plan.threads.iter().map(usize::to_string).collect();
        let mut editor = Self {
            texts: [
                plan.scenes.join(", "),
                labels(&plan.accels, accel_label),
                n_text(&plan.n),
                labels(&plan.kernels, kernel_label),
                plan.rays.join(", "),
                count_text(plan.ray_count),
                threads.join(", "),
                format!("{}..{}", plan.budget.min_samples, plan.budget.max_samples),
            ],
            errors: Default::default(),
            base: plan.clone(),
            marked: Field::Scenes,
        };
        editor.check();
        editor
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
        Field::ALL
            .into_iter()
            .find_map(|field| Some((field, self.error(field)?)))
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

    fn check(&mut self) {
        for field in Field::ALL {
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
        }
    }
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
