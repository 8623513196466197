//! The way in which a batch of rays is traced, decided by looking at the rays and the tree.

use crate::geometry::Ray;
use crate::registry::{ParamKind, ParamSpec, Params};

use super::super::packets::share_origin;
use super::{BvhWide, Node};

/// How a batch is traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Way {
    /// One ray after another.
    Single,
    /// Rays from one origin go together.
    Packets,
    /// Sixteen rays at once where they visit the same nodes.
    Hybrid,
    /// Several rays take turns, each while the memory fetches for the others.
    Interleaved,
}

impl Way {
    /// The parameter that asks for a way: for tests and for measuring what the choice is worth.
    pub const PARAM: ParamSpec = ParamSpec {
        name: "way",
        about: "How a batch of rays is traced; `auto` looks at the rays and the tree. Kernels that make no packets have but one way: `single`.",
        kind: ParamKind::Choice(&["auto", "single", "hybrid", "interleaved", "packets"]),
        default: "auto",
    };

    /// The way that `params` ask for, if any.
    pub fn of(params: &Params) -> Option<Self> {
        match params.text("way") {
            "single" => Some(Self::Single),
            "packets" => Some(Self::Packets),
            "hybrid" => Some(Self::Hybrid),
            "interleaved" => Some(Self::Interleaved),
            _ => None,
        }
    }
}

/// What is done with a batch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Plan {
    /// Its way is known.
    Known(Way),
    /// The first rays go the way of [`Way::Hybrid`], and the others too if these shared much of theirs; else one by one.
    Tried,
}

/// A tree of this size stays in the caches near a core, where taking turns costs more than it hides. Measured with bounce
/// rays on bunny (4 MB), armadillo and sponza (20 MB), where it lost up to a tenth, and on two meshes of 55 MB, where it
/// won a twentieth, and up to a half with random ones.
const NEAR_CACHES: usize = 24 << 20;

/// For rays that begin far from each other that is less: what one needs is not there yet for the next. Measured with
/// random rays: a fifth won on bunny (4 MB) and armadillo, a tenth lost on sponza.
const OWN_CACHE: usize = 3 << 20;

/// Neighbours whose directions are closer than this (the cosine) find in the caches what the one before left there.
const COHERENT: f32 = 0.9;

/// Neighbours whose origins are closer than this part of the scene's diagonal begin at the same place.
const NEAR: f32 = 0.05;

/// Decides how `rays`, of which any hit is asked, or the nearest, are traced.
pub(super) fn choose(tree: &BvhWide, rays: &[Ray], any_hit: bool) -> Plan {
    if share_origin(rays) {
        return Plan::Known(Way::Packets);
    }
    let coherent = most(rays, have_like_directions);
    if any_hit && coherent {
        return Plan::Known(Way::Hybrid);
    }
    let near = NEAR * tree.scene.bounds.extent().length();
    let begin_near = most(rays, |a, b| {
        a.origin.distance_squared(b.origin) < near * near
    });
    // A block is as large as a node and a quarter.
    let bytes = (tree.nodes.len() + tree.filled.len() * 5 / 4) * size_of::<Node>();
    let cached = if begin_near { NEAR_CACHES } else { OWN_CACHE };
    if bytes > cached && !coherent {
        Plan::Known(Way::Interleaved)
    } else if begin_near {
        Plan::Tried
    } else {
        Plan::Known(Way::Single)
    }
}

/// Whether `holds` for most rays of a sample and the ray after each.
fn most(rays: &[Ray], holds: impl Fn(&Ray, &Ray) -> bool) -> bool {
    let pairs = rays.windows(2).step_by(16);
    let held = pairs.clone().filter(|pair| holds(&pair[0], &pair[1]));
    held.count() * 2 > pairs.count()
}

/// Whether two rays have nearly the same direction. NaN, of directions whose squares overflow, is not close.
fn have_like_directions(a: &Ray, b: &Ray) -> bool {
    let (a, b) = (a.dir, b.dir);
    let dot = a.dot(b);
    dot > 0.0 && dot * dot > COHERENT * COHERENT * a.length_squared() * b.length_squared()
}
