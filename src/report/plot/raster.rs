//! PNG by rasterising the SVG, so both show the same figure.
//!
//! Reads what `canvas` writes and no more: filled rectangles, discs and polygons, stroked rings and lines, texts. An
//! element or a value beyond that is an error, never left out. Texts are drawn as outlines of our own typeface.
//!
//! **Differs:** a whole SVG renderer, with its shaping of texts, would take longer to compile than all else that draws.
//! The tests hold one against this.

use roxmltree::{Document, Node};
use tiny_skia::{
    Color, FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, Transform,
};

use super::font::{self, Weight};

/// Pixels of the picture for each pixel of the figure: sharp on dense screens and in print.
pub(super) const SCALE: f32 = 2.0;

/// `svg` as PNG, opaque, [`SCALE`] times its size.
///
/// # Errors
/// A sentence; a figure of this crate gives none unless memory runs out.
pub(super) fn png(svg: &str) -> Result<Vec<u8>, String> {
    let pixels = pixels(svg)?;
    // Opaque everywhere, so premultiplied colours are the colours.
    let rgb: Vec<u8> = pixels
        .data()
        .chunks_exact(4)
        .flat_map(|p| [p[0], p[1], p[2]])
        .collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&rgb))
        .map_err(|e| e.to_string())?;
    Ok(bytes)
}

/// The picture, on white.
///
/// # Errors
/// As [`png()`].
pub(super) fn pixels(svg: &str) -> Result<Pixmap, String> {
    let document = Document::parse(svg).map_err(|e| e.to_string())?;
    let root = document.root_element();
    let (width, height) = (number(root, "width")?, number(root, "height")?);
    let view = attribute(root, "viewBox")?;
    let [_, _, w, h] = numbers(view)?[..] else {
        return Err(format!("'{view}' is not a view box"));
    };
    let (across, down) = (
        (width * SCALE).ceil() as u32,
        (height * SCALE).ceil() as u32,
    );
    let mut pixels =
        Pixmap::new(across, down).ok_or_else(|| format!("no memory for {across}x{down} pixels"))?;
    pixels.fill(Color::WHITE);
    // A sheet's size is in whole pixels, its view box is not: as large as fits, in the middle.
    let scale = SCALE * (width / w).min(height / h);
    let edge = |whole: f32, part: f32| (whole * SCALE - part * scale) / 2.0;
    let place = Transform::from_row(scale, 0.0, 0.0, scale, edge(width, w), edge(height, h));
    for node in root.children().filter(Node::is_element) {
        draw(&mut pixels, node, place)?;
    }
    Ok(pixels)
}

/// Draws one element, whose coordinates `place` takes to pixels.
fn draw(pixels: &mut Pixmap, node: Node, place: Transform) -> Result<(), String> {
    // What has no extent has no path, and shows nothing.
    let path = match node.tag_name().name() {
        // For readers of the SVG: a name, and colours on dark ground.
        "title" | "style" => return Ok(()),
        "rect" => rectangle(node)?,
        "circle" => {
            let [x, y, r] = ["cx", "cy", "r"].map(|name| number(node, name));
            PathBuilder::from_circle(x?, y?, r?)
        }
        "polygon" => lines(attribute(node, "points")?, true)?,
        "path" => lines(attribute(node, "d")?, false)?,
        "text" => text(node)?,
        other => return Err(format!("no figure has an element '{other}'")),
    };
    let Some(path) = path else { return Ok(()) };
    if let Some(paint) = paint(node, attribute(node, "fill")?)? {
        pixels.fill_path(&path, &paint, FillRule::Winding, place, None);
    }
    if let Some(paint) = paint(node, node.attribute("stroke").unwrap_or("none"))? {
        let stroke = Stroke {
            width: number(node, "stroke-width")?,
            line_join: LineJoin::Round,
            ..Stroke::default()
        };
        pixels.stroke_path(&path, &paint, &stroke, place, None);
    }
    Ok(())
}

fn rectangle(node: Node) -> Result<Option<Path>, String> {
    let [x, y, w, h] = ["x", "y", "width", "height"].map(|name| number(node, name));
    Ok(Rect::from_xywh(x?, y?, w?, h?).map(PathBuilder::from_rect))
}

/// The lines through points `x,y x,y`, one a piece that begins with `M`; closed on demand.
fn lines(data: &str, closed: bool) -> Result<Option<Path>, String> {
    let mut path = PathBuilder::new();
    for piece in data.split('M').filter(|piece| !piece.is_empty()) {
        for (i, pair) in numbers(piece)?.chunks(2).enumerate() {
            match *pair {
                [x, y] if i == 0 => path.move_to(x, y),
                [x, y] => path.line_to(x, y),
                _ => return Err(format!("'{piece}' is not a row of points")),
            }
        }
        if closed {
            path.close();
        }
    }
    Ok(path.finish())
}

/// The outlines of a text, as wide as it says it is.
fn text(node: Node) -> Result<Option<Path>, String> {
    if let Some(turn) = node.attribute("transform") {
        return Err(format!("no figure has a text under '{turn}'"));
    }
    let weight = match node.attribute("font-weight") {
        None => Weight::Regular,
        Some("bold") => Weight::Bold,
        Some(other) => return Err(format!("no figure has a text of weight '{other}'")),
    };
    let (size, width) = (number(node, "font-size")?, number(node, "textLength")?);
    let before = match attribute(node, "text-anchor")? {
        "start" => 0.0,
        "middle" => 0.5,
        "end" => 1.0,
        other => return Err(format!("no figure has a text anchored at '{other}'")),
    };
    let dy = attribute(node, "dy")?;
    let dy = dy.strip_suffix("em").ok_or_else(|| unreadable(dy))?;
    let content = node.text().unwrap_or_default();
    let at = (
        number(node, "x")? - before * width,
        number(node, "y")? + parsed(dy)? * size,
    );
    let place = Transform::from_row(width, 0.0, 0.0, size, at.0, at.1);
    Ok(font::outline(content, weight).and_then(|path| path.transform(place)))
}

/// `colour` at the element's opacity; `None` for `none`.
fn paint(node: Node, colour: &str) -> Result<Option<Paint<'static>>, String> {
    if colour == "none" {
        return Ok(None);
    }
    let rgb = colour.strip_prefix('#').filter(|hex| hex.len() == 6);
    let rgb = rgb.and_then(|hex| u32::from_str_radix(hex, 16).ok());
    let [_, r, g, b] = rgb.ok_or_else(|| unreadable(colour))?.to_be_bytes();
    let opacity = number(node, "opacity")?.clamp(0.0, 1.0);
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, (opacity * 255.0).round() as u8);
    Ok(Some(paint))
}

fn attribute<'a>(node: Node<'a, '_>, name: &str) -> Result<&'a str, String> {
    let tag = node.tag_name().name();
    node.attribute(name)
        .ok_or_else(|| format!("an element '{tag}' has no '{name}'"))
}

fn number(node: Node, name: &str) -> Result<f32, String> {
    attribute(node, name).and_then(parsed)
}

/// The numbers of a list, which spaces or commas part.
fn numbers(list: &str) -> Result<Vec<f32>, String> {
    list.split([' ', ','])
        .filter(|word| !word.is_empty())
        .map(parsed)
        .collect()
}

fn parsed(word: &str) -> Result<f32, String> {
    word.parse().map_err(|_| unreadable(word))
}

fn unreadable(word: &str) -> String {
    format!("no figure has a value '{word}'")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Edges of the ink on a sheet of 200 by 100 that holds `element`, in pixels of the figure: left, top, right,
    /// bottom.
    fn ink(element: &str) -> [f32; 4] {
        let svg = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='200' height='100' viewBox='0 0 1600 800'>{element}</svg>"
        );
        let pixels = pixels(&svg).unwrap();
        let mut edges = [f32::MAX, f32::MAX, 0.0, 0.0];
        for (i, p) in pixels.pixels().iter().enumerate() {
            if p.red() < 128 {
                let (x, y) = (i as u32 % pixels.width(), i as u32 / pixels.width());
                let (x, y) = (x as f32 / SCALE, y as f32 / SCALE);
                edges = [
                    edges[0].min(x),
                    edges[1].min(y),
                    edges[2].max(x + 1.0 / SCALE),
                    edges[3].max(y + 1.0 / SCALE),
                ];
            }
        }
        edges
    }

    fn near(found: [f32; 4], expected: [f32; 4]) {
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() <= 1.0, "{found:?}, not {expected:?}");
        }
    }

    /// A text of 20 pixels an em at 100, 40.
    fn word(anchor: &str, content: &str, wider: f64, more: &str) -> String {
        let width = font::width(content, 160.0, Weight::Regular) * wider;
        format!(
            "<text x='800' y='320' dy='0.5em' text-anchor='{anchor}' font-size='160' opacity='1' fill='#000000' \
             textLength='{width}' {more}>{content}</text>"
        )
    }

    #[test]
    fn a_text_begins_or_ends_or_has_its_middle_at_its_place_and_stands_on_its_base_line() {
        // An H stands on the base line, as high as capitals, with little room at its sides.
        let width = font::width("HHH", 20.0, Weight::Regular) as f32;
        let side = 1.6;
        for (anchor, left) in [
            ("start", 100.0),
            ("middle", 100.0 - width / 2.0),
            ("end", 100.0 - width),
        ] {
            let found = ink(&word(anchor, "HHH", 1.0, ""));
            near(found, [left + side, 35.5, left + width - side, 50.0]);
        }
        // What hangs below the base line does so by a fifth of an em.
        let found = ink(&word("start", "gpq", 1.0, ""));
        assert!((53.0..=55.5).contains(&found[3]), "{found:?}");
    }

    #[test]
    fn a_text_is_drawn_as_wide_as_it_says() {
        let [left, _, right, _] = ink(&word("start", "HHH", 1.0, ""));
        let [wide_left, _, wide_right, _] = ink(&word("start", "HHH", 1.5, ""));
        assert!((wide_right - wide_left - 1.5 * (right - left)).abs() <= 1.0);
    }

    #[test]
    fn bold_texts_have_thicker_strokes() {
        let width = |more: &str| {
            let [left, _, right, _] = ink(&word("start", "|", 1.0, more));
            right - left
        };
        assert!(width("font-weight='bold'") > width(""));
    }

    #[test]
    fn marks_of_xml_are_drawn_as_the_characters_they_mean() {
        let as_wide_as_one = |content: &str| {
            let width = |text: &str| font::width(text, 1.0, Weight::Regular);
            ink(&word("start", content, width("<") / width(content), ""))
        };
        assert_eq!(as_wide_as_one("&lt;"), as_wide_as_one("&#60;"));
    }

    #[test]
    fn shapes_lie_where_they_say() {
        let paint = "opacity='1' fill='#000000'";
        let line = "opacity='1' fill='none' stroke='#000000' stroke-width='16'";
        for (element, expected) in [
            (
                format!("<rect x='80' y='160' width='240' height='80' {paint}/>"),
                [10.0, 20.0, 40.0, 30.0],
            ),
            (
                format!("<circle cx='800' cy='400' r='160' stroke='none' {paint}/>"),
                [80.0, 30.0, 120.0, 70.0],
            ),
            (
                format!("<circle cx='800' cy='400' r='160' {line}/>"),
                [79.0, 29.0, 121.0, 71.0],
            ),
            (
                format!("<polygon points='80,80 400,80 400,720 ' {paint}/>"),
                [10.0, 10.0, 50.0, 90.0],
            ),
            (
                format!("<path d='M80,80 400,80M480,80 480,720' {line}/>"),
                [10.0, 9.0, 61.0, 90.0],
            ),
        ] {
            near(ink(&element), expected);
        }
    }

    #[test]
    fn what_no_figure_holds_is_refused_rather_than_left_out() {
        let word = |more: &str| word("start", "a", 1.0, more);
        for (element, named) in [
            ("<ellipse/>".to_owned(), "ellipse"),
            ("<circle cx='1' cy='2'/>".to_owned(), "'r'"),
            ("<path d='M1,2 3' fill='none'/>".to_owned(), "1,2 3"),
            ("<path d='M1,2C3,4' fill='none'/>".to_owned(), "2C3"),
            (
                "<polygon points='0,0 9,9 0,9' fill='red'/>".to_owned(),
                "red",
            ),
            (word("transform='rotate(90)'"), "rotate"),
            (word("font-weight='thin'"), "thin"),
        ] {
            let svg = format!("<svg width='9' height='9' viewBox='0 0 9 9'>{element}</svg>");
            let why = pixels(&svg).unwrap_err();
            assert!(why.contains(named), "{element}: {why}");
        }
        assert!(pixels("<svg>").is_err());
    }
}
