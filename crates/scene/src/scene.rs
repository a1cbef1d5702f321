//! The scene as data.

use std::collections::BTreeSet;
use std::sync::Arc;

use expr::{Graph, NodeId};
use syntax::span::Span;

use crate::geodesic_value::{GeodesicCache, GeodesicFault, GeodesicValue, MOST_NUMBERS};
pub use crate::ids::{GridId, ObjectId, ParamId};
pub use crate::range::{Range, Sampling};
use crate::rerun::Rerun;
use crate::solid::{Attribute, Background, Camera, Light, Solid, SolidLeaf, stated_word};
use crate::stated_picture::StatedPicture;

/// A compiled program.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Every expression of the scene.
    pub graph: Graph,
    /// The params, in the order of the text.
    pub params: Vec<Param>,
    /// The grids, in the order of the text.
    pub grids: Vec<Grid>,
    /// The drawn objects, in the order of the text.
    pub objects: Vec<Object>,
    /// The solids that are not drawn because a set names them, in the order of the text.
    pub parts: Vec<Object>,
    /// The lights, the cameras and the background, each in the order of the text.
    pub stage: Vec<Object>,
    /// The number of uniforms (components of params and grids, and numbers of geodesics):
    /// `expr::Input::Uniform(0..n)`.
    pub uniform_count: u32,
    /// The values of geodesics that expressions read, in the order of their uniforms. A value may read those before it.
    pub geodesic_values: Vec<GeodesicValue>,
    /// The values that have been computed.
    pub geodesic_cache: GeodesicCache,
    /// The picture that the text itself describes, if any. Such a scene has only its own lights.
    pub picture: Option<StatedPicture>,
    /// The scene for other values of the params, if params may change more than numbers.
    pub rerun: Option<Rerun<Scene>>,
}

impl Scene {
    /// Converts coordinates, or the components of a vector, from the scene to the text or back: y and z are exchanged if
    /// the text is left-handed.
    pub fn stated<T: Copy>(&self, [x, y, z]: [T; 3]) -> [T; 3] {
        match self.picture {
            Some(_) => [x, z, y],
            None => [x, y, z],
        }
    }

    /// Returns for each axis of the scene the corresponding axis of the text, from 0 to 2.
    pub fn stated_axes(&self) -> [usize; 3] {
        self.stated([0, 1, 2])
    }

    /// Returns the objects with their ids.
    pub fn numbered(&self) -> impl Iterator<Item = (ObjectId, &Object)> {
        (0..).map(ObjectId::new).zip(&self.objects)
    }

    /// Returns true if the object with this id is a solid.
    pub fn is_solid(&self, id: ObjectId) -> bool {
        let object = self.get(id);
        object.is_some_and(|object| object.shape.solid().is_some())
    }

    /// Returns the object with this id.
    pub fn get(&self, id: ObjectId) -> Option<&Object> {
        self.objects.get(id.index())
    }

    /// Returns true if the 3D view shows an object: all except metrics, and geodesics on a metric, are in space.
    pub fn is_in_space(&self, object: &Object) -> bool {
        match object.shape.geodesic() {
            Some((surface, _)) => self.get(surface).is_none_or(|on| !on.shape.is_metric()),
            None => !object.shape.is_metric(),
        }
    }

    /// Returns the geodesics on a surface, a metric or a solid.
    pub fn geodesics_on(&self, surface: ObjectId) -> impl Iterator<Item = (ObjectId, &Object)> {
        let name = self.get(surface).map(|on| &*on.name);
        let lies_on = move |object: &Object| match object.shape.space_geodesic() {
            Some((path, _)) => name == Some(path.solid),
            None => {
                let geodesic = object.shape.geodesic();
                geodesic.is_some_and(|(on, _)| on == surface)
            }
        };
        self.numbered().filter(move |(_, object)| lies_on(object))
    }

    /// Computes the values of geodesics that an object reads, and writes them into its uniforms.
    pub(crate) fn fill(&self, object: &Object, uniforms: &mut [f64]) {
        for &index in &object.geodesic_values {
            if let Some(value) = self.geodesic_values.get(index as usize) {
                value.fill(&self.graph, uniforms, &self.geodesic_cache);
            }
        }
    }

    /// Returns the geodesics that an object reads and that have no value for an instance of it, each with the reason.
    pub fn geodesic_faults(&self, object: &Object, uniforms: &[f64]) -> Vec<(&str, GeodesicFault)> {
        let mut uniforms = uniforms.to_vec();
        let read = object.geodesic_values.iter();
        let read = read.filter_map(|index| self.geodesic_values.get(*index as usize));
        let mut faults: Vec<(&str, GeodesicFault)> = Vec::new();
        for value in read {
            let fault = value.fill(&self.graph, &mut uniforms, &self.geodesic_cache);
            // The value that it requires has been reported.
            let fault = fault.filter(|fault| *fault != GeodesicFault::UndefinedInput);
            faults.extend(fault.map(|fault| (&*value.geodesic, fault)));
        }
        faults
    }

    /// Returns the variables of a curve at a parameter: the parameter, then the numbers of the geodesics that it follows, which
    /// are NaN if undefined.
    pub fn curve_variables(&self, shape: &Shape, uniforms: &[f64], parameter: f64) -> Vec<f64> {
        let mut variables = vec![parameter];
        for value in shape.followed() {
            let solved = value.solve(&self.graph, uniforms, &variables, &self.geodesic_cache);
            let numbers = solved.unwrap_or([f64::NAN; MOST_NUMBERS]);
            variables.extend_from_slice(&numbers[..value.width() as usize]);
        }
        variables
    }

    /// Returns the images that attributes name, as words or as paths, without duplicates, in alphabetical order.
    pub fn image_words(&self) -> BTreeSet<&str> {
        let objects = self.objects.iter().chain(&self.stage);
        let stated = objects.flat_map(|object| {
            let leaves = object.shape.solid().into_iter();
            let leaves = leaves.flat_map(|solid| &solid.leaves);
            std::iter::once(&object.attributes).chain(leaves.map(|leaf| &*leaf.attributes))
        });
        let words = stated.filter_map(|attributes| stated_word(attributes, "image"));
        words.collect()
    }

    /// Returns the background.
    pub fn background(&self) -> Option<&Object> {
        let mut stage = self.stage.iter();
        stage.find(|object| matches!(object.shape, Shape::Background(_)))
    }

    /// Returns the object with a name.
    pub fn object(&self, name: &str) -> Option<(ObjectId, &Object)> {
        self.objects_named(name).next()
    }

    /// The objects of a name: several of a script may share one.
    pub fn objects_named(&self, name: &str) -> impl Iterator<Item = (ObjectId, &Object)> {
        self.numbered()
            .filter(move |(_, object)| object.name == name)
    }

    /// The number that an object of this scene has in another one: the n-th object of a name is the n-th of that name there.
    pub fn number_in(&self, other: &Self, id: ObjectId) -> Option<ObjectId> {
        let name = &self.get(id)?.name;
        let mut own = self.objects_named(name);
        let place = own.position(|(known, _)| known == id)?;
        let (found, _) = other.objects_named(name).nth(place)?;
        Some(found)
    }
}

/// A slider, or one for each component.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Its name.
    pub name: String,
    /// The span of the name in the text.
    pub name_span: Span,
    /// One interval per component.
    pub ranges: Vec<Range>,
    /// The initial value, one number per component, within its interval: the declared one, or else the minimum.
    pub initial: Vec<f64>,
    /// The uniform `expr::Input::Uniform(first_uniform)` of its first component; the others follow.
    pub first_uniform: u32,
}

/// Equally spaced values; an object that depends on them has an instance for each.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Its name.
    pub name: String,
    /// The span of the name in the text.
    pub name_span: Span,
    /// One axis per component; the grid's values are the product of its axes.
    pub axes: Vec<Sampling>,
    /// The uniform `expr::Input::Uniform(first_uniform)` of its first component; the others follow.
    pub first_uniform: u32,
}

/// A drawn object.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its name.
    pub name: String,
    /// The span of the name in the text.
    pub name_span: Span,
    /// Its kind, with its expressions.
    pub shape: Shape,
    /// The params that it reads, directly or indirectly, in order; its value need not change with each.
    pub params: Vec<ParamId>,
    /// The grids that it reads, directly or indirectly, in order; it is drawn once for each combination of their
    /// values.
    pub grids: Vec<GridId>,
    /// The values of geodesics that it reads, directly or indirectly: indexes into [`Scene::geodesic_values`],
    /// ascending.
    pub geodesic_values: Vec<u32>,
    /// The attributes that it states, in the order of the text. A solid's faces have the attributes of its leaves.
    pub attributes: Vec<Attribute>,
}

impl Object {
    pub(crate) fn nodes_mut(&mut self) -> impl Iterator<Item = &mut NodeId> {
        let attributes = self.attributes.iter_mut().flat_map(Attribute::nodes_mut);
        self.shape.nodes_mut().into_iter().chain(attributes)
    }
}

/// The kinds of object. Nodes are handles into [`Scene::graph`], over the scene's uniforms and, for a curve,
/// a surface or a metric, `expr::Input::Variable(0)` (and `Variable(1)`).
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
