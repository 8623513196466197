//! `gears:S`: S³ gears, each two concave 144-gons and the 144 quadrilaterals of its rim, over a floor.
//!
//! **Source:** Haines, "Standard Procedural Databases" (1987), `gears`. **Differs:** gears stand apart instead of
//! interlocking, their axes along x, y and z in turns.

use super::{Draft, draft::matte, exact};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::polygon::Cutter;
use crate::scene::{Camera, Light, Scene, SceneEntry, SceneError, Sizes};

/// The family's row.
pub const ROW: SceneEntry = SceneEntry {
    name: "gears",
    about: "Toothed wheels of concave polygons with long thin rims.",
    size: "S",
    params: &[ParamSpec {
        name: "S",
        about: "Gears along each axis.",
        kind: ParamKind::Int { min: 1, max: 40 },
        default: "3",
    }],
    example: "gears:2",
    blind: false,
    triangles: |sizes| 572 * u64::from(sizes.int(0)).pow(3) + 2,
    build,
};

/// Corners of a gear's outline: 36 teeth of four.
const CORNERS: u32 = 144;

fn build(sizes: &Sizes) -> Result<Scene, SceneError> {
    let n = sizes.int(0);
    let mut draft = Draft::new(Vec3::Z);
    let outline = outline();
    let mut cutter = Cutter::new();
    let faces = cutter.cut(&outline).0.to_vec();
    for i in 0..n * n * n {
        let cell = [i % n, i / n % n, i / n / n];
        let centre = DVec3::from_array(cell.map(|c| f64::from(c) - f64::from(n - 1) * 0.5));
        // The axis turns from gear to gear; cyclic exchange of coordinates keeps orientation.
        let axis = cell.iter().sum::<u32>() % 3;
        let place = |p: DVec3| match axis {
            0 => centre + p,
            1 => centre + DVec3::new(p.y, p.z, p.x),
            _ => centre + DVec3::new(p.z, p.x, p.y),
        };
        let bottom = draft.vertices.len() as u32;
        for height in [-0.12, 0.12] {
            for p in &outline {
                draft.vertex(place(*p + DVec3::Z * height));
            }
        }
        let top = bottom + CORNERS;
        draft.triangles.extend(
            faces
                .iter()
                .map(|&[a, b, c]| [a + bottom, c + bottom, b + bottom]),
        );
        draft
            .triangles
            .extend(faces.iter().map(|t| t.map(|i| i + top)));
        for a in 0..CORNERS {
            let b = (a + 1) % CORNERS;
            draft.quad([bottom + a, bottom + b, top + b, top + a]);
        }
    }
    draft.paint(matte("brass", 0.70, 0.55, 0.28));
    let reach = f64::from(n);
    draft.floor(reach, -0.5 * reach - 0.05);
    draft.paint(matte("floor", 0.42, 0.45, 0.48));
    draft.lights.push(Light {
        position: Vec3::new(1.2, -1.0, 2.2) * reach as f32,
        intensity: Vec3::splat(4.0 * (reach * reach) as f32),
    });
    draft.camera = Some(Camera {
        eye: Vec3::new(0.75, -1.55, 1.05) * (n as f32 + 0.4),
        at: Vec3::new(0.0, 0.0, -0.06) * n as f32,
        up: Vec3::Z,
        fov_deg: 38.0,
    });
    draft.finish()
}

/// The gear's outline in z = 0, counter-clockwise: two corners at the foot and two at the tip of each tooth.
fn outline() -> Vec<DVec3> {
    (0..CORNERS)
        .map(|i| {
            let (cos, sin) = exact::turn(i, CORNERS);
            let radius = if i % 4 < 2 { 0.40 } else { 0.48 };
            DVec3::new(cos, sin, 0.0) * radius
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use crate::scene::family::closed;
    use crate::scene::{Mesh, load};

    #[test]
    fn gears_have_the_recipes_triangles_and_are_closed_above_their_floor() {
        let mesh = load("gears:2").unwrap().mesh;
        assert_eq!(mesh.len(), 572 * 8 + 2);
        let gears = mesh.triangles()[..572 * 8].to_vec();
        assert!(closed(&Mesh::new(mesh.vertices().to_vec(), gears).unwrap()));
        assert_eq!(mesh.degenerate(), 0);
    }
}
