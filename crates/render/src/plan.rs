//! What a picture needs, decided before anything is built.
//!
//! A scene, its settings and a request flow in; a [`Plan`] flows out, as data for `explain`. The GPU path builds
//! exactly what the plan says ([`Plan::built`]), and tests compare its counters with it: no surface, no surface
//! pipeline; no open geodesic view, no geodesic kernel; no texture, no sampler.

use std::collections::BTreeSet;
use std::sync::Arc;

use expr::tape::Tape;
use expr::{Input, NodeId};
use scene::ParamValues;
use scene::{Object, ObjectId, Scene, Shape};

use crate::overlay;
use crate::request::{Backend, Request, View};
use crate::sample::surface_roots;

/// From this many operations (samples × operations per sample) on, a generated kernel fills an object's samples on
/// the GPU; below, f64 blocks are ready before a driver has compiled anything.
pub const KERNEL_PAYS: u64 = 200_000_000;

/// What one picture needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Whether the picture is planned for a GPU; otherwise nothing of [`Plan::built`] is.
    pub gpu: bool,
    /// What is drawn in space; empty in a geodesic view.
    pub objects: Vec<ObjectPlan>,
    /// The geodesic view, if that is the picture.
    pub geodesic: Option<GeodesicPlan>,
    /// What draws overlays in space, beside the objects' painters.
    pub overlays: &'static [Painter],
    /// Distinct images.
    pub textures: u32,
    /// Why the rest is not there: a sentence for each thing left out.
    pub left_out: Vec<String>,
}

/// How one object is drawn in space.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectPlan {
    /// The object.
    pub object: ObjectId,
    /// What draws it.
    pub painter: Painter,
    /// How many instances of it there are.
    pub instances: u64,
    /// Samples of all instances.
    pub samples: u64,
    /// Where its samples come from.
    pub source: Source,
    /// The uniforms that its samples depend on.
    pub uniforms: Vec<u32>,
    /// Operations of its position (and direction) per sample.
    pub operations: u64,
    /// Operations of position and first derivatives per sample (for normals), shared ones once: surfaces only;
    /// `None` also if the derivatives explode, and the surface is drawn without normals.
    pub operations_with_normals: Option<u64>,
}

/// What a geodesic view needs.
#[derive(Clone, Debug, PartialEq)]
pub struct GeodesicPlan {
    /// The surface.
    pub surface: ObjectId,
    /// Whether its ends are a table of polynomials, which a fixed pass on the GPU colours; a map pixel by pixel is
    /// coloured on the CPU.
    pub is_table: bool,
    /// Operations of the surface's derivatives up to order two, shared ones once: what one evaluation of the
    /// geodesic equation computes of the surface. `None` if they explode.
    pub derivative_operations: Option<u64>,
}

/// The painters: one per kind of object.
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
}

/// Where numbers come from.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Source {
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
    /// Fixed passes that turn a table of geodesics' ends into colours.
    pub resolve_pipelines: u32,
    /// Images.
    pub textures: u32,
    /// Samplers.
    pub samplers: u32,
}

/// Plans a picture; the request has been checked.
pub fn plan(scene: &Scene, settings: &ParamValues, request: &Request) -> Plan {
    let gpu = request.backend != Backend::Software;
    let mut plan = Plan {
        gpu,
        objects: Vec::new(),
        geodesic: None,
        overlays: &[],
        textures: 0,
        left_out: Vec::new(),
    };
    let mut textured = Vec::new();
    match &request.view {
        View::Space { .. } => {
            plan.overlays = overlay::painters(scene, request);
            for (index, object) in scene.objects.iter().enumerate() {
                let id = ObjectId(index as u32);
                if !request.shows(id) {
                    continue;
                }
                if matches!(object.shape, Shape::Surface { .. }) {
                    textured.push(id);
                }
                plan.objects
                    .extend(object_plan(scene, settings, id, object, gpu));
            }
            plan.left_out.push(
                "no geodesic kernel and no resolve pass: the picture is the 3D view".to_owned(),
            );
        }
        View::Geodesic {
            surface, method, ..
        } => {
            textured.push(*surface);
            plan.geodesic = Some(GeodesicPlan {
                surface: *surface,
                is_table: method.is_fan(),
                derivative_operations: derivative_operations(scene, *surface),
            });
        }
    }
    let images: BTreeSet<_> = textured
        .iter()
        .map(|&id| Arc::as_ptr(&request.texture(id)))
        .collect();
    plan.textures = images.len() as u32;
    if plan.textures == 0 {
        plan.left_out
            .push("no texture and no sampler: nothing in the picture has one".to_owned());
    }
    let inside = plan.geodesic.is_some();
    let painters = plan.painters();
    for (painter, kind) in [
        (Painter::Points, "point"),
        (Painter::Vectors, "vector"),
        (Painter::Curves, "curve"),
        (Painter::Surfaces, "surface"),
    ] {
        if !painters.contains(&painter) {
            let reason = if inside {
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
        .all(|object| object.source == Source::Blocks)
    {
        let reason = if inside {
            "a geodesic view has no samples"
        } else {
            "the samples come from f64 blocks"
        };
        plan.left_out.push(format!("no sampling kernel: {reason}"));
    }
    if inside {
        plan.left_out
            .push("no geodesic kernel: the geodesics are followed in f64".to_owned());
    }
    plan
}

impl Plan {
    /// The painters in use.
    pub fn painters(&self) -> BTreeSet<Painter> {
        let objects = self.objects.iter().map(|object| object.painter);
        objects.chain(self.overlays.iter().copied()).collect()
    }

    /// What the GPU path builds.
    pub fn built(&self) -> Built {
        if !self.gpu {
            return Built::default();
        }
        let kernels = self
            .objects
            .iter()
            .filter(|object| object.source == Source::Kernel)
            .count();
        let geodesic = self.geodesic.as_ref();
        // A map pixel by pixel is coloured on the CPU, with its image.
        let textures = if geodesic.is_some_and(|view| !view.is_table) {
            0
        } else {
            self.textures
        };
        Built {
            draw_pipelines: self.painters().len() as u32,
            sample_kernels: kernels as u32,
            resolve_pipelines: u32::from(geodesic.is_some_and(|view| view.is_table)),
            textures,
            samplers: u32::from(textures > 0),
        }
    }
}

fn object_plan(
    scene: &Scene,
    settings: &ParamValues,
    id: ObjectId,
    object: &Object,
    gpu: bool,
) -> Option<ObjectPlan> {
    let instances = settings.instance_count(scene, object);
    let (painter, roots, per_instance) = match &object.shape {
        Shape::Point { position } => (Painter::Points, position.to_vec(), 1),
        Shape::Vector { direction, origin } => {
            (Painter::Vectors, [*origin, *direction].concat(), 1)
        }
        Shape::Curve {
            position, domain, ..
        } => (Painter::Curves, position.to_vec(), u64::from(domain.count)),
        Shape::Surface {
            position, domain, ..
        } => (
            Painter::Surfaces,
            position.to_vec(),
            u64::from(domain[0].count) * u64::from(domain[1].count),
        ),
        Shape::Geodesic {
            direction,
            start,
            domain,
            ..
        } if geometry::lies_in_space(scene, id) => (
            Painter::Curves,
            [*direction, *start].concat(),
            u64::from(domain.count),
        ),
        // Neither has samples in space.
        Shape::Metric { .. } | Shape::Geodesic { .. } => return None,
    };
    let operations = count(&scene.graph, &roots);
    let with_normals = match &object.shape {
        Shape::Surface { position, .. } => {
            surface_roots(scene, position).map(|(graph, roots)| count(&graph, &roots))
        }
        _ => None,
    };
    // A geodesic has no expression: it is followed in f64.
    let followed = matches!(object.shape, Shape::Geodesic { .. });
    let samples = instances.saturating_mul(per_instance);
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
        source: if gpu && work >= KERNEL_PAYS && !followed {
            Source::Kernel
        } else {
            Source::Blocks
        },
        uniforms: uniforms.collect(),
        operations,
        operations_with_normals: with_normals,
    })
}

/// Samples of all instances of an object in space.
pub(crate) fn samples(scene: &Scene, settings: &ParamValues, id: ObjectId) -> u64 {
    let Some(object) = scene.objects.get(id.0 as usize) else {
        return 0;
    };
    let per_instance = match &object.shape {
        Shape::Point { .. } | Shape::Vector { .. } => 1,
        Shape::Curve { domain, .. } => u64::from(domain.count),
        Shape::Surface { domain, .. } => u64::from(domain[0].count) * u64::from(domain[1].count),
        // A geodesic has no expression: it is followed in f64.
        Shape::Metric { .. } | Shape::Geodesic { .. } => 0,
    };
    settings
        .instance_count(scene, object)
        .saturating_mul(per_instance)
}

/// Operations of one sample of an object, of a surface with its normal.
pub(crate) fn operations(scene: &Scene, id: ObjectId) -> u64 {
    let Some(object) = scene.objects.get(id.0 as usize) else {
        return 0;
    };
    let with_normal = match &object.shape {
        Shape::Surface { position, .. } => {
            surface_roots(scene, position).map(|(graph, roots)| count(&graph, &roots))
        }
        _ => None,
    };
    with_normal
        .unwrap_or_else(|| count(&scene.graph, &object.shape.roots()))
        .max(1)
}

fn derivative_operations(scene: &Scene, surface: ObjectId) -> Option<u64> {
    let position = match &scene.objects.get(surface.0 as usize)?.shape {
        Shape::Surface { position, .. } => position,
        Shape::Metric { components, .. } => return form_operations(scene, components),
        _ => return None,
    };
    let (mut graph, roots) = surface_roots(scene, position)?;
    let (du, dv) = (&roots[3..6], &roots[6..9]);
    let mut all = roots[3..9].to_vec();
    for (first, by) in [(du, 0), (du, 1), (dv, 1)] {
        all.extend(graph.derivatives(first, Input::Variable(by)).ok()?);
    }
    Some(count(&graph, &all))
}

/// Operations of E, F, G, their first derivatives, and the second ones that the curvature takes.
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

fn count(graph: &expr::Graph, roots: &[NodeId]) -> u64 {
    Tape::new(graph, roots).operation_count() as u64
}
