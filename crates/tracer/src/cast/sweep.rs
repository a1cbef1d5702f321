//! The sweep along a ray.
//!
//! In: a ray, and what is sought on it. Out: the crossings, in ascending order. The boxes that the ray meets are in a queue,
//! and so are the events of the leaves whose boxes it has reached. Events at the same point are processed together: a solid
//! is crossed there if all of them change its membership.

use super::queue::RayOrder;
use super::{BOX, Caster, Crossing, SurfaceEvent};
use crate::bounds::BoundingBox;
use crate::bvh::NodePart;
use crate::leaf::NearLeaf;
use crate::line::{Ray, SurfaceId};

/// The leaves in which crossings are sought.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Among {
    World,
    /// The leaves near the bundle, to which the ray belongs.
    Bundle,
    /// Those leaves near the bundle that do not belong to products.
    JoinedOfBundle,
}

/// The part of a ray that the caller asks for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sought {
    /// True if only the first crossings are needed.
    pub(super) first: bool,
    pub(super) among: Among,
    /// Crossings are sought before this t.
    pub(super) before: f64,
}

impl Sought {
    pub(super) const ALL: Self = Self {
        first: false,
        among: Among::World,
        before: f64::INFINITY,
    };
}

/// The work for a ray, for a leaf on it, and for a box that it meets, in operations; derived from measured times.
const RAY_OPERATIONS: u64 = 32;
const LEAF_OPERATIONS: u64 = 16;
const BOX_OPERATIONS: u64 = 8;

/// The owner of a box that a ray meets: a node of the hierarchy or, numbered after all nodes, a leaf.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub(super) struct BoxOwner(u32);

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

impl Caster<'_> {
    /// Finds the crossings that are sought, in ascending order, and ends once `found` returns false for one.
    pub(super) fn sweep(
        &mut self,
        ray: &Ray,
        sought: Sought,
        found: &mut dyn FnMut(&Crossing) -> bool,
    ) {
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
}
