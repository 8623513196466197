//! What the reader makes of awkward files, case by case.

use proptest::prelude::*;

use super::*;

fn no_library(_: &str) -> io::Result<Vec<u8>> {
    Err(io::ErrorKind::NotFound.into())
}

fn load(text: impl AsRef<[u8]>) -> Result<Scene, SceneError> {
    read(text.as_ref(), Path::new("a.obj"), &no_library)
}

fn message(text: impl AsRef<[u8]>) -> String {
    let error = load(text).unwrap_err();
    assert!(!error.is_usage());
    error.to_string()
}

/// Four corners of a unit square.
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn square_and(rest: &str) -> String {
    format!("{SQUARE}{rest}")
}

#[test]
fn a_polyline_is_never_a_triangle() {
    let scene = load(square_and("l 1 2 3 4\nf 1 2 3\np 1\nl 1 2 3")).unwrap();
    assert_eq!(scene.mesh.len(), 1);
    assert_eq!(
        scene.warnings,
        ["3 lines and points are ignored; raylab traces triangles."]
    );
}

#[test]
fn coordinates_that_are_not_finite_are_errors_with_their_line() {
    for bad in ["nan", "NaN", "inf", "-Infinity", "1e400", "1e39", "-1e39"] {
        let text = format!("# first\n\nv 0 0 0\nv 1 {bad} 0\nv 0 0 1\nf 1 2 3");
        let message = message(text);
        assert!(message.starts_with("a.obj:4: "), "{message}");
        assert!(message.contains(bad), "{message}");
    }
}

#[test]
fn long_decimals_and_exponents_within_range_are_read() {
    let text = "v 0.000000000000000000000000000000000000000000001 1e-50 1E3\nv 1 +2 .5\nv 1. 0 -0\nf 1 2 3";
    let mesh = load(text).unwrap().mesh;
    assert_eq!(mesh.corners(0)[0].z, 1000.0);
    assert_eq!(mesh.corners(0)[1], Vec3::new(1.0, 2.0, 0.5));
}

#[test]
fn a_word_that_is_no_number_is_named_with_its_line() {
    let text = "v 0 0 0\nv 1,5 0 0\n";
    assert_eq!(message(text), "a.obj:2: '1,5' is not a number");
    assert_eq!(
        message("v 1 2\n"),
        "a.obj:1: a vertex needs three coordinates"
    );
    assert_eq!(
        message(b"v 1 2 \xff\n"),
        "a.obj:1: '\u{fffd}' is not a number"
    );
}

#[test]
fn a_concave_polygon_is_covered_without_overlap() {
    // An arrow whose fan from the first corner would lie half outside.
    let text = "v 0 0 0\nv 2 1 0\nv 0 2 0\nv 0.5 1 0\nf 2 3 4 1\nf 1 2 3 4";
    let mesh = load(text).unwrap().mesh;
    let areas: Vec<f32> = (0..4)
        .map(|prim| {
            let [a, b, c] = mesh.corners(prim);
            (b - a).cross(c - a).z * 0.5
        })
        .collect();
    assert!(areas.iter().all(|&a| a > 0.0), "{areas:?}");
    assert_eq!(areas.iter().sum::<f32>(), 3.0);
}

#[test]
fn a_byte_order_mark_does_not_cost_the_first_vertex() {
    let mesh = load("\u{feff}v 5 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3")
        .unwrap()
        .mesh;
    assert_eq!(mesh.corners(0)[0].x, 5.0);
}

#[test]
fn bytes_that_are_no_utf8_do_no_harm_in_comments_and_names() {
    let text = [
        &b"# caf\xe9\no \xff\nusemtl \xe9\n"[..],
        SQUARE.as_bytes(),
        b"f 1 2 3 # \xfe",
    ];
    let scene = load(text.concat()).unwrap();
    assert_eq!(scene.mesh.len(), 1);
    assert!(scene.warnings[0].contains("'\u{fffd}'"));
}

#[test]
fn a_backslash_joins_lines_and_a_comment_after_a_face_is_stripped() {
    let text = square_and("f 1 \\\n2 3 # why not\nf 1 3 \\ # here\r\n4\n");
    let mesh = load(text).unwrap().mesh;
    assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn line_numbers_count_through_continuations_and_all_line_ends() {
    let text = "v 0 0 0\r\nv 1 0 \\\r\n 0\r\n\r\nv 0 1 0\rf 1 2 9\r\n";
    assert!(message(text).starts_with("a.obj:6: a face names vertex 9"));
}

#[test]
fn colours_on_some_vertices_only_are_ignored() {
    let text = "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 1 1\nf 1 2 3";
    assert_eq!(load(text).unwrap().mesh.corners(0)[2], Vec3::Y);
}

#[test]
fn a_weight_is_ignored_and_said_so_unless_it_is_one() {
    let scene = load("v 2 2 2 2\nv 1 0 0 1\nv 0 1 0 1.0\nf 1 2 3").unwrap();
    assert_eq!(scene.mesh.corners(0)[0], Vec3::splat(2.0));
    assert_eq!(
        scene.warnings,
        ["1 vertices have a weight other than 1, which is ignored."]
    );
}

#[test]
fn index_zero_and_indices_out_of_range_are_errors_with_path_and_line() {
    let cases = [
        (
            "f 1 2 0",
            "a.obj:5: a face names vertex 0, but OBJ counts vertices from 1",
        ),
        (
            "f 1 2 5",
            "a.obj:5: a face names vertex 5, but the file has only 4",
        ),
        (
            "f 1 2 -5",
            "a.obj:5: a face names vertex -5, but only 4 stand above it",
        ),
    ];
    for (face, expected) in cases {
        assert_eq!(message(square_and(face)), expected);
    }
    for odd in [
        "f 1 2 99999999999999999999",
        "f 1 2 x",
        "f 1 2 3/x",
        "f 1 2 3/1/1/1",
        "f 1 2 /3",
    ] {
        let message = message(square_and(odd));
        assert!(message.starts_with("a.obj:5: '"), "{message}");
    }
}

#[test]
fn a_face_may_stand_before_its_vertices() {
    let mesh = load(format!("f 1 2 3\n{SQUARE}")).unwrap().mesh;
    assert_eq!(mesh.corners(0)[2], Vec3::new(1.0, 1.0, 0.0));
}

#[test]
fn a_bare_face_is_an_error_and_shorter_ones_are_ignored_with_a_count() {
    assert_eq!(
        message(square_and("f\n")),
        "a.obj:5: a face needs three corners or more"
    );
    let scene = load(square_and("f 1 2\nf 1 2 3\nf 3\n")).unwrap();
    assert_eq!(scene.mesh.triangles(), [[0, 1, 2]]);
    assert_eq!(
        scene.warnings,
        ["2 faces of one or two corners are ignored."]
    );
}

#[test]
fn a_file_without_faces_says_that_it_has_no_triangles() {
    for text in ["", SQUARE, "hello\nworld\n", "v 0 0 0\nf 1 1\n", "\n\n#\n"] {
        assert!(message(text).contains("has no triangles"), "{text:?}");
    }
}

#[test]
fn vertices_of_groups_are_welded_by_their_coordinates() {
    let text = "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no b\nv -0 0 0\nv 1 0 0\nv 0 0 1\ng c\nf 4 5 6\nf -3 2 6";
    let mesh = load(text).unwrap().mesh;
    assert_eq!(mesh.vertices().len(), 4);
    assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 1, 3], [0, 1, 3]]);
}

#[test]
fn vertices_that_no_face_uses_do_not_enlarge_the_box() {
    let mesh = load(square_and("v 1000 1000 1000\nf 1 2 3")).unwrap().mesh;
    assert_eq!(mesh.bounds().max, Vec3::new(1.0, 1.0, 0.0));
}

#[test]
fn triangles_without_area_stay_in_and_are_counted() {
    let scene = load(square_and("f 1 1 1\nf 1 2 3\nf 1 2 2\nf 1 1 2 3\n")).unwrap();
    assert_eq!(scene.mesh.len(), 5);
    assert_eq!(
        scene.warnings,
        ["3 triangles have no area; they stay in, and no ray hits them."]
    );
}

#[test]
fn packed_and_binary_files_are_refused_with_what_to_do() {
    let cases: [(&[u8], &str); 4] = [
        (b"\xfd7zXZ\0\0", "'a.obj' is packed by xz; unpack it first"),
        (
            b"\x1f\x8b\x08",
            "'a.obj' is packed by gzip; unpack it first",
        ),
        (
            b"v 1 2 3\n\0\0",
            "'a.obj' is not text: line 2 holds a zero byte",
        ),
        (
            b"\xff\xfev\0",
            "'a.obj' is text in UTF-16; save it as UTF-8",
        ),
    ];
    for (bytes, expected) in cases {
        let message = message(bytes);
        assert!(message.starts_with(expected), "{message}");
    }
}

#[test]
fn polygons_keep_file_order_and_their_materials() {
    let library = |name: &str| match name {
        "a.mtl" => Ok(b"newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n".to_vec()),
        _ => Err(io::ErrorKind::NotFound.into()),
    };
    let text = square_and(
        "f 1 2 3\nmtllib a.mtl\nusemtl red\nf 1 2 3 4\nusemtl blue\nusemtl none\nf 1 2 3\nusemtl blue\nf 4 3 2\nusemtl\nf 1 2 3",
    );
    let scene = read(text.as_bytes(), Path::new("a.obj"), &library).unwrap();
    let names: Vec<&str> = (0..6)
        .map(|prim| scene.material(prim).name.as_str())
        .collect();
    assert_eq!(
        names,
        ["default", "red", "red", "default", "blue", "default"]
    );
    assert_eq!(
        scene.warnings,
        ["No library has the material 'none'; the default is used."]
    );
}

#[test]
fn a_missing_library_is_a_warning_and_costs_only_its_materials() {
    let scene = load(square_and("mtllib gone.mtl\nusemtl x\nf 1 2 3")).unwrap();
    assert_eq!(scene.material(0), &Material::default());
    assert_eq!(
        scene.warnings,
        [
            "a.obj:5: the material library 'gone.mtl' is not there; its materials are the default.",
            "No library has the material 'x'; the default is used.",
        ]
    );
}

#[test]
fn one_mtllib_may_name_several_libraries_and_names_may_hold_spaces() {
    let library = |name: &str| match name {
        "a.mtl" => Ok(b"newmtl a\nKd 1 0 0\n".to_vec()),
        "b c.mtl" => Ok(b"newmtl b\nKd 0 1 0\n".to_vec()),
        _ => Err(io::ErrorKind::NotFound.into()),
    };
    for libraries in ["a.mtl b c.mtl", "b c.mtl a.mtl", "a.mtl\nmtllib b c.mtl"] {
        let text = square_and(&format!(
            "mtllib {libraries}\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3"
        ));
        let scene = read(text.as_bytes(), Path::new("a.obj"), &library).unwrap();
        assert_eq!(scene.material(0).diffuse, Vec3::X, "{libraries}");
        assert_eq!(scene.material(1).diffuse, Vec3::Y, "{libraries}");
        assert_eq!(scene.warnings, [""; 0]);
    }
}

#[test]
fn thousands_of_warnings_are_cut_short() {
    let library = |_: &str| Ok(b"newmtl a\nKd 1\n".repeat(1000));
    let text = square_and("mtllib a.mtl\nf 1 2 3");
    let scene = read(text.as_bytes(), Path::new("a.obj"), &library).unwrap();
    assert_eq!(scene.warnings.len(), MAX_WARNINGS + 1);
    assert!(scene.warnings[MAX_WARNINGS].starts_with("980 more"));
}

#[test]
fn files_that_are_not_there_and_folders_are_errors_that_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let missing = load_file(&folder.path().join("gone.obj")).unwrap_err();
    assert!(missing.to_string().contains("there is no such file"));
    let not_a_file = load_file(folder.path()).unwrap_err();
    assert!(not_a_file.to_string().contains("it is a folder"));
}

#[test]
fn a_file_finds_the_libraries_beside_it_in_either_notation() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    std::fs::write(folder.path().join("sub/m.mtl"), "newmtl a\nKd 1 0 0\n").unwrap();
    let path = folder.path().join("mesh.OBJ");
    std::fs::write(&path, square_and("mtllib sub\\m.mtl\nusemtl a\nf 1 2 3")).unwrap();
    let scene = load_file(&path).unwrap();
    assert_eq!(scene.material(0).diffuse, Vec3::X);
    assert_eq!(scene.warnings, [""; 0]);
}

/// Words that OBJ files are made of, and some that they should not be.
fn near_obj() -> impl Strategy<Value = String> {
    let word = prop_oneof![
        3 => prop::sample::select(vec!["v", "f", "\nv", "\nf", "vn", "l", "o", "g", "usemtl", "mtllib", "s", "#", "\\", "\\\n"]),
        3 => prop::sample::select(vec!["\n", "\r\n", "\r", " ", "\t", "\x0b", "\u{feff}", "/", "//", "\u{85}"]),
        5 => prop::sample::select(vec!["0", "1", "2", "3", "4", "-1", "-2", "1/2/3", "1//2", "1e39", "nan", "-0.0", "1e-46", "x"]),
    ];
    prop::collection::vec(word, 0..80).prop_map(|words| words.join(" "))
}

proptest! {
    #[test]
    fn no_bytes_make_the_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read(&bytes[..], Path::new("a.obj"), &|_| Ok(bytes.clone()));
        let _ = mtl::read(&bytes, Path::new("a.mtl"), &mut Vec::new());
    }

    #[test]
    fn no_near_obj_text_makes_the_reader_panic_and_what_it_reads_is_whole(text in near_obj()) {
        if let Ok(scene) = load(format!("{SQUARE}{text}")) {
            prop_assert_eq!(scene.material_of.len(), scene.mesh.len());
            prop_assert!(!scene.mesh.is_empty());
        }
    }

    #[test]
    fn no_near_mtl_text_makes_the_reader_panic(
        words in prop::collection::vec(
            prop::sample::select(vec![
                "newmtl a", "Kd", "Ks", "Ke", "Tf", "Tr", "d", "-halo", "Ns", "Ni", "illum", "map_Kd", "bump", "\n", "\n",
                "1", "0.5", "-1", "nan", "1e400", "xyz", "spectral", "\\\n", "#", "\u{85}", "newmtl \u{a0}",
            ]),
            0..60,
        )
    ) {
        let text = words.join(" ");
        let _ = mtl::read(text.as_bytes(), Path::new("a.mtl"), &mut Vec::new());
    }

    #[test]
    fn any_polygon_of_n_corners_gives_n_less_2_triangles(
        points in prop::collection::vec((-4_i32..4, -4_i32..4, -1_i32..2), 3..12)
    ) {
        use std::fmt::Write as _;
        let mut text = String::new();
        for (x, y, z) in &points {
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
        text.push('f');
        for i in 1..=points.len() {
            write!(text, " {i}").unwrap();
        }
        prop_assert_eq!(load(&text).unwrap().mesh.len(), points.len() - 2);
    }
}
