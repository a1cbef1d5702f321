//! The shapes of objects, and the paths of geodesics: their expressions, and what they have in common.

use std::sync::Arc;

use expr::NodeId;

use crate::geodesic_value::GeodesicValue;
use crate::ids::ObjectId;
use crate::range::Sampling;
use crate::solid::{Background, Camera, Light, Solid, SolidLeaf};
/// The kinds of object. Nodes are handles into the graph of the [`Scene`](super::Scene), over the scene's uniforms and, for
/// a curve, a surface or a metric, `expr::Input::Variable(0)` (and `Variable(1)`).
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub enum Shape {
    Point {
        position: [NodeId; 3],
    },
    Vector {
        direction: [NodeId; 3],
        origin: [NodeId; 3],
    },
    Curve {
        position: [NodeId; 3],
        domain: Sampling,
        parameter: String,
        /// The values of geodesics at its parameter, whose numbers are the variables after the parameter. A value may read
        /// those before it.
        followed: Vec<GeodesicValue>,
    },
    Surface {
        position: [NodeId; 3],
        domain: [Sampling; 2],
        parameters: [String; 2],
    },
    /// A surface without a shape in space, given by its first fundamental form: it has a geodesic view, and is omitted
    /// from the 3D view. The domain's counts have no meaning.
    Metric {
        /// E, F and G, over `Variable(0)` and `Variable(1)` like a surface's position.
        components: [NodeId; 3],
        domain: [Sampling; 2],
        parameters: [String; 2],
    },
    /// The curve γ(t) of constant speed with γ(0) = `start` and γ'(0) along a σu + b σv; a negative t is before its
    /// start. Its nodes read no `Variable`. [`crate::InitialConditionsEvaluator`] evaluates them.
    Geodesic {
        /// Its ground, its start and its direction.
        path: GeodesicPath,
        /// The drawn interval of t, and the number of samples.
        domain: Sampling,
        parameter: String,
    },
    /// A solid. Its nodes read `Variable(0)`, `Variable(1)` and `Variable(2)`: x, y, z.
    Solid(Arc<Solid>),
    /// A light.
    Light(Light),
    /// A camera.
    Camera(Camera),
    /// The background.
    Background(Background),
}

/// The start of a geodesic on its ground.
#[derive(Clone, Debug)]
pub enum GeodesicPath {
    /// On a surface or a metric.
    Chart {
        /// Its surface or metric, declared above it. The geodesic reads everything that the surface reads, so an
        /// instance of the geodesic determines the instance of the surface.
        surface: ObjectId,
        /// (a, b); its length does not matter.
        direction: [NodeId; 2],
        /// (u, v), in the surface's parameters.
        start: [NodeId; 2],
        /// Its speed, the length of one unit of t: the distance, for a geodesic between two points; 1 if `None`.
        unit: Option<NodeId>,
    },
    /// On the surface of a solid.
    Space {
        /// The solid's name.
        solid: Arc<str>,
        /// The solid's field, over `Variable(0)`, `Variable(1)` and `Variable(2)`.
        field: NodeId,
        /// (a, b, c); it is projected onto the tangent plane.
        direction: [NodeId; 3],
        /// (x, y, z), which is projected onto the surface.
        start: [NodeId; 3],
    },
}

/// The nodes of a geodesic on a solid.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)]
pub struct SpacePath<'a> {
    pub solid: &'a str,
    pub field: NodeId,
    pub direction: [NodeId; 3],
    pub start: [NodeId; 3],
}

impl GeodesicPath {
    fn nodes_mut(&mut self) -> Vec<&mut NodeId> {
        match self {
            Self::Chart {
                direction,
                start,
                unit,
                ..
            } => direction.iter_mut().chain(start).chain(unit).collect(),
            Self::Space {
                field,
                direction,
                start,
                ..
            } => {
                let mut all = vec![field];
                all.extend(direction.iter_mut().chain(start));
                all
            }
        }
    }
}

impl Shape {
    /// Returns the keyword that declares it: `point`, `vector`, `curve`, `surface`, `metric`, `geodesic`, `solid`,
    /// `light`, `camera` or `background`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Point { .. } => "point",
            Self::Vector { .. } => "vector",
            Self::Curve { .. } => "curve",
            Self::Surface { .. } => "surface",
            Self::Metric { .. } => "metric",
            Self::Geodesic { .. } => "geodesic",
            Self::Solid(_) => "solid",
            Self::Light(_) => "light",
            Self::Camera(_) => "camera",
            Self::Background(_) => "background",
        }
    }

    /// Returns true if it is a point.
    pub fn is_point(&self) -> bool {
        matches!(self, Self::Point { .. })
    }

    /// Returns true if it is a surface in space.
    pub fn is_surface(&self) -> bool {
        matches!(self, Self::Surface { .. })
    }

    /// Returns true if it is a metric, which has no shape in space.
    pub fn is_metric(&self) -> bool {
        matches!(self, Self::Metric { .. })
    }

    /// Returns true if it is a geodesic, whose points are integrated and have no expression.
    pub fn is_geodesic(&self) -> bool {
        matches!(self, Self::Geodesic { .. })
    }

    /// Returns the sampled intervals of its parameters: none for a point or a vector, one for a curve or a geodesic,
    /// two for a surface or a metric.
    pub fn domain(&self) -> &[Sampling] {
        match self {
            Self::Point { .. }
            | Self::Vector { .. }
            | Self::Solid(_)
            | Self::Light(_)
            | Self::Camera(_)
            | Self::Background(_) => &[],
            Self::Curve { domain, .. } | Self::Geodesic { domain, .. } => {
                std::slice::from_ref(domain)
            }
            Self::Surface { domain, .. } | Self::Metric { domain, .. } => domain,
        }
    }

    /// Returns the names of its parameters in the form of a point: "(u, v)".
    pub fn chart_label(&self) -> String {
        format!("({})", self.parameters().join(", "))
    }

    /// Returns the names of its parameters, one for each interval of [`Shape::domain`].
    pub fn parameters(&self) -> &[String] {
        match self {
            Self::Point { .. }
            | Self::Vector { .. }
            | Self::Solid(_)
            | Self::Light(_)
            | Self::Camera(_)
            | Self::Background(_) => &[],
            Self::Curve { parameter, .. } | Self::Geodesic { parameter, .. } => {
                std::slice::from_ref(parameter)
            }
            Self::Surface { parameters, .. } | Self::Metric { parameters, .. } => parameters,
        }
    }

    /// Returns the domain of a manifold (a surface or a metric), which has a geodesic view.
    pub fn manifold(&self) -> Option<&[Sampling; 2]> {
        match self {
            Self::Surface { domain, .. } | Self::Metric { domain, .. } => Some(domain),
            _ => None,
        }
    }

    /// Returns the position and the domain of a surface in space.
    pub fn surface(&self) -> Option<(&[NodeId; 3], &[Sampling; 2])> {
        match self {
            Self::Surface {
                position, domain, ..
            } => Some((position, domain)),
            _ => None,
        }
    }

    /// Returns the first fundamental form (E, F, G) and the domain of a metric.
    pub fn metric(&self) -> Option<(&[NodeId; 3], &[Sampling; 2])> {
        match self {
            Self::Metric {
                components, domain, ..
            } => Some((components, domain)),
            _ => None,
        }
    }

    /// Returns the surface or metric on which a geodesic runs, and the drawn arc lengths; `None` for a geodesic on a
    /// solid.
    pub fn geodesic(&self) -> Option<(ObjectId, &Sampling)> {
        match self {
            Self::Geodesic {
                path: GeodesicPath::Chart { surface, .. },
                domain,
                ..
            } => Some((*surface, domain)),
            _ => None,
        }
    }

    /// Returns the drawn arc lengths of a geodesic on any ground.
    pub fn arc_lengths(&self) -> Option<&Sampling> {
        match self {
            Self::Geodesic { domain, .. } => Some(domain),
            _ => None,
        }
    }

    /// Returns the path of a geodesic on a solid, and the drawn arc lengths.
    pub fn space_geodesic(&self) -> Option<(SpacePath<'_>, &Sampling)> {
        match self {
            Self::Geodesic {
                path:
                    GeodesicPath::Space {
                        solid,
                        field,
                        direction,
                        start,
                    },
                domain,
                ..
            } => {
                let path = SpacePath {
                    solid,
                    field: *field,
                    direction: *direction,
                    start: *start,
                };
                Some((path, domain))
            }
            _ => None,
        }
    }

    /// Returns true if it has a geodesic view: a surface, a metric or a solid.
    pub fn has_inside(&self) -> bool {
        self.manifold().is_some() || self.solid().is_some()
    }

    /// Returns the direction and the start of a geodesic on a surface or a metric, and its speed if that is not 1.
    pub fn initial_conditions(&self) -> Option<(&[NodeId; 2], &[NodeId; 2], Option<NodeId>)> {
        match self {
            Self::Geodesic {
                path:
                    GeodesicPath::Chart {
                        direction,
                        start,
                        unit,
                        ..
                    },
                ..
            } => Some((direction, start, *unit)),
            _ => None,
        }
    }

    /// Returns the values of geodesics that a curve follows at its parameter.
    pub fn followed(&self) -> &[GeodesicValue] {
        match self {
            Self::Curve { followed, .. } => followed,
            _ => &[],
        }
    }

    /// Returns true for a geodesic and for a curve along one: their points have no expression and are integrated.
    pub fn is_followed(&self) -> bool {
        self.is_geodesic() || !self.followed().is_empty()
    }

    /// Returns the position of a point, or of a curve or surface over its parameters.
    pub fn position(&self) -> Option<&[NodeId; 3]> {
        match self {
            Self::Point { position }
            | Self::Curve { position, .. }
            | Self::Surface { position, .. } => Some(position),
            _ => None,
        }
    }

    /// Returns the direction and the origin of a vector.
    pub fn vector(&self) -> Option<(&[NodeId; 3], &[NodeId; 3])> {
        match self {
            Self::Vector { direction, origin } => Some((direction, origin)),
            _ => None,
        }
    }

    /// Returns the number of samples of one instance along each parameter, 1 for a parameter that it does not have. A metric is
    /// not sampled in space and counts as one sample.
    pub fn sample_counts(&self) -> [u32; 2] {
        match self {
            Self::Metric { .. } => [1; 2],
            _ => match self.domain() {
                [] => [1; 2],
                [only] => [only.count, 1],
                [first, second, ..] => [first.count, second.count],
            },
        }
    }

    /// Returns the number of samples of one instance: the product of [`Shape::sample_counts`].
    pub fn sample_count(&self) -> u64 {
        self.sample_counts().into_iter().map(u64::from).product()
    }

    /// Returns its nodes: three for a position, or for E, F and G; for a vector the direction's three, then the origin's;
    /// for a geodesic the direction's two, then the start's, then its speed's if it has one; on a solid the field, then the
    /// direction's three and the start's.
    pub fn roots(&self) -> Vec<NodeId> {
        match self {
            Self::Point { position }
            | Self::Curve { position, .. }
            | Self::Surface { position, .. } => position.to_vec(),
            Self::Metric { components, .. } => components.to_vec(),
            Self::Vector { direction, origin } => [*direction, *origin].concat(),
            Self::Geodesic { .. }
            | Self::Solid(_)
            | Self::Light(_)
            | Self::Camera(_)
            | Self::Background(_) => self
                .clone()
                .nodes_mut()
                .into_iter()
                .map(|node| *node)
                .collect(),
        }
    }

    /// Returns the nodes of [`Shape::roots`] and of [`Shape::followed`] for replacement.
    pub(crate) fn nodes_mut(&mut self) -> Vec<&mut NodeId> {
        match self {
            Self::Point { position } | Self::Surface { position, .. } => {
                position.iter_mut().collect()
            }
            Self::Curve {
                position, followed, ..
            } => {
                let followed = followed.iter_mut().flat_map(GeodesicValue::nodes_mut);
                position.iter_mut().chain(followed).collect()
            }
            Self::Metric { components, .. } => components.iter_mut().collect(),
            Self::Vector { direction, origin } => direction.iter_mut().chain(origin).collect(),
            Self::Geodesic { path, .. } => path.nodes_mut(),
            Self::Solid(solid) => {
                let leaves = Arc::make_mut(solid).leaves.iter_mut();
                leaves.flat_map(SolidLeaf::nodes_mut).collect()
            }
            Self::Light(light) => {
                let parts = light.direction.iter_mut().chain(&mut light.position);
                parts.flatten().collect()
            }
            Self::Camera(camera) => camera
                .direction
                .iter_mut()
                .chain(&mut camera.position)
                .collect(),
            Self::Background(background) => background.colour.iter_mut().collect(),
        }
    }

    /// Returns a solid's set.
    pub fn solid(&self) -> Option<&Solid> {
        match self {
            Self::Solid(solid) => Some(solid),
            _ => None,
        }
    }
}
