//! Operators on values.
//!
//! In: one or two values. Out: a value, or the code and the message of an error.

use std::sync::Arc;

use syntax::crt::tree::{BinaryOperator as B, PrefixOperator};
use syntax::diagnostic::Code;

use super::value::ScriptValue;
use super::{MAX_SIZE, codes};

/// An error in an operation.
pub(super) type Fault = (Code, String);

/// Applies an operator to one operand.
pub(super) fn prefix(operator: PrefixOperator, value: &ScriptValue) -> Result<ScriptValue, Fault> {
    Ok(match (operator, value) {
        (
            PrefixOperator::Plus,
            ScriptValue::Integer(_) | ScriptValue::Float(_) | ScriptValue::Vector(_),
        ) => value.clone(),
        (PrefixOperator::Minus, ScriptValue::Integer(number)) => {
            ScriptValue::Integer(number.wrapping_neg())
        }
        (PrefixOperator::Minus, ScriptValue::Float(number)) => ScriptValue::Float(-number),
        (PrefixOperator::Minus, ScriptValue::Vector(vector)) => {
            ScriptValue::Vector(vector.map(|x| -x))
        }
        (PrefixOperator::Not, ScriptValue::Boolean(truth)) => ScriptValue::Boolean(!truth),
        (PrefixOperator::Not, other) => {
            let message = format!(
                "`!` takes a Boolean, but this is a value of type {}",
                other.kind()
            );
            return Err((codes::TYPE_MISMATCH, message));
        }
        (_, other) => {
            let message = format!(
                "a sign takes a number or a Vector, but this is a value of type {}",
                other.kind()
            );
            return Err((codes::TYPE_MISMATCH, message));
        }
    })
}

/// Applies an operator other than `==` and `!=` to two operands that are not entities.
pub(super) fn binary(operator: B, a: &ScriptValue, b: &ScriptValue) -> Result<ScriptValue, Fault> {
    let mismatch = || {
        let message = format!(
            "`{}` does not take values of type {} and {}",
            operator.text(),
            a.kind(),
            b.kind()
        );
        Err((codes::TYPE_MISMATCH, message))
    };
    match operator {
        B::And | B::Or => {
            return match (a, b) {
                (ScriptValue::Boolean(a), ScriptValue::Boolean(b)) if operator == B::And => {
                    Ok(ScriptValue::Boolean(*a && *b))
                }
                (ScriptValue::Boolean(a), ScriptValue::Boolean(b)) => {
                    Ok(ScriptValue::Boolean(*a || *b))
                }
                _ => mismatch(),
            };
        }
        _ => {}
    }
    if let (ScriptValue::Integer(a), ScriptValue::Integer(b)) = (a, b) {
        return integers(operator, *a, *b).unwrap_or_else(mismatch);
    }
    if let (Some(a), Some(b)) = (a.number(), b.number()) {
        return floats(operator, a, b).map_or_else(mismatch, Ok);
    }
    match (operator, a, b) {
        (B::Add, ScriptValue::Text(_), _) | (B::Add, _, ScriptValue::Text(_)) => {
            match (a.simple_text(), b.simple_text()) {
                (Some(a), Some(b)) => text(a + &b),
                _ => mismatch(),
            }
        }
        (B::Multiply, ScriptValue::Text(part), ScriptValue::Integer(count)) => {
            let count = u64::try_from(*count).unwrap_or(0);
            if (part.len() as u64).saturating_mul(count) > MAX_SIZE {
                return Err(too_long());
            }
            text(part.repeat(count as usize))
        }
        (B::Add | B::Subtract, ScriptValue::Vector(a), ScriptValue::Vector(b)) => {
            Ok(ScriptValue::Vector(joined(operator, a, b)))
        }
        (B::Add | B::Subtract, ScriptValue::Colour(a), ScriptValue::Colour(b)) => {
            Ok(ScriptValue::Colour(joined(operator, a, b)))
        }
        (B::Multiply | B::Divide, ScriptValue::Vector(v), other) => match other.number() {
            Some(by) => Ok(ScriptValue::Vector(scaled(operator, v, by))),
            None => mismatch(),
        },
        (B::Multiply | B::Divide, ScriptValue::Colour(c), other) => match other.number() {
            Some(by) => Ok(ScriptValue::Colour(scaled(operator, c, by))),
            None => mismatch(),
        },
        (B::Multiply, other, ScriptValue::Vector(v)) => match other.number() {
            Some(by) => Ok(ScriptValue::Vector(scaled(operator, v, by))),
            None => mismatch(),
        },
        (B::Multiply, other, ScriptValue::Colour(c)) => match other.number() {
            Some(by) => Ok(ScriptValue::Colour(scaled(operator, c, by))),
            None => mismatch(),
        },
        _ => mismatch(),
    }
}

fn too_long() -> Fault {
    let message = format!("a string has at most {MAX_SIZE} bytes");
    (codes::TOO_LARGE, message)
}

fn text(text: String) -> Result<ScriptValue, Fault> {
    if text.len() as u64 > MAX_SIZE {
        return Err(too_long());
    }
    Ok(ScriptValue::Text(Arc::from(text)))
}

/// Applies an operator to integers; `None` if it does not take numbers.
fn integers(operator: B, a: i32, b: i32) -> Option<Result<ScriptValue, Fault>> {
    let by_zero = || {
        let message = format!("`{}` divides a whole number by 0", operator.text());
        Err((codes::DIVISION_BY_ZERO, message))
    };
    Some(Ok(match operator {
        B::Add => ScriptValue::Integer(a.wrapping_add(b)),
        B::Subtract => ScriptValue::Integer(a.wrapping_sub(b)),
        B::Multiply => ScriptValue::Integer(a.wrapping_mul(b)),
        B::Divide | B::Remainder if b == 0 => return Some(by_zero()),
        B::Divide => ScriptValue::Integer(a.wrapping_div(b)),
        B::Remainder => ScriptValue::Integer(a.wrapping_rem(b)),
        B::Less => ScriptValue::Boolean(a < b),
        B::LessEqual => ScriptValue::Boolean(a <= b),
        B::Greater => ScriptValue::Boolean(a > b),
        B::GreaterEqual => ScriptValue::Boolean(a >= b),
        _ => return None,
    }))
}

fn floats(operator: B, a: f64, b: f64) -> Option<ScriptValue> {
    Some(match operator {
        B::Add => ScriptValue::Float(a + b),
        B::Subtract => ScriptValue::Float(a - b),
        B::Multiply => ScriptValue::Float(a * b),
        B::Divide => ScriptValue::Float(a / b),
        B::Remainder => ScriptValue::Float(a % b),
        B::Less => ScriptValue::Boolean(a < b),
        B::LessEqual => ScriptValue::Boolean(a <= b),
        B::Greater => ScriptValue::Boolean(a > b),
        B::GreaterEqual => ScriptValue::Boolean(a >= b),
        _ => return None,
    })
}

fn joined(operator: B, a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    let sign = if operator == B::Subtract { -1.0 } else { 1.0 };
    [0, 1, 2].map(|k| a[k] + sign * b[k])
}

fn scaled(operator: B, vector: &[f64; 3], by: f64) -> [f64; 3] {
    vector.map(|x| {
        if operator == B::Divide {
            x / by
        } else {
            x * by
        }
    })
}
