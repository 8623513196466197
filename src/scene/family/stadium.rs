//! `stadium:R`: a teapot of length 1 in the middle of a stadium of radius R.
//!
//! ```text
//!  ▔▁                ▁▔
//!    ▔▁            ▁▔      tiers, 64 rings of 256 quadrilaterals
//!      ▔▔▔▔▔▔∩▔▔▔▔▔▔       field, and the pot on it
//! ```
//!
//! All detail lies in one cell of a uniform grid once R is large; two-level grids and trees do not care.

use super::{Draft, draft::matte, exact, teapot};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Camera, Scene, SceneEntry, SceneError, Sizes};

/// The family's row.
pub const ROW: SceneEntry = SceneEntry {
    name: "stadium",
    about: "A teapot in a stadium, where all detail falls into one cell of a grid.",
    size: "R",
    params: &[ParamSpec {
        name: "R",
        about: "Radius of the stadium in lengths of the pot.",
        kind: ParamKind::Float { min: 1.0, max: 1e6 },
        default: "1000",
    }],
    example: "stadium:10",
    blind: false,
    triangles: |_| 65_280 + 32_768,
    build,
};

const ROWS: u32 = 64;
const SEGMENTS: u32 = 256;
/// Quadrilaterals along a patch of the pot.
const POT: u32 = 32;

fn build(sizes: &Sizes) -> Result<Scene, SceneError> {
    let radius = sizes.float(0);
    let mut draft = Draft::new(Vec3::Z);
    let (points, triangles) = teapot::unit_pot(POT);
    draft.vertices = points.iter().map(|p| p.as_vec3()).collect();
    draft.triangles = triangles;
    draft.paint(teapot::glaze());
    let first = draft.vertices.len() as u32;
    for ring in 0..=ROWS {
        let (out, up) = profile(ring, radius);
        for segment in 0..SEGMENTS {
            let (cos, sin) = exact::turn(segment, SEGMENTS);
            draft.vertex(DVec3::new(cos * out, sin * out, up) * radius);
        }
    }
    for ring in 0..ROWS {
        for segment in 0..SEGMENTS {
            let at = |r: u32, s: u32| first + r * SEGMENTS + s % SEGMENTS;
            let (a, b) = (at(ring, segment), at(ring + 1, segment));
            draft.quad([a, b, at(ring + 1, segment + 1), at(ring, segment + 1)]);
        }
        if ring == 0 {
            draft.paint(matte("field", 0.25, 0.42, 0.22));
        }
    }
    draft.paint(matte("tiers", 0.55, 0.53, 0.5));
    draft.camera = Some(Camera {
        eye: Vec3::new(0.55, -1.35, 0.62),
        at: Vec3::new(0.0, 0.0, 0.22),
        up: Vec3::Z,
        fov_deg: 42.0,
    });
    draft.finish()
}

/// Distance from the axis and height of a ring, in radii: first the field, then tread and riser in turns.
fn profile(ring: u32, radius: f64) -> (f64, f64) {
    if ring == 0 {
        // Not the centre itself, where 256 triangles would collapse: a hole under the pot.
        return (0.05 / radius, 0.0);
    }
    let step = f64::from((ring - 1) / 2) / 32.0;
    let tread = f64::from(ring / 2) / 32.0;
    (0.6 + 0.4 * tread, 0.35 * step)
}

#[cfg(test)]
mod tests {
    use crate::scene::load;

    #[test]
    fn the_stadium_grows_with_its_radius_and_the_pot_does_not() {
        for radius in [1.0, 10.0, 1000.0] {
            let mesh = load(&format!("stadium:{radius}")).unwrap().mesh;
            assert_eq!(mesh.len(), 98_048);
            assert!((mesh.bounds().max.x - radius).abs() < 1e-4 * radius);
            assert_eq!(mesh.degenerate(), 0);
            assert!(mesh.triangle_bounds(0).max.abs().max_element() < 0.6);
        }
    }
}
