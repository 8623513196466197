//! Builds the two levels: the coarse lists, and in each coarse cell that lists triangles, in parallel, its own.

use crate::scene::Mesh;

use super::super::grid::Settings;
use super::super::grid::density::ByDensity;
use super::super::grid::lattice::Lattice;
use super::super::grid::lists::Lists;
use super::super::parallel;
use super::super::share::{Shared, Span};
use super::super::{BuildError, BuildRequest, MAX_N};
use super::predict::{self, Predictor};
use super::{ENTRY, Grid2Level, Inner, fine_dims, lattice_in};

/// Coarse cells of a task.
const CHUNK: usize = 64;

/// Fine references a coarse one, above which a grid is made half as fine: where triangles cover each other, cells of any
/// size list them all.
const CROWDED: usize = 8;

/// What a task builds: the grids of its coarse cells, whose first cells and blocks count from 0.
#[derive(Default)]
struct Part {
    inner: Vec<Inner>,
    cells: u32,
    shared: Shared,
}

/// Builds the structure, and the triangles of its blocks.
///
/// # Errors
/// It would take more memory than allowed, by prediction before anything is allocated, or by count before the fine grids
/// are put together.
pub(super) fn build(request: &BuildRequest) -> Result<(Grid2Level, Vec<u32>), BuildError> {
    let settings = Settings::read(request.params);
    let n = request.n.unwrap_or(1).max(1);
    let mesh: &Mesh = request.mesh;
    let predictor = Predictor::new(mesh, request.params);
    let limit = request.memory_limit;
    let refuse = |predicted_bytes, largest_n| BuildError::TooLarge {
        accel: ENTRY.name,
        n,
        predicted_bytes,
        limit_bytes: limit,
        largest_n,
    };
    let largest_n = || predictor.largest_n(limit);
    if n > MAX_N || predictor.bytes(n) > limit {
        return Err(refuse(predictor.bytes(n), largest_n()));
    }
    // A model that was too low for this mesh was so by an unknown factor: half the resolution is a safe advice.
    let less = || (n / 2).min(largest_n());
    let coarse = Lattice::new(mesh.bounds(), predictor.model.dims(n));
    let most = limit.saturating_sub(predict::coarse_bytes(coarse.len())) / 4;
    let Some(lists) = settings.lists(&coarse, mesh, most) else {
        return Err(refuse(limit.saturating_add(1), less()));
    };
    let places: Vec<u32> = (0..coarse.len() as u32).collect();
    let parts = parallel::chunks(&places, CHUNK, |places| {
        part(&coarse, &lists, settings, predictor.density, mesh, places)
    });
    drop(lists);
    let bytes =
        |part: &Part| u64::from(part.cells) * size_of::<Span>() as u64 + part.shared.bytes();
    let bytes = predict::coarse_bytes(coarse.len()) + parts.iter().map(bytes).sum::<u64>();
    let cells: u64 = parts.iter().map(|part| u64::from(part.cells)).sum();
    if bytes > limit || cells > u64::from(u32::MAX) {
        return Err(refuse(bytes, less()));
    }
    let mut grid = Grid2Level {
        coarse,
        inner: Vec::with_capacity(places.len()),
        spans: vec![Span::default(); cells as usize],
        filled: Vec::new(),
    };
    let mut all = Shared::default();
    let mut first = 0;
    for part in parts {
        let shifted = |inner: &Inner| Inner {
            first: first + inner.first,
            ..*inner
        };
        grid.inner.extend(part.inner.iter().map(shifted));
        all.append(part.shared, first);
        first += part.cells;
    }
    for (cell, span) in all.spans {
        grid.spans[cell as usize] = span;
    }
    grid.filled = all.filled;
    Ok((grid, all.slots))
}

/// Builds the grids of some coarse cells.
fn part(
    coarse: &Lattice,
    lists: &Lists,
    settings: Settings,
    density: f64,
    mesh: &Mesh,
    places: &[u32],
) -> Part {
    let mut part = Part::default();
    // What the next cells read is fetched meanwhile: triangles that share a cell are often not neighbours in memory.
    let listed = |place: Option<&u32>| place.map_or(&[][..], |place| lists.of(*place as usize));
    for (i, &place) in places.iter().enumerate() {
        for prim in listed(places.get(i + 2)) {
            mesh.prefetch_triangle(*prim);
        }
        for prim in listed(places.get(i + 1)) {
            mesh.prefetch_corners(*prim);
        }
        let prims = lists.of(place as usize);
        let mut inner = Inner {
            first: part.cells,
            dims: [0; 3],
        };
        if !prims.is_empty() {
            let mut density = density;
            let fine = loop {
                inner.dims = fine_dims(coarse.size, prims.len(), density);
                let lattice = lattice_in(coarse, place, inner.dims);
                // One cell lists each triangle once.
                let most = CROWDED * prims.len();
                if let Some(fine) = settings.lists_of(&lattice, mesh, prims, most) {
                    break fine;
                }
                density /= 8.0;
            };
            let listed = (0..inner.cells()).filter(|cell| !fine.of(*cell as usize).is_empty());
            part.shared
                .put(listed.map(|cell| (inner.first + cell, fine.of(cell as usize))));
            part.cells += inner.cells();
        }
        part.inner.push(inner);
    }
    part
}
