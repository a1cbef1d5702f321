//! Rays through a world.
//!
//! ```text
//! ray ──bvh.rs──▶ leaves by entry ──surface.rs, field.rs──▶ events by t ──tree.rs──▶ crossings
//! ```
//!
//! In: a ray. Out: the points where it enters and leaves solids. The sweep follows the ray from its start. A leaf is read
//! when the sweep reaches the leaf's box. Events at the same t are processed together; if they change the membership in a
//! solid, the ray crosses its surface. No distance counts as zero: a ray that leaves a surface names it, and the root there
//! is divided out. `cast/events.rs` reads leaves.

mod events;
mod found;
mod gradient;
mod queue;
mod sweep;

use expr::processor::Processor;
use expr::vectors::{Lanes, MOST_LANES};
use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::bundle::{RayBlocks, RayBundle};
use crate::field::{DividedBundle, FieldScratch, TILE_RAY_OPERATIONS};
use crate::first::FirstPlace;
use crate::line::{Ray, SurfaceId, UnitLine};
use crate::near::NearLeaves;
use crate::roots::SignChanges;
use crate::tree::ForestState;
use crate::world::World;

use queue::{Queue, RayOrder};
use sweep::{Among, BoxOwner, Sought};

/// A point where a ray enters or leaves a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The parameter: the point is origin + t·direction.
    pub t: f64,
    /// The solid.
    pub solid: usize,
    /// The leaf to whose surface the point belongs, numbered over all solids.
    pub leaf: usize,
    /// The surface.
    pub surface: SurfaceId,
    /// True where the ray enters.
    pub entering: bool,
    /// The point.
    pub position: DVec3,
    /// The outward unit normal of the solid.
    pub normal: DVec3,
}

/// Casts rays into a world; each thread needs a caster of its own.
#[derive(Debug)]
pub struct Caster<'w> {
    world: &'w World,
    state: ForestState,
    field: FieldScratch,
    /// True for the pieces that the ray is inside of; valid for active leaves only.
    inside: Vec<bool>,
    /// True for the leaves whose boxes contain the current point of the ray; valid for active leaves that are not convex.
    gates: Vec<bool>,
    /// The boxes ahead that the ray meets, by entry, each with the part of the ray in it.
    candidates: Queue<(RayOrder, BoxOwner), [f64; 2]>,
    /// The reciprocal of the ray's direction.
    reciprocal: DVec3,
    /// The leaf that the ray leaves.
    own: Option<BoxOwner>,
    /// The events ahead, in the part of the ray that has been read.
    events: Queue<RayOrder, SurfaceEvent>,
    /// The sign changes of each group of shared polynomials, in t.
    shared: FxHashMap<u32, SignChanges>,
    /// The changes of each group of shared fields, in t.
    shared_fields: FxHashMap<u32, Vec<f64>>,
    processor: Processor,
    /// The rays of the current bundle.
    bundle: RayBlocks,
    /// True if fields are evaluated for all rays of the bundle at once, and the results for each field.
    divides_fields: bool,
    bundle_parts: FxHashMap<SurfaceId, DividedBundle>,
    /// The index in the bundle of the ray that is cast, if it belongs to the bundle.
    bundle_index: usize,
    near: NearLeaves,
    /// The number of the ray, and its lines in the frames of the leaves that were used most recently.
    ray_number: u64,
    sweeps: u64,
    /// The number of operations so far, except those of fields.
    operations: u64,
    lines: [KnownLine; KNOWN_LINES],
    group: Vec<SurfaceEvent>,
    crossings: Vec<Crossing>,
    start: Vec<usize>,
}

/// A line in the frame of a leaf.
#[derive(Clone, Copy, Debug, Default)]
struct KnownLine {
    ray_number: u64,
    leaf: u32,
    line: UnitLine,
}

/// The work for a leaf and a block of rays, in operations; derived from measured times.
const BLOCK_OPERATIONS: u64 = 32;

/// The number of cached lines, a power of two.
const KNOWN_LINES: usize = 16;

/// A surface that the ray crosses.
#[derive(Clone, Copy, Debug)]
struct SurfaceEvent {
    t: f64,
    leaf: u32,
    /// [`BOX`] for the leaf's box.
    piece: u32,
    /// For a field, the part of the ray in which the next event is sought after this one.
    rest: Option<[f64; 2]>,
}

/// The piece of an event that stands for a side of a leaf's box.
const BOX: u32 = u32::MAX;

impl SurfaceEvent {
    /// Creates the event of a side of a leaf's box.
    fn box_side(leaf: u32, t: f64) -> Self {
        Self {
            t,
            leaf,
            piece: BOX,
            rest: None,
        }
    }
}

impl World {
    /// Creates a caster of rays into this world.
    pub fn caster(&self) -> Caster<'_> {
        Caster {
            world: self,
            state: ForestState::default(),
            field: FieldScratch::default(),
            inside: vec![false; self.surface_of_piece.len()],
            gates: vec![false; self.leaves.len()],
            candidates: Queue::new(),
            reciprocal: DVec3::ZERO,
            own: None,
            events: Queue::new(),
            shared: FxHashMap::default(),
            shared_fields: FxHashMap::default(),
            processor: Processor::here(),
            bundle: RayBlocks::default(),
            divides_fields: false,
            bundle_parts: FxHashMap::default(),
            bundle_index: 0,
            near: NearLeaves::default(),
            ray_number: 0,
            sweeps: 0,
            operations: 0,
            lines: [KnownLine::default(); KNOWN_LINES],
            group: Vec::new(),
            crossings: Vec::new(),
            start: Vec::new(),
        }
    }
}

impl Caster<'_> {
    /// Returns all crossings with t > 0, by t, then by solid.
    pub fn cast(&mut self, ray: &Ray) -> &[Crossing] {
        self.sweep(ray, Sought::ALL, &mut |_| true);
        &self.crossings
    }

    /// Returns the first crossing with t > 0.
    pub fn first(&mut self, ray: &Ray) -> Option<Crossing> {
        let sought = Sought {
            first: true,
            ..Sought::ALL
        };
        self.sweep(ray, sought, &mut |_| true);
        self.crossings.first().copied()
    }

    /// Returns the crossings with the smallest t > 0 of the ray with this index in the bundle, by solid.
    pub(crate) fn nearest(&mut self, index: usize) -> &[Crossing] {
        if self.near.is_empty() {
            self.crossings.clear();
            self.start.clone_from(&self.world.endless_solids);
            return &self.crossings;
        }
        self.bundle_index = index;
        let ray = &self.bundle.ray(index);
        let mut sought = Sought {
            first: true,
            among: Among::Bundle,
            ..Sought::ALL
        };
        let passed = match self.near.first(self.world, index) {
            FirstPlace::Unknown => {
                self.sweep(ray, sought, &mut |_| true);
                return &self.crossings;
            }
            FirstPlace::Nothing => None,
            FirstPlace::Passes {
                t,
                surface,
                entering,
            } => Some((t, surface, entering)),
        };
        if self.near.joined().is_empty() {
            self.start.clear();
            self.crossings.clear();
        } else {
            sought.among = Among::JoinedOfBundle;
            sought.before = passed.map_or(f64::INFINITY, |(t, ..)| t.next_up());
            self.sweep(ray, sought, &mut |_| true);
        }
        if let Some((t, surface, entering)) = passed {
            match self.crossings.first() {
                None => {
                    let crossing = self.passed(ray, t, surface, entering);
                    self.crossings.push(crossing);
                }
                Some(other) if other.t == t => {
                    sought.among = Among::Bundle;
                    sought.before = f64::INFINITY;
                    self.sweep(ray, sought, &mut |_| true);
                }
                Some(_) => {}
            }
        }
        &self.crossings
    }

    /// Returns the solid that the ray with this index in the bundle crosses first, the leaf through which it does, and true
    /// if it enters; `None` unless this is known without a sweep and happens before `before`.
    pub(crate) fn passed_before(&self, index: usize, before: f64) -> Option<(usize, usize, bool)> {
        match self.near.first(self.world, index) {
            FirstPlace::Passes {
                t,
                surface,
                entering,
            } if t < before => {
                let leaf = surface.leaf as usize;
                Some((self.world.leaves[leaf].solid, leaf, entering))
            }
            _ => None,
        }
    }

    /// Passes the crossings with 0 < t < `before` of the ray with this index in the bundle to `found`, by t, then by solid,
    /// until it returns false.
    pub(crate) fn each_before(
        &mut self,
        index: usize,
        before: f64,
        found: &mut dyn FnMut(&Crossing) -> bool,
    ) {
        if self.near.is_empty() {
            return;
        }
        let among = match self.near.first(self.world, index) {
            FirstPlace::Passes { t, .. } if t < before => Among::Bundle,
            FirstPlace::Unknown => Among::Bundle,
            _ if self.near.joined().is_empty() => return,
            _ => Among::JoinedOfBundle,
        };
        let sought = Sought {
            before,
            among,
            ..Sought::ALL
        };
        self.bundle_index = index;
        let ray = self.bundle.ray(index);
        self.sweep(&ray, sought, found);
    }

    /// Limits the further work on functions that are not polynomials, in operations. Rays beyond the limit are sampled; once
    /// the samples have used the same number of operations, rays do not meet the surfaces of such functions.
    pub fn limit_fields(&mut self, operations: u64) {
        self.field.limit(operations);
    }

    /// Begins a tile of a picture: evaluating functions may use [`TILE_RAY_OPERATIONS`] for each of this number of rays,
    /// including all their secondary rays.
    pub fn begin_tile(&mut self, rays: usize) {
        self.limit_fields(rays as u64 * TILE_RAY_OPERATIONS);
    }

    /// Returns the number of rays so far that exceeded the work limit and may lack a crossing.
    pub fn rays_cut_short(&self) -> u64 {
        self.field.cut_short()
    }

    /// Reads these rays together, until the next bundle; all of them must start on one surface or on none.
    /// [`Caster::first_of_bundle`] then takes less time, the less the closer the rays are. The rays of a small block of
    /// pixels make a good bundle.
    pub fn begin_bundle(&mut self, rays: &[Ray]) {
        let bundle = self.begin(rays.first().and_then(|ray| ray.leaving));
        for ray in rays {
            bundle.push(ray.origin, ray.direction);
        }
        self.find_near(f64::INFINITY);
        self.divide_fields();
    }

    /// Begins a bundle of rays that leave a surface. The caller adds the rays before it calls [`Caster::find_near`].
    pub(crate) fn begin(&mut self, leaving: Option<SurfaceId>) -> &mut RayBlocks {
        self.bundle.begin(leaving);
        &mut self.bundle
    }

    /// Evaluates fields for all rays of the bundle at once, which pays off if the rays stay close to each other.
    pub(crate) fn divide_fields(&mut self) {
        self.divides_fields = true;
    }

    /// Finds the leaves that the rays of the bundle may meet before `reach`; valid until the next bundle.
    pub(crate) fn find_near(&mut self, reach: f64) {
        self.bundle_parts.clear();
        self.divides_fields = false;
        let bundle = RayBundle::new(self.processor, &self.bundle, reach);
        self.near.find(self.world, &bundle, self.bundle.leaving);
        let reads = (1 + self.near.all().len()) * self.bundle.blocks().len();
        self.operations += reads as u64 * BLOCK_OPERATIONS;
        if !self.near.is_empty() {
            self.near
                .find_first_places(self.processor, self.world, &self.bundle);
        }
    }

    /// Returns the crossings that the last call has found.
    pub(crate) fn crossings(&self) -> &[Crossing] {
        &self.crossings
    }

    /// Returns true if no ray of the bundle meets anything.
    pub(crate) fn bundle_is_free(&self) -> bool {
        self.near.is_empty()
    }

    /// Returns the rays of a block of the bundle that are known to meet nothing before these parameters; `first` is the
    /// index of the block's first ray.
    pub(crate) fn free_rays(&self, first: usize, before: &[f64; MOST_LANES]) -> Lanes {
        self.near.free(first, before)
    }

    /// Returns the first crossing with t > 0 of the ray with this index in the bundle.
    pub fn first_of_bundle(&mut self, index: usize) -> Option<Crossing> {
        self.nearest(index).first().copied()
    }

    /// Returns the solids that contained the last ray immediately after its start, ascending; not for rays of a bundle that
    /// leave a surface.
    pub fn solids_at_start(&self) -> &[usize] {
        &self.start
    }

    /// Returns the number of rays so far that needed a sweep.
    pub fn sweeps(&self) -> u64 {
        self.sweeps
    }

    /// Returns the work so far, in operations of some nanoseconds each. It depends on the rays only, not on the time taken.
    pub fn operations(&self) -> u64 {
        self.operations + self.state.operations() + self.field.operations()
    }

    /// Returns the number of interval evaluations so far.
    pub fn interval_evaluations(&self) -> u64 {
        self.field.evaluations
    }
}
