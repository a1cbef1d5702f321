//! Manifolds. In: an object of a scene and the values of its uniforms. Out: the surface or metric that geodesics run
//! on.
//!
//! Only this module turns a scene's surface or metric into a [`Surface`].

use std::fmt;
use std::sync::Arc;

use geodesic::intrinsic::MetricSurface;
use geodesic::surface::{ParametricSurface, Surface};
use geodesic::topology::Apex;
use scene::{ObjectId, ParamValues, Sampling, Scene};

use crate::polyline_cache::{ChartPolyline, GeodesicSegment, PolylineCache};

/// A surface or a metric of a scene, with the numbers of one instance substituted.
#[derive(Clone, Debug)]
pub struct Manifold {
    kind: ManifoldKind,
    /// Shared by clones, since they are the same manifold.
    polylines: Arc<PolylineCache>,
}

#[derive(Clone, Debug)]
enum ManifoldKind {
    /// A surface in space.
    Surface(Box<ParametricSurface>),
    /// A metric, which is not embedded in space.
    Metric(Box<MetricSurface>),
}

/// The reason why an object cannot be a [`Manifold`].
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum ManifoldError {
    /// The object is not a surface, metric or solid, or not of the required kind, or the scene does not contain it.
    NoSurface {
        /// The object's name, if it is in the scene.
        name: Option<String>,
    },
    /// The derivatives that geodesics need exceed the limit for expressions.
    TooLarge {
        /// The object's name.
        name: String,
    },
    /// A map of the solid is singular with these values of the params, so the solid has no boundary.
    Flat {
        /// The solid's name.
        name: String,
        /// The leaf to which the map belongs.
        leaf: String,
    },
    /// The solid contains no point with these values of the params.
    Empty {
        /// The solid's name.
        name: String,
    },
}

impl Manifold {
    /// Compiles the first instance of an object.
    ///
    /// # Errors
    /// See [`ManifoldError`].
    pub fn first(scene: &Scene, params: &ParamValues, id: ObjectId) -> Result<Self, ManifoldError> {
        let object = scene.get(id);
        let uniforms = object.map(|object| params.first_instance(scene, object));
        Self::new(scene, id, &uniforms.unwrap_or_default())
    }

    /// Compiles an object with the uniforms of one of its instances.
    ///
    /// # Errors
    /// See [`ManifoldError`].
    pub fn new(scene: &Scene, object: ObjectId, uniforms: &[f64]) -> Result<Self, ManifoldError> {
        let Some(object) = scene.get(object) else {
            return Err(ManifoldError::NoSurface { name: None });
        };
        let name = || object.name.clone();
        let too_large = |_| ManifoldError::TooLarge { name: name() };
        let graph = &scene.graph;
        let shape = &object.shape;
        let kind = if let Some((position, domain)) = shape.surface() {
            ParametricSurface::new(graph, *position, intervals(domain), uniforms)
                .map(|surface| ManifoldKind::Surface(Box::new(surface)))
                .map_err(too_large)
        } else if let Some((components, domain)) = shape.metric() {
            MetricSurface::new(graph, *components, intervals(domain), uniforms)
                .map(|metric| ManifoldKind::Metric(Box::new(metric)))
                .map_err(too_large)
        } else {
            Err(ManifoldError::NoSurface { name: Some(name()) })
        };
        Ok(Self {
            kind: kind?,
            polylines: Arc::default(),
        })
    }

    /// Returns the surface or metric that geodesics run on.
    pub fn surface(&self) -> &dyn Surface {
        match &self.kind {
            ManifoldKind::Surface(surface) => surface.as_ref(),
            ManifoldKind::Metric(metric) => metric.as_ref(),
        }
    }

    /// Follows geodesics to points of the chart, on all cores; those that were followed before come from a cache.
    pub fn polylines(&self, segments: &[GeodesicSegment]) -> Vec<ChartPolyline> {
        self.polylines.follow(self.surface(), segments)
    }

    /// Returns the sides that are one point: `[axis][end]`.
    pub fn apexes(&self) -> [[Option<Apex>; 2]; 2] {
        [0, 1].map(|axis| [0, 1].map(|end| self.surface().apex(axis, end)))
    }
}

/// Returns `[[u min, u max], [v min, v max]]`.
fn intervals(domain: &[Sampling; 2]) -> [[f64; 2]; 2] {
    domain
        .each_ref()
        .map(|axis| [axis.range.min, axis.range.max])
}

impl fmt::Display for ManifoldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSurface { name: Some(name) } => {
                write!(
                    f,
                    "`{name}` is not a surface, and only surfaces, metrics and solids have a geodesic view"
                )
            }
            Self::NoSurface { name: None } => write!(f, "there is no surface to see from inside"),
            Self::TooLarge { name } => write!(
                f,
                "the derivatives of `{name}` are too large, and its geodesics need them"
            ),
            Self::Flat { name, leaf } => {
                write!(
                    f,
                    "`{name}` has no surface: the map of `{leaf}` is singular"
                )
            }
            Self::Empty { name } => write!(f, "`{name}` has no surface: it contains no point"),
        }
    }
}

impl std::error::Error for ManifoldError {}
