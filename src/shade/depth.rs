//! The channel `depth`: how far from the eye each pixel's surface is, near ones bright.

use crate::geometry::Hit;

use super::channel::{Channel, Painter};
use super::color_map::GREY;
use super::legend::Ramp;

pub(super) const CHANNEL: Channel = Channel {
    name: "depth",
    about: "Distance from the eye, near bright and far dark.",
    paint: |view| {
        let view = *view;
        Painter::Numbers {
            tile: Box::new(move |rays, counts| {
                counts.primary += rays.len() as u64;
                let mut hits = vec![Hit::MISS; rays.len()];
                view.accel.closest(rays, &mut hits);
                counts.hits += hits.iter().filter(|hit| hit.is_hit()).count() as u64;
                // A camera's rays have unit length, so t is the distance.
                let depth = |hit: &Hit| if hit.is_hit() { hit.t } else { f32::NAN };
                hits.iter().map(depth).collect()
            }),
            ramp: Ramp {
                title: "distance",
                map: GREY,
                reversed: true,
                counts: false,
            },
        }
    },
};
