//! `city:N`: N×N houses on the ground, the lots ever narrower towards the centre, heights with a long tail.
//!
//! Lots shrink as e^(−3(1 − r)) along each axis, r being the distance from the centre, to a twentieth; heights are
//! Pareto-distributed with exponent 1.2, at most 80 times the lowest.

use super::{Draft, Random, draft::matte, exact};
use crate::geometry::{DVec3, Vec3};
use crate::registry::{ParamKind, ParamSpec};
use crate::scene::{Camera, Light, Scene, SceneEntry, SceneError, Sizes};

/// The family's row.
pub const ROW: SceneEntry = SceneEntry {
    name: "city",
    about: "Houses of uneven density with a few very tall ones, which stretch the box of all.",
    size: "N",
    params: &[ParamSpec {
        name: "N",
        about: "Houses along each side.",
        kind: ParamKind::Int { min: 1, max: 1400 },
        default: "50",
    }],
    example: "city:6",
    blind: false,
    triangles: |sizes| 10 * u64::from(sizes.int(0)).pow(2) + 2,
    build,
};

/// Height of the lowest house, in lots at the rim.
const LOWEST: f64 = 0.03;

fn build(sizes: &Sizes) -> Result<Scene, SceneError> {
    let n = sizes.int(0);
    let mut draft = Draft::new(Vec3::Z);
    let mut random = Random::new(1);
    let borders = borders(n);
    for y in 0..n as usize {
        for x in 0..n as usize {
            let (west, east) = side(&mut random, borders[x], borders[x + 1]);
            let (south, north) = side(&mut random, borders[y], borders[y + 1]);
            let height = height(&mut random);
            house(&mut draft, [west, south], [east, north], height);
        }
    }
    draft.paint(matte("houses", 0.60, 0.57, 0.52));
    let reach = borders[n as usize];
    draft.floor(reach * 1.05, 0.0);
    draft.paint(matte("ground", 0.38, 0.40, 0.36));
    let size = reach as f32;
    draft.lights.push(Light {
        position: Vec3::new(1.6, -0.9, 1.9) * size,
        intensity: Vec3::splat(size * size),
    });
    draft.camera = Some(Camera {
        eye: Vec3::new(0.65, -1.75, 1.05) * size,
        at: Vec3::new(0.0, 0.0, -0.05) * size,
        up: Vec3::Z,
        fov_deg: 42.0,
    });
    draft.finish()
}

/// Where lots begin and end along an axis, from −s to s.
fn borders(n: u32) -> Vec<f64> {
    let width = |i: u32| {
        let place = (f64::from(2 * i + 1) / f64::from(n) - 1.0).abs();
        exact::exp(-3.0 * (1.0 - place))
    };
    let mut borders = vec![0.0];
    let mut end = 0.0;
    for i in 0..n {
        end += width(i);
        borders.push(end);
    }
    borders.iter().map(|b| b - end * 0.5).collect()
}

/// A house's side of 0.3 to 0.9 of its lot, in the middle of it.
fn side(random: &mut Random, from: f64, to: f64) -> (f64, f64) {
    let half = (to - from) * 0.5 * random.between(0.3, 0.9);
    let middle = (from + to) * 0.5;
    (middle - half, middle + half)
}

/// Pareto by inversion: u^(−1/1.2) = u^(−5/6).
fn height(random: &mut Random) -> f64 {
    let u = 1.0 - random.unit();
    let sixth = exact::root(u, 6);
    let tail = 1.0 / (sixth * sixth * sixth * sixth * sixth);
    LOWEST * tail.min(80.0)
}

/// Walls and roof: ten triangles.
fn house(draft: &mut Draft, least: [f64; 2], most: [f64; 2], height: f64) {
    let corners: [u32; 8] = std::array::from_fn(|k| {
        let x = if k & 1 == 0 { least[0] } else { most[0] };
        let y = if k & 2 == 0 { least[1] } else { most[1] };
        draft.vertex(DVec3::new(x, y, if k & 4 == 0 { 0.0 } else { height }))
    });
    // All faces but the first, which lies on the ground.
    for face in &super::draft::CUBOID_FACES[1..] {
        draft.quad(face.map(|k| corners[k]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::load;

    #[test]
    fn a_city_has_ten_triangles_a_house_and_comes_near_900_000() {
        assert_eq!((ROW.triangles)(&Sizes::of([Some(200.0)])), 400_002);
        assert_eq!((ROW.triangles)(&Sizes::of([Some(300.0)])), 900_002);
        assert_eq!(load("city:7").unwrap().mesh.len(), 492);
    }

    #[test]
    fn lots_shrink_towards_the_centre_and_lie_about_it() {
        let borders = borders(101);
        assert!((borders[0] + borders[101]).abs() < 1e-12);
        let width = |i: usize| borders[i + 1] - borders[i];
        assert!(width(50) < 0.06 * width(0) && (width(0) - width(100)).abs() < 1e-12);
    }

    #[test]
    fn heights_have_a_long_tail_that_is_cut() {
        let mut random = Random::new(1);
        let heights: Vec<f64> = (0..20_000).map(|_| height(&mut random) / LOWEST).collect();
        let above = |h: f64| heights.iter().filter(|&&x| x > h).count() as f64 / 20_000.0;
        assert!(heights.iter().all(|h| (1.0..=80.0).contains(h)));
        // P(h > 2) = 2^(−1.2) and P(h > 10) = 10^(−1.2).
        assert!((above(2.0) - 0.435).abs() < 0.02 && (above(10.0) - 0.063).abs() < 0.01);
    }
}
