//! The channels `cells` and `tests`: the work of each pixel's primary ray, as a heat map.

use crate::accel::Counts;
use crate::geometry::{Hit, Ray};

use super::channel::{Channel, Painter};
use super::color_map::INFERNO;
use super::legend::Ramp;
use super::render::{RayCounts, View};

pub(super) const CELLS: Channel = Channel {
    name: "cells",
    about: "How many cells or nodes each ray visits.",
    paint: |view| heat_map(view, "cells per ray", |counts| counts.steps),
};

pub(super) const TESTS: Channel = Channel {
    name: "tests",
    about: "How many triangles each ray is tested against.",
    paint: |view| heat_map(view, "tests per ray", |counts| counts.tests),
};

/// The picture of one count. Rays that enter the structure and hit nothing have their count too.
fn heat_map<'a>(view: &View<'a>, title: &'static str, count: fn(&Counts) -> u64) -> Painter<'a> {
    let view = *view;
    let tile = move |rays: &[Ray], ray_counts: &mut RayCounts| {
        let mut hits = vec![Hit::MISS; rays.len()];
        let mut counts = vec![Counts::default(); rays.len()];
        view.accel.closest_counted(rays, &mut hits, &mut counts);
        ray_counts.primary += rays.len() as u64;
        ray_counts.hits += hits.iter().filter(|hit| hit.is_hit()).count() as u64;
        // A ray that enters nothing did no work that could be compared: it shows the background.
        let number = |c: &Counts| {
            if c.steps == 0 {
                f32::NAN
            } else {
                count(c) as f32
            }
        };
        counts.iter().map(number).collect()
    };
    Painter::Numbers {
        tile: Box::new(tile),
        ramp: Ramp {
            title,
            map: INFERNO,
            reversed: false,
            counts: true,
        },
    }
}
