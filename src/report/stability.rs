//! A stability map on the disk: as JSON and as a picture, and each failing cell as a scene and a ray.
//!
//! ```text
//! DIR/stability.json  .svg  .png  -dark.png
//! DIR/failures/README.md                                  a line a failing cell, with the command that steps through it
//! DIR/failures/woop-in-bvh-naive-slab-on-flat-boxes.obj   the least triangles that still fail
//!              …                                .rays     the ray
//! ```

use std::fmt::Write;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::accel;
use crate::geometry::Vec3;
use crate::lab::stability::{Cell, Map, Reproducer, reproduce};
use crate::scene::Mesh;
use crate::trace::files::write_rays;

use super::export::{ExportError, make, put};
use super::plot;

/// Writes `map` into `dir`, which is made where it is missing; returns the files, those of `failures` last. `done` is told
/// how many of how many failures are written, in no particular order.
///
/// # Errors
/// A folder or file that cannot be written.
pub fn write_map(
    map: &Map,
    dir: &Path,
    done: impl Fn(usize, usize) + Sync,
) -> Result<Vec<PathBuf>, ExportError> {
    make(dir)?;
    let json = serde_json::to_string_pretty(map).map_err(|why| ExportError::Write {
        path: dir.join("stability.json").display().to_string(),
        why: why.into(),
    })?;
    let mut files = vec![put(dir, "stability.json", json + "\n")?];
    files.extend(plot::write_map(map, dir)?);

    let failing: Vec<&Cell> = map.cells.iter().filter(|c| c.witness.is_some()).collect();
    if failing.is_empty() {
        return Ok(files);
    }
    let folder = dir.join("failures");
    make(&folder)?;
    let finished = std::sync::atomic::AtomicUsize::new(0);
    let written = failing.par_iter().map(|cell| {
        let least = reproduce(cell, map.seed);
        let one = least
            .map(|least| write_failure(&least, &folder))
            .transpose()?;
        let count = finished.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
        done(count, failing.len());
        Ok(one.map(|one| (*cell, one)))
    });
    let written: Vec<Option<(&Cell, Written)>> = written.collect::<Result<_, ExportError>>()?;
    let written: Vec<_> = written.into_iter().flatten().collect();
    files.push(put(&folder, "README.md", contents(&written))?);
    files.extend(written.into_iter().flat_map(|(_, one)| one.files));
    Ok(files)
}

/// A failure on the disk.
pub struct Written {
    /// The scene and the ray.
    pub files: [PathBuf; 2],
    command: String,
    triangles: usize,
}

/// Writes a failure into `folder`, which is made where it is missing, as an OBJ and a `.rays` file.
///
/// # Errors
/// The folder or a file cannot be written.
pub fn write_failure(least: &Reproducer, folder: &Path) -> Result<Written, ExportError> {
    make(folder)?;
    let stem = stem(least);
    let scene = put(folder, &format!("{stem}.obj"), obj(least))?;
    let rays = folder.join(format!("{stem}.rays"));
    write_rays(&rays, &least.rays).map_err(|why| ExportError::Write {
        path: rays.display().to_string(),
        why: std::io::Error::other(why),
    })?;
    Ok(Written {
        files: [scene, rays],
        command: command(least, &stem),
        triangles: least.mesh.len(),
    })
}

/// The name of a failure's files, without ending: letters, digits, `.` and `-` only.
fn stem(least: &Reproducer) -> String {
    let (kernel, accel) = (label(least).0, label(least).1);
    let text = format!("{kernel}-in-{accel}-on-{}", least.case);
    text.replace(
        |c: char| !(c.is_ascii_alphanumeric() || c == '.' || c == '-'),
        "-",
    )
}

fn label(least: &Reproducer) -> (String, String) {
    let kernel = crate::kernel::entry(&least.kernel).map_or(&[][..], |e| e.params);
    let accel = accel::entry(&least.accel.name).map_or(&[][..], |e| e.params);
    (least.kernel.label(kernel), least.accel.label(accel))
}

/// The command that steps through the failure, run in the folder of its files.
fn command(least: &Reproducer, stem: &str) -> String {
    let (kernel, accel) = label(least);
    let has_n = accel::entry(&least.accel.name).is_ok_and(|e| e.resolution.is_some());
    let n = if has_n {
        format!(" --n {}", least.n)
    } else {
        String::new()
    };
    format!(
        "raylab inspect {stem}.obj --rays-file {stem}.rays --accel {accel}{n} --kernel {kernel}"
    )
}

/// The triangles as an OBJ that reads back bit for bit: three vertices a triangle, in order.
fn obj(least: &Reproducer) -> String {
    let (kernel, accel) = label(least);
    let mut text = format!(
        "# {} of {kernel} in {accel} on {} {}\n",
        least.fault.name(),
        least.case,
        least.rung
    );
    let mesh: &Mesh = &least.mesh;
    for (i, prim) in least.prims.iter().enumerate() {
        for Vec3 { x, y, z } in mesh.corners(i as u32) {
            // The shortest digits that tell the number from all others; writing to a string cannot fail.
            let _ = writeln!(text, "v {x:e} {y:e} {z:e}");
        }
        let first = 3 * i + 1;
        let _ = writeln!(
            text,
            "f {first} {} {} # triangle {prim} of the case",
            first + 1,
            first + 2
        );
    }
    text
}

/// A line a failure.
fn contents(written: &[(&Cell, Written)]) -> String {
    let mut text = "# Failures of the stability suite\n\nEach is the least scene and ray that still fails. Run the \
                    command in this folder.\n\n| fails | first | as | triangles | why | command |\n|---|---|---|---|---|---|\n"
        .to_owned();
    for (cell, one) in written {
        let fault = cell.witness.map_or("", |w| w.fault.name());
        let _ = writeln!(
            text,
            "| {} in {} on {} | {} | {fault} | {} | {} | `{}` |",
            cell.kernel,
            cell.accel,
            cell.case,
            cell.first.as_deref().unwrap_or(""),
            one.triangles,
            cell.reason.as_deref().unwrap_or("not known"),
            one.command,
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel;
    use crate::lab::Control;
    use crate::lab::stability::{StabilityPlan, stability};
    use crate::scene;
    use crate::trace::files::read_rays;

    #[test]
    fn failures_read_back_bit_for_bit_and_the_picture_names_every_case() {
        let plan = StabilityPlan {
            // Tiny and huge numbers, and triangles without area beside them.
            cases: vec!["small-scales", "denormals", "duplicates"],
            kernels: vec![kernel::parse("moller-trumbore").unwrap()],
            accels: vec![accel::parse("bvh").unwrap()],
            ..StabilityPlan::default()
        };
        let map = stability(&plan, &Control::default(), &mut |_| {}).unwrap();
        let dir = tempfile::tempdir().unwrap();
        let files = write_map(&map, dir.path(), |_, _| {}).unwrap();
        assert!(files.iter().all(|f| f.exists()));
        let svg = std::fs::read_to_string(dir.path().join("stability.svg")).unwrap();
        for name in map.cases.iter().copied().chain(["bvh", "moller-trumbore"]) {
            assert!(svg.contains(name), "{name}");
        }
        let mut failures = 0;
        for cell in map.cells.iter().filter(|c| c.witness.is_some()) {
            let least = reproduce(cell, map.seed).unwrap();
            let path = dir.path().join("failures").join(stem(&least));
            let scene = scene::load(&path.with_extension("obj").display().to_string()).unwrap();
            for prim in 0..least.mesh.len() as u32 {
                assert_eq!(scene.mesh.corners(prim), least.mesh.corners(prim));
            }
            let rays = read_rays(&path.with_extension("rays")).unwrap();
            assert_eq!(rays, least.rays);
            failures += 1;
        }
        assert!(failures > 0);
    }
}
