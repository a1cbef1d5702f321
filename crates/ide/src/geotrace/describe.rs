//! Descriptions of names: signature, value, geometry.

use expr::NodeId;
use expr::ops::{self, Binary};
use scene::{ParamValues, Shape, Value};
use syntax::attribute_range::AttributeRange;
use syntax::geotrace::attributes::{AttributeRow, AttributeType};
use syntax::geotrace::declarations::{Category, DeclarationKeyword};
use syntax::geotrace::symbols::{Symbol, SymbolKind};
use syntax::geotrace::token::{MapWord, TokenKind};
use syntax::span::Span;
use syntax::symbol::SymbolId;

use super::NAME;
use super::analysis::GeotraceAnalysis;
use super::application;
use super::edit_param;
use super::geometry;
use super::hints::{constant, shown};
use super::item::Item;
use super::outline::parameters;
use super::solid;
use super::start;
use super::targets::Target;
use crate::description::Description;

/// Returns a description in the Geotrace language.
pub(crate) fn description(
    code: impl Into<String>,
    text: impl IntoIterator<Item = String>,
) -> Description {
    Description {
        language: NAME,
        code: code.into(),
        text: text.into_iter().collect(),
    }
}

/// Describes a declaration keyword by its example and its purpose.
pub(crate) fn keyword(keyword: DeclarationKeyword) -> Description {
    let row = keyword.row();
    description(row.example, [row.purpose.to_owned()])
}

/// Describes a map of a set.
pub(crate) fn map(map: MapWord) -> Description {
    let (example, purpose) = match map {
        MapWord::Scale => (
            "solid small = ball @ scale 0.5;",
            "scales a set about the origin: by a number, or by (a, b, c) along the axes",
        ),
        MapWord::Rotate => (
            "solid turned = ball @ rotate (0, 0, pi/4);",
            "rotates a set about a vector through the origin, by the vector's length in radians, counterclockwise as seen from its tip",
        ),
    };
    description(example, [purpose.to_owned()])
}

/// Describes an attribute.
pub(crate) fn attribute(row: &AttributeRow) -> Description {
    description(
        row.example,
        [row.purpose.to_owned(), range_and_default(row)],
    )
}

/// Returns the values that an attribute can have, and its default.
pub(crate) fn range_and_default(row: &AttributeRow) -> String {
    let range = |range: AttributeRange| range.text().unwrap_or("any number");
    let values = match row.value {
        AttributeType::Number(numbers) => range(numbers).to_owned(),
        AttributeType::Colour(numbers) => format!("{}, or three of them", range(numbers)),
        AttributeType::Pair => "two numbers".to_owned(),
        AttributeType::Choice(words) => words.join(" "),
        AttributeType::Name => "a word".to_owned(),
    };
    format!("{values}; default: {}", row.default)
}

/// The maximum length in bytes of a value that is repeated in the description of its attribute.
const LONGEST_VALUE: usize = 120;

/// Describes the attribute whose word, or word as a value, is a token: the attribute as it is stated, its purpose, and its
/// value if that is an expression.
pub(crate) fn stated_attribute(analysis: &GeotraceAnalysis, token: usize) -> Option<Description> {
    let place = analysis.token(token)?.span;
    let item = analysis.item_at(place.start)?;
    let mut words = analysis.tokens_before(token + 1);
    let word = words.find_map(|before| match before.kind {
        TokenKind::Attribute(word) => Some(word),
        _ => None,
    })?;
    let row = word.row(item.keyword).or_else(|| word.rows().next())?;
    let mut description = attribute(row);
    let stated = item
        .attributes()
        .find(|(_, word, value)| *word == place || *value == place);
    if let Some((word, _, value)) = stated {
        let text = analysis.slice(value);
        let words: Vec<&str> = text.split_whitespace().collect();
        description.code = match words.join(" ") {
            value if (1..=LONGEST_VALUE).contains(&value.len()) => {
                format!("{} : {value}", row.text)
            }
            _ => row.text.to_owned(),
        };
        if !word.is_key() {
            description.text.extend(application::value(analysis, value));
        }
    }
    Some(description)
}

/// Describes a target.
pub(super) fn describe(analysis: &GeotraceAnalysis, target: Target) -> Option<Description> {
    match target {
        Target::Symbol(id) => match analysis.item_of(id).and_then(|k| analysis.item(k)) {
            Some(item) => Some(declared(analysis, &item)),
            None => builtin(analysis.symbol(id)?),
        },
        Target::Parameter { item, position } => {
            let item = analysis.item(item)?;
            let parameter = item.variables().nth(position)?;
            let owner = format!("{}{}", item.name, signature(&item));
            let mut text = vec![format!(
                "a parameter of the {} `{owner}`",
                item.keyword.text()
            )];
            text.extend(interval_of(analysis, &item, parameter).map(|i| format!("over `{i}`")));
            Some(description(parameter, text))
        }
    }
}

fn signature(item: &Item<'_>) -> String {
    parameters(item.parameters().map(|(name, _)| name))
}

/// Returns the interval of a parameter, as written.
fn interval_of(analysis: &GeotraceAnalysis, item: &Item<'_>, name: &str) -> Option<String> {
    // Intervals have tags and come in any order.
    let text = analysis.slice(item.span);
    let place =
        |span: Span| (span.start - item.span.start) as usize..(span.end - item.span.start) as usize;
    item.intervals().find_map(|span| {
        let range = place(span);
        let before = text[..range.start].trim_end();
        let tag = before.strip_suffix(':')?.trim_end();
        let word = tag.rsplit(|c: char| !c.is_ascii_alphanumeric()).next()?;
        (word == name).then(|| text[range].to_owned())
    })
}

fn declared(analysis: &GeotraceAnalysis, item: &Item<'_>) -> Description {
    let code = format!("{} {}{}", item.keyword.text(), item.name, signature(item));
    let mut text = Vec::new();
    if item.faulty {
        text.push("This declaration has an error.".to_owned());
        return description(code, text);
    }
    match item.keyword.category() {
        Category::Slider => {
            let intervals = written_intervals(analysis, item);
            let [sliders, start, minimum] = match item.intervals().count() {
                1 => ["a slider", "it starts", "its minimum"],
                _ => ["sliders", "they start", "their minima"],
            };
            let value = match edit_param::initial_value(analysis, item) {
                Some(span) => format!("`{}`", analysis.slice(span)),
                None => minimum.to_owned(),
            };
            text.push(format!("{sliders} over {intervals}; {start} at {value}"));
        }
        Category::Grid => {
            let intervals = written_intervals(analysis, item);
            text.push(format!(
                "the values {intervals}: objects that depend on it are drawn once for each"
            ));
        }
        Category::Constant => text.extend(value(analysis, item)),
        Category::Function => {}
        Category::Solid => text.extend(solid::describe(analysis, item)),
        Category::Stage => text.extend(stage(analysis, item)),
        Category::Curve | Category::Surface | Category::Metric => {
            let lines = item.parameters().filter_map(|(name, _)| {
                let interval = interval_of(analysis, item, name)?;
                Some(format!("`{name} : {interval}`"))
            });
            let lines: Vec<String> = lines.collect();
            if !lines.is_empty() {
                text.push(format!("over {}", lines.join(", ")));
            }
            text.extend(geometry::of(analysis, item));
        }
    }
    text.extend(comment_above(analysis, item));
    description(code, text)
}

fn written_intervals(analysis: &GeotraceAnalysis, item: &Item<'_>) -> String {
    let intervals = item.intervals();
    let intervals = intervals.map(|span| format!("`{}`", analysis.slice(span)));
    intervals.collect::<Vec<_>>().join(" × ")
}

/// Returns the value of a constant; if params change it, at their start.
fn value(analysis: &GeotraceAnalysis, item: &Item<'_>) -> Option<String> {
    let excerpt = analysis.excerpt([item.index]);
    if let Some(value) = constant(&excerpt, item.name) {
        return Some(format!("= {value}{}", start::of_scene(excerpt.scene())));
    }
    let values = ParamValues::initial(excerpt.scene());
    let scene::Outcome::Instances(instances) = excerpt.value(item.name, &values)? else {
        return None;
    };
    let first = instances.first()?;
    Some(format!(
        "{} values, one for each value of the grids; the first is {}{}",
        instances.len(),
        shown(&first.value),
        start::of_scene(excerpt.scene())
    ))
}

/// Describes a light, a camera or a background.
fn stage(analysis: &GeotraceAnalysis, item: &Item<'_>) -> Option<String> {
    let excerpt = analysis.excerpt([item.index]);
    let scene = excerpt.scene();
    let object = scene.stage.iter().find(|object| object.name == item.name)?;
    let uniforms = ParamValues::initial(scene).first_instance(scene, object);
    let vector = |nodes: [NodeId; 3]| {
        let numbers = solid::values(scene, nodes, &uniforms)?;
        Some(shown(&Value::Vector(numbers.map(Some).to_vec())))
    };
    let told = match &object.shape {
        Shape::Light(light) => {
            let place = light.position.map(vector);
            match (light.direction.map(vector), place) {
                (None, Some(place)) => format!("shines in all directions from {}", place?),
                (Some(direction), None) => format!("shines along {} everywhere", direction?),
                (Some(direction), Some(place)) => {
                    format!("shines along {} from {}", direction?, place?)
                }
                (None, None) => return None,
            }
        }
        Shape::Camera(camera) => format!(
            "looks along {} from {}",
            vector(camera.direction)?,
            vector(camera.position)?
        ),
        Shape::Background(background) if item.parameters().len() == 0 => {
            format!("the colour {}", vector(background.colour)?)
        }
        Shape::Background(_) => "a colour for each unit direction".to_owned(),
        _ => return None,
    };
    Some(format!("{told}{}", start::of_object(scene, object)))
}

/// Returns the comment right above a declaration, or after it on its line.
fn comment_above(analysis: &GeotraceAnalysis, item: &Item<'_>) -> Option<String> {
    let document = analysis.document();
    // Returns the part of a line, from 1, before an offset.
    let line = |number: u32, end: u32| {
        let start = document.line_start(number)?;
        let next = document.line_start(number + 1).unwrap_or(document.len());
        document.slice(Span::new(start, next.min(end).max(start)))
    };
    let own = document.line(item.span.start);
    let mut lines: Vec<String> = Vec::new();
    if line(own, item.span.start)?.trim().is_empty() {
        for number in (1..own).rev() {
            let above = line(number, item.span.start)?;
            match above.trim().strip_prefix('#') {
                Some(comment) => lines.push(comment.trim().to_owned()),
                None => break,
            }
        }
        lines.reverse();
    }
    if lines.is_empty() {
        let last = document.line(item.span.end);
        let end = document.line_start(last + 1).unwrap_or(document.len());
        let behind = document.slice(Span::new(item.span.end, end))?;
        lines.extend(
            behind
                .trim()
                .strip_prefix('#')
                .map(|it| it.trim().to_owned()),
        );
    }
    let comment = lines.join(" ");
    (!comment.is_empty()).then_some(comment)
}

/// Returns the description of a builtin name.
fn builtin(symbol: &Symbol) -> Option<Description> {
    let name = &*symbol.name;
    if symbol.kind == SymbolKind::Constant {
        let (_, _, doc) = ops::CONSTANTS
            .into_iter()
            .find(|(known, ..)| **known == *name)?;
        return Some(description(name, [doc.to_owned()]));
    }
    let extreme = [Binary::Min, Binary::Max];
    if let Some(op) = extreme.into_iter().find(|op| op.name() == name) {
        let text = [
            format!(
                "The {} component of a vector.",
                match op {
                    Binary::Min => "least",
                    _ => "greatest",
                }
            ),
            "derivative: that of the first component to attain it".to_owned(),
        ];
        return Some(description(format!("{name}(a, b, …)"), text));
    }
    let text = match ops::builtin(name) {
        Some(operation) => {
            let row = operation.row();
            vec![
                row.doc.to_owned(),
                format!("derivative: `{}`", row.derivative),
            ]
        }
        None => vec!["The identity: gives its operand, a number or a vector.".to_owned()],
    };
    Some(description(format!("{name} x"), text))
}

/// Returns the description of a symbol, for a list of completions.
pub(crate) fn of_symbol(analysis: &GeotraceAnalysis, id: SymbolId) -> Option<Description> {
    describe(analysis, Target::Symbol(id))
}
