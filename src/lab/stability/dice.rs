//! Random numbers and points for cases, from `+ − × ÷ √` alone, so that a case has the same bits on every machine.

use rand_core::Rng;
use rand_pcg::Pcg32;

use crate::geometry::{DVec3, Vec3};

/// A seeded source of numbers.
#[derive(Debug, Clone)]
pub struct Dice(Pcg32);

impl Dice {
    /// The source of one rung of the case `name`: independent of all other cases and rungs.
    pub(super) fn new(seed: u64, name: &str, rung: usize) -> Self {
        // FNV-1a, so that a new case changes no other.
        let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |h, b| {
            (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3)
        });
        Self(Pcg32::new(seed, hash.wrapping_add(rung as u64)))
    }

    /// A whole number below `n`.
    pub(super) fn below(&mut self, n: u32) -> u32 {
        ((u64::from(self.0.next_u32()) * u64::from(n)) >> 32) as u32
    }

    /// One of `items`, which are not none.
    pub(super) fn of<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len() as u32) as usize]
    }

    /// Uniform in 0..1, a multiple of 2⁻³².
    pub(super) fn unit(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / (1_u64 << 32) as f64
    }

    /// Uniform in -1..1.
    pub(super) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Uniform in the cube from -1 to 1.
    pub(super) fn cube(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    /// A unit vector, uniform on the sphere.
    pub(super) fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.cube();
            let square = v.length_squared();
            if (1e-4..1.0).contains(&square) {
                return v / square.sqrt();
            }
        }
    }

    /// A point of the triangle, uniform, not nearer to an edge than a thousandth of its height.
    pub(super) fn inside(&mut self, [a, b, c]: [DVec3; 3]) -> DVec3 {
        loop {
            let (u, v) = (self.unit(), self.unit());
            let w = 1.0 - u - v;
            if u.min(v).min(w) > 1e-3 {
                return a * w + b * u + c * v;
            }
        }
    }

    /// Along an axis, with zeros of either sign beside.
    pub(super) fn axis(&mut self) -> Vec3 {
        let mut along = [
            self.of(&[0.0, -0.0]),
            self.of(&[0.0, -0.0]),
            self.of(&[1.0, -1.0]),
        ];
        along.rotate_left(self.below(3) as usize);
        Vec3::from(along)
    }
}
