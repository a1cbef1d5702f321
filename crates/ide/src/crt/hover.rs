//! Descriptions of the words of a script.

use expr::number::rounded;
use scene::crt::{Assignment, EntityExtent};
use syntax::crt::objects::{DefaultValue, FUNCTIONS, ObjectAttribute, ObjectName, ValueType};
use syntax::crt::token::TokenKind;
use syntax::span::Span;
use syntax::text::capitalised;

use super::CrtAnalysis;
use super::names::{Origin, VariableId};
use crate::description::Description;

/// The name of the frame.
pub(super) const FRAME_NAME: &str = "t";
const FRAME: &str = "The frame: 0 unless set by the slider `t` of the window, by `--set t=V` or by `--animate t=0:19`. The script is run again for each value.";

/// Returns the description of the word at an offset.
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
                None if word == FRAME_NAME => frame(),
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

/// Returns the description of `t`.
pub(super) fn frame() -> Description {
    describe(FRAME_NAME, FRAME.to_owned())
}

/// Returns the description of an object with its attributes.
pub(super) fn object(object: ObjectName) -> Description {
    let rows = object.attributes().iter().map(|row| {
        let note = match default_value(row.default) {
            None => "required".to_owned(),
            Some(default) => format!("default: {default}"),
        };
        format!("- `{}`: {} ({note})", row.text, row.purpose)
    });
    let mut description = describe(object.text(), format!("{}.", capitalised(object.purpose())));
    description.text.push(rows.collect::<Vec<_>>().join("\n"));
    description
}

/// Returns the description of an attribute: its type, range, unit and default.
pub(super) fn attribute(row: &ObjectAttribute) -> Description {
    let code = format!("{} -> {}", row.text, value_type(row.value));
    let mut text = format!("Attribute of `{}`: {}.", row.object.text(), row.purpose);
    if !row.unit.is_empty() {
        text.push_str(&format!(" Unit: {}.", row.unit));
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
    description.text.push(match default_value(row.default) {
        None => "Required.".to_owned(),
        Some(default) => format!("Default: {default}."),
    });
    description
}

/// Returns a default value as code, or the phrase that describes it; `None` if the attribute is required.
fn default_value(default: DefaultValue) -> Option<String> {
    match default {
        DefaultValue::Phrase(phrase) => Some(phrase.to_owned()),
        value => value.text().map(|text| format!("`{text}`")),
    }
}

fn value_type(value: ValueType) -> &'static str {
    match value {
        ValueType::Number(_) => "Float",
        ValueType::Integer(_) => "Integer",
        ValueType::Vector => "Vector",
        ValueType::Colour => "Color",
        ValueType::Text | ValueType::Choice(_) | ValueType::Image => "String",
        ValueType::Material => "Material",
        ValueType::Background => "Background",
        ValueType::Camera => "Camera",
        ValueType::Lights => "List of Light",
    }
}

/// Returns the description of a builtin function.
pub(super) fn function(word: &str) -> Option<Description> {
    let (name, arguments, purpose) = FUNCTIONS.iter().find(|(name, ..)| *name == word)?;
    let code = format!("{name}({})", arguments.join(", "));
    Some(describe(&code, format!("{}.", capitalised(purpose))))
}

/// Returns the description of a variable: its first value, and its definition.
pub(super) fn describe_variable(analysis: &CrtAnalysis, id: VariableId) -> Description {
    let names = analysis.names();
    let variable = names.variable(id);
    let text = analysis.slice(variable.assignment);
    let code = text.lines().next().unwrap_or_default().to_owned();
    let what = match variable.origin {
        Origin::Parameter => "A parameter of a macro".to_owned(),
        Origin::Macro => "A macro".to_owned(),
        Origin::Object(object) => capitalised(object.purpose()),
        Origin::Value => "A variable".to_owned(),
    };
    let line = analysis.snapshot_text().line(variable.assignment.start);
    let bound = names.bindings(id).count();
    let place = match (bound, variable.scope) {
        (0 | 1, _) if variable.origin == Origin::Parameter => String::new(),
        (0 | 1, _) => format!(", assigned in line {line}"),
        (count, _) => format!(", assigned in {count} places, first in line {line}"),
    };
    let mut description = describe(&code, format!("{what}{place}."));
    description.text.extend(last_value(analysis, id));
    description
}

/// Returns the final value of a variable in the run, the number of its assignments, and the last assignment. `None` for a
/// script that is not run.
fn last_value(analysis: &CrtAnalysis, id: VariableId) -> Option<String> {
    let assignments = analysis.assignments()?;
    let found = analysis.names().bindings(id).filter_map(|(name, whole)| {
        let at = assignments.binary_search_by_key(&name, |it| it.span);
        Some((&assignments[at.ok()?], whole))
    });
    let found: Vec<(&Assignment, Span)> = found.collect();
    let Some((last, whole)) = found.iter().max_by_key(|(it, _)| it.last) else {
        return Some("The run does not reach this.".to_owned());
    };
    let times: u32 = found.iter().map(|(it, _)| it.count).sum();
    let variable = analysis.names().variable(id);
    let is_parameter = variable.origin == Origin::Parameter && *whole == variable.assignment;
    let line = analysis.snapshot_text().line(whole.start);
    let source = analysis.slice(*whole);
    let source = source.lines().next().unwrap_or_default();
    let mut text = match last.kind() {
        None => match pointed(source) {
            Some(other) => format!("No value: `{other}` has none"),
            None => "No value: the run ends in an error there".to_owned(),
        },
        Some(kind) => {
            let word = if times == 1 { "Value" } else { "Last value" };
            match last.entity() {
                None => format!("{word}: `{}`, {} {kind}", last.text(), article(kind)),
                Some(entity) => format!("{word}: {}", describe_entity(&entity)),
            }
        }
    };
    text.push_str(&match (is_parameter, times) {
        (true, 1) => ", in the only call".to_owned(),
        (true, times) => format!(", in the last of {times} calls"),
        (false, 1) if found.len() == 1 && *whole == variable.assignment => String::new(),
        (false, 1) => format!(", from `{source}` in line {line}"),
        (false, times) => {
            format!(", from `{source}` in line {line}; assigned {times} times in the run")
        }
    });
    text.push('.');
    Some(text)
}

/// Returns the name to which an assignment makes its own point.
fn pointed(assignment: &str) -> Option<&str> {
    let (_, source) = assignment.split_once('=')?;
    let name = source.trim_matches(|c: char| c.is_whitespace() || "()".contains(c));
    let is_name = name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.chars().all(|c| c.is_ascii_alphanumeric());
    is_name.then_some(name)
}

fn article(kind: &str) -> &'static str {
    match kind.starts_with(['A', 'E', 'I', 'O', 'U']) {
        true => "an",
        false => "a",
    }
}

/// `union of 3 leaves, x from −1 to 1, …`.
fn describe_entity(entity: &EntityExtent) -> String {
    let leaves = match entity.leaves {
        1 => String::new(),
        leaves => format!(" of {leaves} leaves"),
    };
    let what = &entity.what;
    // "Union" begins with a consonant sound.
    let article = match &**what {
        "union" => "a",
        what => article(&capitalised(what)),
    };
    let Some(bounds) = entity.bounds else {
        return format!("{article} {what}{leaves}, which is empty");
    };
    let sides = bounds
        .iter()
        .zip(["x", "y", "z"])
        .map(
            |([least, most], axis)| match (least.is_finite(), most.is_finite()) {
                (true, true) => format!("{axis} from {} to {}", short(*least), short(*most)),
                (true, false) => format!("{axis} from {}", short(*least)),
                (false, true) => format!("{axis} to {}", short(*most)),
                (false, false) => format!("{axis} without bounds"),
            },
        );
    let sides: Vec<String> = sides.collect();
    format!("{article} {what}{leaves}; in the box {}", sides.join(", "))
}

/// Returns a number to six significant digits, without trailing zeros.
fn short(number: f64) -> String {
    // No minus sign before a zero.
    (rounded(number, 6) + 0.0).to_string()
}

fn keyword(kind: TokenKind) -> Option<&'static str> {
    Some(match kind {
        TokenKind::Scene => {
            "The block that draws: each statement whose value is an entity draws it."
        }
        TokenKind::Macro => "A macro: a call gives the list of the entities that its body emits.",
        TokenKind::Scale => "Scales by a number, or by one along each axis, about the origin.",
        TokenKind::Translate => "Moves by a vector.",
        TokenKind::Rotate => "Rotates by degrees about x, then y, then z, about the origin.",
        TokenKind::While => "Repeats its body while the condition is true.",
        TokenKind::If | TokenKind::Else => "Runs one of two bodies.",
        _ => return None,
    })
}
