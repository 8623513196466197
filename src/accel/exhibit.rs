//! Exhibits: structures that make a known mistake on purpose, so that the stability suite shows it.
//!
//! ```text
//! Traced<Exhibit, K> ──▶ dyn AnyWrong ──▶ W::lead(ray, visitor)     W: a sound structure with one part exchanged
//! ```
//!
//! An exhibit is the traversal of a sound structure with one strategy exchanged, never a copy of it. It need not be fast,
//! so it is compiled once, not once a kernel and query, and all exhibits are one type to what is.

use crate::geometry::lanes::Isa;
use crate::geometry::{Aabb, Ray};
use crate::scene::Mesh;

use super::behind::Behind;
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

/// As [`Wrong`], of a type that is not known.
trait AnyWrong: Send + Sync {
    fn leaf(&self) -> PlaceKind;
    fn lead(&self, ray: &Ray, visitor: Behind<true>);
    /// Where any hit will do.
    fn lead_unordered(&self, ray: &Ray, visitor: Behind<false>);
    fn place_bounds(&self, place: u64) -> Option<Aabb>;
    fn stats(&self) -> StructureStats;
    fn memory_bytes(&self) -> u64;
    fn validate(&self, mesh: &Mesh, lanes: &[u32]) -> Result<(), String>;
}

impl<W: Wrong> AnyWrong for W {
    fn leaf(&self) -> PlaceKind {
        self.sound().leaf()
    }

    fn lead(&self, ray: &Ray, mut visitor: Behind<true>) {
        Wrong::lead(self, ray, &mut self.sound().scratch(), &mut visitor);
    }

    fn lead_unordered(&self, ray: &Ray, mut visitor: Behind<false>) {
        Wrong::lead(self, ray, &mut self.sound().scratch(), &mut visitor);
    }

    fn place_bounds(&self, place: u64) -> Option<Aabb> {
        self.sound().place_bounds(place)
    }

    fn stats(&self) -> StructureStats {
        self.sound().stats()
    }

    fn memory_bytes(&self) -> u64 {
        self.sound().memory_bytes()
    }

    fn validate(&self, mesh: &Mesh, lanes: &[u32]) -> Result<(), String> {
        self.sound().validate(mesh, lanes)
    }
}

/// The structure of an exhibit.
pub(super) struct Exhibit(Box<dyn AnyWrong>);

impl Exhibit {
    pub fn of(wrong: impl Wrong) -> Self {
        Self(Box::new(wrong))
    }
}

impl Structure for Exhibit {
    type Items = Singles;
    /// A ray's own is made when it is led.
    type Scratch = ();

    const DIRECT: bool = false;

    fn leaf(&self) -> PlaceKind {
        self.0.leaf()
    }

    fn scratch(&self) {}

    fn traverse<I: Isa, V: Visitor>(&self, ray: &Ray, (): &mut (), visitor: &mut V) {
        if V::ORDERED {
            self.0.lead(ray, Behind::new(visitor));
        } else {
            self.0.lead_unordered(ray, Behind::new(visitor));
        }
    }

    fn place_bounds(&self, place: u64) -> Option<Aabb> {
        self.0.place_bounds(place)
    }

    fn stats(&self) -> StructureStats {
        self.0.stats()
    }

    fn memory_bytes(&self) -> u64 {
        self.0.memory_bytes()
    }

    fn validate(&self, mesh: &Mesh, lanes: &[u32]) -> Result<(), String> {
        self.0.validate(mesh, lanes)
    }
}
