//! The builtin names: the constants and functions of `expr`'s table of operations; `id`, the identity, which also takes
//! vectors; and `min` and `max`, which take only vectors.

use expr::Graph;
use expr::ops::{Binary, CONSTANTS, Unary};
use expr::value::{self, DimensionError, Value};
use syntax::geotrace::symbols::Vocabulary;

use crate::geotrace::foreign::FOREIGN_WORDS;

/// A builtin function.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Builtin {
    /// An operation on a number.
    Operation(Unary),
    /// `id`.
    Identity,
    /// `min` or `max`: a vector's minimum or maximum component.
    Extreme(Binary),
}

/// The functions that are words of their own only before a bracket. A program may declare their names.
const WEAK: [&str; 2] = ["min", "max"];

impl Builtin {
    /// Returns all builtin functions with their names.
    pub(crate) fn all() -> impl Iterator<Item = (&'static str, Self)> {
        let operations = Unary::ALL.into_iter();
        operations
            .filter_map(|op| Some((op.row().builtin?, Self::Operation(op))))
            .chain([("id", Self::Identity)])
            .chain([Binary::Min, Binary::Max].map(|op| (op.name(), Self::Extreme(op))))
    }

    /// Applies the function to an operand.
    pub(crate) fn apply(self, graph: &mut Graph, operand: &Value) -> Result<Value, DimensionError> {
        match self {
            Self::Operation(op) => value::apply(graph, op, operand),
            Self::Identity => Ok(operand.clone()),
            Self::Extreme(op) => value::extreme(graph, op, operand),
        }
    }
}

/// Returns the builtin names, for the parser.
pub fn vocabulary() -> Vocabulary {
    let constants = CONSTANTS.map(|(name, ..)| name);
    let functions: Vec<&str> = Builtin::all().map(|(name, _)| name).collect();
    let vocabulary = Vocabulary::new(&constants, &functions)
        .with_foreign(FOREIGN_WORDS)
        .with_weak(&WEAK);
    let inverses = [
        ("sin", "asin"),
        ("cos", "acos"),
        ("tan", "atan"),
        ("exp", "log"),
        ("log", "exp"),
    ];
    inverses
        .into_iter()
        .fold(vocabulary, |vocabulary, (function, inverse)| {
            vocabulary.with_inverse(function, inverse)
        })
}

/// Returns the number of builtin names; their symbols come first.
pub fn count() -> u32 {
    (CONSTANTS.len() + Builtin::all().count()) as u32
}
