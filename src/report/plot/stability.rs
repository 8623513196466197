//! The stability map: a case a line, a method a column, a letter a cell; colour repeats what the letter says.
//!
//! ```text
//!                    ┌ woop
//!                    │ ┌ moller-trumbore            ┌ grid
//!                    │ │                            │ ┌ bvh
//!  edges             │ │                            │ │
//!    closed-edges    . k                            . .
//!    closed-faces    . .                            . .
//! ```

use plotters::style::RGBColor;

use crate::lab::stability::{CASES, Cell, Map, Verdict};

use super::canvas::{Anchor, At, Canvas, Face, Head, finish};
use super::figure::{MARGIN, Style, quiet_face};
use super::font::{self, Weight};
use super::note;
use super::theme::Theme;

/// Pixels from a column to the next, and from a line to the next.
const COLUMN: f64 = 17.0;
const LINE: f64 = 15.0;
/// From a name of a method to the next one below it.
const STAIR: f64 = 13.0;
/// Above the names of the methods: the title and the line below it.
const TOP: f64 = 62.0;
/// Between the names of the cases and the first column, and after the last.
const APART: f64 = 12.0;
/// From the middle of a column to the name above it.
const NAME: f64 = 8.0;

/// What one half of the map shows: kernels or accelerators.
struct Half<'a> {
    title: &'a str,
    methods: &'a [String],
    cell: fn(&'a Map, &str, &str) -> Option<&'a Cell>,
    left: f64,
}

impl Half<'_> {
    fn x(&self, column: usize) -> f64 {
        self.left + (column as f64 + 0.5) * COLUMN
    }

    /// Where its title and the names of its methods end, which lean to the right of their columns.
    fn right(&self, face: Face) -> f64 {
        let names = self.methods.iter().enumerate();
        names
            .map(|(i, method)| self.x(i) + NAME + face.width(method))
            .fold(self.left + bold(face).width(self.title), f64::max)
    }
}

/// The halves of the map, side by side; one where it has no accelerators.
fn halves(map: &Map, face: Face) -> Vec<Half<'_>> {
    let cases = map.cases.iter().map(|c| face.width(c)).fold(0.0, f64::max);
    let kernels = Half {
        title: "Kernels, by the oracle",
        methods: &map.kernels,
        cell: Map::kernel_cell,
        left: MARGIN + 10.0 + cases + APART,
    };
    let accels = Half {
        title: "Accelerators, by brute force",
        methods: &map.accels,
        cell: Map::accel_cell,
        left: kernels.right(face) + 2.0 * APART,
    };
    let mut halves = vec![kernels, accels];
    halves.retain(|half| !half.methods.is_empty());
    halves
}

fn bold(face: Face) -> Face {
    Face {
        weight: Weight::Bold,
        ..face
    }
}

/// A line of the map: the name of a group of cases, or a case.
enum Line<'a> {
    Group(&'a str),
    Case(&'a str),
}

/// The map as SVG.
///
/// # Errors
/// What could not be drawn.
pub(super) fn svg(map: &Map, style: Style) -> Result<String, String> {
    let theme = style.theme;
    let small = Face {
        size: 11.0,
        weight: Weight::Regular,
        colour: theme.ink,
    };
    let lines = lines(map);
    let halves = halves(map, small);
    let right = halves.iter().map(|h| h.right(small)).fold(0.0, f64::max);
    let width = (right + MARGIN).max(640.0).ceil();
    let stairs = halves.iter().map(|h| h.methods.len()).max().unwrap_or(0);
    let body = TOP + 20.0 + stairs as f64 * STAIR + 6.0;
    let foot = body + lines.len() as f64 * LINE + 10.0;
    let small_print = font::wrap(&small_print(map), note::SMALL, width - 2.0 * MARGIN);
    let height = (foot + 24.0 + small_print.len() as f64 * note::PITCH + 8.0).ceil();

    let mut drawn = String::new();
    let mut canvas = Canvas::new(&mut drawn, width, height, theme.ground);
    title(&mut canvas, theme, map);
    for half in &halves {
        draw_half(&mut canvas, theme, map, half, &lines, body, small);
    }
    draw_names(&mut canvas, theme, &lines, body, small);
    legend(&mut canvas, theme, foot + 12.0);
    note::draw(&mut canvas, theme, &small_print, foot + 24.0);
    let widths = canvas.end()?;
    let head = Head {
        width,
        height,
        title: "Stability map: cases by kernels and accelerators",
        adapts: style.adapts,
    };
    Ok(finish(&drawn, &widths, &head))
}

/// The cases of the map, each group below its name.
fn lines(map: &Map) -> Vec<Line<'_>> {
    let mut lines = Vec::new();
    let mut last = "";
    for name in &map.cases {
        let group = CASES
            .iter()
            .find(|c| c.name == *name)
            .map_or("", |c| c.group);
        if group != last {
            lines.push(Line::Group(group));
            last = group;
        }
        lines.push(Line::Case(name));
    }
    lines
}

fn title(canvas: &mut Canvas, theme: &Theme, map: &Map) {
    let bold = Face {
        size: 16.0,
        weight: Weight::Bold,
        colour: theme.ink,
    };
    canvas.text("Where methods break", (MARGIN, 30.0), Anchor::Start, bold);
    let rungs: u64 = map.cells.iter().map(|c| c.rungs.len() as u64).sum();
    let rays: u64 = map.cells.iter().map(Cell::rays).sum();
    let text = format!(
        "{} cases, {} cells, {rungs} scenes, {:.1} million rays judged",
        map.cases.len(),
        map.cells.len(),
        rays as f64 * 1e-6
    );
    canvas.text(&text, (MARGIN, 47.0), Anchor::Start, quiet_face(theme));
}

/// Names of methods as stairs with a line down to their columns, and the cells below them.
fn draw_half<'a>(
    canvas: &mut Canvas,
    theme: &Theme,
    map: &'a Map,
    half: &Half<'a>,
    lines: &[Line],
    body: f64,
    face: Face,
) {
    let title = (half.left, TOP + 10.0);
    canvas.text(half.title, title, Anchor::Start, bold(face));
    for (i, method) in half.methods.iter().enumerate() {
        let y = TOP + 20.0 + (i as f64 + 0.5) * STAIR;
        let x = half.x(i);
        canvas.line(
            &[(x + 5.0, y), (x, y), (x, body - 3.0)],
            theme.axis,
            0.8,
            &[],
        );
        canvas.text(method, (x + NAME, y + 3.5), Anchor::Start, face);
        for (row, line) in lines.iter().enumerate() {
            if let Line::Case(case) = line
                && let Some(cell) = (half.cell)(map, method, case)
            {
                let at = (x, body + row as f64 * LINE);
                draw_cell(canvas, theme, cell.verdict, at);
            }
        }
    }
}

/// The colour of a verdict and how strong it is, and that of the letter on it.
fn colours(theme: &Theme, verdict: Verdict) -> (RGBColor, f64, RGBColor) {
    let [blue, vermillion, _, _, orange, ..] = theme.lines;
    match verdict {
        Verdict::Ok => (theme.grid, 0.6, theme.muted),
        Verdict::Known => (orange, 0.55, theme.ink),
        Verdict::Gone => (blue, 0.5, theme.ink),
        Verdict::Fails => (vermillion, 1.0, theme.ground),
        Verdict::Refused => (theme.ground, 1.0, theme.muted),
    }
}

/// A cell whose upper middle is `at`.
fn draw_cell(canvas: &mut Canvas, theme: &Theme, verdict: Verdict, (x, y): At) {
    let (ground, strength, ink) = colours(theme, verdict);
    let half = COLUMN * 0.5 - 0.7;
    canvas.rectangle(
        (x - half, y + 0.7),
        (x + half, y + LINE - 0.7),
        ground,
        strength,
    );
    let face = Face {
        size: 10.5,
        weight: if verdict == Verdict::Ok {
            Weight::Regular
        } else {
            Weight::Bold
        },
        colour: ink,
    };
    let letter = verdict.letter().to_string();
    canvas.text(&letter, (x, y + 11.2), Anchor::Middle, face);
}

fn draw_names(canvas: &mut Canvas, theme: &Theme, lines: &[Line], body: f64, face: Face) {
    for (row, line) in lines.iter().enumerate() {
        let y = body + row as f64 * LINE + 11.2;
        match line {
            Line::Group(name) => {
                let bold = Face {
                    weight: Weight::Bold,
                    colour: theme.muted,
                    ..face
                };
                canvas.text(name, (MARGIN, y), Anchor::Start, bold);
            }
            Line::Case(name) => canvas.text(name, (MARGIN + 10.0, y), Anchor::Start, face),
        }
    }
}

/// What each letter means.
fn legend(canvas: &mut Canvas, theme: &Theme, y: f64) {
    let face = quiet_face(theme);
    let mut x = MARGIN + COLUMN * 0.5;
    for verdict in Verdict::ALL {
        draw_cell(canvas, theme, verdict, (x, y - 11.0));
        canvas.text(verdict.about(), (x + COLUMN * 0.7, y), Anchor::Start, face);
        x += COLUMN * 1.9 + face.width(verdict.about());
    }
}

fn small_print(map: &Map) -> String {
    let mut text = "A kernel is judged by exact arithmetic in brute force: leaks, phantoms, wrong surfaces, points off by \
                    more than 64 roundings. An accelerator is judged by brute force with the same kernel wherever that is \
                    right; its worst cell over all kernels is shown. Known failures are data with a bound, the first rung \
                    and a reason; see stability.json."
        .to_owned();
    if map.stopped {
        text.push_str(" Stopped before all cells were done.");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::plot::theme::LIGHT;

    fn map(kernels: usize, accels: usize) -> Map {
        let names = |count| (0..count).map(|i| format!("method-{i}")).collect();
        Map {
            seed: 1,
            cases: vec!["closed-edges"],
            kernels: names(kernels),
            accels: names(accels),
            cells: Vec::new(),
            stopped: false,
        }
    }

    #[test]
    fn titles_and_names_end_before_the_next_half_and_within_the_picture() {
        let small = Face {
            size: 11.0,
            weight: Weight::Regular,
            colour: LIGHT.ink,
        };
        for (kernels, accels) in [(1, 1), (1, 30), (30, 1), (12, 14), (60, 1)] {
            let map = map(kernels, accels);
            let halves = halves(&map, small);
            let ends = |half: &Half| {
                let title = half.left + bold(small).width(half.title);
                let names = half.methods.iter().enumerate();
                let names = names.map(|(i, name)| half.x(i) + NAME + small.width(name));
                names.fold(title, f64::max)
            };
            assert!(ends(&halves[0]) < halves[1].left, "{kernels} kernels");
            let style = Style {
                theme: &LIGHT,
                adapts: false,
            };
            let svg = svg(&map, style).unwrap();
            let width = svg
                .split("width=\"")
                .nth(1)
                .and_then(|rest| rest.split('"').next());
            let width: f64 = width.unwrap().parse().unwrap();
            assert!(ends(&halves[1]) < width, "{accels} accelerators");
        }
        assert_eq!(halves(&map(3, 0), small).len(), 1);
    }
}
