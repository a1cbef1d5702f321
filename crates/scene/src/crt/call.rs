//! Calls of macros and functions, set operations on entities, and modifiers.

use std::sync::Arc;

use geodesic::vector::norm;
use syntax::crt::objects::FUNCTIONS;
use syntax::crt::tree::{BinaryOperator, Expression, Modifier, ModifierKind};
use syntax::span::Span;

use super::entity::{Entity, Map, Node, SetOperation};
use super::run::{Interpreter, Stopped};
use super::value::ScriptValue;
use super::{MAX_CALLS, codes};

impl Interpreter<'_> {
    /// Calls a name: a macro if it denotes one, otherwise a function.
    pub(super) fn call_name(
        &mut self,
        name: &Arc<str>,
        arguments: &[Expression],
        span: Span,
    ) -> Result<ScriptValue, Stopped> {
        let known = self.known(name);
        if let Some(called @ ScriptValue::Macro(_)) = &known {
            return self.call_value(called, arguments, span);
        }
        let Some((_, parameters, _)) = FUNCTIONS.iter().find(|row| *row.0 == **name) else {
            let value = match known {
                Some(value) => value,
                None => self.value_of_name(name, span)?,
            };
            return self.call_value(&value, arguments, span);
        };
        let arguments = self.arguments(arguments)?;
        self.check_count(
            &format!("`{name}`"),
            parameters.len(),
            arguments.len(),
            span,
        )?;
        self.function(name, &arguments, span)
    }

    fn value_of_name(&mut self, name: &Arc<str>, span: Span) -> Result<ScriptValue, Stopped> {
        let kind = syntax::crt::tree::ExpressionKind::Identifier(name.clone());
        self.value(&Expression { kind, span })
    }

    fn arguments(&mut self, arguments: &[Expression]) -> Result<Vec<ScriptValue>, Stopped> {
        arguments.iter().map(|it| self.value(it)).collect()
    }

    fn check_count(
        &mut self,
        called: &str,
        expected: usize,
        given: usize,
        span: Span,
    ) -> Result<(), Stopped> {
        if expected == given {
            return Ok(());
        }
        let word = if expected == 1 {
            "argument"
        } else {
            "arguments"
        };
        let are = if given == 1 { "is" } else { "are" };
        let message = format!("{called} takes {expected} {word}, but {given} {are} given");
        Err(self.fault(codes::ARGUMENT_COUNT, span, message))
    }

    /// Calls a value.
    pub(super) fn call_value(
        &mut self,
        value: &ScriptValue,
        arguments: &[Expression],
        span: Span,
    ) -> Result<ScriptValue, Stopped> {
        let ScriptValue::Macro(called) = value else {
            let message = format!(
                "only a macro or a function can be called, but this is a value of type {}",
                value.kind()
            );
            return Err(self.fault(codes::NOT_A_MACRO, span, message));
        };
        let arguments = self.arguments(arguments)?;
        let expected = called.definition.parameters.len();
        self.check_count("the macro", expected, arguments.len(), span)?;
        self.count(span, "this call")?;
        if self.call_depth >= MAX_CALLS {
            let message = format!("calls within calls are limited to {MAX_CALLS}");
            return Err(self.fault(codes::CALL_DEPTH, span, message));
        }
        self.call_depth += 1;
        let emitted = self.run_macro(called, arguments);
        self.call_depth -= 1;
        emitted
    }

    fn function(
        &mut self,
        name: &str,
        arguments: &[ScriptValue],
        span: Span,
    ) -> Result<ScriptValue, Stopped> {
        match (name, arguments) {
            ("length", [ScriptValue::Vector(v)]) => {
                return Ok(ScriptValue::Float(norm(*v)));
            }
            ("length", [ScriptValue::List(list)]) => {
                return Ok(ScriptValue::Integer(list.items.len() as i32));
            }
            ("length", [ScriptValue::Text(text)]) => {
                self.spend_bytes(text, span)?;
                return Ok(ScriptValue::Integer(text.chars().count() as i32));
            }
            ("abs", [ScriptValue::Integer(number)]) => {
                return Ok(ScriptValue::Integer(number.wrapping_abs()));
            }
            ("floor", [ScriptValue::Integer(number)]) => return Ok(ScriptValue::Integer(*number)),
            _ => {}
        }
        let numbers: Option<Vec<f64>> = arguments.iter().map(ScriptValue::number).collect();
        let numbers = numbers.unwrap_or_default();
        Ok(match (name, &numbers[..]) {
            ("vec3", &[x, y, z]) => ScriptValue::Vector([x, y, z]),
            ("rgb", &[r, g, b]) | ("rgba", &[r, g, b, _]) => ScriptValue::Colour([r, g, b]),
            ("sin", [x]) => ScriptValue::Float(x.sin()),
            ("cos", [x]) => ScriptValue::Float(x.cos()),
            ("tan", [x]) => ScriptValue::Float(x.tan()),
            ("sqrt", [x]) => ScriptValue::Float(x.sqrt()),
            ("abs", [x]) => ScriptValue::Float(x.abs()),
            ("floor", [x]) => {
                let down = x.floor();
                let is_whole = (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&down);
                match is_whole {
                    true => ScriptValue::Integer(down as i32),
                    false => ScriptValue::Float(down),
                }
            }
            ("pow", &[x, y]) => ScriptValue::Float(x.powf(y)),
            ("rand", &[a, b]) => {
                ScriptValue::Float(self.random.number() * (a - b).abs() + a.min(b))
            }
            _ => {
                let kinds: Vec<&str> = arguments.iter().map(ScriptValue::kind).collect();
                let message = format!("`{name}` does not take values of type {}", kinds.join(", "));
                return Err(self.fault(codes::TYPE_MISMATCH, span, message));
            }
        })
    }

    /// Returns the entity of an operand: the operand itself, or the union of a list.
    fn operand(&mut self, value: &ScriptValue, span: Span) -> Result<Option<Arc<Entity>>, Stopped> {
        if let ScriptValue::Entity(entity) = value {
            return Ok(Some(entity.clone()));
        }
        let Some(entities) = value.entities() else {
            return Ok(None);
        };
        let mut entities = entities.into_iter();
        let Some(mut all) = entities.next() else {
            let message = "this list has no entities, but a set operation needs at least one";
            return Err(self.fault(codes::TYPE_MISMATCH, span, message));
        };
        for next in entities {
            all = self.set(SetOperation::Union, all, next, span)?;
        }
        Ok(Some(all))
    }

    fn set(
        &mut self,
        operation: SetOperation,
        a: Arc<Entity>,
        b: Arc<Entity>,
        span: Span,
    ) -> Result<Arc<Entity>, Stopped> {
        self.leaves(a.leaves + b.leaves, span)?;
        self.count_object();
        let node = Arc::new(Node::Set(operation, a, b));
        Ok(Arc::new(Entity::of(node, self.id())))
    }

    /// Applies `+`, `-` and `^` to entities; `None` for other values.
    pub(super) fn joined_entities(
        &mut self,
        operator: BinaryOperator,
        a: &ScriptValue,
        b: &ScriptValue,
        span: Span,
    ) -> Result<Option<ScriptValue>, Stopped> {
        let operation = match operator {
            BinaryOperator::Add => SetOperation::Union,
            BinaryOperator::Subtract => SetOperation::Difference,
            BinaryOperator::Intersect => SetOperation::Intersection,
            _ => return Ok(None),
        };
        let is_list =
            |value: &ScriptValue| matches!(value, ScriptValue::List(_) | ScriptValue::Entity(_));
        if !is_list(a) || !is_list(b) {
            return Ok(None);
        }
        let (Some(a), Some(b)) = (self.operand(a, span)?, self.operand(b, span)?) else {
            return Ok(None);
        };
        let joined = self.set(operation, a, b, span)?;
        Ok(Some(ScriptValue::Entity(joined)))
    }

    /// Applies modifiers to an entity, or to the union of a list of entities.
    pub(super) fn modified(
        &mut self,
        value: &ScriptValue,
        modifiers: &[Modifier],
        span: Span,
    ) -> Result<ScriptValue, Stopped> {
        let Some(entity) = self.operand(value, span)? else {
            let message = format!(
                "only entities can be scaled, moved and rotated, but this is a value of type {}",
                value.kind()
            );
            return Err(self.fault(codes::TYPE_MISMATCH, span, message));
        };
        let mut map = Map::IDENTITY;
        for modifier in modifiers {
            let by = self.value(&modifier.value)?;
            let next = match (modifier.kind, &by) {
                (ModifierKind::Scale, ScriptValue::Vector(v)) => Map::scale(*v),
                (ModifierKind::Translate, ScriptValue::Vector(v)) => Map::translate(*v),
                (ModifierKind::Rotate, ScriptValue::Vector(v)) => Map::rotate(*v),
                (ModifierKind::Scale, other) if other.number().is_some() => {
                    Map::scale([other.number().unwrap_or(1.0); 3])
                }
                (kind, other) => {
                    let needs = match kind {
                        ModifierKind::Scale => "`scale` takes a Vector or a number",
                        ModifierKind::Translate => "`translate` takes a Vector",
                        ModifierKind::Rotate => "`rotate` takes a Vector",
                    };
                    let message = format!("{needs}, but this is a value of type {}", other.kind());
                    return Err(self.fault(codes::TYPE_MISMATCH, modifier.span, message));
                }
            };
            map = next.after(&map);
        }
        let id = self.id();
        Ok(ScriptValue::Entity(Arc::new(entity.placed(&map, id))))
    }
}
