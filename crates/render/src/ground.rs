//! What a being can live in: a surface, or a metric without a shape in space, with the values of an instance.

use std::sync::Arc;

use geodesic::intrinsic::MetricSurface;
use geodesic::surface::{ParametricSurface, Surface};
use geodesic::topology::Apex;
use scene::{ObjectId, Scene, Shape};

use crate::geodesics::{Line, Polyline, Polylines};
use crate::request::RenderError;

/// A surface or a metric of a scene, ready for geodesics.
#[derive(Clone, Debug)]
pub struct Ground {
    kind: Kind,
    /// Shared by clones, which are the same surface.
    polylines: Arc<Polylines>,
}

#[derive(Clone, Debug)]
enum Kind {
    /// A surface in space.
    Surface(Box<ParametricSurface>),
    Metric(Box<MetricSurface>),
}

impl Ground {
    /// An object with the uniforms of one of its instances.
    ///
    /// # Errors
    /// [`RenderError::NoSurface`] for other kinds of object, [`RenderError::TooLarge`].
    pub fn new(scene: &Scene, object: ObjectId, uniforms: &[f64]) -> Result<Self, RenderError> {
        let Some(object) = scene.objects.get(object.0 as usize) else {
            return Err(RenderError::NoSurface { name: None });
        };
        let name = || object.name.clone();
        let too_large = |_| RenderError::TooLarge { name: name() };
        let graph = &scene.graph;
        let ranges = |domain: &[scene::Sampling; 2]| {
            domain
                .each_ref()
                .map(|axis| [axis.range.min, axis.range.max])
        };
        let kind = match &object.shape {
            Shape::Surface {
                position, domain, ..
            } => ParametricSurface::new(graph, *position, ranges(domain), uniforms)
                .map(|surface| Kind::Surface(Box::new(surface)))
                .map_err(too_large),
            Shape::Metric {
                components, domain, ..
            } => MetricSurface::new(graph, *components, ranges(domain), uniforms)
                .map(|metric| Kind::Metric(Box::new(metric)))
                .map_err(too_large),
            _ => Err(RenderError::NoSurface { name: Some(name()) }),
        };
        Ok(Self {
            kind: kind?,
            polylines: Arc::default(),
        })
    }

    /// What geodesics need of it.
    pub fn surface(&self) -> &dyn Surface {
        match &self.kind {
            Kind::Surface(surface) => surface.as_ref(),
            Kind::Metric(metric) => metric.as_ref(),
        }
    }

    /// Geodesics as points in the chart, followed on all cores where they have not been before.
    pub(crate) fn polylines(&self, lines: &[Line]) -> Vec<Polyline> {
        self.polylines.of(self.surface(), lines)
    }

    /// The sides that are one point: `[axis][end]`.
    pub fn apexes(&self) -> [[Option<Apex>; 2]; 2] {
        [0, 1].map(|axis| [0, 1].map(|end| self.surface().apex(axis, end)))
    }
}
