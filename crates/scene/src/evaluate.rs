//! The value of a lone expression in a program's scope.
//!
//! What flows in: an expression's text, and the values of the params. What flows out: its value, or one for
//! each combination of the values of the grids that it depends on.

use std::sync::Arc;

use expr::tape::{Registers, Tape};
use expr::{Input, value};
use syntax::diagnostic::Diagnostic;
use syntax::parse_expression;
use syntax::span::Span;
use syntax::symbols::Parsed;

use crate::compile::{Compiler, has_errors};
use crate::declare::Declarations;
use crate::fault::{self, Fault};
use crate::limits::MAX_INSTANCES;
use crate::reads::Reads;
use crate::values::Settings;

/// A number or a vector as it is at the current values of the params.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number; none where it is undefined (not finite).
    Number(Option<f64>),
    /// A vector of dimension 2 or more; none for each component that is undefined.
    Vector(Vec<Option<f64>>),
}

/// The value for one combination of the grids' values.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// The grids that the expression depends on and that are not fixed, in the order of the text, each with
    /// its name and its value: one number per axis.
    pub grids: Vec<(String, Vec<f64>)>,
    /// The expression's value there.
    pub value: Value,
}

/// What an expression evaluates to.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// One value: it depends on no grid that is not fixed.
    Single(Value),
    /// A value for each combination of the grids' values, the last axis fastest.
    Instances(Vec<Instance>),
}

/// An outcome, and what was surprising about the expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// What the expression evaluates to.
    pub outcome: Outcome,
    /// Warnings and hints; spans are those of the expression's text.
    pub warnings: Vec<Diagnostic>,
}

/// What an expression may use: everything that a program without errors has declared.
#[derive(Clone, Debug)]
pub(crate) struct Scope(Arc<Program>);

#[derive(Debug)]
struct Program {
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
        Self(Arc::new(Program {
            names,
            declarations,
            line_ends,
        }))
    }

    /// As [`crate::Compilation::evaluate`].
    pub(crate) fn evaluate(
        &self,
        text: &str,
        settings: &Settings,
    ) -> Result<Evaluation, Vec<Diagnostic>> {
        let program = &*self.0;
        let mut compiler = Compiler {
            declarations: program.declarations.clone(),
        };
        parse_expression(text, &program.names, &mut compiler);
        let mut declarations = compiler.declarations;
        let mut found = std::mem::take(&mut declarations.diagnostics);
        let code = &declarations.lowerer.code;
        let body = match code.last_before(code.end()) {
            Some([body]) if !has_errors(&found) => body,
            _ => {
                Diagnostic::sort(&mut found);
                return Err(found);
            }
        };
        let mut faults = Vec::new();
        let lowered = declarations.lowerer.lower(body, Vec::new(), &mut faults);
        found.extend(faults.into_iter().map(|fault| program.place_in_hint(fault)));
        Diagnostic::sort(&mut found);
        let Some(result) = lowered.value.filter(|_| !has_errors(&found)) else {
            return Err(found);
        };
        match outcome(&declarations, &result, lowered.reads, settings) {
            Ok(outcome) => Ok(Evaluation {
                outcome,
                warnings: found,
            }),
            Err(fault) => {
                let end = u32::try_from(text.len()).unwrap_or(u32::MAX);
                found.push(fault.at(Span::new(0, end)));
                Diagnostic::sort(&mut found);
                Err(found)
            }
        }
    }
}

impl Program {
    /// The related places of a fault in a function's body lie in the program, not in the expression's text:
    /// they are told in the hint.
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

/// Evaluates a value for each combination of the grids that it depends on.
fn outcome(
    declarations: &Declarations,
    result: &value::Value,
    reads: Reads,
    settings: &Settings,
) -> Result<Outcome, Fault> {
    let (_, mut grids) = declarations.dependencies(reads);
    let scene = &declarations.scene;
    grids.retain(|&id| settings.fixed_grid(scene, id).is_none());
    let roots = result.components();
    let tape = Tape::new(&declarations.lowerer.graph, roots);
    let mut registers = Registers::default();
    let mut numbers = vec![f64::NAN; roots.len()];
    let mut at = |uniforms: &[f64]| {
        let inputs: Vec<f64> = tape
            .inputs()
            .iter()
            .map(|input| match input {
                Input::Uniform(index) => uniforms.get(*index as usize).copied(),
                Input::Variable(_) => None,
            })
            .map(|number| number.unwrap_or(f64::NAN))
            .collect();
        tape.eval(&mut registers, &inputs, &mut numbers);
        let mut defined = numbers
            .iter()
            .map(|&number| number.is_finite().then_some(number));
        match result {
            value::Value::Number(_) => Value::Number(defined.next().flatten()),
            value::Value::Vector(_) => Value::Vector(defined.collect()),
        }
    };

    if grids.is_empty() {
        return Ok(Outcome::Single(at(settings.uniforms())));
    }
    let count = settings.combinations(scene, &grids);
    if count > MAX_INSTANCES {
        return Err(Fault::new(
            fault::TOO_MANY_INSTANCES,
            format!(
                "this expression has {count} values, one for each combination of the grids' values; the limit is {MAX_INSTANCES}"
            ),
        )
        .with_hint("give a grid one value"));
    }
    let mut uniforms = settings.uniforms().to_vec();
    let instances = (0..count).map(|index| {
        settings.combination(scene, &grids, index, &mut uniforms);
        let value = at(&uniforms);
        let grids = grids
            .iter()
            .filter_map(|id| scene.grids.get(id.0 as usize))
            .map(|grid| {
                let first = grid.first_uniform as usize;
                let axes = uniforms[first..first + grid.axes.len()].to_vec();
                (grid.name.clone(), axes)
            });
        Instance {
            grids: grids.collect(),
            value,
        }
    });
    Ok(Outcome::Instances(instances.collect()))
}
