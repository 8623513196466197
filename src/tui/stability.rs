//! The stability screen: which kernel and which accelerator break on which case, cell by cell as they are found.

use super::plan_editor::{PlanEditor, accel_label, kernel_label};
use super::progress::Progress;
use super::state::Panel;
use crate::lab::Plan;
use crate::lab::stability::{Cell, Reproducer, StabilityEvent, StabilityPlan, Verdict};

/// The accelerator in which kernels are judged alone.
const BRUTE: &str = "brute";

/// Which methods are the rows of the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// Kernels, in the chosen accelerator.
    Kernels,
    /// Accelerators, with the chosen kernel, or with the one that does worst.
    Accels,
}

/// What is to be made again.
#[derive(Debug, Clone, PartialEq)]
pub struct Wanted {
    /// The cell that fails.
    pub cell: Cell,
    /// The seed of its map.
    pub seed: u64,
    /// Whether it is written to files; else it is inspected.
    pub export: bool,
}

/// What came of it.
#[derive(Debug, Clone)]
pub enum Reproduced {
    /// To be inspected.
    Found(Box<Reproducer>),
    /// Written; a sentence that says where.
    Written(String),
    /// Not; why.
    Failed(String),
}

/// The stability screen.
#[derive(Debug, Clone)]
pub struct Stability {
    /// What is tried next.
    pub plan: PlanEditor,
    /// Which panel has the keys.
    pub panel: Panel,
    /// How far the suite is.
    pub progress: Progress,
    /// Why it broke off.
    pub error: Option<String>,
    /// Cases of the suite that ran last.
    pub cases: Vec<&'static str>,
    /// Its kernels.
    pub kernels: Vec<String>,
    /// Its accelerators, brute force first: there kernels are judged alone.
    pub accels: Vec<String>,
    /// By case, accelerator, kernel; `None` until a cell is found.
    cells: Vec<Option<Box<Cell>>>,
    /// The seed of its cases.
    pub seed: u64,
    /// Which methods are the rows.
    pub view: View,
    /// The accelerator in which kernels are shown.
    pub accel: usize,
    /// The kernel with which accelerators are shown; one beyond the last: whichever does worst.
    pub kernel: usize,
    /// The marked row.
    pub row: usize,
    /// The marked case.
    pub case: usize,
    /// What was told while the display was held still.
    held: Vec<StabilityEvent>,
}

impl Stability {
    /// Nothing tried yet.
    #[must_use]
    pub fn new(plan: &Plan) -> Self {
        Self {
            plan: PlanEditor::of_stability(plan),
            panel: Panel::Plan,
            progress: Progress::idle(),
            error: None,
            cases: Vec::new(),
            kernels: Vec::new(),
            accels: Vec::new(),
            cells: Vec::new(),
            seed: plan.seed,
            view: View::Kernels,
            accel: 0,
            kernel: 0,
            row: 0,
            case: 0,
            held: Vec::new(),
        }
    }

    /// The suite begins.
    pub fn begin(&mut self, plan: &StabilityPlan, clock: f64) {
        self.progress = Progress::beginning(clock);
        self.error = None;
        self.cases.clone_from(&plan.cases);
        self.kernels = plan.kernels.iter().map(kernel_label).collect();
        let structures = plan.accels.iter().filter(|a| a.name != BRUTE);
        self.accels = std::iter::once(BRUTE.to_owned())
            .chain(structures.map(accel_label))
            .collect();
        self.cells = vec![None; self.cases.len() * self.accels.len() * self.kernels.len()];
        self.seed = plan.seed;
        (self.accel, self.kernel, self.row, self.case) = (0, self.kernels.len(), 0, 0);
        self.view = View::Kernels;
        self.held.clear();
        self.panel = Panel::Runs;
    }

    /// Takes in what the suite tells; what is told while the display is `frozen` is shown later.
    pub fn take(&mut self, event: StabilityEvent, frozen: bool) {
        if frozen {
            self.held.push(event);
            return;
        }
        let StabilityEvent::Cell { cell, done, all } = event;
        self.progress.done = done as f64 / all.max(1) as f64;
        self.progress.doing = format!("{} / {} on {}", cell.accel, cell.kernel, cell.case);
        let at = |list: &[String], name: &str| list.iter().position(|l| l == name);
        let case = self.cases.iter().position(|case| *case == cell.case);
        if let (Some(case), Some(accel), Some(kernel)) = (
            case,
            at(&self.accels, &cell.accel),
            at(&self.kernels, &cell.kernel),
        ) {
            let index = self.index(case, accel, kernel);
            self.cells[index] = Some(cell);
        }
    }

    /// Takes in what was told while the display was held still.
    pub fn catch_up(&mut self) {
        for event in std::mem::take(&mut self.held) {
            self.take(event, false);
        }
    }

    fn index(&self, case: usize, accel: usize, kernel: usize) -> usize {
        (case * self.accels.len() + accel) * self.kernels.len() + kernel
    }

    fn cell(&self, case: usize, accel: usize, kernel: usize) -> Option<&Cell> {
        let inside = accel < self.accels.len() && kernel < self.kernels.len();
        let index = inside.then(|| self.index(case, accel, kernel))?;
        self.cells.get(index)?.as_deref()
    }

    /// Whether there is a map.
    #[must_use]
    pub fn has_cells(&self) -> bool {
        !self.cells.is_empty()
    }

    /// The methods that are the rows of the map.
    #[must_use]
    pub fn rows(&self) -> &[String] {
        match self.view {
            View::Kernels => &self.kernels,
            // Brute force is not a structure that could break.
            View::Accels => self.accels.get(1..).unwrap_or_default(),
        }
    }

    /// The cell of a row and a case; `None` until it is found, or where it is not tried.
    #[must_use]
    pub fn at(&self, row: usize, case: usize) -> Option<&Cell> {
        match self.view {
            View::Kernels => self.cell(case, self.accel, row),
            View::Accels if self.kernel < self.kernels.len() => {
                self.cell(case, row + 1, self.kernel)
            }
            View::Accels => {
                let of = (0..self.kernels.len()).filter_map(|k| self.cell(case, row + 1, k));
                of.reduce(|worst, cell| {
                    if cell.verdict > worst.verdict {
                        cell
                    } else {
                        worst
                    }
                })
            }
        }
    }

    /// The marked cell.
    #[must_use]
    pub fn marked(&self) -> Option<&Cell> {
        self.at(self.row, self.case)
    }

    /// What the map shows, in words.
    #[must_use]
    pub fn title(&self) -> String {
        match self.view {
            View::Kernels if self.accel == 0 => "kernels alone".to_owned(),
            View::Kernels => {
                let accel = self.accels.get(self.accel).map_or("", String::as_str);
                format!("kernels in {accel}")
            }
            View::Accels => match self.kernels.get(self.kernel) {
                Some(kernel) => format!("accelerators with {kernel}"),
                None => "accelerators, the worst of all kernels".to_owned(),
            },
        }
    }

    /// How many cells of the whole suite have each verdict.
    #[must_use]
    pub fn counts(&self) -> Vec<(Verdict, usize)> {
        let found = || self.cells.iter().flatten();
        let count = |verdict| found().filter(|cell| cell.verdict == verdict).count();
        Verdict::ALL
            .map(|verdict| (verdict, count(verdict)))
            .to_vec()
    }

    /// Moves the mark by rows and cases; whether it moved.
    pub fn step(&mut self, rows: isize, cases: isize) -> bool {
        let before = (self.row, self.case);
        let moved = |at: usize, by: isize, len: usize| {
            let last = len.saturating_sub(1);
            at.min(last).saturating_add_signed(by).min(last)
        };
        self.row = moved(self.row, rows, self.rows().len());
        self.case = moved(self.case, cases, self.cases.len());
        (self.row, self.case) != before
    }

    /// Marks the next cell that is not ok, row by row, around the ends; whether there is one.
    pub fn seek(&mut self, steps: isize) -> bool {
        let (rows, cases) = (self.rows().len(), self.cases.len());
        let all = (rows * cases) as isize;
        let from = (self.row * cases + self.case) as isize;
        let around = (1..=all).map(|i| (from + i * steps.signum()).rem_euclid(all) as usize);
        let found = around.into_iter().find(|i| {
            let cell = self.at(i / cases, i % cases);
            cell.is_some_and(|cell| cell.verdict != Verdict::Ok)
        });
        if let Some(i) = found {
            (self.row, self.case) = (i / cases, i % cases);
        }
        found.is_some()
    }

    /// The other map.
    pub fn turn(&mut self) {
        self.view = match self.view {
            View::Kernels => View::Accels,
            View::Accels => View::Kernels,
        };
        self.row = self.row.min(self.rows().len().saturating_sub(1));
    }

    /// Another accelerator for the kernels, and that map.
    pub fn step_accel(&mut self, steps: isize) {
        if self.view == View::Accels {
            return self.turn();
        }
        let len = self.accels.len().max(1) as isize;
        self.accel = (self.accel as isize + steps).rem_euclid(len) as usize;
    }

    /// Another kernel for the accelerators, and that map; after the last whichever does worst.
    pub fn step_kernel(&mut self) {
        if self.view == View::Kernels {
            return self.turn();
        }
        self.kernel = (self.kernel + 1) % (self.kernels.len() + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::fixture;

    #[test]
    fn cells_come_in_any_order_and_are_found_by_row_and_case() {
        let map = fixture::tried().stability;
        let mut seen = 0;
        for row in 0..map.rows().len() {
            for case in 0..map.cases.len() {
                let cell = map.at(row, case).unwrap();
                assert_eq!(
                    (&cell.kernel, cell.case),
                    (&map.rows()[row], map.cases[case])
                );
                assert_eq!(cell.accel, "brute");
                seen += 1;
            }
        }
        assert_eq!(seen, map.kernels.len() * map.cases.len());
    }

    #[test]
    fn seeking_goes_round_all_cells_that_are_not_ok() {
        let mut map = fixture::tried().stability;
        assert!(map.seek(1));
        let first = (map.row, map.case);
        let failing = (0..map.rows().len())
            .flat_map(|row| (0..map.cases.len()).map(move |case| (row, case)))
            .filter(|&(row, case)| map.at(row, case).unwrap().verdict != Verdict::Ok)
            .count();
        for _ in 0..failing {
            assert_ne!(map.marked().unwrap().verdict, Verdict::Ok);
            map.seek(1);
        }
        assert_eq!((map.row, map.case), first);
        assert!(map.seek(-1) && map.seek(1));
        assert_eq!((map.row, map.case), first);
    }

    #[test]
    fn accelerators_are_shown_with_the_kernel_that_does_worst_or_with_one() {
        let mut map = fixture::tried().stability;
        map.step_kernel();
        assert_eq!(map.view, View::Accels);
        assert!(map.title().contains("worst"));
        let worst = map.at(0, 0).unwrap().verdict;
        for _ in 0..map.kernels.len() {
            map.step_kernel();
            assert!(map.at(0, 0).is_none_or(|cell| cell.verdict <= worst));
        }
    }

    #[test]
    fn a_display_that_is_held_still_catches_up_later() {
        let mut map = fixture::tried().stability;
        let before = map.clone();
        let mut cell = map.marked().unwrap().clone();
        cell.verdict = Verdict::Refused;
        let event = StabilityEvent::Cell {
            cell: Box::new(cell),
            done: 1,
            all: 2,
        };
        map.take(event, true);
        assert_eq!(map.counts(), before.counts());
        map.catch_up();
        assert_eq!(map.marked().unwrap().verdict, Verdict::Refused);
    }
}
