//! `menger:L`: Menger's sponge of L generations in the unit cube: two triangles for each face of a small cube that is
//! seen from outside.
//!
//! A cube is taken out where two or more of its coordinates have a 1 at the same place in base 3. Coordinates are
//! multiples of 3^−L, rounded: faces of one plane share it bit for bit.

use super::{
    Draft,
    draft::{CUBOID_FACES, matte},
};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Scene, SceneEntry, SceneError, Sizes};

/// The family's row.
pub const ROW: SceneEntry = SceneEntry {
    name: "menger",
    about: "Menger's sponge, watertight, with faces in cell planes and rays that run far inside.",
    size: "L",
    params: &[ParamSpec {
        name: "L",
        about: "Generations.",
        kind: ParamKind::Int { min: 1, max: 5 },
        default: "3",
    }],
    example: "menger:2",
    blind: false,
    triangles: |sizes| 2 * (2 * 20_u64.pow(sizes.int(0)) + 4 * 8_u64.pow(sizes.int(0))),
    build,
};

fn build(sizes: &Sizes) -> Result<Scene, SceneError> {
    let n = 3_u32.pow(sizes.int(0));
    let mut draft = Draft::new(Vec3::Z);
    // Index of each lattice point's vertex, once it has one.
    let side = n + 1;
    let mut index = vec![u32::MAX; (side * side * side) as usize];
    for i in 0..n * n * n {
        let cube = [i % n, i / n % n, i / n / n];
        if !is_solid(cube) {
            continue;
        }
        for (face, corners) in CUBOID_FACES.iter().enumerate() {
            if neighbour(cube, face, n).is_some_and(is_solid) {
                continue;
            }
            let corners = corners.map(|k| {
                let [x, y, z] = [0, 1, 2].map(|a| cube[a] + (k as u32 >> a & 1));
                let slot = (z * side * side + y * side + x) as usize;
                if index[slot] == u32::MAX {
                    let place = |i: u32| f64::from(i) / f64::from(n);
                    index[slot] = draft.vertex(DVec3::new(place(x), place(y), place(z)));
                }
                index[slot]
            });
            draft.quad(corners);
        }
    }
    draft.paint(matte("sponge", 0.70, 0.60, 0.42));
    draft.finish()
}

/// Whether the sponge keeps a small cube.
fn is_solid(mut cube: [u32; 3]) -> bool {
    while cube.iter().any(|&c| c > 0) {
        if cube.iter().filter(|&&c| c % 3 == 1).count() >= 2 {
            return false;
        }
        cube = cube.map(|c| c / 3);
    }
    true
}

/// The cube on the other side of a face of [`CUBOID_FACES`]; `None` outside.
fn neighbour(mut cube: [u32; 3], face: usize, n: u32) -> Option<[u32; 3]> {
    // Faces come in the order −z, +z, −y, +y, −x, +x.
    let axis = 2 - face / 2;
    let moved = if face.is_multiple_of(2) {
        cube[axis].checked_sub(1)
    } else {
        Some(cube[axis] + 1)
    };
    cube[axis] = moved.filter(|&c| c < n)?;
    Some(cube)
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use crate::scene::load;

    #[test]
    fn exposed_faces_are_those_of_the_formula() {
        for (level, triangles) in [(1, 144), (2, 2_112), (3, 36_096)] {
            assert_eq!(
                load(&format!("menger:{level}")).unwrap().mesh.len(),
                triangles
            );
        }
    }

    #[test]
    fn every_edge_is_used_as_often_in_either_direction() {
        let mesh = load("menger:2").unwrap().mesh;
        let mut balance = HashMap::new();
        for t in mesh.triangles() {
            for i in 0..3 {
                let (a, b) = (t[i], t[(i + 1) % 3]);
                *balance.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
            }
        }
        assert!(balance.values().all(|&sum| sum == 0));
    }
}
