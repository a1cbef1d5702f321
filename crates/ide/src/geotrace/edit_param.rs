//! Values found with a slider, written into the text.
//!
//! In: a param's name and a number for each of its components. Out: the edit after which these are the initial values
//! of the param, as in `param r = 0.3 : [0, 1];`.

use scene::{Range, SetError};
use syntax::geotrace::declarations::Category;
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use super::analysis::GeotraceAnalysis;
use super::item::Item;
use crate::edit::Edit;
use crate::edit_param::EditParamError;

/// Returns the edit that sets the initial values of a param, one for each of its components. Each is written with the
/// minimum number of digits that distinguish it from its neighbours on a slider of ten thousand positions, and is
/// within its interval. If the text already states these values, the edit changes nothing.
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
    let ranges = ranges(analysis, &item).ok_or_else(no_param)?;
    SetError::check(param, &ranges, values)?;
    let numbers = ranges.iter().zip(values);
    let numbers: Vec<String> = numbers
        .map(|(range, value)| shortest(*range, *value))
        .collect();
    let text = match &numbers[..] {
        [number] => number.clone(),
        _ => format!("({})", numbers.join(", ")),
    };
    let Some(span) = initial_value(analysis, &item) else {
        return Ok(Edit::insert(item.name_span.end, format!(" = {text}")));
    };
    let mut tokens = analysis.tokens(analysis.tokens_in(span));
    if tokens.any(|token| token.kind == TokenKind::Comment) {
        return Err(EditParamError::Comment {
            name: param.to_owned(),
        });
    }
    Ok(Edit::replace(span, text))
}

/// The number of distinct positions of a slider, more than a screen has pixels. A value is written with just enough
/// digits to distinguish them.
const STEPS: f64 = 10_000.0;

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

/// Returns the intervals of a param, if it has no errors.
fn ranges(analysis: &GeotraceAnalysis, item: &Item<'_>) -> Option<Vec<Range>> {
    if item.keyword.category() != Category::Slider {
        return None;
    }
    let excerpt = analysis.excerpt([item.index]);
    let mut params = excerpt.scene().params.iter();
    let param = params.find(|param| param.name == item.name)?;
    Some(param.ranges.clone())
}

/// Returns the shortest decimal number within an interval whose distance to a value in it is less than half a slider's
/// step.
fn shortest(range: Range, value: f64) -> String {
    let reach = 0.5 * (range.max - range.min) / STEPS;
    let fits = |text: &String| {
        text.parse().is_ok_and(|number: f64| {
            (range.min..=range.max).contains(&number) && (number - value).abs() <= reach
        })
    };
    // At an end, rounding may leave the interval: then round towards the middle.
    let inwards = (0.5 * range.min + 0.5 * range.max - value).signum();
    let rounded = |digits: usize| {
        let inside = value + 0.5 * inwards * 10_f64.powi(-(digits as i32));
        [format!("{value:.digits$}"), format!("{inside:.digits$}")]
    };
    let plain = (0..=20).flat_map(rounded).find(fits);
    let scaled = (0..=17)
        .map(|digits| format!("{value:.digits$e}"))
        .find(fits);
    let mut all: Vec<String> = plain.into_iter().chain(scaled).collect();
    all.push(format!("{value}"));
    let shortest = all.into_iter().map(tidy).min_by_key(String::len);
    shortest.unwrap_or_default()
}

fn tidy(number: String) -> String {
    match number.as_str() {
        "-0" | "0e0" | "-0e0" => "0".to_owned(),
        _ => number,
    }
}

#[cfg(test)]
mod tests {
    use scene::Range;

    use super::shortest;

    #[test]
    fn a_number_has_the_digits_that_tell_it_from_its_neighbours_and_stays_within_its_interval() {
        use std::f64::consts::{PI, TAU};
        for (min, max, value, text) in [
            (0.0, 1.0, 0.3, "0.3"),
            (0.0, 1.0, 0.300_02, "0.3"),
            (0.0, 1.0, 0.123_456, "0.1235"),
            (0.0, 1.0, 1.0, "1"),
            (0.0, 1.0, 0.00001, "0"),
            (-1.0, 1.0, -0.000_01, "0"),
            (0.0, TAU, TAU, "6.283"),
            (-PI, PI, -PI, "-3.1415"),
            (0.0, 1e9, 123_456_789.0, "1.235e8"),
            (0.0, 1e-9, 2.5e-10, "2.5e-10"),
            (1.0, 1.0 + 1e-15, 1.0 + 4.44e-16, "1.0000000000000004"),
            (-f64::MAX, f64::MAX, 1e300, "0"),
        ] {
            let range = Range { min, max };
            let written = shortest(range, value);
            let number: f64 = written.parse().expect("a number");
            assert!((min..=max).contains(&number), "{written}");
            if max - min < f64::MAX {
                assert_eq!(written, text, "{value} in [{min}, {max}]");
            }
        }
    }
}
