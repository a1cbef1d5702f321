//! Attributes: from recorded attributes to values over the variables of a declaration.

use expr::number;
use expr::value::Value;
use syntax::attribute_range::AttributeRange;
use syntax::geotrace::actions::{Declaration, StatedAttribute};
use syntax::geotrace::attributes::{AttributeRow, AttributeType, AttributeWord};
use syntax::geotrace::codes::ATTRIBUTE_RANGE;
use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::span::Span;

use crate::geotrace::code::Expression;
use crate::geotrace::declarations::{Declarations, kind_of};
use crate::geotrace::dependencies::Dependencies;
use crate::geotrace::error::{self, SemanticError};
use crate::solid::{Attribute, AttributeValue};

/// An attribute as read.
#[derive(Clone, Debug)]
pub(crate) struct DeclaredAttribute {
    pub(crate) read: StatedAttribute,
    pub(crate) value: ReadValue,
}

/// Creates the error of a constant outside the range of an attribute.
type RangeError = fn(&AttributeRow, AttributeRange, f64) -> SemanticError;

/// The value of an attribute as read.
#[derive(Clone, Debug)]
pub(crate) enum ReadValue {
    Expression(Expression),
    Word(Box<str>),
}

impl DeclaredAttribute {
    /// Returns the step at which its expression starts.
    pub(crate) fn start(&self) -> Option<usize> {
        match &self.value {
            ReadValue::Expression(value) => Some(value.steps().start),
            ReadValue::Word(_) => None,
        }
    }

    /// Returns true if it states the projection that can cover half a turn or more.
    fn is_spherical(&self) -> bool {
        let is_projection = self.read.word == AttributeWord::Projection;
        is_projection && matches!(&self.value, ReadValue::Word(word) if **word == *"spherical")
    }
}

impl Declarations {
    /// Returns the attributes of a declaration, over its variables, and the params and grids that they read. Attributes with
    /// an error are reported and omitted.
    pub(crate) fn stated(
        &mut self,
        keyword: DeclarationKeyword,
        variables: usize,
    ) -> (Vec<Attribute>, Dependencies) {
        let mut all = Vec::new();
        let mut dependencies = Dependencies::default();
        let declared = std::mem::take(&mut self.attributes);
        let is_narrow = !declared.iter().any(DeclaredAttribute::is_spherical);
        for stated in declared {
            let word = stated.read.word;
            let Some(row) = word.row(keyword) else {
                continue;
            };
            let value = match stated.value {
                ReadValue::Word(word) => Some(AttributeValue::Word(word.into())),
                ReadValue::Expression(value) => {
                    let lowered = self.over_variables(value, variables);
                    let sets = &mut self.lowerer.dependencies;
                    dependencies = sets.union(dependencies, lowered.dependencies);
                    let is_constant = lowered.dependencies == Dependencies::default();
                    let error = if row.word == AttributeWord::Fov && is_narrow {
                        wide_or_out_of_range
                    } else {
                        out_of_range
                    };
                    let error: Option<RangeError> = is_constant.then_some(error);
                    lowered.value.and_then(|found| {
                        self.checked_attribute(row, &found, error, stated.read.value_span)
                    })
                }
            };
            all.extend(value.map(|value| Attribute {
                word: word.text(),
                span: stated.read.word_span,
                value,
                map: None,
            }));
        }
        if is_narrow {
            self.check_field_of_view(&all);
        }
        (all, dependencies)
    }

    /// Returns the attributes of a declaration, and the dependencies of them and of the rest of the declaration.
    pub(crate) fn stated_with(
        &mut self,
        declaration: &Declaration<'_>,
        variables: usize,
        rest: Dependencies,
    ) -> (Vec<Attribute>, Dependencies) {
        let (attributes, stated) = self.stated(declaration.keyword, variables);
        (attributes, self.lowerer.dependencies.union(rest, stated))
    }

    /// Returns the value of an attribute, which must be within its range if it is constant; otherwise the error of
    /// `constant` is reported.
    fn checked_attribute(
        &mut self,
        row: &AttributeRow,
        value: &Value,
        constant: Option<RangeError>,
        span: Span,
    ) -> Option<AttributeValue> {
        let (counts, what, range): (&[usize], &str, _) = match row.value {
            AttributeType::Number(range) => (&[1], "a number", range),
            AttributeType::Colour(range) => (&[1, 3], "a number or three", range),
            AttributeType::Pair => (&[2], "a vector of dimension 2", AttributeRange::ANY),
            AttributeType::Choice(_) | AttributeType::Name => return None,
        };
        let nodes = value.components();
        if !counts.contains(&nodes.len()) {
            let message = format!("`{}` is {what}, but this is {}", row.text, kind_of(value));
            let error = SemanticError::new(error::ATTRIBUTE_DIMENSION, message);
            self.found.push(error.at(span));
            return None;
        }
        let graph = &self.lowerer.graph;
        // Values of geodesics are uniforms; such a value is clamped where it is used.
        let is_known = |node| graph.inputs(&[node]).is_empty();
        if let Some(error) = constant {
            for node in nodes.iter().copied().filter(|node| is_known(*node)) {
                let number = self.lowerer.numbers(&[node])[0];
                if !range.contains(number) {
                    self.found.push(error(row, range, number).at(span));
                    return None;
                }
            }
        }
        Some(AttributeValue::Numbers(nodes.to_vec()))
    }

    /// Reports a constant field of view of half a turn or more, if the camera is not spherical.
    fn check_field_of_view(&mut self, attributes: &[Attribute]) {
        let word = AttributeWord::Fov.text();
        let Some(fov) = attributes.iter().find(|it| it.word == word) else {
            return;
        };
        let AttributeValue::Numbers(nodes) = &fov.value else {
            return;
        };
        let graph = &self.lowerer.graph;
        let number = nodes.first().and_then(|node| graph.value(*node));
        if let Some(number) = number.filter(|number| *number >= std::f64::consts::PI) {
            let error = wide(number);
            self.found.push(error.at(fov.span));
        }
    }
}

/// Returns the error of a camera that is not spherical and sees half a turn or more.
fn wide(number: f64) -> SemanticError {
    let message = format!(
        "the `fov` of a camera that is not spherical is below pi, but this is {}",
        number::text(number)
    );
    let error = SemanticError::new(ATTRIBUTE_RANGE, message);
    // Up to a full turn, it may be meant in radians.
    if number <= std::f64::consts::TAU {
        return error.with_hint("angles are in radians: pi is half a turn");
    }
    let degrees = if number < 180.0 { number } else { 75.0 };
    error.with_hint(format!(
        "angles are in radians: write `{}pi/180`",
        number::text(degrees)
    ))
}

/// Returns the error of the field of view of a camera that is not spherical, if it is out of range.
fn wide_or_out_of_range(row: &AttributeRow, range: AttributeRange, number: f64) -> SemanticError {
    if number > range.max {
        wide(number)
    } else {
        out_of_range(row, range, number)
    }
}

fn out_of_range(row: &AttributeRow, range: AttributeRange, number: f64) -> SemanticError {
    let is = match number {
        number if number.is_nan() => "undefined".to_owned(),
        number if number.is_infinite() => "infinite".to_owned(),
        number => number::text(number),
    };
    let message = match range.text() {
        Some(range) if number.is_finite() => format!("`{}` is {range}, but this is {is}", row.text),
        _ => format!("`{}` is {is} here", row.text),
    };
    let error = SemanticError::new(ATTRIBUTE_RANGE, message);
    let is_byte = range == AttributeRange::SHARE && number > 1.0 && number <= 255.0;
    if row.word == AttributeWord::Color && is_byte {
        return error.with_hint("components of colours are 0…1: divide by 255");
    }
    let is_angle = range == AttributeRange::TURN && number > range.max;
    if is_angle {
        let hint = format!(
            "angles are in radians: write `{}pi/180`",
            number::text(number)
        );
        return error.with_hint(hint);
    }
    error
}
