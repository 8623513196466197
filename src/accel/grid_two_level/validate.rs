//! Checks what `grid-2level` promises: grids that fill their room, spans within the blocks, and no triangle missing from a
//! fine cell that it touches.

use crate::scene::Mesh;

use super::super::grid::validate::{each_touched_cell, listed_where_it_is};
use super::super::share;
use super::{Grid2Level, MOST, lattice_in};

/// Checks `grid`, whose blocks hold the triangles `lanes`, against `mesh`.
///
/// # Errors
/// A sentence that names the first broken promise.
pub(super) fn check(grid: &Grid2Level, mesh: &Mesh, lanes: &[u32]) -> Result<(), String> {
    share::validate(&grid.filled, lanes, grid.spans.iter().copied())?;
    let mut first = 0;
    for (place, inner) in grid.inner.iter().enumerate() {
        let is_empty = inner.dims == [0; 3];
        let is_grid = inner
            .dims
            .iter()
            .all(|&n| (1..=MOST).contains(&u32::from(n)));
        if inner.first != first || !(is_empty || is_grid) {
            return Err(format!(
                "the grid in coarse cell {place} is {inner:?}, not from cell {first} on"
            ));
        }
        first += inner.cells();
    }
    if grid.inner.len() as u64 != grid.coarse.len() || first as usize != grid.spans.len() {
        return Err("the fine grids do not fill their room".to_owned());
    }
    let lists = |place: usize, prim: u32| {
        let inner = grid.inner[place];
        let fine = lattice_in(&grid.coarse, place as u32, inner.dims);
        let lists = |cell: usize, prim: u32| {
            share::holds(grid.spans[inner.first as usize + cell], lanes, prim)
        };
        inner.dims[0] > 0 && listed_where_it_is(&fine, &lists, mesh, prim).is_ok()
    };
    each_touched_cell(&grid.coarse, mesh, &lists)
}
