//! Points, arrows and curves as bodies.
//!
//! In: an object of a scene. Out: balls, cylinders and cones whose union is its body. A point is a ball, an arrow a cylinder
//! with a cone, a curve or a geodesic a chain of cylinders joined by balls.

use expr::tape::Tape;
use expr::{Graph, Input, NodeId};
use glam::{DAffine3, DMat3, DVec3};
use scene::{Object, ObjectId, ParamValues, Scene, Shape};
use tracer::{BuildError, SetStep, ShapeId, WorldBuilder, is_singular};

use super::attributes::{AttributeSet, NumberAttribute, evaluated};
use crate::breaks::{Breaks, Interruptions, jumps_along_geodesics};
use crate::declared::follow_declared;

/// The maximum number of balls, cylinders and cones of all points, arrows and curves of a scene; the rest is not drawn.
pub const MAX_BODIES: usize = 400_000;

/// The sizes of points, arrows and curves that state no `radius`, in the scene's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thickness {
    /// The radius of points.
    pub point: f64,
    /// The radius of curves, geodesics and the shafts of arrows.
    pub line: f64,
    /// The length of an arrow's head, in radii of its shaft.
    pub head_length: f64,
    /// The radius of an arrow's head, in radii of its shaft.
    pub head_radius: f64,
    /// The maximum length of an arrow's head as a fraction of the arrow's length.
    pub head_share: f64,
}

/// A shape of which bodies consist.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum BodyShape {
    /// The unit ball.
    Ball,
    /// The cylinder of radius 1 about z, from z = −1 to 1.
    Cylinder,
    /// The cone of radius 1 at z = 0 with its tip at z = 1.
    Cone,
}

/// A part of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyPart {
    pub(super) shape: BodyShape,
    /// The map from the shape's coordinates to the scene's.
    pub(super) map: DAffine3,
    /// The parameter of its curve at z = −1 and at z = 1.
    pub(super) parameter: [f64; 2],
    /// The index of the instance of its object.
    pub(super) instance: u64,
}

/// The shapes in a world; each is added with the first body that uses it.
#[derive(Debug, Default)]
pub(super) struct BodyShapes {
    nodes: Option<[NodeId; 3]>,
    known: [Option<ShapeId>; 3],
}

impl BodyShapes {
    /// Adds the expressions of the shapes to a graph.
    pub(super) fn prepare(&mut self, graph: &mut Graph) {
        let [x, y, z] = [0, 1, 2].map(|k| graph.input(Input::Variable(k)));
        let [xx, yy, zz] = [x, y, z].map(|x| graph.mul(x, x));
        let one = graph.constant(1.0);
        let around = graph.add(xx, yy);
        let all = graph.add(around, zz);
        let ball = graph.sub(all, one);
        let cylinder = graph.sub(around, one);
        let rest = graph.sub(one, z);
        let rest = graph.mul(rest, rest);
        let cone = graph.sub(around, rest);
        self.nodes = Some([ball, cylinder, cone]);
    }

    /// Returns the steps of the union of parts.
    pub(super) fn steps(
        &mut self,
        builder: &mut WorldBuilder<'_>,
        parts: &[BodyPart],
    ) -> Result<Vec<SetStep>, BuildError> {
        let Some(nodes) = self.nodes else {
            return Ok(Vec::new());
        };
        let mut steps = Vec::with_capacity(2 * parts.len());
        for (k, part) in parts.iter().enumerate() {
            let kind = part.shape as usize;
            let shape = match self.known[kind] {
                Some(shape) => shape,
                None => {
                    let cut = match part.shape {
                        BodyShape::Ball => None,
                        BodyShape::Cylinder => Some([-1.0, 1.0]),
                        BodyShape::Cone => Some([0.0, 1.0]),
                    };
                    builder.shape(nodes[kind], [None, None, cut])?
                }
            };
            self.known[kind] = Some(shape);
            steps.push(SetStep::Leaf(shape, part.map));
            if k > 0 {
                steps.push(SetStep::Union);
            }
        }
        Ok(steps)
    }
}

/// Returns the parts of all instances of a point, a vector, a curve or a geodesic in space, at most `room`; and true if
/// there would be more. The result is empty for other objects.
pub(super) fn parts(
    scene: &Scene,
    params: &ParamValues,
    (id, object): (ObjectId, &Object),
    attributes: &AttributeSet,
    thickness: &Thickness,
    room: usize,
) -> (Vec<BodyPart>, bool) {
    let usual = if object.shape.is_point() {
        thickness.point
    } else {
        thickness.line
    };
    let mut body = Body {
        parts: Vec::new(),
        instance: 0,
        thickness,
        attributes,
        usual,
    };
    let graph = &scene.graph;
    let mut instances = 0..params.instance_count(scene, object);
    match &object.shape {
        Shape::Point { position } => {
            let tape = Tape::new(graph, position);
            while let Some(k) = next(&mut instances, &body, room) {
                let uniforms = params.instance(scene, object, k);
                body.instance = k;
                let at = evaluated(&tape, &[], &uniforms, DVec3::from_slice);
                body.ball(at, body.radius(&uniforms, 0.0), 0.0);
            }
        }
        Shape::Vector { direction, origin } => {
            let tape = Tape::new(graph, &[*direction, *origin].concat());
            while let Some(k) = next(&mut instances, &body, room) {
                let uniforms = params.instance(scene, object, k);
                body.instance = k;
                let [direction, origin] = evaluated(&tape, &[], &uniforms, |out| {
                    [&out[..3], &out[3..]].map(DVec3::from_slice)
                });
                let radius = body.radius(&uniforms, 0.0);
                // As in the 3D view, an arrow of length 0 is a point.
                match direction == DVec3::ZERO {
                    true => body.ball(origin, radius, 0.0),
                    false => body.arrow(origin, direction, radius),
                }
            }
        }
        Shape::Curve {
            position, domain, ..
        } => {
            let tape = Tape::new(graph, position);
            let finder = Breaks::of(scene, params, object);
            while let Some(k) = next(&mut instances, &body, room) {
                let uniforms = params.instance(scene, object, k);
                body.instance = k;
                let found = finder
                    .as_ref()
                    .and_then(|it| it.find(&[*domain], &uniforms));
                let Interruptions { breaks, poles } = found.unwrap_or_default();
                let places = (0..domain.count).map(|i| {
                    let t = domain.value(i);
                    let variables = scene.curve_variables(&object.shape, &uniforms, t);
                    let at = evaluated(&tape, &variables, &uniforms, DVec3::from_slice);
                    let at = Some(at).filter(|at| at.is_finite()).or_else(|| {
                        let limit = finder.as_ref()?.limit(&[*domain], &uniforms, [t, 0.0]);
                        limit.map(DVec3::from_array)
                    });
                    at.filter(|_| poles.binary_search(&[i, 0]).is_err())
                });
                let places: Vec<Option<DVec3>> = places.collect();
                let jumps = match object.shape.followed().is_empty() {
                    true => Vec::new(),
                    false => {
                        let places: Vec<Option<[f64; 3]>> =
                            places.iter().map(|at| at.map(|at| at.to_array())).collect();
                        jumps_along_geodesics(scene, object, domain, &uniforms, &places)
                    }
                };
                let places = (0..domain.count).zip(places).flat_map(|(i, at)| {
                    let is_break = breaks.binary_search_by_key(&i, |it| it.first[0]).is_ok();
                    let is_last = is_break || jumps.binary_search(&i).is_ok();
                    let t = domain.value(i);
                    std::iter::once((t, at)).chain(is_last.then_some((t, None)))
                });
                body.line(places, &uniforms);
            }
        }
        Shape::Geodesic { domain, .. } => {
            let followed = follow_declared(scene, params, id);
            for (k, line) in (0..).zip(&followed.lines) {
                if next(&mut instances, &body, room).is_none() {
                    break;
                }
                let uniforms = params.instance(scene, object, k);
                body.instance = k;
                let places = (0..domain.count).zip(line).map(|(i, knot)| {
                    let at = knot.and_then(|knot| knot.position);
                    (domain.value(i), at.map(DVec3::from_array))
                });
                body.line(places, &uniforms);
            }
        }
        _ => {}
    }
    let more = body.parts.len() > room;
    body.parts.truncate(room);
    (body.parts, more)
}

/// The instances and the parameters of a curve at which its radius is read.
const RADIUS_READS: u32 = 32;

/// The largest radius that a point, a vector, a curve or a geodesic states, in the scene's units; 0 where it states none.
pub fn stated_radius(scene: &Scene, params: &ParamValues, object: &Object) -> f64 {
    let attributes = AttributeSet::new(&scene.graph, &object.attributes, false);
    if !attributes.states(NumberAttribute::Radius) {
        return 0.0;
    }
    let parameters: Vec<f64> = match &object.shape {
        Shape::Curve { domain, .. } | Shape::Geodesic { domain, .. } => {
            let step = domain.count.div_ceil(RADIUS_READS).max(1);
            let places = (0..domain.count).step_by(step as usize);
            let last = domain.count.checked_sub(1);
            places.chain(last).map(|k| domain.value(k)).collect()
        }
        _ => vec![0.0],
    };
    let count = params.instance_count(scene, object);
    let step = count.div_ceil(RADIUS_READS.into()).max(1);
    let instances = (0..count).step_by(step as usize);
    let radii = instances.flat_map(|k| {
        let uniforms = params.instance(scene, object, k);
        let radius = |&t: &f64| radius_at(&attributes, &uniforms, t, 0.0);
        parameters.iter().map(radius).collect::<Vec<f64>>()
    });
    radii.filter(|it| it.is_finite()).fold(0.0, f64::max)
}

/// The stated radius at a parameter, or the usual one.
fn radius_at(attributes: &AttributeSet, uniforms: &[f64], t: f64, usual: f64) -> f64 {
    let mut radius = usual;
    let place = |_| [t, f64::NAN, f64::NAN];
    attributes.at(uniforms, place, |numbers| {
        if numbers.attribute == NumberAttribute::Radius {
            radius = numbers.number();
        }
    });
    radius
}

/// Returns the next instance, while there is room.
fn next(instances: &mut std::ops::Range<u64>, body: &Body<'_>, room: usize) -> Option<u64> {
    (body.parts.len() <= room).then(|| instances.next())?
}

struct Body<'a> {
    parts: Vec<BodyPart>,
    instance: u64,
    thickness: &'a Thickness,
    attributes: &'a AttributeSet,
    /// The radius if none is stated.
    usual: f64,
}

impl Body<'_> {
    /// Returns the radius at a parameter.
    fn radius(&self, uniforms: &[f64], t: f64) -> f64 {
        radius_at(self.attributes, uniforms, t, self.usual)
    }

    fn push(&mut self, shape: BodyShape, map: DAffine3, parameter: [f64; 2]) {
        if !is_singular(&map) && map.matrix3.determinant() > 0.0 {
            self.parts.push(BodyPart {
                shape,
                map,
                parameter,
                instance: self.instance,
            });
        }
    }

    fn ball(&mut self, at: DVec3, radius: f64, t: f64) {
        let scale = DMat3::from_diagonal(DVec3::splat(radius));
        let map = DAffine3::from_mat3_translation(scale, at);
        self.push(BodyShape::Ball, map, [t; 2]);
    }

    /// Adds a shape whose axis runs from a point along a vector.
    fn along(&mut self, shape: BodyShape, from: DVec3, axis: DVec3, radius: f64, t: [f64; 2]) {
        let Some(unit) = axis.try_normalize() else {
            return;
        };
        let x = unit.any_orthonormal_vector();
        let y = unit.cross(x);
        let map = if shape == BodyShape::Cylinder {
            let half = 0.5 * axis;
            let turned = DMat3::from_cols(radius * x, radius * y, half);
            DAffine3::from_mat3_translation(turned, from + half)
        } else {
            let turned = DMat3::from_cols(radius * x, radius * y, axis);
            DAffine3::from_mat3_translation(turned, from)
        };
        self.push(shape, map, t);
    }

    fn arrow(&mut self, origin: DVec3, direction: DVec3, radius: f64) {
        let length = direction.length();
        let Thickness {
            head_length,
            head_radius,
            head_share,
            ..
        } = *self.thickness;
        // A short arrow is scaled down in all its parts.
        let radius = radius.min(head_share * length / head_length);
        let shaft = direction * (1.0 - head_length * radius / length);
        self.along(BodyShape::Cylinder, origin, shaft, radius, [0.0; 2]);
        let head = direction - shaft;
        let tip = head_radius * radius;
        self.along(BodyShape::Cone, origin + shaft, head, tip, [0.0; 2]);
    }

    fn line(&mut self, places: impl Iterator<Item = (f64, Option<DVec3>)>, uniforms: &[f64]) {
        let mut last: Option<(f64, DVec3, f64)> = None;
        for (t, at) in places {
            let here = at.map(|at| (t, at, self.radius(uniforms, t)));
            if let Some((t, at, radius)) = here {
                if let Some((s, from, before)) = last {
                    let mean = 0.5 * (before + radius);
                    self.along(BodyShape::Cylinder, from, at - from, mean, [s, t]);
                }
                self.ball(at, radius, t);
            }
            last = here;
        }
    }
}
