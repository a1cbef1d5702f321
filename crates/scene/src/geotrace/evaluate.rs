//! The value of a lone expression in a program's scope.
//!
//! In: an expression's text, and the values of the params. Out: its value, or one for each combination of the values of
//! the grids that it depends on.

use std::sync::Arc;

use expr::value::Value;
use syntax::diagnostic::Diagnostic;
use syntax::geotrace::parse_expression;
use syntax::geotrace::symbols::Parsed;
use syntax::span::Span;

use crate::evaluation::{Evaluation, Outcome, evaluate};
use crate::geotrace::declarations::Declarations;
use crate::geotrace::dependencies::Dependencies;
use crate::geotrace::error::{self, SemanticError, has_errors};
use crate::geotrace::geodesics::GeodesicFaults;
use crate::limits::MAX_INSTANCES;
use crate::param_values::ParamValues;

/// The names that an expression may use: everything that a program without errors declares.
#[derive(Clone, Debug)]
pub(crate) struct Scope(Arc<ScopeData>);

#[derive(Debug)]
struct ScopeData {
    names: Parsed,
    declarations: Declarations,
    /// The offset of each line's end.
    line_ends: Vec<u32>,
}

impl Scope {
    pub(crate) fn new(source: &str, names: Parsed, declarations: Declarations) -> Self {
        let line_ends = source
            .bytes()
            .zip(0..)
            .filter_map(|(byte, offset)| (byte == b'\n').then_some(offset))
            .collect();
        Self(Arc::new(ScopeData {
            names,
            declarations,
            line_ends,
        }))
    }

    /// See [`Compilation::evaluate`](super::Compilation::evaluate).
    pub(crate) fn evaluate(
        &self,
        text: &str,
        params: &ParamValues,
    ) -> Result<Evaluation, Vec<Diagnostic>> {
        let program = &*self.0;
        let mut declarations = program.declarations.clone();
        parse_expression(text, &program.names, &mut declarations);
        let mut found = std::mem::take(&mut declarations.diagnostics);
        let code = &declarations.lowerer.code;
        let body = match code.last_before(code.end()) {
            Some([body]) if !has_errors(&found) => body,
            _ => {
                Diagnostic::sort(&mut found);
                return Err(found);
            }
        };
        let mut errors = Vec::new();
        let lowered = declarations.lowerer.lower(body, Vec::new(), &mut errors);
        found.extend(errors.into_iter().map(|error| program.place_in_hint(error)));
        Diagnostic::sort(&mut found);
        let Some(result) = lowered.value.filter(|_| !has_errors(&found)) else {
            return Err(found);
        };
        let whole = Span::new(0, u32::try_from(text.len()).unwrap_or(u32::MAX));
        match outcome(&declarations, &result, lowered.dependencies, params) {
            Ok((outcome, faults)) => {
                let faults = faults.into_iter();
                found.extend(faults.map(|(name, fault)| {
                    let message = format!("`{name}` has no value here: {fault}");
                    Diagnostic::warning(error::GEODESIC_UNDEFINED, whole, message)
                }));
                Ok(Evaluation {
                    outcome,
                    warnings: found,
                })
            }
            Err(error) => {
                found.push(error.at(whole));
                Diagnostic::sort(&mut found);
                Err(found)
            }
        }
    }
}

impl ScopeData {
    /// Moves the related locations of an error in a function's body into the hint: they are in the program, not in the
    /// expression's text.
    fn place_in_hint(&self, mut diagnostic: Diagnostic) -> Diagnostic {
        let places = std::mem::take(&mut diagnostic.related);
        if let Some(place) = places.first() {
            let line = self
                .line_ends
                .partition_point(|&end| end < place.span.start)
                + 1;
            let told = format!("line {line} of the program: {}", place.message);
            diagnostic.hint = Some(match diagnostic.hint {
                Some(hint) => format!("{hint} ({told})"),
                None => told,
            });
        }
        diagnostic
    }
}

/// Evaluates a value for each combination of the grids that it depends on. Also returns the geodesics that have no
/// value for some of these, each with the first reason.
///
/// # Errors
/// If there are more than [`MAX_INSTANCES`] combinations.
pub(crate) fn outcome(
    declarations: &Declarations,
    value: &Value,
    dependencies: Dependencies,
    values: &ParamValues,
) -> Result<(Outcome, GeodesicFaults), SemanticError> {
    let (_, grids) = declarations.sources_of(dependencies);
    let (scene, graph) = (&declarations.scene, &declarations.lowerer.graph);
    let count = values.combinations(scene, &grids);
    if count > MAX_INSTANCES {
        return Err(SemanticError::new(
            error::TOO_MANY_INSTANCES,
            format!(
                "this expression has {count} values, one for each combination of the grids' values; the limit is {MAX_INSTANCES}"
            ),
        )
        .with_hint("give a grid one value"));
    }
    let lowerer = &declarations.lowerer;
    let mut faults = GeodesicFaults::new();
    let fill = |uniforms: &mut Vec<f64>| {
        uniforms.resize(lowerer.dependencies.uniform_count() as usize, f64::NAN);
        for (name, fault) in lowerer.geodesics.fill(graph, value.components(), uniforms) {
            if faults.iter().all(|(known, _)| *known != name) {
                faults.push((name, fault));
            }
        }
    };
    let outcome = evaluate(scene, graph, value, &grids, values, fill);
    Ok((outcome, faults))
}
