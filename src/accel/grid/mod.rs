//! The uniform grid: n³ cells over the smallest box, each listing the triangles that touch it.
//!
//! ```text
//!   +---+---+---+---+
//!   |   | .-+-. |   |      lattice     where the cells are: one boundary function
//!   +---+/--+--\+---+      overlap     which cells a triangle touches
//!   |   |\  |  /|  -+-->   lists       cell -> triangles, compact
//!   +---+-`-+-'-+/--+      walk        ray -> cells, in order
//!   |   |   | / |   |      mailbox     a triangle in two cells is tested once
//!   +---+---/---+---+      predict     what it will cost, and the best n
//! ```
//!
//! A ray stops before the first cell that begins beyond the nearest hit: "keep the best, stop when beyond". Hits outside
//! the cell in which they are found count, so nothing is lost at cell planes.
//!
//! **Source:** A. Fujimoto, T. Tanaka and K. Iwata, "ARTS: Accelerated Ray-Tracing System", IEEE CG&A 6(4), 1986;
//! each part names its own. **Differs:** cells are closed and padded, and everything spatial is computed in `f64`
//! (see `lattice`), so no ray and no triangle falls between two cells.

use std::marker::PhantomData;

use crate::geometry::lanes::Isa;
use crate::geometry::{Aabb, Ray, Vec3};
use crate::registry::{ParamKind, ParamSpec, Params};
use crate::scene::Mesh;

use super::{
    Accelerator, AcceleratorEntry, BuildError, BuildRequest, MAX_N, PlaceKind, Resolution, Singles,
    Structure, StructureStats, Visitor, finish,
};

pub(super) mod density;
mod exhibits;
pub(super) mod lattice;
pub(super) mod lists;
mod mailbox;
pub(super) mod overlap;
pub(super) mod predict;
#[cfg(test)]
mod tests;
pub(super) mod validate;
pub(super) mod walk;

pub(super) use exhibits::{F32_OVERLAP, INCREMENTAL, INSIDE_ONLY};
use lattice::{Lattice, Shape};
use lists::Lists;
use mailbox::{Forgetful, Hashed, Mailbox};
use overlap::{Boxes, Separating, SingleSeparating, ThreeTest};
use predict::Model;
use walk::Walk;

pub(super) const ENTRY: AcceleratorEntry = AcceleratorEntry {
    name: "grid",
    about: "Uniform grid over the smallest box; cells list the triangles that touch them.",
    paper: "Fujimoto et al. 1986, ARTS; Amanatides and Woo 1987; Lagae and Dutré 2008",
    params: &[
        Settings::OVERLAP,
        ParamSpec {
            name: "mailbox",
            about: "Whether a triangle listed in several cells is tested once a ray.",
            kind: ParamKind::Choice(&["on", "off"]),
            default: "on",
        },
        Settings::SHAPE,
    ],
    control: false,
    resolution: Some(Resolution {
        auto: |mesh, params| Model::new(mesh, Settings::read(params)).auto().0,
        predict: |mesh, params, n| Model::new(mesh, Settings::read(params)).predict(n),
    }),
    peer: None,
    build,
};

/// How a triangle is found to touch a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OverlapTest {
    Three,
    Separating,
    /// A mistake that is exhibited.
    SingleSeparating,
    Boxes,
}

/// The parameters, read.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settings {
    overlap: OverlapTest,
    mailbox: bool,
    pub(super) shape: Shape,
}

impl Settings {
    /// The parameter `overlap`.
    pub(super) const OVERLAP: ParamSpec = ParamSpec {
        name: "overlap",
        about: "How a triangle is found to touch a cell: vertices, edges and diagonals; separating axes; or boxes.",
        kind: ParamKind::Choice(&["three-test", "sat", "bbox"]),
        default: "three-test",
    };

    /// The parameter `shape`.
    pub(super) const SHAPE: ParamSpec = ParamSpec {
        name: "shape",
        about: "n cells on every axis, or n on the longest and cells as cubic as possible.",
        kind: ParamKind::Choice(&["n3", "cubic"]),
        default: "n3",
    };

    /// As [`Settings::SHAPE`] for grids that need not be told to be cubic: long cells of flat scenes are met by many rays.
    pub(super) const CUBIC_SHAPE: ParamSpec = ParamSpec {
        default: "cubic",
        ..Self::SHAPE
    };

    pub(super) fn read(params: &Params) -> Self {
        Self {
            overlap: match params.text("overlap") {
                "sat" => OverlapTest::Separating,
                "bbox" => OverlapTest::Boxes,
                _ => OverlapTest::Three,
            },
            mailbox: params.text("mailbox") != "off",
            shape: match params.text("shape") {
                "cubic" => Shape::Cubic,
                _ => Shape::N3,
            },
        }
    }

    /// Lists the triangles of `mesh` in the cells of `lattice`; `None` if these are more than `most` references.
    pub(super) fn lists(self, lattice: &Lattice, mesh: &Mesh, most: u64) -> Option<Lists> {
        match self.overlap {
            OverlapTest::Three => Lists::build::<ThreeTest>(lattice, mesh, most),
            OverlapTest::Separating => Lists::build::<Separating>(lattice, mesh, most),
            OverlapTest::SingleSeparating => {
                let bare = Lattice {
                    pad: 0.0,
                    ..*lattice
                };
                Lists::build::<SingleSeparating>(&bare, mesh, most)
            }
            OverlapTest::Boxes => Lists::build::<Boxes>(lattice, mesh, most),
        }
    }

    /// Lists some triangles of `mesh`, whose indices ascend, in the cells of `lattice`; `None` if these are more than `most`
    /// references.
    pub(super) fn lists_of(
        self,
        lattice: &Lattice,
        mesh: &Mesh,
        some: &[u32],
        most: usize,
    ) -> Option<Lists> {
        match self.overlap {
            OverlapTest::Separating => Lists::of_some::<Separating>(lattice, mesh, some, most),
            OverlapTest::Boxes => Lists::of_some::<Boxes>(lattice, mesh, some, most),
            _ => Lists::of_some::<ThreeTest>(lattice, mesh, some, most),
        }
    }

    /// Whether every cell of a triangle's box lists it.
    fn lists_boxes(self) -> bool {
        self.overlap == OverlapTest::Boxes
    }
}

fn build(request: &BuildRequest) -> Result<Box<dyn Accelerator>, BuildError> {
    let settings = Settings::read(request.params);
    let n = request.n.unwrap_or(1).max(1);
    if settings.mailbox {
        finish(Grid::<Hashed>::new(request, settings, n)?, request)
    } else {
        finish(Grid::<Forgetful>::new(request, settings, n)?, request)
    }
}

/// The structure `grid`.
struct Grid<M> {
    lattice: Lattice,
    lists: Lists,
    mailbox: PhantomData<M>,
}

impl<M> Grid<M> {
    /// Builds the grid of `request.mesh` at `n`.
    ///
    /// # Errors
    /// It would take more memory than allowed, by prediction before anything is allocated, or by count while the
    /// references are found.
    fn new(request: &BuildRequest, settings: Settings, n: u32) -> Result<Self, BuildError> {
        let mesh: &Mesh = request.mesh;
        let model = Model::new(mesh, settings);
        let limit = request.memory_limit;
        let refuse = |predicted_bytes, largest_n| BuildError::TooLarge {
            accel: ENTRY.name,
            n,
            predicted_bytes,
            limit_bytes: limit,
            largest_n,
        };
        if n > MAX_N || model.bytes(n) > limit {
            return Err(refuse(model.bytes(n), model.largest_n(limit)));
        }
        let lattice = Lattice::new(mesh.bounds(), model.dims(n));
        let most = (limit - lists::bytes(lattice.len(), 0).min(limit)) / size_of::<u32>() as u64;
        match settings.lists(&lattice, mesh, most) {
            Some(lists) => Ok(Self {
                lattice,
                lists,
                mailbox: PhantomData,
            }),
            // The model was too low for this mesh, by an unknown factor: half the resolution is a safe advice.
            None => Err(refuse(limit + 1, (n / 2).min(model.largest_n(limit)))),
        }
    }
}

impl<M: Mailbox> Grid<M> {
    /// Leads `visitor` as [`Structure::traverse`] asks; `ACCUMULATE` and `INSIDE_ONLY` are mistakes that are exhibited.
    #[inline(always)]
    fn lead<const ACCUMULATE: bool, const INSIDE_ONLY: bool, V: Visitor>(
        &self,
        ray: &Ray,
        mailbox: &mut M,
        visitor: &mut V,
    ) {
        let Some(mut walk) = Walk::<ACCUMULATE>::new(&self.lattice, ray) else {
            return;
        };
        mailbox.begin();
        loop {
            let list = self.lists.of(walk.cell);
            let exit = walk.exit();
            visitor.step(
                walk.cell as u64,
                true,
                list.len() as u32,
                walk.base + walk.entry,
                walk.base + exit,
            );
            if INSIDE_ONLY {
                let [from, to] = walk.inside();
                visitor.narrow(from, to);
            }
            for &prim in list {
                if !mailbox.takes(prim) {
                    visitor.skipped(prim);
                } else if visitor.test(prim) {
                    return;
                }
            }
            if !walk.advance(exit, visitor.t_limit()) {
                return;
            }
        }
    }
}

impl<M: Mailbox> Structure for Grid<M> {
    type Items = Singles;
    type Scratch = M;

    fn leaf(&self) -> PlaceKind {
        PlaceKind::Cell
    }

    fn scratch(&self) -> M {
        M::default()
    }

    #[inline(always)]
    fn traverse<I: Isa, V: Visitor>(&self, ray: &Ray, mailbox: &mut M, visitor: &mut V) {
        self.lead::<false, false, V>(ray, mailbox, visitor);
    }

    fn place_bounds(&self, place: u64) -> Option<Aabb> {
        let cell = self.lattice.cell(place)?;
        let corner = |end: u32| {
            let plane = |a: usize| self.lattice.plane(a, cell[a] + end) as f32;
            Vec3::from_array([0, 1, 2].map(plane))
        };
        Some(Aabb {
            min: corner(0),
            max: corner(1),
        })
    }

    fn stats(&self) -> StructureStats {
        let cells = self.lists.offsets.windows(2).map(|pair| pair[1] - pair[0]);
        StructureStats {
            cells: self.lattice.len(),
            empty_cells: cells.clone().filter(|&len| len == 0).count() as u64,
            references: self.lists.prims.len() as u64,
            depth: 0,
            longest_list: cells.max().unwrap_or(0),
            dims: Some(self.lattice.dims),
        }
    }

    fn memory_bytes(&self) -> u64 {
        self.lists.bytes()
    }

    fn validate(&self, mesh: &Mesh, _: &[u32]) -> Result<(), String> {
        validate::check(&self.lattice, &self.lists, mesh)
    }
}
