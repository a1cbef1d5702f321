//! Expressions |u| − c: thin shells around the zeros of u.
//!
//! In: an expression of this form. Out: where a ray crosses the levels c and −c of u. The absolute value has a kink halfway
//! through the shell, but u has none: on a part where u is monotone, both levels are found without dividing it down to the
//! thickness of the shell.

use expr::interval::Slope;
use expr::ops::{Binary, Unary};
use expr::tape::Tape;
use expr::{Graph, Input, Node, NodeId};

use crate::field::bundle::PartKind;

/// The expression u with the level c > 0.
#[derive(Clone, Debug)]
pub(super) struct Shell {
    pub(super) inner: Tape,
    pub(super) level: f64,
}

/// The next level on a part where u is monotone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LevelCrossing {
    /// 1 for the level c, −1 for −c: the shell's value is `sign`·u − c there.
    pub(super) sign: f64,
    /// The values of sign·u − c at the ends of the part.
    pub(super) ends: [f64; 2],
}

impl Shell {
    /// Reads an expression; returns `None` if it does not have this form.
    pub(super) fn new(graph: &Graph, root: NodeId, uniform: &dyn Fn(Input) -> f64) -> Option<Self> {
        let Node::Binary(op, a, b) = graph.node(root) else {
            return None;
        };
        let number = |id: NodeId| match graph.node(id) {
            Node::Constant(value) => Some(value),
            Node::Input(input @ Input::Uniform(_)) => Some(uniform(input)),
            _ => None,
        };
        let inner = |id: NodeId| match graph.node(id) {
            Node::Unary(Unary::Abs, inner) => Some(inner),
            _ => None,
        };
        let (inner, level) = match op {
            Binary::Sub => (inner(a)?, number(b)?),
            Binary::Add => match inner(a) {
                Some(inner) => (inner, -number(b)?),
                None => (inner(b)?, -number(a)?),
            },
            _ => return None,
        };
        (level > 0.0 && level.is_finite()).then(|| Self {
            inner: Tape::new(graph, &[inner]),
            level,
        })
    }

    /// Returns the kind of a part, from the range of u on it; `None` if it is open.
    pub(super) fn kind(&self, range: Slope) -> Option<PartKind> {
        let value = range.value;
        let outside = value.lower() > self.level || value.upper() < -self.level;
        let inside = value.lower() >= -self.level && value.upper() <= self.level;
        if value.is_empty() || outside {
            Some(PartKind::Outside)
        } else if inside && !value.is_partial() {
            Some(PartKind::Inside)
        } else {
            range.is_monotone().then_some(PartKind::Monotone)
        }
    }

    /// Returns true if |u| is also defined and monotone where u has this range.
    pub(super) fn is_monotone(&self, range: Slope) -> bool {
        range.is_monotone() && !range.value.contains(0.0)
    }

    /// Returns the first level that u crosses between the ends of a monotone part; `inside` is the membership immediately
    /// after the first end.
    pub(super) fn crossing(&self, [a, b]: [f64; 2], inside: bool) -> Option<LevelCrossing> {
        let rises = b > a;
        // A rising u leaves at c and enters at −c.
        let sign = if rises == inside { 1.0 } else { -1.0 };
        let ends = [a, b].map(|u| sign * u - self.level);
        let crosses = if inside {
            ends[1] > 0.0
        } else {
            ends[0] > 0.0 && ends[1] <= 0.0
        };
        crosses.then_some(LevelCrossing { sign, ends })
    }
}
