//! Declarations: from a declaration that has been read to a symbol's meaning and, for what is drawn, an
//! object of the scene.

use expr::value::Value;
use expr::{Input, NodeId};
use rustc_hash::FxHashMap;
use syntax::actions::{self, Declaration, Parameter};
use syntax::codes::MISSING_INTERVAL;
use syntax::diagnostic::{Diagnostic, Related};
use syntax::span::Span;
use syntax::token::{DeclareWord, SymbolId};

use crate::builtin;
use crate::code::Expression;
use crate::fault::{self, Fault};
use crate::interval::{Interval, Purpose};
use crate::limits::{DEFAULT_SAMPLES, MAX_INSTANCES, MAX_SAMPLES};
use crate::lower::{Lowered, Lowerer};
use crate::params::{Owner, Uniforms};
use crate::reads::Reads;
use crate::scene::{GridId, Object, ObjectId, ParamId, Range, Sampling, Scene, Shape};
use crate::symbol::{Constant, Declared, Meaning};

/// The compiler between two declarations: what has been declared, and what has been read of the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Declarations {
    pub(crate) lowerer: Lowerer,
    /// Params, grids and objects; the objects' nodes are those of the lowerer's graph.
    pub(crate) scene: Scene,
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// The intervals of the declaration that is being read.
    intervals: Vec<Interval>,
    /// What each source of the lowerer's reads is.
    pub(crate) sources: Vec<Owner>,
    /// How many samples the objects have together.
    pub(crate) samples: u64,
    /// The surfaces and metrics, for the geodesics that lie on them.
    patches: FxHashMap<SymbolId, Patch>,
    /// The uniforms that the next param or grid takes if it has as many components, instead of fresh ones.
    pub(crate) kept: Option<Uniforms>,
    /// The limits that hold for all declarations together are someone else's business.
    pub(crate) is_workshop: bool,
}

/// What a geodesic has to know of the surface or metric that it lies on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Patch {
    pub(crate) object: ObjectId,
    pub(crate) domain: [Range; 2],
    pub(crate) reads: Reads,
}

impl Declarations {
    /// Nothing declared but the builtins.
    pub(crate) fn new() -> Self {
        let mut declarations = Self::default();
        let lowerer = &mut declarations.lowerer;
        builtin::define(&mut lowerer.symbols, &mut lowerer.graph);
        declarations
    }

    /// The scene, with a graph of its own that holds what its objects need and nothing else.
    pub(crate) fn scene(&self) -> Scene {
        let mut scene = self.scene.clone();
        let shapes = scene.objects.iter_mut().map(|object| &mut object.shape);
        let mut places: Vec<&mut NodeId> = shapes.flat_map(Shape::roots_mut).collect();
        let roots: Vec<NodeId> = places.iter().map(|place| **place).collect();
        let (graph, roots) = self.lowerer.graph.extract(&roots);
        for (place, root) in places.iter_mut().zip(roots) {
            **place = root;
        }
        scene.graph = graph;
        scene
    }

    /// An interval has been read.
    pub(crate) fn interval(&mut self, read: actions::Interval) {
        // Where the expressions are incomplete the declaration is faulty and is dropped as a whole.
        self.intervals.extend(Interval::last(&self.lowerer, read));
    }

    /// A declaration has been read to its end.
    pub(crate) fn declare(&mut self, declaration: &Declaration<'_>) {
        let intervals = std::mem::take(&mut self.intervals);
        let meaning = if declaration.faulty {
            None
        } else {
            self.understand(declaration, &intervals)
        };
        self.lowerer.code.forget();
        if let (Some(symbol), Some(meaning)) = (declaration.symbol, meaning) {
            let word = Some(declaration.word);
            let symbols = &mut self.lowerer.symbols;
            symbols.define(symbol, declaration.name, word, meaning);
        }
    }

    /// What a declaration means; none where something is wrong with it.
    fn understand(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[Interval],
    ) -> Option<Meaning> {
        match declaration.word {
            DeclareWord::Param => self.param(declaration, intervals),
            DeclareWord::Grid => self.grid(declaration, intervals),
            DeclareWord::Define => {
                let [body] = self.expressions(intervals)?;
                let lowered = self.constant(body);
                Some(constant(lowered.value?, lowered.reads))
            }
            DeclareWord::Function => self.function(declaration),
            DeclareWord::Point => self.point(declaration),
            DeclareWord::Vector => self.vector(declaration),
            DeclareWord::Curve => self.curve(declaration, intervals),
            DeclareWord::Surface => self.surface(declaration, intervals),
            DeclareWord::Metric => self.metric(declaration, intervals),
            DeclareWord::Geodesic => self.geodesic(declaration, intervals),
        }
    }

    /// A function's body is kept as it was read, for its type is that of its applications.
    fn function(&mut self, declaration: &Declaration<'_>) -> Option<Meaning> {
        let [body] = self.expressions(&[])?;
        // What is wrong whatever the function is applied to is reported where it stands.
        let symbols = &self.lowerer.symbols;
        let totals = self.lowerer.code.totals(body);
        let totals =
            totals.filter_map(|(symbol, span)| Some(symbols.total_fault(symbol)?.at(span)));
        let functions = self.lowerer.code.functions(body);
        let values =
            functions.filter_map(|(symbol, span)| Some(symbols.value_fault(symbol)?.at(span)));
        let faults: Vec<Diagnostic> = totals.chain(values).collect();
        let sound = faults.is_empty();
        self.diagnostics.extend(faults);
        sound.then(|| self.keep(declaration, body))
    }

    fn point(&mut self, declaration: &Declaration<'_>) -> Option<Meaning> {
        let [body] = self.expressions(&[])?;
        let lowered = self.constant(body);
        let position = self.in_space(body, &lowered, "a point")?;
        self.object(declaration, Shape::Point { position }, lowered.reads);
        Some(constant(lowered.value?, lowered.reads))
    }

    fn vector(&mut self, declaration: &Declaration<'_>) -> Option<Meaning> {
        let [direction, origin] = self.expressions(&[])?;
        let lowered = self.constant(direction);
        let towards = self.in_space(direction, &lowered, "a vector's direction");
        let start = self.constant(origin);
        let from = self.in_space(origin, &start, "a vector's origin");
        if let (Some(direction), Some(origin)) = (towards, from) {
            let reads = self.lowerer.reads.union(lowered.reads, start.reads);
            self.object(declaration, Shape::Vector { direction, origin }, reads);
        }
        // The name stands for the direction, which has its meaning whatever the origin is.
        towards?;
        Some(constant(lowered.value?, lowered.reads))
    }

    fn curve(&mut self, declaration: &Declaration<'_>, intervals: &[Interval]) -> Option<Meaning> {
        let domain = self.domain(declaration, intervals, "a curve has one parameter");
        let [body] = self.expressions(intervals)?;
        let lowered = self.over_variables(body, declaration.parameters.len());
        let position = self.in_space(body, &lowered, "a curve")?;
        let [domain] = domain?;
        self.object(
            declaration,
            Shape::Curve {
                position,
                domain: domain?,
                parameter: declaration.parameters.first()?.name.clone(),
            },
            lowered.reads,
        );
        Some(self.keep(declaration, body))
    }

    fn surface(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[Interval],
    ) -> Option<Meaning> {
        let domain = self.domain(declaration, intervals, "a surface has two parameters");
        let [body] = self.expressions(intervals)?;
        let lowered = self.over_variables(body, declaration.parameters.len());
        let position = self.in_space(body, &lowered, "a surface")?;
        let [u, v] = domain?;
        let [first, second] = declaration.parameters else {
            return None;
        };
        let shape = Shape::Surface {
            position,
            domain: [u?, v?],
            parameters: [first.name.clone(), second.name.clone()],
        };
        self.patch(declaration, shape, lowered.reads);
        Some(self.keep(declaration, body))
    }

    /// Adds a surface or a metric, on which geodesics may lie.
    pub(crate) fn patch(
        &mut self,
        declaration: &Declaration<'_>,
        shape: Shape,
        reads: Reads,
    ) -> Option<ObjectId> {
        let domain = shape.patch()?.map(|axis| axis.range);
        let object = self.object(declaration, shape, reads)?;
        let patch = Patch {
            object,
            domain,
            reads,
        };
        self.patches.insert(declaration.symbol?, patch);
        Some(object)
    }

    /// The surface or metric of this name; none where it could not be added.
    pub(crate) fn patch_of(&self, symbol: SymbolId) -> Option<Patch> {
        self.patches.get(&symbol).copied()
    }

    /// The expressions that stand before the intervals.
    pub(crate) fn expressions<const N: usize>(
        &self,
        intervals: &[Interval],
    ) -> Option<[Expression; N]> {
        let code = &self.lowerer.code;
        let end = intervals.first().map_or(code.end(), Interval::start);
        code.last_before(end)
    }

    pub(crate) fn constant(&mut self, body: Expression) -> Lowered {
        self.lowerer.lower(body, Vec::new(), &mut self.diagnostics)
    }

    /// Lowers a curve's or a surface's own body, whose parameters are numbers.
    pub(crate) fn over_variables(&mut self, body: Expression, count: usize) -> Lowered {
        let graph = &mut self.lowerer.graph;
        let variables = (0..count as u32)
            .map(|index| Value::Number(graph.input(Input::Variable(index))))
            .collect();
        self.lowerer.lower(body, variables, &mut self.diagnostics)
    }

    /// A function's meaning; its steps are kept.
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

    /// The sampled intervals of a curve or a surface in the order of its parameters, each none where something
    /// is wrong with it; none at all where the number of parameters is wrong or a tag is.
    pub(crate) fn domain<const N: usize>(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[Interval],
        rule: &str,
    ) -> Option<[Option<Sampling>; N]> {
        let parameters = declaration.parameters;
        let mut sound = parameters.len() == N;
        if !sound {
            let fault = Fault::new(
                fault::PARAMETER_COUNT,
                format!(
                    "{rule}, but `{}` has {}",
                    declaration.name,
                    parameters.len()
                ),
            );
            self.diagnostics
                .push(fault.at(list_span(parameters, declaration.name_span)));
        }
        let mut by_parameter: Vec<Option<&Interval>> = vec![None; parameters.len()];
        for interval in intervals {
            let Some((position, tag)) = interval.read.tag else {
                continue;
            };
            // An unknown tag has been reported; which parameter was meant is anyone's guess.
            let place = position.and_then(|position| by_parameter.get_mut(position as usize));
            let Some(place) = place else {
                sound = false;
                by_parameter.clear();
                break;
            };
            match place {
                None => *place = Some(interval),
                Some(first) => {
                    let position = position.unwrap_or_default() as usize;
                    let name = parameters.get(position).map_or("", |named| &*named.name);
                    let mut fault = Fault::new(
                        fault::DUPLICATE_TAG,
                        format!("the parameter `{name}` has two intervals"),
                    );
                    fault.trail.extend(first.read.tag.map(|(_, span)| Related {
                        span,
                        message: "its first interval is here".to_owned(),
                    }));
                    self.diagnostics.push(fault.at(tag));
                    sound = false;
                }
            }
        }
        for (parameter, interval) in parameters.iter().zip(&by_parameter) {
            if interval.is_none() {
                let name = &parameter.name;
                let fault = Fault::new(
                    MISSING_INTERVAL,
                    format!("the parameter `{name}` has no interval"),
                )
                .with_hint(format!("add one before the `;`: `, {name} : [0, 1]`"));
                self.diagnostics.push(fault.at(parameter.span));
                sound = false;
            }
        }
        // The intervals have their own mistakes, whatever is wrong with their tags.
        let samplings: Vec<Option<Sampling>> = intervals
            .iter()
            .map(|interval| {
                let lowerer = &mut self.lowerer;
                let bounds = interval.bounds(lowerer, Purpose::Domain, &mut self.diagnostics)?;
                Some(bounds.sampling(DEFAULT_SAMPLES))
            })
            .collect();
        if !sound {
            return None;
        }
        let mut domain = [None; N];
        for (interval, sampling) in intervals.iter().zip(samplings) {
            if let Some((Some(position), _)) = interval.read.tag
                && let Some(place) = domain.get_mut(position as usize)
            {
                *place = sampling;
            }
        }
        Some(domain)
    }

    /// The components of what is drawn; none where it does not lie in space or has failed before.
    fn in_space(
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
        let fault = Fault::new(
            fault::NOT_IN_SPACE,
            format!(
                "{what} lies in space and needs 3 components, but this is {}",
                kind_of(value)
            ),
        );
        let span = self.lowerer.code.span(expression);
        self.diagnostics.push(fault.at(span));
        None
    }

    /// Adds an object, within the limits of what can be drawn; none where it lies beyond them.
    pub(crate) fn object(
        &mut self,
        declaration: &Declaration<'_>,
        shape: Shape,
        reads: Reads,
    ) -> Option<ObjectId> {
        let (params, grids) = self.dependencies(reads);
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
                .map(|(grid, count)| format!("`{grid}` has {} values", tally(*count)))
                .collect();
            if counts.len() > product.len() {
                product.push("…".to_owned());
            }
            let times = tally(instances);
            let fault = Fault::new(
                fault::TOO_MANY_INSTANCES,
                format!(
                    "`{name}` would be drawn {times} times, and the limit is {MAX_INSTANCES}: {}",
                    product.join(", ")
                ),
            );
            self.diagnostics.push(fault.at(declaration.name_span));
            return None;
        }
        let samples = instances.saturating_mul(match &shape {
            Shape::Point { .. } | Shape::Vector { .. } | Shape::Metric { .. } => 1,
            Shape::Curve { domain, .. } | Shape::Geodesic { domain, .. } => u64::from(domain.count),
            Shape::Surface { domain: [u, v], .. } => u64::from(u.count) * u64::from(v.count),
        });
        if samples > MAX_SAMPLES - self.samples {
            let all = if self.samples == 0 {
                String::new()
            } else {
                format!(", on top of the {} of what is drawn above", self.samples)
            };
            let fault = Fault::new(
                fault::TOO_MANY_SAMPLES,
                format!(
                    "`{name}` has {} samples{all}; the limit is {MAX_SAMPLES} in all",
                    tally(samples)
                ),
            )
            .with_hint("give its intervals, or the grids it depends on, smaller counts");
            self.diagnostics.push(fault.at(declaration.name_span));
            return None;
        }
        let id = ObjectId(self.scene.objects.len() as u32);
        self.samples += samples;
        self.scene.objects.push(Object {
            name: name.to_owned(),
            name_span: declaration.name_span,
            shape,
            params,
            grids,
        });
        Some(id)
    }

    /// The params and grids of a set of reads, in the order of the text.
    pub(crate) fn dependencies(&self, reads: Reads) -> (Vec<ParamId>, Vec<GridId>) {
        let mut params = Vec::new();
        let mut grids = Vec::new();
        for source in self.lowerer.reads.sources(reads) {
            match self.sources.get(source.0 as usize) {
                Some(Owner::Param(id)) => params.push(*id),
                Some(Owner::Grid(id)) => grids.push(*id),
                None => {}
            }
        }
        (params, grids)
    }
}

/// A value's dimension in words.
pub(crate) fn kind_of(value: &Value) -> String {
    match value {
        Value::Number(_) => "a number".to_owned(),
        Value::Vector(nodes) => format!("a vector of dimension {}", nodes.len()),
    }
}

pub(crate) fn constant(value: Value, reads: Reads) -> Meaning {
    Meaning::Constant(Constant { value, reads })
}

/// From the first parameter to the last.
fn list_span(parameters: &[Parameter], name: Span) -> Span {
    match parameters {
        [] => name,
        [first, .., last] => first.span.to(last.span),
        [only] => only.span,
    }
}

/// A count in words: a product that was too large to hold is no number to be told.
fn tally(count: u64) -> String {
    match count {
        u64::MAX => "too many".to_owned(),
        _ => count.to_string(),
    }
}
