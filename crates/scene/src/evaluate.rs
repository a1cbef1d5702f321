//! The value of a lone expression in a program's scope.

use syntax::diagnostic::Diagnostic;

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
