//! Everything the screen depends on. Views read it, [`update`](super::update::update) changes it, and nothing else does.

use std::path::PathBuf;

pub use super::experiment::{Experiment, Kept, Phase, Sweep};
pub use super::screen::Screen;
pub use super::shelved::{BundleRow, Opened, Reports};

use super::inspect::Inspect;
use super::keymap::{Place, Situation};
use super::overlay::Overlay;
use super::pareto::Pareto;
use super::picture::{Picture, Wish};
use super::plan_editor::PlanEditor;
use super::runs::Runs;
use super::stability::Stability;
use super::table_view::TableView;
use super::theme::Theme;
use crate::lab::{self, Plan};
use crate::preview::ColorMode;
use crate::report::Run;
use crate::report::series::Quantity;

/// Which panel of the sweep screen has the keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Panel {
    /// The plan.
    Plan,
    /// The table of runs.
    Runs,
}

/// Where charts take their runs from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// The sweep of this session.
    Live,
    /// The opened report.
    Opened,
}

/// A line of the charts screen that can be changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChartLine {
    /// What is charted.
    Quantity,
    /// Which scene, kernel, rays and threads.
    Panel,
    /// Sweep or report.
    Source,
}

impl ChartLine {
    /// From top to bottom.
    pub const ALL: [Self; 3] = [Self::Quantity, Self::Panel, Self::Source];
}

/// The charts screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Charts {
    /// What is charted large.
    pub quantity: Quantity,
    /// Which of the panels.
    pub panel: usize,
    /// Where the runs come from.
    pub source: Source,
    /// The marked line.
    pub marked: ChartLine,
}

/// A sentence above the footer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Notice {
    /// What happened.
    pub text: String,
    /// Whether it is bad news.
    pub bad: bool,
}

/// The state of the TUI.
#[derive(Debug, Clone)]
pub struct State {
    /// The screen that is shown.
    pub screen: Screen,
    /// The screen that was shown before help.
    pub before_help: Screen,
    /// The screen from which the inspector was opened.
    pub before_inspect: Screen,
    /// Columns and rows of the terminal.
    pub size: (u16, u16),
    /// Seconds since the start.
    pub clock: f64,
    /// Colours.
    pub theme: Theme,
    /// The plan.
    pub plan: PlanEditor,
    /// The sweep.
    pub sweep: Sweep,
    /// Which panel of the sweep screen has the keys.
    pub panel: Panel,
    /// How the table of runs is looked at.
    pub table: TableView,
    /// Whether the focused panel has the whole screen.
    pub expanded: bool,
    /// Whether the display is held still.
    pub frozen: bool,
    /// What the sweep told meanwhile.
    pub held: Vec<lab::Event>,
    /// What lies over the screen, topmost last.
    pub overlays: Vec<Overlay>,
    /// The picture.
    pub picture: Picture,
    /// The inspect screen.
    pub inspect: Inspect,
    /// The charts screen.
    pub charts: Charts,
    /// The Pareto screen.
    pub pareto: Pareto,
    /// The stability screen.
    pub stability: Stability,
    /// The reports screen.
    pub reports: Reports,
    /// First line of help that is shown.
    pub help_line: usize,
    /// A sentence above the footer.
    pub notice: Option<Notice>,
    /// Where bundles are written.
    pub results: PathBuf,
    /// Whether the program is to end.
    pub quitting: bool,
}

impl State {
    /// The state at the start: the plan ready to run, the picture of its first scene wished for.
    #[must_use]
    pub fn new(plan: &Plan, results: PathBuf, colors: ColorMode, size: (u16, u16)) -> Self {
        Self {
            screen: Screen::Sweep,
            before_help: Screen::Sweep,
            before_inspect: Screen::Preview,
            size,
            clock: 0.0,
            theme: Theme::new(colors),
            picture: Picture::new(Wish::first(plan)),
            plan: PlanEditor::new(plan),
            sweep: Sweep::idle(),
            panel: Panel::Plan,
            table: TableView::default(),
            expanded: false,
            frozen: false,
            held: Vec::new(),
            overlays: Vec::new(),
            inspect: Inspect::new(),
            charts: Charts {
                quantity: Quantity::Speed,
                panel: 0,
                source: Source::Live,
                marked: ChartLine::Quantity,
            },
            pareto: Pareto::new(plan),
            stability: Stability::new(plan),
            reports: Reports::default(),
            help_line: 0,
            notice: None,
            results,
            quitting: false,
        }
    }

    /// Where the next key goes.
    #[must_use]
    pub fn place(&self) -> Place {
        if let Some(overlay) = self.overlays.last() {
            return overlay.place();
        }
        match (self.screen, self.panel) {
            (Screen::Sweep, Panel::Plan) => Place::Plan,
            (Screen::Sweep, Panel::Runs) => Place::Runs,
            (Screen::Preview, _) if self.picture.cursor.is_some() => Place::Aim,
            (Screen::Preview, _) => Place::Preview,
            (Screen::Inspect, _) => Place::Inspect,
            (Screen::Charts, _) => Place::Charts,
            (Screen::Pareto, _)
                if self.pareto.opened.is_some() && self.picture.cursor.is_some() =>
            {
                Place::Aim
            }
            (Screen::Pareto, _) if self.pareto.opened.is_some() => Place::Configuration,
            (Screen::Pareto, _) if self.pareto.panel == Panel::Plan => Place::OtherPlan,
            (Screen::Pareto, _) => Place::Points,
            (Screen::Stability, _) if self.stability.panel == Panel::Plan => Place::OtherPlan,
            (Screen::Stability, _) => Place::Map,
            (Screen::Reports, _) => Place::Reports,
            (Screen::Help, _) => Place::Help,
        }
    }

    /// What hints depend on.
    #[must_use]
    pub fn situation(&self) -> Situation {
        Situation {
            running: self.running().is_some(),
            measured: match self.screen {
                Screen::Pareto => !self.judged().is_empty(),
                Screen::Stability => self.stability.has_cells(),
                _ => !self.sweep.runs.rows.is_empty(),
            },
        }
    }

    /// What is measured now; `None` where nothing is.
    #[must_use]
    pub fn running(&self) -> Option<Experiment> {
        if self.sweep.is_running() {
            Some(Experiment::Sweep)
        } else if self.pareto.progress.is_running() {
            Some(Experiment::Accuracy)
        } else if self.stability.progress.is_running() {
            Some(Experiment::Stability)
        } else {
            None
        }
    }

    /// Where what is measured now stands.
    pub fn phase_mut(&mut self) -> Option<&mut Phase> {
        Some(match self.running()? {
            Experiment::Sweep => &mut self.sweep.phase,
            Experiment::Accuracy => &mut self.pareto.progress.phase,
            Experiment::Stability => &mut self.stability.progress.phase,
        })
    }

    /// The plan of the screen that is shown.
    #[must_use]
    pub fn editor(&self) -> &PlanEditor {
        match self.screen {
            Screen::Pareto => &self.pareto.plan,
            Screen::Stability => &self.stability.plan,
            _ => &self.plan,
        }
    }

    /// The plan of the screen that is shown.
    pub fn editor_mut(&mut self) -> &mut PlanEditor {
        match self.screen {
            Screen::Pareto => &mut self.pareto.plan,
            Screen::Stability => &mut self.stability.plan,
            _ => &mut self.plan,
        }
    }

    /// The judged runs that the Pareto screen shows, among others.
    #[must_use]
    pub fn judged(&self) -> &[Run] {
        match (&self.pareto.source, &self.reports.opened) {
            (Source::Opened, Some(opened)) => &opened.report.runs,
            _ => &self.pareto.runs,
        }
    }

    /// The plan by which these were judged.
    #[must_use]
    pub fn judged_by(&self) -> Option<&Plan> {
        match (&self.pareto.source, &self.reports.opened) {
            (Source::Opened, Some(opened)) => Some(&opened.report.config),
            _ => self.pareto.ran.as_ref().map(|plan| &plan.plan),
        }
    }

    /// What becomes of what an experiment measures; `None` where it keeps nothing.
    pub fn kept_mut(&mut self, experiment: Experiment) -> Option<&mut Kept> {
        match experiment {
            Experiment::Sweep => Some(&mut self.sweep.kept),
            Experiment::Accuracy => Some(&mut self.pareto.kept),
            Experiment::Stability => None,
        }
    }

    /// The runs that charts show.
    #[must_use]
    pub fn charted(&self) -> &Runs {
        match (&self.charts.source, &self.reports.opened) {
            (Source::Opened, Some(opened)) => &opened.runs,
            _ => &self.sweep.runs,
        }
    }

    /// Puts a sentence above the footer.
    pub fn say(&mut self, text: impl Into<String>) {
        self.notice = Some(Notice {
            text: text.into(),
            bad: false,
        });
    }

    /// Puts bad news above the footer.
    pub fn warn(&mut self, text: impl Into<String>) {
        self.notice = Some(Notice {
            text: text.into(),
            bad: true,
        });
    }
}
