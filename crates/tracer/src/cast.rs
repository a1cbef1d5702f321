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
mod queue;

use expr::processor::Processor;
use expr::vectors::{Lanes, MOST_LANES};
use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::bounds::BoundingBox;
use crate::bundle::{RayBlocks, RayBundle};
use crate::bvh::NodePart;
use crate::field::{DividedBundle, FieldScratch, TILE_RAY_OPERATIONS};
use crate::first::FirstPlace;
use crate::leaf::NearLeaf;
use crate::line::{Ray, SurfaceId, UnitLine};
use crate::near::NearLeaves;
use crate::roots::SignChanges;
use crate::shape::LeafSurface;
use crate::tree::ForestState;
use crate::world::World;

use queue::{Queue, RayOrder};

/// The relative distances at which a gradient is evaluated beside a point where it is undefined.
const BESIDE: [f64; 5] = [1e-14, 1e-12, 1e-10, 1e-8, 1e-6];

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

/// The leaves in which crossings are sought.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Among {
    World,
    /// The leaves near the bundle, to which the ray belongs.
    Bundle,
    /// Those leaves near the bundle that do not belong to products.
    JoinedOfBundle,
}

/// The part of a ray that the caller asks for.
#[derive(Clone, Copy, Debug)]
struct Sought {
    /// True if only the first crossings are needed.
    first: bool,
    among: Among,
    /// Crossings are sought before this t.
    before: f64,
}

impl Sought {
    const ALL: Self = Self {
        first: false,
        among: Among::World,
        before: f64::INFINITY,
    };
}

/// A line in the frame of a leaf.
#[derive(Clone, Copy, Debug, Default)]
struct KnownLine {
    ray_number: u64,
    leaf: u32,
    line: UnitLine,
}

/// The work for a ray, for a leaf on it, for a box that it meets, and for a leaf and a block of rays, in operations; derived
/// from measured times.
const RAY_OPERATIONS: u64 = 32;
const LEAF_OPERATIONS: u64 = 16;
const BOX_OPERATIONS: u64 = 8;
const BLOCK_OPERATIONS: u64 = 32;

/// The number of cached lines, a power of two.
const KNOWN_LINES: usize = 16;

/// The owner of a box that a ray meets: a node of the hierarchy or, numbered after all nodes, a leaf.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
struct BoxOwner(u32);

impl BoxOwner {
    const LEAVES: u32 = 1 << 31;
    /// The root of the hierarchy.
    const ROOT: Self = Self(0);

    fn leaf(leaf: u32) -> Self {
        Self(Self::LEAVES | leaf)
    }

    /// Returns the leaf, unless the owner is a node.
    fn as_leaf(self) -> Option<u32> {
        self.0.checked_sub(Self::LEAVES)
    }
}

/// Returns the part of a ray in a box, slightly enlarged: far from the start of the ray a box may be thinner than the
/// spacing of the numbers, and its surface may be outside by a rounding error.
fn rounded([entry, exit]: [f64; 2]) -> [f64; 2] {
    const ROUNDING: f64 = 8.0 * f64::EPSILON;
    [entry - ROUNDING * entry.abs(), exit + ROUNDING * exit.abs()]
}

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

    fn sweep(&mut self, ray: &Ray, sought: Sought, found: &mut dyn FnMut(&Crossing) -> bool) {
        let Sought { among, before, .. } = sought;
        let bundled = among != Among::World;
        self.operations += self.state.operations();
        self.state.reset(&self.world.forest);
        self.crossings.clear();
        self.events.clear();
        self.shared.clear();
        self.shared_fields.clear();
        self.start.clear();
        self.field.begin();
        self.ray_number += 1;
        self.sweeps += 1;
        if !ray.is_usable() {
            return;
        }
        self.find_candidates(ray, among);
        self.operations += RAY_OPERATIONS;
        while let Some((leaf, part)) = self.next_leaf(ray, 0.0) {
            self.activate(ray, leaf, part, bundled);
        }
        self.read_start();
        loop {
            let event = self.events.first().map_or(before, |event| event.t);
            if let Some((leaf, part)) = self.next_leaf(ray, event.min(before)) {
                self.activate(ray, leaf, part, bundled);
                if self.state.changed.is_empty() {
                    continue;
                }
                let known = self.crossings.len();
                self.come_to(ray, leaf, part, bundled);
                let enough = sought.first && !self.crossings.is_empty();
                if enough || !self.crossings[known..].iter().all(&mut *found) {
                    break;
                }
                continue;
            }
            let Some(&event) = self.events.first().filter(|event| event.t < before) else {
                break;
            };
            self.group.clear();
            while let Some((_, same)) = self.events.pop_if(|next| next.t == event.t) {
                self.group.push(same);
            }
            let known = self.crossings.len();
            self.pass(ray);
            let enough = sought.first && !self.crossings.is_empty();
            if enough || !self.crossings[known..].iter().all(&mut *found) {
                break;
            }
            for k in 0..self.group.len() {
                self.go_on(ray, self.group[k], bundled);
            }
        }
    }

    /// Finds the leaves that the ray may meet, or the root of the hierarchy.
    fn find_candidates(&mut self, ray: &Ray, among: Among) {
        self.candidates.clear();
        self.reciprocal = ray.direction.recip();
        let world = self.world;
        self.own = ray.leaving.map(|own| BoxOwner::leaf(own.leaf));
        let listed = match among {
            Among::Bundle if !self.near.is_crowded() => self.near.all().len(),
            Among::JoinedOfBundle => self.near.joined().len(),
            Among::World | Among::Bundle => {
                for &leaf in &world.endless {
                    self.add_candidate(ray, BoxOwner::leaf(leaf), None);
                }
                if !world.hierarchy.is_empty() {
                    self.add_candidate(ray, BoxOwner::ROOT, Some(&world.hierarchy.bounds()));
                }
                // By rounding, the boxes around it may begin behind the start.
                if let Some(own) = ray.leaving
                    && let Some(bounds) = &world.leaves[own.leaf as usize].bounds
                {
                    self.add_candidate(ray, BoxOwner::leaf(own.leaf), Some(bounds));
                }
                0
            }
        };
        // The leaves that do not belong to products come first.
        for k in 0..listed {
            let NearLeaf { leaf, bounds } = self.near.all()[k];
            self.add_candidate(ray, BoxOwner::leaf(leaf), bounds.as_ref());
        }
    }

    /// Adds a box if the ray meets it; `None` stands for all of space.
    #[inline]
    fn add_candidate(&mut self, ray: &Ray, of: BoxOwner, bounds: Option<&BoundingBox>) {
        let part = match bounds {
            Some(bounds) => bounds.part(ray.origin, self.reciprocal),
            None => [f64::NEG_INFINITY, f64::INFINITY],
        };
        if part[0] <= part[1] && part[1] >= 0.0 {
            let [mut entry, exit] = rounded(part);
            // A start on a leaf counts as inside its box, despite rounding.
            if self.own == Some(of) {
                entry = entry.min(0.0);
            }
            self.operations += BOX_OPERATIONS;
            self.candidates
                .push((RayOrder::of(entry), of), [entry, exit]);
        }
    }

    /// Removes the leaf whose box the ray enters first, if it does so up to `most`, and returns it with the part of the ray
    /// in the box.
    #[inline]
    fn next_leaf(&mut self, ray: &Ray, most: f64) -> Option<(u32, [f64; 2])> {
        loop {
            let ((_, of), part) = self.candidates.pop_if(|[entry, _]| *entry <= most)?;
            let Some(leaf) = of.as_leaf() else {
                self.open(ray, of.0);
                continue;
            };
            // The cost of the queue grows with the logarithm of its length.
            let rest = self.candidates.len() + self.events.len() + 1;
            self.operations += LEAF_OPERATIONS + 8 * u64::from(rest.ilog2());
            return Some((leaf, part));
        }
    }

    /// Adds the parts of a node of the hierarchy.
    fn open(&mut self, ray: &Ray, node: u32) {
        let world = self.world;
        for (part, bounds) in world.hierarchy.parts(node) {
            let of = match part {
                NodePart::Node(node) => BoxOwner(node),
                NodePart::Box(place) => BoxOwner::leaf(world.boxed[place as usize]),
            };
            if self.own != Some(of) {
                self.add_candidate(ray, of, Some(bounds));
            }
        }
    }

    /// Records the solids that contain the start of the ray.
    fn read_start(&mut self) {
        if self.state.changed.is_empty() && self.world.endless_solids.is_empty() {
            return;
        }
        let mut changed = std::mem::take(&mut self.state.changed);
        changed.sort_unstable();
        changed.dedup();
        let forest = &self.world.forest;
        for solid in changed.drain(..) {
            if self.state.inside(forest, solid as usize) {
                self.start.push(solid as usize);
            }
        }
        self.state.changed = changed;
        for &solid in &self.world.endless_solids {
            if !self.start.contains(&solid) && self.state.inside(forest, solid) {
                self.start.push(solid);
            }
        }
        self.start.sort_unstable();
    }

    /// Processes the events of the group and records the crossings.
    fn pass(&mut self, ray: &Ray) {
        self.group
            .sort_unstable_by_key(|event| (event.leaf, event.piece));
        self.state.changed.clear();
        for k in 0..self.group.len() {
            self.toggle(self.group[k]);
        }
        self.note_changes(ray);
    }

    /// Records the crossings where the ray reaches the box of a leaf and is inside the leaf there. In exact arithmetic no
    /// solid begins at its box; but a rounded root of the surface may be before the box.
    fn come_to(&mut self, ray: &Ray, leaf: u32, [entry, _]: [f64; 2], bundled: bool) {
        let mut ends = self.world.leaves[leaf as usize].ends;
        self.group.clear();
        self.group.push(SurfaceEvent::box_side(leaf, entry));
        // Boxes that begin at the same point are processed together.
        while let Some((leaf, part)) = self.next_leaf(ray, entry) {
            self.activate(ray, leaf, part, bundled);
            ends |= self.world.leaves[leaf as usize].ends;
            self.group.push(SurfaceEvent::box_side(leaf, entry));
        }
        if ends {
            self.note_changes(ray);
        } else {
            // The box of an unbounded field does not show where the field begins.
            self.state.changed.clear();
        }
    }

    /// Records what the events of the group have changed.
    fn note_changes(&mut self, ray: &Ray) {
        let mut changed = std::mem::take(&mut self.state.changed);
        changed.sort_unstable();
        let mut at = 0;
        while at < changed.len() {
            let solid = changed[at];
            let count = changed[at..].iter().take_while(|&&s| s == solid).count();
            at += count;
            if count % 2 == 1 {
                let owner = self.owner(solid as usize);
                let entering = self.state.inside(&self.world.forest, solid as usize);
                let crossing = self.crossing(ray, owner, solid as usize, entering);
                self.crossings.push(crossing);
            }
        }
        changed.clear();
        self.state.changed = changed;
    }

    /// Seeks the event of a field after this one.
    fn go_on(&mut self, ray: &Ray, event: SurfaceEvent, bundled: bool) {
        if let Some(rest) = event.rest {
            let leaf = &self.world.leaves[event.leaf as usize];
            let inside = self.inside[leaf.first_piece + event.piece as usize];
            let id = SurfaceId {
                leaf: event.leaf,
                piece: event.piece,
            };
            self.seek(ray, id, rest, inside, bundled);
        }
    }

    fn toggle(&mut self, event: SurfaceEvent) {
        let leaf = &self.world.leaves[event.leaf as usize];
        let is_convex = self.world.convex[event.leaf as usize];
        if event.piece == BOX && !is_convex {
            let gate = &mut self.gates[event.leaf as usize];
            *gate = !*gate;
            self.state.set(&self.world.forest, leaf.gate, *gate);
            return;
        }
        let piece = if is_convex { 0 } else { event.piece as usize };
        let inside = &mut self.inside[leaf.first_piece + piece];
        *inside = !*inside;
        let literal = if is_convex {
            leaf.gate
        } else {
            leaf.pieces[piece]
        };
        self.state.set(&self.world.forest, literal, *inside);
    }

    /// Returns the first event of the group that by itself takes the ray across the solid's surface, otherwise the solid's
    /// first event.
    fn owner(&mut self, solid: usize) -> SurfaceEvent {
        if let [only] = self.group[..] {
            return only;
        }
        let of_solid =
            |event: &&SurfaceEvent| self.world.leaves[event.leaf as usize].solid == solid;
        let own: Vec<SurfaceEvent> = self.group.iter().filter(of_solid).copied().collect();
        if let [only] = own[..] {
            return only;
        }
        let after = self.state.inside(&self.world.forest, solid);
        for &event in &own {
            self.toggle(event);
        }
        let mut found = None;
        for &event in &own {
            self.toggle(event);
            let crosses = self.state.inside(&self.world.forest, solid) == after;
            self.toggle(event);
            if crosses {
                found = Some(event);
                break;
            }
        }
        for &event in &own {
            self.toggle(event);
        }
        found.unwrap_or(own[0])
    }

    /// Returns the crossing where a ray passes a surface of a solid.
    fn passed(&mut self, ray: &Ray, t: f64, surface: SurfaceId, entering: bool) -> Crossing {
        self.ray_number += 1;
        let SurfaceId { leaf, piece } = surface;
        let solid = self.world.leaves[leaf as usize].solid;
        let event = SurfaceEvent {
            t,
            leaf,
            piece,
            rest: None,
        };
        self.crossing(ray, event, solid, entering)
    }

    /// Returns the piece of a leaf whose surface is nearest to a point, estimated by the slope there.
    fn nearest_piece(&mut self, leaf: u32, place: DVec3) -> u32 {
        let leaf = &self.world.leaves[leaf as usize];
        let mut nearest = (f64::INFINITY, 0);
        for (k, piece) in leaf.compiled.pieces.iter().enumerate() {
            let (value, gradient) = match piece {
                LeafSurface::Polynomial(surface) => {
                    let at = leaf.unit_from_world.transform_point3(place);
                    let gradient = leaf.unit_from_world.matrix3.transpose() * surface.gradient(at);
                    (surface.polynomial.at(at.to_array()), gradient)
                }
                LeafSurface::Field(field, _) => {
                    let at = leaf.shape_from_world.transform_point3(place);
                    let gradient = field.gradient(&mut self.field, at);
                    let gradient = leaf.shape_from_world.matrix3.transpose() * gradient;
                    (field.value(&mut self.field, at), gradient)
                }
            };
            let distance = value.abs() / gradient.length();
            if distance < nearest.0 {
                nearest = (distance, k as u32);
            }
        }
        nearest.1
    }

    fn crossing(
        &mut self,
        ray: &Ray,
        mut event: SurfaceEvent,
        solid: usize,
        entering: bool,
    ) -> Crossing {
        let world = self.world;
        if event.piece == BOX {
            let place = ray.origin + event.t * ray.direction;
            event.piece = self.nearest_piece(event.leaf, place);
        }
        let leaf = &world.leaves[event.leaf as usize];
        let piece = leaf.first_piece + event.piece as usize;
        let flat = world.low[piece].as_ref().and_then(|low| low.normal);
        let normal = flat.or_else(|| self.gradient(ray, event).try_normalize());
        let normal = normal.or_else(|| self.normal_beside(ray, event));
        // Without a usable gradient, the normal is along the ray.
        let normal = normal.unwrap_or_else(|| ray.direction.normalize_or(DVec3::Z));
        let leads_out = (normal.dot(ray.direction) < 0.0) == entering;
        Crossing {
            t: event.t,
            solid,
            leaf: event.leaf as usize,
            surface: SurfaceId {
                leaf: event.leaf,
                piece: event.piece,
            },
            entering,
            position: ray.origin + event.t * ray.direction,
            normal: if leads_out { normal } else { -normal },
        }
    }

    /// Returns the direction of a function's gradient slightly beside a point of the ray where the gradient is undefined. At
    /// a pole it is that of the pole's surface; at the end of a domain the gradient usually tends towards the normal.
    fn normal_beside(&mut self, ray: &Ray, event: SurfaceEvent) -> Option<DVec3> {
        let world = self.world;
        let leaf = &world.leaves[event.leaf as usize];
        let LeafSurface::Field(field, _) = &leaf.compiled.pieces[event.piece as usize] else {
            return None;
        };
        let position = ray.origin + event.t * ray.direction;
        let size = position.abs().max(ray.origin.abs()).max_element();
        let step = ray.direction.try_normalize()? * size;
        let largest = |gradient: &DVec3| gradient.abs().max_element();
        BESIDE.into_iter().find_map(|share| {
            let sides = [-share, share].map(|share| {
                let at = leaf
                    .shape_from_world
                    .transform_point3(position + share * step);
                field.gradient(&mut self.field, at)
            });
            // For a maximum, this selects the function with the pole.
            let sides = sides.into_iter().filter(|gradient| gradient.is_finite());
            let steepest = sides.max_by(|a, b| largest(a).total_cmp(&largest(b)))?;
            // The square of its length may overflow.
            let gradient = steepest / largest(&steepest);
            (leaf.shape_from_world.matrix3.transpose() * gradient).try_normalize()
        })
    }

    /// Returns the gradient of the surface of an event.
    fn gradient(&mut self, ray: &Ray, event: SurfaceEvent) -> DVec3 {
        let world = self.world;
        let leaf = &world.leaves[event.leaf as usize];
        let position = ray.origin + event.t * ray.direction;
        match &leaf.compiled.pieces[event.piece as usize] {
            LeafSurface::Polynomial(surface) => {
                let at = match surface.quadratic() {
                    // For a quadric this point is as exact as one on the line in its frame.
                    Some(_) => leaf.unit_from_world.transform_point3(position),
                    None => {
                        let line = self.line(ray, event.leaf);
                        line.point + line.place(event.t) * line.direction
                    }
                };
                leaf.unit_from_world.matrix3.transpose() * surface.gradient(at)
            }
            LeafSurface::Field(field, _) => {
                let at = leaf.shape_from_world.transform_point3(position);
                let gradient = field.gradient(&mut self.field, at);
                leaf.shape_from_world.matrix3.transpose() * gradient
            }
        }
    }
}
