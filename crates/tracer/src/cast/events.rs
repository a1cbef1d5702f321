//! The events of leaves on a ray.
//!
//! In: a leaf whose box the ray reaches. Out: the membership there, and the points where the ray crosses the surfaces of the
//! leaf's pieces. A convex leaf has two events at most; other leaves have those of each piece. A field yields one event at a
//! time.
//!
//! Before and behind its box a leaf counts as outside, whatever the computed surfaces are there: if the ray is still inside
//! the leaf at the end of the box, the leaf ends there.

use super::queue::RayOrder;
use super::{Caster, KNOWN_LINES, KnownLine, SurfaceEvent};
use crate::bundle::RayBlocks;
use crate::field::{DividedBundle, Field, FieldScratch};
use crate::leaf::Leaf;
use crate::line::{Ray, SurfaceId, UnitLine, changes_in_t, field_line, quadratic_changes_in_t};
use crate::low::{LowEquation, LowPiece};
use crate::roots::{QuadraticChanges, SignChanges};
use crate::shape::LeafSurface;
use crate::surface::PolynomialSurface;

impl Caster<'_> {
    /// Reads a leaf whose box contains the ray from `entry` to `exit`: the membership where the ray enters the box, and the
    /// events.
    pub(super) fn activate(
        &mut self,
        ray: &Ray,
        number: u32,
        [entry, exit]: [f64; 2],
        bundled: bool,
    ) {
        let world = self.world;
        let leaf = &world.leaves[number as usize];
        let part = [entry.max(0.0), exit];
        if leaf.ends && part[0] >= part[1] {
            // The ray starts at the end of the box.
            return;
        }
        if world.convex[number as usize] {
            return self.activate_convex(ray, number, part);
        }
        let line = self.line(ray, number);
        if !line.is_usable() {
            return;
        }
        self.state.set(&self.world.forest, leaf.gate, true);
        self.gates[number as usize] = true;
        let [from, to] = part;
        let mut ends_inside = false;
        for (k, piece) in leaf.compiled.pieces.iter().enumerate() {
            let surface = SurfaceId {
                leaf: number,
                piece: k as u32,
            };
            let index = leaf.first_piece + k;
            let inside = match piece {
                LeafSurface::Polynomial(polynomial) => {
                    if let Some(low) = &world.low[index] {
                        let leaving = ray.leaving.is_some() && self.leaves(ray, surface);
                        let changes = self.low_changes(ray, low, leaving).unwrap_or_default();
                        self.add_events(surface, changes.places(), [from, to]);
                        ends_inside |= changes.inside_after(to) != low.opposite;
                        changes.inside_after(from) != low.opposite
                    } else {
                        self.operations += polynomial.operations();
                        let range = leaf.bounded.then_some([from, to]);
                        let (changes, opposite) =
                            self.polynomial_changes(ray, &line, polynomial, surface, range);
                        self.add_events(surface, changes.places(), [from, to]);
                        ends_inside |= changes.inside_after(to) != opposite;
                        changes.inside_after(from) != opposite
                    }
                }
                LeafSurface::Field(..) if !self.field.may_evaluate() => false,
                LeafSurface::Field(field, _) => {
                    let line = field_line(leaf, ray);
                    let leaving = from == 0.0 && self.leaves(ray, surface);
                    let known = if bundled && self.divides_fields {
                        let (bundle, index) = (&self.bundle, self.bundle_index);
                        let divided = self
                            .bundle_parts
                            .entry(surface)
                            .or_insert_with(|| divide_bundle(field, leaf, bundle, &mut self.field));
                        Some((divided, index))
                    } else {
                        None
                    };
                    let (inside, start) =
                        field.start(&mut self.field, &line, [from, to], leaving, known);
                    self.seek(ray, surface, [start, to], inside, bundled);
                    ends_inside = true;
                    inside
                }
            };
            self.inside[index] = inside;
            if inside {
                self.state.set(&self.world.forest, leaf.pieces[k], true);
            }
        }
        if ends_inside && leaf.ends {
            let end = SurfaceEvent::box_side(number, to);
            self.events.push(RayOrder::of(to), end);
        }
    }

    /// Returns the sign changes of a piece; `None` if the ray is not usable in its frame.
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
                line.is_usable()
                    .then(|| quadratic_changes_in_t(&line, form, leaving))
            }
        }
    }

    /// Reads a convex leaf, whose membership is that of its gate: the ray is inside from its last entry into a piece to its
    /// first exit from one.
    fn activate_convex(&mut self, ray: &Ray, number: u32, part: [f64; 2]) {
        let world = self.world;
        let leaf = &world.leaves[number as usize];
        let (mut entry, mut exit) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
        for piece in 0..leaf.compiled.pieces.len() as u32 {
            let Some(low) = &world.low[leaf.first_piece + piece as usize] else {
                return;
            };
            let surface = SurfaceId {
                leaf: number,
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
        let [from, to] = part;
        let inside = entry.0 <= from && from < exit.0;
        self.inside[leaf.first_piece] = inside;
        if inside {
            self.state.set(&world.forest, leaf.gate, true);
        }
        let surface = |piece: u32| SurfaceId {
            leaf: number,
            piece,
        };
        self.add_events(surface(entry.1), &[entry.0], part);
        if entry.0 <= to {
            let end = if leaf.ends { exit.0.min(to) } else { exit.0 };
            self.add_events(surface(exit.1), &[end], part);
        }
    }

    fn add_events(&mut self, surface: SurfaceId, places: &[f64], [from, to]: [f64; 2]) {
        for &t in places {
            if t > from && t <= to {
                let event = SurfaceEvent {
                    t,
                    leaf: surface.leaf,
                    piece: surface.piece,
                    rest: None,
                };
                self.events.push(RayOrder::of(t), event);
            }
        }
    }

    /// Returns the ray in the frame of a leaf.
    pub(super) fn line(&mut self, ray: &Ray, leaf: u32) -> UnitLine {
        // Different solids often have the same number of leaves: hashing separates numbers that differ by a multiple.
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

    /// Adds the next event of a field; `inside` is the membership immediately after the start of this part of the ray.
    pub(super) fn seek(
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
        let divided = self.bundle_parts.get_mut(&id).filter(|_| bundled);
        let known = divided.map(|divided| (divided, self.bundle_index));
        let found = field.next_change(&mut self.field, &line, [from, to], inside, known);
        if let Some((t, rest)) = found {
            let t = self.snapped(id, t);
            let event = SurfaceEvent {
                t,
                leaf: id.leaf,
                piece: id.piece,
                rest: Some([rest, to]),
            };
            self.events.push(RayOrder::of(t), event);
        }
    }

    /// Returns the sign changes of a surface in t, and true if the piece is on the opposite side of it.
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

    /// Returns true if the ray starts on this surface.
    fn leaves(&self, ray: &Ray, id: SurfaceId) -> bool {
        let Some(leaving) = ray.leaving else {
            return false;
        };
        let group = self.world.group(leaving);
        leaving == id || group.is_some() && group == self.world.group(id)
    }

    /// Returns the t that the first leaf of a shared field found.
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
}

/// Returns the parts of the range in which rays are within a leaf's box, with what is known of the field for all of them.
fn divide_bundle(
    field: &Field,
    leaf: &Leaf,
    rays: &RayBlocks,
    scratch: &mut FieldScratch,
) -> DividedBundle {
    let Some(bounds) = leaf.bounds else {
        return DividedBundle::unknown();
    };
    let [mut from, mut to] = [f64::INFINITY, 0.0f64];
    for ray in rays.iter() {
        let [entry, exit] = bounds.part(ray.origin, ray.direction.recip());
        if entry <= exit && exit >= 0.0 {
            from = from.min(entry.max(0.0));
            to = to.max(exit);
        }
    }
    if from >= to || !to.is_finite() {
        return DividedBundle::unknown();
    }
    let lines = rays.iter().map(|ray| field_line(leaf, &ray));
    field.divided(scratch, lines, [from, to])
}
