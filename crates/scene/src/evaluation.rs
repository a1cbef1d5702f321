//! The values of expressions over a scene's params and grids.
//!
//! In: nodes of a graph and the values of the params. Out: a value, or one for each combination of the values of the grids
//! that the expression depends on.

use expr::tape::{Registers, Tape};
use expr::{Graph, value};
use syntax::diagnostic::Diagnostic;

use crate::param_values::ParamValues;
use crate::scene::{GridId, Scene};

/// A number or a vector at the present values of the params.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number; `None` if it is undefined (not finite).
    Number(Option<f64>),
    /// A vector of dimension 2 or more; `None` for each component that is undefined.
    Vector(Vec<Option<f64>>),
    /// A value of another type, in the syntax of its language.
    Text(String),
}

/// The value for one combination of the grids' values.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// The grids that the expression depends on and that are not fixed, in the order of the text, each with its name
    /// and its value: one number per axis.
    pub grids: Vec<(String, Vec<f64>)>,
    /// The expression's value there.
    pub value: Value,
}

/// The value of an expression, or its values over grids.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// One value: the expression depends on no grid that is not fixed.
    Single(Value),
    /// A value for each combination of the grids' values, the last axis fastest.
    Instances(Vec<Instance>),
}

/// An outcome with the warnings about the expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// The value, or the values.
    pub outcome: Outcome,
    /// Warnings and hints; their spans refer to the expression's text.
    pub warnings: Vec<Diagnostic>,
}

/// Evaluates an expression for each combination of the values of the grids that are not fixed. `fill` writes the numbers of
/// geodesics into the uniforms.
pub(crate) fn evaluate(
    scene: &Scene,
    graph: &Graph,
    expression: &value::Value,
    grids: &[GridId],
    values: &ParamValues,
    mut fill: impl FnMut(&mut Vec<f64>),
) -> Outcome {
    let is_open = |id: &GridId| values.fixed_grid(scene, *id).is_none();
    let grids: Vec<GridId> = grids.iter().copied().filter(is_open).collect();
    let roots = expression.components();
    let tape = Tape::new(graph, roots);
    let mut registers = Registers::default();
    let mut numbers = vec![f64::NAN; roots.len()];
    let mut at = |uniforms: &[f64]| {
        let inputs: Vec<f64> = tape
            .inputs()
            .iter()
            .map(|input| input.value(&[], uniforms))
            .collect();
        tape.eval(&mut registers, &inputs, &mut numbers);
        let mut defined = numbers
            .iter()
            .map(|&number| number.is_finite().then_some(number));
        match expression {
            value::Value::Number(_) => Value::Number(defined.next().flatten()),
            value::Value::Vector(_) => Value::Vector(defined.collect()),
        }
    };

    let mut uniforms = values.uniforms().to_vec();
    if grids.is_empty() {
        fill(&mut uniforms);
        return Outcome::Single(at(&uniforms));
    }
    let instances = (0..values.combinations(scene, &grids)).map(|index| {
        values.combination(scene, &grids, index, &mut uniforms);
        fill(&mut uniforms);
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
    Outcome::Instances(instances.collect())
}
