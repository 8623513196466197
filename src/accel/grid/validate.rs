//! Checks what a grid promises: offsets that fit, lists that ascend, and no triangle missing from a cell it touches.

use crate::geometry::Vec3;
use crate::scene::Mesh;

use super::lattice::{Block, Lattice};
use super::lists::Lists;
use super::overlap::{Overlap, Separating};

/// Cells that are checked for triangles: all of a small mesh, an even sample of a large one.
const CHECKED_CELLS: u64 = 2_000_000;

/// Cells that are checked for one triangle.
const CHECKED_CELLS_OF_TRIANGLE: u64 = 200_000;

/// Checks `lists` against `mesh`.
///
/// Triangles are tested against cells without pad, by separating axes whichever test the lists were made with, so what
/// that test misses is found.
///
/// # Errors
/// A sentence that names the first broken promise.
pub(super) fn check(lattice: &Lattice, lists: &Lists, mesh: &Mesh) -> Result<(), String> {
    well_formed(lattice, lists, mesh.len())?;
    let lists = |cell: usize, prim: u32| lists.of(cell).binary_search(&prim).is_ok();
    each_touched_cell(lattice, mesh, &lists)
}

/// Checks that a triangle is listed, as `lists` says, in every cell that it touches.
///
/// # Errors
/// A sentence that names a triangle and a cell.
pub(in crate::accel) fn each_touched_cell(
    lattice: &Lattice,
    mesh: &Mesh,
    lists: &dyn Fn(usize, u32) -> bool,
) -> Result<(), String> {
    let touched: u64 = (0..mesh.len() as u32)
        .map(|prim| {
            block(lattice, mesh, prim)
                .cells()
                .min(CHECKED_CELLS_OF_TRIANGLE)
        })
        .sum();
    let stride = touched.div_ceil(CHECKED_CELLS).max(1) as usize;
    (0..mesh.len() as u32)
        .step_by(stride)
        .try_for_each(|prim| listed_where_it_is(lattice, lists, mesh, prim))
}

fn well_formed(lattice: &Lattice, lists: &Lists, triangles: usize) -> Result<(), String> {
    let Lists { offsets, prims } = lists;
    if offsets.len() as u64 != lattice.len() + 1 {
        return Err(format!(
            "the grid has {} offsets for {} cells",
            offsets.len(),
            lattice.len()
        ));
    }
    if offsets[0] != 0 || offsets[offsets.len() - 1] as usize != prims.len() {
        return Err("the grid's offsets do not span its references".to_owned());
    }
    if let Some(cell) = offsets.windows(2).position(|pair| pair[0] > pair[1]) {
        return Err(format!("the list of cell {cell} ends before it begins"));
    }
    for cell in 0..offsets.len() - 1 {
        let list = lists.of(cell);
        if list.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err(format!("the list of cell {cell} does not ascend"));
        }
        if list.last().is_some_and(|&prim| prim as usize >= triangles) {
            return Err(format!(
                "the list of cell {cell} names a triangle that does not exist"
            ));
        }
    }
    Ok(())
}

fn block(lattice: &Lattice, mesh: &Mesh, prim: u32) -> Block {
    let bounds = mesh.triangle_bounds(prim);
    lattice.block(bounds.min.as_dvec3(), bounds.max.as_dvec3())
}

/// Checks that one triangle is listed in every cell that it touches.
///
/// # Errors
/// A sentence that names the triangle and a cell.
pub(in crate::accel) fn listed_where_it_is(
    lattice: &Lattice,
    lists: &dyn Fn(usize, u32) -> bool,
    mesh: &Mesh,
    prim: u32,
) -> Result<(), String> {
    let corners = mesh.corners(prim).map(Vec3::as_dvec3);
    let [a, b, c] = corners;
    let (min, max) = (a.min(b).min(c), a.max(b).max(c));
    let triangle = Separating::new(corners);
    let block = lattice.block(min, max);
    let stride = block.cells().div_ceil(CHECKED_CELLS_OF_TRIANGLE) as usize;
    let size: [u64; 3] = std::array::from_fn(|a| u64::from(block.last[a] - block.first[a]) + 1);
    for k in (0..block.cells()).step_by(stride) {
        let step = [k % size[0], k / size[0] % size[1], k / size[0] / size[1]];
        let cell: [u32; 3] = std::array::from_fn(|a| block.first[a] + step[a] as u32);
        let (centre, half) = lattice.padded(
            &Block {
                first: cell,
                last: cell,
            },
            0.0,
        );
        let in_box = min.cmple(centre + half).all() && max.cmpge(centre - half).all();
        if in_box && triangle.touches(centre, half) {
            let index = lattice.index(cell) as usize;
            if !lists(index, prim) {
                return Err(format!(
                    "triangle {prim} touches cell {cell:?} but is not listed there"
                ));
            }
        }
    }
    Ok(())
}
