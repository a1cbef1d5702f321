//! Rays through a world.
//!
//! ```text
//! ray ──bvh.rs──▶ leaves by entry ──surface.rs, field.rs──▶ events by t ──tree.rs──▶ crossings
//! ```
//!
//! Input: a ray. Output: where it enters and leaves solids. The sweep goes from the start of the ray on. A leaf is read when
//! it comes to the leaf's box; the events at one t are taken together, and where the membership in a solid has then
//! changed, the ray crosses its surface. No distance is taken for zero: a ray that leaves a surface says which, and the
//! root there is divided out. `cast/events.rs` reads leaves.

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

/// The distances at which a gradient is looked for beside a place that has none, as shares of the place's size.
const BESIDE: [f64; 5] = [1e-14, 1e-12, 1e-10, 1e-8, 1e-6];

/// A place where a ray enters or leaves a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The place is origin + t·direction.
    pub t: f64,
    /// The solid.
    pub solid: usize,
    /// The leaf whose surface it is, over all solids.
    pub leaf: usize,
    /// The surface.
    pub surface: SurfaceId,
    /// True where the ray enters.
    pub entering: bool,
    /// The place.
    pub position: DVec3,
    /// The unit normal that leads out of the solid.
    pub normal: DVec3,
}

/// Casts rays into a world; one for each thread.
#[derive(Debug)]
pub struct Caster<'w> {
    world: &'w World,
    state: ForestState,
    field: FieldScratch,
    /// True for the pieces that the ray is inside of; of active leaves only.
    inside: Vec<bool>,
    /// True for the leaves in whose boxes the ray is; of active leaves that are not convex only.
    gates: Vec<bool>,
    /// The boxes to come that the ray meets, by entry, with the part of the ray in each.
    candidates: Queue<(RayOrder, BoxOwner), [f64; 2]>,
    /// That of the ray's direction.
    reciprocal: DVec3,
    /// The leaf that the ray leaves.
    own: Option<BoxOwner>,
    /// The surfaces to come, in the part of the ray that has been read.
    events: Queue<RayOrder, SurfaceEvent>,
    /// The sign changes of each group of shared polynomials, in t.
    shared: FxHashMap<u32, SignChanges>,
    /// The changes of each group of shared fields, in t.
    shared_fields: FxHashMap<u32, Vec<f64>>,
    processor: Processor,
    /// The rays that are read together.
    bundle: RayBlocks,
    /// True where fields are read for all rays of the bundle at once, and what is then known of each.
    divides_fields: bool,
    bundle_parts: FxHashMap<SurfaceId, DividedBundle>,
    /// The index in the bundle of the ray that is cast, if it is one of it.
    bundle_index: usize,
    near: NearLeaves,
    /// The number of the ray, and the lines of a ray in the frames of leaves that were needed last.
    ray_number: u64,
    sweeps: u64,
    /// The number of operations so far, without those of fields.
    operations: u64,
    lines: [KnownLine; KNOWN_LINES],
    group: Vec<SurfaceEvent>,
    crossings: Vec<Crossing>,
    start: Vec<usize>,
}

/// The leaves among which crossings are sought.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Among {
    World,
    /// Those near the bundle, of which the ray is one.
    Bundle,
    /// Those of them that are not of products.
    JoinedOfBundle,
}

/// The part of a ray that is asked for.
#[derive(Clone, Copy, Debug)]
struct Sought {
    /// True if the first crossings are enough.
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

/// The work of a ray by itself, of a leaf on it, of a box that it meets, and of a leaf for a block of rays, in operations: from
/// their times.
const RAY_OPERATIONS: u64 = 32;
const LEAF_OPERATIONS: u64 = 16;
const BOX_OPERATIONS: u64 = 8;
const BLOCK_OPERATIONS: u64 = 32;

/// The number of lines that are kept, a power of two.
const KNOWN_LINES: usize = 16;

/// The owner of a box that a ray meets: a node of the hierarchy, or after all nodes a leaf.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
struct BoxOwner(u32);

impl BoxOwner {
    const LEAVES: u32 = 1 << 31;
    /// The node of all boxes.
    const ROOT: Self = Self(0);

    fn leaf(leaf: u32) -> Self {
        Self(Self::LEAVES | leaf)
    }

    /// The leaf, unless it is a node.
    fn as_leaf(self) -> Option<u32> {
        self.0.checked_sub(Self::LEAVES)
    }
}

/// The part of a ray in a box, made larger by some: far from the start of the ray a box is thinner than the numbers are
/// dense, and its surface may lie a step of rounding outside.
fn rounded([entry, exit]: [f64; 2]) -> [f64; 2] {
    const ROUNDING: f64 = 8.0 * f64::EPSILON;
    [entry - ROUNDING * entry.abs(), exit + ROUNDING * exit.abs()]
}

/// A surface that the ray passes.
#[derive(Clone, Copy, Debug)]
struct SurfaceEvent {
    t: f64,
    leaf: u32,
    /// [`BOX`] for the leaf's box.
    piece: u32,
    /// Of a field, the part of the ray in which its next event is sought once this one is passed.
    rest: Option<[f64; 2]>,
}

/// The piece of an event that is a side of a leaf's box.
const BOX: u32 = u32::MAX;

impl SurfaceEvent {
    /// A side of a leaf's box.
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
    /// A caster of rays into this world.
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
    /// All crossings with t > 0, by t, then by solid.
    pub fn cast(&mut self, ray: &Ray) -> &[Crossing] {
        self.sweep(ray, Sought::ALL, &mut |_| true);
        &self.crossings
    }

    /// The first crossing with t > 0.
    pub fn first(&mut self, ray: &Ray) -> Option<Crossing> {
        let sought = Sought {
            first: true,
            ..Sought::ALL
        };
        self.sweep(ray, sought, &mut |_| true);
        self.crossings.first().copied()
    }

    /// The crossings with the least t > 0 of the ray with this index in the bundle, by solid.
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

    /// The solid that the ray with this index in the bundle enters or leaves first, the leaf through which it does, and true if
    /// it enters; `None` unless it is known without a sweep that it does before `before`.
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

    /// Hands the crossings with t > 0 and less than `before` of the ray with this index in the bundle to `found`, by t, then
    /// by solid, until it returns false.
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

    /// Limits the work on functions that are no polynomials from here on, in operations: rays that take more are sampled, and
    /// once samples have taken as many again, rays meet no function's surface.
    pub fn limit_fields(&mut self, operations: u64) {
        self.field.limit(operations);
    }

    /// Begins a tile of a picture: the functions have [`TILE_RAY_OPERATIONS`] for each of so many rays, with all rays to which
    /// they give rise.
    pub fn begin_tile(&mut self, rays: usize) {
        self.limit_fields(rays as u64 * TILE_RAY_OPERATIONS);
    }

    /// The number of rays so far that took more work than there may be, and may lack a crossing.
    pub fn rays_cut_short(&self) -> u64 {
        self.field.cut_short()
    }

    /// Reads these rays, which all start on one surface or on none, together, until the next bundle:
    /// [`Caster::first_of_bundle`] then takes less time, the less the nearer they are to each other. The rays of a few pixels
    /// by a few make a good bundle.
    pub fn begin_bundle(&mut self, rays: &[Ray]) {
        let bundle = self.begin(rays.first().and_then(|ray| ray.leaving));
        for ray in rays {
            bundle.push(ray.origin, ray.direction);
        }
        self.find_near(f64::INFINITY);
        self.divide_fields();
    }

    /// Begins a bundle of rays that leave a surface. It is to receive them, before [`Caster::find_near`].
    pub(crate) fn begin(&mut self, leaving: Option<SurfaceId>) -> &mut RayBlocks {
        self.bundle.begin(leaving);
        &mut self.bundle
    }

    /// Reads fields for all rays of the bundle at once: that pays where they stay near each other.
    pub(crate) fn divide_fields(&mut self) {
        self.divides_fields = true;
    }

    /// Finds the leaves that the rays of the bundle may meet before `reach`, until the next bundle.
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

    /// The crossings that the last call has found.
    pub(crate) fn crossings(&self) -> &[Crossing] {
        &self.crossings
    }

    /// True if no ray of the bundle meets anything.
    pub(crate) fn bundle_is_free(&self) -> bool {
        self.near.is_empty()
    }

    /// Those rays of a block of the bundle, the first of which has this index, that are known to meet nothing before these
    /// places.
    pub(crate) fn free_rays(&self, first: usize, before: &[f64; MOST_LANES]) -> Lanes {
        self.near.free(first, before)
    }

    /// The first crossing with t > 0 of the ray with this index in the bundle.
    pub fn first_of_bundle(&mut self, index: usize) -> Option<Crossing> {
        self.nearest(index).first().copied()
    }

    /// The solids that the last ray was inside of right after its start, ascending; not for rays of a bundle that leave a
    /// surface.
    pub fn solids_at_start(&self) -> &[usize] {
        &self.start
    }

    /// The number of rays that took a sweep so far.
    pub fn sweeps(&self) -> u64 {
        self.sweeps
    }

    /// The work so far, in operations on numbers, some nanoseconds each: the same for the same rays, however long it takes.
    pub fn operations(&self) -> u64 {
        self.operations + self.state.operations() + self.field.operations()
    }

    /// The number of evaluations on intervals so far.
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

    /// Finds the leaves that the ray may meet, or the node of all their boxes.
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
                // The boxes around it may begin behind the start, by rounding.
                if let Some(own) = ray.leaving
                    && let Some(bounds) = &world.leaves[own.leaf as usize].bounds
                {
                    self.add_candidate(ray, BoxOwner::leaf(own.leaf), Some(bounds));
                }
                0
            }
        };
        // Those that are not of products are the first of all.
        for k in 0..listed {
            let NearLeaf { leaf, bounds } = self.near.all()[k];
            self.add_candidate(ray, BoxOwner::leaf(leaf), bounds.as_ref());
        }
    }

    /// Adds a box if the ray meets it; without bounds, it is everything.
    #[inline]
    fn add_candidate(&mut self, ray: &Ray, of: BoxOwner, bounds: Option<&BoundingBox>) {
        let part = match bounds {
            Some(bounds) => bounds.part(ray.origin, self.reciprocal),
            None => [f64::NEG_INFINITY, f64::INFINITY],
        };
        if part[0] <= part[1] && part[1] >= 0.0 {
            let [mut entry, exit] = rounded(part);
            // A start on a leaf is in its box, whatever rounding says.
            if self.own == Some(of) {
                entry = entry.min(0.0);
            }
            self.operations += BOX_OPERATIONS;
            self.candidates
                .push((RayOrder::of(entry), of), [entry, exit]);
        }
    }

    /// Takes the leaf whose box the ray enters first, if it does so up to this place, with the part of the ray in it.
    #[inline]
    fn next_leaf(&mut self, ray: &Ray, most: f64) -> Option<(u32, [f64; 2])> {
        loop {
            let ((_, of), part) = self.candidates.pop_if(|[entry, _]| *entry <= most)?;
            let Some(leaf) = of.as_leaf() else {
                self.open(ray, of.0);
                continue;
            };
            // Among many the order takes longer, as their logarithm.
            let rest = self.candidates.len() + self.events.len() + 1;
            self.operations += LEAF_OPERATIONS + 8 * u64::from(rest.ilog2());
            return Some((leaf, part));
        }
    }

    /// Adds what a node of the hierarchy consists of.
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

    /// Notes what the ray starts inside of.
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

    /// Passes the events of the group, and notes what is crossed.
    fn pass(&mut self, ray: &Ray) {
        self.group
            .sort_unstable_by_key(|event| (event.leaf, event.piece));
        self.state.changed.clear();
        for k in 0..self.group.len() {
            self.toggle(self.group[k]);
        }
        self.note_changes(ray);
    }

    /// Notes what is crossed where the ray comes to the box of a leaf that it is inside of there. In exact numbers no solid
    /// begins there; a surface whose root has been rounded to a place before its box does.
    fn come_to(&mut self, ray: &Ray, leaf: u32, [entry, _]: [f64; 2], bundled: bool) {
        let mut ends = self.world.leaves[leaf as usize].ends;
        self.group.clear();
        self.group.push(SurfaceEvent::box_side(leaf, entry));
        // What begins at the same place is taken together.
        while let Some((leaf, part)) = self.next_leaf(ray, entry) {
            self.activate(ray, leaf, part, bundled);
            ends |= self.world.leaves[leaf as usize].ends;
            self.group.push(SurfaceEvent::box_side(leaf, entry));
        }
        if ends {
            self.note_changes(ray);
        } else {
            // The box of an endless field says nothing of where it begins.
            self.state.changed.clear();
        }
    }

    /// Notes what the events of the group have changed.
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

    /// The first event of the group that alone takes the ray across the solid's surface, else the first of the solid.
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

    /// The crossing where a ray passes a surface of a solid.
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

    /// The piece of a leaf whose surface is nearest to a place, by the slope there.
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
        // Where the gradient says nothing, the normal is along the ray.
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

    /// The direction of the gradient of a function a little beside a place on the ray at which there is none: at a pole it is
    /// that of the pole's surface, and where a domain ends the gradient grows towards the normal as a rule.
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
            // Of a maximum, the function that has the pole.
            let sides = sides.into_iter().filter(|gradient| gradient.is_finite());
            let steepest = sides.max_by(|a, b| largest(a).total_cmp(&largest(b)))?;
            // The square of its length may not be finite.
            let gradient = steepest / largest(&steepest);
            (leaf.shape_from_world.matrix3.transpose() * gradient).try_normalize()
        })
    }

    /// The gradient of the surface of an event.
    fn gradient(&mut self, ray: &Ray, event: SurfaceEvent) -> DVec3 {
        let world = self.world;
        let leaf = &world.leaves[event.leaf as usize];
        let position = ray.origin + event.t * ray.direction;
        match &leaf.compiled.pieces[event.piece as usize] {
            LeafSurface::Polynomial(surface) => {
                let at = match surface.quadratic() {
                    // For a quadric the place is as exact as one on the line in its frame.
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
