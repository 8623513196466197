//! Accelerators: spatial structures that choose, conservatively, which triangles a ray meets, in which order, and when
//! it may stop. They never decide a hit and know nothing of kernels, colours, files or time.
//!
//! ```text
//! Structure (one room each: brute, grid, plane_tree, bvh)    Kernel (crate::kernel)
//!        \  traverse(ray, visitor)                          /  intersect(ray, triangles)
//!         \                Items: single triangles, blocks  /
//!          `-----------------  Traced<S, K>  --------------'
//!                                   |   for the instruction set of the machine
//!                        dyn Accelerator: batches of rays -> hits, counts
//! ```
//!
//! **The rule.** Wherever brute force with the same kernel is right, every accelerator gives the same triangle and the
//! same `t`, bit for bit. Two things make it hold: a structure visits every place that the exact ray touches, and it
//! stops only where the next place begins beyond [`Visitor::t_limit`], which lies behind the nearest hit by the
//! kernel's own error bound. Equal `t`: the lowest triangle index wins, in whatever order the tests came.
//!
//! To add one: a file here with a type that implements [`Structure`], and a row in [`ACCELERATORS`].

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::geometry::lanes::{InstructionSet, Isa};
use crate::geometry::{Aabb, Hit, Ray};
use crate::kernel;
use crate::registry::{Choice, ChoiceError, ParamSpec, Params};
use crate::scene::Mesh;

mod auto;
mod batch;
mod behind;
mod brute;
mod bsp_tree;
mod bvh;
mod bvh_wide;
mod clip;
mod exhibit;
mod grid;
mod grid_skip;
mod grid_two_level;
mod items;
mod kd_tree;
mod octree;
mod packet;
mod packets;
mod pages;
mod parallel;
mod peers;
mod plane_tree;
mod query;
mod record;
mod sah;
mod share;
mod slab;
mod stack;
#[cfg(test)]
mod testbed;
mod traced;
mod visit;

pub use auto::picked;
pub use batch::Rays;
pub use brute::Brute;
pub use bvh::Bvh;
pub use items::{Blocks, Items, Singles};
pub use peers::{Peer, Standing};
pub use plane_tree::PlaneTree;
pub use record::{Outcome, PlaceKind, Recording, Test, Visit};
pub use traced::finish;
pub use visit::{Counts, Visitor};

/// A spatial structure over the triangles of one mesh.
pub trait Structure: Send + Sync + 'static {
    /// How its triangles lie in memory, and so what the numbers mean that it hands to [`Visitor::test`].
    type Items: Items;
    /// What one thread needs beside the structure to traverse it, e.g. mailboxes.
    type Scratch: Send;

    /// Whether the traversal is compiled for each kernel and query, so that tests are no calls; else once, see `behind`.
    const DIRECT: bool = true;

    /// What the places that list triangles are called.
    fn leaf(&self) -> PlaceKind {
        PlaceKind::Leaf
    }

    /// A fresh scratch.
    fn scratch(&self) -> Self::Scratch;

    /// Leads `visitor` through every cell or node that `ray` touches, near ones first where the structure can tell.
    ///
    /// Calls [`Visitor::step`] for each cell or node and [`Visitor::test`] for each item it offers; returns at once
    /// when a test says that the query is finished, and when what is left begins beyond [`Visitor::t_limit`].
    fn traverse<I: Isa, V: Visitor>(&self, ray: &Ray, scratch: &mut Self::Scratch, visitor: &mut V);

    /// Answers a batch in the way that suits its rays: here one after another. Right answers are the same in every way.
    #[inline(always)]
    fn trace<'a, R: Rays<'a>>(&self, batch: &mut R, scratch: &mut Self::Scratch) {
        for index in 0..batch.rays().len() {
            let mut visitor = batch.begin(index);
            let ray = &batch.rays()[index];
            self.lead::<R::Isa, _>(ray, scratch, &mut visitor);
            batch.finish(index, &visitor);
        }
    }

    /// As [`Structure::traverse`], directly or with the visitor behind a pointer.
    #[inline(always)]
    fn lead<I: Isa, V: Visitor>(&self, ray: &Ray, scratch: &mut Self::Scratch, visitor: &mut V) {
        // Unit tests take the other way, and are compiled sooner; tests/matrix takes this one.
        if Self::DIRECT && V::DIRECT && (I::SIXTEEN || !Self::Items::LANES) && !cfg!(test) {
            self.traverse::<I, _>(ray, scratch, visitor);
        } else {
            behind::lead(self, ray, scratch, visitor);
        }
    }

    /// The box of a place that [`Visitor::step`] named, rounded to `f32`; `None` where the structure has none or no such
    /// place. Asked only where a ray's way is recorded: at most linear in the depth.
    fn place_bounds(&self, _place: u64) -> Option<Aabb> {
        None
    }

    /// Sizes and shape.
    fn stats(&self) -> StructureStats;

    /// Bytes of the structure itself, without the packed triangles.
    fn memory_bytes(&self) -> u64;

    /// Checks what the structure promises: every triangle is referenced where it must be, boxes contain their parts,
    /// depths stay within the stack. `lanes` is the triangle in each lane of each of its blocks, empty where its items are
    /// single triangles.
    ///
    /// # Errors
    /// A sentence that names the first broken promise.
    fn validate(&self, mesh: &Mesh, lanes: &[u32]) -> Result<(), String>;
}

/// Sizes and shape of a structure; what does not apply is 0.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct StructureStats {
    /// Cells of a grid, or nodes (interior ones and leaves) of a tree.
    pub cells: u64,
    /// Cells or leaves that hold no reference.
    pub empty_cells: u64,
    /// References to triangles.
    pub references: u64,
    /// Longest way from the root to a leaf; 0 for a single leaf and for grids.
    pub depth: u32,
    /// References in the fullest cell or leaf.
    pub longest_list: u32,
    /// Cells along x, y and z of a grid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dims: Option<[u32; 3]>,
}

/// A structure bound to a kernel: what rays are traced through.
pub trait Accelerator: Send + Sync {
    /// The nearest hit of each ray. `hits` is as long as `rays`.
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]);
    /// Whether anything lies within each ray's interval. `blocked` is as long as `rays`.
    fn occluded(&self, rays: &[Ray], blocked: &mut [bool]);
    /// As [`Accelerator::closest`], counting the work of each ray.
    fn closest_counted(&self, rays: &[Ray], hits: &mut [Hit], counts: &mut [Counts]);
    /// As [`Accelerator::occluded`], counting the work of each ray.
    fn occluded_counted(&self, rays: &[Ray], blocked: &mut [bool], counts: &mut [Counts]);
    /// Every step and every test of the closest-hit query of a valid ray; the same answer as [`Accelerator::closest`].
    fn inspect(&self, ray: &Ray) -> Recording;
    /// The instruction set that batches are traced with; [`InstructionSet::Portable`] where it makes no difference.
    fn instruction_set(&self) -> InstructionSet {
        InstructionSet::Portable
    }
    /// Sizes and shape of the structure.
    fn stats(&self) -> StructureStats;
    /// Bytes of structure and packed triangles together.
    fn memory_bytes(&self) -> u64;
    /// See [`Structure::validate`].
    ///
    /// # Errors
    /// A sentence that names the first broken promise.
    fn validate(&self) -> Result<(), String>;
}

/// What a build needs. Parallel builders use the rayon pool they are called in.
#[derive(Debug, Clone, Copy)]
pub struct BuildRequest<'a> {
    /// The triangles.
    pub mesh: &'a Arc<Mesh>,
    /// The kernel that will test them.
    pub kernel: &'a Choice,
    /// The accelerator's parameters, all set.
    pub params: &'a Params,
    /// Grid resolution; `None` for structures without one.
    pub n: Option<u32>,
    /// Bytes the structure may take; a larger one is refused before it is allocated.
    pub memory_limit: u64,
    /// The instruction set to trace with.
    pub set: InstructionSet,
}

/// Why a structure was not built.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum BuildError {
    /// The structure would not fit.
    #[error(
        "{accel} at n = {n} would take about {} MB, more than the limit of {} MB; the largest n that fits is {largest_n}",
        predicted_bytes.div_ceil(1 << 20), limit_bytes >> 20
    )]
    TooLarge {
        /// The accelerator.
        accel: &'static str,
        /// The resolution asked for.
        n: u32,
        /// What it would take.
        predicted_bytes: u64,
        /// What it may take.
        limit_bytes: u64,
        /// The greatest resolution within the limit.
        largest_n: u32,
    },
    /// A structure without a resolution that grew beyond what it may take.
    #[error(
        "{accel} over this scene takes more than the limit of {} MB; choose a structure that lists each triangle once, e.g. bvh-wide",
        limit_bytes >> 20
    )]
    Outgrown {
        /// The accelerator.
        accel: &'static str,
        /// What it may take.
        limit_bytes: u64,
    },
    /// A peer that cannot take this mesh.
    #[error("{accel} cannot take {why}; choose another accelerator for this scene")]
    Unfit {
        /// The accelerator.
        accel: &'static str,
        /// What it cannot take.
        why: String,
    },
    /// A peer whose library is not on this machine, or failed.
    #[error("{0}")]
    Unavailable(String),
    /// The kernel or a parameter is not known.
    #[error(transparent)]
    Choice(#[from] ChoiceError),
}

/// What a model predicts of a grid before it is built.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Prediction {
    /// The predicted best n: what `--n auto` takes.
    pub n: u32,
    /// Least and greatest n whose predicted cost is within 5 % of the best: the plateau of ties.
    pub plateau: [u32; 2],
    /// Predicted references at the n that was built.
    pub references: f64,
    /// Predicted cells visited by a random line through the box.
    pub steps: f64,
    /// Predicted tests of a random line through the box.
    pub tests: f64,
}

/// What structures with a resolution can do beside being built.
#[derive(Debug, Clone, Copy)]
pub struct Resolution {
    /// The best n for `mesh`, by a closed-form model.
    pub auto: fn(mesh: &Mesh, params: &Params) -> u32,
    /// What the model says of `mesh` at `n`.
    pub predict: fn(mesh: &Mesh, params: &Params, n: u32) -> Prediction,
}

/// A row of the accelerator registry.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct AcceleratorEntry {
    /// Kebab-case name.
    pub name: &'static str,
    /// One sentence.
    pub about: &'static str,
    /// Where it was published.
    pub paper: &'static str,
    /// Parameters beside n.
    pub params: &'static [ParamSpec],
    /// Whether it makes a known mistake on purpose: an exhibit of the stability suite, chosen only by name.
    pub control: bool,
    /// Present where the structure has a resolution n.
    #[serde(skip)]
    pub resolution: Option<Resolution>,
    /// Present where it is another library's; `None` for raylab's own, which obey the rule of this room.
    #[serde(skip)]
    pub peer: Option<Peer>,
    /// Builds it.
    #[serde(skip)]
    pub build: fn(&BuildRequest) -> Result<Box<dyn Accelerator>, BuildError>,
}

impl AcceleratorEntry {
    /// Whose it is, and whether it can be built here.
    #[must_use]
    pub fn standing(&self) -> Standing {
        Standing::of(self.peer.as_ref(), &Params::defaults(self.params))
    }

    /// What decides hits with these parameters in place of the run's kernel; `None` where the kernel does.
    #[must_use]
    pub fn own_test(&self, params: &Params) -> Option<&'static str> {
        (self.peer?.own_test)(params)
    }
}

/// All accelerators, in the order in which they are listed.
///
/// A static, not a constant: a constant's functions would be compiled anew, for every kernel, in each program that names it.
pub static ACCELERATORS: &[AcceleratorEntry] = &[
    brute::ENTRY,
    grid::ENTRY,
    grid_skip::ENTRY,
    grid_two_level::ENTRY,
    kd_tree::ENTRY,
    octree::ENTRY,
    bsp_tree::ENTRY,
    bvh::ENTRY,
    bvh_wide::ENTRY,
    auto::ENTRY,
    peers::OBVHS,
    peers::BVH_CRATE,
    peers::EMBREE,
    grid::INCREMENTAL,
    grid::INSIDE_ONLY,
    grid::F32_OVERLAP,
    bvh::NAIVE_SLAB,
];

/// The accelerator taken where none is named: the fastest of raylab's own.
pub const DEFAULT: &str = "bvh-wide";

/// Greatest accepted n; DESIGN asks for 512, the format of the cells allows this.
pub const MAX_N: u32 = 1024;

/// Reads `name` or `name:key=value…`.
///
/// # Errors
/// An unknown name, parameter or value.
pub fn parse(text: &str) -> Result<Choice, ChoiceError> {
    Choice::parse(
        "accelerator",
        text,
        ACCELERATORS.iter().map(|a| (a.name, a.params)),
    )
}

/// The row named `name`.
///
/// # Errors
/// There is none; the message names the nearest.
pub fn entry(name: &str) -> Result<&'static AcceleratorEntry, ChoiceError> {
    ACCELERATORS.iter().find(|a| a.name == name).ok_or_else(|| {
        ChoiceError::unknown("accelerator", name, ACCELERATORS.iter().map(|a| a.name))
    })
}

/// Builds `accel` over `mesh` for `kernel`, with a resolution where it has one (`None`: predicted).
///
/// # Errors
/// Unknown names; a structure larger than the memory limit.
pub fn build(
    mesh: &Arc<Mesh>,
    accel: &Choice,
    n: Option<u32>,
    kernel: &Choice,
    memory_limit: u64,
) -> Result<Box<dyn Accelerator>, BuildError> {
    build_for(InstructionSet::best(), mesh, accel, n, kernel, memory_limit)
}

/// As [`build`], to be traced with an instruction set: what tests of their equality need.
///
/// # Errors
/// As [`build`].
pub fn build_for(
    set: InstructionSet,
    mesh: &Arc<Mesh>,
    accel: &Choice,
    n: Option<u32>,
    kernel: &Choice,
    memory_limit: u64,
) -> Result<Box<dyn Accelerator>, BuildError> {
    let entry = entry(&accel.name)?;
    kernel::parse(&kernel.name)?;
    let n = entry
        .resolution
        .map(|r| n.unwrap_or_else(|| (r.auto)(mesh, &accel.params)));
    (entry.build)(&BuildRequest {
        mesh,
        kernel,
        params: &accel.params,
        n,
        memory_limit,
        set,
    })
}
