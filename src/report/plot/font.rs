//! The one typeface of all plots: Inter (SIL Open Font License, `font/LICENSE.txt`), reduced to Latin, Greek and
//! mathematical signs and without kerning, so a text is exactly as wide as its advances say, wherever it is drawn.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, OutlineCurve, Point};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use plotters::style::{FontStyle, register_font};
use tiny_skia::{Path, PathBuilder};

/// What SVG files name: our typeface first, then what a reader's machine is likely to have. Texts carry their width,
/// so the layout holds with any of them.
pub(super) const FAMILY: &str = "Inter, Helvetica, Arial, sans-serif";

/// The typeface as OpenType files.
pub(super) const REGULAR: &[u8] = include_bytes!("../font/Inter-Regular.otf");
pub(super) const BOLD: &[u8] = include_bytes!("../font/Inter-SemiBold.otf");

/// Units an em where a face does not say.
const EM: f32 = 1000.0;

/// Weight of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weight {
    Regular,
    Bold,
}

static FACES: LazyLock<Option<[FontRef<'static>; 2]>> = LazyLock::new(|| {
    Some([
        FontRef::try_from_slice(REGULAR).ok()?,
        FontRef::try_from_slice(BOLD).ok()?,
    ])
});

fn face(weight: Weight) -> Option<&'static FontRef<'static>> {
    let faces = FACES.as_ref()?;
    Some(&faces[usize::from(weight == Weight::Bold)])
}

/// Makes the typeface known to plotters; needed before anything is drawn. Cheap when repeated.
pub(super) fn register() {
    static DONE: LazyLock<()> = LazyLock::new(|| {
        // Both files are compiled in and parse (a test says so); without them plotters reports an unknown font.
        let _ = register_font(FAMILY, FontStyle::Normal, REGULAR);
        let _ = register_font(FAMILY, FontStyle::Bold, BOLD);
    });
    LazyLock::force(&DONE);
}

/// Rules that bring the typeface into a page.
pub(in crate::report) fn css() -> String {
    [(REGULAR, 400), (BOLD, 600)]
        .map(|(face, weight)| {
            let data = STANDARD.encode(face);
            format!(
                "@font-face{{font-family:Inter;font-weight:{weight};\
                 src:url(data:font/otf;base64,{data}) format('opentype')}}"
            )
        })
        .concat()
}

/// Width of `text` at `size` pixels an em.
pub(super) fn width(text: &str, size: f64, weight: Weight) -> f64 {
    let Some(face) = face(weight) else {
        // 0.6 em a character is wider than any Latin text: a layout made with it has room to spare.
        return 0.6 * size * text.chars().count() as f64;
    };
    let units = f64::from(face.units_per_em().unwrap_or(EM));
    text.chars()
        .map(|c| f64::from(face.h_advance_unscaled(face.glyph_id(c))) / units * size)
        .sum()
}

/// The outlines of `text`: x from 0 to 1 over its [`width`], y in ems, downwards, 0 at the base line; `None` where it has
/// no ink.
pub(super) fn outline(text: &str, weight: Weight) -> Option<Path> {
    let face = face(weight)?;
    let units = face.units_per_em().unwrap_or(EM);
    let whole = width(text, f64::from(units), weight) as f32;
    let mut path = PathBuilder::new();
    let mut from = 0.0;
    for glyph in text.chars().map(|c| face.glyph_id(c)) {
        let at = |p: &Point| ((from + p.x) / whole, -p.y / units);
        let mut last = None;
        for curve in face.outline(glyph).into_iter().flat_map(|o| o.curves) {
            let (OutlineCurve::Line(start, end)
            | OutlineCurve::Quad(start, _, end)
            | OutlineCurve::Cubic(start, _, _, end)) = &curve;
            // A curve that does not go on from the last one begins another contour.
            if last != Some(*start) {
                let (x, y) = at(start);
                path.move_to(x, y);
            }
            last = Some(*end);
            let (x, y) = at(end);
            match &curve {
                OutlineCurve::Line(..) => path.line_to(x, y),
                OutlineCurve::Quad(_, a, _) => path.quad_to(at(a).0, at(a).1, x, y),
                OutlineCurve::Cubic(_, a, b, _) => {
                    path.cubic_to(at(a).0, at(a).1, at(b).0, at(b).1, x, y);
                }
            }
        }
        from += face.h_advance_unscaled(glyph);
    }
    path.finish()
}

/// `text` if it is at most `room` wide, else its beginning and end around an ellipsis.
pub(super) fn fit(text: &str, size: f64, weight: Weight, room: f64) -> String {
    if width(text, size, weight) <= room {
        return text.to_owned();
    }
    let chars: Vec<char> = text.chars().collect();
    for kept in (1..chars.len()).rev() {
        // The end of a path or spec tells more than its middle, the beginning more than the end.
        let head = kept.div_ceil(2);
        let tail = &chars[chars.len() - (kept - head)..];
        let short: String = chars[..head].iter().chain(&['…']).chain(tail).collect();
        if width(&short, size, weight) <= room {
            return short;
        }
    }
    "…".to_owned()
}

/// `text` broken at spaces into lines at most `room` wide; a word that is wider alone is shortened.
pub(super) fn wrap(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let word = fit(word, size, Weight::Regular, room);
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), size, Weight::Regular) <= room => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => lines.push(word),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_faces_parse_and_have_every_sign_that_plots_use() {
        let faces = FACES.as_ref().expect("embedded faces parse");
        for face in faces {
            for c in "Aaz09 ,.;:·…×⁰¹²³⁴⁵⁶⁷⁸⁹⁻–−%µ≤≥()=/".chars() {
                assert_ne!(face.glyph_id(c).0, 0, "no glyph for {c:?}");
            }
        }
    }

    #[test]
    fn shortened_text_fits_and_keeps_both_ends() {
        let long = "/data/models/very/long/path/to/a/mesh/dragon.obj";
        let short = fit(long, 12.0, Weight::Regular, 150.0);
        assert!(width(&short, 12.0, Weight::Regular) <= 150.0);
        assert!(
            short.starts_with("/data") && short.ends_with("on.obj"),
            "{short}"
        );
        assert_eq!(fit("teapot", 12.0, Weight::Bold, 150.0), "teapot");
    }

    #[test]
    fn wrapped_lines_fit_and_lose_no_word() {
        let text = "Median of 9 samples a point and its 95 % bootstrap interval";
        let lines = wrap(text, 10.0, 120.0);
        assert!(lines.len() > 1);
        assert!(
            lines
                .iter()
                .all(|l| width(l, 10.0, Weight::Regular) <= 120.0)
        );
        assert_eq!(lines.join(" "), text);
    }
}
