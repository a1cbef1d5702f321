//! Expressions and numbers as text.

use std::fmt::Write;

use crate::graph::{Graph, Input, Node, NodeId};

/// The longest text that [`Graph::text`] writes, in bytes; what is longer ends in `…`.
const TEXT_LIMIT: usize = 4096;

enum Step {
    Node(NodeId),
    Text(&'static str),
    Power(i32),
}

impl Graph {
    /// A node as a prefix expression, for golden tests and for looking at: `(add x0 (sin p1))`, where `x` are
    /// variables and `p` uniforms. Clipped past a few thousand characters.
    pub fn text(&self, root: NodeId) -> String {
        let mut out = String::new();
        let mut stack = vec![Step::Node(root)];
        while let Some(step) = stack.pop() {
            if out.len() > TEXT_LIMIT {
                out.push('…');
                break;
            }
            // Writing to a String cannot fail.
            let _ = match step {
                Step::Text(text) => write!(out, "{text}"),
                Step::Power(n) => write!(out, " {n})"),
                Step::Node(id) => match self.node(id) {
                    Node::Constant(bits) => write!(out, "{}", f64::from_bits(bits)),
                    Node::Input(Input::Variable(index)) => write!(out, "x{index}"),
                    Node::Input(Input::Uniform(index)) => write!(out, "p{index}"),
                    Node::Unary(op, a) => {
                        stack.extend([Step::Text(")"), Step::Node(a)]);
                        write!(out, "({} ", op.row().name)
                    }
                    Node::Binary(op, a, b) => {
                        stack.extend([
                            Step::Text(")"),
                            Step::Node(b),
                            Step::Text(" "),
                            Step::Node(a),
                        ]);
                        write!(out, "({} ", op.row().name)
                    }
                    Node::IntegerPower(a, n) => {
                        stack.extend([Step::Power(n), Step::Node(a)]);
                        write!(out, "(power ")
                    }
                },
            };
        }
        out
    }
}

/// A number as a WGSL literal: the shortest text that reads back as the nearest f32. What is beyond f32 becomes
/// the largest f32, as WGSL has no literal for an infinity; none for a NaN.
pub fn wgsl_literal(value: f64) -> Option<String> {
    if value.is_nan() {
        return None;
    }
    let value = (value as f32).clamp(f32::MIN, f32::MAX);
    Some(format!("{value:?}"))
}
