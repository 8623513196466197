//! Exhibits: structures that make a known mistake on purpose, so that the stability suite shows it.
//!
//! ```text
//! Traced<Exhibit<S>, K> ── one call ──▶ S::lead(ray, Behind(&mut dyn …))     S: a sound structure with one part exchanged
//! ```
//!
//! An exhibit is the traversal of a sound structure with one strategy exchanged, never a copy of it. It need not be fast:
//! its visitor stands behind a pointer, so that each exhibit is compiled once, not once a kernel and query.

use crate::geometry::lanes::Isa;
use crate::geometry::{Aabb, Ray};
use crate::scene::Mesh;

use super::{PlaceKind, Singles, Structure, StructureStats, Visitor};

/// A structure whose rays are led through it in a wrong way.
pub(super) trait Wrong: Send + Sync + 'static {
    /// The structure, which is sound but for the mistake.
    type Sound: Structure<Items = Singles>;

    /// The structure.
    fn sound(&self) -> &Self::Sound;

    /// See [`Structure::traverse`].
    fn lead(
        &self,
        ray: &Ray,
        scratch: &mut <Self::Sound as Structure>::Scratch,
        visitor: &mut Behind,
    );
}

/// The structure of an exhibit.
pub(super) struct Exhibit<W>(pub W);

/// What a visitor does, behind a pointer.
trait AnyVisitor {
    fn step(&mut self, place: u64, leaf: bool, references: u32, entry: f64, exit: f64);
    fn test(&mut self, item: u32) -> bool;
    fn skipped(&mut self, prim: u32);
    fn t_limit(&self) -> f32;
    fn narrow(&mut self, from: f32, to: f32);
}

impl<V: Visitor> AnyVisitor for V {
    fn step(&mut self, place: u64, leaf: bool, references: u32, entry: f64, exit: f64) {
        Visitor::step(self, place, leaf, references, entry, exit);
    }
    fn test(&mut self, item: u32) -> bool {
        Visitor::test(self, item)
    }
    fn skipped(&mut self, prim: u32) {
        Visitor::skipped(self, prim);
    }
    fn t_limit(&self) -> f32 {
        Visitor::t_limit(self)
    }
    fn narrow(&mut self, from: f32, to: f32) {
        Visitor::narrow(self, from, to);
    }
}

/// A visitor behind a pointer.
pub(super) struct Behind<'a>(&'a mut dyn AnyVisitor);

impl Visitor for Behind<'_> {
    // Whoever looks is told; whoever does not, ignores it.
    const WATCHED: bool = true;

    fn step(&mut self, place: u64, leaf: bool, references: u32, entry: f64, exit: f64) {
        self.0.step(place, leaf, references, entry, exit);
    }
    fn test(&mut self, item: u32) -> bool {
        self.0.test(item)
    }
    fn skipped(&mut self, prim: u32) {
        self.0.skipped(prim);
    }
    fn t_limit(&self) -> f32 {
        self.0.t_limit()
    }
    fn narrow(&mut self, from: f32, to: f32) {
        self.0.narrow(from, to);
    }
}

impl<W: Wrong> Structure for Exhibit<W> {
    type Items = Singles;
    type Scratch = <W::Sound as Structure>::Scratch;

    const LEAF: PlaceKind = W::Sound::LEAF;

    fn scratch(&self) -> Self::Scratch {
        self.0.sound().scratch()
    }

    fn traverse<I: Isa, V: Visitor>(
        &self,
        ray: &Ray,
        scratch: &mut Self::Scratch,
        visitor: &mut V,
    ) {
        self.0.lead(ray, scratch, &mut Behind(visitor));
    }

    fn place_bounds(&self, place: u64) -> Option<Aabb> {
        self.0.sound().place_bounds(place)
    }

    fn stats(&self) -> StructureStats {
        self.0.sound().stats()
    }

    fn memory_bytes(&self) -> u64 {
        self.0.sound().memory_bytes()
    }

    fn validate(&self, mesh: &Mesh, lanes: &[u32]) -> Result<(), String> {
        self.0.sound().validate(mesh, lanes)
    }
}
