//! Kernels: generated functions joined with the pass that calls them.

use std::fmt;

use expr::statistics::operation_count;
use expr::{Graph, Input, NodeId};

use crate::contract;
use crate::emit::{self, Body};
use crate::join::{InternalError, Joined, join};
use crate::library::{self, Piece};

/// Generated functions with more operations than this are rejected: a driver would compile them for minutes.
pub const OPERATION_LIMIT: usize = 20_000;

/// A validated compute shader with one entry point, and its inputs.
#[derive(Clone, Debug)]
pub struct Kernel {
    joined: Joined,
    generated: String,
    uniforms: Vec<u32>,
    operations: usize,
}

impl Kernel {
    /// Returns the whole text.
    pub fn source(&self) -> &str {
        self.joined.source()
    }
    /// Returns the joined shader.
    pub fn joined(&self) -> &Joined {
        &self.joined
    }
    /// Returns the generated functions alone.
    pub fn generated(&self) -> &str {
        &self.generated
    }
    /// Returns the name of its entry point.
    pub fn entry_point(&self) -> &str {
        self.joined.entry_points().next().unwrap_or_default()
    }
    /// Returns the uniforms in use, the numbers of `expr::Input::Uniform` in ascending order: a row of the uniform
    /// buffer contains exactly these.
    pub fn uniforms(&self) -> &[u32] {
        &self.uniforms
    }
    /// Returns the number of operations in one evaluation of the generated functions, counting shared subexpressions
    /// once.
    pub fn operations(&self) -> usize {
        self.operations
    }
}

/// The reason why there is no kernel.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum GenerateError {
    /// The expression, or its derivatives, are too large for a shader; they can still be evaluated in f64.
    TooLarge {
        /// The number of operations, if they could be counted.
        operations: Option<usize>,
    },
    /// A fault of this program.
    Internal(InternalError),
}

impl fmt::Display for GenerateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLarge {
                operations: Some(count),
            } => {
                write!(
                    f,
                    "{count} operations are too many for a shader (the limit is {OPERATION_LIMIT})"
                )
            }
            Self::TooLarge { operations: None } => {
                write!(f, "the derivatives are too large for a shader")
            }
            Self::Internal(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for GenerateError {}

impl From<InternalError> for GenerateError {
    fn from(error: InternalError) -> Self {
        Self::Internal(error)
    }
}

impl From<expr::graph::TooLarge> for GenerateError {
    fn from(_: expr::graph::TooLarge) -> Self {
        Self::TooLarge { operations: None }
    }
}

/// Samples of a point: instances → positions.
///
/// # Errors
/// [`GenerateError::TooLarge`] if the expressions have too many operations, [`GenerateError::Internal`] if naga
/// rejects the joined text.
pub fn sample_point(graph: &Graph, position: [NodeId; 3]) -> Result<Kernel, GenerateError> {
    let functions = [Function::vector(
        "point_position(instance: u32) -> vec3f",
        position,
    )];
    generate(
        graph,
        &functions,
        &library::CONTRACT_POINT,
        &[library::NUMBER, library::POWER, library::SAMPLING],
        &library::PASS_SAMPLE_POINT,
    )
}

/// Samples of a vector: instances → origins and directions.
///
/// # Errors
/// [`GenerateError::TooLarge`] if the expressions have too many operations, [`GenerateError::Internal`] if naga
/// rejects the joined text.
pub fn sample_vector(
    graph: &Graph,
    direction: [NodeId; 3],
    origin: [NodeId; 3],
) -> Result<Kernel, GenerateError> {
    let functions = [
        Function::vector("vector_direction(instance: u32) -> vec3f", direction),
        Function::vector("vector_origin(instance: u32) -> vec3f", origin),
    ];
    generate(
        graph,
        &functions,
        &library::CONTRACT_VECTOR,
        &[library::NUMBER, library::POWER, library::SAMPLING],
        &library::PASS_SAMPLE_VECTOR,
    )
}

/// Samples of a curve: instances and `Variable(0)` → positions.
///
/// # Errors
/// [`GenerateError::TooLarge`] if the expressions have too many operations, [`GenerateError::Internal`] if naga
/// rejects the joined text.
pub fn sample_curve(graph: &Graph, position: [NodeId; 3]) -> Result<Kernel, GenerateError> {
    let functions = [Function::vector(
        "curve_position(u: f32, instance: u32) -> vec3f",
        position,
    )];
    generate(
        graph,
        &functions,
        &library::CONTRACT_CURVE,
        &[library::NUMBER, library::POWER, library::SAMPLING],
        &library::PASS_SAMPLE_CURVE,
    )
}

/// Samples of a surface: instances, `Variable(0)` and `Variable(1)` → positions and normals.
///
/// # Errors
/// [`GenerateError::TooLarge`] if the expressions or their derivatives have too many operations,
/// [`GenerateError::Internal`] if naga rejects the joined text.
pub fn sample_surface(graph: &Graph, position: [NodeId; 3]) -> Result<Kernel, GenerateError> {
    let (mut graph, roots) = graph.extract(&position);
    let du = graph.derivatives(&roots, Input::Variable(0))?;
    let dv = graph.derivatives(&roots, Input::Variable(1))?;
    let functions = [Function {
        header: "surface_tangents(u: f32, v: f32, instance: u32) -> Tangents",
        roots: [roots, du, dv].concat(),
        result: ResultForm::Vectors("Tangents"),
    }];
    generate(
        &graph,
        &functions,
        &library::CONTRACT_SURFACE,
        &[
            library::NUMBER,
            library::POWER,
            library::SAMPLING,
            library::JET,
        ],
        &library::PASS_SAMPLE_SURFACE,
    )
}

/// Expressions over rows of inputs: for comparing a GPU's results with f64.
///
/// # Errors
/// [`GenerateError::TooLarge`] if the expressions have too many operations, [`GenerateError::Internal`] if naga
/// rejects the joined text.
pub fn evaluate(graph: &Graph, roots: &[NodeId]) -> Result<Kernel, GenerateError> {
    let functions = [Function {
        header: "evaluate(row: u32)",
        roots: roots.to_vec(),
        result: ResultForm::Stored,
    }];
    generate(
        graph,
        &functions,
        &library::CONTRACT_EVALUATE,
        &[library::NUMBER, library::POWER, library::SAMPLING],
        &library::PASS_EVALUATE,
    )
}

/// A function to be generated.
struct Function {
    /// Its signature after `fn`.
    header: &'static str,
    roots: Vec<NodeId>,
    result: ResultForm,
}

/// The form in which generated functions return the values of the roots.
enum ResultForm {
    /// Three roots are a vec3f.
    Vector,
    /// Every three roots are a vec3f, each a member of this struct.
    Vectors(&'static str),
    /// Each root is passed to `store_output`.
    Stored,
}

impl Function {
    fn vector(header: &'static str, roots: [NodeId; 3]) -> Self {
        Self {
            header,
            roots: roots.to_vec(),
            result: ResultForm::Vector,
        }
    }

    fn write(&self, graph: &Graph, uniforms: &[u32]) -> String {
        let stored = matches!(self.result, ResultForm::Stored);
        let instance = if stored { "row" } else { "instance" };
        let input = |input: Input| match input {
            Input::Variable(k) if stored => format!("input_value(row, {k}u)"),
            Input::Variable(0) => "u".to_owned(),
            Input::Variable(_) => "v".to_owned(),
            Input::Uniform(k) => {
                // The list contains every uniform on which the roots depend.
                let slot = uniforms.partition_point(|&uniform| uniform < k);
                format!("uniform_value({instance}, {slot}u)")
            }
        };
        let Body { lets, roots } = emit::body(graph, &self.roots, &input);
        let vectors = |roots: &[String]| {
            roots
                .chunks(3)
                .map(|of| format!("vec3f({})", of.join(", ")))
                .collect::<Vec<_>>()
        };
        let end = match self.result {
            ResultForm::Vector => format!("    return {};\n", vectors(&roots).concat()),
            ResultForm::Vectors(name) => {
                format!(
                    "    return {name}(\n        {},\n    );\n",
                    vectors(&roots).join(",\n        ")
                )
            }
            ResultForm::Stored => roots
                .iter()
                .enumerate()
                .map(|(index, root)| format!("    store_output(row, {index}u, {root});\n"))
                .collect(),
        };
        format!("fn {} {{\n{lets}{end}}}\n", self.header)
    }
}

/// Writes the functions, compares them with their contract and the pass with its provided functions, and joins them.
fn generate(
    graph: &Graph,
    functions: &[Function],
    contract: &Piece<'_>,
    library: &[Piece<'_>],
    pass: &Piece<'_>,
) -> Result<Kernel, GenerateError> {
    let roots: Vec<NodeId> = functions
        .iter()
        .flat_map(|function| &function.roots)
        .copied()
        .collect();
    let operations = functions
        .iter()
        .map(|function| operation_count(graph, &function.roots))
        .sum();
    if operations > OPERATION_LIMIT {
        return Err(GenerateError::TooLarge {
            operations: Some(operations),
        });
    }
    let uniforms: Vec<u32> = graph
        .inputs(&roots)
        .into_iter()
        .filter_map(|input| match input {
            Input::Uniform(k) => Some(k),
            Input::Variable(_) => None,
        })
        .collect();
    let texts: Vec<String> = functions
        .iter()
        .map(|function| function.write(graph, &uniforms))
        .collect();
    let generated = texts.join("\n");
    let piece = Piece {
        origin: "generated",
        text: &generated,
    };
    contract::is_exactly(&piece, &[*contract])?;
    contract::fulfils(pass, &library::CONTRACT_UNIFORMS)?;
    if functions
        .iter()
        .any(|function| matches!(function.result, ResultForm::Stored))
    {
        contract::fulfils(pass, &library::CONTRACT_TABLE)?;
    }
    let mut pieces = library.to_vec();
    pieces.push(piece);
    pieces.push(*pass);
    let joined = join(&pieces)?;
    Ok(Kernel {
        joined,
        generated,
        uniforms,
        operations,
    })
}
