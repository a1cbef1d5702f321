//! The scene as data.

use expr::{Graph, NodeId};
use syntax::span::Span;

/// What a program declares, compiled.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Every expression of the scene.
    pub graph: Graph,
    /// The params, in the order of the text.
    pub params: Vec<Param>,
    /// The grids, in the order of the text.
    pub grids: Vec<Grid>,
    /// What is drawn, in the order of the text.
    pub objects: Vec<Object>,
    /// How many uniforms (components of params and grids) there are: `expr::Input::Uniform(0..n)`.
    pub uniform_count: u32,
}

impl Scene {
    /// What is drawn, each with its number.
    pub fn numbered(&self) -> impl Iterator<Item = (ObjectId, &Object)> {
        (0..).map(ObjectId).zip(&self.objects)
    }

    /// The object of a name.
    pub fn object(&self, name: &str) -> Option<(ObjectId, &Object)> {
        self.numbered().find(|(_, object)| object.name == name)
    }
}

/// A position in [`Scene::params`].
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct ParamId(pub u32);
/// A position in [`Scene::grids`].
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct GridId(pub u32);
/// A position in [`Scene::objects`].
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct ObjectId(pub u32);

/// A closed interval with finite ends, `min < max`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Range {
    pub min: f64,
    pub max: f64,
}

/// Equally spaced values over a closed interval, both ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// The interval.
    pub range: Range,
    /// How many values, at least 2.
    pub count: u32,
}

impl Sampling {
    /// The `index`-th value, counted from 0 and below `count`; the first is `min` and the last is `max`,
    /// exactly.
    pub fn value(&self, index: u32) -> f64 {
        let last = self.count - 1;
        if index == last {
            return self.range.max;
        }
        let Range { min, max } = self.range;
        let (index, last) = (f64::from(index), f64::from(last));
        // Multiplied before divided: the integers of [0, 100, 101] come out as integers.
        let offset = (max - min) * index / last;
        if offset.is_finite() {
            return (min + offset).min(max);
        }
        // The interval is wider than the largest number.
        min * (1.0 - index / last) + max * (index / last)
    }
}

/// A slider, or one per component.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Its name.
    pub name: String,
    /// Where the name stands.
    pub name_span: Span,
    /// One interval per component.
    pub ranges: Vec<Range>,
    /// The value that it opens with, one number per component, within its interval: the declared one, else the
    /// minimum.
    pub opening: Vec<f64>,
    /// Its first component is `expr::Input::Uniform(first_uniform)`, the others follow.
    pub first_uniform: u32,
}

/// Equally spaced values that instance what depends on them.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Its name.
    pub name: String,
    /// Where the name stands.
    pub name_span: Span,
    /// One axis per component; the grid's values are the product of its axes.
    pub axes: Vec<Sampling>,
    /// Its first component is `expr::Input::Uniform(first_uniform)`, the others follow.
    pub first_uniform: u32,
}

/// Something drawn.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its name.
    pub name: String,
    /// Where the name stands.
    pub name_span: Span,
    /// What it is.
    pub shape: Shape,
    /// The params it reads, directly or not, in order; its value need not change with each.
    pub params: Vec<ParamId>,
    /// The grids it reads, directly or not, in order; it is drawn once for each combination of their values.
    pub grids: Vec<GridId>,
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
    },
    Surface {
        position: [NodeId; 3],
        domain: [Sampling; 2],
        parameters: [String; 2],
    },
    /// A surface without a shape in space, given by its first fundamental form: it has a geodesic view, and
    /// the 3D view leaves it out. The domain's counts mean nothing.
    Metric {
        /// E, F and G, over `Variable(0)` and `Variable(1)` as a surface's position is.
        components: [NodeId; 3],
        domain: [Sampling; 2],
        parameters: [String; 2],
    },
    /// The curve γ(t) of unit speed with γ(0) = `start` and γ'(0) along a σu + b σv; a negative t lies behind
    /// its start. Its nodes read no `Variable`. [`crate::geodesic::Launcher`] evaluates them.
    Geodesic {
        /// The surface or metric that it lies on, declared above it. What that reads, this reads too, so an
        /// instance of the one determines the instance of the other.
        surface: ObjectId,
        /// (a, b); its length does not matter.
        direction: [NodeId; 2],
        /// (u, v), in the surface's parameters.
        start: [NodeId; 2],
        /// The arc lengths t that are drawn, and the number of samples.
        domain: Sampling,
        parameter: String,
    },
}

impl Shape {
    /// The domain of what has a geodesic view: a surface or a metric.
    pub fn patch(&self) -> Option<&[Sampling; 2]> {
        match self {
            Self::Surface { domain, .. } | Self::Metric { domain, .. } => Some(domain),
            Self::Point { .. }
            | Self::Vector { .. }
            | Self::Curve { .. }
            | Self::Geodesic { .. } => None,
        }
    }

    /// Its nodes: three for a position, or for E, F and G; for a vector the direction's three, then the
    /// origin's; for a geodesic the direction's two, then the start's.
    pub fn roots(&self) -> Vec<NodeId> {
        match self {
            Self::Point { position }
            | Self::Curve { position, .. }
            | Self::Surface { position, .. } => position.to_vec(),
            Self::Metric { components, .. } => components.to_vec(),
            Self::Vector { direction, origin } => [*direction, *origin].concat(),
            Self::Geodesic {
                direction, start, ..
            } => [*direction, *start].concat(),
        }
    }

    /// The same nodes, to be replaced.
    pub(crate) fn roots_mut(&mut self) -> impl Iterator<Item = &mut NodeId> {
        let (first, second): (&mut [NodeId], &mut [NodeId]) = match self {
            Self::Point { position }
            | Self::Curve { position, .. }
            | Self::Surface { position, .. } => (position, &mut []),
            Self::Metric { components, .. } => (components, &mut []),
            Self::Vector { direction, origin } => (direction, origin),
            Self::Geodesic {
                direction, start, ..
            } => (direction, start),
        };
        first.iter_mut().chain(second)
    }
}
