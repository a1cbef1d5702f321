//! Leaves: placed shapes.

use std::sync::Arc;

use glam::DAffine3;

use crate::bounds::BoundingBox;
use crate::shape::FramedShape;
use crate::tree::Literal;

/// A leaf of a solid.
#[derive(Clone, Debug)]
pub(crate) struct Leaf {
    pub(crate) solid: usize,
    pub(crate) shape: usize,
    pub(crate) compiled: Arc<FramedShape>,
    pub(crate) unit_from_world: DAffine3,
    pub(crate) shape_from_world: DAffine3,
    /// True if it is within a box of its own.
    pub(crate) bounded: bool,
    /// The box within which rays are tested against it.
    pub(crate) bounds: Option<BoundingBox>,
    /// True if it does not matter outside of that box.
    pub(crate) ends: bool,
    pub(crate) gate: Literal,
    /// The literals of its pieces; empty for a convex leaf, whose membership is that of its gate.
    pub(crate) pieces: Vec<Literal>,
    /// The number of pieces of all leaves before it.
    pub(crate) first_piece: usize,
}

/// A leaf with its box; an unbounded leaf has none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearLeaf {
    pub(crate) leaf: u32,
    pub(crate) bounds: Option<BoundingBox>,
}

/// The maximum number of leaves that are listed near a bundle and read for each ray; with more leaves, the hierarchy of
/// boxes is faster.
pub(crate) const MOST_NEAR: usize = 64;
