//! The way in which a batch of rays is traced, decided by looking at the rays and the tree.

use std::ops::Range;

use crate::geometry::Ray;
use crate::registry::{ParamKind, ParamSpec, Params};

use super::super::batch::run_apart;
use super::super::packets::share_origin;
use super::super::{Rays, Visitor};
use super::BvhWide;
use super::hybrid::{Hybrid, WINDOW};
use super::interleaved::Interleaved;
use super::stack::Stacks;

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
    /// [`Way::Hybrid`] where that pays, else [`Way::Interleaved`].
    Mixed,
}

impl Way {
    /// The parameter that asks for a way: for tests and for measuring what the choice is worth.
    pub const PARAM: ParamSpec = ParamSpec {
        name: "way",
        about: "How a batch of rays is traced; `auto` looks at the rays and the tree. Kernels that make no packets have but one way, `single`; `exact` makes no groups of rays that any hit will do: these are `interleaved` where others are `hybrid` or `mixed`.",
        kind: ParamKind::Choice(&[
            "auto",
            "single",
            "hybrid",
            "interleaved",
            "mixed",
            "packets",
        ]),
        default: "auto",
    };

    /// The way that `params` ask for, if any.
    pub fn of(params: &Params) -> Option<Self> {
        match params.text("way") {
            "single" => Some(Self::Single),
            "packets" => Some(Self::Packets),
            "hybrid" => Some(Self::Hybrid),
            "interleaved" => Some(Self::Interleaved),
            "mixed" => Some(Self::Mixed),
            _ => None,
        }
    }
}

/// Neighbours whose origins are closer than this part of the scene's diagonal begin at the same place: so do those of bounce
/// and shadow rays, and they may have much of their way in common. Others are not even tried as groups.
const NEAR: f32 = 0.05;

/// Of how many rays the origins of one and its neighbour are compared.
const SAMPLED: usize = 64;

/// Decides how `rays` are traced.
pub(super) fn choose(tree: &BvhWide, rays: &[Ray]) -> Way {
    if share_origin(rays) {
        return Way::Packets;
    }
    let near = NEAR * tree.scene.bounds.extent().length();
    let begin_near = |pair: &&[Ray]| pair[0].origin.distance_squared(pair[1].origin) < near * near;
    let sample = rays.windows(2).step_by(SAMPLED);
    let (near_ones, pairs) = (sample.clone().filter(begin_near).count(), sample.len());
    if near_ones * 2 > pairs {
        Way::Mixed
    } else {
        Way::Interleaved
    }
}

/// Rays that go as groups while that pays: at first, and most at once.
const TOGETHER: Range<usize> = WINDOW..1024;

/// Rays that take turns until groups are tried again: at first, and most, where they were tried in vain again and again.
const APART: Range<usize> = 1024..8192;

/// So many rays of a group at a node, in the mean, cost less together than in turns. As measured: bounce rays share 10 of 16
/// where both are alike (with a bound of 9 those of `city:300` and `sphereflake:4` are 4 and 3 % slower, with 8 6 and 7 %),
/// shadow rays 9 to 14. Primary rays share less where both are alike: with 9 or 8 those of `plant` are 7 % faster than with 10,
/// of `city:300` and `sphereflake:4` within 2 %.
fn many<V: Visitor>(from_one_point: bool) -> u32 {
    match (V::ORDERED, from_one_point) {
        (false, _) => 9,
        (true, true) => 8,
        (true, false) => 10,
    }
}

/// Traces the rays of `batch` in `range` in groups where these share much of their way, else in turns.
///
/// That differs from place to place in a picture: with shadow rays of `plant` and bounce rays of the Crytek Sponza it is a
/// tenth faster than either way for all.
#[inline(always)]
pub(super) fn mixed<'a, R: Rays<'a>>(
    tree: &BvhWide,
    batch: &mut R,
    range: Range<usize>,
    stacks: &mut Stacks,
    from_one_point: bool,
) {
    if !R::GROUPS {
        return run_apart::<Interleaved, _, _>(tree, batch, range, stacks);
    }
    let many = many::<R::Visitor>(from_one_point);
    let (mut start, end) = (range.start, range.end);
    let (mut together, mut apart) = (TOGETHER.start, APART.start);
    while start < end {
        let tried = start..end.min(start + together);
        start = tried.end;
        let shared = run_apart::<Hybrid, _, _>(tree, batch, tried, stacks);
        if shared.by_so_many(many) {
            together = TOGETHER.end.min(2 * together);
            apart = APART.start;
        } else {
            let turns = start..end.min(start + apart);
            start = turns.end;
            run_apart::<Interleaved, _, _>(tree, batch, turns, stacks);
            together = TOGETHER.start;
            apart = APART.end.min(2 * apart);
        }
    }
}
