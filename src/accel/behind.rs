//! A visitor behind a pointer, for structures that are compiled once, not once a kernel and query.
//!
//! ```text
//! DIRECT       traverse::<Query<woop, closest>>    traverse::<Query<woop, occlusion>>    traverse::<Query<exact, …>>  …
//! not DIRECT   traverse::<Behind> ── one call an item ──▶ Query<woop, closest>, Query<woop, occlusion>, Query<exact, …>  …
//! ```
//!
//! A call costs a few nanoseconds, and the compiler a second less for each kernel; [`Structure::DIRECT`] says what was
//! chosen for each structure. Traversals that are counted or recorded, and those without vector instructions on a processor
//! that has them, are not there for their speed and go this way too.
//!
//! [`Structure::DIRECT`]: super::Structure::DIRECT

use crate::geometry::Ray;
use crate::geometry::lanes::Portable;

use super::Structure;
use super::visit::Visitor;

/// What a visitor does.
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
        Visitor::test_apart(self, item)
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
pub(super) struct Behind<'a, const ORDERED: bool> {
    visitor: &'a mut dyn AnyVisitor,
    watched: bool,
}

impl<'a, const ORDERED: bool> Behind<'a, ORDERED> {
    pub fn new<V: Visitor>(visitor: &'a mut V) -> Self {
        Self {
            watched: V::WATCHED,
            visitor,
        }
    }
}

/// Leads `visitor` through `structure`, behind a pointer.
pub(super) fn lead<S: Structure + ?Sized, V: Visitor>(
    structure: &S,
    ray: &Ray,
    scratch: &mut S::Scratch,
    visitor: &mut V,
) {
    if V::ORDERED {
        lead_apart(structure, ray, scratch, Behind::<true>::new(visitor));
    } else {
        lead_apart(structure, ray, scratch, Behind::<false>::new(visitor));
    }
}

/// Compiled once a structure and order: within [`lead`] it would be once a kernel and query again.
#[inline(never)]
fn lead_apart<S: Structure + ?Sized, const ORDERED: bool>(
    structure: &S,
    ray: &Ray,
    scratch: &mut S::Scratch,
    mut visitor: Behind<'_, ORDERED>,
) {
    structure.traverse::<Portable, _>(ray, scratch, &mut visitor);
}

impl<const ORDERED: bool> Visitor for Behind<'_, ORDERED> {
    const ORDERED: bool = ORDERED;
    // Whoever looks is told; for whoever does not, it is computed in vain.
    const WATCHED: bool = true;

    #[inline]
    fn step(&mut self, place: u64, leaf: bool, references: u32, entry: f64, exit: f64) {
        if self.watched {
            self.visitor.step(place, leaf, references, entry, exit);
        }
    }
    #[inline]
    fn test(&mut self, item: u32) -> bool {
        self.visitor.test(item)
    }
    #[inline]
    fn skipped(&mut self, prim: u32) {
        if self.watched {
            self.visitor.skipped(prim);
        }
    }
    #[inline]
    fn t_limit(&self) -> f32 {
        self.visitor.t_limit()
    }
    #[inline]
    fn narrow(&mut self, from: f32, to: f32) {
        self.visitor.narrow(from, to);
    }
}
