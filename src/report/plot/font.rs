//! The one typeface of all plots: Inter (SIL Open Font License, `font/LICENSE.txt`), reduced to Latin, Greek and
//! mathematical signs and without kerning, so a text is exactly as wide as its advances say, wherever it is drawn.

use std::sync::{Arc, LazyLock};

use ab_glyph::{Font, FontRef};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use plotters::style::{FontStyle, register_font};
use resvg::usvg::fontdb::Database;

/// What SVG files name: our typeface first, then what a reader's machine is likely to have. Texts carry their width,
/// so the layout holds with any of them.
pub(super) const FAMILY: &str = "Inter, Helvetica, Arial, sans-serif";

const REGULAR: &[u8] = include_bytes!("../font/Inter-Regular.otf");
const BOLD: &[u8] = include_bytes!("../font/Inter-SemiBold.otf");

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

/// Makes the typeface known to plotters; needed before anything is drawn. Cheap when repeated.
pub(super) fn register() {
    static DONE: LazyLock<()> = LazyLock::new(|| {
        // Both files are compiled in and parse (a test says so); without them plotters reports an unknown font.
        let _ = register_font(FAMILY, FontStyle::Normal, REGULAR);
        let _ = register_font(FAMILY, FontStyle::Bold, BOLD);
    });
    LazyLock::force(&DONE);
}

/// The typeface for the rasteriser.
pub(super) fn database() -> Arc<Database> {
    static DATABASE: LazyLock<Arc<Database>> = LazyLock::new(|| {
        let mut database = Database::new();
        database.load_font_data(REGULAR.to_vec());
        database.load_font_data(BOLD.to_vec());
        database.set_sans_serif_family("Inter");
        Arc::new(database)
    });
    Arc::clone(&DATABASE)
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
    let Some(faces) = FACES.as_ref() else {
        // 0.6 em a character is wider than any Latin text: a layout made with it has room to spare.
        return 0.6 * size * text.chars().count() as f64;
    };
    let face = &faces[usize::from(weight == Weight::Bold)];
    let units = f64::from(face.units_per_em().unwrap_or(1000.0));
    text.chars()
        .map(|c| f64::from(face.h_advance_unscaled(face.glyph_id(c))) / units * size)
        .sum()
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
