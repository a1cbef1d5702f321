//! The variables of a script by scope, and its objects, attributes, macros, colours and images with their spans.
//!
//! The scopes are the script and each macro. A use is looked up outwards; an assignment binds in the innermost scope. A use
//! that may precede the binding in its own scope may refer to the outer variable of the same name: the two then count as one,
//! so that renaming them preserves the script's behaviour. A call of a function's name is that of the function, unless the
//! variable has a macro. A variable that counts as one with a function, or with `t`, cannot be renamed.

use std::collections::HashMap;
use std::sync::Arc;

use syntax::crt::objects::{FUNCTIONS, ObjectName, ValueType};
use syntax::crt::tree::{
    Arm, Attribute, BlockKind, Body, Expression, ExpressionKind, PrefixOperator, Script, Statement,
    StatementKind, SuffixKind,
};
use syntax::span::Span;

use crate::occurrence::Occurrence;

/// A variable, by its number.
pub(super) type VariableId = usize;

/// The kind of value that was assigned to a variable first, as far as the text shows it.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Origin {
    /// It is the parameter of a macro.
    Parameter,
    /// It is assigned a macro.
    Macro,
    /// It is assigned an object.
    Object(ObjectName),
    /// It is assigned another expression.
    Value,
}

/// A variable.
#[derive(Clone, Debug)]
pub(super) struct Variable {
    /// Its name.
    pub(super) name: Arc<str>,
    /// The kind of its first value.
    pub(super) origin: Origin,
    /// The span of its first assignment.
    pub(super) assignment: Span,
    /// The span of the scope: of the macro with its parameters; `None` for the script.
    pub(super) scope: Option<Span>,
    /// The index of its first binding, in the order of the text.
    order: usize,
    /// The parameters of the macro that is its first value.
    parameters: Option<Vec<Arc<str>>>,
    /// One of its values may be a macro.
    may_be_macro: bool,
    /// One of its values may be something else.
    may_be_other: bool,
    /// One of its uses may be that of the builtin name.
    may_be_builtin: bool,
    /// Another variable that counts as the same, or the variable itself.
    same: VariableId,
}

/// An occurrence of a name.
#[derive(Clone, Debug)]
struct NameUse {
    name: Arc<str>,
    span: Span,
    scope: usize,
    order: usize,
    /// The span of the assignment that binds it, or of the parameter.
    binds: Option<Span>,
    /// It is called.
    is_called: bool,
    variable: Option<VariableId>,
}

#[derive(Debug)]
struct MacroScope {
    parent: Option<usize>,
    span: Option<Span>,
    bound: HashMap<Arc<str>, VariableId>,
}

/// An object in the text.
#[derive(Clone, Debug)]
pub(super) struct ObjectPlace {
    /// The object; `None` for an unknown name.
    pub(super) object: Option<ObjectName>,
    /// The span of the name.
    pub(super) name: Span,
    /// The span of the braces.
    pub(super) braces: Span,
    /// The spans of the attributes, each with the span of its name.
    pub(super) attributes: Vec<(Span, Span)>,
}

/// All names of a script.
#[derive(Debug, Default)]
pub(super) struct ScriptNames {
    scopes: Vec<MacroScope>,
    variables: Vec<Variable>,
    uses: Vec<NameUse>,
    /// The objects, including the block `Settings`, in the order of the text.
    pub(super) objects: Vec<ObjectPlace>,
    /// The spans of bodies between braces.
    pub(super) bodies: Vec<Span>,
    /// The starts of statements and blocks.
    pub(super) starts: Vec<u32>,
    /// The positions of the `>` that close modifiers.
    pub(super) modifier_ends: Vec<u32>,
    /// The calls of `rgb` with numbers.
    pub(super) colours: Vec<(Span, [f64; 3])>,
    /// The strings that name images, with the spans between their quotes.
    pub(super) images: Vec<(Span, Arc<str>)>,
}

impl ScriptNames {
    /// Resolves the names of a script.
    pub(super) fn of(script: &Script) -> Self {
        let mut walk = Walk {
            names: Self::default(),
            base: 0,
            scope: 0,
            is_conditional: false,
        };
        walk.names.scopes.push(MacroScope {
            parent: None,
            span: None,
            bound: HashMap::new(),
        });
        for (start, block) in script.blocks() {
            walk.base = start;
            walk.names.starts.push(start + block.span.start);
            match &block.kind {
                BlockKind::Settings(attributes, braces) => {
                    let keyword = "Settings".len() as u32;
                    let name = Span::new(block.span.start, block.span.start + keyword);
                    walk.object(Some(ObjectName::Settings), name, *braces, attributes);
                }
                BlockKind::Scene(body) => walk.body(body),
                BlockKind::Statement(statement) => walk.statement(statement),
            }
        }
        let mut names = walk.names;
        names.resolve();
        names.uses.sort_by_key(|it| it.span);
        names.objects.sort_by_key(|it| it.name);
        names.starts.sort_unstable();
        names.modifier_ends.sort_unstable();
        names
    }

    fn resolve(&mut self) {
        for k in 0..self.uses.len() {
            let NameUse {
                name,
                scope,
                order,
                is_called,
                ..
            } = self.uses[k].clone();
            let is_binding = self.uses[k].binds.is_some();
            let calls_function = is_called && FUNCTIONS.iter().any(|(it, ..)| **it == *name);
            let mut found: Option<VariableId> = None;
            let mut may_be_builtin = calls_function || &*name == "t";
            let mut other_is_builtin = false;
            let mut at = Some(scope);
            while let Some(scope) = at {
                let MacroScope { parent, bound, .. } = &self.scopes[scope];
                at = *parent;
                let Some(&variable) = bound.get(&name) else {
                    continue;
                };
                let row = &self.variables[variable];
                let is_certain = is_binding || row.order <= order;
                other_is_builtin |= calls_function && row.may_be_other;
                if !calls_function || row.may_be_macro {
                    if let Some(inner) = found {
                        let (inner, outer) = (self.same(inner), self.same(variable));
                        self.variables[inner.max(outer)].same = inner.min(outer);
                    }
                    found = found.or(Some(variable));
                }
                if is_certain {
                    may_be_builtin = false;
                    break;
                }
            }
            if let Some(variable) = found {
                self.variables[variable].may_be_builtin |= may_be_builtin || other_is_builtin;
            }
            self.uses[k].variable = found;
        }
    }

    fn same(&self, mut variable: VariableId) -> VariableId {
        while self.variables[variable].same != variable {
            variable = self.variables[variable].same;
        }
        variable
    }

    /// Returns the variable of the name at an offset, with the span of the name.
    pub(super) fn variable_at(&self, offset: u32) -> Option<(Span, VariableId)> {
        let after = self.uses.partition_point(|it| it.span.end < offset);
        let near = self.uses.get(after..)?.iter().take(2);
        let mut near = near.filter(|it| it.span.start <= offset && offset <= it.span.end);
        let found = near.next()?;
        Some((found.span, self.same(found.variable?)))
    }

    /// Returns a variable by its number.
    pub(super) fn variable(&self, variable: VariableId) -> &Variable {
        &self.variables[variable]
    }

    /// Returns true if some uses of a variable may be those of a function, or of `t`.
    pub(super) fn may_be_builtin(&self, variable: VariableId) -> bool {
        let mut all = self.variables.iter().enumerate();
        all.any(|(k, it)| it.may_be_builtin && self.same(k) == variable)
    }

    /// Returns the parameters of the macro that is a variable's first value; `None` if that is not a macro.
    pub(super) fn parameters(&self, variable: VariableId) -> Option<&[Arc<str>]> {
        self.variables[variable].parameters.as_deref()
    }

    /// Returns the variables; variables that count as the same are returned once.
    pub(super) fn variables(&self) -> impl Iterator<Item = &Variable> {
        let all = self.variables.iter().enumerate();
        all.filter(|(k, it)| it.same == *k).map(|(_, it)| it)
    }

    /// Returns the first span that binds a variable.
    pub(super) fn first(&self, variable: VariableId) -> Option<Span> {
        let occurrences = self.occurrences(variable).into_iter();
        let mut binding = occurrences.filter(|it| it.introduces);
        Some(binding.next()?.span)
    }

    /// Returns the occurrences of a variable, in the order of the text.
    pub(super) fn occurrences(&self, variable: VariableId) -> Vec<Occurrence> {
        let uses = self.uses.iter();
        let uses = uses.filter(|it| it.variable.is_some_and(|it| self.same(it) == variable));
        let places = uses.map(|it| Occurrence {
            span: it.span,
            introduces: it.binds.is_some(),
        });
        places.collect()
    }

    /// Returns the bindings of a variable, in the order of the text: the spans of the name and of the assignment.
    pub(super) fn bindings(&self, variable: VariableId) -> impl Iterator<Item = (Span, Span)> {
        let uses = self.uses.iter();
        let uses = uses.filter(move |it| it.variable.is_some_and(|it| self.same(it) == variable));
        uses.filter_map(|it| Some((it.span, it.binds?)))
    }

    /// Returns the first occurrence of a name, whatever its meaning.
    pub(super) fn place_of(&self, name: &str) -> Option<Span> {
        let mut uses = self.uses.iter().filter(|it| &*it.name == name);
        uses.next().map(|it| it.span)
    }

    /// Returns the object with an attribute whose name has this span.
    pub(super) fn object_of(&self, name: Span) -> Option<&ObjectPlace> {
        let holds = |it: &&ObjectPlace| it.attributes.iter().any(|(_, place)| *place == name);
        self.objects.iter().find(holds)
    }

    /// Returns the spans of attribute names, in the order of the text.
    pub(super) fn attribute_names(&self) -> Vec<Span> {
        let objects = self.objects.iter();
        let names = objects.flat_map(|it| it.attributes.iter().map(|(_, name)| *name));
        let mut names: Vec<Span> = names.collect();
        names.sort_unstable();
        names
    }
}

/// The state of a walk through a tree.
struct Walk {
    names: ScriptNames,
    /// The offset of the piece.
    base: u32,
    scope: usize,
    /// True inside code that a run may skip.
    is_conditional: bool,
}

impl Walk {
    /// Binds a name; `value` is what is assigned, `None` for a parameter.
    fn bind(&mut self, name: &Arc<str>, span: Span, value: Option<&Expression>, assignment: Span) {
        // A binding that may be skipped leaves later uses to the outer variable.
        let order = match self.is_conditional {
            true => usize::MAX,
            false => self.names.uses.len(),
        };
        let fresh = self.names.variables.len();
        let scope = &mut self.names.scopes[self.scope];
        let variable = *scope.bound.entry(Arc::clone(name)).or_insert(fresh);
        if variable == fresh {
            self.names.variables.push(Variable {
                name: Arc::clone(name),
                origin: value.map_or(Origin::Parameter, origin_of),
                assignment: assignment.moved(self.base),
                scope: scope.span,
                order,
                parameters: None,
                may_be_macro: false,
                may_be_other: false,
                may_be_builtin: false,
                same: fresh,
            });
        }
        let variable = &mut self.names.variables[variable];
        variable.order = order.min(variable.order);
        variable.may_be_macro |= value.is_none_or(may_be_macro);
        variable.may_be_other |=
            value.is_none_or(|it| !matches!(it.ungrouped().kind, ExpressionKind::Macro(_)));
        self.name(name, span, Some(assignment.moved(self.base)));
    }

    /// Walks code that a run may skip.
    fn conditionally(&mut self, walk: impl FnOnce(&mut Self)) {
        let before = std::mem::replace(&mut self.is_conditional, true);
        walk(self);
        self.is_conditional = before;
    }

    fn name(&mut self, name: &Arc<str>, span: Span, binds: Option<Span>) {
        let order = self.names.uses.len();
        self.names.uses.push(NameUse {
            name: Arc::clone(name),
            span: span.moved(self.base),
            scope: self.scope,
            order,
            binds,
            is_called: false,
            variable: None,
        });
    }

    fn body(&mut self, body: &Body) {
        self.names.bodies.push(body.span.moved(self.base));
        for statement in &body.statements {
            self.statement(statement);
        }
    }

    fn statement(&mut self, statement: &Statement) {
        self.names.starts.push(self.base + statement.span.start);
        match &statement.kind {
            StatementKind::Expression(expression) => self.expression(expression),
            StatementKind::While(arm) => self.arm(arm),
            StatementKind::If(arms, otherwise) => {
                for arm in arms {
                    self.arm(arm);
                }
                if let Some(body) = otherwise {
                    self.conditionally(|walk| walk.body(body));
                }
            }
        }
    }

    fn arm(&mut self, arm: &Arm) {
        self.expression(&arm.condition);
        self.conditionally(|walk| walk.body(&arm.body));
    }

    fn object(
        &mut self,
        object: Option<ObjectName>,
        name: Span,
        braces: Span,
        attributes: &[Attribute],
    ) {
        let places = attributes.iter();
        let places = places.map(|it| (it.span.moved(self.base), it.name.span.moved(self.base)));
        self.names.objects.push(ObjectPlace {
            object,
            name: name.moved(self.base),
            braces: braces.moved(self.base),
            attributes: places.collect(),
        });
        for attribute in attributes {
            self.expression(&attribute.value);
            let row = object.and_then(|object| object.attribute(&attribute.name.text));
            let value = attribute.value.ungrouped();
            if let Some(ValueType::Image) = row.map(|row| row.value)
                && let ExpressionKind::Text(text) = &value.kind
            {
                let quoted = value.span.moved(self.base);
                let inside = Span::new(quoted.start + 1, quoted.end - 1);
                self.names.images.push((inside, Arc::clone(text)));
            }
        }
    }

    fn expression(&mut self, expression: &Expression) {
        match &expression.kind {
            ExpressionKind::Missing
            | ExpressionKind::Integer(_)
            | ExpressionKind::Float(_)
            | ExpressionKind::Text(_)
            | ExpressionKind::Boolean(_) => {}
            ExpressionKind::Identifier(name) => self.name(name, expression.span, None),
            ExpressionKind::Object(object) => {
                let known = ObjectName::from_text(&object.name.text);
                self.object(known, object.name.span, object.braces, &object.attributes);
            }
            ExpressionKind::List(elements) => elements.iter().for_each(|it| self.expression(it)),
            ExpressionKind::Macro(it) => {
                let outer = (self.scope, self.is_conditional);
                self.scope = self.names.scopes.len();
                self.is_conditional = false;
                self.names.scopes.push(MacroScope {
                    parent: Some(outer.0),
                    span: Some(expression.span.moved(self.base)),
                    bound: HashMap::new(),
                });
                for parameter in &it.parameters {
                    let span = parameter.span;
                    self.bind(&parameter.text, span, None, span);
                }
                self.body(&it.body);
                (self.scope, self.is_conditional) = outer;
            }
            ExpressionKind::Group(inner) | ExpressionKind::Prefix(_, inner) => {
                self.expression(inner);
            }
            ExpressionKind::Assignment(parts) => {
                let [target, value] = &**parts;
                self.expression(value);
                match &target.kind {
                    ExpressionKind::Identifier(name) => {
                        self.bind(name, target.span, Some(value), expression.span);
                        let bound = self.names.scopes[self.scope].bound.get(name);
                        if let (ExpressionKind::Macro(it), Some(&variable)) = (&value.kind, bound) {
                            let words = it.parameters.iter().map(|it| it.text.clone());
                            let own = &mut self.names.variables[variable].parameters;
                            own.get_or_insert_with(|| words.collect());
                        }
                    }
                    _ => self.expression(target),
                }
            }
            ExpressionKind::Conditional(parts) => {
                let [condition, choices @ ..] = &**parts;
                self.expression(condition);
                self.conditionally(|walk| choices.iter().for_each(|it| walk.expression(it)));
            }
            ExpressionKind::Chain(first, links) => {
                self.expression(first);
                links.iter().for_each(|link| self.expression(&link.operand));
            }
            ExpressionKind::Suffixed(base, suffixes) => {
                self.expression(base);
                let called = suffixes.first().map(|it| &it.kind);
                let is_call = matches!(called, Some(SuffixKind::Call(_)));
                // The name was read last, as it stands alone.
                if let (true, Some(_), Some(name)) =
                    (is_call, base.identifier(), self.names.uses.last_mut())
                {
                    name.is_called = true;
                }
                for suffix in suffixes {
                    match &suffix.kind {
                        SuffixKind::Element(index) => self.expression(index),
                        SuffixKind::Call(arguments) => {
                            arguments.iter().for_each(|it| self.expression(it));
                        }
                        SuffixKind::Modifiers(modifiers) => {
                            let end = self.base + suffix.span.end;
                            self.names.modifier_ends.push(end.saturating_sub(1));
                            modifiers.iter().for_each(|it| self.expression(&it.value));
                        }
                    }
                }
                let colour = match suffixes.first().map(|it| &it.kind) {
                    Some(SuffixKind::Call(arguments)) => written_colour(base, arguments),
                    _ => None,
                };
                if let (Some(colour), Some(call)) = (colour, suffixes.first()) {
                    let span = Span::new(expression.span.start, call.span.end).moved(self.base);
                    self.names.colours.push((span, colour));
                }
            }
        }
    }
}

/// Returns the kind of a value that is assigned to a variable.
fn origin_of(value: &Expression) -> Origin {
    match &value.kind {
        ExpressionKind::Macro(_) => Origin::Macro,
        ExpressionKind::Object(object) => {
            let known = ObjectName::from_text(&object.name.text);
            known.map_or(Origin::Value, Origin::Object)
        }
        _ => Origin::Value,
    }
}

/// Returns true if the value of an expression may be a macro.
fn may_be_macro(value: &Expression) -> bool {
    match &value.ungrouped().kind {
        ExpressionKind::Macro(_) | ExpressionKind::Identifier(_) | ExpressionKind::Missing => true,
        ExpressionKind::Assignment(sides) => may_be_macro(&sides[1]),
        ExpressionKind::Conditional(parts) => parts[1..].iter().any(may_be_macro),
        ExpressionKind::Suffixed(_, suffixes) => {
            let last = suffixes.last().map(|it| &it.kind);
            matches!(last, Some(SuffixKind::Element(_)))
        }
        _ => false,
    }
}

/// Returns the colour of a call of `rgb` with numbers. `rgba` is excluded: it has a fourth number, which a picker would
/// drop.
fn written_colour(called: &Expression, arguments: &[Expression]) -> Option<[f64; 3]> {
    let is_rgb = called.identifier().is_some_and(|name| &**name == "rgb");
    if !is_rgb || arguments.len() != 3 {
        return None;
    }
    let mut colour = [0.0; 3];
    for (place, part) in colour.iter_mut().zip(arguments) {
        *place = number(part)?;
    }
    Some(colour)
}

fn number(expression: &Expression) -> Option<f64> {
    match &expression.kind {
        ExpressionKind::Integer(value) => Some(f64::from(*value)),
        ExpressionKind::Float(value) => Some(*value),
        ExpressionKind::Prefix(PrefixOperator::Plus, inner) | ExpressionKind::Group(inner) => {
            number(inner)
        }
        _ => None,
    }
}
