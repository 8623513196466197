//! The grid with a known mistake: exhibits of the stability suite.
//!
//! | name | mistake |
//! |---|---|
//! | `grid-incremental` | crossings are accumulated in `f32`: `t_max += t_delta` |
//! | `grid-inside-only` | a hit counts only inside the cell in which it is found |
//! | `grid-f32-overlap` | triangles are found to touch cells by separating axes in `f32`, around the cell's centre |

use crate::geometry::Ray;
use crate::registry::Params;

use super::super::exhibit::{Exhibit, Wrong};
use super::super::{Accelerator, AcceleratorEntry, BuildError, BuildRequest, Visitor, finish};
use super::mailbox::Forgetful;
use super::{ENTRY, Grid, OverlapTest, Settings};

/// A row that differs from the grid's in its mistake.
const fn row(
    name: &'static str,
    about: &'static str,
    paper: &'static str,
    build: fn(&BuildRequest) -> Result<Box<dyn Accelerator>, BuildError>,
) -> AcceleratorEntry {
    AcceleratorEntry {
        name,
        about,
        paper,
        params: &[],
        control: true,
        build,
        ..ENTRY
    }
}

/// The grid that accumulates crossings.
pub(in super::super) const INCREMENTAL: AcceleratorEntry = row(
    "grid-incremental",
    "A uniform grid whose walk adds up its crossings in f32 (t_max += t_delta), and so skips cells.",
    "Amanatides and Woo 1987, A Fast Voxel Traversal Algorithm for Ray Tracing: as printed",
    |request| exhibit::<true, false>(request, OverlapTest::Three),
);

/// The grid that believes hits only inside the cell.
pub(in super::super) const INSIDE_ONLY: AcceleratorEntry = row(
    "grid-inside-only",
    "A uniform grid that accepts only hits inside the current cell, and so loses those on its planes.",
    "A widespread reading of Amanatides and Woo 1987",
    |request| exhibit::<false, true>(request, OverlapTest::Three),
);

/// The grid whose overlap test is in `f32`.
pub(in super::super) const F32_OVERLAP: AcceleratorEntry = row(
    "grid-f32-overlap",
    "A uniform grid whose separating-axis overlap test is in f32, and so loses triangles on cell planes.",
    "Akenine-Möller 2001, Fast 3D Triangle-Box Overlap Testing: as printed",
    |request| exhibit::<false, false>(request, OverlapTest::SingleSeparating),
);

/// A grid without mailboxes, led with these mistakes.
struct Mistaken<const ACCUMULATE: bool, const INSIDE_ONLY: bool>(Grid<Forgetful>);

fn exhibit<const ACCUMULATE: bool, const INSIDE_ONLY: bool>(
    request: &BuildRequest,
    overlap: OverlapTest,
) -> Result<Box<dyn Accelerator>, BuildError> {
    let settings = Settings {
        overlap,
        mailbox: false,
        ..Settings::read(&Params::default())
    };
    let grid = Grid::new(request, settings, request.n.unwrap_or(1).max(1))?;
    let wrong = Mistaken::<ACCUMULATE, INSIDE_ONLY>(grid);
    finish(Exhibit::of(wrong), request)
}

impl<const ACCUMULATE: bool, const INSIDE_ONLY: bool> Wrong for Mistaken<ACCUMULATE, INSIDE_ONLY> {
    type Sound = Grid<Forgetful>;

    fn sound(&self) -> &Grid<Forgetful> {
        &self.0
    }

    fn lead<V: Visitor>(&self, ray: &Ray, mailbox: &mut Forgetful, visitor: &mut V) {
        self.0
            .lead::<ACCUMULATE, INSIDE_ONLY, _>(ray, mailbox, visitor);
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::testbed::{Dice, built_at, mesh, rays};
    use super::super::lattice::Lattice;
    use super::super::walk::Walk;
    use crate::geometry::{Aabb, Hit, Ray, Vec3};

    /// The cells that a ray visits in a unit cube of n³ cells.
    fn cells<const ACCUMULATE: bool>(ray: &Ray, n: u32) -> Vec<usize> {
        let bounds = Aabb {
            min: Vec3::ZERO,
            max: Vec3::ONE,
        };
        let lattice = Lattice::new(bounds, [n; 3]);
        let mut cells = Vec::new();
        if let Some(mut walk) = Walk::<ACCUMULATE>::new(&lattice, ray) {
            loop {
                cells.push(walk.cell);
                let exit = walk.exit();
                if !walk.advance(exit, f32::INFINITY) {
                    break;
                }
            }
        }
        cells
    }

    #[test]
    fn a_walk_that_accumulates_strays_the_more_often_the_more_cells_there_are() {
        let mut dice = Dice::new(1);
        let mut strayed = [0; 2];
        for _ in 0..2000 {
            let (from, to) = (dice.vector() * 2.0, dice.vector().abs());
            let ray = Ray::new(from, to - from);
            for (strayed, n) in strayed.iter_mut().zip([64, 1024]) {
                *strayed += u32::from(cells::<true>(&ray, n) != cells::<false>(&ray, n));
            }
        }
        let [few, many] = strayed;
        assert!(few < 40 && many > 400, "{few}, {many}");
    }

    #[test]
    fn hits_in_a_flat_scene_are_lost_where_only_those_inside_the_cell_count() {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.3);
        let flat: Vec<_> = (0..64_u8)
            .map(|i| {
                let (x, y) = (f32::from(i % 8), f32::from(i / 8));
                [corner(x, y), corner(x + 1.0, y), corner(x, y + 1.0)]
            })
            .collect();
        let mesh = mesh(&flat);
        // Towards the sheet at a slope: along an axis, t and so the point of the hit round to the sheet itself.
        let slanted = |ray: &Ray| ray.origin.z != 0.3 && ray.dir.abs().min_element() > 0.0;
        let rays: Vec<_> = rays(&mesh, 1000, 3).into_iter().filter(slanted).collect();
        let hits = |accel| {
            let mut hits = vec![Hit::MISS; rays.len()];
            built_at(&mesh, accel, Some(8), "woop").closest(&rays, &mut hits);
            hits.iter().filter(|h| h.is_hit()).count()
        };
        let (sound, wrong) = (hits("grid"), hits("grid-inside-only"));
        assert!(wrong * 4 < sound * 3, "{wrong} of {sound}");
    }
}
