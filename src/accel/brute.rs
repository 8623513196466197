//! Brute force: every triangle, in file order. The judge of all others.

use crate::geometry::Ray;
use crate::geometry::lanes::Isa;
use crate::scene::Mesh;

use super::{AcceleratorEntry, Singles, Structure, StructureStats, Visitor, finish};

pub(super) const ENTRY: AcceleratorEntry = AcceleratorEntry {
    name: "brute",
    about: "Tests every triangle: no structure, and the judge of all others.",
    paper: "",
    params: &[],
    control: false,
    resolution: None,
    peer: None,
    build: |request| {
        let triangles = request.mesh.len() as u32;
        finish(Brute { triangles }, request)
    },
};

/// The structure `brute`: a count of triangles.
#[derive(Debug, Clone, Copy)]
pub struct Brute {
    triangles: u32,
}

impl Structure for Brute {
    type Items = Singles;
    type Scratch = ();

    fn scratch(&self) {}

    #[inline(always)]
    fn traverse<I: Isa, V: Visitor>(&self, ray: &Ray, (): &mut (), visitor: &mut V) {
        visitor.step(
            0,
            true,
            self.triangles,
            f64::from(ray.t_min),
            f64::from(ray.t_max),
        );
        for prim in 0..self.triangles {
            if visitor.test(prim) {
                return;
            }
        }
    }

    fn stats(&self) -> StructureStats {
        StructureStats {
            cells: 1,
            empty_cells: u64::from(self.triangles == 0),
            references: u64::from(self.triangles),
            longest_list: self.triangles,
            ..StructureStats::default()
        }
    }

    fn memory_bytes(&self) -> u64 {
        0
    }

    fn validate(&self, mesh: &Mesh, _: &[u32]) -> Result<(), String> {
        if mesh.len() as u32 == self.triangles {
            Ok(())
        } else {
            Err("brute counts other triangles than the mesh has".to_owned())
        }
    }
}
