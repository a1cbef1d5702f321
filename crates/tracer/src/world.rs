//! Worlds: solids as data, prepared for rays.
//!
//! In: expressions, set operations in postfix order, affine maps. Out: a [`World`], into which `cast.rs` casts rays.

mod boxes;
mod builder;

use glam::DVec3;

use crate::bounds::BoundingBox;
use crate::bvh::Hierarchy;
use crate::field::FieldScratch;
use crate::leaf::Leaf;
use crate::line::SurfaceId;
use crate::low::LowPiece;
use crate::product::{Product, ProductLeaf};
use crate::shape::{LeafSurface, Shape};
use crate::shared::Surfaces;
use crate::tree::{Forest, TreeStep};
pub use builder::{BuildError, SEARCHED_RADII, SetStep, ShapeId, WorldBuilder, is_singular};

/// Solids into which rays can be cast.
#[derive(Debug)]
pub struct World {
    pub(crate) shapes: Vec<Shape>,
    pub(crate) leaves: Vec<Leaf>,
    pub(crate) forest: Forest,
    pub(crate) hierarchy: Hierarchy,
    /// The leaf of each box of the hierarchy.
    pub(crate) boxed: Vec<u32>,
    pub(crate) endless: Vec<u32>,
    /// The solids that contain the points that no leaf contains.
    pub(crate) endless_solids: Vec<usize>,
    pub(crate) surfaces: Surfaces,
    /// The pieces of degree at most two.
    pub(crate) low: Vec<Option<LowPiece>>,
    /// True for the leaves that a ray never meets again once it has left them.
    pub(crate) convex: Vec<bool>,
    /// The guard of each leaf: another leaf without which it does not matter.
    pub(crate) guards: Vec<Option<u32>>,
    /// The products whose unions are solids, and the role of each leaf in one.
    pub(crate) products: Vec<Product>,
    pub(crate) product_of: Vec<Option<ProductLeaf>>,
    /// The surface of each piece.
    pub(crate) surface_of_piece: Vec<SurfaceId>,
    pub(crate) solids: Vec<Vec<TreeStep>>,
    /// For each solid a box that contains it; sides for which no bound is found are infinite.
    extents: Vec<BoundingBox>,
}

/// The work of evaluating a leaf, or of preparing one, in operations.
const LEAF_WORK: u64 = 16;

impl World {
    /// Returns a world without solids.
    pub fn empty() -> Self {
        Self {
            shapes: Vec::new(),
            leaves: Vec::new(),
            forest: Forest::default(),
            hierarchy: Hierarchy::new(Vec::new()),
            boxed: Vec::new(),
            endless: Vec::new(),
            endless_solids: Vec::new(),
            surfaces: Surfaces::default(),
            low: Vec::new(),
            convex: Vec::new(),
            guards: Vec::new(),
            products: Vec::new(),
            product_of: Vec::new(),
            surface_of_piece: Vec::new(),
            solids: Vec::new(),
            extents: Vec::new(),
        }
    }

    /// Returns true if the leaf belongs to a product.
    pub(crate) fn is_in_product(&self, leaf: u32) -> bool {
        self.product_of[leaf as usize].is_some()
    }

    /// Returns the group of the surfaces that coincide with this one.
    pub(crate) fn group(&self, id: SurfaceId) -> Option<u32> {
        let piece = self.leaves[id.leaf as usize].first_piece + id.piece as usize;
        self.surfaces.group(piece).map(|member| member.group)
    }

    /// Returns the number of solids.
    pub fn solid_count(&self) -> usize {
        self.forest.len()
    }

    /// Returns the number of leaves of all solids; the leaves of a solid are consecutive, in the order of its steps.
    pub fn leaf_count(&self) -> usize {
        self.leaves.len()
    }

    /// Returns a box that contains the solid; `None` for an unbounded one, and if the boxes of its leaves do not bound it.
    pub fn bounds(&self, solid: usize) -> Option<BoundingBox> {
        self.extents[solid].if_finite()
    }

    /// Returns for each axis whether no bound of the solid along it was found, on one side or both.
    pub fn unbounded_axes(&self, solid: usize) -> [bool; 3] {
        let extent = &self.extents[solid];
        let is_bounded = |k: usize| extent.lower[k].is_finite() && extent.upper[k].is_finite();
        [0, 1, 2].map(|k| !extent.is_empty() && !is_bounded(k))
    }

    /// Returns the highest degree of the polynomials that bound a leaf; `None` if a field bounds it.
    pub fn degree(&self, leaf: usize) -> Option<usize> {
        let mut highest = 0;
        for piece in &self.leaves[leaf].compiled.pieces {
            match piece {
                LeafSurface::Polynomial(surface) => highest = highest.max(surface.degree()),
                LeafSurface::Field(..) => return None,
            }
        }
        Some(highest)
    }

    /// Returns the work of [`World::contains`], in operations.
    pub(crate) fn work_on_point(&self, solid: usize) -> u64 {
        let work = |step: &TreeStep| match *step {
            TreeStep::Leaf(leaf) => {
                let shape = &self.shapes[self.leaves[leaf].shape];
                LEAF_WORK + shape.field.value_work()
            }
            _ => 1,
        };
        self.solids[solid].iter().map(work).sum()
    }

    /// Returns true if the solid contains the point, by the values of its leaves' expressions there.
    pub fn contains(&self, solid: usize, point: DVec3) -> bool {
        let mut scratch = FieldScratch::default();
        let mut stack: Vec<bool> = Vec::new();
        for step in &self.solids[solid] {
            if let TreeStep::Leaf(leaf) = *step {
                let leaf = &self.leaves[leaf];
                let at = leaf.shape_from_world.transform_point3(point);
                stack.push(self.shapes[leaf.shape].contains(&mut scratch, at));
            } else if let (Some(b), Some(a)) = (stack.pop(), stack.pop()) {
                stack.push(match step {
                    TreeStep::Union => a || b,
                    TreeStep::Intersection => a && b,
                    _ => a && !b,
                });
            }
        }
        stack.pop().unwrap_or(false)
    }
}
