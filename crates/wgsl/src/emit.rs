//! Straight-line WGSL from expressions: what is used more than once becomes a `let`, the rest stays inline.

use std::collections::HashMap;
use std::fmt::Write;

use expr::{Graph, Input, NodeId};

/// How deep expressions nest before a `let` breaks them up: parsers recurse, so generated text must not be deep.
const INLINE_DEPTH: u32 = 12;
/// How long an inline expression grows before a `let` breaks it up, for readers.
const INLINE_LENGTH: usize = 100;

/// The body of a function: `let` lines, and one expression for each root.
pub(crate) struct Body {
    /// Indented, each line ended.
    pub(crate) lets: String,
    /// The roots' values, in order.
    pub(crate) roots: Vec<String>,
}

/// How tightly a text binds; a looser operand stands in parentheses.
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

/// Writes the roots' expressions. `input` gives the text of an input: an identifier or a call.
pub(crate) fn body(graph: &Graph, roots: &[NodeId], input: &dyn Fn(Input) -> String) -> Body {
    let uses = uses(graph, roots);
    let mut order: Vec<NodeId> = uses.keys().copied().collect();
    // Operands come before what uses them, so ids in order are an order of evaluation.
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
            Text { text: name, binding: Binding::Atom, depth: 0 }
        } else {
            text
        };
        texts.insert(node, text);
    }
    let roots = roots.iter().map(|root| texts[root].text.clone()).collect();
    Body { lets, roots }
}

/// How many operations the roots need: every shared subexpression once, constants and inputs not counted.
pub(crate) fn operations(graph: &Graph, roots: &[NodeId]) -> usize {
    uses(graph, roots).keys().filter(|&&node| !operands(graph, node).is_empty()).count()
}

/// For each node that the roots need, how often it is used.
fn uses(graph: &Graph, roots: &[NodeId]) -> HashMap<NodeId, u32> {
    let mut uses: HashMap<NodeId, u32> = HashMap::new();
    let mut stack: Vec<NodeId> = roots.to_vec();
    while let Some(node) = stack.pop() {
        let count = uses.entry(node).or_insert(0);
        *count += 1;
        if *count == 1 {
            stack.extend(operands(graph, node));
        }
    }
    uses
}
fn operands(_: &Graph, _: NodeId) -> Vec<NodeId> { Vec::new() }
fn text(_: &Graph, _: NodeId, _: &dyn Fn(Input) -> String, _: &HashMap<NodeId, Text>) -> Text {
    Text { text: String::new(), binding: Binding::Sum, depth: 0 }
}
