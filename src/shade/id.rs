//! The channel `id`: a colour of its own for each triangle, the background elsewhere. The plainest picture of what was
//! hit, and the one that the exercise sheet asks for.
//!
//! **Source:** Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences" (2018), for a sequence whose
//! neighbours lie far apart in hue, lightness and chroma; Ottosson, "A perceptual color space" (2020), for Oklab.

use crate::geometry::{Hit, Vec3};

use super::channel::{Channel, Painter};
use super::image::to_srgb;

pub(super) const CHANNEL: Channel = Channel {
    name: "id",
    about: "A distinct colour for each triangle.",
    paint: |view| {
        let view = *view;
        let background = to_srgb(view.scene.background);
        Painter::Colours {
            tile: Box::new(move |rays, counts| {
                counts.primary += rays.len() as u64;
                let mut hits = vec![Hit::MISS; rays.len()];
                view.accel.closest(rays, &mut hits);
                let colour = |hit: &Hit| {
                    if hit.is_hit() {
                        counts.hits += 1;
                        triangle_colour(hit.prim)
                    } else {
                        background
                    }
                };
                hits.iter().map(colour).collect()
            }),
            found: "one colour a triangle".to_owned(),
        }
    },
};

/// The colour of a triangle: neither dark nor pale, and far from those of triangles with near indices.
fn triangle_colour(prim: u32) -> [u8; 3] {
    // Powers of 1/1.2207…, the root of x⁴ = x + 1, spread points evenly over three dimensions.
    let fraction = |step: f64| (0.5 + f64::from(prim) * step).fract() as f32;
    let hue = fraction(0.819_172_513_396_164_5) * std::f32::consts::TAU;
    let lightness = 0.52 + 0.36 * fraction(0.671_043_606_703_789_3);
    let chroma = 0.07 + 0.11 * fraction(0.549_700_477_901_970_9);
    to_srgb(oklab(lightness, chroma * hue.cos(), chroma * hue.sin()))
}

/// Linear RGB of an Oklab colour; components may leave 0..1 where the screen has no such colour.
fn oklab(lightness: f32, a: f32, b: f32) -> Vec3 {
    let cube = |x: f32| x * x * x;
    let l = cube(lightness + 0.396_337_78 * a + 0.215_803_76 * b);
    let m = cube(lightness - 0.105_561_346 * a - 0.063_854_17 * b);
    let s = cube(lightness - 0.089_484_18 * a - 1.291_485_5 * b);
    Vec3::new(
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn difference(a: [u8; 3], b: [u8; 3]) -> i32 {
        (0..3)
            .map(|i| (i32::from(a[i]) - i32::from(b[i])).abs())
            .sum()
    }

    #[test]
    fn triangles_with_near_indices_have_clearly_different_colours() {
        for prim in 0..2000 {
            for next in prim + 1..prim + 4 {
                let (a, b) = (triangle_colour(prim), triangle_colour(next));
                assert!(difference(a, b) > 40, "{prim} {a:?}, {next} {b:?}");
            }
        }
    }

    #[test]
    fn of_a_thousand_triangles_hardly_any_share_a_colour() {
        let colours: std::collections::HashSet<_> = (0..1000).map(triangle_colour).collect();
        assert!(colours.len() >= 995, "{}", colours.len());
    }

    #[test]
    fn no_triangle_is_black() {
        assert!((0..5000).all(|prim| triangle_colour(prim).iter().max() > Some(&90)));
    }
}
