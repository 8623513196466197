//! Seeded random numbers, the same on every machine.

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

use crate::geometry::DVec3;

/// A stream of PCG32.
pub struct Random(Pcg32);

impl Random {
    /// The stream of `seed`.
    pub fn new(seed: u64) -> Self {
        Self(Pcg32::seed_from_u64(seed))
    }

    /// Uniform in [0, 1), a multiple of 2⁻³².
    pub fn unit(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / (1_u64 << 32) as f64
    }

    /// Uniform in [`lo`, `hi`).
    pub fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }

    /// Uniform in the cube [`lo`, `hi`)³.
    pub fn cube(&mut self, lo: f64, hi: f64) -> DVec3 {
        // One after the other, because the order of evaluation is part of the stream.
        let x = self.between(lo, hi);
        let y = self.between(lo, hi);
        let z = self.between(lo, hi);
        DVec3::new(x, y, z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stream_of_a_seed_is_fixed() {
        let mut a = Random::new(1);
        let mut b = Random::new(1);
        let mut c = Random::new(2);
        let first = a.unit();
        assert_eq!(first, b.unit());
        assert_ne!(first, c.unit());
        assert!((0.0..1.0).contains(&first));
    }
}
