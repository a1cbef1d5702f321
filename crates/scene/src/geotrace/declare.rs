//! Declarations: from a declaration that has been read to a symbol's meaning and, if it is drawn, an object of the
//! scene.

use syntax::diagnostic::{Diagnostic, Related};
use syntax::geotrace::actions::{Declaration, Parameter};
use syntax::geotrace::codes::MISSING_INTERVAL;
use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::span::Span;

use crate::geotrace::declarations::{Declarations, Understood, constant};
use crate::geotrace::error::{self, SemanticError};
use crate::geotrace::interval::{DeclaredInterval, Purpose};
use crate::geotrace::lowerer::too_large;
use crate::limits::DEFAULT_SAMPLES;
use crate::scene::{Sampling, Shape};

impl Declarations {
    /// Computes the meaning of a declaration; `None` after an error.
    pub(super) fn meaning(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
        match declaration.keyword {
            DeclarationKeyword::Param => self.param(declaration, intervals),
            DeclarationKeyword::Grid => self.grid(declaration, intervals),
            DeclarationKeyword::Define => {
                let [body] = self.expressions(intervals)?;
                let lowered = self.constant(body);
                Some(constant(lowered.value?, lowered.dependencies).into())
            }
            DeclarationKeyword::Function => self.function(declaration),
            DeclarationKeyword::Point => self.point(declaration, intervals),
            DeclarationKeyword::Vector => self.vector(declaration, intervals),
            DeclarationKeyword::Curve => self.curve(declaration, intervals),
            DeclarationKeyword::Surface => self.surface(declaration, intervals),
            DeclarationKeyword::Metric => self.metric(declaration, intervals),
            DeclarationKeyword::Geodesic => self.geodesic(declaration, intervals),
            DeclarationKeyword::Solid => self.solid(declaration, intervals),
            DeclarationKeyword::Light => self.light(declaration, intervals),
            DeclarationKeyword::Camera => self.camera(declaration, intervals),
            DeclarationKeyword::Background => self.background(declaration, intervals),
        }
    }

    /// Stores a function's body as read, because its type depends on its applications.
    fn function(&mut self, declaration: &Declaration<'_>) -> Option<Understood> {
        let [body] = self.expressions(&[])?;
        // An error that does not depend on the arguments is reported at its span in the body.
        let symbols = &self.lowerer.symbols;
        let totals = self.lowerer.code.totals(body);
        let totals =
            totals.filter_map(|(symbol, span)| Some(symbols.total_error(symbol)?.at(span)));
        let errors: Vec<Diagnostic> = totals.collect();
        let sound = errors.is_empty();
        self.found.extend(errors);
        sound.then(|| self.keep(declaration, body).into())
    }

    fn point(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
        let [body] = self.expressions(intervals)?;
        let lowered = self.constant(body);
        let position = self.in_space(body, &lowered, "a point");
        let (attributes, all) = self.stated_with(declaration, 0, lowered.dependencies);
        let shape = Shape::Point {
            position: position?,
        };
        let drawn = self.object(declaration, shape, all, attributes);
        let meaning = constant(lowered.value?, lowered.dependencies);
        Some(Understood::from(meaning).drawn(drawn))
    }

    fn vector(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
        let [direction, origin] = self.expressions(intervals)?;
        let lowered = self.constant(direction);
        let towards = self.in_space(direction, &lowered, "a vector's direction");
        let start = self.constant(origin);
        let from = self.in_space(origin, &start, "a vector's origin");
        let sets = &mut self.lowerer.dependencies;
        let dependencies = sets.union(lowered.dependencies, start.dependencies);
        let (attributes, all) = self.stated_with(declaration, 0, dependencies);
        let drawn = from.zip(towards).and_then(|(origin, direction)| {
            let shape = Shape::Vector { direction, origin };
            self.object(declaration, shape, all, attributes)
        });
        // The name denotes the direction, which is valid even if the origin is not.
        towards?;
        let meaning = constant(lowered.value?, lowered.dependencies);
        Some(Understood::from(meaning).drawn(drawn))
    }

    fn curve(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
        let domain = self.domain(declaration, intervals, "a curve has one parameter");
        let [body] = self.expressions(intervals)?;
        self.lowerer.is_along_curve = true;
        let lowered = self.over_variables(body, declaration.parameters.len());
        self.lowerer.is_along_curve = false;
        let position = self.in_space(body, &lowered, "a curve");
        let (attributes, all) = self.stated_with(declaration, 1, lowered.dependencies);
        let mut position = position?;
        let lowerer = &mut self.lowerer;
        let followed = lowerer.geodesics.follow(&mut lowerer.graph, &mut position);
        let followed = followed.map_err(|_| too_large());
        let span = self.lowerer.code.span(body);
        let followed = self.sound(followed, span)?;
        let [domain] = domain?;
        let shape = Shape::Curve {
            followed,
            position,
            domain: domain?,
            parameter: declaration.parameters.first()?.name.clone(),
        };
        let drawn = self.object(declaration, shape, all, attributes);
        Some(Understood::from(self.keep(declaration, body)).drawn(drawn))
    }

    fn surface(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
        let domain = self.domain(declaration, intervals, "a surface has two parameters");
        let [body] = self.expressions(intervals)?;
        let lowered = self.over_variables(body, declaration.parameters.len());
        let position = self.in_space(body, &lowered, "a surface");
        let (attributes, all) = self.stated_with(declaration, 2, lowered.dependencies);
        let position = position?;
        let [u, v] = domain?;
        let [first, second] = declaration.parameters else {
            return None;
        };
        let shape = Shape::Surface {
            position,
            domain: [u?, v?],
            parameters: [first.name.clone(), second.name.clone()],
        };
        let drawn = self.object(declaration, shape, all, attributes);
        Some(Understood::from(self.keep(declaration, body)).drawn(drawn))
    }

    /// Returns the sampled intervals of a curve or a surface in the order of its parameters, `None` for each one with an
    /// error. Returns `None` for all if the number of parameters or a tag is wrong.
    pub(crate) fn domain<const N: usize>(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
        rule: &str,
    ) -> Option<[Option<Sampling>; N]> {
        let parameters = declaration.parameters;
        let mut sound = parameters.len() == N;
        if !sound {
            let error = SemanticError::new(
                error::PARAMETER_COUNT,
                format!(
                    "{rule}, but `{}` has {}",
                    declaration.name,
                    parameters.len()
                ),
            );
            self.found
                .push(error.at(list_span(parameters, declaration.name_span)));
        }
        let mut by_parameter: Vec<Option<&DeclaredInterval>> = vec![None; parameters.len()];
        for interval in intervals {
            let Some((position, tag)) = interval.read.tag else {
                continue;
            };
            // An unknown tag has been reported, but not which parameter was meant.
            let place = position.and_then(|position| by_parameter.get_mut(position as usize));
            let Some(place) = place else {
                sound = false;
                by_parameter.clear();
                break;
            };
            match place {
                None => *place = Some(interval),
                Some(first) => {
                    let position = position.unwrap_or_default() as usize;
                    let name = parameters.get(position).map_or("", |named| &*named.name);
                    let mut error = SemanticError::new(
                        error::DUPLICATE_TAG,
                        format!("the parameter `{name}` has two intervals"),
                    );
                    error.trail.extend(first.read.tag.map(|(_, span)| Related {
                        span,
                        message: "its first interval is here".to_owned(),
                    }));
                    self.found.push(error.at(tag));
                    sound = false;
                }
            }
        }
        for (parameter, interval) in parameters.iter().zip(&by_parameter) {
            if interval.is_none() {
                let name = &parameter.name;
                let error = SemanticError::new(
                    MISSING_INTERVAL,
                    format!("the parameter `{name}` has no interval"),
                )
                .with_hint(format!("add one before the `;`: `, {name} : [0, 1]`"));
                self.found.push(error.at(parameter.span));
                sound = false;
            }
        }
        // Errors in the intervals are reported even if their tags are wrong.
        let samplings: Vec<Option<Sampling>> = intervals
            .iter()
            .map(|interval| {
                let lowerer = &mut self.lowerer;
                let bounds = interval.bounds(lowerer, Purpose::Domain, &mut self.found)?;
                Some(bounds.sampling(DEFAULT_SAMPLES))
            })
            .collect();
        if !sound {
            return None;
        }
        let mut domain = [None; N];
        for (interval, sampling) in intervals.iter().zip(samplings) {
            if let Some((Some(position), _)) = interval.read.tag
                && let Some(place) = domain.get_mut(position as usize)
            {
                *place = sampling;
            }
        }
        Some(domain)
    }
}

/// Returns the span from the first parameter to the last.
pub(crate) fn list_span(parameters: &[Parameter], name: Span) -> Span {
    match parameters {
        [] => name,
        [first, .., last] => first.span.to(last.span),
        [only] => only.span,
    }
}
