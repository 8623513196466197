//! `sphereflake:D[,L]`: a sphere with nine children of a third of its radius on it, and so on, over a floor.
//!
//! ```text
//!        ∘∘∘      three children around the pole …
//!      ∘╭───╮∘
//!      ∘│   │∘    … and six on the equator; each child's pole points away from its parent
//!      ∘╰───╯∘
//! ```
//!
//! **Source:** Haines, "Standard Procedural Databases" (1987), `balls`: the nine directions are those from a sphere to
//! its neighbours in the densest packing, less the three below.
//!
//! **Differs:** without L, spheres are cut by their size: those of the deepest level once, each level above once more,
//! so that all triangles are of about one size. With L, all are cut L times.

use super::{Draft, Icosphere, draft::matte, icosphere};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Camera, Light, Scene, SceneEntry, SceneError, Sizes};
use glam::DQuat;

/// The family's row.
pub const ROW: SceneEntry = SceneEntry {
    name: "sphereflake",
    about: "Spheres on spheres over many scales, for which no grid resolution is right everywhere.",
    size: "D[,L]",
    params: &[
        ParamSpec {
            name: "D",
            about: "Generations of spheres after the first.",
            kind: ParamKind::Int { min: 0, max: 6 },
            default: "3",
        },
        ParamSpec {
            name: "L",
            about: "How often every sphere is cut; left out, smaller spheres are cut less.",
            kind: ParamKind::Int { min: 0, max: 6 },
            default: "",
        },
    ],
    example: "sphereflake:1",
    blind: false,
    triangles,
    build,
};

/// Radius of the first sphere, around the origin.
const RADIUS: f64 = 0.5;

/// Cuts of the spheres of generation `g` of `depth`.
fn level(sizes: &Sizes, g: u32) -> u32 {
    sizes.optional(1).map_or(sizes.int(0) - g + 1, |l| l as u32)
}

fn triangles(sizes: &Sizes) -> u64 {
    let spheres = |g| 9_u64.pow(g) * icosphere::triangles(level(sizes, g));
    (0..=sizes.int(0)).map(spheres).sum::<u64>() + 2
}

fn build(sizes: &Sizes) -> Result<Scene, SceneError> {
    let mut draft = Draft::new(Vec3::Z);
    let directions = directions();
    let colours = [
        matte("generation 0", 0.75, 0.60, 0.42),
        matte("generation 1", 0.68, 0.42, 0.30),
        matte("generation 2", 0.40, 0.50, 0.58),
    ];
    // Centre and orientation of each sphere of a generation.
    let mut generation = vec![(DVec3::ZERO, DQuat::IDENTITY)];
    let mut radius = RADIUS;
    for g in 0..=sizes.int(0) {
        let unit = Icosphere::new(level(sizes, g));
        for &(centre, _) in &generation {
            draft.sphere(&unit, centre, radius);
        }
        draft.paint(colours[g as usize % colours.len()].clone());
        if g < sizes.int(0) {
            generation = generation
                .iter()
                .flat_map(|&(centre, turned)| {
                    directions.map(|(direction, turn)| {
                        (
                            centre + turned * direction * (radius * 4.0 / 3.0),
                            turned * turn,
                        )
                    })
                })
                .collect();
        }
        radius /= 3.0;
    }
    draft.floor(6.0, -RADIUS);
    draft.paint(matte("floor", 0.55, 0.55, 0.5));
    draft.lights.push(Light {
        position: Vec3::new(2.6, -2.2, 4.0),
        intensity: Vec3::splat(30.0),
    });
    draft.camera = Some(Camera {
        eye: Vec3::new(1.5, -1.9, 1.25),
        at: Vec3::new(0.0, 0.0, 0.08),
        up: Vec3::Z,
        fov_deg: 40.0,
    });
    draft.finish()
}

/// The nine directions to the children, seen from a sphere whose pole is +z, with the turn that takes the pole there.
fn directions() -> [(DVec3, DQuat); 9] {
    // Neighbours in a layer lie 60° apart; those of the layer above over the gaps, at height √(2/3).
    let (half, side) = (0.5, 0.75_f64.sqrt());
    let (up, out) = ((2.0_f64 / 3.0).sqrt(), (1.0_f64 / 3.0).sqrt());
    let ring = [
        (1.0, 0.0),
        (half, side),
        (-half, side),
        (-1.0, 0.0),
        (-half, -side),
        (half, -side),
    ];
    let crown = [(side, half), (-side, half), (0.0, -1.0)];
    std::array::from_fn(|i| {
        let direction = match i {
            0..6 => DVec3::new(ring[i].0, ring[i].1, 0.0),
            _ => DVec3::new(crown[i - 6].0 * out, crown[i - 6].1 * out, up),
        };
        (direction, DQuat::from_rotation_arc(DVec3::Z, direction))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{check, load};

    #[test]
    fn triangle_counts_are_those_of_the_recipe() {
        let count = |d: f64, l| triangles(&Sizes::of([Some(d), l]));
        assert_eq!(count(3.0, Some(2.0)), 262_402);
        assert_eq!(count(4.0, Some(1.0)), 590_482);
        assert_eq!(count(4.0, None), 928_402);
        assert_eq!(load("sphereflake:2,0").unwrap().mesh.len(), 91 * 20 + 2);
        assert!(check("sphereflake:6,6").unwrap_err().is_usage());
    }

    #[test]
    fn children_touch_their_parent_and_no_sibling() {
        let directions = directions();
        for (i, (a, turn)) in directions.iter().enumerate() {
            assert!((a.length() - 1.0).abs() < 1e-15);
            assert!((*turn * DVec3::Z - *a).length() < 1e-15);
            for (b, _) in &directions[..i] {
                // Centres at 4/3 of the parent's radius, radii of 1/3.
                assert!((*a - *b).length() * 4.0 / 3.0 > 2.0 / 3.0);
            }
        }
    }
}
