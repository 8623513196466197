//! What can lie over a screen: a list of choices, a text field, the details of a run, a question.

use super::keymap::Place;
use super::plan_editor::{Field, Offer, PlanEditor};
use super::text_input::TextInput;

/// What lies over a screen.
#[derive(Debug, Clone, PartialEq)]
pub enum Overlay {
    /// A list of choices for a line of the plan.
    Pick(Pick),
    /// A text being typed.
    Text(TextField),
    /// Everything known of something, and the first line shown.
    Details(Box<Facts>, usize),
    /// Whether to quit although a sweep runs or something is not saved; the reason.
    Quit(String),
}

impl Overlay {
    /// Where its keys are in the keymap.
    #[must_use]
    pub fn place(&self) -> Place {
        match self {
            Self::Pick(_) => Place::Pick,
            Self::Text(_) => Place::Text,
            Self::Details(..) => Place::Details,
            Self::Quit(_) => Place::Confirm,
        }
    }
}

/// What is known of something: names and values, in the order in which they are told.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Facts {
    /// What it is.
    pub title: String,
    /// Names and values.
    pub rows: Vec<(String, String)>,
}

impl Facts {
    /// Nothing known yet.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            rows: Vec::new(),
        }
    }

    /// Adds a fact.
    pub fn put(&mut self, name: &str, value: impl Into<String>) {
        self.rows.push((name.to_owned(), value.into()));
    }
}

/// What a text is typed for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// A line of the plan.
    Line(Field),
    /// The filter of the table of runs.
    RunsFilter,
    /// The filter of the list of bundles, or of the opened report's table.
    ReportsFilter,
    /// The filter of the list of choices below.
    PickFilter,
}

/// A text being typed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextField {
    /// What for.
    pub purpose: Purpose,
    /// The text.
    pub input: TextInput,
    /// What it was before, for Esc.
    pub before: String,
    /// Why it cannot be taken over as it stands.
    pub error: Option<String>,
}

impl TextField {
    /// A field that starts with `text`.
    #[must_use]
    pub fn new(purpose: Purpose, text: &str) -> Self {
        Self {
            purpose,
            input: TextInput::new(text),
            before: text.to_owned(),
            error: None,
        }
    }
}

/// A choice and whether it is taken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PickItem {
    /// As it is written.
    pub name: String,
    /// One sentence.
    pub about: String,
    /// Whether it is taken.
    pub taken: bool,
}

/// A list of choices.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pick {
    /// The line of the plan.
    pub field: Field,
    /// The choices: those of the registry, and before them what was typed beside them.
    pub items: Vec<PickItem>,
    /// The marked one among those shown.
    pub marked: usize,
    /// Only choices that contain this.
    pub filter: String,
}

impl Pick {
    /// The choices of a line, those it has now taken.
    #[must_use]
    pub fn new(plan: &PlanEditor, field: Field) -> Self {
        let taken = plan.items(field);
        let offers = field.offers();
        let typed = taken
            .iter()
            .filter(|item| !offers.iter().any(|(name, _)| name == *item))
            .map(|item| (item.clone(), "typed".to_owned()));
        let all: Vec<Offer> = typed.chain(offers.iter().cloned()).collect();
        Self {
            field,
            items: all
                .into_iter()
                .map(|(name, about)| PickItem {
                    taken: taken.contains(&name),
                    name,
                    about,
                })
                .collect(),
            marked: 0,
            filter: String::new(),
        }
        .at_first_taken()
    }

    /// Marks the first choice that is taken.
    fn at_first_taken(mut self) -> Self {
        self.marked = self.items.iter().position(|item| item.taken).unwrap_or(0);
        self
    }

    /// Indices of the choices that are shown.
    #[must_use]
    pub fn shown(&self) -> Vec<usize> {
        let filter = self.filter.to_lowercase();
        (0..self.items.len())
            .filter(|&i| {
                let item = &self.items[i];
                format!("{} {}", item.name, item.about)
                    .to_lowercase()
                    .contains(&filter)
            })
            .collect()
    }

    /// Moves the mark, staying within the choices shown.
    pub fn step(&mut self, lines: isize) {
        let last = self.shown().len().saturating_sub(1);
        self.marked = self.marked.min(last).saturating_add_signed(lines).min(last);
    }

    /// Takes or leaves the marked choice.
    pub fn toggle(&mut self) {
        let shown = self.shown();
        if let Some(&at) = shown.get(self.marked.min(shown.len().saturating_sub(1))) {
            self.items[at].taken = !self.items[at].taken;
        }
    }

    /// Takes all choices shown, or leaves them where all are taken.
    pub fn toggle_all(&mut self) {
        let shown = self.shown();
        let take = !shown.iter().all(|&at| self.items[at].taken);
        for at in shown {
            self.items[at].taken = take;
        }
    }

    /// The line that the choices make.
    #[must_use]
    pub fn text(&self) -> String {
        let taken: Vec<&str> = self
            .items
            .iter()
            .filter(|item| item.taken)
            .map(|item| item.name.as_str())
            .collect();
        taken.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::Plan;

    fn pick() -> Pick {
        let mut plan = PlanEditor::new(&Plan::default());
        plan.set(Field::Scenes, "soup:1000,0.5, teapot");
        Pick::new(&plan, Field::Scenes)
    }

    #[test]
    fn what_was_typed_stays_among_the_choices() {
        let pick = pick();
        assert_eq!(pick.items[0].name, "soup:1000,0.5");
        assert_eq!(pick.text(), "soup:1000,0.5, teapot");
    }

    #[test]
    fn toggling_and_filtering_act_on_what_is_shown() {
        let mut pick = pick();
        pick.toggle();
        assert_eq!(pick.text(), "teapot");
        pick.filter = "teapot".to_owned();
        pick.step(100);
        assert!(pick.marked < pick.shown().len());
        pick.toggle_all();
        pick.toggle_all();
        let shown = pick.shown();
        let all = shown.iter().all(|&i| pick.items[i].taken);
        let none = shown.iter().all(|&i| !pick.items[i].taken);
        assert!(all || none);
        pick.filter = "no scene is called this".to_owned();
        pick.step(1);
        pick.toggle();
        assert!(pick.shown().is_empty());
    }
}
