//! A sheet in pixels that plotters draws on and that becomes one SVG.
//!
//! plotters' coordinates are whole numbers, which is too coarse for curves: the sheet is drawn [`FINE`] times as large
//! and shrunk by the `viewBox`. Every text states its width, so a reader without our typeface sees the same layout.

use plotters::coord::Shift;
use plotters::element::{Circle, Drawable, PathElement, PointCollection, Polygon, Rectangle, Text};
use plotters::prelude::{DrawingArea, IntoDrawingArea, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, IntoFont, RGBColor, ShapeStyle, TextStyle};

use super::font::{self, FAMILY, Weight};
use super::theme::{self, Marker};

/// Drawn units a pixel.
const FINE: f64 = 8.0;
/// Where plotters puts the top of a text above its base line, in ems.
const TOP: f64 = 0.76;
/// plotters divides the sizes of fonts by this.
const PLOTTERS_EM: f64 = 1.24;

/// A place in pixels, x to the right and y down.
pub(super) type At = (f64, f64);

/// How a text stands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    /// Pixels an em.
    pub size: f64,
    pub weight: Weight,
    pub colour: RGBColor,
}

impl Face {
    pub fn width(self, text: &str) -> f64 {
        font::width(text, self.size, self.weight)
    }
}

/// Where a text is relative to its place, which lies on its base line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// The sheet.
pub(super) struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
    /// Widths of the texts so far, in drawn units.
    widths: Vec<f64>,
    failed: Option<String>,
}

/// `x` pixels in drawn units.
fn fine(x: f64) -> i32 {
    (x * FINE).round() as i32
}

fn place((x, y): At) -> (i32, i32) {
    (fine(x), fine(y))
}

/// A stroke's width in drawn units.
fn stroke(colour: RGBColor, width: f64) -> ShapeStyle {
    colour.stroke_width(fine(width).max(1) as u32)
}

impl<'a> Canvas<'a> {
    /// A sheet of `width` by `height` pixels that writes into `svg`.
    pub fn new(svg: &'a mut String, width: f64, height: f64, ground: RGBColor) -> Self {
        font::register();
        let size = (fine(width) as u32, fine(height) as u32);
        let mut canvas = Self {
            area: SVGBackend::with_string(svg, size).into_drawing_area(),
            widths: Vec::new(),
            failed: None,
        };
        canvas.rectangle((0.0, 0.0), (width, height), ground, 1.0);
        canvas
    }

    fn draw<E>(&mut self, element: &E)
    where
        for<'b> &'b E: PointCollection<'b, (i32, i32)>,
        E: Drawable<SVGBackend<'a>>,
    {
        if let Err(error) = self.area.draw(element) {
            self.failed.get_or_insert_with(|| error.to_string());
        }
    }

    /// A filled rectangle between two corners.
    pub fn rectangle(&mut self, from: At, to: At, colour: RGBColor, opacity: f64) {
        self.draw(&Rectangle::new(
            [place(from), place(to)],
            colour.mix(opacity).filled(),
        ));
    }

    /// A filled polygon.
    pub fn polygon(&mut self, points: &[At], colour: RGBColor, opacity: f64) {
        let points: Vec<_> = points.iter().copied().map(place).collect();
        self.draw(&Polygon::new(points, colour.mix(opacity)));
    }

    /// A line through `points`, broken into `dashes`; empty `dashes` leave it whole.
    pub fn line(&mut self, points: &[At], colour: RGBColor, width: f64, dashes: &[f64]) {
        for piece in dashed(points, dashes) {
            let piece: Vec<_> = piece.into_iter().map(place).collect();
            self.draw(&PathElement::new(piece, stroke(colour, width)));
        }
    }

    /// A disc.
    pub fn disc(&mut self, at: At, radius: f64, colour: RGBColor) {
        self.draw(&Circle::new(place(at), fine(radius), colour.filled()));
    }

    /// A ring.
    pub fn ring(&mut self, at: At, radius: f64, colour: RGBColor, width: f64) {
        self.draw(&Circle::new(place(at), fine(radius), stroke(colour, width)));
    }

    /// A line's sign at one of its points, on a halo of `ground` so that it stays legible over other lines.
    pub fn marker(&mut self, at: At, marker: Marker, colour: RGBColor, ground: RGBColor) {
        let (x, y) = at;
        let on =
            |points: &[At]| -> Vec<At> { points.iter().map(|(dx, dy)| (x + dx, y + dy)).collect() };
        // Sizes chosen so that all signs look equally heavy.
        let filled: &[At] = match marker {
            Marker::Circle | Marker::Ring => {
                self.disc(at, 4.0, ground);
                if marker == Marker::Ring {
                    self.ring(at, 2.6, colour, 1.4);
                } else {
                    self.disc(at, 3.0, colour);
                }
                return;
            }
            Marker::Cross | Marker::Plus => {
                self.disc(at, 4.0, ground);
                let (a, b) = if marker == Marker::Cross {
                    ([(-2.6, -2.6), (2.6, 2.6)], [(-2.6, 2.6), (2.6, -2.6)])
                } else {
                    ([(-3.4, 0.0), (3.4, 0.0)], [(0.0, -3.4), (0.0, 3.4)])
                };
                for arm in [a, b] {
                    self.line(&on(&arm), colour, 1.7, &[]);
                }
                return;
            }
            Marker::Square => &[(-2.7, -2.7), (2.7, -2.7), (2.7, 2.7), (-2.7, 2.7)],
            Marker::Up => &[(0.0, -3.6), (3.4, 2.5), (-3.4, 2.5)],
            Marker::Down => &[(0.0, 3.6), (3.4, -2.5), (-3.4, -2.5)],
            Marker::Diamond => &[(0.0, -3.9), (3.5, 0.0), (0.0, 3.9), (-3.5, 0.0)],
        };
        let outline: Vec<At> = filled.iter().map(|(x, y)| (x * 1.36, y * 1.36)).collect();
        self.polygon(&on(&outline), ground, 1.0);
        self.polygon(&on(filled), colour, 1.0);
    }

    /// `text` with its base line at `at`.
    pub fn text(&mut self, text: &str, at: At, anchor: Anchor, face: Face) {
        let clean = printable(text);
        if clean.is_empty() {
            return;
        }
        self.widths.push(face.width(&clean) * FINE);
        let style = match face.weight {
            Weight::Regular => FontStyle::Normal,
            Weight::Bold => FontStyle::Bold,
        };
        let h_pos = match anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        let font = (FAMILY, face.size * FINE * PLOTTERS_EM, style).into_font();
        let style = TextStyle::from(font)
            .color(&face.colour)
            .pos(Pos::new(h_pos, VPos::Top));
        let top = (at.0, at.1 - TOP * face.size);
        self.draw(&Text::new(clean, place(top), style));
    }

    /// Ends the drawing; the widths of its texts, for [`finish`].
    ///
    /// # Errors
    /// The first thing that could not be drawn.
    pub fn end(mut self) -> Result<Vec<f64>, String> {
        if let Err(error) = self.area.present() {
            self.failed.get_or_insert_with(|| error.to_string());
        }
        match self.failed {
            Some(why) => Err(why),
            None => Ok(self.widths),
        }
    }
}

/// `text` without what XML cannot hold and without line breaks.
fn printable(text: &str) -> String {
    text.chars()
        .map(|c| {
            if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') {
                ' '
            } else {
                c
            }
        })
        .collect::<String>()
        .trim()
        .to_owned()
}

/// `text` as XML holds it.
pub(in crate::report) fn escape(text: &str) -> String {
    let mut out = String::new();
    for c in printable(text).chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

/// What stands in the head of an SVG.
pub(super) struct Head<'a> {
    pub width: f64,
    pub height: f64,
    /// What a screen reader says.
    pub title: &'a str,
    /// Whether the colours follow the reader's preference for dark.
    pub adapts: bool,
}

/// Gives plotters' `drawn` a size in pixels, a title, the widths of its texts, and dark colours on demand.
pub(super) fn finish(drawn: &str, widths: &[f64], head: &Head) -> String {
    let (w, h) = (fine(head.width), fine(head.height));
    let title = escape(head.title);
    let style = if head.adapts {
        theme::dark_style()
    } else {
        String::new()
    };
    let open = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" viewBox=\"0 0 {w} {h}\" role=\"img\" \
         stroke-linejoin=\"round\">",
        head.width.round(),
        head.height.round(),
    );
    let mut svg = vec![open, format!("<title>{title}</title>"), style];
    let body = drawn.split_once('>').map_or("", |(_, body)| body);
    let mut widths = widths.iter();
    let mut lines = body.trim_start().lines();
    while let Some(line) = lines.next() {
        if let Some(open) = line.strip_suffix('>').filter(|l| l.starts_with("<text ")) {
            // plotters puts a text on lines of its own; the breaks would count as spaces.
            let content = lines.next().unwrap_or_default();
            lines.next();
            let width = widths.next().copied().unwrap_or_default();
            svg.push(format!(
                "{open} textLength=\"{width:.0}\" lengthAdjust=\"spacingAndGlyphs\">{content}</text>"
            ));
        } else {
            svg.push(line.to_owned());
        }
    }
    joined(&svg) + "\n"
}

/// `lines` of SVG, with neighbouring polylines of one style made one path: the dashes of a line are a single element.
fn joined(lines: &[String]) -> String {
    const START: &str = "<polyline ";
    let split = |line: &'_ str| -> Option<(String, String)> {
        let (style, points) = line.strip_prefix(START)?.split_once(" points=\"")?;
        let points = points.strip_suffix("\"/>")?.trim_end();
        Some((style.to_owned(), points.to_owned()))
    };
    let mut out: Vec<String> = Vec::new();
    let mut path: Option<(String, Vec<String>)> = None;
    let close = |path: Option<(String, Vec<String>)>, out: &mut Vec<String>| {
        if let Some((style, pieces)) = path {
            out.push(format!("<path {style} d=\"M{}\"/>", pieces.join("M")));
        }
    };
    for line in lines {
        match (split(line), &mut path) {
            (Some((style, points)), Some((open, pieces))) if style == *open => pieces.push(points),
            (Some((style, points)), _) => {
                close(path.replace((style, vec![points])), &mut out);
            }
            (None, _) => {
                close(path.take(), &mut out);
                out.push(line.clone());
            }
        }
    }
    close(path, &mut out);
    out.join("\n")
}

/// `points` as pieces whose lengths, and the gaps between them, follow `pattern` (dash, gap, dash, gap …).
fn dashed(points: &[At], pattern: &[f64]) -> Vec<Vec<At>> {
    if pattern.is_empty() || points.len() < 2 {
        return vec![points.to_vec()];
    }
    let mut pieces: Vec<Vec<At>> = vec![vec![points[0]]];
    let (mut phase, mut left) = (0, pattern[0]);
    for pair in points.windows(2) {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        let length = (x1 - x0).hypot(y1 - y0);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let at = (
                x0 + (x1 - x0) * done / length,
                y0 + (y1 - y0) * done / length,
            );
            if phase % 2 == 0 {
                if let Some(piece) = pieces.last_mut() {
                    piece.push(at);
                }
            } else {
                pieces.push(vec![at]);
            }
            phase = (phase + 1) % pattern.len();
            left = pattern[phase];
        }
        left -= length - done;
        if phase % 2 == 0
            && let Some(piece) = pieces.last_mut()
        {
            piece.push((x1, y1));
        }
    }
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_cover_their_share_of_a_line() {
        let pieces = dashed(&[(0.0, 0.0), (30.0, 0.0), (30.0, 30.0)], &[4.0, 2.0]);
        let length: f64 = pieces
            .iter()
            .flat_map(|p| p.windows(2))
            .map(|w| (w[1].0 - w[0].0).hypot(w[1].1 - w[0].1))
            .sum();
        assert!((length - 40.0).abs() < 1e-9, "{length}");
        assert_eq!(dashed(&[(0.0, 0.0), (9.0, 0.0)], &[]).len(), 1);
    }

    #[test]
    fn neighbouring_lines_of_one_style_become_one_path() {
        let line = |c: &str, p: &str| format!("<polyline stroke=\"{c}\" points=\"{p} \"/>");
        let lines = [
            line("a", "1,2 3,4"),
            line("a", "5,6 7,8"),
            line("b", "0,0 1,1"),
            "</svg>".to_owned(),
        ];
        assert_eq!(
            joined(&lines),
            "<path stroke=\"a\" d=\"M1,2 3,4M5,6 7,8\"/>\n<path stroke=\"b\" d=\"M0,0 1,1\"/>\n</svg>"
        );
    }

    #[test]
    fn control_characters_and_markup_do_not_reach_the_file() {
        assert_eq!(escape("a<b>\u{7}&\"c\""), "a&lt;b&gt; &amp;&quot;c&quot;");
    }
}
