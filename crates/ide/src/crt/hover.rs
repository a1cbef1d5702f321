//! Descriptions of the words of a script.

use syntax::crt::objects::{FUNCTIONS, ObjectAttribute, ObjectName, ValueType};
use syntax::crt::token::TokenKind;
use syntax::span::Span;

use super::CrtAnalysis;
use super::names::{Origin, VariableId};
use crate::description::Description;

/// The description of the word at a place.
pub(super) fn hover(analysis: &CrtAnalysis, offset: u32) -> Option<(Span, Description)> {
    let token = analysis.word_at(offset)?;
    let word = analysis.slice(token.span);
    let names = analysis.names();
    let found = match token.kind {
        TokenKind::Name => object(ObjectName::from_text(&word)?),
        TokenKind::Settings => object(ObjectName::Settings),
        TokenKind::Identifier => match names.object_of(token.span) {
            Some(place) => attribute(place.object?.attribute(&word)?),
            None => match names.variable_at(offset) {
                Some((_, variable)) => describe_variable(analysis, variable),
                None => function(&word)?,
            },
        },
        kind => describe(kind.text()?, keyword(kind)?.to_owned()),
    };
    Some((token.span, found))
}

fn describe(code: &str, text: String) -> Description {
    Description {
        language: super::NAME,
        code: code.to_owned(),
        text: vec![text],
    }
}

/// The description of an object with its attributes.
pub(super) fn object(object: ObjectName) -> Description {
    let rows = object.attributes().iter().map(|row| {
        let note = match row.default.text() {
            None => "required".to_owned(),
            Some(default) => format!("default `{default}`"),
        };
        format!("- `{}`: {} ({note})", row.text, row.purpose)
    });
    let mut description = describe(object.text(), format!("{}.", capital(object.purpose())));
    description.text.push(rows.collect::<Vec<_>>().join("\n"));
    description
}

/// The description of an attribute: its type, range, unit and default.
pub(super) fn attribute(row: &ObjectAttribute) -> Description {
    let code = format!("{} -> {}", row.text, value_type(row.value));
    let mut text = format!("{} of `{}`.", capital(row.purpose), row.object.text());
    if !row.unit.is_empty() {
        text.push_str(&format!(" In {}.", row.unit));
    }
    let range = match row.value {
        ValueType::Number(range) | ValueType::Integer(range) => match range.text() {
            Some(text) => Some(text.to_owned()),
            None if range.max < f64::INFINITY => {
                let sign = if range.is_open { ">" } else { "≥" };
                Some(format!("{sign} {} and ≤ {}", range.min, range.max))
            }
            None => None,
        },
        ValueType::Choice(words) => Some(words.join(", ")),
        _ => None,
    };
    let mut description = describe(&code, text);
    description
        .text
        .extend(range.map(|range| format!("Range: {range}.")));
    description.text.push(match row.default.text() {
        None => "Required.".to_owned(),
        Some(default) => format!("Default: `{default}`."),
    });
    description
}

fn value_type(value: ValueType) -> &'static str {
    match value {
        ValueType::Number(_) => "Float",
        ValueType::Integer(_) => "Integer",
        ValueType::Vector => "Vector",
        ValueType::Color => "Color",
        ValueType::Text | ValueType::Choice(_) | ValueType::Image => "String",
        ValueType::Material => "Material",
        ValueType::Background => "Background",
        ValueType::Camera => "Camera",
        ValueType::Lights => "List of Light",
    }
}

/// The description of a function that every script has.
pub(super) fn function(word: &str) -> Option<Description> {
    let (name, arguments, purpose) = FUNCTIONS.iter().find(|(name, ..)| *name == word)?;
    let code = format!("{name}({})", arguments.join(", "));
    Some(describe(&code, format!("{}.", capital(purpose))))
}

/// The description of a variable: what it was given, and where it stands.
pub(super) fn describe_variable(analysis: &CrtAnalysis, id: VariableId) -> Description {
    let names = analysis.names();
    let variable = names.variable(id);
    let text = analysis.slice(variable.assignment);
    let code = text.lines().next().unwrap_or_default().to_owned();
    let what = match variable.origin {
        Origin::Parameter => "A parameter of a macro".to_owned(),
        Origin::Macro => "A macro".to_owned(),
        Origin::Object(object) => capital(object.purpose()),
        Origin::Value => "A variable".to_owned(),
    };
    let line = analysis.snapshot_text().line(variable.assignment.start);
    let occurrences = names.occurrences(id);
    let bound = occurrences.iter().filter(|it| it.introduces).count();
    let place = match (bound, variable.scope) {
        (0 | 1, _) if variable.origin == Origin::Parameter => String::new(),
        (0 | 1, _) => format!(", assigned in line {line}"),
        (count, _) => format!(", assigned {count} times, first in line {line}"),
    };
    describe(&code, format!("{what}{place}."))
}

fn keyword(kind: TokenKind) -> Option<&'static str> {
    Some(match kind {
        TokenKind::Scene => {
            "The block that draws: each statement whose value is an entity emits it."
        }
        TokenKind::Macro => "A macro: a call gives the list of the entities that its body emits.",
        TokenKind::Scale => "Scales by a number, or by one along each axis, about the origin.",
        TokenKind::Translate => "Moves by a vector.",
        TokenKind::Rotate => "Turns by degrees about x, then y, then z, about the origin.",
        TokenKind::While => "Repeats its body while the condition is true.",
        TokenKind::If | TokenKind::Else => "Runs one of two bodies.",
        _ => return None,
    })
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|first| first.to_ascii_uppercase());
    first.into_iter().chain(letters).collect()
}
