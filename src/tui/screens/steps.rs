//! The steps of a ray as a list: cells or nodes with entry and exit t, what was tested there, the nearest hit so far; under
//! the marked step each triangle that it offered.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::text::Line;

use super::slice::nearest_so_far;
use crate::accel::{Outcome, Test};
use crate::lab::{Inspection, Step};
use crate::tui::figures::fine;
use crate::tui::inspect::Inspect;
use crate::tui::overlay::Facts;
use crate::tui::theme::{Role, Theme};
use crate::tui::view::clipped;

/// Columns from which a row has words instead of letters.
const WIDE: usize = 66;

/// Draws the list of one side.
pub fn draw(theme: Theme, inspect: &Inspect, side: usize, frame: &mut Frame, area: Rect) {
    let Some(examined) = inspect.examined(side) else {
        return;
    };
    let inspection = &examined.inspection;
    let width = area.width as usize;
    let steps = &inspection.steps;
    if steps.is_empty() {
        let text = " The ray enters nothing: no step, no test.";
        frame.render_widget(
            Line::styled(clipped(text, width), theme.style(Role::Quiet)),
            area,
        );
        return;
    }
    let marked = inspect.marked[side].min(steps.len() - 1);
    let rows = window(
        inspection,
        marked,
        area.height as usize,
        side == inspect.focus,
    );
    for (y, row) in rows.into_iter().enumerate() {
        let (text, role) = match row {
            Row::Step(at) => {
                let role = if at == marked {
                    Role::Marked
                } else {
                    Role::Text
                };
                (step_row(inspection, at, at == marked, width), role)
            }
            Row::Test(test) => {
                let role = match test.outcome {
                    Outcome::Nearest => Role::Good,
                    Outcome::Hit => Role::Text,
                    Outcome::Miss | Outcome::Skipped => Role::Quiet,
                };
                (test_row(&test), role)
            }
            Row::More(count) => {
                let text = format!("        and {count} more: Enter shows them");
                (text, Role::Quiet)
            }
        };
        let line = Line::styled(clipped(&text, width), theme.style(role));
        frame.render_widget(line, Rect::new(area.x, area.y + y as u16, area.width, 1));
    }
}

enum Row {
    Step(usize),
    Test(Test),
    More(usize),
}

/// The rows that fit: the marked step near the middle, its tests below it where the side has the keys.
fn window(inspection: &Inspection, marked: usize, room: usize, focused: bool) -> Vec<Row> {
    let steps = &inspection.steps;
    let tests = &steps[marked].tests;
    // At least a third of the rows stays for the steps around.
    let most = if focused { room * 2 / 3 } else { 0 };
    let shown = if tests.len() <= most {
        tests.len()
    } else {
        most.saturating_sub(1)
    };
    let mut below: Vec<Row> = tests[..shown].iter().copied().map(Row::Test).collect();
    if focused && shown < tests.len() && most > 0 {
        below.push(Row::More(tests.len() - shown));
    }
    let around = room.saturating_sub(below.len() + 1);
    let after = steps.len() - marked - 1;
    let before = marked.min((around / 2).max(around.saturating_sub(after)));
    let mut rows: Vec<Row> = (marked - before..=marked).map(Row::Step).collect();
    rows.append(&mut below);
    let rest = room.saturating_sub(rows.len());
    rows.extend((marked + 1..steps.len()).take(rest).map(Row::Step));
    rows
}

/// Tests and skips of a step.
fn work(step: &Step) -> (usize, usize) {
    let skipped = step
        .tests
        .iter()
        .filter(|t| t.outcome == Outcome::Skipped)
        .count();
    (step.tests.len() - skipped, skipped)
}

fn step_row(inspection: &Inspection, at: usize, marked: bool, width: usize) -> String {
    let steps = &inspection.steps;
    let step = &steps[at];
    let mark = if marked { "▸" } else { " " };
    let digits = steps.len().to_string().len();
    let span = span(inspection);
    let (tests, skipped) = work(step);
    let (entry, exit) = (fine(step.entry, span), fine(step.exit, span));
    let number = at + 1;
    let kind = step.kind.name();
    let nearest = nearest_so_far(steps, at);
    if width < WIDE {
        let mut text = format!(
            "{mark}{number:>digits$} {kind} {} {entry}..{exit}",
            step.place
        );
        if tests > 0 {
            text = format!("{text} {tests}t");
        }
        if skipped > 0 {
            text = format!("{text} {skipped}s");
        }
        // A nearest hit is told where it is found.
        let own = step.tests.iter().any(|t| t.outcome == Outcome::Nearest);
        return match nearest.filter(|_| own) {
            Some((_, t)) => format!("{text} ●{}", fine(f64::from(t), span)),
            None => text,
        };
    }
    let place = step.place.to_string();
    let range = format!("{entry} .. {exit}");
    let nearest = nearest.map_or(String::new(), |(prim, t)| {
        format!("● {} #{prim}", fine(f64::from(t), span))
    });
    let skipped = match skipped {
        0 => String::new(),
        count => format!("{count} skip"),
    };
    let tested = match (tests, step.references) {
        (0, 0) => String::new(),
        (tests, references) => format!("{tests} of {references} tested"),
    };
    format!(
        "{mark}{number:>digits$} {kind:<4} {place:>7}  {range:<19} {tested:<13} {skipped:<7} {nearest}"
    )
}

/// How wide the range is in which the steps lie, for the digits of their t.
fn span(inspection: &Inspection) -> f64 {
    let ends = inspection.steps.iter().flat_map(|s| [s.entry, s.exit]);
    let finite = ends.filter(|t| t.is_finite() && t.abs() < f64::from(f32::MAX));
    let (lo, hi) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), t| {
        (lo.min(t), hi.max(t))
    });
    hi - lo
}

fn test_row(test: &Test) -> String {
    let outcome = match test.outcome {
        Outcome::Skipped => "skipped: tested before".to_owned(),
        other => other.name().to_owned(),
    };
    let t = test.t.map_or(String::new(), |t| format!(" at t = {t}"));
    let sign = if test.outcome == Outcome::Nearest {
        "●"
    } else {
        " "
    };
    format!("      {sign} triangle {} {outcome}{t}", test.prim)
}

/// Work, answer and whether it is right, in one line.
#[must_use]
pub fn summary(inspection: &Inspection) -> String {
    let (tests, skipped) = inspection
        .steps
        .iter()
        .map(work)
        .fold((0, 0), |(a, b), (c, d)| (a + c, b + d));
    let skips = if skipped > 0 {
        format!(", {skipped} skipped")
    } else {
        String::new()
    };
    let answer = match &inspection.hit {
        Some(hit) => format!("triangle {} at t = {}", hit.prim, hit.t),
        None => "a miss".to_owned(),
    };
    let steps = inspection.steps.len();
    format!(
        "{} · {steps} steps, {tests} tests{skips} · {answer}",
        verdict(inspection)
    )
}

/// Whether the answer is right.
fn verdict(inspection: &Inspection) -> String {
    let truth = &inspection.truth;
    match (inspection.right, truth.t, truth.prims.first()) {
        (true, ..) => "RIGHT".to_owned(),
        (false, Some(t), Some(prim)) => format!("WRONG, truth: triangle {prim} at t = {t:.6}"),
        (false, ..) => "WRONG, truth: a miss".to_owned(),
    }
}

/// Everything known of the marked step, for the box of details.
#[must_use]
pub fn facts(inspect: &Inspect) -> Option<Facts> {
    let inspection = &inspect.examined(inspect.focus)?.inspection;
    let at = inspect.marked[inspect.focus];
    let step = inspection.steps.get(at)?;
    let mut facts = Facts::new(format!("step {} of {}", at + 1, inspection.steps.len()));
    let n = inspection.n.map_or(String::new(), |n| format!(" n={n}"));
    facts.put("accelerator", format!("{}{n}", inspection.accel));
    facts.put(step.kind.name(), step.place.to_string());
    facts.put("entry t", step.entry.to_string());
    facts.put("exit t", step.exit.to_string());
    if let Some([min, max]) = step.bounds {
        facts.put("least corner", point(min));
        facts.put("greatest corner", point(max));
    }
    facts.put("references", step.references.to_string());
    for test in &step.tests {
        let t = test.t.map_or(String::new(), |t| format!(", t = {t}"));
        facts.put(test.outcome.name(), format!("triangle {}{t}", test.prim));
    }
    if let Some((prim, t)) = nearest_so_far(&inspection.steps, at) {
        facts.put("nearest so far", format!("triangle {prim}, t = {t}"));
    }
    Some(facts)
}

/// A point or direction, each number in full.
#[must_use]
pub fn point(p: [f32; 3]) -> String {
    let text = p.map(|x| {
        if x == 0.0 || (1e-4..1e7).contains(&x.abs()) {
            x.to_string()
        } else {
            format!("{x:e}")
        }
    });
    format!("({})", text.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::fixture;

    #[test]
    fn the_marked_step_and_its_tests_are_always_within_the_window() {
        let inspect = fixture::inspected().inspect;
        let inspection = &inspect.examined(1).unwrap().inspection;
        for room in [1, 2, 5, 9, 40] {
            for marked in 0..inspection.steps.len() {
                let rows = window(inspection, marked, room, true);
                assert!(rows.len() <= room);
                let is = |row: &Row| matches!(row, Row::Step(at) if *at == marked);
                assert_eq!(rows.iter().filter(|row| is(row)).count(), 1);
                let all = rows.len() == room || rows.len() >= inspection.steps.len();
                assert!(all, "{marked} of {} in {room}", inspection.steps.len());
            }
        }
    }

    #[test]
    fn a_row_tells_place_interval_tests_and_the_nearest_hit_so_far() {
        let inspect = fixture::inspected().inspect;
        let inspection = &inspect.examined(1).unwrap().inspection;
        let hit = inspection.hit.unwrap();
        let rows: Vec<String> = (0..inspection.steps.len())
            .map(|at| step_row(inspection, at, false, 90))
            .collect();
        assert!(rows[0].contains("cell") && rows[0].contains(".."));
        assert!(rows.last().unwrap().contains(&format!("#{}", hit.prim)));
        assert!(rows.iter().any(|row| row.contains("tested")));
        assert!(summary(inspection).starts_with("RIGHT"));
    }

    #[test]
    fn a_wrong_answer_says_so_and_names_the_truth() {
        let mut inspection = fixture::inspected()
            .inspect
            .examined(0)
            .unwrap()
            .inspection
            .clone();
        inspection.right = false;
        inspection.hit = None;
        let text = summary(&inspection);
        assert!(text.starts_with("WRONG, truth: triangle"), "{text}");
    }

    #[test]
    fn the_details_of_a_step_tell_every_test_in_full() {
        let mut inspect = fixture::inspected().inspect;
        inspect.focus = 1;
        inspect.step(isize::MAX / 2);
        let facts = facts(&inspect).unwrap();
        let step = inspect
            .examined(1)
            .unwrap()
            .inspection
            .steps
            .last()
            .unwrap();
        let told = facts
            .rows
            .iter()
            .filter(|(_, value)| value.starts_with("triangle"));
        assert_eq!(told.count(), step.tests.len() + 1);
        assert!(
            facts
                .rows
                .iter()
                .any(|(name, value)| name == "entry t" && *value == step.entry.to_string())
        );
    }
}
