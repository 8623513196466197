//! Rays on which structures and kernels are known to fail, aimed at any mesh.

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use raylab::geometry::{Aabb, Ray, Vec3};
use raylab::scene::Mesh;

/// A seeded source of numbers.
pub struct Dice(Pcg32);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Self(Pcg32::seed_from_u64(seed))
    }

    pub fn below(&mut self, n: u32) -> u32 {
        self.0.next_u32() % n
    }

    /// One of `items`.
    pub fn of<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len() as u32) as usize]
    }

    /// Uniform in -1..1, with 24 bits.
    pub fn signed(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    /// Along an axis, with zeros of either sign beside.
    fn axis(&mut self) -> Vec3 {
        let mut along = [self.of(&[0.0, -0.0]), self.of(&[0.0, -0.0]), 0.0];
        along[2] = self.of(&[1.0, -1.0]);
        along.rotate_left(self.below(3) as usize);
        Vec3::from(along)
    }

    /// Along the planes of two axes: one component is a zero of either sign.
    fn in_plane(&mut self) -> Vec3 {
        let mut along = self.vector().to_array();
        along[self.below(3) as usize] = self.of(&[0.0, -0.0]);
        Vec3::from(along)
    }

    /// A point of the triangle, its edges and corners among them.
    fn on(&mut self, [a, b, c]: [Vec3; 3]) -> Vec3 {
        match self.below(5) {
            0 => a,
            1 => (a + b) * 0.5,
            2 => b + (c - b) * (self.signed() * 0.5 + 0.5),
            _ => {
                let (u, v) = (self.signed().abs(), self.signed().abs());
                let (u, v) = if u + v > 1.0 {
                    (1.0 - u, 1.0 - v)
                } else {
                    (u, v)
                };
                a + (b - a) * u + (c - a) * v
            }
        }
    }

    /// A point of the box on a plane between two cells of some uniform grid, or where such planes meet.
    fn on_cell_faces(&mut self, bounds: Aabb, axes: u32) -> Vec3 {
        let n = self.of(&[1u32, 2, 3, 4, 7, 8, 16]);
        let mut point = (bounds.centre() + bounds.extent() * 0.5 * self.vector()).to_array();
        let first = self.below(3);
        for k in 0..axes {
            let axis = ((first + k) % 3) as usize;
            let (lo, hi) = (f64::from(bounds.min[axis]), f64::from(bounds.max[axis]));
            point[axis] = (lo + (hi - lo) * f64::from(self.below(n + 1)) / f64::from(n)) as f32;
        }
        Vec3::from(point)
    }
}

/// Kinds of rays that [`ray`] makes.
const KINDS: u32 = 14;

/// About `count` valid rays at `mesh`: across it and from inside it; along axes with zeros of both signs; aimed at
/// vertices, edges and insides of triangles; along edges and in the planes of triangles; from triangles; from and along
/// the faces of cells, and through their corners. Some have short intervals, some run backwards from `t = 0`.
pub fn aimed_at(mesh: &Mesh, count: u32, seed: u64) -> Vec<Ray> {
    let mut dice = Dice::new(seed);
    let bounds = if mesh.is_empty() {
        Aabb::of_points([-Vec3::ONE, Vec3::ONE])
    } else {
        mesh.bounds()
    };
    (0..count)
        .map(|i| ray(&mut dice, mesh, bounds, i % KINDS))
        .filter(Ray::is_valid)
        .collect()
}

fn ray(dice: &mut Dice, mesh: &Mesh, bounds: Aabb, kind: u32) -> Ray {
    let half = bounds.extent() * 0.5;
    let radius = half.max_element().max(f32::MIN_POSITIVE);
    let inside = bounds.centre() + half * dice.vector();
    let outside = bounds.centre() + 2.0 * radius * dice.vector();
    let corners = if mesh.is_empty() {
        [inside, outside, bounds.centre()]
    } else {
        mesh.corners(dice.below(mesh.len() as u32))
    };
    let target = dice.on(corners);
    let axis = dice.axis();
    let (origin, dir) = match kind {
        0 => (outside, inside - outside),
        1 => (inside, dice.vector()),
        2 => (target - axis * radius * 2.0, axis),
        3 | 4 => (outside, target - outside),
        5 => (inside, (target - inside) * 0.5),
        6 => (corners[0], corners[1] - corners[0]),
        7 => {
            // In the plane of the triangle as far as f32 can say.
            let along = (corners[1] - corners[0]) * dice.signed()
                + (corners[2] - corners[0]) * dice.signed();
            (target - along * 3.0, along)
        }
        8 => (target, dice.vector()),
        9 => (dice.on_cell_faces(bounds, 1), dice.vector()),
        10 => (dice.on_cell_faces(bounds, 2), dice.in_plane()),
        11 => (dice.on_cell_faces(bounds, 2) - axis * radius * 3.0, axis),
        12 => {
            // Through the corners of cells: two of them on one line.
            let (from, to) = (dice.on_cell_faces(bounds, 3), dice.on_cell_faces(bounds, 3));
            (from - (to - from), to - from)
        }
        _ => {
            // Along the diagonal of the box, which meets a corner of every cell on it.
            let signs = Vec3::new(
                dice.of(&[1.0, -1.0]),
                dice.of(&[1.0, -1.0]),
                dice.of(&[1.0, -1.0]),
            );
            let along = signs * bounds.extent();
            (bounds.centre() - along, along * dice.of(&[1.0, 0.3]))
        }
    };
    let mut ray = Ray::new(origin, dir);
    if dice.below(5) == 0 {
        ray.t_max = dice.signed().abs();
    }
    match dice.below(12) {
        0 => ray.t_min = ray.t_max.min(1.0) * 0.25,
        1 => ray.t_min = -1.0,
        2 => ray.t_min = f32::NEG_INFINITY,
        _ => {}
    }
    ray
}
