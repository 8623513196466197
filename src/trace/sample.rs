//! Random numbers, directions and points, made with correctly rounded operations only, so that they are the same
//! everywhere.

use rand_core::Rng;
use rand_pcg::Pcg32;

use crate::geometry::DVec3;

/// A generator for `seed`; different `purpose`s of one seed are independent streams.
pub fn generator(seed: u64, purpose: u64) -> Pcg32 {
    Pcg32::new(seed, purpose)
}

/// A number in 0..1, a multiple of 2⁻³².
pub(super) fn unit(random: &mut Pcg32) -> f64 {
    f64::from(random.next_u32()) / (1_u64 << 32) as f64
}

/// A point of the open unit disc, uniform by area.
fn disc(random: &mut Pcg32) -> [f64; 2] {
    loop {
        let [x, y] = [(); 2].map(|()| 2.0 * unit(random) - 1.0);
        if x * x + y * y < 1.0 {
            return [x, y];
        }
    }
}

/// A unit vector, uniform on the sphere.
pub(super) fn direction(random: &mut Pcg32) -> DVec3 {
    loop {
        let v = DVec3::from_array([(); 3].map(|()| 2.0 * unit(random) - 1.0));
        let square = v.length_squared();
        // Points next to the centre are left out: their direction would be coarse.
        if (1e-6..1.0).contains(&square) {
            return v / square.sqrt();
        }
    }
}

/// A unit vector around the unit vector `normal`, with a density proportional to the cosine between them (Malley: a
/// uniform point of the disc, projected up).
pub fn cosine_direction(random: &mut Pcg32, normal: DVec3) -> DVec3 {
    let [x, y] = disc(random);
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    tangent * x + bitangent * y + normal * (1.0 - x * x - y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_have_unit_length_and_no_preference() {
        let mut random = generator(1, 0);
        let mut sum = DVec3::ZERO;
        for _ in 0..20_000 {
            let d = direction(&mut random);
            assert!((d.length() - 1.0).abs() < 1e-12);
            sum += d;
        }
        // The mean of 20,000 unit vectors has a deviation of 0.004 an axis.
        assert!((sum / 20_000.0).abs().max_element() < 0.02);
    }

    #[test]
    fn cosine_directions_have_a_mean_cosine_of_two_thirds() {
        let mut random = generator(1, 0);
        let normal = DVec3::new(1.0, 2.0, -2.0) / 3.0;
        let cosines: Vec<f64> = (0..20_000)
            .map(|_| cosine_direction(&mut random, normal).dot(normal))
            .collect();
        assert!(cosines.iter().all(|c| *c >= 0.0));
        let mean = cosines.iter().sum::<f64>() / 20_000.0;
        assert!((mean - 2.0 / 3.0).abs() < 0.01, "{mean}");
    }

    #[test]
    fn the_stream_is_the_published_one() {
        // From the PCG C library's demo: seed 42, stream 54.
        let mut random = generator(42, 54);
        assert_eq!(random.next_u32(), 0xa15c_02b7);
    }
}
