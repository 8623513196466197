//! The grid with a known mistake: exhibits of the stability suite.
//!
//! | name | mistake |
//! |---|---|
//! | `grid-incremental` | crossings are accumulated in `f32`: `t_max += t_delta` |
//! | `grid-inside-only` | a hit counts only inside the cell in which it is found |
//! | `grid-f32-overlap` | triangles are found to touch cells by separating axes in `f32`, around the cell's centre |

use crate::geometry::Ray;
use crate::registry::Params;

use super::super::exhibit::{Behind, Exhibit, Wrong};
use super::super::{Accelerator, AcceleratorEntry, BuildError, BuildRequest, finish};
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
    finish(Exhibit(Mistaken::<ACCUMULATE, INSIDE_ONLY>(grid)), request)
}

impl<const ACCUMULATE: bool, const INSIDE_ONLY: bool> Wrong for Mistaken<ACCUMULATE, INSIDE_ONLY> {
    type Sound = Grid<Forgetful>;

    fn sound(&self) -> &Grid<Forgetful> {
        &self.0
    }

    fn lead(&self, ray: &Ray, mailbox: &mut Forgetful, visitor: &mut Behind) {
        self.0
            .lead::<ACCUMULATE, INSIDE_ONLY, _>(ray, mailbox, visitor);
    }
}
