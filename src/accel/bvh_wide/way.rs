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

/// A tree of this size stays in the caches near a core, where taking turns costs more than it hides. Measured on bunny
/// (5 MB), armadillo and sponza (20 MB), where it lost up to a fifth, and on two meshes of 55 MB, where it won a sixth to a
/// half.
const NEAR_CACHES: usize = 24 << 20;

/// Neighbours whose directions are closer than this (the cosine) find in the caches what the one before left there.
const COHERENT: f32 = 0.9;

/// Chooses the way for `rays`, of which any hit is asked, or the nearest.
pub(super) fn choose(tree: &BvhWide, rays: &[Ray], any_hit: bool) -> Way {
    if share_origin(rays) {
        return Way::Packets;
    }
    let coherent = are_coherent(rays);
    if any_hit && coherent {
        return Way::Hybrid;
    }
    // A block is as large as a node and a quarter.
    let bytes = (tree.nodes.len() + tree.filled.len() * 5 / 4) * size_of::<Node>();
    if bytes > NEAR_CACHES && !coherent {
        Way::Interleaved
    } else {
        Way::Single
    }
}

/// Whether most rays of a sample have nearly the direction of the one before.
fn are_coherent(rays: &[Ray]) -> bool {
    let pairs = rays.windows(2).step_by(16);
    let close = |pair: &&[Ray]| {
        let [a, b] = [pair[0].dir, pair[1].dir];
        let dot = a.dot(b);
        // NaN, of directions whose squares overflow, is not close.
        dot > 0.0 && dot * dot > COHERENT * COHERENT * a.length_squared() * b.length_squared()
    };
    pairs.clone().filter(close).count() * 2 > pairs.count()
}
