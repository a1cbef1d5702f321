//! Values that a person has found with a slider, written into the text.
//!
//! What flows in: a param's name and a number for each of its components. What flows out: the edit after which the
//! param opens with them, as in `param r = 0.3 : [0, 1];`.

use std::fmt;

use scene::Range;
use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use crate::edit::Edit;
use crate::item::Item;
use crate::reading::Reading;

/// How many places of a slider are told apart: more than a screen has pixels. A value is written with no more digits
/// than say which of them it is at.
const STEPS: f64 = 10_000.0;

/// Why a value is not written.
#[derive(Clone, Debug, PartialEq)]
pub enum Refusal {
    /// No param of this name is declared without errors.
    NoParam {
        /// The name.
        name: String,
    },
    /// The number of values is not that of the param's components.
    Components {
        /// The param.
        name: String,
        /// How many components it has.
        expected: usize,
        /// How many values were given.
        given: usize,
    },
    /// A value lies outside its interval, or is not a number.
    OutOfRange {
        /// The param.
        name: String,
        /// The value.
        value: f64,
        /// The least value allowed.
        min: f64,
        /// The greatest value allowed.
        max: f64,
    },
    /// A comment stands within the value that is written now, and would be lost.
    Comment {
        /// The param.
        name: String,
    },
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoParam { name } => write!(
                f,
                "no param `{name}` is declared without errors, so its value cannot be written"
            ),
            Self::Components {
                name,
                expected,
                given,
            } => {
                let wanted = match expected {
                    1 => "one number".to_owned(),
                    count => format!("{count} numbers"),
                };
                write!(f, "`{name}` takes {wanted}, but {given} were given")
            }
            Self::OutOfRange {
                name,
                value,
                min,
                max,
            } => write!(
                f,
                "{value} lies outside the interval [{min}, {max}] of `{name}`"
            ),
            Self::Comment { name } => write!(
                f,
                "the value of `{name}` has a comment in it, which would be lost: write the value by hand"
            ),
        }
    }
}

impl std::error::Error for Refusal {}

/// The edit after which a param opens with these values, one for each of its components. Each is written with as few
/// digits as tell it from its neighbours on a slider of ten thousand places, and lies within its interval. Where the
/// text says the same already, the edit changes nothing.
///
/// # Errors
/// Where there is no such param, the values are not its own, or a comment would be lost.
pub fn value(reading: &Reading, param: &str, values: &[f64]) -> Result<Edit, Refusal> {
    let no_param = || Refusal::NoParam {
        name: param.to_owned(),
    };
    let item = reading.declared(param).ok_or_else(no_param)?;
    let ranges = ranges(reading, &item).ok_or_else(no_param)?;
    if ranges.len() != values.len() {
        return Err(Refusal::Components {
            name: param.to_owned(),
            expected: ranges.len(),
            given: values.len(),
        });
    }
    if let Some(component) = Range::first_outside(&ranges, values) {
        let Range { min, max } = ranges[component];
        return Err(Refusal::OutOfRange {
            name: param.to_owned(),
            value: values[component],
            min,
            max,
        });
    }
    let numbers = ranges.iter().zip(values);
    let numbers: Vec<String> = numbers
        .map(|(range, value)| shortest(*range, *value))
        .collect();
    let text = match &numbers[..] {
        [number] => number.clone(),
        _ => format!("({})", numbers.join(", ")),
    };
    let Some(span) = opening(reading, &item) else {
        return Ok(Edit::insert(item.name_span.end, format!(" = {text}")));
    };
    let mut tokens = reading.tokens(reading.tokens_in(span));
    if tokens.any(|token| token.kind == TokenKind::Comment) {
        return Err(Refusal::Comment {
            name: param.to_owned(),
        });
    }
    Ok(Edit::replace(span, text))
}

/// The value that a param opens with, where it is written.
pub fn opening(reading: &Reading, item: &Item<'_>) -> Option<Span> {
    if item.word != DeclarationKeyword::Param {
        return None;
    }
    let behind = Span::new(item.name_span.end, item.span.end);
    let tokens = reading.tokens(reading.tokens_in(behind));
    let mut tokens = tokens.filter(|token| token.kind != TokenKind::Comment);
    if tokens.next()?.kind != TokenKind::Equals {
        return None;
    }
    let value = tokens.take_while(|token| token.kind != TokenKind::Colon);
    value.map(|token| token.span).reduce(Span::to)
}

/// The intervals of a param, where nothing is wrong with it.
fn ranges(reading: &Reading, item: &Item<'_>) -> Option<Vec<Range>> {
    if item.word != DeclarationKeyword::Param {
        return None;
    }
    let excerpt = reading.excerpt([item.index]);
    let mut params = excerpt.scene().params.iter();
    let param = params.find(|param| param.name == item.name)?;
    Some(param.ranges.clone())
}

/// The shortest decimal number within an interval that is nearer to a value of it than half a slider's step.
fn shortest(range: Range, value: f64) -> String {
    let reach = 0.5 * (range.max - range.min) / STEPS;
    let fits = |text: &String| {
        text.parse().is_ok_and(|number: f64| {
            (range.min..=range.max).contains(&number) && (number - value).abs() <= reach
        })
    };
    // At an end rounding may leave the interval: then it is rounded towards the middle.
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
