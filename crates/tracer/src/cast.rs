//! Rays through a world.
//!
//! ```text
//! ray ──bvh.rs──▶ leaves by entry ──surface.rs, field.rs──▶ events by t ──tree.rs──▶ crossings
//! ```
//!
//! Input: a ray. Output: where it enters and leaves solids. The sweep goes from the start of the ray on. A leaf is read when
//! it comes to the leaf's box; the events at one t are taken together, and where the membership in a solid has then
//! changed, the ray crosses its surface. No distance is taken for zero: a ray that leaves a surface says which, and the
//! root there is divided out.

use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::bundle::RayBundle;
use crate::field::{BundlePart, Field, FieldScratch, LineBundle};
use crate::leaf::Leaf;
use crate::line::{Ray, SurfaceId, UnitLine, changes_in_t, field_line, quadratic_changes_in_t};
use crate::lone::FirstPlace;
use crate::low::{LowEquation, LowPiece};
use crate::near::{NearLeaf, NearLeaves};
use crate::roots::{QuadraticChanges, SignChanges};
use crate::shape::LeafSurface;
use crate::surface::PolynomialSurface;
use crate::tree::ForestState;
use crate::world::World;

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
    candidates: Vec<Candidate>,
    /// Those to come, the next one last.
    events: Vec<SurfaceEvent>,
    /// The sign changes of each group of shared polynomials, in t.
    shared: FxHashMap<u32, SignChanges>,
    /// The changes of each group of shared fields, in t.
    shared_fields: FxHashMap<u32, Vec<f64>>,
    /// The rays that are read together, if something is near them.
    bundle: Vec<Ray>,
    /// True where fields are read for all rays of the bundle at once, and what is then known of each.
    divides_fields: bool,
    bundle_parts: FxHashMap<SurfaceId, Vec<BundlePart>>,
    near: NearLeaves,
    /// The number of the ray, and the lines of a ray in the frames of leaves that were needed last.
    ray_number: u64,
    lines: [KnownLine; KNOWN_LINES],
    group: Vec<SurfaceEvent>,
    stack: Vec<u32>,
    crossings: Vec<Crossing>,
    start: Vec<usize>,
}

/// The leaves among which crossings are sought.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Among {
    World,
    /// Those near the bundle, of which the ray is one.
    Bundle,
    /// Those of them that are no solids by themselves.
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

/// The number of lines that are kept, a power of two.
const KNOWN_LINES: usize = 16;

/// A leaf whose box the ray meets.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    entry: f64,
    exit: f64,
    leaf: u32,
}

/// A surface that the ray passes.
#[derive(Clone, Copy, Debug)]
struct SurfaceEvent {
    t: f64,
    leaf: u32,
    piece: u32,
    /// Of a field, the part of the ray in which its next event is sought once this one is passed.
    rest: Option<[f64; 2]>,
}

impl World {
    /// A caster of rays into this world.
    pub fn caster(&self) -> Caster<'_> {
        Caster {
            world: self,
            state: ForestState::default(),
            field: FieldScratch::default(),
            inside: vec![false; self.piece_count],
            candidates: Vec::new(),
            events: Vec::new(),
            shared: FxHashMap::default(),
            shared_fields: FxHashMap::default(),
            bundle: Vec::new(),
            divides_fields: false,
            bundle_parts: FxHashMap::default(),
            near: NearLeaves::default(),
            ray_number: 0,
            lines: [KnownLine::default(); KNOWN_LINES],
            group: Vec::new(),
            stack: Vec::new(),
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
        let ray = &{ self.bundle[index] };
        let mut sought = Sought {
            first: true,
            among: Among::Bundle,
            ..Sought::ALL
        };
        let lone = match self.near.first(index) {
            FirstPlace::Unknown => {
                self.sweep(ray, sought, &mut |_| true);
                return &self.crossings;
            }
            FirstPlace::Nothing => None,
            FirstPlace::Enters(t, leaf) => Some((t, leaf)),
        };
        if self.near.joined().is_empty() {
            self.start.clear();
            self.crossings.clear();
        } else {
            sought.among = Among::JoinedOfBundle;
            sought.before = lone.map_or(f64::INFINITY, |(t, _)| t.next_up());
            self.sweep(ray, sought, &mut |_| true);
        }
        if let Some((t, leaf)) = lone {
            match self.crossings.first() {
                None => {
                    let crossing = self.entered(ray, t, leaf);
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

    /// The crossing of the ray with this index in the bundle, if it is known without a sweep that one lies before `before`.
    pub(crate) fn known_before(&mut self, index: usize, before: f64) -> Option<Crossing> {
        match self.near.first(index) {
            FirstPlace::Enters(t, leaf) if t < before => {
                let ray = self.bundle[index];
                Some(self.entered(&ray, t, leaf))
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
        let among = match self.near.first(index) {
            FirstPlace::Enters(t, _) if t < before => Among::Bundle,
            FirstPlace::Unknown => Among::Bundle,
            _ if self.near.joined().is_empty() => return,
            _ => Among::JoinedOfBundle,
        };
        let sought = Sought {
            before,
            among,
            ..Sought::ALL
        };
        let ray = self.bundle[index];
        self.sweep(&ray, sought, found);
    }

    /// Reads these rays together, until the next bundle: [`Caster::first_of_bundle`] then takes less time, the less the
    /// nearer they are to each other. The rays of a few pixels by a few make a good bundle.
    pub fn begin_bundle(&mut self, rays: &[Ray]) {
        self.begin_near(rays.iter().copied(), f64::INFINITY, None);
        self.divide_fields();
    }

    /// Reads fields for all rays of the bundle at once: that pays where they stay near each other.
    pub(crate) fn divide_fields(&mut self) {
        self.divides_fields = true;
    }

    /// Finds the leaves that these rays, all of which leave the surface `leaving`, may meet before `reach`, until the next
    /// bundle.
    pub(crate) fn begin_near(
        &mut self,
        rays: impl Iterator<Item = Ray> + Clone,
        reach: f64,
        leaving: Option<SurfaceId>,
    ) {
        self.bundle.clear();
        self.bundle_parts.clear();
        self.divides_fields = false;
        let bundle = RayBundle::new(rays.clone(), reach);
        self.near.find(self.world, &bundle, leaving);
        if !self.near.is_empty() {
            self.bundle.extend(rays);
            let rays = &self.bundle;
            self.near.find_first_places(self.world, rays, leaving);
        }
    }

    /// True if no ray of the bundle meets anything.
    pub(crate) fn bundle_is_free(&self) -> bool {
        self.near.is_empty()
    }

    /// The first crossing with t > 0 of the ray with this index in the bundle.
    pub fn first_of_bundle(&mut self, index: usize) -> Option<Crossing> {
        self.nearest(index).first().copied()
    }

    /// The solids that the last ray was inside of right after its start, ascending.
    pub fn solids_at_start(&self) -> &[usize] {
        &self.start
    }

    /// The number of evaluations on intervals so far.
    pub fn interval_evaluations(&self) -> u64 {
        self.field.evaluations
    }

    fn sweep(&mut self, ray: &Ray, sought: Sought, found: &mut dyn FnMut(&Crossing) -> bool) {
        let Sought { among, before, .. } = sought;
        let bundled = among != Among::World;
        self.state.reset(&self.world.forest);
        self.crossings.clear();
        self.events.clear();
        self.shared.clear();
        self.shared_fields.clear();
        self.start.clear();
        self.field.begin();
        self.ray_number += 1;
        if !ray.is_usable() {
            return;
        }
        self.find_candidates(ray, among);
        let mut next = 0;
        while next < self.candidates.len() && self.candidates[next].entry <= 0.0 {
            self.activate(ray, self.candidates[next], bundled);
            next += 1;
        }
        self.read_start();
        loop {
            let event = self.events.last().map_or(before, |event| event.t);
            if next < self.candidates.len() && self.candidates[next].entry <= event.min(before) {
                self.activate(ray, self.candidates[next], bundled);
                next += 1;
                continue;
            }
            let Some(event) = self.events.last().copied() else {
                break;
            };
            if event.t >= before {
                break;
            }
            self.group.clear();
            while let Some(same) = self.events.pop_if(|next| next.t == event.t) {
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

    /// The leaves that the ray may meet, by entry.
    fn find_candidates(&mut self, ray: &Ray, among: Among) {
        let Self {
            world,
            candidates,
            stack,
            near,
            ..
        } = self;
        candidates.clear();
        let endless = |leaf: u32| Candidate {
            entry: f64::NEG_INFINITY,
            exit: f64::INFINITY,
            leaf,
        };
        let reciprocal = ray.direction.recip();
        let of_bundle = match among {
            Among::Bundle if !near.is_crowded() => near.all(),
            Among::JoinedOfBundle => near.joined(),
            Among::World | Among::Bundle => {
                candidates.extend(world.endless.iter().copied().map(endless));
                world
                    .hierarchy
                    .met(ray.origin, reciprocal, stack, &mut |k, [entry, exit]| {
                        let leaf = world.boxed[k];
                        candidates.push(Candidate { entry, exit, leaf });
                    });
                &[]
            }
        };
        for &NearLeaf { leaf, bounds } in of_bundle {
            let Some(bounds) = bounds else {
                candidates.push(endless(leaf));
                continue;
            };
            let [entry, exit] = bounds.part(ray.origin, reciprocal);
            if entry <= exit && exit >= 0.0 {
                candidates.push(Candidate { entry, exit, leaf });
            }
        }
        // A start on a leaf is in its box, whatever rounding says.
        if let Some(leaving) = ray.leaving
            && let Some(own) = candidates.iter_mut().find(|c| c.leaf == leaving.leaf)
        {
            own.entry = own.entry.min(0.0);
        }
        if candidates.len() > 1 {
            candidates.sort_unstable_by(|a, b| {
                let by_entry = a.entry.total_cmp(&b.entry);
                by_entry.then(a.leaf.cmp(&b.leaf))
            });
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

    /// Reads a leaf: its membership where the ray comes to it, and its events.
    fn activate(&mut self, ray: &Ray, candidate: Candidate, bundled: bool) {
        let world = self.world;
        let leaf = &world.leaves[candidate.leaf as usize];
        if world.convex[candidate.leaf as usize] {
            return self.activate_convex(ray, candidate);
        }
        let line = self.line(ray, candidate.leaf);
        if !(line.speed.is_finite() && line.speed > 0.0) {
            return;
        }
        self.state.set(&self.world.forest, leaf.gate, true);
        let from = candidate.entry.max(0.0);
        let to = candidate.exit;
        let before = self.events.len();
        for (k, piece) in leaf.compiled.pieces.iter().enumerate() {
            let surface = SurfaceId {
                leaf: candidate.leaf,
                piece: k as u32,
            };
            let index = leaf.first_piece + k;
            let inside = match piece {
                LeafSurface::Polynomial(polynomial) => {
                    if let Some(low) = &world.low[index] {
                        let leaving = ray.leaving.is_some() && self.leaves(ray, surface);
                        let Some(changes) = self.low_changes(ray, low, leaving) else {
                            return;
                        };
                        self.add_events(surface, changes.places(), [from, to]);
                        changes.inside_after(from) != low.opposite
                    } else {
                        let range = leaf.bounded.then_some([from, to]);
                        let (changes, opposite) =
                            self.polynomial_changes(ray, &line, polynomial, surface, range);
                        self.add_events(surface, changes.places(), [from, to]);
                        changes.inside_after(from) != opposite
                    }
                }
                LeafSurface::Field(field, _) => {
                    let line = field_line(leaf, ray);
                    let leaving = from == 0.0 && self.leaves(ray, surface);
                    let (inside, start) = field.start(&mut self.field, &line, [from, to], leaving);
                    self.seek(ray, surface, [start, to], inside, bundled);
                    inside
                }
            };
            self.inside[index] = inside;
            if inside {
                self.state.set(&self.world.forest, leaf.pieces[k], true);
            }
        }
        if self.events.len() > before && self.events.len() > 1 {
            self.sort_events();
        }
    }

    /// The sign changes of a piece; `None` where its frame is none for the ray.
    #[inline]
    fn low_changes(
        &mut self,
        ray: &Ray,
        low: &LowPiece,
        leaving: bool,
    ) -> Option<QuadraticChanges> {
        match &low.equation {
            LowEquation::Plane(plane) => Some(plane.changes(ray, leaving)),
            LowEquation::Quadric { frame, form } => {
                let line = self.line(ray, *frame);
                let is_line = line.speed.is_finite() && line.speed > 0.0;
                is_line.then(|| quadratic_changes_in_t(&line, form, leaving))
            }
        }
    }

    /// Reads a convex leaf, whose membership is that of its gate: the ray is inside from its last entry into a piece to its
    /// first exit from one.
    fn activate_convex(&mut self, ray: &Ray, candidate: Candidate) {
        let world = self.world;
        let leaf = &world.leaves[candidate.leaf as usize];
        let (mut entry, mut exit) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
        for piece in 0..leaf.compiled.pieces.len() as u32 {
            let Some(low) = &world.low[leaf.first_piece + piece as usize] else {
                return;
            };
            let surface = SurfaceId {
                leaf: candidate.leaf,
                piece,
            };
            let leaving = ray.leaving.is_some() && self.leaves(ray, surface);
            let Some(changes) = self.low_changes(ray, low, leaving) else {
                return;
            };
            let Some([from, to]) = changes.convex_part(low.opposite) else {
                return;
            };
            if from > entry.0 {
                entry = (from, piece);
            }
            if to < exit.0 {
                exit = (to, piece);
            }
        }
        if entry.0 >= exit.0 {
            return;
        }
        let from = candidate.entry.max(0.0);
        let inside = entry.0 <= from && from < exit.0;
        self.inside[leaf.first_piece] = inside;
        if inside {
            self.state.set(&world.forest, leaf.gate, true);
        }
        let before = self.events.len();
        for (t, piece) in [entry, exit] {
            let surface = SurfaceId {
                leaf: candidate.leaf,
                piece,
            };
            self.add_events(surface, &[t], [from, candidate.exit]);
        }
        if self.events.len() > before && self.events.len() > 1 {
            self.sort_events();
        }
    }

    fn add_events(&mut self, surface: SurfaceId, places: &[f64], [from, to]: [f64; 2]) {
        for &t in places {
            if t > from && t <= to {
                self.events.push(SurfaceEvent {
                    t,
                    leaf: surface.leaf,
                    piece: surface.piece,
                    rest: None,
                });
            }
        }
    }

    /// The ray in the frame of a leaf.
    fn line(&mut self, ray: &Ray, leaf: u32) -> UnitLine {
        // The leaves of one solid are often as many as those of the next: the places of multiples differ too.
        let place = leaf.wrapping_mul(0x9e37_79b1) as usize >> (32 - KNOWN_LINES.ilog2());
        let known = &mut self.lines[place];
        if known.ray_number != self.ray_number || known.leaf != leaf {
            *known = KnownLine {
                ray_number: self.ray_number,
                leaf,
                line: UnitLine::new(&self.world.leaves[leaf as usize], ray),
            };
        }
        known.line
    }

    /// The next one last.
    fn sort_events(&mut self) {
        self.events.sort_unstable_by(|a, b| {
            let by_t = b.t.total_cmp(&a.t);
            by_t.then((b.leaf, b.piece).cmp(&(a.leaf, a.piece)))
        });
    }

    /// Adds the next event of a field, `inside` being its membership right after the start of this part of the ray.
    fn seek(
        &mut self,
        ray: &Ray,
        id: SurfaceId,
        [from, to]: [f64; 2],
        inside: bool,
        bundled: bool,
    ) {
        let leaf = &self.world.leaves[id.leaf as usize];
        let LeafSurface::Field(field, _) = &leaf.compiled.pieces[id.piece as usize] else {
            return;
        };
        let line = field_line(leaf, ray);
        let known: &[BundlePart] = if bundled && self.divides_fields {
            let bundle = &self.bundle;
            let divided = self.bundle_parts.entry(id);
            divided.or_insert_with(|| divide_bundle(field, leaf, bundle, &mut self.field))
        } else {
            &[]
        };
        let found = field.next_change(&mut self.field, &line, [from, to], inside, known);
        if let Some((t, rest)) = found {
            let t = self.snapped(id, t);
            self.events.push(SurfaceEvent {
                t,
                leaf: id.leaf,
                piece: id.piece,
                rest: Some([rest, to]),
            });
        }
    }

    /// The sign changes of a surface in t; true if it is the other side of them.
    fn polynomial_changes(
        &mut self,
        ray: &Ray,
        line: &UnitLine,
        surface: &PolynomialSurface,
        id: SurfaceId,
        range: Option<[f64; 2]>,
    ) -> (SignChanges, bool) {
        let leaf = &self.world.leaves[id.leaf as usize];
        let member = self
            .world
            .surfaces
            .group(leaf.first_piece + id.piece as usize);
        let Some(member) = member else {
            let leaving = self.leaves(ray, id);
            return (changes_in_t(line, surface, leaving, range), false);
        };
        if let Some(known) = self.shared.get(&member.group) {
            return (*known, member.opposite);
        }
        let leaving = self.leaves(ray, id);
        let (l, p) = self.world.surfaces.first[member.group as usize];
        let first = &self.world.leaves[l as usize];
        let LeafSurface::Polynomial(equation) = &first.compiled.pieces[p as usize] else {
            return (changes_in_t(line, surface, leaving, range), false);
        };
        let changes = changes_in_t(&UnitLine::new(first, ray), equation, leaving, None);
        self.shared.insert(member.group, changes);
        (changes, member.opposite)
    }

    /// True if the ray starts on this surface.
    fn leaves(&self, ray: &Ray, id: SurfaceId) -> bool {
        let Some(leaving) = ray.leaving else {
            return false;
        };
        let group = self.world.group(leaving);
        leaving == id || group.is_some() && group == self.world.group(id)
    }

    /// The t that the first leaf of a shared field found.
    fn snapped(&mut self, id: SurfaceId, t: f64) -> f64 {
        let leaf = &self.world.leaves[id.leaf as usize];
        let Some(member) = self
            .world
            .surfaces
            .group(leaf.first_piece + id.piece as usize)
        else {
            return t;
        };
        let known = self.shared_fields.entry(member.group).or_default();
        let near = |other: &&f64| (t - **other).abs() <= 1e-10 * (1.0 + t.abs());
        match known.iter().find(near) {
            Some(other) => *other,
            None => {
                known.push(t);
                t
            }
        }
    }

    /// Passes the events of the group, and notes what is crossed.
    fn pass(&mut self, ray: &Ray) {
        self.group
            .sort_unstable_by_key(|event| (event.leaf, event.piece));
        self.state.changed.clear();
        for k in 0..self.group.len() {
            self.toggle(self.group[k]);
        }
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
            let before = self.events.len();
            self.seek(ray, id, rest, inside, bundled);
            if self.events.len() > before {
                self.sort_events();
            }
        }
    }

    fn toggle(&mut self, event: SurfaceEvent) {
        let leaf = &self.world.leaves[event.leaf as usize];
        let is_convex = self.world.convex[event.leaf as usize];
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

    /// The crossing where a ray enters a leaf that is a solid by itself.
    fn entered(&mut self, ray: &Ray, t: f64, leaf: u32) -> Crossing {
        self.ray_number += 1;
        let solid = self.world.leaves[leaf as usize].solid;
        let event = SurfaceEvent {
            t,
            leaf,
            piece: 0,
            rest: None,
        };
        self.crossing(ray, event, solid, true)
    }

    fn crossing(
        &mut self,
        ray: &Ray,
        event: SurfaceEvent,
        solid: usize,
        entering: bool,
    ) -> Crossing {
        let world = self.world;
        let leaf = &world.leaves[event.leaf as usize];
        let piece = leaf.first_piece + event.piece as usize;
        let flat = world.low[piece].as_ref().and_then(|low| low.normal);
        let normal = flat.or_else(|| self.gradient(ray, event).try_normalize());
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

    /// The gradient of the surface of an event.
    fn gradient(&mut self, ray: &Ray, event: SurfaceEvent) -> DVec3 {
        let world = self.world;
        let leaf = &world.leaves[event.leaf as usize];
        match &leaf.compiled.pieces[event.piece as usize] {
            LeafSurface::Polynomial(surface) => {
                let line = self.line(ray, event.leaf);
                let at = line.point + line.place(event.t) * line.direction;
                leaf.unit_from_world.matrix3.transpose() * surface.gradient(at)
            }
            LeafSurface::Field(field, _) => {
                let position = ray.origin + event.t * ray.direction;
                let at = leaf.shape_from_world.transform_point3(position);
                let gradient = field.gradient(&mut self.field, at);
                leaf.shape_from_world.matrix3.transpose() * gradient
            }
        }
    }
}

/// The parts of the range in which rays are within a leaf's box, with what is known of the field for all of them.
fn divide_bundle(
    field: &Field,
    leaf: &Leaf,
    rays: &[Ray],
    scratch: &mut FieldScratch,
) -> Vec<BundlePart> {
    let Some(bounds) = leaf.bounds else {
        return Vec::new();
    };
    let [mut from, mut to] = [f64::INFINITY, 0.0f64];
    for ray in rays {
        let [entry, exit] = bounds.part(ray.origin, ray.direction.recip());
        if entry <= exit && exit >= 0.0 {
            from = from.min(entry.max(0.0));
            to = to.max(exit);
        }
    }
    if from >= to || !to.is_finite() {
        return Vec::new();
    }
    let lines = rays.iter().map(|ray| field_line(leaf, ray));
    field.divide(scratch, &LineBundle::new(lines), [from, to])
}
