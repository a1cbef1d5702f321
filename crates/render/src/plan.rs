//! The plan of a picture: everything that it needs, decided before anything is built.
//!
//! A view adds its needs to the [`Plan`] of a request ([`View::plan`](crate::view::View::plan)); `explain` prints the plan.
//! The GPU path builds exactly what the plan lists ([`Plan::built`]), and tests compare its counters with it: no surface, no
//! surface pipeline; no geodesic view, no resolve pass; no texture, no sampler.

use std::collections::BTreeSet;
use std::sync::Arc;

use expr::tape::Tape;
use expr::{Input, NodeId};
use geometry::Breaks;
use rayon::prelude::*;
use scene::ParamValues;
use scene::{Object, ObjectId, Scene};

pub use crate::sample::Painter;
use crate::sample::surface_roots;
use crate::texture::SurfaceImage;

/// The number of operations (samples × operations per sample) from which on a generated kernel fills an object's samples on
/// the GPU; below it, f64 blocks are ready before a driver has compiled anything.
pub const KERNEL_PAYS: u64 = 200_000_000;

/// The plan of one picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// True if the picture is planned for a GPU; otherwise [`Plan::built`] is empty.
    pub gpu: bool,
    /// The objects that are drawn in space; empty in a geodesic view.
    pub objects: Vec<ObjectPlan>,
    /// The geodesic view, if the picture is one.
    pub geodesic: Option<GeodesicPlan>,
    /// True if the pass on the GPU traces the picture.
    pub traced: bool,
    /// The painters of overlays in space, in addition to the objects' painters.
    pub overlays: &'static [Painter],
    /// Distinct images.
    pub textures: u32,
    /// The number of samplers of its images.
    pub samplers: u32,
    /// A sentence for each omission, with the reason.
    pub left_out: Vec<String>,
}

/// The plan of one object in space.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectPlan {
    /// The object.
    pub object: ObjectId,
    /// The painter that draws it.
    pub painter: Painter,
    /// The number of its instances.
    pub instances: u64,
    /// Samples of all instances.
    pub samples: u64,
    /// The source of its samples.
    pub source: SampleSource,
    /// The uniforms on which its samples depend.
    pub uniforms: Vec<u32>,
    /// Operations of its position (and direction) per sample.
    pub operations: u64,
    /// Operations of position and first derivatives per sample (for normals), with shared ones counted once; for surfaces
    /// only. Also `None` if the derivatives are too large; the surface is then drawn without normals.
    pub operations_with_normals: Option<u64>,
}

/// The plan of a geodesic view.
#[derive(Clone, Debug, PartialEq)]
pub struct GeodesicPlan {
    /// The surface.
    pub surface: ObjectId,
    /// True if its ends are a table of polynomials, which a fixed pass on the GPU colours; a map by pixel is coloured on the
    /// CPU.
    pub is_table: bool,
    /// Operations of the surface's derivatives up to order two, with shared ones counted once: the work on the surface for
    /// one evaluation of the geodesic equation. For a solid, those of the leaf that has the most. `None` if the derivatives
    /// are too large.
    pub derivative_operations: Option<u64>,
}

/// The source of an object's samples.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum SampleSource {
    /// f64 on the CPU.
    Blocks,
    /// Generated code on the GPU.
    Kernel,
}

/// Counts of what the GPU path builds for one picture.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Built {
    /// Pipelines that draw objects: one per painter in use.
    pub draw_pipelines: u32,
    /// Generated compute kernels that fill samples: one per object whose source is a kernel.
    pub sample_kernels: u32,
    /// Fixed passes that convert a table of geodesics' ends to colours.
    pub resolve_pipelines: u32,
    /// Passes that trace pictures, each with the functions of a scene.
    pub trace_pipelines: u32,
    /// Images.
    pub textures: u32,
    /// Samplers.
    pub samplers: u32,
}

/// Completes a plan after its view has added its needs: lists the omissions with their reasons.
pub(crate) fn complete(plan: &mut Plan) {
    if plan.textures == 0 {
        plan.left_out
            .push("no texture and no sampler: nothing in the picture has one".to_owned());
    }
    let is_geodesic = plan.geodesic.is_some();
    let painters = plan.painters();
    for (painter, kind) in [
        (Painter::Points, "point"),
        (Painter::Vectors, "vector"),
        (Painter::Curves, "curve"),
        (Painter::Surfaces, "surface"),
    ] {
        if !painters.contains(&painter) {
            let reason = if is_geodesic {
                "the picture is a geodesic view".to_owned()
            } else {
                format!("the scene has no {kind}")
            };
            plan.left_out.push(format!("no {kind} pipeline: {reason}"));
        }
    }
    if plan
        .objects
        .iter()
        .all(|object| object.source == SampleSource::Blocks)
    {
        let reason = if is_geodesic {
            "a geodesic view has no samples"
        } else {
            "the samples come from f64 blocks"
        };
        plan.left_out.push(format!("no sampling kernel: {reason}"));
    }
}

impl Plan {
    /// Creates an empty plan.
    pub(crate) fn new(gpu: bool) -> Self {
        Self {
            gpu,
            objects: Vec::new(),
            geodesic: None,
            traced: false,
            overlays: &[],
            textures: 0,
            samplers: 0,
            left_out: Vec::new(),
        }
    }

    /// Counts the distinct images of these objects, and their samplers.
    pub(crate) fn count_images(&mut self, images: &[SurfaceImage]) {
        let textures = images.iter().flat_map(|image| image.texture.instances());
        let textures: BTreeSet<_> = textures.map(Arc::as_ptr).collect();
        let samplers: BTreeSet<_> = images.iter().map(|image| image.repeats).collect();
        (self.textures, self.samplers) = (textures.len() as u32, samplers.len() as u32);
    }

    /// Returns the painters in use.
    pub fn painters(&self) -> BTreeSet<Painter> {
        let objects = self.objects.iter().map(|object| object.painter);
        objects.chain(self.overlays.iter().copied()).collect()
    }

    /// Returns the counts of everything that the GPU path builds.
    pub fn built(&self) -> Built {
        if !self.gpu {
            return Built::default();
        }
        let kernels = self
            .objects
            .iter()
            .filter(|object| object.source == SampleSource::Kernel)
            .count();
        let geodesic = self.geodesic.as_ref();
        // A map by pixel is coloured on the CPU, with its image.
        let textures = if geodesic.is_some_and(|view| !view.is_table) {
            0
        } else {
            self.textures
        };
        Built {
            draw_pipelines: self.painters().len() as u32,
            sample_kernels: kernels as u32,
            resolve_pipelines: u32::from(geodesic.is_some_and(|view| view.is_table)),
            trace_pipelines: u32::from(self.traced),
            textures,
            samplers: if textures > 0 { self.samplers } else { 0 },
        }
    }
}

/// Plans an object in space; `None` for an object that is not drawn there.
pub(crate) fn object_plan(
    scene: &Scene,
    params: &ParamValues,
    id: ObjectId,
    object: &Object,
    gpu: bool,
) -> Option<ObjectPlan> {
    let instances = params.instance_count(scene, object);
    let painter = Painter::for_object(scene, object)?;
    let roots = object.shape.roots();
    let operations = count(&scene.graph, &roots);
    let with_normals = operations_with_normals(scene, object);
    let samples = samples(scene, params, object);
    let work = samples.saturating_mul(with_normals.unwrap_or(operations).max(1));
    let inputs = scene.graph.inputs(&roots);
    let uniforms = inputs.into_iter().filter_map(|input| match input {
        Input::Uniform(k) => Some(k),
        Input::Variable(_) => None,
    });
    Some(ObjectPlan {
        object: id,
        painter,
        instances,
        samples,
        source: if gpu && work >= KERNEL_PAYS && may_have_kernel(scene, params, object) {
            SampleSource::Kernel
        } else {
            SampleSource::Blocks
        },
        uniforms: uniforms.collect(),
        operations,
        operations_with_normals: with_normals,
    })
}

/// Returns the number of samples of all instances of an object.
pub(crate) fn samples(scene: &Scene, params: &ParamValues, object: &Object) -> u64 {
    params
        .instance_count(scene, object)
        .saturating_mul(object.shape.sample_count())
}

/// Returns whether a kernel could give the samples of an object. A metric has no embedding, and what is followed has no
/// expression. Where an object breaks off is found by intervals.
pub(crate) fn may_have_kernel(scene: &Scene, params: &ParamValues, object: &Object) -> bool {
    let shape = &object.shape;
    !shape.is_metric() && !shape.is_followed() && !may_break(scene, params, object)
}

fn may_break(scene: &Scene, params: &ParamValues, object: &Object) -> bool {
    let Some(breaks) = Breaks::of(scene, params, object) else {
        return false;
    };
    let domain = object.shape.domain();
    let instances = (0..params.instance_count(scene, object)).into_par_iter();
    instances.any(|instance| breaks.may_occur(domain, &params.instance(scene, object, instance)))
}

/// Returns the operations of one sample of an object; for a surface, with its normal.
pub(crate) fn operations(scene: &Scene, object: &Object) -> u64 {
    operations_with_normals(scene, object)
        .unwrap_or_else(|| count(&scene.graph, &object.shape.roots()))
        .max(1)
}

/// Returns the operations of one sample of a surface with its normal; `None` for other objects, and if the derivatives are
/// too large.
fn operations_with_normals(scene: &Scene, object: &Object) -> Option<u64> {
    let (position, _) = object.shape.surface()?;
    let (graph, roots) = surface_roots(scene, position)?;
    Some(count(&graph, &roots))
}

/// Returns the operations of a surface's derivatives up to order two, of the derivatives of a metric that its geodesics need,
/// or of the derivatives up to order two of a solid's leaf, the one that has the most; `None` if they are too large.
pub(crate) fn derivative_operations(scene: &Scene, surface: ObjectId) -> Option<u64> {
    let shape = &scene.get(surface)?.shape;
    if let Some((components, _)) = shape.metric() {
        return form_operations(scene, components);
    }
    if let Some(solid) = shape.solid() {
        let fields: BTreeSet<NodeId> = solid.leaves.iter().map(|leaf| leaf.field).collect();
        let mut counts = fields.iter().map(|&field| field_operations(scene, field));
        return counts.try_fold(0, |most, count| Some(most.max(count?)));
    }
    let (position, _) = shape.surface()?;
    let (mut graph, roots) = surface_roots(scene, position)?;
    let (du, dv) = (&roots[3..6], &roots[6..9]);
    let mut all = roots[3..9].to_vec();
    for (first, by) in [(du, 0), (du, 1), (dv, 1)] {
        all.extend(graph.derivatives(first, Input::Variable(by)).ok()?);
    }
    Some(count(&graph, &all))
}

/// Returns the operations of E, F, G, their first derivatives, and the second derivatives that the curvature needs.
fn form_operations(scene: &Scene, components: &[NodeId; 3]) -> Option<u64> {
    let (mut graph, form) = scene.graph.extract(components);
    let (u, v) = (Input::Variable(0), Input::Variable(1));
    let by_u = graph.derivatives(&form, u).ok()?;
    let by_v = graph.derivatives(&form, v).ok()?;
    let mut all = [&form[..], &by_u, &by_v].concat();
    for (first, by) in [(by_v[0], v), (by_u[1], v), (by_u[2], u)] {
        all.extend(graph.derivatives(&[first], by).ok()?);
    }
    Some(count(&graph, &all))
}

/// Returns the operations of the gradient and the second derivatives of a leaf's field.
fn field_operations(scene: &Scene, field: NodeId) -> Option<u64> {
    let (mut graph, field) = scene.graph.extract(&[field]);
    let mut all = Vec::new();
    for k in 0..3 {
        let first = graph.derivatives(&field, Input::Variable(k)).ok()?;
        for by in k..3 {
            all.extend(graph.derivatives(&first, Input::Variable(by)).ok()?);
        }
        all.extend(first);
    }
    Some(count(&graph, &all))
}

fn count(graph: &expr::Graph, roots: &[NodeId]) -> u64 {
    Tape::new(graph, roots).operation_count() as u64
}
