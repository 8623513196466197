//! Checks what `grid-skip` promises: spans within its blocks, no triangle missing from a cell it touches or from its block's box,
//! and distances no greater than the empty cubes.

use rayon::prelude::*;

use crate::scene::Mesh;

use super::super::grid::validate::each_touched_cell;
use super::super::share;
use super::GridSkip;
use super::distances::OCTANTS;

/// Checks `grid`, whose blocks hold the triangles `lanes`, against `mesh`.
///
/// # Errors
/// A sentence that names the first broken promise.
pub(super) fn check(grid: &GridSkip, mesh: &Mesh, lanes: &[u32]) -> Result<(), String> {
    share::validate(&grid.filled, lanes, grid.cells.spans.iter().copied())?;
    let lists = |cell: usize, prim: u32| {
        let cell = grid.lattice.cell(cell as u64).unwrap_or_default();
        let rank = grid.cells.rank(grid.bricks.place(cell));
        rank.is_some_and(|rank| {
            let span = grid.cells.spans[rank];
            if grid.crowded.holds(span) {
                // Clusters do not ascend.
                span.lanes(lanes).contains(&prim)
            } else {
                share::holds(span, lanes, prim)
            }
        })
    };
    grid.crowded.validate(mesh, lanes)?;
    each_touched_cell(&grid.lattice, mesh, &lists)?;
    (0..OCTANTS)
        .into_par_iter()
        .try_for_each(|octant| (0..grid.lattice.dims[2]).try_for_each(|z| plane(grid, octant, z)))
}

/// Checks the distances of a direction in one plane: that a cell has 0 if it lists triangles, and that each is at most one
/// more than those of its seven neighbours ahead. By induction from the far end of the grid, all cubes are then empty.
fn plane(grid: &GridSkip, octant: usize, z: u32) -> Result<(), String> {
    let [nx, ny, _] = grid.lattice.dims;
    let distance = |cell: [u32; 3]| {
        let place = grid.direction(octant) + grid.bricks.place(cell);
        u32::from(grid.distances[place])
    };
    let ahead = |a: usize, i: u32| {
        let next = if octant >> a & 1 == 1 {
            i.checked_sub(1)
        } else {
            Some(i + 1)
        };
        next.filter(|&i| i < grid.lattice.dims[a])
    };
    for (x, y) in (0..ny).flat_map(|y| (0..nx).map(move |x| (x, y))) {
        let cell = [x, y, z];
        let found = distance(cell);
        let index = grid.bricks.place(cell);
        if (found == 0) != grid.cells.rank(index).is_some() {
            return Err(format!(
                "cell {cell:?} has distance {found} in direction {octant}, against its bit"
            ));
        }
        for step in 1..OCTANTS {
            let number = |a: usize| {
                if step >> a & 1 == 1 {
                    ahead(a, cell[a])
                } else {
                    Some(cell[a])
                }
            };
            if let [Some(x), Some(y), Some(z)] = [number(0), number(1), number(2)]
                && found > distance([x, y, z]) + 1
            {
                return Err(format!(
                    "cell {cell:?} has distance {found} in direction {octant}, which is too far"
                ));
            }
        }
    }
    Ok(())
}
