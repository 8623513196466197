//! Nodes of a tree of planes.

use std::ops::Range;

use crate::geometry::{Aabb, DVec3};

/// The axis of what is no axis-parallel plane.
const NONE: u32 = 3;

/// Set where a plane only belongs to the node above it, as six of the seven of an octree's node do; among what has no
/// axis, set for an oblique plane.
const FLAG: u32 = 4;

/// Bits below the index.
const SHIFT: u32 = 3;

/// A split plane, or a leaf.
///
/// `tag & 3` is the axis of an axis-parallel plane, whose coordinate is in `value` and the first of whose two children has
/// index `tag >> 3`. A leaf has `tag >> 3` blocks from `value` on. An oblique plane stands in a list of its own at `value`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C, align(8))]
pub(in super::super) struct Node {
    value: u32,
    tag: u32,
}

/// What a node is.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Kind {
    /// These blocks.
    Leaf(Range<u32>),
    /// The plane where `axis` is `place`.
    Axis {
        axis: usize,
        place: f32,
        /// Index of the child below it; the other one follows.
        pair: u32,
    },
    /// The oblique plane with this index.
    Oblique(u32),
}

impl Node {
    /// A leaf without triangles.
    pub const EMPTY: Self = Self::leaf(0, 0);

    /// A leaf of `count` blocks.
    pub const fn leaf(first: u32, count: u32) -> Self {
        Self {
            value: first,
            tag: count << SHIFT | NONE,
        }
    }

    /// The plane where `axis` is `place`, over the children from `pair` on.
    pub fn axis(axis: usize, place: f32, pair: u32) -> Self {
        Self {
            value: place.to_bits(),
            tag: pair << SHIFT | axis as u32,
        }
    }

    /// This plane as a part of the node above it.
    pub fn inner(self) -> Self {
        Self {
            tag: self.tag | FLAG,
            ..self
        }
    }

    /// The oblique plane with this index.
    pub fn oblique(index: u32) -> Self {
        Self {
            value: index,
            tag: FLAG | NONE,
        }
    }

    /// The axis of an axis-parallel plane.
    #[inline(always)]
    pub(super) fn split_axis(self) -> Option<usize> {
        let axis = self.tag & NONE;
        (axis != NONE).then_some(axis as usize)
    }

    /// The coordinate of an axis-parallel plane.
    #[inline(always)]
    pub(super) fn place(self) -> f32 {
        f32::from_bits(self.value)
    }

    /// The first child of an axis-parallel plane.
    #[inline(always)]
    pub(super) fn pair(self) -> u32 {
        self.tag >> SHIFT
    }

    /// The index of an oblique plane; else the node is a leaf. Asked only where there is no axis.
    #[inline(always)]
    pub(super) fn as_oblique(self) -> Option<u32> {
        (self.tag & FLAG != 0).then_some(self.value)
    }

    /// The blocks of a leaf.
    #[inline(always)]
    pub(super) fn blocks(self) -> Range<u32> {
        self.value..self.value + (self.tag >> SHIFT)
    }

    /// What it is.
    pub(super) fn kind(self) -> Kind {
        match (self.split_axis(), self.as_oblique()) {
            (Some(axis), _) => Kind::Axis {
                axis,
                place: self.place(),
                pair: self.pair(),
            },
            (None, Some(index)) => Kind::Oblique(index),
            (None, None) => Kind::Leaf(self.blocks()),
        }
    }

    pub(super) fn is_leaf(self) -> bool {
        matches!(self.kind(), Kind::Leaf(_))
    }

    /// Whether a visit of it is a traversal step.
    pub(super) fn is_step(self) -> bool {
        self.split_axis().is_none() || self.tag & FLAG == 0
    }

    /// The same node where its children, its blocks and the oblique planes begin by so much later.
    pub(super) fn moved(self, nodes: u32, blocks: u32, obliques: u32) -> Self {
        match self.kind() {
            Kind::Axis { .. } => Self {
                tag: self.tag + (nodes << SHIFT),
                ..self
            },
            Kind::Leaf(_) => Self {
                value: self.value + blocks,
                ..self
            },
            Kind::Oblique(index) => Self::oblique(index + obliques),
        }
    }
}

/// A plane across no axis: where `normal · x` is `offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Oblique {
    /// Its greatest component is 1 or -1.
    pub normal: DVec3,
    pub offset: f64,
    /// What lies within so much of the plane is taken to be on both sides by every ray, and may be listed on one side only.
    pub pad: f64,
    /// The first child.
    pub pair: u32,
}

impl Oblique {
    /// How far `point` lies above the plane, in lengths of the normal.
    #[inline(always)]
    pub fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }

    /// The sum of the normal's components.
    #[inline(always)]
    pub fn reach(&self) -> f64 {
        self.normal.abs().element_sum()
    }
}

/// The two parts of the cell of an axis-parallel plane.
pub(in super::super) fn halves(cell: &Aabb, axis: usize, place: f32) -> [Aabb; 2] {
    let (mut below, mut above) = (*cell, *cell);
    below.max[axis] = place;
    above.min[axis] = place;
    [below, above]
}
