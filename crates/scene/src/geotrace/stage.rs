//! Lights, cameras and the background: from recorded declarations to a stage.

use expr::value::Value;
use expr::{NodeId, number};
use syntax::diagnostic::{Code, Diagnostic, Fix};
use syntax::geotrace::actions::{Declaration, Operator};
use syntax::span::Span;

use crate::geotrace::code::Expression;
use crate::geotrace::declarations::{Declarations, Understood, constant, kind_of};
use crate::geotrace::declare::list_span;
use crate::geotrace::error::{self, SemanticError};
use crate::geotrace::interval::DeclaredInterval;
use crate::geotrace::lowerer::Lowered;
use crate::scene::Shape;
use crate::solid::{Attribute, AttributeValue, Background, Camera, Light};

impl Declarations {
    /// `light l = d;`, `light l = @ p;` or `light l = d @ p;`
    pub(crate) fn light(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
        let (direction, position) = match self.expressions(intervals) {
            Some([direction, position]) => (Some(direction), Some(position)),
            None => {
                let [part] = self.expressions(intervals)?;
                match self.lowerer.code.last_operator(part) {
                    Some(Operator::Position) => (None, Some(part)),
                    _ => (Some(part), None),
                }
            }
        };
        let mut dependencies = crate::geotrace::dependencies::Dependencies::default();
        let mut part = |declarations: &mut Self, part: Option<Expression>, what| {
            let Some(part) = part else {
                return Some((None, None));
            };
            let lowered = declarations.constant(part);
            let sets = &mut declarations.lowerer.dependencies;
            dependencies = sets.union(dependencies, lowered.dependencies);
            let nodes = declarations.in_space(part, &lowered, what)?;
            Some((Some(nodes), Some(lowered)))
        };
        let towards_span = direction.map(|part| self.lowerer.code.span(part));
        let direction = part(self, direction, "a light's direction");
        let position = part(self, position, "a light's position");
        let (attributes, stated) = self.stated(declaration.keyword, 0);
        let ((direction, towards), (position, place)) = (direction?, position?);
        let all = self.lowerer.dependencies.union(dependencies, stated);
        let bytes = self.bytes_of_light(declaration.name, &attributes);
        self.found.extend(bytes);
        let [has_position, has_direction] = [position.is_some(), direction.is_some()];
        let unused = unused_by_light(declaration.name, has_position, has_direction, &attributes);
        self.found.extend(unused);
        let shape = Shape::Light(Light {
            position,
            direction,
        });
        let drawn = self.object(declaration, shape, all, attributes);
        if let (None, Some(direction), Some(span)) = (position, direction, towards_span) {
            let warning = self.upward_light(declaration.name, direction, span);
            self.found.extend(warning);
        }
        let lowered = place.or(towards)?;
        let meaning = constant(lowered.value?, lowered.dependencies);
        Some(Understood::from(meaning).drawn(drawn))
    }

    /// Returns a warning about a parallel light that shines upwards along a vector so long that a position is probably
    /// meant.
    fn upward_light(&self, name: &str, direction: [NodeId; 3], span: Span) -> Option<Diagnostic> {
        const LONGEST: f64 = 2.0;
        let found = self.lowerer.numbers(&direction);
        let length = found.iter().map(|x| x * x).sum::<f64>().sqrt();
        if found[2] <= 0.0 || length.is_nan() || length <= LONGEST {
            return None;
        }
        let numbers: Vec<String> = found.into_iter().map(number::text).collect();
        let vector = format!("({})", numbers.join(", "));
        let message =
            format!("`{name}` shines upwards, along {vector}, from below the whole scene");
        let fix = Fix {
            title: format!("Write `@ {vector}`"),
            span: Span::new(span.start, span.start),
            replacement: "@ ".to_owned(),
            preferred: false,
            all: false,
        };
        Some(
            Diagnostic::warning(error::LIGHT_FROM_BELOW, span, message)
                .with_hint(format!(
                    "a light at a position has an `@` before it: write `@ {vector}`"
                ))
                .with_fix(fix),
        )
    }

    /// `camera c = d @ p;`
    pub(crate) fn camera(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
        let [direction, position] = self.expressions(intervals)?;
        let towards = self.constant(direction);
        let direction = self.in_space(direction, &towards, "a camera's direction");
        let place = self.constant(position);
        let position = self.in_space(position, &place, "a camera's position");
        let (attributes, stated) = self.stated(declaration.keyword, 0);
        let (direction, position) = (direction?, position?);
        let sets = &mut self.lowerer.dependencies;
        let all = sets.union(towards.dependencies, place.dependencies);
        let all = sets.union(all, stated);
        let shape = Shape::Camera(Camera {
            direction,
            position,
        });
        let drawn = self.object(declaration, shape, all, attributes);
        let meaning = constant(place.value?, place.dependencies);
        Some(Understood::from(meaning).drawn(drawn))
    }

    /// `background b(x,y,z) = c;` or `background b = c;`
    pub(crate) fn background(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
        let count = declaration.parameters.len();
        let [body] = self.expressions(intervals)?;
        let lowered = self.over_variables(body, count);
        let mut is_sound = matches!(count, 0 | 3);
        if !is_sound {
            let plural = if count == 1 { "" } else { "s" };
            let message = format!(
                "a background is a function of x, y and z, but `{}` has {count} parameter{plural}",
                declaration.name
            );
            let error = SemanticError::new(error::PARAMETER_COUNT, message);
            let place = list_span(declaration.parameters, declaration.name_span);
            self.found.push(error.at(place));
        }
        if let Some(interval) = intervals.first() {
            let message = "a background has no intervals: it is seen in every direction";
            let error = SemanticError::new(syntax::geotrace::codes::UNKNOWN_TAG, message);
            self.found.push(error.at(interval.read.span));
            is_sound = false;
        }
        let colour = self.colour(body, &lowered);
        let (attributes, stated) = self.stated(declaration.keyword, count);
        let colour = colour.filter(|_| is_sound)?;
        let all = self
            .lowerer
            .dependencies
            .union(lowered.dependencies, stated);
        let shape = Shape::Background(Background { colour });
        let drawn = self.object(declaration, shape, all, attributes);
        if !self.is_checker && self.has_background && drawn.is_some() {
            let message = format!("`{}` is a second background", declaration.name);
            let error = SemanticError::new(error::SECOND_BACKGROUND, message)
                .with_hint("a program has one background: remove one of them");
            self.found.push(error.at(declaration.name_span));
            return None;
        }
        let span = self.lowerer.code.span(body);
        let warning = self.bytes_of_background(declaration.name, colour, span);
        self.found.extend(warning);
        let meaning = match count {
            0 => constant(lowered.value?, lowered.dependencies),
            _ => self.keep(declaration, body),
        };
        Some(Understood::from(meaning).drawn(drawn))
    }

    /// Returns a warning about a light with a colour of bytes. A light without a `power` may be bright, but hardly by whole
    /// numbers.
    fn bytes_of_light(&self, name: &str, attributes: &[Attribute]) -> Option<Diagnostic> {
        const ONE_ABOVE: f64 = 32.0;
        if attributes.iter().any(|it| it.word == "power") {
            return None;
        }
        let colour = attributes.iter().find(|it| it.word == "color")?;
        let AttributeValue::Numbers(nodes) = &colour.value else {
            return None;
        };
        let found = self.lowerer.numbers(nodes);
        let is_byte = |number: &f64| (0.0..=255.0).contains(number) && number.fract() == 0.0;
        let is_bright = found.iter().any(|number| *number > ONE_ABOVE);
        (found.iter().all(is_byte) && is_bright)
            .then(|| far_too_bright(error::BRIGHT_LIGHT, colour.span, name, found))
    }

    /// Returns a warning about a background that is white wherever its numbers are known, as if they were bytes.
    fn bytes_of_background(
        &self,
        name: &str,
        colour: [NodeId; 3],
        span: Span,
    ) -> Option<Diagnostic> {
        // A sky may be brighter than white.
        const ALL_ABOVE: f64 = 2.0;
        const ONE_ABOVE: f64 = 16.0;
        let found = self.lowerer.numbers(&colour);
        let is_byte = found.iter().all(|number| (0.0..=255.0).contains(number));
        let is_bright = found.iter().all(|number| *number >= ALL_ABOVE)
            || found.iter().any(|number| *number > ONE_ABOVE);
        (is_byte && is_bright).then(|| far_too_bright(error::BRIGHT_BACKGROUND, span, name, found))
    }

    /// Returns red, green and blue of a value.
    fn colour(&mut self, body: Expression, lowered: &Lowered) -> Option<[NodeId; 3]> {
        let value = lowered.value.as_ref()?;
        if let Value::Number(grey) = value {
            return Some([*grey; 3]);
        }
        if let Ok(colour) = <[NodeId; 3]>::try_from(value.components()) {
            return Some(colour);
        }
        let message = format!(
            "a colour is a number or three, but this is {}",
            kind_of(value)
        );
        let error = SemanticError::new(error::ATTRIBUTE_DIMENSION, message);
        let span = self.lowerer.code.span(body);
        self.found.push(error.at(span));
        None
    }
}

/// Returns a warning about each attribute that has no effect on a light of this kind.
fn unused_by_light(
    name: &str,
    has_position: bool,
    has_direction: bool,
    attributes: &[Attribute],
) -> Vec<Diagnostic> {
    let is_beam = attributes.iter().any(|it| it.word == "radius");
    let (kind, unused): (_, &[&str]) = match (has_position, has_direction, is_beam) {
        (true, true, false) => return Vec::new(),
        (true, true, true) => ("a beam", &["angle", "size"]),
        (true, false, _) => ("a light in all directions", &["angle", "soft", "radius"]),
        (false, ..) => (
            "parallel light from far away",
            &["angle", "soft", "radius", "size", "falloff"],
        ),
    };
    let unused = attributes.iter().filter(|it| unused.contains(&it.word));
    let warning = |it: &Attribute| {
        let message = format!("`{}` has no effect on `{name}`, {kind}", it.word);
        let hint = match (has_position, has_direction) {
            (true, true) => "a beam has a `radius` and `soft`; without `radius` it is a cone",
            (true, false) => "a cone or a beam has a direction before the `@`",
            _ => "a light at a position has an `@` before it",
        };
        Diagnostic::warning(error::UNUSED_ATTRIBUTE, it.span, message).with_hint(hint)
    };
    unused.map(warning).collect()
}

/// Returns a warning about a colour of bytes.
fn far_too_bright(code: Code, span: Span, name: &str, colour: Vec<f64>) -> Diagnostic {
    let numbers: Vec<String> = colour.into_iter().map(number::text).collect();
    let message = format!(
        "`{name}` is far brighter than white: ({})",
        numbers.join(", ")
    );
    let hint = "components of colours are 0…1: divide by 255";
    Diagnostic::warning(code, span, message).with_hint(hint)
}
