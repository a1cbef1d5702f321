//! The crossing of an event.
//!
//! In: an event on a ray. Out: the crossing, with the piece that is crossed and the normal there.

use glam::DVec3;

use super::gradient::gradient_on;
use super::{BOX, Caster, Crossing, SurfaceEvent};
use crate::line::{Ray, SurfaceId};
use crate::shape::LeafSurface;

/// The relative distances at which a gradient is evaluated beside a point where it is undefined.
const BESIDE: [f64; 5] = [1e-14, 1e-12, 1e-10, 1e-8, 1e-6];

impl Caster<'_> {
    /// Returns the crossing where a ray passes a surface of a solid.
    // Here and below: a crossing that is returned through memory is read back before the processor has stored it.
    #[inline(always)]
    pub(super) fn passed(
        &mut self,
        ray: &Ray,
        t: f64,
        surface: SurfaceId,
        entering: bool,
    ) -> Crossing {
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

    /// Returns the crossing of an event on a ray, with the normal.
    #[inline(always)]
    pub(super) fn crossing(
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
        let normal = match flat {
            Some(normal) => normal,
            None => match self.gradient(ray, event).try_normalize() {
                Some(normal) => normal,
                None => self.normal_beside(ray, event),
            },
        };
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

    /// Returns a unit normal where there is no usable gradient: that of the gradient beside the point, or else along the ray.
    fn normal_beside(&mut self, ray: &Ray, event: SurfaceEvent) -> DVec3 {
        let beside = self.gradient_beside(ray, event);
        beside.unwrap_or_else(|| ray.direction.normalize_or(DVec3::Z))
    }

    /// Returns the direction of a function's gradient slightly beside a point of the ray where the gradient is undefined. At
    /// a pole it is that of the pole's surface; at the end of a domain the gradient usually tends towards the normal.
    fn gradient_beside(&mut self, ray: &Ray, event: SurfaceEvent) -> Option<DVec3> {
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

    /// Returns a vector along the normal of the surface of an event: the gradient, unless that is only rounding.
    fn gradient(&mut self, ray: &Ray, event: SurfaceEvent) -> DVec3 {
        let world = self.world;
        let leaf = &world.leaves[event.leaf as usize];
        let position = ray.origin + event.t * ray.direction;
        match &leaf.compiled.pieces[event.piece as usize] {
            LeafSurface::Polynomial(surface) => {
                let gradient = match surface.quadratic() {
                    // For a quadric this point is as exact as one on the line in its frame.
                    Some(form) => form.gradient(leaf.unit_from_world.transform_point3(position)),
                    None => {
                        let line = self.line(ray, event.leaf);
                        gradient_on(surface, &line, line.place(event.t))
                    }
                };
                leaf.unit_from_world.matrix3.transpose() * gradient
            }
            LeafSurface::Field(field, _) => {
                let at = leaf.shape_from_world.transform_point3(position);
                let gradient = field.gradient(&mut self.field, at);
                leaf.shape_from_world.matrix3.transpose() * gradient
            }
        }
    }
}
