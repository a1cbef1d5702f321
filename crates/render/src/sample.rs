//! Samples of objects, from f64 blocks: the input of painters.
//!
//! In: an object and the param values. Out: arrays of plain samples, relative to a [`Placement`]. A generated kernel on the
//! GPU fills buffers of the same layout; a painter does not know the source of its samples.
//!
//! The order is instance by instance; within a surface row by row of constant v, u fastest: sample (i, j) of instance k is
//! at index `(k·count_v + j)·count_u + i`.

use bytemuck::{Pod, Zeroable};
use expr::tape::Tape;
use expr::{Graph, Input, NodeId};
use scene::ParamValues;
use scene::{Object, ObjectId, Scene, Shape};

use crate::placement::Placement;
use crate::point::{DrawingPoint, WorldPoint};
use geometry::{
    Breaks, FollowedGeodesic, Knot, follow_declared, jumps_along_geodesics, lies_in_space,
};
use rayon::prelude::*;

mod sampler;
mod surface;

pub(crate) use sampler::{Resolution, Sampler};

/// A surface's normal that does not exist (at a pole, a crease) is evaluated this fraction of the domain further inside.
pub(crate) const NORMAL_NUDGE: f64 = 1e-4;
/// σu and σv, each scaled by its domain's width, count as parallel if |σu×σv| is at most this times the square of the longer
/// one.
pub(crate) const DEGENERATE: f64 = 1e-7;
/// Points farther than this from the scene's centre, in drawing units, count as undefined.
pub const HORIZON: f64 = 1e6;

/// The value of `defined` of a sample after which a curve or a surface breaks off, at a pole or a jump.
const LAST: f32 = 2.0;

/// A position in drawing units: a point, or a sample of a curve. 16 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PositionSample {
    /// The position in drawing units; zero if undefined.
    pub position: [f32; 3],
    /// 0 if undefined, otherwise 1; 2 if a curve breaks off after it.
    pub defined: f32,
}

impl PositionSample {
    /// Returns whether a curve breaks off after it.
    pub fn is_last(&self) -> bool {
        self.defined == LAST
    }
}

impl SurfaceSample {
    /// Returns whether the cell between it and the next samples is left open.
    pub fn is_last(&self) -> bool {
        self.defined == LAST
    }
}

/// A vector in drawing units. 32 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct VectorSample {
    /// Its origin.
    pub origin: [f32; 3],
    /// 1 if origin and direction are defined, otherwise 0.
    pub defined: f32,
    /// The vector from its start to its tip.
    pub direction: [f32; 3],
    /// Makes the size a multiple of 16 bytes.
    pub padding: f32,
}

/// A vertex of a surface. 32 bytes. Its texture coordinates follow from its position in the grid: (i/(count_u − 1),
/// j/(count_v − 1)).
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SurfaceSample {
    /// The position in drawing units; zero if undefined.
    pub position: [f32; 3],
    /// 0 if undefined, otherwise 1; 2 if the cell between it and the next samples is left open.
    pub defined: f32,
    /// The unit vector along σu×σv; zero if it is undefined.
    pub normal: [f32; 3],
    /// Makes the size a multiple of 16 bytes.
    pub padding: f32,
}

/// The painters: one for each kind of sample.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub enum Painter {
    /// Discs.
    Points,
    /// Arrows.
    Vectors,
    /// Strips with round joins.
    Curves,
    /// Lit, textured triangles.
    Surfaces,
    /// Rays.
    Solids,
}

impl Painter {
    /// Returns the painter of an object in space; `None` for an object that is not drawn there.
    pub(crate) fn for_object(scene: &Scene, object: &Object) -> Option<Self> {
        match &object.shape {
            Shape::Point { .. } => Some(Self::Points),
            Shape::Vector { .. } => Some(Self::Vectors),
            Shape::Curve { .. } => Some(Self::Curves),
            Shape::Surface { .. } => Some(Self::Surfaces),
            Shape::Geodesic { .. } => scene.is_in_space(object).then_some(Self::Curves),
            Shape::Solid(_) => Some(Self::Solids),
            Shape::Metric { .. } | Shape::Light(_) | Shape::Camera(_) | Shape::Background(_) => {
                None
            }
        }
    }
}

/// The samples of one object.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// One per instance.
    Points(Vec<PositionSample>),
    /// One per instance.
    Vectors(Vec<VectorSample>),
    /// `count` per instance.
    Curves {
        /// Samples of one instance, at least 2.
        count: u32,
        /// All instances, one after the other.
        samples: Vec<PositionSample>,
    },
    /// `count[0]·count[1]` per instance.
    Surfaces {
        /// Samples of one instance along u and v, each at least 2.
        count: [u32; 2],
        /// All instances, one after the other, u fastest.
        samples: Vec<SurfaceSample>,
    },
}

impl Samples {
    /// Returns the number of samples, and the number of undefined ones.
    pub fn undefined(&self) -> (usize, usize) {
        let positions =
            |s: &[PositionSample]| (s.len(), s.iter().filter(|s| s.defined == 0.0).count());
        match self {
            Self::Points(samples) | Self::Curves { samples, .. } => positions(samples),
            Self::Vectors(s) => (s.len(), s.iter().filter(|s| s.defined == 0.0).count()),
            Self::Surfaces { samples: s, .. } => {
                (s.len(), s.iter().filter(|s| s.defined == 0.0).count())
            }
        }
    }

    /// Returns a note for each geodesic whose value an undefined object needs.
    fn undefined_geodesics(
        &self,
        scene: &Scene,
        params: &ParamValues,
        object: &Object,
    ) -> Vec<String> {
        if object.geodesic_values.is_empty() || self.undefined().1 == 0 {
            return Vec::new();
        }
        let faults = scene.geodesic_faults(object, &params.first_instance(scene, object));
        let faults = faults.into_iter();
        faults
            .map(|(name, fault)| format!("`{name}` has no value: {fault}"))
            .collect()
    }

    /// Returns the note on undefined samples.
    pub fn note(&self, name: &str) -> Option<String> {
        let (all, undefined) = self.undefined();
        note(name, all, undefined)
    }
}

/// Returns the note on the samples of an object, if some are undefined.
pub(crate) fn note(name: &str, all: usize, undefined: usize) -> Option<String> {
    match (all, undefined) {
        (_, 0) => None,
        (1, _) => Some(format!(
            "`{name}` is undefined at the current params and is not drawn"
        )),
        (all, undefined) if all == undefined => Some(format!(
            "`{name}` is undefined everywhere at the current params and is not drawn"
        )),
        (all, undefined) => Some(format!(
            "`{name}` is undefined at {undefined} of its {all} samples and has holes there"
        )),
    }
}

/// Evaluates the position of an object at all its samples, in f64 and in the scene's units; undefined positions are replaced
/// by their limits, if they exist.
pub fn positions(
    scene: &Scene,
    params: &ParamValues,
    object: &Object,
    position: &[NodeId; 3],
) -> Vec<[f64; 3]> {
    let tape = Tape::new(&scene.graph, position);
    let sampler = Sampler::new(scene, params, object, tape, Resolution::Full);
    let mut all = sampler.map(|_, out: &[f64; 3]| *out);
    if let Some(breaks) = Breaks::of(scene, params, object) {
        let domain = object.shape.domain();
        let size = object.shape.sample_count() as usize;
        let instances = all.par_chunks_mut(size).enumerate();
        instances.for_each(|(k, places)| {
            let uniforms = params.instance(scene, object, k as u64);
            let is_undefined = |index: usize| !places[index].iter().all(|x| x.is_finite());
            for (index, limit) in breaks.limits(domain, &uniforms, is_undefined) {
                places[index] = limit;
            }
        });
    }
    all
}

/// Samples as [`sample`] does, and adds notes for the reader of the picture.
pub fn sample_with_notes(
    scene: &Scene,
    params: &ParamValues,
    id: ObjectId,
    placement: &Placement,
) -> (Samples, Vec<String>) {
    let object = &scene.objects[id.index()];
    let name = &object.name;
    match &object.shape {
        Shape::Metric { .. } => (
            Samples::Points(Vec::new()),
            left_out(object).into_iter().collect(),
        ),
        Shape::Geodesic { .. } if lies_in_space(scene, id) => {
            let followed = follow_declared(scene, params, id);
            let samples = line_samples(placement, followed.count, &followed.lines);
            (samples, followed.notes)
        }
        _ => {
            let samples = sample(scene, params, id, placement);
            let mut notes: Vec<String> = samples.note(name).into_iter().collect();
            notes.extend(samples.undefined_geodesics(scene, params, object));
            (samples, notes)
        }
    }
}

/// Returns the note of a 3D picture on an object that it cannot show.
pub(crate) fn left_out(object: &Object) -> Option<String> {
    let name = &object.name;
    matches!(object.shape, Shape::Metric { .. }).then(|| {
        format!("`{name}` is a metric without an embedding: only its geodesic view can be drawn")
    })
}

/// Evaluates all samples of an object, on all cores.
pub fn sample(
    scene: &Scene,
    params: &ParamValues,
    object_id: ObjectId,
    placement: &Placement,
) -> Samples {
    let object = &scene.objects[object_id.index()];
    match &object.shape {
        Shape::Point { position } => {
            let sampler = Sampler::full(scene, params, object, position);
            Samples::Points(sampler.map(|_, out: &[f64; 3]| placed(placement, out)))
        }
        Shape::Vector { direction, origin } => {
            let [dx, dy, dz] = *direction;
            let [x, y, z] = *origin;
            let sampler = Sampler::full(scene, params, object, &[x, y, z, dx, dy, dz]);
            Samples::Vectors(sampler.map(|_, out: &[f64; 6]| {
                let [x, y, z, dx, dy, dz] = *out;
                vector(placement, [x, y, z], [dx, dy, dz])
            }))
        }
        Shape::Curve {
            position, domain, ..
        } => {
            let sampler = Sampler::full(scene, params, object, position);
            let mut samples = sampler.map(|_, out: &[f64; 3]| placed(placement, out));
            if let Some(breaks) = Breaks::of(scene, params, object) {
                let instances = samples.par_chunks_mut(domain.count as usize).enumerate();
                instances.for_each(|(k, samples)| {
                    let uniforms = params.instance(scene, object, k as u64);
                    let is_undefined = |index: usize| samples[index].defined == 0.0;
                    for (index, limit) in breaks.limits(&[*domain], &uniforms, is_undefined) {
                        samples[index] = placed(placement, &limit);
                    }
                    let found = breaks.find(&[*domain], &uniforms).unwrap_or_default();
                    for it in found.breaks {
                        break_behind(&mut samples[it.first[0] as usize].defined);
                    }
                    for [i, _] in found.poles {
                        samples[i as usize] = PositionSample::default();
                    }
                });
            }
            if !object.shape.followed().is_empty() {
                let instances = samples.par_chunks_mut(domain.count as usize).enumerate();
                instances.for_each(|(k, samples)| {
                    let uniforms = params.instance(scene, object, k as u64);
                    let places = samples.iter();
                    let places: Vec<Option<[f64; 3]>> = places
                        .map(|it| (it.defined != 0.0).then(|| it.position.map(f64::from)))
                        .collect();
                    for k in jumps_along_geodesics(scene, object, domain, &uniforms, &places) {
                        break_behind(&mut samples[k as usize].defined);
                    }
                });
            }
            Samples::Curves {
                count: domain.count,
                samples,
            }
        }
        Shape::Surface {
            position, domain, ..
        } => {
            let mut samples = surface::surface(scene, params, object, placement, position, domain);
            if let (Some(breaks), Samples::Surfaces { count, samples }) =
                (Breaks::of(scene, params, object), &mut samples)
            {
                let size = count[0] as usize * count[1] as usize;
                let instances = samples.par_chunks_mut(size).enumerate();
                instances.for_each(|(k, samples)| {
                    let uniforms = params.instance(scene, object, k as u64);
                    let is_undefined = |index: usize| samples[index].defined == 0.0;
                    let limits = breaks.limits(domain, &uniforms, is_undefined);
                    surface::fill_gaps(samples, *count, placement, &limits);
                    let found = breaks.find(domain, &uniforms).unwrap_or_default();
                    for it in found.breaks {
                        let [i, j] = it.first;
                        break_behind(&mut samples[(j * count[0] + i) as usize].defined);
                    }
                    for [i, j] in found.poles {
                        samples[(j * count[0] + i) as usize] = SurfaceSample::default();
                    }
                });
            }
            samples
        }
        Shape::Metric { .. }
        | Shape::Solid(_)
        | Shape::Light(_)
        | Shape::Camera(_)
        | Shape::Background(_) => Samples::Points(Vec::new()),
        Shape::Geodesic { .. } if !lies_in_space(scene, object_id) => Samples::Points(Vec::new()),
        Shape::Geodesic { .. } => {
            let FollowedGeodesic { count, lines, .. } = follow_declared(scene, params, object_id);
            line_samples(placement, count, &lines)
        }
    }
}

/// Marks a sample, if it is defined, as one after which the object breaks off.
fn break_behind(defined: &mut f32) {
    if *defined != 0.0 {
        *defined = LAST;
    }
}

/// Returns lines of `count` points each, as curves.
pub(crate) fn line_samples(
    placement: &Placement,
    count: u32,
    lines: &[Vec<Option<Knot>>],
) -> Samples {
    let knots = lines.iter().flatten();
    let sample = |knot: &Option<Knot>| {
        let position = knot.and_then(|knot| knot.position);
        position.map_or_else(PositionSample::default, |at| placed(placement, &at))
    };
    Samples::Curves {
        count,
        samples: knots.map(sample).collect(),
    }
}

/// Returns the roots of a surface's samples: σ, σu, σv, in a graph of their own. `None` if the derivatives are too large.
pub(crate) fn surface_roots(scene: &Scene, position: &[NodeId; 3]) -> Option<(Graph, [NodeId; 9])> {
    let (mut graph, roots) = scene.graph.extract(position);
    let du = graph.derivatives(&roots, Input::Variable(0)).ok()?;
    let dv = graph.derivatives(&roots, Input::Variable(1)).ok()?;
    let all: Vec<NodeId> = roots.iter().chain(&du).chain(&dv).copied().collect();
    Some((graph, <[NodeId; 9]>::try_from(all).ok()?))
}

pub(crate) fn placed(placement: &Placement, out: &[f64; 3]) -> PositionSample {
    let DrawingPoint(local) = placement.local(WorldPoint(*out));
    if local.iter().all(|x| x.abs() <= HORIZON) {
        PositionSample {
            position: local.map(|x| x as f32),
            defined: 1.0,
        }
    } else {
        PositionSample::default()
    }
}

pub(crate) fn vector(placement: &Placement, origin: [f64; 3], direction: [f64; 3]) -> VectorSample {
    let DrawingPoint(origin) = placement.local(WorldPoint(origin));
    let direction = direction.map(|x| x / placement.radius);
    if origin.iter().chain(&direction).all(|x| x.abs() <= HORIZON) {
        let [origin, direction] = [origin, direction].map(|a| a.map(|x| x as f32));
        VectorSample {
            origin,
            defined: 1.0,
            direction,
            padding: 0.0,
        }
    } else {
        VectorSample::default()
    }
}
