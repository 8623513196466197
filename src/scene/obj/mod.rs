//! OBJ and MTL files, from bytes to a mesh with materials.
//!
//! ```text
//! bytes ──▶ lines ──▶ clean ──▶ tobj ──▶ weld ──▶ polygon ──▶ Mesh
//!                       │                            ▲
//!                       └──▶ materials ◀── mtl       └ n corners give n − 2 triangles, in file order
//! ```
//!
//! **Source:** Wavefront's description of OBJ and MTL (appendices B1 and B2 of the Advanced Visualizer manual).
//!
//! **Differs:** vertices are welded where their coordinates are equal (−0 becomes 0 first), vertices that no face uses
//! are dropped, normals, texture coordinates, colours, groups, curves, lines and points are left aside. Triangles without
//! area stay in, and [`Scene::warnings`] counts them.

mod clean;
mod lines;
mod mtl;

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;
use std::sync::Arc;

use self::clean::{Clean, Facts};
use self::lines::Failure;
use super::polygon::Cutter;
use super::{BACKGROUND, Camera, Material, Mesh, Scene, SceneError};
use crate::geometry::Vec3;

/// How a material library is opened by the name that stands in the OBJ.
pub type Library<'a> = &'a dyn Fn(&str) -> io::Result<Vec<u8>>;

/// The largest MTL file that is read: far more than all materials that an index could name usefully.
const MAX_LIBRARY: u64 = 64 << 20;

/// How many warnings of one file are kept word for word.
const MAX_WARNINGS: usize = 20;

/// Loads the mesh in `path`, with the materials of the libraries beside it, seen by a camera that frames its box.
///
/// # Errors
/// A file that cannot be read, is no text, has a broken line, or has no triangles.
pub fn load_file(path: &Path) -> Result<Scene, SceneError> {
    check_file(path)?;
    let file = File::open(path).map_err(|e| unreadable(path, &e))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    read(BufReader::with_capacity(1 << 20, file), path, &|name| {
        library_file(folder, name)
    })
}

/// Checks that `path` is there and is no folder.
///
/// # Errors
/// It is not, with what to do.
pub fn check_file(path: &Path) -> Result<(), SceneError> {
    let facts = std::fs::metadata(path).map_err(|e| unreadable(path, &e))?;
    if facts.is_dir() {
        return Err(SceneError::Unreadable {
            path: path.to_owned(),
            reason: "it is a folder; name an .obj file in it".to_owned(),
        });
    }
    Ok(())
}

fn unreadable(path: &Path, error: &io::Error) -> SceneError {
    let reason = match error.kind() {
        io::ErrorKind::NotFound => {
            "there is no such file; check the path, or see 'raylab list scenes' for bundled scenes"
                .to_owned()
        }
        io::ErrorKind::PermissionDenied => "you may not read it; change its permissions".to_owned(),
        _ => error.to_string(),
    };
    SceneError::Unreadable {
        path: path.to_owned(),
        reason,
    }
}

/// The bytes of the library `name` in `folder`; `\` in a name also separates folders, as other systems write it.
fn library_file(folder: &Path, name: &str) -> io::Result<Vec<u8>> {
    let plain = folder.join(name);
    let path = if plain.exists() {
        plain
    } else {
        folder.join(name.replace('\\', "/"))
    };
    // Only plain files: a device or pipe might never end.
    if !std::fs::metadata(&path)?.is_file() {
        return Err(io::Error::other("it is not a plain file"));
    }
    let mut text = Vec::new();
    File::open(path)?.take(MAX_LIBRARY).read_to_end(&mut text)?;
    Ok(text)
}

/// Reads OBJ text; `path` stands in messages and becomes the scene's name.
///
/// # Errors
/// Text that is no OBJ, has a broken line, or has no triangles.
pub fn read(mut text: impl BufRead, path: &Path, library: Library) -> Result<Scene, SceneError> {
    let failed = |failure| error(path, failure);
    refuse_packed(&mut text).map_err(failed)?;
    let mut clean = Clean::new(text);
    // `triangulate` off: polygons come as they are. Groups never reach tobj, so there is one model.
    let loaded = tobj::load_obj_buf(&mut clean, &tobj::LoadOptions::default(), |_| {
        Err(tobj::LoadError::OpenFileFailed)
    });
    let model = match loaded {
        Ok((models, _)) => models.into_iter().next().map(|m| m.mesh),
        Err(e) => return Err(failed(clean.failure(e))),
    };
    let facts = clean.facts;
    facts.check().map_err(failed)?;
    let model = model.filter(|m| !m.indices.is_empty()).ok_or_else(|| {
        failed(Failure::File(format!(
            "has no triangles ({} vertices, no face of three corners or more); export the surface's faces too",
            facts.vertices
        )))
    })?;
    let mut warnings = dropped(&facts);
    let (materials, index_of) = materials(&facts, path, library, &mut warnings);
    let (vertices, corners) = weld(&model.positions, model.indices);
    let cut = cut(&vertices, &corners, &model.face_arities);
    let material_of = material_of(cut.face_of, &facts, &index_of, materials.len() as u32 - 1);
    let mesh = Mesh::new(vertices, cut.triangles)?;
    warnings.extend(doubtful(&mesh, cut.not_covered));
    Ok(Scene {
        name: path.display().to_string(),
        about: format!("A mesh of {} triangles from a file.", mesh.len()),
        materials,
        material_of,
        lights: Vec::new(),
        camera: Camera::framing(mesh.bounds(), Vec3::Y),
        background: BACKGROUND,
        warnings,
        mesh: Arc::new(mesh),
    })
}

fn error(path: &Path, failure: Failure) -> SceneError {
    let path = path.to_owned();
    match failure {
        Failure::Io(e) => unreadable(&path, &e),
        Failure::Text { line, reason } => SceneError::Line { path, line, reason },
        Failure::File(reason) => SceneError::NotAMesh { path, reason },
    }
}

/// Refuses files that are packed or in UTF-16, by their first bytes, with the way to unpack them.
fn refuse_packed(text: &mut impl BufRead) -> Result<(), Failure> {
    const KINDS: [(&[u8], &str); 7] = [
        (
            b"\xfd7zXZ",
            "is packed by xz; unpack it first with 'xz -dk'",
        ),
        (
            b"\x1f\x8b",
            "is packed by gzip; unpack it first with 'gzip -dk'",
        ),
        (
            b"BZh",
            "is packed by bzip2; unpack it first with 'bzip2 -dk'",
        ),
        (
            b"\x28\xb5\x2f\xfd",
            "is packed by zstd; unpack it first with 'zstd -dk'",
        ),
        (
            b"PK\x03\x04",
            "is a zip archive; unpack it first with 'unzip'",
        ),
        (b"\xff\xfe", "is text in UTF-16; save it as UTF-8"),
        (b"\xfe\xff", "is text in UTF-16; save it as UTF-8"),
    ];
    let start = text.fill_buf().map_err(Failure::Io)?;
    match KINDS.iter().find(|(magic, _)| start.starts_with(magic)) {
        Some((_, what)) => Err(Failure::File((*what).to_owned())),
        None => Ok(()),
    }
}

/// Vertices with distinct coordinates, and the corners that name them. −0 becomes 0, so equal means equal bits.
fn weld(positions: &[f32], mut corners: Vec<u32>) -> (Vec<Vec3>, Vec<u32>) {
    let mut vertices = Vec::with_capacity(positions.len() / 3);
    let mut index_of = HashMap::with_capacity(positions.len() / 3);
    let mut welded = Vec::with_capacity(positions.len() / 3);
    for &[x, y, z] in positions.as_chunks::<3>().0 {
        let point = Vec3::new(x, y, z) + Vec3::ZERO;
        let next = vertices.len() as u32;
        welded.push(
            *index_of
                .entry(point.to_array().map(f32::to_bits))
                .or_insert_with(|| {
                    vertices.push(point);
                    next
                }),
        );
    }
    for corner in &mut corners {
        *corner = welded[*corner as usize];
    }
    (vertices, corners)
}

/// Triangles in file order.
struct Cut {
    triangles: Vec<[u32; 3]>,
    /// The face that each triangle is from.
    face_of: Vec<u32>,
    /// Faces that their triangles do not cover.
    not_covered: u64,
}

/// Cuts faces into triangles. `arities` has the number of corners of each face; empty means all have three.
fn cut(vertices: &[Vec3], corners: &[u32], arities: &[u32]) -> Cut {
    let mut all = Cut {
        triangles: Vec::with_capacity(corners.len() / 3),
        face_of: Vec::with_capacity(corners.len() / 3),
        not_covered: 0,
    };
    let mut cutter = Cutter::new();
    let mut points = Vec::new();
    let mut rest = corners;
    let mut face = 0;
    while !rest.is_empty() {
        let arity = arities.get(face as usize).map_or(3, |&n| n as usize);
        let (polygon, after) = rest.split_at(arity.min(rest.len()));
        rest = after;
        if let &[a, b, c] = polygon {
            all.triangles.push([a, b, c]);
        } else {
            points.clear();
            points.extend(polygon.iter().map(|&i| vertices[i as usize].as_dvec3()));
            let (triangles, covered) = cutter.cut(&points);
            let own = triangles.iter().map(|t| t.map(|i| polygon[i as usize]));
            all.triangles.extend(own);
            all.not_covered += u64::from(!covered);
        }
        all.face_of.resize(all.triangles.len(), face);
        face += 1;
    }
    all
}

/// The material of each triangle, in place of its face.
fn material_of(mut face_of: Vec<u32>, facts: &Facts, index_of: &[u32], default: u32) -> Vec<u32> {
    let mut changes = facts.materials.iter().peekable();
    let mut material = default;
    for face in &mut face_of {
        while let Some((_, name)) = changes.next_if(|(from, _)| from <= face) {
            material = name.map_or(default, |n| index_of[n as usize]);
        }
        *face = material;
    }
    face_of
}

/// The materials of all libraries and last the default one; and for each name in `facts` which of them it is.
fn materials(
    facts: &Facts,
    path: &Path,
    library: Library,
    warnings: &mut Vec<String>,
) -> (Vec<Material>, Vec<u32>) {
    let mut materials = Vec::new();
    for (line, names) in &facts.libraries {
        let at = format!("{}:{line}", path.display());
        read_libraries(names, &at, library, warnings, &mut materials);
    }
    let default = materials.len() as u32;
    let by_name: HashMap<&str, u32> = (0..)
        .zip(&materials)
        .map(|(i, m): (u32, &Material)| (m.name.as_str(), i))
        .collect();
    let mut missing = Vec::new();
    let index_of = facts
        .names
        .iter()
        .map(|name| {
            by_name.get(name.as_str()).copied().unwrap_or_else(|| {
                missing.push(format!("'{name}'"));
                default
            })
        })
        .collect();
    limit(warnings);
    if !missing.is_empty() {
        let more = missing.len().saturating_sub(8);
        missing.truncate(8);
        let more = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        warnings.push(format!(
            "No library has the material {}{more}; the default is used.",
            missing.join(", ")
        ));
    }
    materials.push(Material::default());
    (materials, index_of)
}

/// Appends the materials of the libraries that one `mtllib` names: the whole as one name where there is such a file,
/// else several, each ending in `.mtl` where one does, else each a word.
fn read_libraries(
    names: &str,
    at: &str,
    library: Library,
    warnings: &mut Vec<String>,
    materials: &mut Vec<Material>,
) {
    let whole = library(names);
    let split: Vec<(String, io::Result<Vec<u8>>)> = if whole.is_ok() || !names.contains(' ') {
        vec![(names.to_owned(), whole)]
    } else {
        let several = library_names(names);
        several
            .into_iter()
            .map(|n| {
                let text = library(&n);
                (n, text)
            })
            .collect()
    };
    for (name, text) in split {
        match text {
            Ok(text) => materials.extend(mtl::read(&text, Path::new(&name), warnings)),
            Err(e) if e.kind() == io::ErrorKind::NotFound => warnings.push(format!(
                "{at}: the material library '{name}' is not there; its materials are the default."
            )),
            Err(e) => warnings.push(format!(
                "{at}: the material library '{name}' cannot be read ({e}); its materials are the default."
            )),
        }
    }
}

/// Splits `a b.mtl c.mtl` after each word that ends in `.mtl`.
fn library_names(names: &str) -> Vec<String> {
    let mut all = Vec::new();
    let mut name = String::new();
    for word in names.split_inclusive(' ') {
        name.push_str(word);
        if word.trim().to_ascii_lowercase().ends_with(".mtl") {
            all.push(std::mem::take(&mut name).trim().to_owned());
        }
    }
    all.extend(name.split_whitespace().map(str::to_owned));
    all
}

/// Keeps the first warnings and counts the others.
fn limit(warnings: &mut Vec<String>) {
    if warnings.len() > MAX_WARNINGS {
        let more = warnings.len() - MAX_WARNINGS;
        warnings.truncate(MAX_WARNINGS);
        warnings.push(format!("{more} more warnings of this kind."));
    }
}

/// A sentence for each kind of statement that was dropped.
fn dropped(facts: &Facts) -> Vec<String> {
    let kinds = [
        (facts.short_faces, "faces of one or two corners are ignored"),
        (
            facts.lines_and_points,
            "lines and points are ignored; raylab traces triangles",
        ),
        (
            facts.free_forms,
            "free-form curves and surfaces are ignored; export them as polygons",
        ),
        (
            facts.weights,
            "vertices have a weight other than 1, which is ignored",
        ),
    ];
    let said = kinds.iter().filter(|(count, _)| *count > 0);
    said.map(|(count, what)| format!("{count} {what}."))
        .collect()
}

/// A sentence for each kind of triangle that may surprise.
fn doubtful(mesh: &Mesh, not_covered: u64) -> Vec<String> {
    let kinds = [
        (
            not_covered,
            "polygons are so warped that they cross themselves, or lie on a line; they are cut as fans",
        ),
        (
            mesh.degenerate() as u64,
            "triangles have no area; they stay in, and no ray hits them",
        ),
    ];
    let said = kinds.iter().filter(|(count, _)| *count > 0);
    said.map(|(count, what)| format!("{count} {what}."))
        .collect()
}

#[cfg(test)]
mod tests;
