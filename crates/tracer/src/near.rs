//! The leaves that the rays of a bundle may meet.
//!
//! In: a world, and rays with similar directions. Out: the leaves whose boxes some ray may meet, except leaves that all rays
//! have left for good, and leaves whose sets are empty because no ray meets the guard. For solids that are products, also
//! the first crossing of each ray. If the rays diverge among many leaves, none are listed.

use expr::processor::Processor;
use expr::vectors::{Lanes, MOST_LANES};

use crate::bounds::BoundingBox;
use crate::bundle::{RayBlocks, RayBundle};
use crate::first::{FirstPlace, FirstPlaces};
use crate::leaf::{MOST_NEAR, NearLeaf};
use crate::line::SurfaceId;
use crate::low::{departs, passes};
use crate::world::World;

/// The leaves near a bundle.
#[derive(Clone, Debug, Default)]
pub(crate) struct NearLeaves {
    /// The leaves; those of products come last.
    leaves: Vec<NearLeaf>,
    /// The number of leaves that do not belong to products.
    joined: usize,
    /// True if there are too many leaves; then none is listed.
    crowded: bool,
    /// For each ray its first crossing with the products.
    first: FirstPlaces,
    stack: Vec<u32>,
}

impl NearLeaves {
    /// Finds the leaves that the rays of a bundle, all of which leave the surface `leaving`, may meet.
    pub(crate) fn find(&mut self, world: &World, bundle: &RayBundle, leaving: Option<SurfaceId>) {
        let departed = leaving.filter(|id| {
            world.convex[id.leaf as usize]
                && departs(&world.leaves[id.leaf as usize], id.piece, bundle)
        });
        let Self {
            leaves,
            stack,
            joined,
            crowded,
            first,
        } = self;
        leaves.clear();
        first.clear();
        let mut add = |leaf: u32, bounds: Option<BoundingBox>| {
            if departed.is_none_or(|id| id.leaf != leaf) {
                leaves.push(NearLeaf { leaf, bounds });
            }
            leaves.len() <= MOST_NEAR
        };
        let is_met = |&leaf: &u32| {
            let index = leaf as usize;
            !(world.convex[index] && passes(&world.leaves[index], bundle))
        };
        let few = world.endless.len() <= MOST_NEAR
            && world
                .endless
                .iter()
                .copied()
                .filter(is_met)
                .all(|leaf| add(leaf, None))
            && world.hierarchy.each_near(bundle, stack, &mut |k, bounds| {
                add(world.boxed[k], Some(*bounds))
            });
        *crowded = !few;
        if *crowded {
            leaves.clear();
            *joined = 0;
            return;
        }
        for k in (0..leaves.len()).rev() {
            let guard = world.guards[leaves[k].leaf as usize];
            if guard.is_some_and(|guard| leaves.iter().all(|near| near.leaf != guard)) {
                leaves.swap_remove(k);
            }
        }
        leaves.sort_unstable_by_key(|near| (world.is_in_product(near.leaf), near.leaf));
        *joined = leaves.partition_point(|near| !world.is_in_product(near.leaf));
    }

    /// Returns true if there are no leaves.
    pub(crate) fn is_empty(&self) -> bool {
        self.leaves.is_empty() && !self.crowded
    }

    /// Returns true if there are too many leaves to list.
    pub(crate) fn is_crowded(&self) -> bool {
        self.crowded
    }

    /// Returns all leaves.
    pub(crate) fn all(&self) -> &[NearLeaf] {
        &self.leaves
    }

    /// Returns the leaves that do not belong to products.
    pub(crate) fn joined(&self) -> &[NearLeaf] {
        &self.leaves[..self.joined]
    }

    /// Returns the first crossing of the ray with this index with the products.
    pub(crate) fn first(&self, world: &World, index: usize) -> FirstPlace {
        self.first.get(world, index)
    }

    /// Returns the rays of a block that are known to meet nothing before these parameters; `first` is the index of the
    /// block's first ray.
    pub(crate) fn free(&self, first: usize, before: &[f64; MOST_LANES]) -> Lanes {
        if self.joined > 0 {
            return Lanes::default();
        }
        self.first.free(first, before)
    }

    /// Finds the first crossing of each ray of the bundle with the products.
    pub(crate) fn find_first_places(
        &mut self,
        processor: Processor,
        world: &World,
        rays: &RayBlocks,
    ) {
        if self.crowded || !world.endless_solids.is_empty() {
            return;
        }
        let near = &self.leaves[self.joined..];
        self.first.find(processor, world, near, rays);
    }
}
