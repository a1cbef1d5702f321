//! Values found with a slider, written into the text.
//!
//! In: a param's name and a number for each of its components. Out: the edit after which these are the initial values
//! of the param, as in `param r = 0.3 : [0, 1];`.

use scene::{Param, SetError};
use syntax::geotrace::declarations::Category;
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use super::analysis::GeotraceAnalysis;
use super::item::Item;
use crate::edit::Edit;
use crate::edit_param::EditParamError;

/// Returns the edit that sets the initial values of a param, one for each of its components, exactly. If the text already
/// states these values, in whatever form, the edit changes nothing.
///
/// # Errors
/// If there is no such param, the values do not fit it, or a comment would be lost.
pub fn edit_param(
    analysis: &GeotraceAnalysis,
    param: &str,
    values: &[f64],
) -> Result<Edit, EditParamError> {
    let no_param = || EditParamError::NoParam {
        name: param.to_owned(),
    };
    let item = analysis.declared(param).ok_or_else(no_param)?;
    let stated = stated(analysis, &item).ok_or_else(no_param)?;
    SetError::check(param, &stated.ranges, values)?;
    let numbers: Vec<String> = values.iter().copied().map(literal).collect();
    let text = match &numbers[..] {
        [number] => number.clone(),
        _ => format!("({})", numbers.join(", ")),
    };
    let Some(span) = initial_value(analysis, &item) else {
        return Ok(Edit::insert(item.name_span.end, format!(" = {text}")));
    };
    if stated.initial == values {
        return Ok(Edit::insert(span.end, ""));
    }
    let mut tokens = analysis.tokens(analysis.tokens_in(span));
    if tokens.any(|token| token.kind == TokenKind::Comment) {
        return Err(EditParamError::Comment {
            name: param.to_owned(),
        });
    }
    Ok(Edit::replace(span, text))
}

/// Returns the span of a param's initial value, if it is stated.
pub(crate) fn initial_value(analysis: &GeotraceAnalysis, item: &Item<'_>) -> Option<Span> {
    if item.keyword.category() != Category::Slider {
        return None;
    }
    let behind = Span::new(item.name_span.end, item.span.end);
    let tokens = analysis.tokens(analysis.tokens_in(behind));
    let mut tokens = tokens.filter(|token| token.kind != TokenKind::Comment);
    if tokens.next()?.kind != TokenKind::Equals {
        return None;
    }
    let value = tokens.take_while(|token| token.kind != TokenKind::Colon);
    value.map(|token| token.span).reduce(Span::to)
}

/// Returns a param as the text states it, if it has no errors.
fn stated(analysis: &GeotraceAnalysis, item: &Item<'_>) -> Option<Param> {
    if item.keyword.category() != Category::Slider {
        return None;
    }
    let excerpt = analysis.excerpt([item.index]);
    let mut params = excerpt.scene().params.iter();
    params.find(|param| param.name == item.name).cloned()
}

/// Returns the shortest text of exactly this number.
fn literal(value: f64) -> String {
    let (plain, scaled) = (value.to_string(), format!("{value:e}"));
    match plain.as_str() {
        "-0" => "0".to_owned(),
        _ if scaled.len() < plain.len() => scaled,
        _ => plain,
    }
}
