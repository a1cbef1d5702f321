//! The state of the compiler between two declarations: everything declared, and what has been read of the next
//! declaration.
//!
//! In: the parser's hooks. Out: the meaning of each symbol, and the objects of the scene. The kinds of declaration are in
//! `declare.rs`, `params.rs`, `intrinsic.rs`, `solids.rs` and `stage.rs`.

use expr::value::Value;
use expr::{Input, NodeId};
use rustc_hash::{FxHashMap, FxHashSet};
use syntax::diagnostic::Diagnostic;
use syntax::geotrace::actions::{self, Actions, Declaration, Operator, StatedAttribute};
use syntax::span::Span;
use syntax::symbol::SymbolId;

use crate::geodesic_value::{GeodesicValue, ManifoldNodes};
use crate::geotrace::attributes::{DeclaredAttribute, ReadValue};
use crate::geotrace::code::Expression;
use crate::geotrace::dependencies::{Dependencies, SourceIndex};
use crate::geotrace::error::{self, SemanticError};
use crate::geotrace::geodesics::nodes_of;
use crate::geotrace::interval::DeclaredInterval;
use crate::geotrace::lowerer::{Lowered, Lowerer};
use crate::geotrace::symbol::{Constant, Declared, Meaning, Symbols};
use crate::limits::{MAX_INSTANCES, MAX_SAMPLES};
use crate::scene::{GeodesicPath, Grid, GridId, Object, ObjectId, Param, ParamId, Scene, Shape};
use crate::solid::Attribute;

/// The state of the compiler between two declarations: everything declared, and what has been read of the next
/// declaration.
#[derive(Clone, Debug, Default)]
pub(crate) struct Declarations {
    pub(crate) lowerer: Lowerer,
    /// Params, grids and objects; the objects' nodes are those of the lowerer's graph.
    pub(crate) scene: Scene,
    /// All diagnostics, in no particular order.
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// The diagnostics of the declaration that is being read.
    pub(crate) found: Vec<Diagnostic>,
    /// The intervals of the declaration that is being read.
    intervals: Vec<DeclaredInterval>,
    /// The attributes of the declaration that is being read.
    pub(crate) attributes: Vec<DeclaredAttribute>,
    /// The param or grid of each source of the lowerer's dependencies.
    pub(crate) sources: Vec<Owner>,
    /// The number of samples of all objects together.
    pub(crate) samples: u64,
    /// The number of leaves of all solids together, including all instances of each.
    pub(crate) leaves: u64,
    /// The solids, with the ids of their objects.
    solids: Vec<(SymbolId, ObjectId)>,
    /// The solids that sets name.
    parts: FxHashSet<SymbolId>,
    pub(crate) has_background: bool,
    /// The surfaces and metrics, for geodesics on them.
    manifolds: FxHashMap<SymbolId, DeclaredManifold>,
    /// The number of components of all params and grids together.
    pub(crate) components: u32,
    /// The uniforms for the next param or grid if it has the same number of components, instead of fresh ones.
    pub(crate) kept: Option<Uniforms>,
    /// True if the limits on all declarations together are left to the caller.
    pub(crate) is_checker: bool,
}

/// The outcome of a declaration. It is not part of the scene, nor known by name, until [`Declarations::add`].
#[derive(Debug, Default)]
pub(crate) struct Understood {
    /// The meaning of its name; `None` after an error, or if it uses a name whose declaration failed.
    pub(crate) meaning: Option<Meaning>,
    /// Its object, if it is drawn.
    pub(crate) drawn: Option<Drawn>,
    /// Its param or grid, if it is one.
    pub(crate) source: Option<DeclaredSource>,
    /// Its diagnostics.
    pub(crate) diagnostics: Vec<Diagnostic>,
}

/// An object that remains to be added to the scene.
#[derive(Debug)]
pub(crate) struct Drawn {
    pub(crate) object: Object,
    /// The number of samples of all its instances.
    pub(crate) samples: u64,
    pub(crate) dependencies: Dependencies,
    /// The number of leaves of a solid, including all its instances.
    pub(crate) leaves: u64,
    /// The solids that a set names.
    pub(crate) named: Vec<SymbolId>,
    /// The dependencies of a solid, including the grids at which it closes.
    pub(crate) closed: Dependencies,
}

/// A param or a grid that remains to be added to the scene.
#[derive(Debug)]
pub(crate) struct DeclaredSource {
    pub(crate) data: SourceData,
    pub(crate) uniforms: Uniforms,
    /// True if the uniforms are new.
    pub(crate) is_fresh: bool,
}

#[derive(Clone, Debug)]
pub(crate) enum SourceData {
    Param(Param),
    Grid(Grid),
}

impl From<Meaning> for Understood {
    fn from(meaning: Meaning) -> Self {
        Self {
            meaning: Some(meaning),
            ..Self::default()
        }
    }
}

impl Understood {
    /// Adds the drawn object.
    pub(crate) fn drawn(mut self, drawn: Option<Drawn>) -> Self {
        self.drawn = drawn;
        self
    }

    /// Adds the param or grid.
    pub(crate) fn source(mut self, source: DeclaredSource) -> Self {
        self.source = Some(source);
        self
    }
}

/// The part of a surface or a metric that geodesics on it require.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DeclaredManifold {
    pub(crate) object: ObjectId,
    pub(crate) nodes: ManifoldNodes,
    pub(crate) dependencies: Dependencies,
}

/// The uniforms of a param or a grid.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) struct Uniforms {
    pub(crate) first: u32,
    pub(crate) count: u32,
    /// The set that contains only this param or grid.
    pub(crate) dependencies: Dependencies,
    pub(crate) source: SourceIndex,
}

/// The param or grid of a source of dependencies.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Owner {
    Param(ParamId),
    Grid(GridId),
}

impl Actions for Declarations {
    fn act_operator(&mut self, operator: Operator, span: Span) {
        self.lowerer.code.push(operator, span);
    }

    fn act_interval(&mut self, interval: actions::Interval) {
        self.interval(interval);
    }

    fn act_attribute(&mut self, attribute: StatedAttribute, value: &str) {
        self.attribute(attribute, value);
    }

    fn act_declaration(&mut self, declaration: &Declaration<'_>) {
        let understood = self.understand(declaration);
        self.add(declaration, understood);
    }

    fn act_error(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }
}

impl Declarations {
    /// Creates a state with only the builtins.
    pub(crate) fn new() -> Self {
        let mut declarations = Self::default();
        let lowerer = &mut declarations.lowerer;
        lowerer.symbols = Symbols::builtin(&mut lowerer.graph);
        declarations
    }

    /// Returns the scene, with a graph of its own that contains only the nodes required by its objects.
    pub(crate) fn scene(&self) -> Scene {
        let mut scene = self.scene.clone();
        scene.uniform_count = self.lowerer.dependencies.uniform_count();
        self.put_parts_aside(&mut scene);
        self.read_geodesics(&mut scene);
        let stage = scene.parts.iter_mut().chain(&mut scene.stage);
        let objects = scene.objects.iter_mut().chain(stage);
        let shapes = objects.flat_map(Object::nodes_mut);
        let values = scene.geodesic_values.iter_mut();
        let values = values.flat_map(GeodesicValue::nodes_mut);
        let mut places: Vec<&mut NodeId> = shapes.chain(values).collect();
        let roots: Vec<NodeId> = places.iter().map(|place| **place).collect();
        let (graph, roots) = self.lowerer.graph.extract(&roots);
        for (place, root) in places.iter_mut().zip(roots) {
            **place = root;
        }
        scene.graph = graph;
        scene
    }

    /// Moves the solids that sets name from the drawn objects to the parts.
    fn put_parts_aside(&self, scene: &mut Scene) {
        let mut is_part = vec![false; scene.objects.len()];
        let named = self
            .solids
            .iter()
            .filter(|(symbol, _)| self.parts.contains(symbol));
        for (_, object) in named {
            is_part[object.index()] = true;
        }
        if !is_part.contains(&true) {
            return;
        }
        let objects = std::mem::take(&mut scene.objects);
        let mut numbers = Vec::with_capacity(objects.len());
        for (object, is_part) in objects.into_iter().zip(is_part) {
            numbers.push(ObjectId::new(scene.objects.len()));
            match is_part {
                true => scene.parts.push(object),
                false => scene.objects.push(object),
            }
        }
        for object in &mut scene.objects {
            if let Shape::Geodesic {
                path: GeodesicPath::Chart { surface, .. },
                ..
            } = &mut object.shape
                && let Some(number) = numbers.get(surface.index())
            {
                *surface = *number;
            }
        }
    }

    /// Adds the values of geodesics that its objects read to a scene.
    fn read_geodesics(&self, scene: &mut Scene) {
        let geodesics = &self.lowerer.geodesics;
        if geodesics.values().is_empty() {
            return;
        }
        let mut used: Vec<u32> = Vec::new();
        let surfaces: Vec<Vec<NodeId>> = scene.objects.iter().map(|on| on.shape.roots()).collect();
        let staged = scene.parts.iter_mut().chain(&mut scene.stage);
        for object in scene.objects.iter_mut().chain(staged) {
            let mut nodes = nodes_of(&object.shape);
            let attributes = object.attributes.iter_mut();
            nodes.extend(attributes.flat_map(Attribute::nodes_mut).map(|node| *node));
            // A geodesic is drawn with the numbers of its surface.
            if let Some((surface, _)) = object.shape.geodesic()
                && let Some(on) = surfaces.get(surface.index())
            {
                nodes.extend(on);
            }
            let read = geodesics.read(&self.lowerer.graph, &nodes);
            used.extend(&read);
            object.geodesic_values = read;
        }
        used.sort_unstable();
        used.dedup();
        let staged = scene.parts.iter_mut().chain(&mut scene.stage);
        for object in scene.objects.iter_mut().chain(staged) {
            for value in &mut object.geodesic_values {
                *value = used.partition_point(|other| other < value) as u32;
            }
        }
        let all = geodesics.values();
        let values = used.iter().filter_map(|index| all.get(*index as usize));
        scene.geodesic_values = values.cloned().collect();
    }

    /// Records an interval that has been read.
    pub(crate) fn interval(&mut self, read: actions::Interval) {
        // If the expressions are incomplete, the declaration is faulty and is dropped as a whole.
        self.intervals
            .extend(DeclaredInterval::last(&self.lowerer, read));
    }

    /// Records an attribute that has been read, with the text of its value.
    pub(crate) fn attribute(&mut self, read: StatedAttribute, text: &str) {
        let value = match read.word.is_key() {
            true => Some(ReadValue::Word(text.into())),
            false => {
                let code = &self.lowerer.code;
                let last = code.last_before(code.end());
                last.map(|[value]| ReadValue::Expression(value))
            }
        };
        let attribute = value.map(|value| DeclaredAttribute { read, value });
        self.attributes.extend(attribute);
    }

    /// Computes the outcome of a declaration that has been read to its end.
    pub(crate) fn understand(&mut self, declaration: &Declaration<'_>) -> Understood {
        let intervals = std::mem::take(&mut self.intervals);
        let understood = match declaration.faulty {
            true => None,
            false => self.meaning(declaration, &intervals),
        };
        self.attributes.clear();
        self.lowerer.code.forget();
        Understood {
            diagnostics: std::mem::take(&mut self.found),
            ..understood.unwrap_or_default()
        }
    }

    /// Adds the outcome of a declaration: defines its name, and adds its object to the scene.
    pub(crate) fn add(&mut self, declaration: &Declaration<'_>, understood: Understood) {
        self.scene.uniform_count = self.lowerer.dependencies.uniform_count();
        match understood.source.map(|source| source.data) {
            Some(SourceData::Param(param)) => self.scene.params.push(param),
            Some(SourceData::Grid(grid)) => self.scene.grids.push(grid),
            None => {}
        }
        if let Some(drawn) = understood.drawn {
            self.draw(declaration.symbol, drawn);
        }
        if let (Some(symbol), Some(meaning)) = (declaration.symbol, understood.meaning) {
            let keyword = Some(declaration.keyword);
            let symbols = &mut self.lowerer.symbols;
            symbols.define(symbol, declaration.name, keyword, meaning);
        }
        self.diagnostics.extend(understood.diagnostics);
    }

    fn draw(&mut self, symbol: Option<SymbolId>, drawn: Drawn) {
        let object = ObjectId::new(self.scene.objects.len());
        let shape = &drawn.object.shape;
        if let (Some(symbol), Some((components, domain))) =
            (symbol, shape.surface().or(shape.metric()))
        {
            let manifold = DeclaredManifold {
                object,
                nodes: ManifoldNodes {
                    components: *components,
                    is_metric: shape.is_metric(),
                    domain: domain.map(|axis| axis.range),
                },
                dependencies: drawn.dependencies,
            };
            self.manifolds.insert(symbol, manifold);
        }
        self.samples += drawn.samples;
        self.leaves += drawn.leaves;
        self.parts.extend(drawn.named);
        match shape {
            Shape::Light(_) | Shape::Camera(_) => self.scene.stage.push(drawn.object),
            Shape::Background(_) => {
                self.has_background = true;
                self.scene.stage.push(drawn.object);
            }
            Shape::Solid(_) => {
                self.solids.extend(symbol.map(|symbol| (symbol, object)));
                self.scene.objects.push(drawn.object);
            }
            _ => self.scene.objects.push(drawn.object),
        }
    }

    /// Returns the surface or metric of this symbol; `None` if it could not be added.
    pub(crate) fn manifold_of(&self, symbol: SymbolId) -> Option<DeclaredManifold> {
        self.manifolds.get(&symbol).copied()
    }

    /// Returns the expressions before the intervals and attributes.
    pub(crate) fn expressions<const N: usize>(
        &self,
        intervals: &[DeclaredInterval],
    ) -> Option<[Expression; N]> {
        let code = &self.lowerer.code;
        let intervals = intervals.first().map(DeclaredInterval::start);
        let mut attributes = self.attributes.iter();
        let attributes = attributes.find_map(DeclaredAttribute::start);
        let end = intervals.into_iter().chain(attributes).min();
        code.last_before(end.unwrap_or(code.end()))
    }

    pub(crate) fn constant(&mut self, body: Expression) -> Lowered {
        self.lowerer.lower(body, Vec::new(), &mut self.found)
    }

    /// Lowers a curve's or a surface's own body, whose parameters are numbers.
    pub(crate) fn over_variables(&mut self, body: Expression, count: usize) -> Lowered {
        let graph = &mut self.lowerer.graph;
        let variables = (0..count as u32)
            .map(|index| Value::Number(graph.input(Input::Variable(index))))
            .collect();
        self.lowerer.lower(body, variables, &mut self.found)
    }

    /// Returns a function's meaning; its steps are stored.
    pub(crate) fn keep(&mut self, declaration: &Declaration<'_>, body: Expression) -> Meaning {
        self.lowerer.code.keep(body.steps().end);
        let parameters = declaration.parameters.iter();
        Meaning::Declared(Declared {
            body,
            parameters: parameters
                .map(|parameter| parameter.name.as_str().into())
                .collect(),
        })
    }

    /// Returns the components of a drawn value; `None` if it is not in space or its declaration failed.
    pub(crate) fn in_space(
        &mut self,
        expression: Expression,
        lowered: &Lowered,
        what: &str,
    ) -> Option<[NodeId; 3]> {
        let value = lowered.value.as_ref()?;
        if let (Value::Vector(nodes), Ok(position)) =
            (value, <[NodeId; 3]>::try_from(value.components()))
            && nodes.len() == 3
        {
            return Some(position);
        }
        let mut error = SemanticError::new(
            error::NOT_IN_SPACE,
            format!(
                "{what} lies in space and needs 3 components, but this is {}",
                kind_of(value)
            ),
        );
        let hint = match (value, what) {
            (Value::Number(_), "a surface") => {
                Some("the graph of f is the surface `(x, y, f(x, y))`")
            }
            (Value::Number(_), "a curve") => Some("the graph of f is the curve `(t, f t, 0)`"),
            (Value::Vector(nodes), _) if nodes.len() == 2 => {
                Some("add a third component: `(x, y, 0)` lies in the plane z = 0")
            }
            _ => None,
        };
        if let Some(hint) = hint {
            error = error.with_hint(hint);
        }
        let span = self.lowerer.code.span(expression);
        self.found.push(error.at(span));
        None
    }

    /// Returns the value of a result; an error is reported at `span`.
    pub(crate) fn sound<T>(&mut self, result: Result<T, SemanticError>, span: Span) -> Option<T> {
        match result {
            Ok(sound) => Some(sound),
            Err(error) => {
                self.found.push(error.at(span));
                None
            }
        }
    }

    /// Returns an object within the limits for drawing; `None` if it exceeds one, which is reported.
    pub(crate) fn object(
        &mut self,
        declaration: &Declaration<'_>,
        shape: Shape,
        dependencies: Dependencies,
        attributes: Vec<Attribute>,
    ) -> Option<Drawn> {
        let (params, grids) = self.sources_of(dependencies);
        let name = declaration.name;
        let mut counts = Vec::new();
        for grid in &grids {
            let grid = &self.scene.grids[grid.0 as usize];
            let values = grid.axes.iter().fold(1, |product: u64, axis| {
                product.saturating_mul(u64::from(axis.count))
            });
            counts.push((&grid.name, values));
        }
        let instances = counts
            .iter()
            .fold(1, |product: u64, (_, count)| product.saturating_mul(*count));
        if instances > MAX_INSTANCES {
            let mut product: Vec<String> = counts
                .iter()
                .take(6)
                .map(|(grid, count)| format!("`{grid}` has {} values", count_in_words(*count)))
                .collect();
            if counts.len() > product.len() {
                product.push("…".to_owned());
            }
            let times = count_in_words(instances);
            let error = SemanticError::new(
                error::TOO_MANY_INSTANCES,
                format!(
                    "`{name}` would be drawn {times} times, and the limit is {MAX_INSTANCES}: {}",
                    product.join(", ")
                ),
            );
            self.found.push(error.at(declaration.name_span));
            return None;
        }
        let samples = instances.saturating_mul(shape.sample_count());
        if samples > MAX_SAMPLES - self.samples {
            let all = if self.samples == 0 {
                String::new()
            } else {
                format!(", on top of the {} of what is drawn above", self.samples)
            };
            let error = SemanticError::new(
                error::TOO_MANY_SAMPLES,
                format!(
                    "`{name}` has {} samples{all}; the limit is {MAX_SAMPLES} in all",
                    count_in_words(samples)
                ),
            )
            .with_hint("give its intervals, or the grids it depends on, smaller counts");
            self.found.push(error.at(declaration.name_span));
            return None;
        }
        Some(Drawn {
            object: Object {
                name: name.to_owned(),
                name_span: declaration.name_span,
                shape,
                params,
                grids,
                // The indexes for a scene, whose graph has other nodes, are determined when it is assembled.
                geodesic_values: Vec::new(),
                attributes,
            },
            samples,
            dependencies,
            leaves: 0,
            named: Vec::new(),
            closed: Dependencies::default(),
        })
    }

    /// Returns the params and grids in a set of dependencies, in the order of the text.
    pub(crate) fn sources_of(&self, dependencies: Dependencies) -> (Vec<ParamId>, Vec<GridId>) {
        let mut params = Vec::new();
        let mut grids = Vec::new();
        for source in self.lowerer.dependencies.sources(dependencies) {
            match self.sources.get(source.0 as usize) {
                Some(Owner::Param(id)) => params.push(*id),
                Some(Owner::Grid(id)) => grids.push(*id),
                None => {}
            }
        }
        (params, grids)
    }
}

/// Returns a value's dimension in words.
pub(crate) fn kind_of(value: &Value) -> String {
    match value {
        Value::Number(_) => "a number".to_owned(),
        Value::Vector(nodes) => format!("a vector of dimension {}", nodes.len()),
    }
}

pub(crate) fn constant(value: Value, dependencies: Dependencies) -> Meaning {
    Meaning::Constant(Constant {
        value,
        dependencies,
    })
}

/// Returns a count in words; a product that was too large to compute has no digits.
fn count_in_words(count: u64) -> String {
    match count {
        u64::MAX => "too many".to_owned(),
        _ => count.to_string(),
    }
}
