//! What a being can live in: a surface, or a metric without a shape in space, with the values of an instance.

use geodesic::intrinsic::MetricSurface;
use geodesic::surface::{ParametricSurface, Surface};
use geodesic::topology::Apex;
use scene::scene::{ObjectId, Scene, Shape};

use crate::request::RenderError;

/// A surface or a metric of a scene, ready for geodesics.
#[derive(Clone, Debug)]
pub enum Ground {
    /// A surface in space.
    Surface(Box<ParametricSurface>),
    /// A metric.
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
        let ranges = |domain: &[scene::scene::Sampling; 2]| {
            domain
                .each_ref()
                .map(|axis| [axis.range.min, axis.range.max])
        };
        match &object.shape {
            Shape::Surface {
                position, domain, ..
            } => ParametricSurface::new(graph, *position, ranges(domain), uniforms)
                .map(|surface| Self::Surface(Box::new(surface)))
                .map_err(too_large),
            Shape::Metric {
                components, domain, ..
            } => MetricSurface::new(graph, *components, ranges(domain), uniforms)
                .map(|metric| Self::Metric(Box::new(metric)))
                .map_err(too_large),
            _ => Err(RenderError::NoSurface { name: Some(name()) }),
        }
    }

    /// What geodesics need of it.
    pub fn surface(&self) -> &dyn Surface {
        match self {
            Self::Surface(surface) => surface.as_ref(),
            Self::Metric(metric) => metric.as_ref(),
        }
    }

    /// The sides that are one point: `[axis][end]`.
    pub fn apexes(&self) -> [[Option<Apex>; 2]; 2] {
        [0, 1].map(|axis| [0, 1].map(|end| self.surface().apex(axis, end)))
    }
}
