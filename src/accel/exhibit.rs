//! Exhibits: structures that make a known mistake on purpose, so that the stability suite shows it.
//!
//! ```text
//! Traced<Exhibit<W>, K> ──▶ W::lead(ray, visitor)     W: a sound structure with one part exchanged
//! ```
//!
//! An exhibit is the traversal of a sound structure with one strategy exchanged, never a copy of it. It need not be fast,
//! so it is compiled once, not once a kernel and query.

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
    fn lead<V: Visitor>(
        &self,
        ray: &Ray,
        scratch: &mut <Self::Sound as Structure>::Scratch,
        visitor: &mut V,
    );
}

/// The structure of an exhibit.
pub(super) struct Exhibit<W>(pub W);

impl<W: Wrong> Structure for Exhibit<W> {
    type Items = Singles;
    type Scratch = <W::Sound as Structure>::Scratch;

    const LEAF: PlaceKind = W::Sound::LEAF;
    const DIRECT: bool = false;

    fn scratch(&self) -> Self::Scratch {
        self.0.sound().scratch()
    }

    fn traverse<I: Isa, V: Visitor>(
        &self,
        ray: &Ray,
        scratch: &mut Self::Scratch,
        visitor: &mut V,
    ) {
        self.0.lead(ray, scratch, visitor);
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
