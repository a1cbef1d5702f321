//! Values found interactively, written into the block `Settings`: the position of the camera, and numbers.
//!
//! In: an analysis and numbers in the script's coordinates. Out: the edit after which the script states them. The rest
//! of the block and of its camera remains unchanged.

use scene::SetError;
use syntax::crt::objects::{ObjectName, ValueType};
use syntax::crt::token::TokenKind;
use syntax::crt::tree::BlockKind;
use syntax::span::Span;

use super::CrtAnalysis;
use super::names::{ObjectPlace, Origin};
use crate::edit::{self, Edit};
use crate::edit_camera::{EditCameraError, short_numbers};
use crate::edit_param::EditParamError;
use crate::language::Analysis;

/// The name of the scene's camera.
const CAMERA: &str = "camera";

/// Returns the edit after which the camera is at `position` and looks along `direction`.
///
/// # Errors
/// If the numbers are not a valid position, the camera is not stated in one location, or a comment would be lost.
pub(super) fn edit_camera(
    analysis: &CrtAnalysis,
    direction: [f64; 3],
    position: [f64; 3],
) -> Result<Edit, EditCameraError> {
    let [places, length] = [position, direction].map(|[x, y, z]| x.hypot(y).hypot(z));
    if !(length > 0.0 && length.is_finite() && places.is_finite()) {
        return Err(EditCameraError::NotAPlace);
    }
    let pointing = [0, 1, 2].map(|k| position[k] + direction[k]);
    let [position, pointing] = [position, pointing].map(|place| {
        let numbers = short_numbers(place, length).map(|number| literal(&number));
        format!("vec3({})", numbers.join(", "))
    });
    let Some((_, value)) = setting(analysis, CAMERA) else {
        if settings(analysis).is_some_and(|block| named(analysis, block, CAMERA).is_some()) {
            return Err(EditCameraError::NotStated);
        }
        let stated = format!(
            "camera -> Camera {{\n        position -> {position}\n        pointing -> {pointing}\n        fov -> 60\n    }}"
        );
        return Ok(added(analysis, &stated));
    };
    let camera = stated_camera(analysis, value).ok_or(EditCameraError::NotStated)?;
    let span_of = |word: &str| attribute(analysis, camera, word).map(|(span, _)| span);
    let (Some(from), Some(to)) = (span_of("position"), span_of("pointing")) else {
        return Err(EditCameraError::NotStated);
    };
    if [from, to].iter().any(|span| has_comment(analysis, *span)) {
        let name = CAMERA.to_owned();
        return Err(EditCameraError::Comment { name });
    }
    // The text between the two remains.
    let whole = Span::new(from.start.min(to.start), from.end.max(to.end));
    let within = |span: Span, text: String| {
        let span = Span::new(span.start - whole.start, span.end - whole.start);
        Edit::replace(span, text)
    };
    let mut edits = vec![
        within(from, format!("position -> {position}")),
        within(to, format!("pointing -> {pointing}")),
    ];
    edits.sort_by_key(|edit| edit.span);
    Ok(Edit::replace(
        whole,
        edit::apply(&analysis.slice(whole), &edits),
    ))
}

/// Returns the edit after which the block `Settings` states a number: `gamma`, `supersampling`, `dofsamples` or
/// `recursiondepth`.
///
/// # Errors
/// If the block has no number of this name, the number is out of range, or a comment would be lost.
pub(super) fn edit_number(
    analysis: &CrtAnalysis,
    word: &str,
    values: &[f64],
) -> Result<Edit, EditParamError> {
    let name = word.to_owned();
    let known = ObjectName::Settings.attribute(word);
    let (is_whole, range) = match known.map(|it| it.value) {
        Some(ValueType::Integer(range)) => (true, range),
        Some(ValueType::Number(range)) => (false, range),
        _ => return Err(EditParamError::NoParam { name }),
    };
    let &[value] = values else {
        let given = values.len();
        return Err(SetError::Components {
            name,
            expected: 1,
            given,
        }
        .into());
    };
    if !range.contains(value) || is_whole && value.fract() != 0.0 {
        let error = SetError::OutOfRange {
            name,
            component: 0,
            components: 1,
            value,
            min: range.min,
            max: range.max,
        };
        return Err(error.into());
    }
    let text = format!("{word} -> {}", literal(&value.to_string()));
    match setting(analysis, word) {
        None => Ok(added(analysis, &text)),
        Some((span, _)) if has_comment(analysis, span) => Err(EditParamError::Comment { name }),
        Some((span, _)) => Ok(Edit::replace(span, text)),
    }
}

/// Returns the spans of a setting and of its value.
fn setting(analysis: &CrtAnalysis, word: &str) -> Option<(Span, Span)> {
    attribute(analysis, settings(analysis)?, word)
}

fn settings(analysis: &CrtAnalysis) -> Option<&ObjectPlace> {
    let mut objects = analysis.names().objects.iter();
    objects.find(|it| it.object == Some(ObjectName::Settings))
}

/// Returns the spans of an attribute, the last with its name, and of its value.
fn attribute(analysis: &CrtAnalysis, object: &ObjectPlace, word: &str) -> Option<(Span, Span)> {
    let (span, name) = named(analysis, object, word)?;
    let behind = analysis.tokens(Span::new(name.end, span.end));
    let mut behind = behind.filter(|token| token.span.start >= name.end);
    behind.find(|token| token.kind == TokenKind::Arrow)?;
    let mut behind = behind.filter(|token| token.kind != TokenKind::Comment);
    let value = behind.next()?.span;
    Some((span, Span::new(value.start, span.end)))
}

/// Returns the spans of an attribute, the last with its name, and of that name.
fn named(analysis: &CrtAnalysis, object: &ObjectPlace, word: &str) -> Option<(Span, Span)> {
    let mut attributes = object.attributes.iter().rev();
    attributes
        .find(|(_, name)| analysis.slice(*name) == word)
        .copied()
}

/// Returns the camera that a value denotes: the value itself, or the value of a variable that is assigned once.
fn stated_camera(analysis: &CrtAnalysis, value: Span) -> Option<&ObjectPlace> {
    let names = analysis.names();
    let camera_at = |start: u32| {
        let mut objects = names.objects.iter();
        objects.find(|it| it.object == Some(ObjectName::Camera) && it.name.start == start)
    };
    if let Some(camera) = camera_at(value.start).filter(|it| it.braces.end == value.end) {
        return Some(camera);
    }
    let (span, variable) = names.variable_at(value.start)?;
    let occurrences = names.occurrences(variable);
    let assignments = occurrences.iter().filter(|it| it.introduces).count();
    let variable = names.variable(variable);
    let is_stated =
        span == value && assignments == 1 && variable.origin == Origin::Object(ObjectName::Camera);
    let mut objects = names.objects.iter();
    let assigned = objects.find(|it| {
        it.object == Some(ObjectName::Camera) && it.braces.end == variable.assignment.end
    });
    assigned.filter(|_| is_stated)
}

fn has_comment(analysis: &CrtAnalysis, span: Span) -> bool {
    let mut tokens = analysis.tokens(span);
    tokens.any(|token| token.kind == TokenKind::Comment && token.span.start < span.end)
}

/// Returns the edit that adds a setting at the start of the block; a script without the block gets one before its
/// scene.
fn added(analysis: &CrtAnalysis, stated: &str) -> Edit {
    if let Some(block) = settings(analysis) {
        let is_empty = block.attributes.is_empty();
        let end = if is_empty { "\n" } else { "" };
        return Edit::insert(block.braces.start + 1, format!("\n    {stated}{end}"));
    }
    let script = analysis.script();
    let mut blocks = script.blocks();
    let scene = blocks.find(|(_, block)| matches!(block.kind, BlockKind::Scene(_)));
    let block = format!("Settings {{\n    {stated}\n}}\n");
    match scene {
        Some((base, scene)) => Edit::insert(base + scene.span.start, block + "\n"),
        None => Edit::append(analysis.text(), &block),
    }
}

/// Returns a number in the syntax of a script: without an exponent, and with a point unless it is an integer.
fn literal(number: &str) -> String {
    let Ok(value) = number.parse::<f64>() else {
        return number.to_owned();
    };
    let text = value.to_string();
    match text.contains('.') || value.abs() < 2f64.powi(31) {
        true => text,
        false => text + ".0",
    }
}
