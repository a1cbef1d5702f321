//! Expressions as text, for people and golden tests.

use std::fmt::Write;

use rustc_hash::FxHashMap;

use crate::graph::{Graph, Input, Node, NodeId};
use crate::number;

/// Returns the roots as a listing, one operation per line, shared subexpressions once: as long as the graph, whatever
/// its depth. Inputs are `v0`, `v1`, … and `k0`, `k1`, … (uniforms).
///
/// ```text
/// t0 = mul v0 v0
/// t1 = sin t0
/// (t1, v0)
/// ```
pub fn listing(graph: &Graph, roots: &[NodeId]) -> String {
    let mut names: FxHashMap<NodeId, String> = FxHashMap::default();
    let mut listing = String::new();
    let mut count = 0usize;
    for id in graph.order(roots) {
        let node = graph.node(id);
        let name = match leaf(node) {
            Some(name) => name,
            None => {
                let name = format!("t{count}");
                count += 1;
                let _ = write!(listing, "{name} = {}", head(node));
                for operand in node.operands() {
                    let _ = write!(listing, " {}", names[&operand]);
                }
                listing.push('\n');
                name
            }
        };
        names.insert(id, name);
    }
    let roots: Vec<&str> = roots.iter().map(|root| names[root].as_str()).collect();
    let _ = writeln!(listing, "({})", roots.join(", "));
    listing
}

/// Returns a root as one s-expression, `(add 1 (sin v0))`, with shared subexpressions repeated; cut off with `…` after
/// about `longest` bytes.
pub fn expression(graph: &Graph, root: NodeId, longest: usize) -> String {
    enum Task {
        Node(NodeId),
        Close,
    }
    let mut text = String::new();
    let mut stack = vec![Task::Node(root)];
    while let Some(step) = stack.pop() {
        let id = match step {
            Task::Node(id) => id,
            Task::Close => {
                text.push(')');
                continue;
            }
        };
        if text.len() > longest {
            text.push('…');
            break;
        }
        if !text.is_empty() {
            text.push(' ');
        }
        let node = graph.node(id);
        match leaf(node) {
            Some(name) => text.push_str(&name),
            None => {
                let _ = write!(text, "({}", head(node));
                stack.push(Task::Close);
                let operands: Vec<NodeId> = node.operands().collect();
                stack.extend(operands.into_iter().rev().map(Task::Node));
            }
        }
    }
    text
}

/// Returns the text of a constant or an input.
fn leaf(node: Node) -> Option<String> {
    match node {
        Node::Constant(value) => Some(number::text(value)),
        Node::Input(Input::Variable(index)) => Some(format!("v{index}")),
        Node::Input(Input::Uniform(index)) => Some(format!("k{index}")),
        _ => None,
    }
}

/// Returns an operation's name, with the exponent of a power.
fn head(node: Node) -> String {
    match node {
        Node::Unary(op, _) => op.name().to_owned(),
        Node::Binary(op, _, _) => op.name().to_owned(),
        Node::Power(_, n) => format!("power[{n}]"),
        Node::Constant(_) | Node::Input(_) => String::new(),
    }
}
