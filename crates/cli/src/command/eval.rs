//! `geotrace eval`: the value of an expression in a program's scope.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use scene::{Instance, Outcome, Value};
use serde::Serialize;

use crate::argument::{self, Assignment, Format};
use crate::failure::Failure;
use crate::number;
use crate::output;
use crate::program::{self, LoadedProgram};
use crate::registry::Context;
use crate::source::SourceText;

/// Print the value of an expression that may use everything the program declares.
///
/// Where the expression depends on grids, there is one value for each combination of their values. An undefined
/// number, such as 0/0, is printed as `undefined`, in JSON as null.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  geotrace eval circle.gtr \"c'(pi/2)\"
  geotrace eval circle.gtr 'c(o) + (0, 0, 1)' --set r=0.7 --set o=1
  echo 'function f(x, y) = x^2 y;' | geotrace eval - 'f_x(3, 2)' --format json")]
pub(super) struct Arguments {
    /// The program; `-` is standard input
    file: PathBuf,
    /// The expression, as if written at the end of the program
    #[arg(allow_hyphen_values = true, value_name = "EXPR")]
    expression: String,
    /// A value for a param or a grid, NAME=A,B for components; may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = argument::assignment, allow_hyphen_values = true)]
    set: Vec<Assignment>,
    /// Human-readable text, or one JSON document
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    format: Format,
}

/// The JSON document; undefined numbers are null.
#[derive(Serialize)]
#[serde(untagged)]
enum EvaluationJson<'a> {
    Single { value: JsonValue<'a> },
    Instances { instances: Vec<JsonInstance<'a>> },
}

#[derive(Serialize)]
struct JsonInstance<'a> {
    grids: serde_json::Map<String, serde_json::Value>,
    value: JsonValue<'a>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum JsonValue<'a> {
    Number(Option<f64>),
    Vector(&'a [Option<f64>]),
    Text(&'a str),
}

/// Evaluates one expression.
pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    let mut program = LoadedProgram::load(context, &arguments.file, arguments.format)?;
    let params = program.set_params(&arguments.set)?;
    let expression = SourceText::new("<expression>".into(), arguments.expression.clone());
    let evaluation = match program.evaluate(&expression.text, &params) {
        Ok(evaluation) => evaluation,
        Err(diagnostics) => {
            program::report_diagnostics(&expression, &diagnostics, arguments.format)?;
            return Err(Failure::ProgramHasErrors);
        }
    };
    program::report_diagnostics(&expression, &evaluation.warnings, arguments.format)?;
    match arguments.format {
        Format::Human => output::print(&text(&evaluation.outcome)),
        Format::Json => output::print_json(&document(&evaluation.outcome)),
    }
}

/// One line per value: `(1, 2)`, or `k = 0.5, m = (1, 2): (1, 2)`.
fn text(outcome: &Outcome) -> String {
    match outcome {
        Outcome::Single(value) => format!("{}\n", shown(value)),
        Outcome::Instances(instances) => {
            let mut text = String::new();
            for instance in instances {
                let grids: Vec<String> = instance
                    .grids
                    .iter()
                    .map(|(name, values)| format!("{name} = {}", number::show_all(values)))
                    .collect();
                // Writing to a string cannot fail.
                let _ = writeln!(text, "{}: {}", grids.join(", "), shown(&instance.value));
            }
            text
        }
    }
}

fn shown(value: &Value) -> String {
    let exact = |number: &Option<f64>| number.unwrap_or(f64::NAN);
    match value {
        Value::Number(value) => number::show(exact(value)),
        Value::Vector(values) => {
            let values: Vec<f64> = values.iter().map(exact).collect();
            number::show_all(&values)
        }
        Value::Text(text) => text.clone(),
    }
}

fn document(outcome: &Outcome) -> EvaluationJson<'_> {
    match outcome {
        Outcome::Single(value) => EvaluationJson::Single {
            value: json_value(value),
        },
        Outcome::Instances(instances) => EvaluationJson::Instances {
            instances: instances.iter().map(json_instance).collect(),
        },
    }
}

fn json_instance(instance: &Instance) -> JsonInstance<'_> {
    let grid = |(name, values): &(String, Vec<f64>)| {
        let value = match values[..] {
            [only] => serde_json::Value::from(only),
            _ => serde_json::Value::from(values.clone()),
        };
        (name.clone(), value)
    };
    JsonInstance {
        grids: instance.grids.iter().map(grid).collect(),
        value: json_value(&instance.value),
    }
}

fn json_value(value: &Value) -> JsonValue<'_> {
    match value {
        Value::Number(value) => JsonValue::Number(*value),
        Value::Vector(values) => JsonValue::Vector(values),
        Value::Text(text) => JsonValue::Text(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn json(outcome: &Outcome) -> String {
        serde_json::to_string(&document(outcome)).expect("JSON")
    }

    #[test]
    fn single_values_have_the_form_of_the_contract() {
        let number = Outcome::Single(Value::Number(Some(0.5)));
        assert_eq!(json(&number), r#"{"value":0.5}"#);
        assert_eq!(text(&number), "0.5\n");
        let undefined = Outcome::Single(Value::Number(None));
        assert_eq!(json(&undefined), r#"{"value":null}"#);
        assert_eq!(text(&undefined), "undefined\n");
        let vector = Outcome::Single(Value::Vector(vec![Some(1.0), None]));
        assert_eq!(json(&vector), r#"{"value":[1.0,null]}"#);
        assert_eq!(text(&vector), "(1, undefined)\n");
    }

    #[test]
    fn instances_name_their_grids() {
        let outcome = Outcome::Instances(vec![Instance {
            grids: vec![("k".into(), vec![0.0]), ("m".into(), vec![1.0, 2.5])],
            value: Value::Number(Some(1.0)),
        }]);
        assert_eq!(
            json(&outcome),
            r#"{"instances":[{"grids":{"k":0.0,"m":[1.0,2.5]},"value":1.0}]}"#
        );
        assert_eq!(text(&outcome), "k = 0, m = (1, 2.5): 1\n");
    }
}
