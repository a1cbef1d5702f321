//! The pass of traced pictures with the expressions of a scene.
//!
//! ```text
//! attributes of faces, fields of pieces ──▶ TracedFunctions ──▶ text, the key of cached pipelines ──▶ Joined
//!                           └─▶ the numbers that each use reads: constants, and uniforms of the scene
//! ```
//!
//! Constants are numbers in buffers, like uniforms, so that editing one leaves the text unchanged; equal expressions share
//! one function.

use std::collections::{HashMap, HashSet};
use std::fmt::{self, Write};
use std::hash::{DefaultHasher, Hash, Hasher};

use expr::graph::Node;
use expr::statistics::operation_count;
use expr::{Graph, Input, NodeId};

use crate::contract;
use crate::emit::Body;
use crate::join::{InternalError, Joined, join};
use crate::library::{self, Piece};
use crate::ranges;

/// More operations of all functions of a scene are rejected: on ranges each of them takes many instructions.
pub const RANGE_OPERATION_LIMIT: usize = 2_000;
/// The maximum number of numbers in a list of attributes.
pub const MOST_ATTRIBUTES: usize = 16;

/// The functions that a scene's expressions need.
#[derive(Clone, Debug, Default)]
pub struct TracedFunctions {
    lists: Vec<String>,
    fields: Vec<String>,
    operations: usize,
}

/// A use of a function, with the numbers that it reads, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionUse {
    /// The index of the function among those of its kind.
    pub function: u32,
    /// The numbers that it reads.
    pub numbers: Vec<UsedNumber>,
}

/// A number that a generated function reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UsedNumber {
    /// A constant of the expression.
    Constant(f64),
    /// A uniform of the scene.
    Uniform(u32),
}

/// The functions of a scene have this many operations together, more than [`RANGE_OPERATION_LIMIT`].
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct TooManyOperations(pub usize);

impl fmt::Display for TooManyOperations {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} operations are too many for the shader of a traced picture (the limit is {RANGE_OPERATION_LIMIT})",
            self.0
        )
    }
}

impl std::error::Error for TooManyOperations {}

impl TracedFunctions {
    /// Adds the numbers of attributes as one function of the variables 0, 1, 2.
    ///
    /// # Errors
    /// If it is too large, alone or together with earlier ones.
    pub fn list(
        &mut self,
        graph: &Graph,
        roots: &[NodeId],
    ) -> Result<FunctionUse, TooManyOperations> {
        let lifted = Lifted::new(graph, roots);
        let body = lifted.body();
        let mut text = body.lets;
        for (k, root) in body.roots.iter().enumerate() {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "            store_attribute({k}u, {root});");
        }
        let sum = &mut self.operations;
        let function = known_or_new(&mut self.lists, text, sum, lifted.operations())?;
        Ok(lifted.used(function))
    }

    /// Adds the value of a field, which bounds a piece, as a function of the variables 0, 1, 2.
    ///
    /// # Errors
    /// If it is too large, alone or together with earlier ones.
    pub fn field(&mut self, graph: &Graph, root: NodeId) -> Result<FunctionUse, TooManyOperations> {
        let lifted = Lifted::new(graph, &[root]);
        let body = lifted.body();
        let text = format!("{}            return {};\n", body.lets, body.roots[0]);
        let sum = &mut self.operations;
        let function = known_or_new(&mut self.fields, text, sum, lifted.operations())?;
        Ok(lifted.used(function))
    }

    /// Returns the generated functions: equal texts are the same pass. Empty for a scene without expressions.
    pub fn text(&self) -> String {
        let mut text = String::new();
        if !self.lists.is_empty() {
            text.push_str(
                "fn list_attributes(list: u32, x: Range, y: Range, z: Range, instance: u32) {\n",
            );
            text.push_str(&switch("list", &self.lists));
            text.push_str("}\n");
        }
        if !self.fields.is_empty() {
            text.push_str("fn field_range(field: u32, x: Range, y: Range, z: Range, instance: u32) -> Range {\n");
            text.push_str(&switch("field", &self.fields));
            text.push_str("    return Range(everything(), everything());\n}\n");
        }
        text
    }
}

/// Joins the pass of traced pictures with the functions of this text.
///
/// # Errors
/// A fault of this program.
pub fn trace_scene(functions: &str) -> Result<Joined, InternalError> {
    let mut pieces = vec![library::LENS, library::OPTICS, library::LINE];
    let generated = Piece {
        origin: "generated",
        text: functions,
    };
    let (tables, varied, fields) = (
        library::PASS_TRACE_TABLES,
        library::PASS_TRACE_VARIED,
        library::PASS_TRACE_FIELDS,
    );
    contract::fulfils(&tables, &library::CONTRACT_UNIFORMS)?;
    contract::fulfils(&varied, &library::CONTRACT_VARIED)?;
    contract::fulfils(&varied, &library::CONTRACT_STORED)?;
    contract::fulfils(&fields, &library::CONTRACT_SEARCHED)?;
    let kinds = [
        (library::CONTRACT_LISTS, varied, library::CONTRACT_VARIED),
        (library::CONTRACT_FIELDS, fields, library::CONTRACT_SEARCHED),
    ];
    let mut asked = Vec::new();
    for (contract, written, stub) in kinds {
        let is_there = contract::fulfils(&generated, &contract).is_ok();
        pieces.push(if is_there { written } else { stub });
        asked.extend(is_there.then_some(contract));
    }
    if !functions.is_empty() {
        contract::is_exactly(&generated, &asked)?;
        pieces.extend([library::RANGE, generated]);
    }
    pieces.extend([
        tables,
        library::PASS_TRACE_CROSSINGS,
        library::PASS_TRACE_SCENE,
    ]);
    join(&pieces)
}

/// Returns the index of a text in a list, to which it is added if necessary.
fn known_or_new(
    texts: &mut Vec<String>,
    text: String,
    sum: &mut usize,
    operations: usize,
) -> Result<u32, TooManyOperations> {
    if let Some(known) = texts.iter().position(|known| *known == text) {
        return Ok(known as u32);
    }
    if *sum + operations > RANGE_OPERATION_LIMIT {
        return Err(TooManyOperations(*sum + operations));
    }
    *sum += operations;
    texts.push(text);
    Ok(texts.len() as u32 - 1)
}

/// Returns a `switch` that selects a body by a number.
fn switch(selector: &str, bodies: &[String]) -> String {
    let mut text = format!("    switch {selector} {{\n");
    for (k, body) in bodies.iter().enumerate() {
        // Writing to a String cannot fail.
        let _ = write!(text, "        case {k}u: {{\n{body}        }}\n");
    }
    text.push_str("        default: {\n        }\n    }\n");
    text
}

/// Expressions in which each use of a constant or a uniform is a separate uniform.
struct Lifted {
    graph: Graph,
    roots: Vec<NodeId>,
    numbers: Vec<UsedNumber>,
}

impl Lifted {
    fn new(graph: &Graph, roots: &[NodeId]) -> Self {
        let mut lifted = Self {
            graph: Graph::with_limit(graph.limit()),
            roots: Vec::new(),
            numbers: Vec::new(),
        };
        let mut copies: HashMap<NodeId, NodeId> = HashMap::new();
        for id in order_by_structure(graph, roots) {
            let mut copy = |operand: NodeId| lifted.copy(graph, &copies, operand);
            let made = match graph.node(id) {
                Node::Constant(_) | Node::Input(Input::Uniform(_)) => continue,
                Node::Input(input) => lifted.graph.input(input),
                Node::Unary(op, a) => {
                    let a = copy(a);
                    lifted.graph.unary(op, a)
                }
                Node::Binary(op, a, b) => {
                    let operands = [copy(a), copy(b)];
                    lifted.graph.binary(op, operands[0], operands[1])
                }
                Node::Power(a, n) => {
                    let base = copy(a);
                    lifted.graph.integer_power(base, n)
                }
            };
            copies.insert(id, made);
        }
        for &root in roots {
            let root = lifted.copy(graph, &copies, root);
            lifted.roots.push(root);
        }
        lifted
    }

    /// Returns the copy of a node. Each use of a number gets its own copy, since an edit may change only one of two equal
    /// constants.
    fn copy(&mut self, graph: &Graph, copies: &HashMap<NodeId, NodeId>, id: NodeId) -> NodeId {
        match graph.node(id) {
            Node::Constant(value) => self.number(UsedNumber::Constant(value)),
            Node::Input(Input::Uniform(k)) => self.number(UsedNumber::Uniform(k)),
            _ => copies[&id],
        }
    }

    /// Returns the text on ranges x, y, z.
    fn body(&self) -> Body {
        let input = |input: Input| match input {
            Input::Variable(0) => "x".to_owned(),
            Input::Variable(1) => "y".to_owned(),
            Input::Variable(_) => "z".to_owned(),
            Input::Uniform(slot) => format!("range_number(uniform_value(instance, {slot}u))"),
        };
        let number = |slot: u32| format!("uniform_value(instance, {slot}u)");
        ranges::body(&self.graph, &self.roots, &input, &number)
    }

    fn operations(&self) -> usize {
        operation_count(&self.graph, &self.roots)
    }

    /// Returns the use of the function with this index, with the numbers of these expressions.
    fn used(self, function: u32) -> FunctionUse {
        FunctionUse {
            function,
            numbers: self.numbers,
        }
    }

    /// Returns the input that stands for a number.
    fn number(&mut self, number: UsedNumber) -> NodeId {
        self.numbers.push(number);
        let slot = self.numbers.len() as u32 - 1;
        self.graph.input(Input::Uniform(slot))
    }
}

/// Returns the nodes that the roots need, operands before their uses, in an order that depends on the expressions alone. The
/// order of their ids depends on earlier expressions, and so does that of the operands of sums and products.
fn order_by_structure(graph: &Graph, roots: &[NodeId]) -> Vec<NodeId> {
    let mut structures: HashMap<NodeId, u64> = HashMap::new();
    for id in graph.order(roots) {
        let node = graph.node(id);
        let mut hasher = DefaultHasher::new();
        match node {
            Node::Constant(_) | Node::Input(Input::Uniform(_)) => 0.hash(&mut hasher),
            Node::Input(Input::Variable(k)) => (1, k).hash(&mut hasher),
            Node::Unary(op, _) => (2, op).hash(&mut hasher),
            Node::Binary(op, ..) => (3, op).hash(&mut hasher),
            Node::Power(_, n) => (4, n).hash(&mut hasher),
        }
        let mut operands: Vec<u64> = node
            .operands()
            .map(|operand| structures[&operand])
            .collect();
        operands.sort_unstable();
        operands.hash(&mut hasher);
        structures.insert(id, hasher.finish());
    }
    let mut order = Vec::with_capacity(structures.len());
    let mut seen = HashSet::new();
    let mut stack: Vec<(NodeId, bool)> = roots.iter().rev().map(|&root| (root, false)).collect();
    while let Some((id, is_ready)) = stack.pop() {
        if is_ready {
            order.push(id);
        } else if seen.insert(id) {
            stack.push((id, true));
            let mut operands: Vec<NodeId> = graph.node(id).operands().collect();
            operands.sort_by_key(|operand| structures[operand]);
            stack.extend(operands.iter().map(|&operand| (operand, false)));
        }
    }
    order
}
