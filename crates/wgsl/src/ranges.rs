//! Straight-line WGSL that evaluates expressions on ranges, with the functions of `lib/range.wgsl`.

use std::collections::HashMap;
use std::fmt::Write;

use expr::graph::Node;
use expr::number::wgsl_literal;
use expr::ops::Binary;
use expr::{Graph, Input, NodeId};

use crate::emit::Body;

/// Writes the roots' ranges. `input` returns the text of an input's range, `number` that of a uniform's number.
pub(crate) fn body(
    graph: &Graph,
    roots: &[NodeId],
    input: &dyn Fn(Input) -> String,
    number: &dyn Fn(u32) -> String,
) -> Body {
    let mut names: HashMap<NodeId, String> = HashMap::new();
    let mut lets = String::new();
    for (k, node) in graph.order(roots).into_iter().enumerate() {
        let name = |operand: NodeId| names[&operand].as_str();
        let text = match graph.node(node) {
            Node::Constant(value) => {
                // A number that is NaN or too large may be anything.
                let number = wgsl_literal(value).unwrap_or_else(|_| "3e38".to_owned());
                format!("range_number({number})")
            }
            Node::Input(which) => input(which),
            Node::Unary(op, a) => format!("range_{}({})", op.name(), name(a)),
            Node::Binary(Binary::Mul, a, b) if a == b => format!("range_square({})", name(a)),
            Node::Binary(Binary::Pow, a, b) => {
                let exact = match graph.node(b) {
                    Node::Input(Input::Uniform(k)) => number(k),
                    // Not an integer.
                    _ => "0.5".to_owned(),
                };
                format!("range_power({}, {}, {exact})", name(a), name(b))
            }
            Node::Binary(op, a, b) => format!("range_{}({}, {})", op.name(), name(a), name(b)),
            Node::Power(a, n) => format!("range_integer_power({}, {n})", name(a)),
        };
        let is_name = text.chars().all(char::is_alphanumeric);
        let text = if is_name {
            text
        } else {
            // Writing to a String cannot fail.
            let _ = writeln!(lets, "            let r{k} = {text};");
            format!("r{k}")
        };
        names.insert(node, text);
    }
    let roots = roots.iter().map(|root| names[root].clone()).collect();
    Body { lets, roots }
}
