//! `primary`: the rays of the scene's camera, one through the centre of each pixel.
//!
//! ```text
//! tiles of 32 × 32 pixels, row by row        inside a tile: Morton order
//! ┌────┬────┬─                               0 1 4 5
//! │ 0  │ 1  │                                2 3 6 7
//! ├────┼────┼─                               8 9 …
//! ```
//!
//! So a batch is a tile, and every run of 4, 16 or 64 rays inside it is a square of the picture.

use crate::geometry::Ray;
use crate::scene::Camera;

use super::{Query, RaySetEntry, Rays};

pub(super) const ENTRY: RaySetEntry = RaySetEntry {
    name: "primary",
    about: "Rays of the scene's camera through the pixel centres of a 4:3 picture, in tiles.",
    query: Query::Closest,
    argument: "",
    params: &[],
    make: |request| {
        let (width, height) = picture_size(request.count);
        Ok(Rays {
            rays: rays(&request.scene.camera, width, height),
            warnings: Vec::new(),
        })
    },
};

/// Pixels along a side of a tile.
const TILE: u32 = 32;

/// Width and height of the largest picture of aspect 4:3 with at most `count` pixels; below 12 pixels a square one.
/// `count` is at least 1.
pub(super) fn picture_size(count: usize) -> (u32, u32) {
    match (count / 12).isqrt() as u32 {
        0 => (count.isqrt() as u32, count.isqrt() as u32),
        k => (4 * k, 3 * k),
    }
}

/// One ray a pixel, in tile order.
pub(super) fn rays(camera: &Camera, width: u32, height: u32) -> Vec<Ray> {
    let mut rays = Vec::with_capacity(width as usize * height as usize);
    for top in (0..height).step_by(TILE as usize) {
        for left in (0..width).step_by(TILE as usize) {
            for i in 0..TILE * TILE {
                let (x, y) = (left + every_other_bit(i), top + every_other_bit(i >> 1));
                if x < width && y < height {
                    rays.push(camera.ray(x as f32 + 0.5, y as f32 + 0.5, width, height));
                }
            }
        }
    }
    rays
}

/// Bits 0, 2, 4, 6, 8 of `i`, moved together.
fn every_other_bit(i: u32) -> u32 {
    (0..5).fold(0, |bits, b| bits | (i >> (2 * b) & 1) << b)
}

#[cfg(test)]
mod tests {
    use super::super::fixture;
    use super::*;

    #[test]
    fn pictures_never_have_more_pixels_than_asked_for() {
        for count in 1..3000 {
            let (width, height) = picture_size(count);
            let pixels = (width * height) as usize;
            assert!(pixels >= 1 && pixels <= count, "{count}");
        }
        assert_eq!(picture_size(12 * 64 * 64), (256, 192));
    }

    #[test]
    fn every_pixel_has_its_ray_once() {
        let camera = fixture::room().camera;
        let rays = rays(&camera, 40, 36);
        assert_eq!(rays.len(), 40 * 36);
        for (x, y) in [(0, 0), (39, 35), (31, 32), (17, 3)] {
            let ray = camera.ray(x as f32 + 0.5, y as f32 + 0.5, 40, 36);
            assert_eq!(rays.iter().filter(|r| **r == ray).count(), 1);
        }
    }

    #[test]
    fn the_first_sixteen_rays_are_a_square_of_four_by_four_pixels() {
        let camera = fixture::room().camera;
        let rays = rays(&camera, 64, 64);
        for y in 0..4 {
            for x in 0..4 {
                let ray = camera.ray(x as f32 + 0.5, y as f32 + 0.5, 64, 64);
                assert!(rays[..16].contains(&ray));
            }
        }
    }
}
