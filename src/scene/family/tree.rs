//! `tree:N`: a tree that forks N times: 2^(N+1) − 1 cones and as many spheres at their ends, over a floor.
//!
//! **Source:** Haines, "Standard Procedural Databases" (1987), `tree`, after Aono and Kunii, "Botanical Tree Image
//! Generation" (1984).

use super::{Draft, Icosphere, draft::matte, rings::cone};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Camera, Light, Scene, SceneEntry, SceneError, Sizes};

/// The family's row.
pub const ROW: SceneEntry = SceneEntry {
    name: "tree",
    about: "A forking tree from a thick trunk to clustered twigs, uneven in size and density.",
    size: "N",
    params: &[ParamSpec {
        name: "N",
        about: "How often branches fork.",
        kind: ParamKind::Int { min: 0, max: 18 },
        default: "8",
    }],
    example: "tree:4",
    blind: false,
    triangles: |sizes| 44 * ((2_u64 << sizes.int(0)) - 1) + 2,
    build,
};

/// A branch: where it starts, where it goes, with its length, and how thick it is.
#[derive(Clone, Copy)]
struct Branch {
    from: DVec3,
    along: DVec3,
    radius: f64,
}

/// What a branch's children keep of its length and thickness.
const SHRINK: f64 = 0.78;
const THIN: f64 = 0.68;

fn build(sizes: &Sizes) -> Result<Scene, SceneError> {
    let mut draft = Draft::new(Vec3::Z);
    let unit = Icosphere::new(0);
    let trunk = Branch {
        from: DVec3::ZERO,
        along: DVec3::Z,
        radius: 0.11,
    };
    let mut level = vec![trunk];
    for generation in 0..=sizes.int(0) {
        for branch in &level {
            let end = branch.from + branch.along;
            let thin = branch.radius * THIN;
            cone(&mut draft, [(branch.from, branch.radius), (end, thin)], 12);
            draft.sphere(&unit, end, thin);
        }
        if generation < sizes.int(0) {
            level = level.iter().flat_map(|b| forks(*b, generation)).collect();
        }
    }
    draft.paint(matte("bark", 0.42, 0.34, 0.24));
    draft.floor(3.2, 0.0);
    draft.paint(matte("ground", 0.36, 0.42, 0.28));
    draft.lights.push(Light {
        position: Vec3::new(4.0, -3.0, 8.0),
        intensity: Vec3::splat(80.0),
    });
    draft.camera = Some(Camera {
        eye: Vec3::new(2.2, -6.4, 2.9),
        at: Vec3::new(0.0, 0.0, 1.65),
        up: Vec3::Z,
        fov_deg: 38.0,
    });
    draft.finish()
}

/// The two branches at the end of one, to either side in a plane that turns from fork to fork.
fn forks(branch: Branch, generation: u32) -> [Branch; 2] {
    let axis = branch.along.normalize_or(DVec3::Z);
    let (u, v) = axis.any_orthonormal_pair();
    // Three planes in turns, 60° apart, so that no two generations fork in the same one.
    let aside = match generation % 3 {
        0 => u,
        1 => u * 0.5 + v * 0.75_f64.sqrt(),
        _ => u * -0.5 + v * 0.75_f64.sqrt(),
    };
    let length = branch.along.length() * SHRINK;
    // 30° to one side, 25° to the other: tangents 0.577 and 0.466.
    [0.577, -0.466].map(|tangent| Branch {
        from: branch.from + branch.along,
        along: (axis + aside * tangent).normalize_or(axis) * length,
        radius: branch.radius * THIN,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::load;

    #[test]
    fn a_tree_of_eleven_forks_has_the_recipes_triangles() {
        assert_eq!((ROW.triangles)(&Sizes::of([Some(11.0)])), 180_182);
        let mesh = load("tree:5").unwrap().mesh;
        assert_eq!(mesh.len(), 44 * 63 + 2);
        assert!(mesh.bounds().max.z > 2.5);
    }
}
