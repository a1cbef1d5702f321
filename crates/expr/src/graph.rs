//! The graph of expressions: nodes are made once, simplified as they are made, and never change.
//!
//! **Simplification never changes a value.** What a constructor folds, it folds with the same f64 operations
//! that evaluation uses; it drops `x + 0`, `x − 0`, `x·1`, `x/1`, `x^1`, `−(−x)` and orders the operands of `+` and
//! `·`, which commute exactly; it never reassociates. Three rules may turn a NaN or an infinity into a number
//! (and lose the sign of a zero): `0·x`, `0/x` and `x − x` are 0 even where x is infinite or undefined. Without them
//! no derivative would be sparse.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::ops::{Binary, Unary, as_integer_exponent, integer_power};

/// Names a node of a [`Graph`].
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct NodeId(pub(crate) u32);

impl NodeId {
    /// Its position in the graph: operands have smaller ones.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Where an expression takes a number from.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub enum Input {
    /// A parameter of a function, curve or surface: what derivatives are taken by and what an application
    /// substitutes. Numbered from 0 over the components of all parameters.
    Variable(u32),
    /// A number that is fixed while a picture is drawn: a component of a param or of a grid.
    Uniform(u32),
}

/// A node: an operation on nodes that came before.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Node {
    /// A constant, by the bits of its f64.
    Constant(u64),
    /// A number from outside.
    Input(Input),
    /// An operation on one number.
    Unary(Unary, NodeId),
    /// An operation on two.
    Binary(Binary, NodeId, NodeId),
    /// A power whose exponent is known: not 0 and not 1.
    IntegerPower(NodeId, i32),
}

impl Node {
    /// The nodes that it takes numbers from.
    pub fn operands(self) -> impl DoubleEndedIterator<Item = NodeId> {
        let (a, b) = match self {
            Self::Constant(_) | Self::Input(_) => (None, None),
            Self::Unary(_, a) | Self::IntegerPower(a, _) => (Some(a), None),
            Self::Binary(_, a, b) => (Some(a), Some(b)),
        };
        a.into_iter().chain(b)
    }
}

/// How many nodes a graph may have unless told otherwise.
pub const DEFAULT_LIMIT: usize = 1_000_000;

/// Hash-consed expressions: equal expressions have equal ids, and operands come before what uses them.
///
/// A full graph makes no further node: its constructors then return an arbitrary node and
/// [`Graph::overflowed`] says so; what was built since is to be dropped.
#[derive(Clone, Debug)]
pub struct Graph {
    nodes: Vec<Node>,
    ids: FxHashMap<Node, NodeId>,
    limit: usize,
    full: bool,
}

impl Default for Graph {
    fn default() -> Self {
        Self::with_limit(DEFAULT_LIMIT)
    }
}

/// The expression has grown past the limit of its graph.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct TooLarge;

impl std::fmt::Display for TooLarge {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("the expression is too large")
    }
}

impl std::error::Error for TooLarge {}

impl Graph {
    /// An empty graph that may hold up to `limit` nodes, at least 1.
    pub fn with_limit(limit: usize) -> Self {
        Self {
            nodes: Vec::new(),
            ids: FxHashMap::default(),
            limit: limit.clamp(1, u32::MAX as usize),
            full: false,
        }
    }

    /// How many nodes there are.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no node.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Whether a node could not be made since the graph was made or [`Graph::truncate`]d.
    pub fn overflowed(&self) -> bool {
        self.full
    }

    /// Drops every node from `len` on, and forgets that the graph was full.
    pub fn truncate(&mut self, len: usize) {
        for node in self.nodes.drain(len.min(self.nodes.len())..) {
            self.ids.remove(&node);
        }
        self.full = false;
    }

    /// The node itself.
    pub fn node(&self, id: NodeId) -> Node {
        self.nodes[id.index()]
    }

    /// The value of a node that is a constant.
    pub fn value(&self, node: NodeId) -> Option<f64> {
        match self.node(node) {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    fn intern(&mut self, node: Node) -> NodeId {
        if let Some(&id) = self.ids.get(&node) {
            return id;
        }
        if self.nodes.len() >= self.limit {
            self.full = true;
            return NodeId(0);
        }
        let id = NodeId(self.nodes.len() as u32);
        self.nodes.push(node);
        self.ids.insert(node, id);
        id
    }

    /// A constant. Every NaN is the same constant.
    pub fn constant(&mut self, value: f64) -> NodeId {
        let value = if value.is_nan() { f64::NAN } else { value };
        self.intern(Node::Constant(value.to_bits()))
    }

    /// An input.
    pub fn input(&mut self, input: Input) -> NodeId {
        self.intern(Node::Input(input))
    }

    /// An operation on one number.
    pub fn unary(&mut self, op: Unary, a: NodeId) -> NodeId {
        if let Some(a) = self.value(a) {
            return self.constant(op.eval(a));
        }
        match (op, self.node(a)) {
            (Unary::Negate, Node::Unary(Unary::Negate, inner)) => inner,
            (Unary::Abs, Node::Unary(Unary::Abs | Unary::Negate, inner)) => {
                self.intern(Node::Unary(Unary::Abs, inner))
            }
            _ => self.intern(Node::Unary(op, a)),
        }
    }

    /// An operation on two numbers.
    pub fn binary(&mut self, op: Binary, a: NodeId, b: NodeId) -> NodeId {
        let (known_a, known_b) = (self.value(a), self.value(b));
        if let (Some(a), Some(b)) = (known_a, known_b) {
            return self.constant(op.eval(a, b));
        }
        let is = |known: Option<f64>, value: f64| known == Some(value);
        match op {
            Binary::Add => {
                if is(known_a, 0.0) {
                    return b;
                }
                if is(known_b, 0.0) {
                    return a;
                }
                if let Node::Unary(Unary::Negate, b) = self.node(b) {
                    return self.binary(Binary::Subtract, a, b);
                }
                if let Node::Unary(Unary::Negate, a) = self.node(a) {
                    return self.binary(Binary::Subtract, b, a);
                }
            }
            Binary::Subtract => {
                if is(known_b, 0.0) {
                    return a;
                }
                if is(known_a, 0.0) {
                    return self.unary(Unary::Negate, b);
                }
                if a == b {
                    return self.constant(0.0);
                }
                if let Node::Unary(Unary::Negate, b) = self.node(b) {
                    return self.binary(Binary::Add, a, b);
                }
            }
            Binary::Multiply => {
                if is(known_a, 0.0) || is(known_b, 0.0) {
                    return self.constant(0.0);
                }
                if is(known_a, 1.0) {
                    return b;
                }
                if is(known_b, 1.0) {
                    return a;
                }
                if is(known_a, -1.0) {
                    return self.unary(Unary::Negate, b);
                }
                if is(known_b, -1.0) {
                    return self.unary(Unary::Negate, a);
                }
                if a == b {
                    return self.power_integer(a, 2);
                }
            }
            Binary::Divide => {
                if is(known_b, 1.0) {
                    return a;
                }
                if is(known_b, -1.0) {
                    return self.unary(Unary::Negate, a);
                }
                if is(known_a, 0.0) {
                    return self.constant(0.0);
                }
            }
            Binary::Power => {
                if let Some(n) = known_b.and_then(as_integer_exponent) {
                    return self.power_integer(a, n);
                }
            }
            Binary::AnnihilatingProduct => {
                if is(known_a, 0.0) {
                    return self.constant(0.0);
                }
                if known_a.is_some_and(|a| !a.is_nan()) {
                    return self.binary(Binary::Multiply, a, b);
                }
                if is(known_b, 0.0) || is(known_b, 1.0) {
                    return self.binary(Binary::Multiply, a, b);
                }
            }
        }
        let commutes = matches!(op, Binary::Add | Binary::Multiply);
        let (a, b) = if commutes && b < a { (b, a) } else { (a, b) };
        self.intern(Node::Binary(op, a, b))
    }

    /// `a^n` by [`integer_power`].
    pub fn power_integer(&mut self, a: NodeId, n: i32) -> NodeId {
        match (n, self.value(a)) {
            (0, _) => self.constant(1.0),
            (1, _) => a,
            (_, Some(a)) => self.constant(integer_power(a, n)),
            (2, None) => match self.node(a) {
                Node::Unary(Unary::Negate | Unary::Abs, inner) => {
                    self.intern(Node::IntegerPower(inner, 2))
                }
                _ => self.intern(Node::IntegerPower(a, 2)),
            },
            _ => self.intern(Node::IntegerPower(a, n)),
        }
    }

    /// a + b.
    pub fn add(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.binary(Binary::Add, a, b)
    }

    /// a − b.
    pub fn subtract(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.binary(Binary::Subtract, a, b)
    }

    /// a·b.
    pub fn multiply(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.binary(Binary::Multiply, a, b)
    }

    /// a / b.
    pub fn divide(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.binary(Binary::Divide, a, b)
    }

    /// −a.
    pub fn negate(&mut self, a: NodeId) -> NodeId {
        self.unary(Unary::Negate, a)
    }

    /// The nodes that the roots need, operands first. The work is in proportion to what is needed, not to the
    /// size of the graph.
    pub fn reachable(&self, roots: &[NodeId]) -> Vec<NodeId> {
        let mut seen: FxHashSet<NodeId> = FxHashSet::default();
        let mut stack = Vec::new();
        let mut order = Vec::new();
        for &root in roots {
            if seen.insert(root) {
                stack.push(root);
            }
            while let Some(id) = stack.pop() {
                order.push(id);
                for operand in self.node(id).operands() {
                    if seen.insert(operand) {
                        stack.push(operand);
                    }
                }
            }
        }
        order.sort_unstable();
        order
    }

    /// The inputs that the roots depend on, sorted.
    pub fn inputs(&self, roots: &[NodeId]) -> Vec<Input> {
        let mut inputs: Vec<Input> = self
            .reachable(roots)
            .into_iter()
            .filter_map(|id| match self.node(id) {
                Node::Input(input) => Some(input),
                _ => None,
            })
            .collect();
        inputs.sort_unstable();
        inputs
    }

    /// Replaces inputs, all at once.
    ///
    /// # Errors
    /// [`TooLarge`] where the graph is full.
    pub fn substitute(
        &mut self,
        roots: &[NodeId],
        replace: &dyn Fn(Input) -> Option<NodeId>,
    ) -> Result<Vec<NodeId>, TooLarge> {
        let order = self.reachable(roots);
        let mut images: FxHashMap<NodeId, NodeId> = FxHashMap::default();
        for id in order {
            let image = match self.node(id) {
                Node::Constant(_) => id,
                Node::Input(input) => replace(input).unwrap_or(id),
                Node::Unary(op, a) => self.unary(op, images[&a]),
                Node::Binary(op, a, b) => self.binary(op, images[&a], images[&b]),
                Node::IntegerPower(a, n) => self.power_integer(images[&a], n),
            };
            if self.full {
                return Err(TooLarge);
            }
            images.insert(id, image);
        }
        Ok(roots.iter().map(|root| images[root]).collect())
    }

    /// A graph that holds just what the roots need, and the roots in it.
    pub fn extract(&self, roots: &[NodeId]) -> (Graph, Vec<NodeId>) {
        let mut graph = Graph::with_limit(self.limit);
        let mut images: FxHashMap<NodeId, NodeId> = FxHashMap::default();
        for id in self.reachable(roots) {
            // Simplification has been done: nodes are copied as they are.
            let node = match self.node(id) {
                Node::Unary(op, a) => Node::Unary(op, images[&a]),
                Node::Binary(op, a, b) => {
                    let (a, b) = (images[&a], images[&b]);
                    let commutes = matches!(op, Binary::Add | Binary::Multiply);
                    if commutes && b < a {
                        Node::Binary(op, b, a)
                    } else {
                        Node::Binary(op, a, b)
                    }
                }
                Node::IntegerPower(a, n) => Node::IntegerPower(images[&a], n),
                leaf => leaf,
            };
            let image = graph.intern(node);
            images.insert(id, image);
        }
        let roots = roots.iter().map(|root| images[root]).collect();
        (graph, roots)
    }
}
