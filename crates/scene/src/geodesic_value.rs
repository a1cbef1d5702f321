//! Values of geodesics, which have no formula and are integrated.
//!
//! In: a program's definition of a geodesic, as nodes of a graph, and the numbers of the params. Out: a few numbers for
//! each value, which expressions read as ordinary inputs, or the reason why there are none.
//!
//! The results of integration are cached by the numbers on which they depend: a slider that moves one of two geodesics does
//! not affect the other.

use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use expr::tape::{Registers, Tape};
use expr::{Graph, Input, NodeId};
use geodesic::implicit::{ImplicitSurface, SpaceTraceError};
use geodesic::intrinsic::MetricSurface;
use geodesic::measure::{self, MeasureError};
use geodesic::surface::{ParametricSurface, Surface, affordable_evaluations};
use geodesic::trace::{Options, Status, trace};

use crate::initial_conditions::{InitialConditions, InitialConditionsError};
use crate::range::Range;

/// The maximum number of evaluations of the surface for one point of a geodesic: some 80 ms.
pub const MAX_VALUE_EVALUATIONS: u64 = 200_000;

/// The part of a surface or a metric on which its geodesics depend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ManifoldNodes {
    /// The position, or E, F and G, over `Variable(0)` and `Variable(1)`.
    pub components: [NodeId; 3],
    /// True if the components are those of a metric.
    pub is_metric: bool,
    /// The intervals of the two parameters.
    pub domain: [Range; 2],
}

/// The ground of a geodesic: the surface, metric or solid on which it runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ground {
    /// A surface or a metric.
    Chart(ManifoldNodes),
    /// A solid's surface: its field over `Variable(0)`, `Variable(1)` and `Variable(2)`.
    Solid(NodeId),
}

/// The kind of a geodesic's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ValueKind {
    /// The shortest geodesic between two points: its start, its velocity there, and its length, which equals the length of
    /// the velocity. Five numbers.
    Connection {
        /// (u, v) of the first point.
        from: [NodeId; 2],
        /// (u, v) of the second point.
        to: [NodeId; 2],
    },
    /// A point of a geodesic and its velocity there: (u, v) and (u', v'). Four numbers.
    Point {
        /// (u, v) at the geodesic's start.
        start: [NodeId; 2],
        /// Its direction there.
        direction: [NodeId; 2],
        /// The length of one unit of its parameter; 1 if `None`.
        unit: Option<NodeId>,
        /// The parameter.
        at: NodeId,
    },
    /// A point of a geodesic on a solid's surface and its velocity there: (x, y, z) and (x', y', z'). Six numbers.
    SpacePoint {
        /// (x, y, z) near the geodesic's start.
        start: [NodeId; 3],
        /// Its direction there.
        direction: [NodeId; 3],
        /// The parameter.
        at: NodeId,
    },
}

/// The maximum number of numbers of a value.
pub(crate) const MOST_NUMBERS: usize = 6;

/// A value of a geodesic.
#[derive(Clone, Debug)]
pub struct GeodesicValue {
    /// The geodesic's name.
    pub geodesic: Arc<str>,
    /// The surface, metric or solid on which it runs.
    pub ground: Ground,
    /// The value.
    pub kind: ValueKind,
    /// The index of the input for its first number; the others follow. A uniform, or along a curve a variable.
    pub first: u32,
}

/// The reason why a geodesic has no value. Its text is the end of a sentence about the geodesic.
#[derive(Clone, Debug, PartialEq)]
pub enum GeodesicFault {
    /// A number that it depends on is undefined.
    UndefinedInput,
    /// It cannot start.
    Start(InitialConditionsError),
    /// It cannot start on a solid's surface.
    SpaceStart(SpaceTraceError),
    /// One of its two endpoints is not on the surface.
    Place(MeasureError),
    /// No geodesic between the two points was found.
    NoConnection {
        /// (u, v) of the first point.
        from: [f64; 2],
        /// (u, v) of the second point.
        to: [f64; 2],
    },
    /// It ends before the parameter.
    Ends {
        /// The parameter at which it ends.
        end: f64,
        /// The given parameter.
        at: f64,
        /// The reason why it ends.
        status: Status,
    },
    /// It ends on a solid's surface before the parameter.
    EndsInSpace {
        /// The parameter at which it ends.
        end: f64,
        /// The given parameter.
        at: f64,
        /// The reason why it ends.
        status: Status,
    },
    /// The derivatives of the surface exceed the limit for expressions.
    TooLarge,
}

/// A cache of integrated values and their surfaces. Clones share it. It belongs to one graph.
#[derive(Clone, Debug, Default)]
pub struct GeodesicCache(Arc<Mutex<KeptValues>>);

#[derive(Default)]
struct KeptValues {
    surfaces: HashMap<ManifoldKey, Option<KeptGround>>,
    values: HashMap<ValueKey, Solution>,
    integrated: u64,
}

/// The ground for integration.
#[derive(Clone)]
enum KeptGround {
    Chart(Arc<dyn Surface + Send>, [Range; 2]),
    Solid(Arc<ImplicitSurface>),
}

/// A manifold with the numbers that it reads.
#[derive(Clone, Eq, Hash, PartialEq)]
struct ManifoldKey {
    is_metric: bool,
    /// Three for a surface or a metric, one for a solid.
    components: Vec<NodeId>,
    numbers: Vec<u64>,
}

/// A value with the numbers from which it is computed.
#[derive(Eq, Hash, PartialEq)]
struct ValueKey {
    manifold: ManifoldKey,
    width: u32,
    numbers: Vec<u64>,
}

/// The numbers of a value.
type Solution = Result<[f64; MOST_NUMBERS], GeodesicFault>;

/// The maximum number of cached surfaces, and of cached values.
const MOST_SURFACES: usize = 1 << 8;
const MOST_VALUES: usize = 1 << 16;

impl GeodesicValue {
    /// Returns the number of its numbers.
    pub fn width(&self) -> u32 {
        self.kind.width()
    }

    /// Returns the nodes from which it is computed. The nodes of its ground come first and read the variables of the
    /// ground.
    pub fn nodes(&self) -> Vec<NodeId> {
        let mut all = self.ground.nodes().to_vec();
        all.extend(self.kind.nodes());
        all
    }

    /// Returns the nodes of [`GeodesicValue::nodes`] for replacement.
    pub(crate) fn nodes_mut(&mut self) -> Vec<&mut NodeId> {
        let ground = match &mut self.ground {
            Ground::Chart(manifold) => manifold.components.as_mut_slice(),
            Ground::Solid(field) => std::slice::from_mut(field),
        };
        let mut all: Vec<&mut NodeId> = ground.iter_mut().collect();
        match &mut self.kind {
            ValueKind::Connection { from, to } => all.extend(from.iter_mut().chain(to)),
            ValueKind::Point {
                start,
                direction,
                unit,
                at,
            } => {
                all.extend(start.iter_mut().chain(direction).chain(unit));
                all.push(at);
            }
            ValueKind::SpacePoint {
                start,
                direction,
                at,
            } => {
                all.extend(start.iter_mut().chain(direction));
                all.push(at);
            }
        }
        all
    }

    /// Computes its [`GeodesicValue::width`] numbers.
    ///
    /// # Errors
    /// [`GeodesicFault`].
    pub fn solve(
        &self,
        graph: &Graph,
        uniforms: &[f64],
        variables: &[f64],
        cache: &GeodesicCache,
    ) -> Solution {
        let inputs = numbers(graph, &self.kind.nodes(), uniforms, variables);
        if inputs.iter().any(|x| !x.is_finite()) {
            return Err(GeodesicFault::UndefinedInput);
        }
        let on = self.ground.key(graph, uniforms);
        let key = ValueKey {
            manifold: on.clone(),
            width: self.width(),
            numbers: inputs.iter().map(|x| x.to_bits()).collect(),
        };
        if let Some(known) = cache.lock().values.get(&key) {
            return known.clone();
        }
        let solution = match self.ground.kept(graph, uniforms, on, cache) {
            Some(KeptGround::Chart(surface, domain)) => {
                self.kind.integrate(&*surface, &inputs, domain)
            }
            Some(KeptGround::Solid(surface)) => follow_in_space(&surface, &inputs),
            None => Err(GeodesicFault::TooLarge),
        };
        let mut known = cache.lock();
        known.integrated += 1;
        if known.values.len() >= MOST_VALUES {
            known.values.clear();
        }
        known.values.insert(key, solution.clone());
        solution
    }

    /// Computes its numbers and writes them to its inputs: NaN if there are none.
    pub(crate) fn fill(
        &self,
        graph: &Graph,
        uniforms: &mut [f64],
        cache: &GeodesicCache,
    ) -> Option<GeodesicFault> {
        let (numbers, fault) = match self.solve(graph, uniforms, &[], cache) {
            Ok(numbers) => (numbers, None),
            Err(fault) => ([f64::NAN; MOST_NUMBERS], Some(fault)),
        };
        let first = self.first as usize;
        let places = uniforms.iter_mut().skip(first).take(self.width() as usize);
        for (place, number) in places.zip(numbers) {
            *place = number;
        }
        fault
    }
}

impl ValueKind {
    /// Returns the number of numbers.
    pub(crate) fn width(&self) -> u32 {
        match self {
            Self::Connection { .. } => 5,
            Self::Point { .. } => 4,
            Self::SpacePoint { .. } => 6,
        }
    }

    fn nodes(&self) -> Vec<NodeId> {
        match *self {
            Self::Connection { from, to } => [from, to].concat(),
            Self::Point {
                start,
                direction,
                unit,
                at,
            } => [start, direction]
                .into_iter()
                .flatten()
                .chain(unit)
                .chain([at])
                .collect(),
            Self::SpacePoint {
                start,
                direction,
                at,
            } => [start, direction]
                .into_iter()
                .flatten()
                .chain([at])
                .collect(),
        }
    }

    /// Integrates with the numbers of [`ValueKind::nodes`].
    fn integrate(&self, surface: &dyn Surface, inputs: &[f64], domain: [Range; 2]) -> Solution {
        let [a, b, c, d, ref rest @ ..] = *inputs else {
            return Err(GeodesicFault::UndefinedInput);
        };
        match (self, rest) {
            (Self::Connection { .. }, _) => connect(surface, [a, b], [c, d]),
            (Self::Point { .. }, &[at]) => follow(surface, [a, b], [c, d], 1.0, at, domain),
            (Self::Point { .. }, &[unit, at]) => follow(surface, [a, b], [c, d], unit, at, domain),
            _ => Err(GeodesicFault::UndefinedInput),
        }
    }
}

/// Returns the start, the velocity and the length of the shortest geodesic between two points.
fn connect(surface: &dyn Surface, from: [f64; 2], to: [f64; 2]) -> Solution {
    if measure::is_one_place(surface, from, to) {
        return Ok([from[0], from[1], 0.0, 0.0, 0.0, 0.0]);
    }
    let found = measure::distance(surface, from, to).map_err(GeodesicFault::Place)?;
    let found = found.ok_or(GeodesicFault::NoConnection { from, to })?;
    let ([u, v], [a, b]) = (found.from.0, found.direction.0);
    let length = found.length;
    Ok([u, v, length * a, length * b, length, 0.0])
}

/// Returns a point of a geodesic and its velocity there.
fn follow(
    surface: &dyn Surface,
    start: [f64; 2],
    direction: [f64; 2],
    unit: f64,
    at: f64,
    domain: [Range; 2],
) -> Solution {
    if unit == 0.0 {
        return Ok([start[0], start[1], 0.0, 0.0, 0.0, 0.0]);
    }
    let initial = InitialConditions::new(start, direction, unit, domain);
    let initial = initial.map_err(GeodesicFault::Start)?;
    let (sign, length) = (at.signum(), at.abs() * unit);
    let direction = initial.direction.map(|x| sign * x);
    let options = Options {
        tolerance: TOLERANCE,
        max_evaluations: affordable_evaluations(surface, MAX_VALUE_EVALUATIONS) as usize,
        ..Options::default()
    };
    let end = trace(surface, initial.start, direction, length, &options)
        .map_err(|error| GeodesicFault::Place(error.into()))?;
    if end.status != Status::Complete {
        return Err(GeodesicFault::Ends {
            end: sign * end.length / unit,
            at,
            status: end.status,
        });
    }
    let ([u, v], [a, b]) = (end.uv.0, end.direction.0);
    let scale = sign * unit;
    Ok([u, v, scale * a, scale * b, 0.0, 0.0])
}

/// Returns a point of a geodesic on a solid's surface and its velocity there, given the start, the direction and the
/// parameter.
fn follow_in_space(surface: &ImplicitSurface, inputs: &[f64]) -> Solution {
    let [x, y, z, a, b, c, at] = *inputs else {
        return Err(GeodesicFault::UndefinedInput);
    };
    let (sign, length) = (at.signum(), at.abs());
    let direction = [a, b, c].map(|x| sign * x);
    let options = Options {
        tolerance: TOLERANCE,
        max_evaluations: MAX_VALUE_EVALUATIONS as usize,
        ..Options::default()
    };
    let end = surface.trace([x, y, z], direction, length, &options);
    let end = end.map_err(GeodesicFault::SpaceStart)?;
    if end.status != Status::Complete {
        return Err(GeodesicFault::EndsInSpace {
            end: sign * end.length,
            at,
            status: end.status,
        });
    }
    let ([x, y, z], [a, b, c]) = (end.position, end.direction.map(|x| sign * x));
    Ok([x, y, z, a, b, c])
}

/// The tolerance of a point: the same as for measures, because distances between such points are measured.
const TOLERANCE: f64 = 1e-12;

impl Ground {
    /// Returns its nodes.
    pub fn nodes(&self) -> &[NodeId] {
        match self {
            Self::Chart(manifold) => &manifold.components,
            Self::Solid(field) => std::slice::from_ref(field),
        }
    }

    /// Returns the key of its surface in the cache.
    fn key(&self, graph: &Graph, uniforms: &[f64]) -> ManifoldKey {
        let domain = match self {
            Self::Chart(manifold) => manifold.domain.as_slice(),
            Self::Solid(_) => &[],
        };
        let ends = domain.iter().flat_map(|axis| [axis.min, axis.max]);
        let read = graph.inputs(self.nodes());
        let read = read.iter().filter_map(|input| match *input {
            Input::Uniform(k) => uniforms.get(k as usize).copied(),
            Input::Variable(_) => None,
        });
        ManifoldKey {
            is_metric: matches!(self, Self::Chart(manifold) if manifold.is_metric),
            components: self.nodes().to_vec(),
            numbers: ends.chain(read).map(f64::to_bits).collect(),
        }
    }

    /// Returns the cached surface; `None` if its derivatives are too large.
    fn kept(
        &self,
        graph: &Graph,
        uniforms: &[f64],
        key: ManifoldKey,
        cache: &GeodesicCache,
    ) -> Option<KeptGround> {
        if let Some(known) = cache.lock().surfaces.get(&key) {
            return known.clone();
        }
        let made = match self {
            Self::Chart(manifold) => manifold
                .surface(graph, uniforms)
                .map(|surface| KeptGround::Chart(surface, manifold.domain)),
            Self::Solid(field) => ImplicitSurface::new(graph, *field, uniforms, None)
                .ok()
                .map(|surface| KeptGround::Solid(Arc::new(surface))),
        };
        let mut known = cache.lock();
        if known.surfaces.len() >= MOST_SURFACES {
            known.surfaces.clear();
        }
        known.surfaces.insert(key, made.clone());
        made
    }
}

impl ManifoldNodes {
    /// Returns the surface; `None` if its derivatives are too large.
    fn surface(&self, graph: &Graph, uniforms: &[f64]) -> Option<Arc<dyn Surface + Send>> {
        let domain = self.domain.map(|axis| [axis.min, axis.max]);
        match self.is_metric {
            true => match MetricSurface::new(graph, self.components, domain, uniforms) {
                Ok(metric) => Some(Arc::new(metric)),
                Err(_) => None,
            },
            false => match ParametricSurface::new(graph, self.components, domain, uniforms) {
                Ok(surface) => Some(Arc::new(surface)),
                Err(_) => None,
            },
        }
    }
}

impl GeodesicCache {
    /// Returns the number of values that were integrated rather than found in the cache.
    pub fn integrated(&self) -> u64 {
        self.lock().integrated
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, KeptValues> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Debug for KeptValues {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("KeptValues")
            .field("surfaces", &self.surfaces.len())
            .field("values", &self.values.len())
            .finish_non_exhaustive()
    }
}

impl fmt::Display for GeodesicFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UndefinedInput => write!(f, "a number that it depends on is undefined"),
            Self::Start(error) => write!(f, "{error}"),
            Self::SpaceStart(error) => write!(f, "{error}"),
            Self::Place(error) => write!(f, "{error}"),
            Self::NoConnection {
                from: [a, b],
                to: [c, d],
            } => write!(f, "no geodesic from ({a}, {b}) to ({c}, {d}) was found"),
            Self::Ends { end, at, status } => {
                let why = status.predicate();
                write!(f, "it ends at {end:.6}, before {at}: it {why}")
            }
            Self::EndsInSpace { end, at, status } => {
                let why = match status {
                    Status::LeftDomain => "it reaches an edge of the solid",
                    Status::Degenerate | Status::ConePoint => {
                        "the solid has no tangent plane there"
                    }
                    Status::Undefined => "the solid is undefined there",
                    Status::WorkLimit | Status::Complete => "it exceeds the limit of steps",
                };
                write!(f, "it ends at {end:.6}, before {at}: {why}")
            }
            Self::TooLarge => write!(f, "the derivatives of its surface are too large"),
        }
    }
}

impl std::error::Error for GeodesicFault {}

/// Returns the numbers of some nodes.
pub(crate) fn numbers(
    graph: &Graph,
    nodes: &[NodeId],
    uniforms: &[f64],
    variables: &[f64],
) -> Vec<f64> {
    let tape = Tape::new(graph, nodes);
    let inputs = tape.inputs().iter();
    let inputs: Vec<f64> = inputs.map(|it| it.value(variables, uniforms)).collect();
    let mut out = vec![f64::NAN; nodes.len()];
    tape.eval(&mut Registers::default(), &inputs, &mut out);
    out
}
