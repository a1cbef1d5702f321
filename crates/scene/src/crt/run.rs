//! Runs a script: statements, scopes, and expressions.
//!
//! In: the tree of a script. Out: the entities that its scene emits, its settings, and its diagnostics. An error ends the
//! enclosing statement at top level or in the block `Scene`. Names that this statement assigns have no value, and uses of
//! them are not reported.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use expr::number::{self, grouped};
use syntax::crt::tree::{
    Arm, BinaryOperator, BlockKind, Body, Expression, ExpressionKind as E, Link, Script, Statement,
    StatementKind, Suffix, SuffixKind,
};
use syntax::diagnostic::{Code, Diagnostic, Severity};
use syntax::span::Span;
use syntax::spelling::nearest;

use super::assignment::Assignment;
use super::entity::Entity;
use super::operate;
use super::random::JavaRandom;
use super::value::{List, MacroValue, ScriptSettings, ScriptValue};
use super::{
    BYTES_OF_A_ROUND, Evaluated, MAX_NESTING, MAX_SIZE, MAX_STEPS, MAX_WORK, ScriptLines,
    ScriptRun, build, codes,
};
use crate::limits::MAX_LEAVES;

/// The maximum depth of nested lists.
const MAX_LIST_DEPTH: u32 = 256;
/// The maximum number of variables in a chain of pointers.
const MAX_POINTERS: usize = 1_000;
/// The maximum number of diagnostics; further ones are omitted.
const MAX_DIAGNOSTICS: usize = 1000;

/// An error has been reported, and the statement is abandoned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stopped;

/// The meaning of a name.
#[derive(Clone, Debug)]
enum Binding {
    Value(ScriptValue),
    /// The value of `t` for which the script is run, unless the script assigns `t`.
    Frame,
    /// A pointer to the value of another variable, as it will be, with the span of that variable's name.
    Pointer(Arc<str>, Span),
    /// An error has been reported.
    Faulty,
}

/// The names of a macro call, or of the script.
#[derive(Debug, Default)]
struct ScopeNames {
    /// The scope in which the macro is written.
    parent: Option<usize>,
    names: HashMap<Arc<str>, Binding>,
    /// The names to which variables point, with the spans of these pointers.
    pointed: HashMap<Arc<str>, BTreeSet<Span>>,
}

/// The values assigned to a name at one location.
#[derive(Debug)]
struct Assigned {
    count: u32,
    last: u32,
    binding: Binding,
}

/// The entities that a block or a macro has emitted so far.
#[derive(Default)]
struct Emitted {
    entities: Vec<Arc<Entity>>,
    /// The number of their leaves.
    leaves: u64,
}

/// Runs a script.
pub(super) struct Interpreter<'s> {
    pub(super) lines: &'s ScriptLines,
    /// The offset to which the spans of the tree are relative.
    pub(super) base: u32,
    pub(super) random: JavaRandom,
    pub(super) call_depth: u32,
    scopes: Vec<ScopeNames>,
    scope: usize,
    work: u32,
    steps: u64,
    nesting: u32,
    /// True once the work limit has been reached.
    is_over: bool,
    /// The value of `t` for which the script is run.
    t: f64,
    /// True once it has been read: later errors may be absent for another value.
    has_read_t: bool,
    next_id: u64,
    diagnostics: Vec<Diagnostic>,
    /// The entities emitted by the block and the macros in progress, the innermost last.
    emitted: Vec<Emitted>,
    /// The assigned values, by the spans of the names.
    assigned: HashMap<Span, Assigned>,
    /// The number of assignments.
    assignments: u32,
    /// True once the run has been cancelled.
    given_up: &'s AtomicBool,
    settings: ScriptSettings,
    drawn: Vec<Arc<Entity>>,
}

impl<'s> Interpreter<'s> {
    pub(super) fn new(lines: &'s ScriptLines, t: f64, given_up: &'s AtomicBool) -> Self {
        let mut names = ScopeNames::default();
        names.names.insert("t".into(), Binding::Frame);
        Self {
            lines,
            base: 0,
            random: JavaRandom::new(1337),
            call_depth: 0,
            scopes: vec![names],
            scope: 0,
            work: 0,
            steps: 0,
            nesting: 0,
            is_over: false,
            t,
            has_read_t: false,
            next_id: 0,
            diagnostics: Vec::new(),
            emitted: Vec::new(),
            assigned: HashMap::new(),
            assignments: 0,
            given_up,
            settings: ScriptSettings::default(),
            drawn: Vec::new(),
        }
    }

    /// Runs a script. A second block and statements after the scene are run too: the parser has reported them.
    pub(super) fn script(&mut self, script: &Script) {
        let (mut has_settings, mut has_scene) = (false, false);
        for (base, block) in script.blocks() {
            if self.is_over || self.given_up.load(Ordering::Relaxed) {
                break;
            }
            self.base = base;
            match &block.kind {
                BlockKind::Settings(attributes, _) if !has_settings => {
                    has_settings = true;
                    if let Ok(settings) = self.settings(attributes, block.span) {
                        self.settings = settings;
                    }
                }
                BlockKind::Scene(body) if !has_scene => {
                    has_scene = true;
                    self.emitted.push(Emitted::default());
                    for statement in &body.statements {
                        self.whole(statement, true);
                    }
                    self.drawn = self.emitted.pop().unwrap_or_default().entities;
                }
                BlockKind::Statement(statement) => self.whole(statement, false),
                BlockKind::Settings(..) | BlockKind::Scene(_) => {}
            }
        }
    }

    /// Returns the scene, the diagnostics and the assignments of a run; `None` if it was cancelled.
    pub(super) fn finish(mut self) -> Option<ScriptRun> {
        if self.given_up.load(Ordering::Relaxed) {
            return None;
        }
        if !self.is_over {
            self.report_dangling();
        }
        let assigned = std::mem::take(&mut self.assigned).into_iter();
        let assigned = assigned.map(|(span, it)| Assignment {
            span,
            count: it.count,
            last: it.last,
            value: match it.binding {
                Binding::Value(value) => Some(value),
                Binding::Pointer(other, _) => self.known(&other),
                Binding::Frame | Binding::Faulty => None,
            },
        });
        let mut assignments: Vec<Assignment> = assigned.collect();
        assignments.sort_unstable_by_key(|it| it.span);
        let scene = build::scene(&self.settings, self.drawn);
        let mut diagnostics = self.diagnostics;
        Diagnostic::sort(&mut diagnostics);
        Some(ScriptRun {
            scene,
            diagnostics,
            assignments,
        })
    }

    /// Returns the settings, and the entities that are drawn.
    pub(super) fn left(self) -> (ScriptSettings, Vec<Arc<Entity>>) {
        (self.settings, self.drawn)
    }

    /// Returns the value of an expression after the script; its spans are relative to its own start.
    pub(super) fn value_at_end(
        mut self,
        expression: &Expression,
    ) -> Result<Evaluated, Vec<Diagnostic>> {
        self.diagnostics.clear();
        self.has_read_t = false;
        (self.base, self.is_over, self.work, self.steps) = (0, false, 0, 0);
        match self.value(expression) {
            Ok(value) => Ok(Evaluated {
                kind: value.kind(),
                text: value.text(),
                numbers: value.numbers(),
            }),
            Err(Stopped) => Err(self.diagnostics),
        }
    }

    /// Reports an error.
    pub(super) fn fault(&mut self, code: Code, span: Span, message: impl Into<String>) -> Stopped {
        self.report(Diagnostic::error(code, span, message));
        Stopped
    }

    /// Reports a diagnostic whose spans are relative to the base, once for each span.
    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        self.report_placed(diagnostic.moved(self.base));
    }

    /// Reports a diagnostic whose spans are relative to the start of the text.
    fn report_placed(&mut self, mut diagnostic: Diagnostic) {
        let is_same = |it: &Diagnostic| it.code == diagnostic.code && it.span == diagnostic.span;
        if self.diagnostics.len() < MAX_DIAGNOSTICS && !self.diagnostics.iter().any(is_same) {
            if self.has_read_t && diagnostic.severity == Severity::Error {
                let t = number::text(self.t);
                diagnostic.message = format!("{} (at t = {t})", diagnostic.message);
            }
            self.diagnostics.push(diagnostic);
        }
    }

    /// Returns the id of a new entity.
    pub(super) fn id(&mut self) -> u64 {
        self.next_id += 1;
        self.next_id
    }

    /// Counts a loop iteration, or a call.
    pub(super) fn count(&mut self, span: Span, what: &str) -> Result<(), Stopped> {
        self.spend(1, span, what)
    }

    /// Counts a new object: a million take a gigabyte. At the limit, the surrounding loop or call is stopped.
    pub(super) fn count_object(&mut self) {
        self.work = self.work.saturating_add(1);
    }

    /// Counts an expression, a statement or a compared element. At the limit, the surrounding loop or call is stopped.
    fn step(&mut self) -> Result<(), Stopped> {
        self.steps += 1;
        if self.given_up.load(Ordering::Relaxed) {
            self.is_over = true;
            return Err(Stopped);
        }
        Ok(())
    }

    /// Counts the bytes of a string that is read or copied as a whole.
    pub(super) fn spend_bytes(&mut self, text: &str, span: Span) -> Result<(), Stopped> {
        let rounds = text.len() / BYTES_OF_A_ROUND;
        self.spend(rounds as u32, span, "this string")
    }

    /// Counts an operation with the work of `rounds` iterations or calls.
    fn spend(&mut self, rounds: u32, span: Span, what: &str) -> Result<(), Stopped> {
        self.work = self.work.saturating_add(rounds);
        if self.given_up.load(Ordering::Relaxed) {
            self.is_over = true;
            return Err(Stopped);
        }
        let message = if self.work > MAX_WORK {
            format!(
                "the script is stopped in {what}: it takes more than {} rounds, calls and objects",
                grouped(MAX_WORK.into())
            )
        } else if self.steps > MAX_STEPS {
            format!(
                "the script is stopped in {what}: it takes more than {} expressions and statements",
                grouped(MAX_STEPS)
            )
        } else {
            return Ok(());
        };
        self.is_over = true;
        Err(self.fault(codes::WORK_LIMIT, span, message))
    }

    /// Runs a statement at top level, or of the scene.
    fn whole(&mut self, statement: &Statement, emits: bool) {
        if self.is_over || self.statement(statement, emits).is_ok() {
            return;
        }
        // The names that the statement would have assigned have no value.
        let names = &mut self.scopes[self.scope].names;
        statement.each_assigned(&mut |name| {
            names.insert(name.clone(), Binding::Faulty);
        });
    }

    pub(super) fn body(&mut self, body: &Body, emits: bool) -> Result<(), Stopped> {
        for statement in &body.statements {
            self.statement(statement, emits)?;
        }
        Ok(())
    }

    fn statement(&mut self, statement: &Statement, emits: bool) -> Result<(), Stopped> {
        self.nested(statement.span, |run| run.statement_within(statement, emits))
    }

    fn statement_within(&mut self, statement: &Statement, emits: bool) -> Result<(), Stopped> {
        match &statement.kind {
            StatementKind::Expression(expression) => self.expression(expression, emits),
            StatementKind::While(arm) => {
                while self.condition(arm)? {
                    self.count(statement.span, "this loop")?;
                    self.body(&arm.body, emits)?;
                }
                Ok(())
            }
            StatementKind::If(arms, rest) => {
                for arm in arms {
                    if self.condition(arm)? {
                        return self.body(&arm.body, emits);
                    }
                }
                match rest {
                    Some(body) => self.body(body, emits),
                    None => Ok(()),
                }
            }
        }
    }

    fn condition(&mut self, arm: &Arm) -> Result<bool, Stopped> {
        let value = self.value(&arm.condition)?;
        self.boolean(&value, arm.condition.span)
    }

    fn boolean(&mut self, value: &ScriptValue, span: Span) -> Result<bool, Stopped> {
        match value {
            ScriptValue::Boolean(truth) => Ok(*truth),
            other => {
                let message = format!(
                    "a condition must be a Boolean, but this is a value of type {}",
                    other.kind()
                );
                Err(self.fault(codes::TYPE_MISMATCH, span, message))
            }
        }
    }

    /// Runs an expression as a statement.
    fn expression(&mut self, expression: &Expression, emits: bool) -> Result<(), Stopped> {
        if let E::Assignment(sides) = &expression.ungrouped().kind {
            return self.assign(sides);
        }
        let value = self.value(expression)?;
        let entities = match &value {
            ScriptValue::Entity(entity) => Some(vec![entity.clone()]),
            other => other.entities(),
        };
        let is_call = matches!(&value, ScriptValue::List(list) if list.is_emitted);
        let span = expression.span;
        match entities {
            Some(entities) if emits => self.emit(entities, expression, is_call),
            Some(entities) if is_call && entities.is_empty() => Ok(()),
            Some(_) => {
                let message = "this is not drawn: entities are drawn only in `Scene` or in a macro that is called there";
                self.report(Diagnostic::warning(codes::NOT_DRAWN, span, message));
                Ok(())
            }
            None => {
                let message = format!("this value of type {} has no effect", value.kind());
                self.report(Diagnostic::warning(codes::NO_EFFECT, span, message));
                Ok(())
            }
        }
    }

    fn emit(
        &mut self,
        entities: Vec<Arc<Entity>>,
        expression: &Expression,
        is_call: bool,
    ) -> Result<(), Stopped> {
        let count: u64 = entities.iter().map(|entity| entity.leaves).sum();
        let before: u64 = self.emitted.iter().map(|it| it.leaves).sum();
        self.leaves(before.saturating_add(count), expression.span)?;
        let place = expression.span.moved(self.base);
        let label: Arc<str> = match expression.identifier() {
            Some(name) => name.clone(),
            None => self.lines.place(place.start).into(),
        };
        let keeps = is_call && expression.identifier().is_none();
        let labelled = entities.into_iter().map(|entity| {
            if keeps && entity.label.is_some() {
                return entity;
            }
            Arc::new(entity.labelled((label.clone(), place)))
        });
        if let Some(emitted) = self.emitted.last_mut() {
            emitted.entities.extend(labelled);
            emitted.leaves += count;
        }
        Ok(())
    }

    /// Checks a number of leaves against its limit.
    pub(super) fn leaves(&mut self, count: u64, span: Span) -> Result<(), Stopped> {
        if count <= MAX_LEAVES {
            return Ok(());
        }
        self.is_over = true;
        let message = format!("with this the scene has more than {MAX_LEAVES} leaves");
        Err(self.fault(codes::TOO_MANY_LEAVES, span, message))
    }

    fn assign(&mut self, sides: &[Expression; 2]) -> Result<(), Stopped> {
        let [target, source] = sides;
        let Some(name) = target.identifier() else {
            return Err(Stopped);
        };
        if let Some(other) = source.identifier() {
            return self.point(name, other, source.span, target.span);
        }
        let value = match self.value(source) {
            Ok(value) => value,
            Err(stopped) => {
                self.bind(name.clone(), Binding::Faulty, target.span);
                return Err(stopped);
            }
        };
        if let ScriptValue::Entity(entity) = &value {
            entity.name(name);
        }
        self.bind(name.clone(), Binding::Value(value), target.span);
        Ok(())
    }

    /// Makes a variable point to another one.
    fn point(
        &mut self,
        name: &Arc<str>,
        other: &Arc<str>,
        span: Span,
        target: Span,
    ) -> Result<(), Stopped> {
        let (mut scope, mut next) = (self.scope, other.clone());
        let mut passed = 0;
        loop {
            // The name that is being bound hides the same name of outer scopes.
            let is_itself = next == *name && (scope == self.scope);
            let fault = if is_itself {
                let message = format!("`{name}` would point to itself");
                Some((codes::CIRCULAR_VARIABLE, message))
            } else if passed > MAX_POINTERS {
                let message = format!("a variable points through at most {MAX_POINTERS} others");
                Some((codes::TOO_LARGE, message))
            } else {
                None
            };
            if let Some((code, message)) = fault {
                self.bind(name.clone(), Binding::Faulty, target);
                return Err(self.fault(code, span, message));
            }
            match self.find(&next, scope) {
                Some((holder, Binding::Pointer(further, _))) => (scope, next) = (holder, further),
                _ => break,
            }
            passed += 1;
            self.steps += 1;
        }
        let holder = self.find(other, self.scope);
        let holder = holder.map_or(self.scope, |(holder, _)| holder);
        let place = target.to(span).moved(self.base);
        let pointed = &mut self.scopes[holder].pointed;
        pointed.entry(other.clone()).or_default().insert(place);
        let pointer = Binding::Pointer(other.clone(), span.moved(self.base));
        self.bind(name.clone(), pointer, target);
        Ok(())
    }

    fn bind(&mut self, name: Arc<str>, binding: Binding, span: Span) {
        let pointed = self.scopes[self.scope].pointed.remove(&name);
        let is_faulty = matches!(binding, Binding::Faulty);
        for place in pointed.into_iter().flatten().filter(|_| !is_faulty) {
            let message =
                format!("this points to `{name}`, which is assigned later: it then has that value");
            let hint = Diagnostic {
                severity: Severity::Hint,
                ..Diagnostic::error(codes::POINTS_LATER, place, message)
            };
            let here = span.moved(self.base);
            self.report_placed(hint.with_related(here, format!("`{name}` is assigned here")));
        }
        let place = span.moved(self.base);
        let value = match &binding {
            // The variables of a call cease to exist at its end.
            Binding::Pointer(other, _) if self.scope != 0 => {
                self.known(other).map_or(Binding::Faulty, Binding::Value)
            }
            other => other.clone(),
        };
        self.assigned(place, value);
        self.scopes[self.scope].names.insert(name, binding);
    }

    /// Records the value assigned to a name.
    fn assigned(&mut self, place: Span, binding: Binding) {
        self.assignments = self.assignments.saturating_add(1);
        let last = self.assignments;
        let known = self.assigned.get(&place).map_or(0, |it| it.count);
        let count = known.saturating_add(1);
        self.assigned.insert(
            place,
            Assigned {
                count,
                last,
                binding,
            },
        );
    }

    /// Finds a name from a scope outwards, with its scope.
    fn find(&self, name: &str, mut scope: usize) -> Option<(usize, Binding)> {
        loop {
            let names = &self.scopes[scope];
            if let Some(binding) = names.names.get(name) {
                return Some((scope, binding.clone()));
            }
            scope = names.parent?;
        }
    }

    /// Returns the value of a variable; `None` if it has none.
    pub(super) fn known(&mut self, name: &str) -> Option<ScriptValue> {
        match self.resolved(name) {
            Ok(Binding::Value(value)) => Some(value),
            _ => None,
        }
    }

    /// Returns the meaning of a name, following pointers between variables. If there is none, returns the dangling
    /// pointer, or `None` if the name itself is undefined. Each pointer counts as a step.
    fn resolved(&mut self, name: &str) -> Result<Binding, Option<(Arc<str>, Span)>> {
        let (mut scope, mut binding) = self.find(name, self.scope).ok_or(None)?;
        // Cycles are refused, but a name bound later in an inner scope might still close one.
        for _ in 0..=MAX_POINTERS {
            match binding {
                Binding::Pointer(other, place) => {
                    self.steps += 1;
                    let found = self.find(&other, scope);
                    (scope, binding) = found.ok_or(Some((other, place)))?;
                }
                Binding::Frame => {
                    self.has_read_t = true;
                    return Ok(Binding::Value(ScriptValue::Float(self.t)));
                }
                found => return Ok(found),
            }
        }
        Err(None)
    }

    /// Returns the names that are visible at the present point of the run, in no particular order.
    fn visible_names(&self) -> Vec<&str> {
        let parent = |scope: &usize| self.scopes[*scope].parent;
        let scopes = std::iter::successors(Some(self.scope), parent);
        let names = scopes.flat_map(|scope| self.scopes[scope].names.keys());
        names.map(|name| &**name).collect()
    }

    /// Reports the pointers of the present scope to names that have never been assigned: at its end, no assignment can
    /// follow.
    fn report_dangling(&mut self) {
        let names = self.scopes[self.scope].names.values();
        let pointers = names.filter_map(|binding| match binding {
            Binding::Pointer(other, place) => Some((*place, other.clone())),
            _ => None,
        });
        let mut pointers: Vec<(Span, Arc<str>)> = pointers.collect();
        pointers.sort_unstable();
        for (place, other) in pointers {
            if let Err(None) = self.resolved(&other)
                && self.diagnostics.len() < MAX_DIAGNOSTICS
            {
                let unknown = self.unknown(&other, place);
                self.report_placed(Diagnostic {
                    severity: Severity::Warning,
                    ..unknown
                });
            }
        }
    }

    /// Returns the error of a name that has not been assigned.
    fn unknown(&self, missing: &str, place: Span) -> Diagnostic {
        let mut all = self.visible_names();
        // Among names equally near, the first is chosen.
        all.sort_unstable();
        let message = format!("no variable `{missing}` has been assigned");
        let diagnostic = Diagnostic::error(codes::UNKNOWN_VARIABLE, place, message);
        match nearest(missing, all.into_iter()) {
            Some(near) => diagnostic.with_hint(format!("did you mean `{near}`?")),
            None => diagnostic,
        }
    }

    fn variable(&mut self, name: &Arc<str>, span: Span) -> Result<ScriptValue, Stopped> {
        let used = span.moved(self.base);
        let (missing, place) = match self.resolved(name) {
            Ok(Binding::Value(value)) => return Ok(value),
            Ok(_) => return Err(Stopped),
            Err(None) => (name.clone(), used),
            Err(Some(pointer)) => pointer,
        };
        if self.diagnostics.len() >= MAX_DIAGNOSTICS {
            return Err(Stopped);
        }
        let mut diagnostic = self.unknown(&missing, place);
        if place != used {
            let message = format!("`{name}` points to it, and is used here");
            diagnostic = diagnostic.with_related(used, message);
        }
        self.report_placed(diagnostic);
        Err(Stopped)
    }

    /// Evaluates an expression.
    pub(super) fn value(&mut self, expression: &Expression) -> Result<ScriptValue, Stopped> {
        self.nested(expression.span, |run| run.value_of(expression))
    }

    /// Calls `work` one level deeper, unless that is too deep.
    fn nested<T>(
        &mut self,
        span: Span,
        work: impl FnOnce(&mut Self) -> Result<T, Stopped>,
    ) -> Result<T, Stopped> {
        if self.nesting >= MAX_NESTING {
            let message = "expressions and statements within calls are nested too deeply here";
            return Err(self.fault(codes::CALL_DEPTH, span, message));
        }
        self.step()?;
        self.nesting += 1;
        let done = work(self);
        self.nesting -= 1;
        done
    }

    fn value_of(&mut self, expression: &Expression) -> Result<ScriptValue, Stopped> {
        let span = expression.span;
        Ok(match &expression.kind {
            E::Missing => return Err(Stopped),
            E::Integer(number) => ScriptValue::Integer(*number),
            E::Float(number) => ScriptValue::Float(*number),
            E::Text(text) => ScriptValue::Text(text.clone()),
            E::Boolean(truth) => ScriptValue::Boolean(*truth),
            E::Identifier(name) => self.variable(name, span)?,
            E::Object(object) => self.object(object, span)?,
            E::List(items) => {
                let items: Result<Vec<ScriptValue>, Stopped> =
                    items.iter().map(|item| self.value(item)).collect();
                self.list(items?, span)?
            }
            E::Macro(definition) => ScriptValue::Macro(MacroValue {
                definition: definition.clone(),
                scope: self.scope,
                base: self.base,
            }),
            E::Group(inner) => self.value(inner)?,
            E::Assignment(sides) => {
                self.assign(sides)?;
                match sides[0].identifier() {
                    Some(name) => self.variable(name, sides[0].span)?,
                    None => return Err(Stopped),
                }
            }
            E::Conditional(parts) => {
                let [condition, yes, no] = &**parts;
                let truth = self.value(condition)?;
                let truth = self.boolean(&truth, condition.span)?;
                // Both operands are always evaluated.
                let (yes, no) = (self.value(yes)?, self.value(no)?);
                if truth { yes } else { no }
            }
            E::Chain(first, links) => self.chain(first, links)?,
            E::Prefix(operator, operand) => {
                let value = self.value(operand)?;
                operate::prefix(*operator, &value)
                    .map_err(|(code, message)| self.fault(code, span, message))?
            }
            E::Suffixed(first, suffixes) => self.suffixed(first, suffixes)?,
        })
    }

    /// Creates a list, within its limits.
    fn list(&mut self, items: Vec<ScriptValue>, span: Span) -> Result<ScriptValue, Stopped> {
        let depth = items.iter().map(|item| match item {
            ScriptValue::List(list) => list.depth,
            _ => 0,
        });
        let depth = 1 + depth.max().unwrap_or(0);
        if depth > MAX_LIST_DEPTH || items.len() as u64 > MAX_SIZE {
            let message = format!(
                "a list has at most {MAX_SIZE} elements, and {MAX_LIST_DEPTH} lists within it"
            );
            return Err(self.fault(codes::TOO_LARGE, span, message));
        }
        Ok(ScriptValue::List(Arc::new(List {
            items,
            depth,
            is_emitted: false,
        })))
    }

    fn chain(&mut self, first: &Expression, links: &[Link]) -> Result<ScriptValue, Stopped> {
        let mut value = self.value(first)?;
        for link in links {
            let other = self.value(&link.operand)?;
            let span = first.span.to(link.operand.span);
            value = match self.joined_entities(link.operator, &value, &other, span)? {
                Some(joined) => joined,
                None => match link.operator {
                    BinaryOperator::Equal => {
                        ScriptValue::Boolean(self.are_equal(&value, &other, span)?)
                    }
                    BinaryOperator::NotEqual => {
                        ScriptValue::Boolean(!self.are_equal(&value, &other, span)?)
                    }
                    operator => operate::binary(operator, &value, &other)
                        .map_err(|(code, message)| self.fault(code, span, message))?,
                },
            };
            if let ScriptValue::Text(text) = &value {
                self.spend_bytes(text, span)?;
            }
        }
        Ok(value)
    }

    /// Returns true if two values are equal: numbers across types, lists by elements, entities by identity.
    fn are_equal(&mut self, a: &ScriptValue, b: &ScriptValue, span: Span) -> Result<bool, Stopped> {
        match (a, b) {
            (ScriptValue::List(a), ScriptValue::List(b)) => {
                if a.items.len() != b.items.len() {
                    return Ok(false);
                }
                for (a, b) in a.items.iter().zip(&b.items) {
                    // Lists can share elements, so there can be more paths to elements than elements.
                    self.step()?;
                    self.spend(0, span, "this comparison")?;
                    if !self.are_equal(a, b, span)? {
                        return Ok(false);
                    }
                }
                Ok(true)
            }
            (ScriptValue::Text(a), ScriptValue::Text(b)) => {
                self.spend_bytes(a, span)?;
                Ok(a == b)
            }
            _ => Ok(a.equals(b)),
        }
    }

    fn suffixed(
        &mut self,
        first: &Expression,
        suffixes: &[Suffix],
    ) -> Result<ScriptValue, Stopped> {
        let mut rest = suffixes.iter();
        let mut span = first.span;
        let mut value = match (first.identifier(), suffixes.first()) {
            (Some(name), Some(suffix)) if let SuffixKind::Call(arguments) = &suffix.kind => {
                rest.next();
                span = span.to(suffix.span);
                self.call_name(name, arguments, span)?
            }
            _ => self.value(first)?,
        };
        for suffix in rest {
            span = span.to(suffix.span);
            value = match &suffix.kind {
                SuffixKind::Call(arguments) => self.call_value(&value, arguments, span)?,
                SuffixKind::Element(index) => {
                    let index_value = self.value(index)?;
                    self.element(&value, &index_value, span)?
                }
                SuffixKind::Modifiers(modifiers) => self.modified(&value, modifiers, span)?,
            };
        }
        Ok(value)
    }

    fn element(
        &mut self,
        value: &ScriptValue,
        index: &ScriptValue,
        span: Span,
    ) -> Result<ScriptValue, Stopped> {
        let (ScriptValue::List(list), ScriptValue::Integer(index)) = (value, index) else {
            let message = format!(
                "`[ ]` takes a List and an Integer, but these are values of type {} and {}",
                value.kind(),
                index.kind()
            );
            return Err(self.fault(codes::TYPE_MISMATCH, span, message));
        };
        let found = usize::try_from(*index).ok().and_then(|k| list.items.get(k));
        match found {
            Some(item) => Ok(item.clone()),
            None => {
                let message = match list.items.len() {
                    0 => format!("there is no element {index}: the list is empty"),
                    count => format!("there is no element {index}: the last one is {}", count - 1),
                };
                Err(self.fault(codes::INDEX_OUT_OF_RANGE, span, message))
            }
        }
    }

    /// Runs the body of a macro with its arguments, and returns the entities that it emits.
    pub(super) fn run_macro(
        &mut self,
        called: &MacroValue,
        arguments: Vec<ScriptValue>,
    ) -> Result<ScriptValue, Stopped> {
        let words = called.definition.parameters.iter();
        let bound: Vec<_> = words.zip(arguments).collect();
        for (word, value) in &bound {
            let place = word.span.moved(called.base);
            self.assigned(place, Binding::Value(value.clone()));
        }
        let names = bound.into_iter();
        let names = names.map(|(word, value)| (word.text.clone(), Binding::Value(value)));
        self.scopes.push(ScopeNames {
            parent: Some(called.scope),
            names: names.collect(),
            pointed: HashMap::new(),
        });
        let inner = self.scopes.len() - 1;
        let (scope, base) = (self.scope, self.base);
        (self.scope, self.base) = (inner, called.base);
        self.emitted.push(Emitted::default());
        self.nesting += 1;
        let done = self.body(&called.definition.body, true);
        self.nesting -= 1;
        if done.is_ok() {
            self.report_dangling();
        }
        let emitted = self.emitted.pop().unwrap_or_default().entities;
        (self.scope, self.base) = (scope, base);
        self.scopes.truncate(inner);
        done?;
        Ok(ScriptValue::List(Arc::new(List {
            items: emitted.into_iter().map(ScriptValue::Entity).collect(),
            depth: 1,
            is_emitted: true,
        })))
    }
}
