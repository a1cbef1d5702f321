//! Straight-line WGSL from expressions: shared subexpressions become a `let`, all others stay inline.

use std::collections::HashMap;
use std::fmt::Write;

use expr::graph::Node;
use expr::number::{LiteralError, wgsl_literal};
use expr::ops::Wgsl;
use expr::{Graph, Input, NodeId};

/// The depth of nesting at which a `let` breaks up an expression: parsers are recursive, so generated text must not be
/// deep.
const INLINE_DEPTH: u32 = 12;
/// The length at which a `let` breaks up an inline expression, for readability.
const INLINE_LENGTH: usize = 100;

/// The body of a function: `let` lines, and one expression for each root.
pub(crate) struct Body {
    /// The `let` lines, indented, each with its line end.
    pub(crate) lets: String,
    /// The expressions of the roots, in order.
    pub(crate) roots: Vec<String>,
}

/// The precedence of a text; an operand with a lower one is parenthesised.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
enum Binding {
    Sum,
    Product,
    Unary,
    Atom,
}

struct Text {
    text: String,
    binding: Binding,
    depth: u32,
}

/// Writes the roots' expressions. `input` returns the text of an input: an identifier or a call.
pub(crate) fn body(graph: &Graph, roots: &[NodeId], input: &dyn Fn(Input) -> String) -> Body {
    let uses = uses(graph, roots);
    let mut order: Vec<NodeId> = uses.keys().copied().collect();
    // Operands come before their uses, so ascending ids are an evaluation order.
    order.sort_unstable();
    let mut texts: HashMap<NodeId, Text> = HashMap::new();
    let mut lets = String::new();
    let mut names = 0usize;
    for node in order {
        let text = text(graph, node, input, &texts);
        let shared = uses[&node] > 1;
        let is_name = text.binding == Binding::Atom && !text.text.contains('(');
        let broken_up = text.depth >= INLINE_DEPTH || text.text.len() > INLINE_LENGTH;
        let text = if (shared && !is_name && graph.value(node).is_none()) || broken_up {
            let name = format!("t{names}");
            names += 1;
            // Writing to a String cannot fail.
            let _ = writeln!(lets, "    let {name} = {};", text.text);
            Text {
                text: name,
                binding: Binding::Atom,
                depth: 0,
            }
        } else {
            text
        };
        texts.insert(node, text);
    }
    let roots = roots.iter().map(|root| texts[root].text.clone()).collect();
    Body { lets, roots }
}

/// Returns the number of uses of each node that the roots need.
fn uses(graph: &Graph, roots: &[NodeId]) -> HashMap<NodeId, u32> {
    let mut uses: HashMap<NodeId, u32> = HashMap::new();
    let mut stack: Vec<NodeId> = roots.to_vec();
    while let Some(id) = stack.pop() {
        let count = uses.entry(id).or_insert(0);
        *count += 1;
        if *count > 1 {
            continue;
        }
        let node = graph.node(id);
        stack.extend(node.operands());
        if let Node::Power(base, n) = node
            && (3..=WRITTEN_OUT).contains(&n.unsigned_abs())
        {
            // Written as a product, the base appears more than once.
            stack.push(base);
        }
    }
    uses
}

/// Returns the text of one node, given the texts of its operands.
fn text(
    graph: &Graph,
    id: NodeId,
    input: &dyn Fn(Input) -> String,
    texts: &HashMap<NodeId, Text>,
) -> Text {
    let operand = |node: NodeId| &texts[&node];
    match graph.node(id) {
        Node::Constant(value) => Text::leaf(literal(value)),
        Node::Input(which) => Text::leaf(input(which)),
        Node::Unary(op, a) => written(op.wgsl(), &[operand(a)]),
        Node::Binary(op, a, b) => written(op.wgsl(), &[operand(a), operand(b)]),
        Node::Power(base, n) => integer_power(operand(base), n),
    }
}

impl Text {
    fn leaf(text: String) -> Self {
        let binding = if text.starts_with('-') {
            Binding::Unary
        } else {
            Binding::Atom
        };
        Self {
            text,
            binding,
            depth: 0,
        }
    }

    /// Returns the text, parenthesised unless its precedence is at least `binding`.
    fn at(&self, binding: Binding) -> String {
        if self.binding < binding {
            format!("({})", self.text)
        } else {
            self.text.clone()
        }
    }
}

/// Returns a constant. NaN and infinities have no literal: they are computed at run time.
fn literal(value: f64) -> String {
    match wgsl_literal(value) {
        Ok(text) => text,
        Err(LiteralError::Undefined) => "undefined()".to_owned(),
        Err(LiteralError::Infinite) => "infinite(1.0)".to_owned(),
        Err(LiteralError::MinusInfinite) => "infinite(-1.0)".to_owned(),
    }
}

/// Writes an operation as the table specifies. Nothing is reassociated: a right operand is parenthesised unless it
/// binds tighter than its operator, and so is a signed one; `--x` is never written.
fn written(wgsl: Wgsl, operands: &[&Text]) -> Text {
    let depth = operands
        .iter()
        .map(|operand| operand.depth)
        .max()
        .unwrap_or(0)
        + 1;
    let (text, binding) = match (wgsl, operands) {
        (Wgsl::Prefix(sign), [a, ..]) => (format!("{sign}{}", a.at(Binding::Atom)), Binding::Unary),
        (Wgsl::Infix(sign), [a, b, ..]) => {
            let binding = if matches!(sign, "*" | "/") {
                Binding::Product
            } else {
                Binding::Sum
            };
            let tighter = if binding == Binding::Sum && b.binding == Binding::Product {
                Binding::Product
            } else {
                Binding::Atom
            };
            (
                format!("{} {sign} {}", a.at(binding), b.at(tighter)),
                binding,
            )
        }
        (Wgsl::Builtin(name) | Wgsl::Library(name), operands) => {
            let operands: Vec<&str> = operands
                .iter()
                .map(|operand| operand.text.as_str())
                .collect();
            (format!("{name}({})", operands.join(", ")), Binding::Atom)
        }
        // The table has no operator for another number of operands.
        (Wgsl::Prefix(_) | Wgsl::Infix(_), _) => ("undefined()".to_owned(), Binding::Atom),
    };
    Text {
        text,
        binding,
        depth,
    }
}

/// Powers up to this one are written as products.
const WRITTEN_OUT: u32 = 4;

/// Writes a power with a known exponent: the same multiplications as `expr::ops::integer_power`.
fn integer_power(base: &Text, n: i32) -> Text {
    let depth = base.depth + 2;
    let x = base.at(Binding::Atom);
    let product = match n.unsigned_abs() {
        3 => format!("{x} * ({x} * {x})"),
        4 => format!("({x} * {x}) * ({x} * {x})"),
        _ => {
            let text = format!("integer_power({}, {n})", base.text);
            return Text {
                text,
                binding: Binding::Atom,
                depth,
            };
        }
    };
    let text = if n < 0 {
        format!("1.0 / ({product})")
    } else {
        product
    };
    Text {
        text,
        binding: Binding::Product,
        depth,
    }
}
