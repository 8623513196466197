//! `bvh-naive-slab`: the tree with a slab test that forgets about 0 · ∞.

use crate::geometry::{Aabb, Ray};

use super::super::exhibit::{Exhibit, Wrong};
use super::super::slab::{BoxTest, Corners};
use super::super::stack::Room;
use super::super::{AcceleratorEntry, Visitor, finish};
use super::{Bvh, ENTRY};

/// The tree with the naive slab test.
pub(in super::super) const NAIVE_SLAB: AcceleratorEntry = AcceleratorEntry {
    name: "bvh-naive-slab",
    about: "A binary tree of boxes whose slab test multiplies 0 by infinity and does not pad, and so misses boxes.",
    paper: "Kay and Kajiya 1986, Ray Tracing Complex Scenes: as it is mostly written",
    control: true,
    build: |request| {
        finish(
            Exhibit::of(NaiveSlab(Bvh::build(request.mesh, request.params))),
            request,
        )
    },
    ..ENTRY
};

struct NaiveSlab(Bvh);

impl Wrong for NaiveSlab {
    type Sound = Bvh;

    fn sound(&self) -> &Bvh {
        &self.0
    }

    fn lead<V: Visitor>(&self, ray: &Ray, room: &mut Room, visitor: &mut V) {
        self.0.lead::<NaiveSlabs, _>(ray, room, visitor);
    }
}

/// A ray with the reciprocals of its direction.
#[derive(Debug, Clone, Copy)]
struct NaiveSlabs {
    origin: [f32; 3],
    inverse: [f32; 3],
    t_min: f32,
}

impl BoxTest for NaiveSlabs {
    fn new(ray: &Ray, _: &Aabb) -> Self {
        Self {
            origin: ray.origin.to_array(),
            inverse: ray.dir.recip().to_array(),
            t_min: ray.t_min,
        }
    }

    /// The mistake: (plane - origin) · inverse is 0 · ∞ = NaN for a ray in a face, and `min` and `max` drop the NaN for
    /// the other plane's infinity; and of a box that is touched in a corner, entry and exit are rounded apart.
    fn clip(&self, corners: &Corners, limit: f32) -> (f32, f32) {
        let (mut entry, mut exit) = (self.t_min, limit);
        let [least, greatest] = corners;
        for axis in 0..3 {
            let at = |plane: f32| (plane - self.origin[axis]) * self.inverse[axis];
            let (a, b) = (at(least[axis]), at(greatest[axis]));
            entry = entry.max(a.min(b));
            exit = exit.min(a.max(b));
        }
        (entry, exit)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::testbed::{built, mesh};
    use crate::geometry::{Hit, Ray, Vec3};

    #[test]
    fn a_ray_in_a_face_of_the_box_misses_it() {
        // The box is the unit cube; the ray runs in its face z = 1 and meets the edge there.
        let mesh = mesh(&[[
            Vec3::ZERO,
            Vec3::new(1.0, 0.0, 1.0),
            Vec3::new(0.0, 1.0, 1.0),
        ]]);
        let ray = Ray::new(Vec3::new(-4.0, 0.5, 1.0), Vec3::X);
        let hit = |accel| {
            let mut hits = [Hit::MISS];
            built(&mesh, accel, "woop").closest(&[ray], &mut hits);
            hits[0]
        };
        assert_eq!(hit("bvh").t, 4.5);
        assert!(!hit("bvh-naive-slab").is_hit());
    }
}
