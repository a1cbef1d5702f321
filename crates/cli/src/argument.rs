//! Parsers of arguments. In: texts of the command line. Out: typed values.

mod figure;
mod look;

use clap::ValueEnum;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use export::animation;

use render::MAX_SIDE;

use crate::number;
use render::view::{View, ViewId, Views};

pub(crate) use figure::{FigureArgument, PathArgument, figure, path};
pub(crate) use look::{ObjectColour, TextureFile, colour, object_colour, setting, texture};

/// The format of a result: for people or for programs.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq, ValueEnum)]
pub(crate) enum Format {
    /// For people.
    #[default]
    Human,
    /// One JSON document on standard output.
    Json,
}

/// A number, or an expression such as `pi/2` that evaluates to a number in the program's scope.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Quantity {
    /// A finite number.
    Number(f64),
    /// The text of an expression.
    Expression(String),
}

/// `NAME=VALUE` or `NAME=V1,V2`: a value for a param or a grid.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Assignment {
    /// The name of the param or grid.
    pub(crate) name: String,
    /// One value per component.
    pub(crate) values: Vec<Quantity>,
}

/// `U,V`: a point or a direction of the chart.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pair(pub(crate) [Quantity; 2]);

/// `U,V`, or `X,Y,Z`: a point on a surface or near a solid, or a direction there.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlaceArgument(pub(crate) Vec<Quantity>);

/// `X,Y,Z`: a point of space.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Triple(pub(crate) [Quantity; 3]);

/// `WxH`: a picture's size in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Size(pub(crate) [u32; 2]);

/// `NAME=FROM:TO`: a param or a grid that changes from one value to another.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Animated {
    /// The name of the param or grid.
    pub(crate) name: String,
    /// The first value, component by component.
    pub(crate) from: Vec<Quantity>,
    /// The last value, with the same number of components.
    pub(crate) to: Vec<Quantity>,
}

/// A word of the command line that stands for a value of another crate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Choice<T: 'static> {
    /// The word.
    pub(crate) word: &'static str,
    /// A line of help, without its end; a word without help is accepted and not listed.
    pub(crate) help: Option<&'static str>,
    /// The meaning of the word.
    pub(crate) value: T,
}

impl<T> Choice<T> {
    /// Returns a word that the help lists.
    pub(crate) const fn new(word: &'static str, help: &'static str, value: T) -> Self {
        Self {
            word,
            help: Some(help),
            value,
        }
    }

    /// Returns a word that is accepted, but not listed by the help.
    pub(crate) const fn hidden(word: &'static str, value: T) -> Self {
        Self {
            word,
            help: None,
            value,
        }
    }
}

/// Returns a parser of the words of a table, with their help and completion.
pub(crate) fn choice<T: Copy + Send + Sync>(
    table: &'static [Choice<T>],
) -> impl TypedValueParser<Value = T> {
    let words = table.iter().map(|choice| {
        let word = PossibleValue::new(choice.word).hide(choice.help.is_none());
        match choice.help {
            Some(help) => word.help(help),
            None => word,
        }
    });
    PossibleValuesParser::new(words).try_map(move |word| {
        let found = table.iter().find(|choice| choice.word == word);
        found.map(|choice| choice.value).ok_or("unknown word")
    })
}

/// Parses `NAME=V1,V2`.
pub(crate) fn assignment(text: &str) -> Result<Assignment, String> {
    let Some((name, values)) = text.split_once('=') else {
        return Err("expected NAME=VALUE, such as r=0.7 or T=0.5,1".into());
    };
    let name = name.trim();
    if name.is_empty() {
        return Err("a name is missing before `=`".into());
    }
    Ok(Assignment {
        name: name.into(),
        values: list(values)?,
    })
}

/// Parses `NAME=FROM:TO`.
pub(crate) fn animated(text: &str) -> Result<Animated, String> {
    let expected = "expected NAME=FROM:TO, such as r=0.5:1 or T=0,0:1,pi";
    let (name, ends) = text.split_once('=').ok_or(expected)?;
    let (from, to) = ends.split_once(':').ok_or(expected)?;
    if name.trim().is_empty() {
        return Err("a name is missing before `=`".into());
    }
    let (from, to) = (list(from)?, list(to)?);
    if from.len() != to.len() {
        return Err("both ends need the same number of values".into());
    }
    Ok(Animated {
        name: name.trim().into(),
        from,
        to,
    })
}

/// Parses a number; any other text is an expression.
pub(crate) fn quantity(text: &str) -> Result<Quantity, String> {
    let text = text.trim();
    let numeric = text.contains(|c: char| c.is_ascii_digit()) && text.parse::<f64>().is_ok();
    if text.is_empty() || numeric {
        return number::parse(text).map(Quantity::Number);
    }
    Ok(Quantity::Expression(text.into()))
}

/// Parses `U,V`.
pub(crate) fn pair(text: &str) -> Result<Pair, String> {
    let values = list(text)?;
    let given = values.len();
    let pair = values.try_into().map(Pair);
    pair.map_err(|_| {
        format!("expected two numbers (parameters of a surface), such as 0.5,-pi/2, found {given}")
    })
}

/// Parses `U,V` or `X,Y,Z`.
pub(crate) fn place(text: &str) -> Result<PlaceArgument, String> {
    let values = list(text)?;
    match values.len() {
        2 | 3 => Ok(PlaceArgument(values)),
        given => Err(format!(
            "expected two numbers, such as 0.5,-pi/2, or three on a solid, found {given}"
        )),
    }
}

/// Parses `X,Y,Z`.
pub(crate) fn triple(text: &str) -> Result<Triple, String> {
    let values = list(text)?;
    let given = values.len();
    let triple = values.try_into().map(Triple);
    triple.map_err(|_| format!("expected three numbers, such as 3,-2,1.5, found {given}"))
}

/// Parses `WxH`.
pub(crate) fn size(text: &str) -> Result<Size, String> {
    let expected = "expected WIDTHxHEIGHT in pixels, such as 800x600";
    let Some((width, height)) = text.split_once(['x', 'X', '×']) else {
        return Err(expected.into());
    };
    let side = |side: &str| -> Result<u32, String> {
        if side.is_empty() || !side.bytes().all(|byte| byte.is_ascii_digit()) {
            return Err(expected.into());
        }
        // It consists of digits, so a failure means that it is too large.
        match side.parse::<u32>() {
            Ok(0) => Err("a picture is at least one pixel wide and high".into()),
            Ok(pixels) if pixels <= MAX_SIDE => Ok(pixels),
            _ => Err(format!(
                "a picture is at most {MAX_SIDE} pixels wide and high"
            )),
        }
    };
    Ok(Size([side(width.trim())?, side(height.trim())?]))
}

/// Parses the name of a view, with that of its object if it has one: `3d`, `geodesic` or `geodesic:SURFACE`.
pub(crate) fn view(text: &str, views: &Views) -> Result<ViewId, String> {
    let ViewId { kind, object } = text.into();
    let object = object.map(|name| name.trim().to_owned());
    let named = |view: &&dyn View| {
        let named = view.name().eq_ignore_ascii_case(&kind);
        named && (object.is_none() || view.name_behind().is_some())
    };
    match views.iter().find(named) {
        Some(view) if object.as_deref() != Some("") => Ok(ViewId {
            kind: view.name().to_owned(),
            object,
        }),
        _ => Err(format!("expected {}", forms(views))),
    }
}

/// Parses the name of a view of this program. [`view_help`] and [`view`] replace this parser and its help, with the
/// views of a registry.
pub(crate) fn standard_view(text: &str) -> Result<ViewId, String> {
    view(text, &Views::standard())
}

/// Returns the help of an option that takes a view: "3d, or geodesic, or geodesic:SURFACE; …".
pub(crate) fn view_help(views: &Views) -> String {
    let names: Vec<String> = view_names(views).collect();
    format!(
        "{}; without a name, the program's first",
        names.join(", or ")
    )
}

/// Returns the forms of view names: `3d`, `traced`, `traced:CAMERA`, `geodesic`, `geodesic:SURFACE`.
fn view_names(views: &Views) -> impl Iterator<Item = String> + '_ {
    views.iter().flat_map(|view| {
        let name = view.name();
        let with_name = view.name_behind().map(|word| format!("{name}:{word}"));
        [Some(name.to_owned()), with_name].into_iter().flatten()
    })
}

/// Returns the forms of view names as a phrase: "3d, geodesic, or geodesic:SURFACE".
fn forms(views: &Views) -> String {
    let names: Vec<String> = view_names(views).collect();
    match names.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{}, or {last}", others.join(", ")),
        None => String::new(),
    }
}

/// Parses a finite number.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    number::parse(text)
}

/// Parses a number greater than zero.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    match number::parse(text)? {
        value if value > 0.0 => Ok(value),
        _ => Err("it must be greater than 0".into()),
    }
}

/// Parses a number of pictures per second.
pub(crate) fn rate(text: &str) -> Result<f64, String> {
    let rates = animation::RATES;
    match positive(text)? {
        value if rates.contains(&value) => Ok(value),
        _ => {
            let (least, most) = (rates.start(), rates.end());
            Err(format!("it must be between {least} and {most}"))
        }
    }
}

/// Parses a tolerance: a positive number, not too large for steps to follow a geodesic.
pub(crate) fn tolerance(text: &str) -> Result<f64, String> {
    const MOST: f64 = 1e-2;
    match positive(text)? {
        value if value <= MOST => Ok(value),
        _ => Err(format!("it must be at most {MOST}")),
    }
}

/// Parses quantities separated by commas, with or without brackets around all of them.
fn list(text: &str) -> Result<Vec<Quantity>, String> {
    let parts = split(text);
    if let [one] = parts[..] {
        let inner = one
            .trim()
            .strip_prefix('(')
            .and_then(|rest| rest.strip_suffix(')'));
        if let Some(several) = inner.map(split).filter(|parts| parts.len() > 1) {
            return several.into_iter().map(quantity).collect();
        }
    }
    parts.into_iter().map(quantity).collect()
}

/// Splits a text at commas outside brackets.
fn split(text: &str) -> Vec<&str> {
    let mut depth = 0_i64;
    text.split(|letter| {
        match letter {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
        letter == ',' && depth == 0
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assignments_have_a_name_and_numbers() {
        assert_eq!(
            assignment("T=-1,.5"),
            Ok(Assignment {
                name: "T".into(),
                values: vec![Quantity::Number(-1.0), Quantity::Number(0.5)]
            })
        );
        for text in ["T", "=1", "T=", "T=1,", "T=1e999"] {
            assert!(assignment(text).is_err(), "{text}");
        }
    }

    #[test]
    fn animated_params_have_two_ends_with_as_many_values() {
        let numbers = |values: &[f64]| -> Vec<Quantity> {
            values.iter().copied().map(Quantity::Number).collect()
        };
        assert_eq!(
            animated("T=0,-1:1,.5"),
            Ok(Animated {
                name: "T".into(),
                from: numbers(&[0.0, -1.0]),
                to: numbers(&[1.0, 0.5]),
            })
        );
        assert!(animated("o=0:2pi").is_ok());
        for text in ["T", "T=0", "=0:1", "T=0:", "T=0,1:2"] {
            assert!(animated(text).is_err(), "{text}");
        }
    }

    #[test]
    fn sizes_have_two_sides_from_1_to_the_longest() {
        assert_eq!(size("1x16384"), Ok(Size([1, 16384])));
        assert_eq!(size("800X600"), Ok(Size([800, 600])));
        for text in [
            "0x0",
            "1x0",
            "512",
            "x",
            "12x",
            "-1x5",
            "1x16385",
            "99999999999x1",
            "1.5x2",
            "+1x1",
        ] {
            assert!(size(text).is_err(), "{text}");
        }
    }

    #[test]
    fn pairs_and_triples_count_their_numbers() {
        let numbers = |values: &[f64]| {
            values
                .iter()
                .copied()
                .map(Quantity::Number)
                .collect::<Vec<_>>()
        };
        for text in ["-2,0.3", "(-2, 0.3)", " -2 , .3 "] {
            assert_eq!(
                pair(text).map(|pair| pair.0.to_vec()),
                Ok(numbers(&[-2.0, 0.3])),
                "{text}"
            );
        }
        for text in ["1", "1,2,3", "1,", "(1,2", ""] {
            assert!(pair(text).is_err(), "{text}");
        }
        assert_eq!(
            triple("1,2,-3").map(|triple| triple.0.to_vec()),
            Ok(numbers(&[1.0, 2.0, -3.0]))
        );
        assert!(triple("1,2").is_err());
    }

    #[test]
    fn what_is_no_number_is_left_to_the_language() {
        let expression = |text: &str| Quantity::Expression(text.into());
        assert_eq!(
            pair("-pi/2, f(1, 2)").map(|pair| pair.0),
            Ok([expression("-pi/2"), expression("f(1, 2)")])
        );
        assert_eq!(
            pair("(1+2),(a)").map(|pair| pair.0),
            Ok([expression("(1+2)"), expression("(a)")])
        );
        // Numbers to Rust, names to the language.
        assert_eq!(quantity("nan"), Ok(expression("nan")));
        assert_eq!(quantity("1e999"), Err("1e999 is too large a number".into()));
    }

    #[test]
    fn views_are_named() {
        let named = |kind: &str, object: Option<&str>| {
            Ok(ViewId {
                kind: String::from(kind),
                object: object.map(str::to_owned),
            })
        };
        assert_eq!(standard_view("3d"), named("3d", None));
        assert_eq!(standard_view("geodesic"), named("geodesic", None));
        assert_eq!(standard_view("geodesic:s"), named("geodesic", Some("s")));
        assert_eq!(standard_view("traced:eye"), named("traced", Some("eye")));
        for text in ["", "2d", "geodesic:", "3d:s"] {
            assert!(standard_view(text).is_err(), "{text}");
        }
    }
}
