//! Sets of points as values: the operators `|`, `&`, `\` and `@` of solids.
//!
//! In: functions and solids by symbol, and values that place them. Out: leaves under affine maps with the steps that join
//! them, or errors.

use std::sync::Arc;

use expr::value::Value;
use expr::{Graph, Input, NodeId};
use rustc_hash::FxHashMap;
use syntax::span::Span;
use syntax::symbol::SymbolId;

use crate::geotrace::declarations::kind_of;
use crate::geotrace::dependencies::Dependencies;
use crate::geotrace::error::{self, SemanticError};
use crate::geotrace::lowerer::{Effect, Function, Lowerer, StackItem, too_large};
use crate::geotrace::symbol::Meaning;
use crate::limits::MAX_LEAVES;
use crate::scene::Sampling;
use crate::solid::{AffineNodes, Attribute, BoundGrid, Solid, SolidLeaf, SolidStep};

/// A set that is being read.
#[derive(Clone, Debug, Default)]
pub(crate) struct PointSet {
    pub(crate) solid: Arc<Solid>,
    /// The solids that it names.
    pub(crate) named: Vec<SymbolId>,
    /// The grids at which parts of it close.
    pub(crate) closed: Vec<ClosedGrid>,
    /// The number of its leaves, including all instances of its parts.
    pub(crate) size: u64,
}

/// A grid at which a solid closes: it is the union of its instances.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ClosedGrid {
    pub(crate) bound: BoundGrid,
    /// The first of the grid's own uniforms.
    pub(crate) own: u32,
    /// The number of surrounding unions over the same grid that are distinguished from this one.
    pub(crate) level: u32,
    pub(crate) axes: Vec<Sampling>,
}

/// A declared solid.
#[derive(Clone, Debug)]
pub(crate) struct DeclaredSolid {
    pub(crate) set: PointSet,
    /// The set without its own cuts, if it has any that are a leaf.
    pub(crate) uncut: Option<Arc<Solid>>,
    pub(crate) parameters: Arc<[Box<str>]>,
    /// The params that its function reads.
    pub(crate) value_dependencies: Dependencies,
    /// These, and the params that its attributes and those of its parts read.
    pub(crate) dependencies: Dependencies,
}

impl DeclaredSolid {
    /// Returns true if the two differ only in spans of the text, so that their users are equal.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.parameters == other.parameters
            && self.value_dependencies == other.value_dependencies
            && self.dependencies == other.dependencies
            && self.uncut.is_some() == other.uncut.is_some()
            && self.set.size == other.set.size
            && self.set.closed == other.set.closed
            && self.set.solid.is_same(&other.set.solid)
    }

    /// Returns the values of a grid at which a part of it closes.
    fn axes_of(&self, bound: &BoundGrid) -> Vec<Sampling> {
        let mut closed = self.set.closed.iter();
        let closed = closed.find(|it| it.bound == *bound);
        closed.map_or_else(Vec::new, |it| it.axes.clone())
    }

    /// Returns the set that it denotes as a function.
    fn function_set(&self) -> &Solid {
        self.uncut.as_ref().unwrap_or(&self.set.solid)
    }
}

impl PointSet {
    /// Returns a set that consists of one leaf.
    pub(crate) fn leaf(leaf: SolidLeaf) -> Self {
        Self {
            solid: Arc::new(Solid {
                leaves: vec![leaf],
                steps: vec![SolidStep::Leaf(0)],
                ..Solid::default()
            }),
            size: 1,
            ..Self::default()
        }
    }

    /// Joins two sets by a step.
    pub(crate) fn joined(mut self, other: Self, step: SolidStep) -> Result<Self, SemanticError> {
        self.size = self.size.saturating_add(other.size);
        if self.size > MAX_LEAVES {
            return Err(too_many_leaves(self.size));
        }
        let solid = Arc::make_mut(&mut self.solid);
        let other_solid = Arc::unwrap_or_clone(other.solid);
        let first = solid.leaves.len() as u32;
        solid.leaves.extend(other_solid.leaves);
        let steps = other_solid.steps.into_iter().map(|step| match step {
            SolidStep::Leaf(leaf) => SolidStep::Leaf(first + leaf),
            step => step,
        });
        solid.steps.extend(steps);
        solid.steps.push(step);
        self.named.extend(other.named);
        for closed in other.closed {
            if !self.closed.contains(&closed) {
                self.closed.push(closed);
            }
        }
        Ok(self)
    }

    /// Returns the set under a map.
    fn placed(mut self, graph: &mut Graph, by: &AffineNodes) -> Self {
        let identity = AffineNodes::identity(graph);
        for leaf in &mut Arc::make_mut(&mut self.solid).leaves {
            leaf.map = by.after(graph, &leaf.map);
            for attribute in Arc::make_mut(&mut leaf.attributes) {
                let before = attribute.map.unwrap_or(identity);
                attribute.map = Some(by.after(graph, &before));
            }
        }
        self
    }

    /// States attributes on the whole set, instead of those of its parts.
    pub(crate) fn state(&mut self, attributes: &[Attribute]) {
        for leaf in &mut Arc::make_mut(&mut self.solid).leaves {
            let is_replaced =
                |own: &Attribute| attributes.iter().any(|stated| stated.word == own.word);
            let own = Arc::make_mut(&mut leaf.attributes);
            own.retain(|own| !is_replaced(own));
            own.extend(attributes.iter().cloned());
        }
    }
}

impl Lowerer {
    /// Returns the set that a function denotes. The function is pushed back if its body has to be lowered first.
    pub(crate) fn atom(
        &mut self,
        function: StackItem,
        span: Span,
        stack: &mut Vec<StackItem>,
        dependencies: &mut Dependencies,
    ) -> Result<Effect, (SemanticError, Span)> {
        let StackItem::Function(function) = function else {
            return Ok(Effect::Push(StackItem::Poison));
        };
        let symbol = function.symbol;
        let count = match self.symbols.meaning(symbol) {
            Meaning::Poisoned => return Ok(Effect::Push(StackItem::Poison)),
            Meaning::Solid(solid) => {
                let solid = Arc::clone(solid);
                let sets = &mut self.dependencies;
                *dependencies = sets.union(*dependencies, solid.value_dependencies);
                let mut set = solid.set.clone();
                if self.renames_parts {
                    let renamed = self.renamed(&mut set, symbol);
                    renamed.map_err(|error| (error, span))?;
                }
                set.named = vec![symbol];
                return Ok(Effect::Push(StackItem::Set(Box::new(set))));
            }
            Meaning::Declared(declared) => Some(declared.parameters.len()),
            _ => None,
        };
        let Some(count @ (2 | 3)) = count else {
            return Err((self.not_a_solid(symbol, count), span));
        };
        let place = (0..count as u32).map(|k| self.graph.input(Input::Variable(k)));
        let operand = StackItem::Value(Value::Vector(place.collect()));
        let field = match self.body_at(function, operand, span, stack, dependencies)? {
            Ok(value) => value,
            Err(effect) => return Ok(effect),
        };
        let Value::Number(field) = field else {
            let name = self.symbols.name(symbol);
            let message = format!(
                "a solid is where a number is not positive, but the value of `{name}` is {}",
                kind_of(&field)
            );
            return Err((SemanticError::new(error::NOT_A_SOLID, message), span));
        };
        let leaf = SolidLeaf {
            name: self.symbols.name(symbol).to_owned(),
            name_span: span,
            field,
            cuts: [None; 3],
            map: AffineNodes::identity(&mut self.graph),
            attributes: Arc::default(),
        };
        Ok(Effect::Push(StackItem::Set(Box::new(PointSet::leaf(leaf)))))
    }

    /// Renames the uniforms of the grids at which a part closes, if they are the grids' own: the placement or attributes of
    /// the part read the same grids.
    fn renamed(&mut self, set: &mut PointSet, symbol: SymbolId) -> Result<(), SemanticError> {
        let outermost = set.closed.iter().filter(|closed| closed.level == 0);
        let outermost: Vec<u32> = outermost.map(|closed| closed.own).collect();
        let mut renamed: FxHashMap<u32, u32> = FxHashMap::default();
        for closed in &mut set.closed {
            if !outermost.contains(&closed.own) {
                continue;
            }
            let count = closed.axes.len() as u32;
            closed.level += 1;
            let key = (closed.own, closed.level, count);
            let first = match self.bound_uniforms.get(&key) {
                Some(&first) => first,
                None => {
                    let own = self.graph.input(Input::Uniform(closed.own));
                    let sets = &mut self.dependencies;
                    let dependencies = sets.of_inputs(&self.graph.inputs(&[own]));
                    let first = sets.add_uniforms(dependencies, count);
                    self.bound_uniforms.insert(key, first);
                    first
                }
            };
            let before = closed.bound.first_uniform;
            renamed.extend((before..before + count).zip(first..));
            closed.bound.first_uniform = first;
        }
        if renamed.is_empty() {
            return Ok(());
        }
        let solid = Arc::make_mut(&mut set.solid);
        for step in &mut solid.steps {
            let SolidStep::Instances(grids) = step else {
                continue;
            };
            for bound in grids {
                let first = bound.first_uniform;
                bound.first_uniform = renamed.get(&first).copied().unwrap_or(first);
            }
        }
        let leaves = solid.leaves.iter_mut();
        let mut places: Vec<&mut NodeId> = leaves.flat_map(SolidLeaf::nodes_mut).collect();
        let nodes: Vec<NodeId> = places.iter().map(|place| **place).collect();
        if self.reads_through_geodesic(&nodes, &renamed) {
            let name = self.symbols.name(symbol);
            let message = format!(
                "`{name}` reads a geodesic that depends on a grid, but is placed by the same grid again"
            );
            let hint = "declare a second grid for one of them";
            return Err(SemanticError::new(error::NO_FORMULA, message).with_hint(hint));
        }
        let graph = &mut self.graph;
        let replace = |input| match input {
            Input::Uniform(uniform) => renamed.get(&uniform).copied(),
            Input::Variable(_) => None,
        };
        let replacements: FxHashMap<Input, NodeId> = graph
            .inputs(&nodes)
            .into_iter()
            .filter_map(|input| Some((input, graph.input(Input::Uniform(replace(input)?)))))
            .collect();
        let found = graph.substitute(&nodes, &|input| replacements.get(&input).copied());
        for (place, node) in places.iter_mut().zip(found.map_err(|_| too_large())?) {
            **place = node;
        }
        Ok(())
    }

    /// Returns true if some nodes read the value of a geodesic that depends on one of these uniforms.
    fn reads_through_geodesic(&self, nodes: &[NodeId], uniforms: &FxHashMap<u32, u32>) -> bool {
        let read = self.geodesics.read(&self.graph, nodes).into_iter();
        let values = self.geodesics.values();
        read.filter_map(|index| values.get(index as usize))
            .any(|value| {
                let inputs = self.graph.inputs(&value.nodes());
                inputs.iter().any(|input| match input {
                    Input::Uniform(uniform) => uniforms.contains_key(uniform),
                    Input::Variable(_) => false,
                })
            })
    }

    fn not_a_solid(&self, symbol: SymbolId, parameters: Option<usize>) -> SemanticError {
        let name = self.symbols.name(symbol);
        let what = match (self.symbols.meaning(symbol), parameters) {
            (Meaning::Builtin(_), _) => "a builtin function".to_owned(),
            (Meaning::Geodesic(_), _) => "a geodesic".to_owned(),
            (_, Some(1)) => "a function of 1 parameter".to_owned(),
            (_, Some(count)) => format!("a function of {count} parameters"),
            (_, None) => "a value".to_owned(),
        };
        let message = format!(
            "a set is made of solids and of functions of 2 or 3 numbers, but `{name}` is {what}"
        );
        SemanticError::new(error::NOT_A_SOLID, message)
    }

    /// Returns the value of a function at an operand. If its body has to be lowered first, that is the effect, and only
    /// the function is pushed back.
    fn body_at(
        &mut self,
        function: Box<Function>,
        operand: StackItem,
        span: Span,
        stack: &mut Vec<StackItem>,
        dependencies: &mut Dependencies,
    ) -> Result<Result<Value, Effect>, (SemanticError, Span)> {
        let function = StackItem::Function(function);
        let effect = self.apply(function, operand, span, stack, dependencies)?;
        Ok(match effect {
            Effect::Push(StackItem::Value(value)) => Ok(value),
            Effect::Push(_) => Err(Effect::Push(StackItem::Poison)),
            run @ Effect::Run(..) => {
                stack.pop();
                Err(run)
            }
        })
    }

    /// Joins two sets by a step.
    pub(crate) fn joined(
        &mut self,
        first: StackItem,
        second: StackItem,
        step: SolidStep,
        span: Span,
    ) -> Result<StackItem, (SemanticError, Span)> {
        let (StackItem::Set(first), StackItem::Set(second)) = (first, second) else {
            return Ok(StackItem::Poison);
        };
        match first.joined(*second, step) {
            Ok(set) => Ok(StackItem::Set(Box::new(set))),
            Err(error) => Err((error, span)),
        }
    }

    /// Computes `set @ v`, `set @ scale v` and `set @ rotate v`.
    pub(crate) fn placed(
        &mut self,
        set: StackItem,
        by: StackItem,
        placement: SetMotion,
        span: Span,
    ) -> Result<StackItem, (SemanticError, Span)> {
        let value = self.value(by)?;
        let (StackItem::Set(set), Some(value)) = (set, value) else {
            return Ok(StackItem::Poison);
        };
        let in_space = <[NodeId; 3]>::try_from(value.components()).ok();
        let graph = &mut self.graph;
        let map = match (placement, in_space, &value) {
            (SetMotion::Move, Some(by), _) => AffineNodes::translation(graph, by),
            (SetMotion::Rotate, Some(by), _) => AffineNodes::rotation(graph, by),
            (SetMotion::Scale, Some(by), _) => AffineNodes::scaling(graph, by),
            (SetMotion::Scale, None, Value::Number(by)) => AffineNodes::scaling(graph, [*by; 3]),
            _ => {
                let what = match placement {
                    SetMotion::Move => "a solid is moved by a vector of dimension 3",
                    SetMotion::Scale => {
                        "a solid is scaled by a number or by one along each of x, y and z"
                    }
                    SetMotion::Rotate => {
                        "a solid is turned about a vector of dimension 3, by its length"
                    }
                };
                let message = format!("{what}, but this is {}", kind_of(&value));
                return Err((SemanticError::new(error::NOT_IN_SPACE, message), span));
            }
        };
        self.under(*set, &map, span)
    }

    /// Computes `set @ f`. The set and the function are pushed back if the body has to be lowered first.
    pub(crate) fn image(
        &mut self,
        set: StackItem,
        function: StackItem,
        span: Span,
        stack: &mut Vec<StackItem>,
        dependencies: &mut Dependencies,
    ) -> Result<Effect, (SemanticError, Span)> {
        let (StackItem::Set(set), StackItem::Function(function)) = (set, function) else {
            return Ok(Effect::Push(StackItem::Poison));
        };
        let name = self.symbols.name(function.symbol).to_owned();
        let count = match self.symbols.meaning(function.symbol) {
            Meaning::Poisoned => return Ok(Effect::Push(StackItem::Poison)),
            Meaning::Declared(declared) => declared.parameters.len(),
            _ => 0,
        };
        let not_affine = |why: String| {
            let hint = "a map is a function of 3 numbers such as `function lean(x, y, z) = (x + 0.4z, y, z);`";
            SemanticError::new(error::NOT_AFFINE, why).with_hint(hint)
        };
        if count != 3 {
            let why = format!(
                "a solid's image is taken under a function of 3 numbers, but `{name}` is not one"
            );
            return Err((not_affine(why), span));
        }
        let place = [0, 1, 2].map(|k| self.graph.input(Input::Variable(k)));
        let operand = StackItem::Value(Value::Vector(place.to_vec()));
        let value = match self.body_at(function, operand, span, stack, dependencies)? {
            Ok(value) => value,
            Err(run @ Effect::Run(..)) => {
                // The function is on top; the set belongs below it.
                let function = stack.pop();
                stack.push(StackItem::Set(set));
                stack.extend(function);
                return Ok(run);
            }
            Err(poison) => return Ok(poison),
        };
        let Ok(image) = <[NodeId; 3]>::try_from(value.components()) else {
            let why = format!(
                "the value of a map has dimension 3, but that of `{name}` is {}",
                kind_of(&value)
            );
            return Err((not_affine(why), span));
        };
        let map = AffineNodes::of_image(&mut self.graph, image).map_err(|_| (too_large(), span))?;
        let Some(map) = map else {
            let why =
                format!("`{name}` is not affine: a derivative of it depends on its parameters");
            return Err((not_affine(why), span));
        };
        self.under(*set, &map, span).map(Effect::Push)
    }

    /// Returns a set under a map, which is an error if the map is constant and singular.
    fn under(
        &mut self,
        set: PointSet,
        map: &AffineNodes,
        span: Span,
    ) -> Result<StackItem, (SemanticError, Span)> {
        let entries = map.0.as_flattened();
        if self.graph.inputs(entries).is_empty() && AffineNodes::is_singular(&self.numbers(entries))
        {
            let numbers = self.numbers(entries);
            let message = if numbers.iter().any(|number| !number.is_finite()) {
                "this map is undefined"
            } else if AffineNodes::is_flat(&numbers) {
                "this map is singular: it flattens the solid"
            } else {
                "this map makes the solid too large or too small: its determinant is beyond the range of numbers"
            };
            return Err((SemanticError::new(error::SINGULAR_MAP, message), span));
        }
        let placed = set.placed(&mut self.graph, map);
        Ok(StackItem::Set(Box::new(placed)))
    }

    /// Returns the value of a solid as a function, over the variables of space: the minimum for a union, the maximum for an
    /// intersection, and the minimum over all instances. A solid's cuts are not part of it.
    ///
    /// # Errors
    /// If the solid has so many leaves or instances that the graph has no room for the expression.
    pub(crate) fn solid_function(
        &mut self,
        solid: &DeclaredSolid,
    ) -> Result<NodeId, SemanticError> {
        let axes = |bound: &BoundGrid| solid.axes_of(bound);
        let set = solid.function_set();
        let found = set.function(&mut self.graph, &axes);
        found.map_err(|_| too_large())
    }

    /// Returns the field whose zero set is a solid's surface: its function with its cuts.
    ///
    /// # Errors
    /// As [`Lowerer::solid_function`].
    pub(crate) fn solid_field(&mut self, solid: &DeclaredSolid) -> Result<NodeId, SemanticError> {
        let axes = |bound: &BoundGrid| solid.axes_of(bound);
        let found = solid.set.solid.field(&mut self.graph, &axes);
        found.map_err(|_| too_large())
    }
}

/// The way in which a value places a set.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum SetMotion {
    Move,
    Scale,
    Rotate,
}

pub(crate) fn too_many_leaves(count: u64) -> SemanticError {
    let message = match count {
        u64::MAX => {
            format!("this solid has too many leaves: the limit is {MAX_LEAVES}, instances included")
        }
        count => format!(
            "this solid has {count} leaves, instances included, and the limit is {MAX_LEAVES}"
        ),
    };
    SemanticError::new(error::TOO_MANY_LEAVES, message)
}
