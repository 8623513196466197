//! The cases, a file for each group of traps.

use super::case::{CaseEntry, Setting};
use super::dice::Dice;
use super::shapes;

mod cells;
mod edges;
mod numbers;
mod rays;
mod trees;
mod triangles;

/// All cases, group by group, in the order in which they are listed.
pub const CASES: &[CaseEntry] = &[
    edges::CLOSED_EDGES,
    edges::CLOSED_VERTICES,
    edges::CLOSED_FACES,
    edges::SILHOUETTES,
    edges::FAN,
    triangles::SLIVERS,
    triangles::NEEDLES,
    triangles::CAPS,
    triangles::ZERO_AREA,
    triangles::NOTHING_TO_HIT,
    triangles::DUPLICATES,
    triangles::COPLANAR,
    triangles::CLOSE_LAYERS,
    numbers::ORDINARY,
    numbers::SMALL_SCALES,
    numbers::LARGE_SCALES,
    numbers::DENORMALS,
    numbers::SHORT_DIRECTIONS,
    numbers::LONG_DIRECTIONS,
    numbers::FAR_ORIGINS,
    numbers::OUTLIER,
    numbers::STADIUM,
    numbers::GIANT,
    rays::IN_PLANE,
    rays::GRAZING,
    rays::STARTS_ON_SURFACES,
    rays::STARTS_BESIDE_SURFACES,
    rays::SIGNED_ZEROS,
    rays::INTERVALS,
    cells::ALONG_CELL_FACES,
    cells::ALONG_CELL_EDGES,
    cells::THROUGH_CELL_CORNERS,
    cells::STARTS_ON_CELL_FACES,
    cells::TRIANGLES_ON_CELL_PLANES,
    cells::FLAT_SCENES,
    cells::DIAGONAL_NEEDLES,
    cells::FINE_CELLS,
    trees::IDENTICAL_CENTROIDS,
    trees::SPLIT_PLANES_ON_VERTICES,
    trees::DEPTH_BOMB,
    trees::NESTED_BOXES,
    trees::FLAT_BOXES,
    trees::BOX_CORNERS,
    trees::OVERLAP,
];

/// Rays of a rung.
const RAYS: u32 = 1000;

/// A case of one rung has this ladder.
const ONE: &[f64] = &[0.0];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_kebab_case_and_every_row_says_what_it_must() {
        for (i, case) in CASES.iter().enumerate() {
            let kebab = |c: char| c.is_ascii_lowercase() || c == '-';
            assert!(case.name.chars().all(kebab), "{}", case.name);
            assert!(CASES[..i].iter().all(|c| c.name != case.name));
            assert!(case.about.ends_with('.') && !case.source.is_empty());
            assert_eq!(case.quantity.is_empty(), case.rungs.len() == 1);
            assert!(!case.rungs.is_empty(), "{}", case.name);
        }
    }

    #[test]
    fn every_rung_has_rays_few_triangles_and_a_seed_of_its_own() {
        for case in CASES {
            for rung in 0..case.rungs.len() {
                let setting = case.setting(rung, 1);
                let name = format!("{} {}", case.name, case.label(rung));
                assert!(setting.mesh.len() <= 1200, "{name}: {}", setting.mesh.len());
                assert!(setting.rays.len() as u32 >= RAYS / 2, "{name}");
                assert!(setting.rays.len() as u32 <= 2 * RAYS, "{name}");
                let again = case.setting(rung, 1);
                assert_eq!(again.rays, setting.rays, "{name}");
                assert_eq!(*again.mesh, *setting.mesh, "{name}");
                assert_ne!(case.setting(rung, 2).rays, setting.rays, "{name}");
            }
        }
    }
}
