//! Geodesics as functions: nodes for numbers that have no formula.
//!
//! In: the application of a geodesic to a node. Out: nodes for its point and its velocity there. If the argument depends only
//! on constants, params and grids, they are uniforms like those of params, and the value is one of the scene's. Inside the
//! body of a function, and along a curve, the argument depends on parameters: the nodes are then *pending* variables beyond
//! those of any parameter list. Substitution replaces them when the argument is known, and differentiation knows their
//! derivatives: since g″ = −Γ(g′, g′), every derivative is an expression in g and g′.

use std::collections::BTreeSet;
use std::sync::Arc;

use expr::{Graph, Input, NodeId, TooLarge};
use rustc_hash::FxHashMap;

use crate::geodesic_value::{
    GeodesicCache, GeodesicFault, GeodesicValue, Ground, MOST_NUMBERS, ManifoldNodes, ValueKind,
};
use crate::geotrace::dependencies::{Dependencies, DependencySets};
use crate::geotrace::geodesic_equation::{geodesic_equation, space_geodesic_equation};
use crate::scene::Shape;

/// A declared geodesic.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DeclaredGeodesic {
    pub(crate) name: Arc<str>,
    pub(crate) way: DeclaredWay,
    /// The params and grids that it reads, including those of its surface.
    pub(crate) dependencies: Dependencies,
}

/// The ground of a declared geodesic, and its start there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum DeclaredWay {
    /// On a surface or a metric.
    Chart {
        manifold: ManifoldNodes,
        start: [NodeId; 2],
        direction: [NodeId; 2],
        /// The length of one unit of its parameter; 1 if `None`.
        unit: Option<NodeId>,
    },
    /// On a solid with this field.
    Space {
        field: NodeId,
        start: [NodeId; 3],
        direction: [NodeId; 3],
    },
}

impl DeclaredWay {
    /// Returns the number of coordinates of its points.
    fn dimension(&self) -> u32 {
        match self {
            Self::Chart { .. } => 2,
            Self::Space { .. } => 3,
        }
    }

    /// Returns its ground, and its point at a parameter as a value.
    fn point(&self, at: NodeId) -> (Ground, ValueKind) {
        match *self {
            Self::Chart {
                manifold,
                start,
                direction,
                unit,
            } => {
                let kind = ValueKind::Point {
                    start,
                    direction,
                    unit,
                    at,
                };
                (Ground::Chart(manifold), kind)
            }
            Self::Space {
                field,
                start,
                direction,
            } => {
                let kind = ValueKind::SpacePoint {
                    start,
                    direction,
                    at,
                };
                (Ground::Solid(field), kind)
            }
        }
    }
}

/// The geodesics without a value, by name, with the reasons.
pub(crate) type GeodesicFaults = Vec<(Arc<str>, GeodesicFault)>;

/// A geodesic by its index.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub(crate) struct GeodesicId(u32);

/// The declared geodesics, and their values in use.
#[derive(Clone, Debug, Default)]
pub(crate) struct Geodesics {
    declared: Vec<DeclaredGeodesic>,
    /// The values whose numbers are uniforms, in order.
    values: Vec<GeodesicValue>,
    points: FxHashMap<(GeodesicId, NodeId), u32>,
    connections: FxHashMap<([NodeId; 7], [u64; 4]), u32>,
    pending: Vec<Pending>,
    pending_ids: FxHashMap<(GeodesicId, NodeId), usize>,
    /// The second derivatives of a point's coordinates over variables for the coordinates, followed by variables for the
    /// velocity.
    accelerations: FxHashMap<GeodesicId, Vec<NodeId>>,
    cache: GeodesicCache,
}

/// A point of a geodesic whose argument depends on parameters.
#[derive(Clone, Copy, Debug)]
struct Pending {
    geodesic: GeodesicId,
    at: NodeId,
}

/// The first pending variable: beyond the parameters of any function.
const FIRST_PENDING: u32 = 1 << 30;
/// The number of variables of a pending point: enough for a point in space with its velocity.
const WIDTH: u32 = MOST_NUMBERS as u32;

impl Geodesics {
    /// Adds a geodesic; equal ones are stored once.
    pub(crate) fn declare(&mut self, geodesic: DeclaredGeodesic) -> GeodesicId {
        let known = self.declared.iter().position(|it| *it == geodesic);
        let index = known.unwrap_or_else(|| {
            self.declared.push(geodesic);
            self.declared.len() - 1
        });
        GeodesicId(index as u32)
    }

    pub(crate) fn get(&self, id: GeodesicId) -> Option<&DeclaredGeodesic> {
        self.declared.get(id.0 as usize)
    }

    /// Returns the values whose numbers are uniforms.
    pub(crate) fn values(&self) -> &[GeodesicValue] {
        &self.values
    }

    /// Returns the shortest geodesic between two points: nodes for its start, its velocity and its length.
    pub(crate) fn connection(
        &mut self,
        graph: &mut Graph,
        sets: &mut DependencySets,
        name: &str,
        manifold: ManifoldNodes,
        [from, to]: [[NodeId; 2]; 2],
        dependencies: Dependencies,
    ) -> [NodeId; 5] {
        let [a, b, c] = manifold.components;
        let nodes = [a, b, c, from[0], from[1], to[0], to[1]];
        let ends = manifold
            .domain
            .map(|axis| [axis.min, axis.max].map(f64::to_bits));
        let key = (nodes, [ends[0][0], ends[0][1], ends[1][0], ends[1][1]]);
        let known = self.connections.get(&key).copied();
        let first = known.unwrap_or_else(|| {
            let kind = ValueKind::Connection { from, to };
            let on = Ground::Chart(manifold);
            let first = self.add_value(sets, name.into(), on, kind, dependencies);
            self.connections.insert(key, first);
            first
        });
        [0, 1, 2, 3, 4].map(|k| graph.input(Input::Uniform(first + k)))
    }

    /// Returns the point of a geodesic and its velocity there, as nodes.
    fn point(
        &mut self,
        graph: &mut Graph,
        sets: &mut DependencySets,
        id: GeodesicId,
        at: NodeId,
    ) -> Option<Vec<NodeId>> {
        let way = self.declared.get(id.0 as usize)?.way;
        let width = 2 * way.dimension();
        let is_variable = |input: &Input| matches!(input, Input::Variable(_));
        if graph.inputs(&[at]).iter().any(is_variable) {
            let known = self.pending_ids.get(&(id, at)).copied();
            let index = known.unwrap_or_else(|| {
                self.pending.push(Pending { geodesic: id, at });
                self.pending_ids.insert((id, at), self.pending.len() - 1);
                self.pending.len() - 1
            });
            return Some(
                (0..width)
                    .map(|k| graph.input(variable(index, k)))
                    .collect(),
            );
        }
        let first = match self.points.get(&(id, at)) {
            Some(&first) => first,
            None => {
                let geodesic = self.declared.get(id.0 as usize)?.clone();
                let own = sets.of_inputs(&graph.inputs(&[at]));
                let dependencies = sets.union(geodesic.dependencies, own);
                let (on, kind) = geodesic.way.point(at);
                let first = self.add_value(sets, geodesic.name, on, kind, dependencies);
                self.points.insert((id, at), first);
                first
            }
        };
        let all = (0..width).map(|k| graph.input(Input::Uniform(first + k)));
        Some(all.collect())
    }

    fn add_value(
        &mut self,
        sets: &mut DependencySets,
        geodesic: Arc<str>,
        ground: Ground,
        kind: ValueKind,
        dependencies: Dependencies,
    ) -> u32 {
        let first = sets.add_uniforms(dependencies, kind.width());
        self.values.push(GeodesicValue {
            geodesic,
            ground,
            kind,
            first,
        });
        first
    }

    /// Returns (u, v) of a geodesic, or (x, y, z) of one on a solid, over `Variable(0)`.
    pub(crate) fn body(
        &mut self,
        graph: &mut Graph,
        sets: &mut DependencySets,
        id: GeodesicId,
    ) -> Option<Vec<NodeId>> {
        let at = graph.input(Input::Variable(0));
        let mut place = self.point(graph, sets, id, at)?;
        place.truncate(place.len() / 2);
        Some(place)
    }

    /// Returns the pending points that some nodes read, directly or indirectly, each after those that its argument
    /// reads.
    fn reached(&self, graph: &Graph, nodes: &[NodeId]) -> Vec<usize> {
        if self.pending.is_empty() {
            return Vec::new();
        }
        let mut reached = BTreeSet::new();
        let mut open: Vec<usize> = pending_in(graph, nodes).collect();
        while let Some(index) = open.pop() {
            if reached.insert(index)
                && let Some(pending) = self.pending.get(index)
            {
                open.extend(pending_in(graph, &[pending.at]));
            }
        }
        reached.into_iter().collect()
    }

    /// Returns the name of a geodesic whose argument depends on parameters, if some nodes read one.
    pub(crate) fn open_name(&self, graph: &Graph, nodes: &[NodeId]) -> Option<&str> {
        if self.pending.is_empty() {
            return None;
        }
        let index = pending_in(graph, nodes).next()?;
        let pending = self.pending.get(index)?;
        Some(&self.get(pending.geodesic)?.name)
    }

    /// Returns the params and grids that some nodes read, including through geodesics.
    pub(crate) fn dependencies(
        &self,
        graph: &Graph,
        sets: &mut DependencySets,
        nodes: &[NodeId],
    ) -> Dependencies {
        let mut all = sets.of_inputs(&graph.inputs(nodes));
        for index in self.reached(graph, nodes) {
            let Some(pending) = self.pending.get(index) else {
                continue;
            };
            let own = sets.of_inputs(&graph.inputs(&[pending.at]));
            all = sets.union(all, own);
            if let Some(geodesic) = self.get(pending.geodesic) {
                all = sets.union(all, geodesic.dependencies);
            }
        }
        all
    }

    /// Returns the derivatives of some nodes by an input, including through geodesics.
    pub(crate) fn derivatives(
        &mut self,
        graph: &mut Graph,
        nodes: &[NodeId],
        by: Input,
    ) -> Result<Vec<NodeId>, TooLarge> {
        let mut chain: Vec<(usize, NodeId)> = Vec::new();
        for index in self.reached(graph, nodes) {
            let Some(Pending { at, .. }) = self.pending.get(index).copied() else {
                continue;
            };
            let inner = self.total(graph, &[at], by, &chain)?;
            chain.extend(inner.first().map(|inner| (index, *inner)));
        }
        self.total(graph, nodes, by, &chain)
    }

    /// Returns the derivatives of some nodes, given those of the arguments of pending points.
    fn total(
        &mut self,
        graph: &mut Graph,
        nodes: &[NodeId],
        by: Input,
        chain: &[(usize, NodeId)],
    ) -> Result<Vec<NodeId>, TooLarge> {
        let mut totals = graph.derivatives(nodes, by)?;
        for &(index, inner) in chain {
            let Some(Pending { geodesic, .. }) = self.pending.get(index).copied() else {
                continue;
            };
            let dimension = self.get(geodesic).map_or(2, |it| it.way.dimension());
            let width = 2 * dimension;
            let own: Vec<NodeId> = (0..width)
                .map(|k| graph.input(variable(index, k)))
                .collect();
            let read = graph.inputs(nodes);
            let reads = |k: u32| read.contains(&variable(index, k));
            let mut slopes = own[dimension as usize..].to_vec();
            if (dimension..width).any(reads) {
                slopes.extend(self.acceleration(graph, geodesic, &own)?);
            }
            for (k, slope) in (0..width).zip(slopes) {
                if !reads(k) {
                    continue;
                }
                let partials = graph.derivatives(nodes, variable(index, k))?;
                let outer = graph.mul(slope, inner);
                for (total, partial) in totals.iter_mut().zip(partials) {
                    let part = graph.mul(partial, outer);
                    *total = graph.add(*total, part);
                }
            }
        }
        Ok(totals)
    }

    /// Returns the second derivatives of a geodesic's coordinates at a point with a velocity: −Γ(g′, g′) in a chart.
    fn acceleration(
        &mut self,
        graph: &mut Graph,
        id: GeodesicId,
        at: &[NodeId],
    ) -> Result<Vec<NodeId>, TooLarge> {
        let formula = match self.accelerations.get(&id) {
            Some(known) => known.clone(),
            None => {
                let way = self.get(id).map(|geodesic| geodesic.way);
                let formula = match way.ok_or(TooLarge)? {
                    DeclaredWay::Chart { manifold, .. } => {
                        geodesic_equation(graph, &manifold)?.to_vec()
                    }
                    DeclaredWay::Space { field, .. } => {
                        space_geodesic_equation(graph, field)?.to_vec()
                    }
                };
                self.accelerations.insert(id, formula.clone());
                formula
            }
        };
        let replace = |input| match input {
            Input::Variable(k) => at.get(k as usize).copied(),
            Input::Uniform(_) => None,
        };
        graph.substitute(&formula, &replace)
    }

    /// Replaces variables, including in the arguments of geodesics: a point whose argument then depends on no parameter
    /// becomes uniforms.
    pub(crate) fn substitute(
        &mut self,
        graph: &mut Graph,
        sets: &mut DependencySets,
        nodes: &[NodeId],
        replacements: &[NodeId],
    ) -> Result<Vec<NodeId>, TooLarge> {
        let mut points: FxHashMap<Input, NodeId> = FxHashMap::default();
        for index in self.reached(graph, nodes) {
            let Some(Pending { geodesic, at }) = self.pending.get(index).copied() else {
                continue;
            };
            let at = replaced(graph, &[at], replacements, &points)?;
            let [at] = at[..] else { continue };
            let point = self.point(graph, sets, geodesic, at).ok_or(TooLarge)?;
            let own = (0..WIDTH).map(|k| variable(index, k));
            points.extend(own.zip(point));
        }
        replaced(graph, nodes, replacements, &points)
    }

    /// Converts the pending points of a curve's position, over its parameter `Variable(0)`, to values of the curve, whose
    /// numbers are the variables from 1 on.
    pub(crate) fn follow(
        &self,
        graph: &mut Graph,
        position: &mut [NodeId; 3],
    ) -> Result<Vec<GeodesicValue>, TooLarge> {
        let mut followed: Vec<GeodesicValue> = Vec::new();
        let mut points: FxHashMap<Input, NodeId> = FxHashMap::default();
        let mut first = 1;
        for index in self.reached(graph, position) {
            let Some(Pending { geodesic, at }) = self.pending.get(index).copied() else {
                continue;
            };
            let at = replaced(graph, &[at], &[], &points)?;
            let (Some(geodesic), [at]) = (self.get(geodesic), &at[..]) else {
                continue;
            };
            let (ground, kind) = geodesic.way.point(*at);
            let width = kind.width();
            followed.push(GeodesicValue {
                geodesic: geodesic.name.clone(),
                ground,
                kind,
                first,
            });
            for k in 0..width {
                let own = graph.input(Input::Variable(first + k));
                points.insert(variable(index, k), own);
            }
            first += width;
        }
        let nodes = replaced(graph, position, &[], &points)?;
        position.copy_from_slice(&nodes);
        Ok(followed)
    }

    /// Returns the values that some nodes read, directly or indirectly, in the order of their uniforms.
    pub(crate) fn read(&self, graph: &Graph, nodes: &[NodeId]) -> Vec<u32> {
        if self.values.is_empty() {
            return Vec::new();
        }
        let mut read: BTreeSet<u32> = BTreeSet::new();
        let mut open = graph.inputs(nodes);
        while let Some(input) = open.pop() {
            let Input::Uniform(uniform) = input else {
                continue;
            };
            let index = self.values.partition_point(|it| it.first <= uniform);
            let Some(index) = index.checked_sub(1) else {
                continue;
            };
            let value = &self.values[index];
            if uniform < value.first + value.width() && read.insert(index as u32) {
                open.extend(graph.inputs(&value.nodes()));
            }
        }
        read.into_iter().collect()
    }

    /// Returns true if some nodes read a geodesic between two points, whose search takes longer than a check should.
    pub(crate) fn reads_connection(&self, graph: &Graph, nodes: &[NodeId]) -> bool {
        let read = self.read(graph, nodes).into_iter();
        let mut read = read.filter_map(|index| self.values.get(index as usize));
        read.any(|value| matches!(value.kind, ValueKind::Connection { .. }))
    }

    /// Computes the values that some nodes read, and writes them into the uniforms. Returns those without a value, with the
    /// reason.
    pub(crate) fn fill(
        &self,
        graph: &Graph,
        nodes: &[NodeId],
        uniforms: &mut [f64],
    ) -> GeodesicFaults {
        let read = self.read(graph, nodes).into_iter();
        let faults = read.filter_map(|index| {
            let value = self.values.get(index as usize)?;
            let fault = value.fill(graph, uniforms, &self.cache)?;
            (fault != GeodesicFault::UndefinedInput).then(|| (value.geodesic.clone(), fault))
        });
        faults.collect()
    }
}

/// Returns all nodes of a shape from which its samples or its geodesics are computed.
pub(crate) fn nodes_of(shape: &Shape) -> Vec<NodeId> {
    let mut nodes = shape.roots();
    nodes.extend(shape.followed().iter().flat_map(GeodesicValue::nodes));
    nodes
}

fn variable(index: usize, component: u32) -> Input {
    Input::Variable(FIRST_PENDING + WIDTH * index as u32 + component)
}

/// Returns the pending points among the inputs of some nodes.
fn pending_in(graph: &Graph, nodes: &[NodeId]) -> impl Iterator<Item = usize> + use<> {
    let inputs = graph.inputs(nodes).into_iter();
    inputs.filter_map(|input| match input {
        Input::Variable(k) => Some((k.checked_sub(FIRST_PENDING)? / WIDTH) as usize),
        Input::Uniform(_) => None,
    })
}

/// Returns some nodes with variables and pending points replaced.
fn replaced(
    graph: &mut Graph,
    nodes: &[NodeId],
    replacements: &[NodeId],
    points: &FxHashMap<Input, NodeId>,
) -> Result<Vec<NodeId>, TooLarge> {
    let replace = |input| match input {
        Input::Variable(k) if k < FIRST_PENDING => replacements.get(k as usize).copied(),
        Input::Variable(_) => points.get(&input).copied(),
        Input::Uniform(_) => None,
    };
    graph.substitute(nodes, &replace)
}
