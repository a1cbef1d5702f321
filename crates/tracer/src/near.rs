//! The leaves that the rays of a bundle may meet.
//!
//! Input: a world, and rays that go nearly the same way. Output: the leaves whose boxes one of them may meet, without those
//! that all of them have left for good, and without those whose sets are empty where the leaf that bounds them is not met.
//! Of the solids that are products also the first place of each ray. Where rays go far apart among many leaves,
//! none are listed.

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
    /// Those of products last.
    leaves: Vec<NearLeaf>,
    /// The number of leaves that are not of products.
    joined: usize,
    /// True where there are too many: then none is listed.
    crowded: bool,
    /// For each ray its first place on the products.
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

    /// True if there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.leaves.is_empty() && !self.crowded
    }

    /// True if there are too many for a list.
    pub(crate) fn is_crowded(&self) -> bool {
        self.crowded
    }

    /// All leaves.
    pub(crate) fn all(&self) -> &[NearLeaf] {
        &self.leaves
    }

    /// Those that are not of products.
    pub(crate) fn joined(&self) -> &[NearLeaf] {
        &self.leaves[..self.joined]
    }

    /// The first place of the ray with this index on the products.
    pub(crate) fn first(&self, world: &World, index: usize) -> FirstPlace {
        self.first.get(world, index)
    }

    /// Those rays of a block, the first of which has this index, that are known to meet nothing before these places.
    pub(crate) fn free(&self, first: usize, before: &[f64; MOST_LANES]) -> Lanes {
        if self.joined > 0 {
            return Lanes::default();
        }
        self.first.free(first, before)
    }

    /// Finds the first place of each ray of the bundle on the products.
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
