//! `cluster:K`, `duplicates:M` and `axis-line`: triangles that no builder can separate, or no ray can hit.

use super::{Draft, Random, draft::matte};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Scene, SceneEntry, SceneError, Sizes};

/// Ever smaller triangles towards a point.
pub const CLUSTER: SceneEntry = SceneEntry {
    name: "cluster",
    about: "Triangles that halve in size towards a point, which tests depth limits and tiny numbers.",
    size: "K",
    params: &[ParamSpec {
        name: "K",
        about: "Halvings; beyond 126 the smallest are denormal numbers.",
        kind: ParamKind::Int { min: 0, max: 145 },
        default: "60",
    }],
    example: "cluster:20",
    blind: false,
    triangles: |sizes| COPIES * u64::from(sizes.int(0) + 1),
    build: cluster,
};

/// One triangle again and again.
pub const DUPLICATES: SceneEntry = SceneEntry {
    name: "duplicates",
    about: "The same triangle many times, every second time reversed, which no plane can split.",
    size: "M",
    params: &[ParamSpec {
        name: "M",
        about: "Triangles.",
        kind: ParamKind::Int {
            min: 1,
            max: 20_000_000,
        },
        default: "10000",
    }],
    example: "duplicates:50",
    blind: false,
    triangles: |sizes| u64::from(sizes.int(0)),
    build: duplicates,
};

/// Triangles without area.
pub const AXIS_LINE: SceneEntry = SceneEntry {
    name: "axis-line",
    about: "Triangles without area on the x axis, in a box of two zero extents, that no ray hits.",
    size: "",
    params: &[],
    example: "axis-line",
    blind: true,
    triangles: |_| 100,
    build: axis_line,
};

/// Jittered copies of each triangle of a cluster.
const COPIES: u64 = 500;

fn cluster(sizes: &Sizes) -> Result<Scene, SceneError> {
    let mut draft = Draft::new(Vec3::Y);
    let mut random = Random::new(1);
    let mut size = 1.0;
    for _ in 0..=sizes.int(0) {
        for _ in 0..COPIES {
            let at = DVec3::X * size + random.cube(-0.5, 0.5) * size;
            draft.triangle([at, at + DVec3::X * size, at + DVec3::Y * size]);
        }
        size *= 0.5;
    }
    draft.paint(matte("cluster", 0.64, 0.56, 0.40));
    draft.finish()
}

fn duplicates(sizes: &Sizes) -> Result<Scene, SceneError> {
    let mut draft = Draft::new(Vec3::Y);
    let corners = [(-1.0, -0.6), (1.0, -0.6), (0.0, 1.0)];
    let [a, b, c] = corners.map(|(x, y)| draft.vertex(DVec3::new(x, y, 0.0)));
    let turned = [[a, b, c], [a, c, b]];
    let all = turned.into_iter().cycle().take(sizes.int(0) as usize);
    draft.triangles.extend(all);
    draft.paint(matte("duplicates", 0.5, 0.6, 0.7));
    draft.finish()
}

fn axis_line(_: &Sizes) -> Result<Scene, SceneError> {
    let mut draft = Draft::new(Vec3::Y);
    for i in 0..100 {
        let x = f64::from(i) / 100.0;
        draft.triangle([x, x + 0.01, x + 0.005].map(|x| DVec3::new(x, 0.0, 0.0)));
    }
    draft.finish()
}

#[cfg(test)]
mod tests {
    use crate::geometry::Vec3;
    use crate::scene::load;

    #[test]
    fn clusters_halve_to_denormal_numbers_without_losing_triangles() {
        assert_eq!(load("cluster:60").unwrap().mesh.len(), 30_500);
        let mesh = load("cluster:145").unwrap().mesh;
        let smallest = mesh.triangle_bounds(mesh.len() as u32 - 1).extent();
        assert!(smallest.x > 0.0 && smallest.x < f32::MIN_POSITIVE);
    }

    #[test]
    fn duplicates_are_the_same_triangle_and_its_reverse() {
        let mesh = load("duplicates:5").unwrap().mesh;
        assert_eq!(
            mesh.triangles(),
            [[0, 1, 2], [0, 2, 1], [0, 1, 2], [0, 2, 1], [0, 1, 2]]
        );
    }

    #[test]
    fn the_axis_line_has_no_area_and_two_zero_extents() {
        let mesh = load("axis-line").unwrap().mesh;
        assert_eq!(mesh.degenerate(), 100);
        assert_eq!(mesh.bounds().extent(), Vec3::new(1.0, 0.0, 0.0));
    }
}
