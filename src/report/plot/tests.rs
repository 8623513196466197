//! What every figure must hold, whatever the report: checked on what a whole SVG renderer, which measures texts by
//! itself, makes of the SVG.

use std::collections::HashSet;
use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{Group, Node, Options, Paint, Rect, Stroke, TextChunk, Tree};

use super::*;
use crate::report::fixture;
use crate::report::scaling::curves;
use crate::report::series::{accel_label, series};

mod cases;

/// A figure of a case.
struct Drawn {
    name: String,
    report: Report,
    subject: Subject,
    svg: String,
}

/// All figures of all cases.
fn drawn() -> Vec<Drawn> {
    let mut all = Vec::new();
    for (case, report) in cases::all() {
        for (name, subject) in figures(&report) {
            if let Some(svg) = svg(&report, &subject).unwrap() {
                let (name, report) = (format!("{case}/{name}"), report.clone());
                all.push(Drawn {
                    name,
                    report,
                    subject,
                    svg,
                });
            }
        }
    }
    all
}

fn parsed(svg: &str) -> Tree {
    static TYPEFACE: LazyLock<Arc<Database>> = LazyLock::new(|| {
        let mut database = Database::new();
        for face in [font::REGULAR, font::BOLD] {
            database.load_font_data(face.to_vec());
        }
        Arc::new(database)
    });
    let options = Options {
        fontdb: Arc::clone(&TYPEFACE),
        ..Options::default()
    };
    Tree::from_str(svg, &options).expect("well-formed SVG")
}

/// Texts with the boxes of their glyphs, in pixels.
fn texts(tree: &Tree) -> Vec<(String, Rect)> {
    fn walk(group: &Group, out: &mut Vec<(String, Rect)>) {
        for node in group.children() {
            match node {
                Node::Group(inner) => walk(inner, out),
                Node::Text(text) => {
                    let content = text.chunks().iter().map(TextChunk::text).collect();
                    out.push((content, node.abs_bounding_box()));
                }
                _ => {}
            }
        }
    }
    let mut out = Vec::new();
    walk(tree.root(), &mut out);
    out
}

/// Boxes of everything drawn, in pixels.
fn boxes(tree: &Tree) -> Vec<Rect> {
    fn walk(group: &Group, out: &mut Vec<Rect>) {
        for node in group.children() {
            match node {
                Node::Group(inner) => walk(inner, out),
                node => out.push(node.abs_bounding_box()),
            }
        }
    }
    let mut out = Vec::new();
    walk(tree.root(), &mut out);
    out
}

#[test]
fn everything_lies_within_the_sheet() {
    for Drawn {
        name: figure, svg, ..
    } in drawn()
    {
        let tree = parsed(&svg);
        let (w, h) = (tree.size().width(), tree.size().height());
        for (text, b) in texts(&tree) {
            let inside =
                b.left() >= 4.0 && b.top() >= 4.0 && b.right() <= w - 4.0 && b.bottom() <= h - 2.0;
            assert!(inside, "{figure}: '{text}' at {b:?} leaves {w}x{h}");
        }
        for b in boxes(&tree) {
            let inside = b.left() >= -0.2
                && b.top() >= -0.2
                && b.right() <= w + 0.2
                && b.bottom() <= h + 0.2;
            assert!(inside, "{figure}: a shape at {b:?} leaves {w}x{h}");
        }
    }
}

#[test]
fn no_two_texts_overlap() {
    for Drawn {
        name: figure, svg, ..
    } in drawn()
    {
        let texts = texts(&parsed(&svg));
        for (i, (a, ra)) in texts.iter().enumerate() {
            for (b, rb) in &texts[i + 1..] {
                let apart = ra.right() < rb.left()
                    || rb.right() < ra.left()
                    || ra.bottom() < rb.top()
                    || rb.bottom() < ra.top();
                assert!(apart, "{figure}: '{a}' {ra:?} and '{b}' {rb:?}");
            }
        }
    }
}

#[test]
fn every_line_has_its_label_in_every_panel() {
    for figure in drawn() {
        let Subject::One(key, kind) = figure.subject else {
            continue;
        };
        let texts = texts(&parsed(&figure.svg));
        for &quantity in kind.quantities() {
            for line in series(&figure.report.runs, &key, quantity) {
                // A long label keeps its beginning.
                let start: String = line.label.chars().take(18).collect();
                let found = texts.iter().filter(|(t, _)| t.starts_with(&start)).count();
                let panels = kind.quantities().len();
                assert!(
                    found >= 1 && found + 1 >= panels,
                    "{}: '{}'",
                    figure.name,
                    line.label
                );
            }
        }
    }
}

#[test]
fn a_text_is_as_wide_as_it_says() {
    // The stated width makes the layout hold where the typeface is missing; here it is present, so both agree.
    let svg = drawn().swap_remove(0).svg;
    let free = svg
        .lines()
        .map(|line| {
            match (
                line.find(" textLength"),
                line.find("lengthAdjust=\"spacingAndGlyphs\""),
            ) {
                (Some(from), Some(to)) => format!("{}{}", &line[..from], &line[to + 31..]),
                _ => line.to_owned(),
            }
        })
        .collect::<Vec<_>>()
        .join("\n");
    assert!(svg.len() > free.len() + 200);
    for ((text, stated), (_, natural)) in texts(&parsed(&svg)).iter().zip(texts(&parsed(&free))) {
        let difference = (stated.width() - natural.width()).abs();
        assert!(difference < 0.4, "'{text}': {stated:?} {natural:?}");
    }
}

#[test]
fn a_figure_holds_no_number_that_is_none() {
    for Drawn {
        name: figure, svg, ..
    } in drawn()
    {
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{figure}");
    }
}

#[test]
fn equal_reports_give_equal_bytes() {
    let once: Vec<String> = drawn().into_iter().map(|d| d.svg).collect();
    let again: Vec<String> = drawn().into_iter().map(|d| d.svg).collect();
    assert_eq!(once, again);
}

#[test]
fn curves_of_a_figure_differ_and_keep_their_look_over_figures() {
    let report = fixture::teapot();
    let labels: HashSet<String> = report.runs.iter().map(accel_label).collect();
    let key = &panels(&report.runs)[0];
    for kind in Kind::ALL {
        let svg = svg(&report, &Subject::One(key.clone(), kind))
            .unwrap()
            .unwrap();
        for colour in &theme::LIGHT.lines[..labels.len()] {
            assert!(svg.contains(&theme::hex(*colour)), "{kind:?}");
        }
    }
}

#[test]
fn an_svg_can_turn_dark_and_a_dark_png_is_dark() {
    let dir = tempfile::tempdir().unwrap();
    let report = fixture::report(vec![fixture::run("grid", Some(4))]);
    let files = write_all(&report, dir.path(), &[PlotFormat::Svg, PlotFormat::PngDark]).unwrap();
    let svg = std::fs::read_to_string(&files[0]).unwrap();
    assert!(svg.contains("prefers-color-scheme:dark"));
    assert_eq!(corner(&files[1]), [0x0F, 0x13, 0x18]);
}

/// The first pixel of a PNG file.
fn corner(path: &Path) -> [u8; 3] {
    let (_, pixels) = decoded(path);
    [pixels[0], pixels[1], pixels[2]]
}

/// Size and RGB bytes of a PNG file.
fn decoded(path: &Path) -> ((u32, u32), Vec<u8>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    ((info.width, info.height), pixels)
}

#[test]
fn a_png_has_twice_the_pixels_of_its_figure() {
    let dir = tempfile::tempdir().unwrap();
    let report = fixture::report(vec![fixture::run("bvh", None)]);
    let files = write_all(&report, dir.path(), &[PlotFormat::Svg, PlotFormat::Png]).unwrap();
    assert_eq!(files.len(), 6);
    let size = parsed(&std::fs::read_to_string(&files[0]).unwrap()).size();
    let ((w, h), pixels) = decoded(&files[1]);
    assert_eq!(
        (w as f32, h as f32),
        (size.width() * 2.0, size.height() * 2.0)
    );
    let ink = pixels.chunks(3).filter(|p| p[0] < 100).count();
    assert!(ink > 1000, "{ink} dark pixels: the text is missing");
}

/// What a whole SVG renderer makes of `svg`.
fn second_opinion(svg: &str) -> Pixmap {
    let tree = parsed(svg);
    let size = tree.size().to_int_size().scale_by(raster::SCALE).unwrap();
    let mut pixels = Pixmap::new(size.width(), size.height()).unwrap();
    pixels.fill(Color::WHITE);
    let place = Transform::from_scale(raster::SCALE, raster::SCALE);
    resvg::render(&tree, place, &mut pixels.as_mut());
    pixels
}

#[test]
fn a_picture_shows_what_a_whole_renderer_makes_of_the_svg() {
    for (case, report) in cases::all() {
        for (name, subject) in figures(&report) {
            let drawn = super::drawn(&report, &subject, PlotFormat::Png.style());
            let Some(svg) = drawn.unwrap() else { continue };
            let (ours, theirs) = (raster::pixels(&svg).unwrap(), second_opinion(&svg));
            let size = |p: &Pixmap| (p.width(), p.height());
            assert_eq!(size(&ours), size(&theirs), "{case}/{name}");
            let pairs = ours.data().iter().zip(theirs.data());
            // Roundings tint edges a little; a text or a line a pixel off turns ground to ink, thousands of times.
            let off = pairs.filter(|(a, b)| a.abs_diff(**b) > 64).count();
            assert!(off * 100_000 < ours.data().len(), "{case}/{name}: {off}");
        }
    }
}

#[test]
fn files_have_stable_names_and_nothing_half_written_stays() {
    let dir = tempfile::tempdir().unwrap();
    let below = dir.path().join("new/folder");
    write_all(&fixture::teapot(), &below, &[PlotFormat::Svg]).unwrap();
    let mut names: Vec<String> = std::fs::read_dir(&below)
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(
        names,
        ["cost", "speed", "work"].map(|kind| format!("{kind}-teapot-woop-primary-1t.svg"))
    );
}

#[test]
fn names_of_files_are_sane_and_distinct_whatever_the_scene() {
    let scenes = [
        "a b",
        "a/b",
        "a:b",
        "../../etc/passwd",
        "con?*",
        "日本",
        "",
        "soup:100000,0.5",
    ];
    let runs = scenes.map(|s| fixture::run_of(s, 1, "file:/x/y.rays", 2, "bvh", None));
    let report = fixture::report(runs.to_vec());
    let names: Vec<String> = figures(&report).into_iter().map(|f| f.0).collect();
    assert_eq!(names.len(), scenes.len() * Kind::ALL.len() + 1);
    assert_eq!(names.iter().collect::<HashSet<_>>().len(), names.len());
    for name in &names {
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '.';
        assert!(name.chars().all(plain) && !name.contains(".."), "{name}");
    }
    assert!(
        names[names.len() - 1].ends_with("soup-100000-0.5-woop-y.rays-2t"),
        "{names:?}"
    );
}

#[test]
fn a_report_without_runs_has_no_figures() {
    let dir = tempfile::tempdir().unwrap();
    let files = write_all(&fixture::report(Vec::new()), dir.path(), &[PlotFormat::Svg]).unwrap();
    assert!(files.is_empty());
}

#[test]
fn several_combinations_get_an_overview_that_names_each() {
    let named = |(name, _): &(&str, Report)| *name == "combinations";
    let (_, report) = cases::all().into_iter().find(named).unwrap();
    let texts = texts(&parsed(&svg(&report, &Subject::Overview).unwrap().unwrap()));
    for key in panels(&report.runs) {
        let named = |(text, _): &&(String, Rect)| text.starts_with(&key.scene);
        assert!(texts.iter().any(|t| named(&t)), "{key}");
    }
}

#[test]
fn sizes_of_a_family_get_a_chart_that_names_every_accelerator_with_its_exponents() {
    let report = fixture::report(fixture::growing());
    let (name, subject) = figures(&report)
        .into_iter()
        .find(|(_, subject)| matches!(subject, Subject::Scaling(_)))
        .unwrap();
    assert_eq!(name, "scaling-woop-primary-1t");
    let texts = texts(&parsed(&svg(&report, &subject).unwrap().unwrap()));
    let count = |label: &str| texts.iter().filter(|(text, _)| text == label).count();
    for family in ["soup", "sphereflake"] {
        assert_eq!(count(family), 1, "{family}");
    }
    let Subject::Scaling(setting) = &subject else {
        unreachable!()
    };
    for family in ["soup", "sphereflake"] {
        for cost in super::super::scaling::COSTS {
            for curve in curves(&report.runs, setting, family, cost) {
                let exponent = format!("N^{:.2}", curve.power().unwrap().slope);
                assert!(count(&exponent) >= 1, "{exponent}: {texts:?}");
                assert_eq!(count(&curve.label), 6);
            }
        }
    }
}

#[test]
fn judged_runs_get_a_pareto_chart_an_offset_and_one_of_error_with_every_method_named() {
    let report = cases::all()
        .into_iter()
        .find(|(name, _)| *name == "judged")
        .unwrap()
        .1;
    let figures = figures(&report);
    let names: Vec<&str> = figures.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        [
            "overview",
            "pareto-teapot-edge-1t-0",
            "pareto-teapot-edge-1t-10000",
            "pareto-teapot-edge-1t-1000000",
            "drift-teapot-edge-1t"
        ]
    );
    for (name, subject) in &figures[1..] {
        let svg = svg(&report, subject).unwrap().unwrap();
        let texts = texts(&parsed(&svg));
        for run in &report.runs {
            assert!(
                texts.iter().any(|(t, _)| *t == run.kernel),
                "{name}: {}",
                run.kernel
            );
        }
    }
}

#[test]
fn a_parameter_and_a_scale_with_several_values_get_charts_of_their_own() {
    let named = |(name, _): &(&str, Report)| *name == "tuned";
    let (_, report) = cases::all().into_iter().find(named).unwrap();
    let figures = figures(&report);
    let names: Vec<&str> = figures.iter().map(|(name, _)| name.as_str()).collect();
    let scale = "0.".to_owned() + &"0".repeat(29) + "1";
    let expected = [
        "overview".to_owned(),
        "pareto-teapot-edge-1t-0".to_owned(),
        "pareto-teapot-edge-1t-10000".to_owned(),
        format!("pareto-teapot-edge-1t-0-x{scale}"),
        "drift-teapot-edge-1t".to_owned(),
        "scale-teapot-edge-1t-0".to_owned(),
        "tuned-sheet-unsigned-eps-teapot-edge-1t".to_owned(),
    ];
    assert_eq!(names, expected);
    let chart = svg(&report, &figures[6].1).unwrap().unwrap();
    let texts = texts(&parsed(&chart));
    for label in ["offset 0", "offset 10,000", "offset 0, scale 10⁻³⁰", "eps"] {
        assert!(texts.iter().any(|(t, _)| t == label), "{label}: {texts:?}");
    }
}

/// The pieces of the front's and the floor's lines: all that is drawn in their colour.
fn stairs(tree: &Tree) -> Vec<Rect> {
    fn walk(group: &Group, out: &mut Vec<Rect>) {
        for node in group.children() {
            match node {
                Node::Group(inner) => walk(inner, out),
                Node::Path(path) => {
                    let muted = theme::LIGHT.muted;
                    let paint = path.stroke().map(Stroke::paint);
                    let of_lines = matches!(
                        paint,
                        Some(Paint::Color(c)) if (c.red, c.green, c.blue) == (muted.0, muted.1, muted.2)
                    );
                    if of_lines {
                        let data = path.data().clone().transform(path.abs_transform()).unwrap();
                        let pieces = data.points().windows(2).filter_map(|w| {
                            let (x, y) = (w[0].x.min(w[1].x), w[0].y.min(w[1].y));
                            let (right, bottom) = (w[0].x.max(w[1].x), w[0].y.max(w[1].y));
                            Rect::from_ltrb(x, y, right + 0.1, bottom + 0.1)
                        });
                        out.extend(pieces);
                    }
                }
                _ => {}
            }
        }
    }
    let mut out = Vec::new();
    walk(tree.root(), &mut out);
    out
}

#[test]
fn labels_of_methods_keep_clear_of_the_lines_of_the_front_and_of_the_floor() {
    let named = |(name, _): &(&str, Report)| *name == "judged";
    let (_, report) = cases::all().into_iter().find(named).unwrap();
    let mut checked = 0;
    for (name, subject) in figures(&report) {
        if !matches!(subject, Subject::Pareto(..)) {
            continue;
        }
        let tree = parsed(&svg(&report, &subject).unwrap().unwrap());
        let known: HashSet<&str> = report.runs.iter().map(|r| r.kernel.as_str()).collect();
        for line in stairs(&tree) {
            for (text, place) in texts(&tree) {
                if !known.contains(text.as_str()) {
                    continue;
                }
                checked += 1;
                let crosses = line.left() < place.right()
                    && place.left() < line.right()
                    && line.top() < place.bottom()
                    && place.top() < line.bottom();
                assert!(!crosses, "{name}: '{text}' at {place:?} on {line:?}");
            }
        }
    }
    assert!(checked > 100, "{checked}");
}
