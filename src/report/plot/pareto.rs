//! Speed against accuracy: one point a method, the front of those that no other beats in both.
//!
//! ```text
//!   share of rays decided wrongly
//!     |                  o sheet        o dominated: grey
//!     |         ┌────────● fast but wrong
//!     |- - - - -│- - - - - - - - - - -  3/N: what none seen can still be
//!    0|    o    ● right                 whiskers: up to the 95 % bound
//!     +------------------------- Mrays/s
//! ```

use crate::lab::Place;
use crate::report::Report;
use crate::report::judged::{Course, Judged, labels, points};

use super::axis::{Axis, Base, measured, number};
use super::canvas::{Anchor, At, Canvas, Face, Head, finish};
use super::figure::{MARGIN, Style, TITLE, WIDTH, file_name, label_face, quiet_face};
use super::font::{self, Weight};
use super::note;
use super::plane::{Plane, Rows, widest_tick};
use super::theme::{Look, Theme};

/// Least height of the area between the axes.
const TALL: f64 = 360.0;
/// Title, subtitle and the name of the vertical axis.
const TOP: f64 = 84.0;
/// How near a line a label may come.
const LINE: f64 = 1.5;
/// Ticks and the name of the horizontal axis.
const BELOW: f64 = 44.0;

/// The chart of one course at one place as SVG; `None` where nothing was judged there.
///
/// # Errors
/// What could not be drawn.
pub(super) fn svg(
    report: &Report,
    course: &Course,
    place: Place,
    style: Style,
) -> Result<Option<String>, String> {
    let points = points(&report.runs, course, place);
    if points.is_empty() {
        return Ok(None);
    }
    let theme = style.theme;
    let note = font::wrap(
        &small_print(report, &points),
        note::SMALL,
        WIDTH - 2.0 * MARGIN,
    );
    // Labels stand over each other at worst.
    let tall = TALL.max(points.len() as f64 * 15.0 + 60.0);
    let foot = TOP + tall + BELOW + 10.0;
    let height = (foot + note.len() as f64 * note::PITCH + 6.0).ceil();
    let mut drawn = String::new();
    let mut canvas = Canvas::new(&mut drawn, WIDTH, height, theme.ground);
    let name = heading(&mut canvas, theme, report, course, &whereabouts(place));
    axis_name(
        &mut canvas,
        theme,
        "Wrong decisions (share of rays)",
        TOP - 18.0,
    );
    let plane = plane(&points, tall, theme);
    plane.draw(&mut canvas, theme, Rows::Labelled);
    let middle = f64::midpoint(plane.left, plane.right);
    let at = (middle, TOP + tall + 36.0);
    canvas.text("speed (Mrays/s)", at, Anchor::Middle, label_face(theme));
    let mut taken = floor(&mut canvas, theme, &plane, &points);
    taken.extend(front(&mut canvas, theme, &plane, &points));
    let known = labels(&report.runs);
    draw_points(&mut canvas, theme, &plane, &points, &known);
    taken.extend(points.iter().flat_map(|p| signs(&plane, p)));
    draw_labels(&mut canvas, theme, &plane, &points, taken);
    note::draw(&mut canvas, theme, &note, foot);
    let widths = canvas.end()?;
    let head = Head {
        width: WIDTH,
        height,
        title: &format!("{name}: speed against accuracy"),
        adapts: style.adapts,
    };
    Ok(Some(finish(&drawn, &widths, &head)))
}

/// Where a scene was judged, as a subtitle goes on.
fn whereabouts(place: Place) -> String {
    let scaled = match place.scale {
        1.0 => String::new(),
        scale => format!(", scaled by {}", number(scale)),
    };
    match (place.offset, scaled.as_str()) {
        (0.0, "") => ", in its place".to_owned(),
        (0.0, scaled) => scaled.to_owned(),
        (offset, scaled) => format!("{scaled}, moved by {} along each axis", number(offset)),
    }
}

/// Title and subtitle of a chart of judged runs; returns the title.
pub(super) fn heading(
    canvas: &mut Canvas,
    theme: &Theme,
    report: &Report,
    course: &Course,
    further: &str,
) -> String {
    let face = Face {
        size: TITLE,
        weight: Weight::Bold,
        colour: theme.ink,
    };
    let plural = if course.threads == 1 { "" } else { "s" };
    let rays = match course.rays.strip_prefix("file:") {
        Some(path) => format!("rays of {}", file_name(path)),
        None => format!("{} rays", course.rays),
    };
    let name = format!(
        "{} · {rays} · {} thread{plural}",
        file_name(&course.scene),
        course.threads
    );
    let room = WIDTH - 2.0 * MARGIN;
    let line = font::fit(&name, face.size, face.weight, room);
    canvas.text(&line, (MARGIN, 26.0), Anchor::Start, face);
    let run = report.runs.iter().find(|r| Course::of(r) == *course);
    let facts = run.map_or_else(String::new, |r| {
        let (triangles, rays) = (r.triangles as f64, r.ray_count as f64);
        format!("{} triangles, {} rays", number(triangles), number(rays))
    });
    let quiet = Face {
        colour: theme.muted,
        ..label_face(theme)
    };
    canvas.text(
        &format!("{facts}{further}"),
        (MARGIN, 44.0),
        Anchor::Start,
        quiet,
    );
    name
}

/// What a vertical axis shows, base line at `y`; less is always better.
pub(super) fn axis_name(canvas: &mut Canvas, theme: &Theme, name: &str, y: f64) {
    let face = Face {
        size: 12.0,
        weight: Weight::Bold,
        colour: theme.ink,
    };
    canvas.text(name, (MARGIN, y), Anchor::Start, face);
    let after = MARGIN + face.width(name) + 8.0;
    canvas.text(
        "lower is better",
        (after, y),
        Anchor::Start,
        quiet_face(theme),
    );
}

/// The rate that cannot be told from none: three of the fewest rays of a point.
fn three_of(points: &[Judged]) -> f64 {
    let rays = points.iter().map(|p| p.accuracy.rays).min().unwrap_or(1);
    (3.0 / rays.max(1) as f64).min(1.0)
}

fn plane(points: &[Judged], tall: f64, theme: &Theme) -> Plane {
    let rates = points
        .iter()
        .flat_map(|p| [p.accuracy.wrong_rate(), p.bound])
        .chain([three_of(points)]);
    let y = Axis::new(rates, Base::Ten, tall, 24.0);
    let left = MARGIN + widest_tick(&y, theme) + 10.0;
    let right = WIDTH - MARGIN - 8.0;
    let speeds = points.iter().flat_map(|p| p.speed);
    let x = Axis::new(speeds, Base::Ten, right - left, 48.0);
    Plane::new(x, y, (left, TOP), (right, TOP + tall))
}

fn place(plane: &Plane, point: &Judged) -> At {
    plane.at(point.speed[0], point.accuracy.wrong_rate())
}

/// The line of three by N with its words; returns the places that both take.
fn floor(canvas: &mut Canvas, theme: &Theme, plane: &Plane, points: &[Judged]) -> Vec<Box2> {
    let rate = three_of(points);
    let y = plane.at(plane.x.lo, rate).1;
    canvas.line(
        &[(plane.left, y), (plane.right, y)],
        theme.muted,
        1.0,
        &[5.0, 4.0],
    );
    let face = quiet_face(theme);
    let text = format!("3/N = {}: none seen is at most this", measured(rate));
    let at = (plane.right - 6.0, y - 5.0);
    canvas.text(&text, at, Anchor::End, face);
    let words = Box2 {
        left: at.0 - face.width(&text),
        right: at.0,
        top: at.1 - face.size,
        bottom: at.1 + 8.0,
    };
    vec![words, Box2::along((plane.left, y), (plane.right, y))]
}

/// The stairs of the front: what the fastest method within each rate of wrong decisions is; returns the places that
/// they take.
fn front(canvas: &mut Canvas, theme: &Theme, plane: &Plane, points: &[Judged]) -> Vec<Box2> {
    let mut stairs: Vec<At> = points
        .iter()
        .filter(|p| p.front)
        .map(|p| place(plane, p))
        .collect();
    stairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(first), Some(last)) = (stairs.first().copied(), stairs.last().copied()) else {
        return Vec::new();
    };
    let mut line = vec![(plane.left, first.1)];
    for (x, y) in stairs {
        if let Some(&(from, _)) = line.last()
            && line.len() > 1
        {
            line.push((from, y));
        }
        line.push((x, y));
    }
    line.push((last.0, plane.top));
    canvas.line(&line, theme.muted, 1.4, &[]);
    line.windows(2).map(|w| Box2::along(w[0], w[1])).collect()
}

fn draw_points(
    canvas: &mut Canvas,
    theme: &Theme,
    plane: &Plane,
    points: &[Judged],
    known: &[String],
) {
    // The front last, so that nothing hides it.
    for front in [false, true] {
        for point in points.iter().filter(|p| p.front == front) {
            let look = Look::of(known.iter().position(|l| *l == point.label).unwrap_or(0));
            let colour = if front {
                theme.lines[look.colour]
            } else {
                theme.axis
            };
            let at = place(plane, point);
            let [_, lo, hi] = point.speed.map(|speed| plane.at(speed, plane.y.hi).0);
            canvas.line(&[(lo, at.1), (hi, at.1)], colour, 1.2, &[]);
            let top = plane.at(plane.x.lo, point.bound).1;
            canvas.line(&[at, (at.0, top)], colour, 1.2, &[]);
            canvas.line(&[(at.0 - 3.0, top), (at.0 + 3.0, top)], colour, 1.2, &[]);
            canvas.marker(at, look.marker, colour, theme.ground);
        }
    }
}

/// What the sign of a point and its whiskers take.
fn signs(plane: &Plane, point: &Judged) -> [Box2; 3] {
    let at = place(plane, point);
    let [_, lo, hi] = point.speed.map(|speed| plane.at(speed, plane.y.hi).0);
    let across = Box2 {
        left: lo,
        right: hi,
        ..Box2::around(at, 1.5)
    };
    let up = Box2 {
        top: plane.at(plane.x.lo, point.bound).1,
        ..Box2::around(at, 3.0)
    };
    [Box2::around(at, 6.0), across, up]
}

/// A rectangle of the sheet.
#[derive(Debug, Clone, Copy)]
struct Box2 {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Box2 {
    fn around((x, y): At, reach: f64) -> Self {
        Self {
            left: x - reach,
            right: x + reach,
            top: y - reach,
            bottom: y + reach,
        }
    }

    /// Around a horizontal or vertical line.
    fn along(a: At, b: At) -> Self {
        Self {
            left: a.0.min(b.0) - LINE,
            right: a.0.max(b.0) + LINE,
            top: a.1.min(b.1) - LINE,
            bottom: a.1.max(b.1) + LINE,
        }
    }

    fn meets(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }
}

/// Labels at the nearest free places beside their points, those of the front first; a leader where that is not near.
fn draw_labels(
    canvas: &mut Canvas,
    theme: &Theme,
    plane: &Plane,
    points: &[Judged],
    mut taken: Vec<Box2>,
) {
    let mut order: Vec<&Judged> = points.iter().collect();
    order.sort_by_key(|p| !p.front);
    for point in order {
        let face = Face {
            weight: if point.front {
                Weight::Bold
            } else {
                Weight::Regular
            },
            colour: if point.front { theme.ink } else { theme.muted },
            ..quiet_face(theme)
        };
        let room = plane.right - plane.left - 12.0;
        let text = font::fit(&point.label, face.size, face.weight, room);
        let at = place(plane, point);
        let width = face.width(&text);
        let Some(spot) = spot(plane, at, width, face.size, &taken) else {
            continue;
        };
        taken.push(spot);
        let near = (
            at.0.clamp(spot.left, spot.right),
            at.1.clamp(spot.top, spot.bottom),
        );
        if (near.0 - at.0).hypot(near.1 - at.1) > 12.0 {
            canvas.line(&[at, near], theme.axis, 0.7, &[]);
        }
        let base = (spot.left + 2.0, spot.bottom - 3.5);
        canvas.text(&text, base, Anchor::Start, face);
    }
}

/// The free place for a text that is nearest to `at`; `None` where the whole plane is full.
fn spot(plane: &Plane, at: At, width: f64, size: f64, taken: &[Box2]) -> Option<Box2> {
    let (w, h) = (width + 4.0, size + 4.5);
    let rows = ((plane.bottom - plane.top) / 7.0) as i32;
    let shifts = [7.0, -7.0 - w, -w / 2.0, 30.0, -30.0 - w, 80.0, -80.0 - w];
    let candidates = (-rows..=rows).flat_map(|row| {
        shifts.map(|shift| {
            let (left, top) = (at.0 + shift, at.1 - h / 2.0 + f64::from(row) * 7.0);
            let (left, top) = (
                left.clamp(plane.left + 3.0, (plane.right - w).max(plane.left + 3.0)),
                top.clamp(
                    plane.top + 1.0,
                    (plane.bottom - h - 1.0).max(plane.top + 1.0),
                ),
            );
            Box2 {
                left,
                right: left + w,
                top,
                bottom: top + h,
            }
        })
    });
    let distance = |b: &Box2| {
        let (x, y) = (at.0.clamp(b.left, b.right), at.1.clamp(b.top, b.bottom));
        (x - at.0).hypot(y - at.1)
    };
    candidates
        .filter(|b| !taken.iter().any(|t| t.meets(b)))
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

fn small_print(report: &Report, points: &[Judged]) -> String {
    let front = points.iter().filter(|p| p.front).count();
    let all = points.len();
    format!(
        "Wrong decisions: leaks, phantoms and wrong surfaces by exact arithmetic on the same f32 numbers; naming a neighbour \
         at the same point is none. Coloured, on the line: the {front} of {all} methods that no other beats in both; grey: \
         dominated. Vertical whiskers: up to the upper 95 % bound (Clopper-Pearson); horizontal: 95 % bootstrap interval \
         of the median speed. {}",
        note::machine(&report.provenance)
    )
}
