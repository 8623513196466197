//! `.rays` and `.hits` files, and the ray set `file:PATH`.
//!
//! ```text
//! .rays  per ray  8 × f32   ox oy oz t_min dx dy dz t_max
//! .hits  per ray  u32 f32   triangle (0xFFFFFFFF: miss), t          closest hits
//!                 u32 f32   0 or 1, 0                               occlusion
//! ```
//!
//! All numbers are little-endian. A miss has t = infinity.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::geometry::{Hit, Ray, Vec3};

use super::{Query, RayError, RaySetEntry, Rays};

pub(super) const ENTRY: RaySetEntry = RaySetEntry {
    name: "file",
    about: "All rays of a .rays file, whatever the count.",
    query: Query::Closest,
    argument: "PATH",
    params: &[],
    make: |request| {
        Ok(Rays {
            rays: read_rays(Path::new(request.argument))?,
            warnings: Vec::new(),
        })
    },
};

/// Bytes of a ray in a `.rays` file.
const RAY_BYTES: usize = 32;

/// Reads all rays of a `.rays` file: at least one, all valid.
///
/// # Errors
/// A file that cannot be read, is empty or ends within a ray; a ray that is not valid, with its index.
pub fn read_rays(path: &Path) -> Result<Vec<Ray>, RayError> {
    let bytes = std::fs::read(path).map_err(|why| failed("read", path, &why))?;
    if bytes.is_empty() {
        let path = path.to_owned();
        return Err(RayError::Empty { path });
    }
    if bytes.len() % RAY_BYTES != 0 {
        return Err(RayError::Truncated {
            path: path.to_owned(),
            bytes: bytes.len() as u64,
        });
    }
    let mut rays = Vec::with_capacity(bytes.len() / RAY_BYTES);
    for (record, bytes) in bytes.chunks_exact(RAY_BYTES).enumerate() {
        let ray = ray_of(bytes);
        if let Some(why) = fault(&ray) {
            return Err(RayError::Invalid {
                path: path.to_owned(),
                record,
                why,
            });
        }
        rays.push(ray);
    }
    Ok(rays)
}

/// Writes a `.rays` file.
///
/// # Errors
/// The file cannot be written.
pub fn write_rays(path: &Path, rays: &[Ray]) -> Result<(), RayError> {
    write(path, rays, |ray, out| {
        let [o, d] = [ray.origin, ray.dir];
        for x in [o.x, o.y, o.z, ray.t_min, d.x, d.y, d.z, ray.t_max] {
            out.write_all(&x.to_le_bytes())?;
        }
        Ok(())
    })
}

/// Writes the answers of closest-hit queries as a `.hits` file.
///
/// # Errors
/// The file cannot be written.
pub fn write_hits(path: &Path, hits: &[Hit]) -> Result<(), RayError> {
    write(path, hits, |hit, out| {
        out.write_all(&hit.prim.to_le_bytes())?;
        out.write_all(&hit.t.to_le_bytes())
    })
}

/// Writes the answers of occlusion queries as a `.hits` file.
///
/// # Errors
/// The file cannot be written.
pub fn write_occluded(path: &Path, blocked: &[bool]) -> Result<(), RayError> {
    write(path, blocked, |blocked, out| {
        out.write_all(&u32::from(*blocked).to_le_bytes())?;
        out.write_all(&0_f32.to_le_bytes())
    })
}

fn write<T>(
    path: &Path,
    records: &[T],
    record: impl Fn(&T, &mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), RayError> {
    let all = || {
        let mut out = BufWriter::new(File::create(path)?);
        records.iter().try_for_each(|r| record(r, &mut out))?;
        out.flush()
    };
    all().map_err(|why| failed("write", path, &why))
}

fn failed(action: &'static str, path: &Path, why: &io::Error) -> RayError {
    RayError::File {
        action,
        path: path.to_owned(),
        why: why.to_string(),
    }
}

fn ray_of(bytes: &[u8]) -> Ray {
    let mut x = [0.0; 8];
    for (x, bytes) in x.iter_mut().zip(bytes.chunks_exact(4)) {
        *x = f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    }
    Ray {
        origin: Vec3::new(x[0], x[1], x[2]),
        t_min: x[3],
        dir: Vec3::new(x[4], x[5], x[6]),
        t_max: x[7],
    }
}

/// What makes a ray invalid.
fn fault(ray: &Ray) -> Option<&'static str> {
    if !ray.origin.is_finite() {
        Some("its origin is not finite")
    } else if !ray.dir.is_finite() {
        Some("its direction is not finite")
    } else if ray.dir == Vec3::ZERO {
        Some("its direction is zero")
    } else if ray.t_min.is_nan() || ray.t_max.is_nan() {
        Some("a bound of t is not a number")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::super::{fixture, ray_set};
    use super::*;

    #[test]
    fn rays_come_back_bit_for_bit() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.rays");
        let scene = fixture::room();
        let mut rays = ray_set(&scene, "random", 100, 1).unwrap().rays;
        rays[0].dir.x = -0.0;
        write_rays(&path, &rays).unwrap();
        assert_eq!(std::fs::metadata(&path).unwrap().len(), 3200);
        let spec = format!("file:{}", path.display());
        let read = ray_set(&scene, &spec, 1, 1).unwrap();
        assert_eq!(read.rays, rays);
        assert!(read.rays[0].dir.x.is_sign_negative());
        assert_eq!(read.name, spec);
    }

    #[test]
    fn hits_are_a_triangle_and_a_t_a_record() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.hits");
        let hit = Hit {
            t: 1.5,
            u: 0.0,
            v: 0.0,
            prim: 0x0102_0304,
        };
        write_hits(&path, &[hit, Hit::MISS]).unwrap();
        let expected = [
            4, 3, 2, 1, 0, 0, 0xc0, 0x3f, 255, 255, 255, 255, 0, 0, 0x80, 0x7f,
        ];
        assert_eq!(std::fs::read(&path).unwrap(), expected);
        write_occluded(&path, &[true, false]).unwrap();
        let expected = [1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        assert_eq!(std::fs::read(&path).unwrap(), expected);
    }

    #[test]
    fn files_that_are_not_rays_are_refused_with_the_reason() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("b.rays");
        let why = || read_rays(&path).unwrap_err().to_string();
        assert!(why().starts_with("cannot read "), "{}", why());
        std::fs::write(&path, []).unwrap();
        assert!(why().contains("holds no ray"), "{}", why());
        std::fs::write(&path, [0; 33]).unwrap();
        assert!(
            why().contains("33 bytes are not a multiple of 32"),
            "{}",
            why()
        );
        std::fs::write(&path, [0; 32]).unwrap();
        assert!(why().starts_with("ray 0 of ") && why().contains("direction is zero"));
        let good = Ray::new(Vec3::ZERO, Vec3::X);
        let bad = |change: fn(&mut Ray)| {
            let mut ray = good;
            change(&mut ray);
            write_rays(&path, &[good, ray]).unwrap();
            read_rays(&path).unwrap_err().to_string()
        };
        assert!(bad(|r| r.origin.y = f32::NAN).contains("ray 1 of"));
        assert!(bad(|r| r.dir.z = f32::INFINITY).contains("direction is not finite"));
        assert!(bad(|r| r.t_max = f32::NAN).contains("not a number"));
    }

    #[test]
    fn a_folder_that_does_not_exist_is_named() {
        let path = Path::new("no-such-folder/a.rays");
        let why = write_rays(path, &[]).unwrap_err().to_string();
        assert!(why.starts_with("cannot write no-such-folder"), "{why}");
    }
}
