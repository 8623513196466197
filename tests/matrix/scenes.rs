//! Scenes of the matrix: the registry's own examples, and meshes each of which is a known trap.

use std::sync::Arc;

use raylab::geometry::Vec3;
use raylab::scene::{self, Mesh, SCENES};

use crate::rays::Dice;
use crate::setting::Setting;

/// Examples with more triangles than this would make brute force the longest part of the matrix.
const MOST_TRIANGLES: usize = 5_000;

/// Resolutions beside the predicted one.
const FEW: &[u32] = &[1, 8];

/// The finest: only for tiny meshes, as the cells take half a gigabyte.
const FINEST: &[u32] = &[1, 512];

/// Resolutions of the random soups, one row a soup.
const ANY: [&[u32]; 6] = [&[2, 23], &[3, 31], &[6, 13], &[7, 40], &[9, 19], &[11, 64]];

type Triangles = Vec<[Vec3; 3]>;

/// All scenes.
pub fn all() -> Vec<Setting> {
    let examples = SCENES.iter().filter_map(|row| {
        let mesh = scene::load(row.example).ok()?.mesh;
        (mesh.len() <= MOST_TRIANGLES).then(|| Setting::new(row.example, mesh, true, FEW))
    });
    let own = nasty()
        .into_iter()
        .map(|(name, triangles, ordinary)| Setting::new(name, mesh(&triangles), ordinary, FEW));
    let finest = [
        ("one-triangle", scaled(&ball(1), 1.0)[..1].to_vec()),
        ("small", ball(2)),
    ]
    .into_iter()
    .map(|(name, triangles)| Setting::new(name, mesh(&triangles), true, FINEST));
    let random = (0..).zip(ANY).map(|(seed, resolutions)| {
        let name = format!("random-soup-{seed}");
        Setting::new(&name, mesh(&stretched_soup(seed)), true, resolutions)
    });
    examples.chain(own).chain(random).chain(finest).collect()
}

/// A mesh of triangles given by corners.
pub fn mesh(triangles: &[[Vec3; 3]]) -> Arc<Mesh> {
    let vertices = triangles.iter().flatten().copied().collect();
    let indices = (0..triangles.len() as u32)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    Arc::new(Mesh::new(vertices, indices).expect("coordinates are finite"))
}

fn moved(triangles: &[[Vec3; 3]], by: Vec3) -> Triangles {
    triangles.iter().map(|t| t.map(|p| p + by)).collect()
}

fn scaled(triangles: &[[Vec3; 3]], by: f32) -> Triangles {
    triangles.iter().map(|t| t.map(|p| p * by)).collect()
}

/// Random triangles of a size in the cube from -1 to 1.
fn soup(count: u32, size: f32, seed: u64) -> Triangles {
    let mut dice = Dice::new(seed);
    (0..count)
        .map(|_| {
            let centre = dice.vector();
            [0; 3].map(|_| centre + size * dice.vector())
        })
        .collect()
}

/// A soup of random number and size of triangles, moved and stretched along each axis.
fn stretched_soup(seed: u64) -> Triangles {
    let mut dice = Dice::new(100 + seed);
    let (count, size) = (1 + dice.below(400), dice.signed().abs().powi(3));
    let (stretch, by) = (
        dice.vector() * dice.of(&[0.1, 1.0, 30.0]),
        dice.vector() * 5.0,
    );
    soup(count, size, seed)
        .into_iter()
        .map(|t| t.map(|p| p * stretch + by))
        .collect()
}

/// A closed ball: an octahedron whose faces are cut into n² parts and pushed outwards. 8·n² triangles.
fn ball(n: u32) -> Triangles {
    let mut triangles = Vec::new();
    for octant in 0..8u32 {
        let sign = |bit: u32| if octant >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let point = |i: u32, j: u32| {
            let parts = [i, j, n - i - j].map(|k| k as f32);
            (Vec3::from(parts) * Vec3::new(sign(0), sign(1), sign(2))).normalize()
        };
        for i in 0..n {
            for j in 0..n - i {
                triangles.push([point(i, j), point(i + 1, j), point(i, j + 1)]);
                if i + j + 1 < n {
                    triangles.push([point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
                }
            }
        }
    }
    triangles
}

/// Squares of two triangles on the planes x, y, z = 0..n: everything lies on cell faces and along axes.
fn lattice(n: u32) -> Triangles {
    let mut triangles = Vec::new();
    for cell in 0..n * n * n {
        let corner = Vec3::new(
            (cell % n) as f32,
            (cell / n % n) as f32,
            (cell / n / n) as f32,
        );
        for [u, v] in [[Vec3::X, Vec3::Y], [Vec3::Y, Vec3::Z], [Vec3::Z, Vec3::X]] {
            triangles.push([corner, corner + u, corner + u + v]);
            triangles.push([corner, corner + u + v, corner + v]);
        }
    }
    triangles
}

/// Meshes by name, and whether they are of ordinary scale.
fn nasty() -> Vec<(&'static str, Triangles, bool)> {
    vec![
        ("ball", ball(8), true),
        (
            "lattice-in-8-cells",
            [lattice(4), moved(&lattice(1), Vec3::splat(7.0))].concat(),
            true,
        ),
        ("flat-x", flat(0), true),
        ("flat-y", flat(1), true),
        ("flat-tilted", tilted(), true),
        ("giant-among-small", giant(), true),
        ("duplicates", duplicates(), true),
        ("coplanar", coplanar(), true),
        ("without-area", without_area(), true),
        (
            "only-without-area",
            vec![[Vec3::ZERO, Vec3::X, Vec3::X * 0.5]; 60],
            true,
        ),
        ("one-point", vec![[Vec3::ONE; 3]; 30], true),
        ("needles", needles(1e-3), true),
        ("slivers", needles(1e-6), true),
        ("same-centre", same_centre(), true),
        ("fan", fan(), true),
        ("halving", halving(24), true),
        ("halving-to-the-end", halving(120), false),
        (
            "outlier",
            [ball(6), moved(&ball(1), Vec3::X * 1e4)].concat(),
            true,
        ),
        (
            "a-million-away",
            moved(&scaled(&ball(6), 16.0), Vec3::splat(1e6)),
            false,
        ),
        (
            "lattice-a-million-away",
            moved(&lattice(4), Vec3::new(1e6, -1e6, 1e6)),
            false,
        ),
        ("tiny", scaled(&ball(6), 1e-6), false),
        ("subnormal", scaled(&ball(3), 1e-39), false),
        ("huge", scaled(&ball(6), 1e9), false),
        ("enormous", scaled(&ball(6), 1e30), false),
    ]
}

/// A square of triangles in a plane across an axis, away from the origin.
fn flat(axis: usize) -> Triangles {
    let place = |x: u32, y: u32| {
        let mut p = [0.3, x as f32 * 0.1, y as f32 * 0.1];
        p.rotate_right(axis);
        Vec3::from(p)
    };
    (0..64)
        .flat_map(|k| {
            let (x, y) = (k % 8, k / 8);
            let [a, b, c, d] = [
                place(x, y),
                place(x + 1, y),
                place(x + 1, y + 1),
                place(x, y + 1),
            ];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// A flat square in a plane across no axis.
fn tilted() -> Triangles {
    let turn = |p: Vec3| Vec3::new(p.y + 0.25 * p.z, p.z, p.y - 0.5 * p.z);
    flat(0).into_iter().map(|t| t.map(turn)).collect()
}

fn giant() -> Triangles {
    let giant = [
        Vec3::new(-500.0, -400.0, -0.3),
        Vec3::new(700.0, -300.0, 0.1),
        Vec3::new(0.0, 900.0, 0.2),
    ];
    [soup(300, 0.05, 2), vec![giant]].concat()
}

/// One triangle many times, wound both ways, each starting at each corner.
fn duplicates() -> Triangles {
    let [a, b, c] = [
        Vec3::new(-0.5, -0.5, 0.25),
        Vec3::new(0.5, -0.25, 0.25),
        Vec3::new(0.0, 0.5, 0.5),
    ];
    [[a, b, c], [a, c, b], [b, c, a], [c, b, a]].repeat(75)
}

/// Triangles that overlap in one plane, with corners on a coarse raster: many ties.
fn coplanar() -> Triangles {
    let mut dice = Dice::new(3);
    let mut corner = || {
        Vec3::new(
            dice.below(9) as f32 * 0.25,
            dice.below(9) as f32 * 0.25,
            0.5,
        )
    };
    (0..80).map(|_| [corner(), corner(), corner()]).collect()
}

/// A soup in which every third triangle is a line or a point.
fn without_area() -> Triangles {
    let mut triangles = soup(240, 0.3, 4);
    for (i, [a, b, c]) in triangles.iter_mut().enumerate() {
        match i % 6 {
            0 => *c = *b,
            3 => (*b, *c) = (*a, *a),
            _ => {}
        }
    }
    triangles
}

/// Long triangles of a width.
fn needles(width: f32) -> Triangles {
    let mut dice = Dice::new(5);
    (0..300)
        .map(|_| {
            let (start, along) = (dice.vector(), dice.vector());
            [
                start,
                start + along,
                start + along * 0.5 + dice.vector() * width,
            ]
        })
        .collect()
}

/// Triangles whose boxes have one centre, which no split by centres can part.
fn same_centre() -> Triangles {
    let mut dice = Dice::new(6);
    (0..300)
        .map(|_| {
            let arm = dice.vector();
            [arm, -arm, arm * dice.vector()]
        })
        .collect()
}

/// Many triangles around one vertex.
fn fan() -> Triangles {
    let rim = |i: u32| {
        let angle = i as f32 * std::f32::consts::TAU / 200.0;
        Vec3::new(angle.cos(), angle.sin(), 0.1 * (i % 2) as f32)
    };
    (0..200)
        .map(|i| [Vec3::ZERO, rim(i), rim((i + 1) % 200)])
        .collect()
}

/// Each half of the rest holds one triangle: splits that halve space peel off one at a time.
fn halving(count: i32) -> Triangles {
    (0..count)
        .map(|i| {
            let x = 0.5_f32.powi(i);
            [Vec3::X * x, Vec3::new(x, x, 0.0), Vec3::new(x, 0.0, x)]
        })
        .collect()
}
