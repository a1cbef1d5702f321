//! The graph of expressions: an arena of nodes in which equal expressions are one node.
//!
//! In: operations on nodes (their constructors are in `simplify.rs`). Out: handles, and for each handle the [`Node`]
//! that it names. Derivatives and substitution are in `rewrite.rs`.
//!
//! A graph never exceeds its limit. A constructor that finds it full returns an undefined constant instead and sets
//! [`Graph::overflowed`]; [`Graph::derivatives`] and [`Graph::substitute`] return [`TooLarge`] and leave the graph
//! unchanged. No function here is recursive: expressions may be as deep as the graph is large.

use rustc_hash::{FxBuildHasher, FxHashMap, FxHashSet};

use crate::ops::{Binary, Unary};

/// The handle of a node of a [`Graph`]. Operands have smaller ids than their uses, so ascending ids are an evaluation
/// order.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct NodeId(u32);

/// The source of a number in an expression.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub enum Input {
    /// A parameter of a function, curve or surface, by which derivatives are computed and for which an application
    /// substitutes. Numbered from 0 over the components of all parameters.
    Variable(u32),
    /// A number that is fixed while a picture is drawn: a component of a param or of a grid.
    Uniform(u32),
}

impl Input {
    /// Returns its value among those of the variables and the uniforms, by their numbers; NaN if it has none.
    pub fn value(self, variables: &[f64], uniforms: &[f64]) -> f64 {
        let value = match self {
            Self::Variable(k) => variables.get(k as usize),
            Self::Uniform(k) => uniforms.get(k as usize),
        };
        value.copied().unwrap_or(f64::NAN)
    }
}

/// One node: a leaf, or an operation on nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    /// A number; NaN where an expression of constants is undefined.
    Constant(f64),
    /// A number from outside the expression.
    Input(Input),
    /// An operation on one number.
    Unary(Unary, NodeId),
    /// An operation on two numbers.
    Binary(Binary, NodeId, NodeId),
    /// A power by [`crate::ops::integer_power`]. The exponents 0, 1, 2 and −1 do not occur: they are 1, x,
    /// x·x and 1/x.
    Power(NodeId, i32),
}

/// The operands of a node, from left to right.
#[derive(Clone, Debug)]
pub struct Operands([Option<NodeId>; 2]);

/// The expression has more than [`Graph::limit`] nodes, or requires too much work.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct TooLarge;

/// Hash-consed expressions: equal expressions have equal ids, and operands come before their uses.
#[derive(Clone, Debug)]
pub struct Graph {
    nodes: Vec<Node>,
    /// The inputs that each node may depend on.
    dependencies: Vec<InputSet>,
    ids: FxHashMap<Key, NodeId>,
    pub(crate) derivatives: FxHashMap<Input, FxHashMap<NodeId, NodeId>>,
    limit: usize,
    work: u64,
    overflowed: bool,
}

/// The default limit on the number of nodes of a graph: about 100 MB.
pub const DEFAULT_LIMIT: usize = 1_000_000;

/// The number of nodes that may be created or visited in total, per node that may be stored. It bounds the time of
/// rewriting even where its results are discarded.
const WORK_PER_NODE: u64 = 40;

/// The number of nodes that the body of a function usually has.
const USUAL_BODY: usize = 48;

/// A node by its bits, so that equality is exact: 0 and −0 are different constants, all NaN are the same.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
enum Key {
    Constant(u64),
    Input(Input),
    Unary(Unary, NodeId),
    Binary(Binary, NodeId, NodeId),
    Power(NodeId, i32),
}

/// A superset of a set of inputs: one bit for each of the first inputs of a kind, and one for all others of the kind.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) struct InputSet(u32);

/// A state of a graph that can be restored.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mark(usize);

impl Default for Graph {
    fn default() -> Self {
        Self::with_limit(DEFAULT_LIMIT)
    }
}

impl Graph {
    /// Creates an empty graph that stores at most `limit` nodes (at least one, and less than 2³²).
    pub fn with_limit(limit: usize) -> Self {
        Self {
            nodes: Vec::new(),
            dependencies: Vec::new(),
            ids: FxHashMap::default(),
            derivatives: FxHashMap::default(),
            limit: limit.clamp(1, u32::MAX as usize - 1),
            work: 0,
            overflowed: false,
        }
    }

    /// Returns the maximum number of nodes.
    pub fn limit(&self) -> usize {
        self.limit
    }

    /// Returns the number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Returns true if the graph has no nodes.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Returns true once a constructor has found the graph full: from then on some nodes are undefined constants in
    /// place of other nodes, and all rewriting returns [`TooLarge`].
    pub fn overflowed(&self) -> bool {
        self.overflowed
    }

    /// Returns a constant. All NaN are the same node.
    pub fn constant(&mut self, value: f64) -> NodeId {
        self.intern(Node::Constant(value))
    }

    /// Returns an input.
    pub fn input(&mut self, input: Input) -> NodeId {
        self.intern(Node::Input(input))
    }

    /// Returns the node that a handle names.
    ///
    /// # Panics
    /// May panic on a handle of another graph.
    pub fn node(&self, id: NodeId) -> Node {
        self.nodes[id.index()]
    }

    /// Returns the value of a node that is a constant.
    pub fn value(&self, node: NodeId) -> Option<f64> {
        match self.node(node) {
            Node::Constant(value) => Some(value),
            _ => None,
        }
    }

    /// Returns the inputs on which the roots depend, sorted.
    pub fn inputs(&self, roots: &[NodeId]) -> Vec<Input> {
        let read = roots.iter().fold(InputSet(0), |all, root| {
            InputSet(all.0 | self.dependencies(*root).0)
        });
        let mut inputs = read.known();
        if read.may_meet(InputSet::OTHERS) {
            let others =
                self.reachable(roots, |id| self.dependencies(id).may_meet(InputSet::OTHERS));
            inputs.extend(others.into_iter().filter_map(|id| match self.node(id) {
                Node::Input(input) => Some(input),
                _ => None,
            }));
        }
        inputs.sort_unstable();
        inputs
    }

    /// Returns the nodes that the roots need, including themselves, operands before their uses.
    pub fn order(&self, roots: &[NodeId]) -> Vec<NodeId> {
        self.reachable(roots, |_| true)
    }

    /// Returns a graph that contains only the nodes that the roots need, and the roots in it, in their order. It has
    /// the same limit.
    pub fn extract(&self, roots: &[NodeId]) -> (Graph, Vec<NodeId>) {
        let mut graph = Graph::with_limit(self.limit);
        let mut copies: FxHashMap<NodeId, NodeId> = FxHashMap::default();
        for id in self.order(roots) {
            // Ids keep their order, so a node in canonical form remains in it.
            let node = self.node(id).map(|operand| copies[&operand]);
            copies.insert(id, graph.intern(node));
        }
        (graph, roots.iter().map(|root| copies[root]).collect())
    }

    /// Returns the reachable nodes that `wanted` accepts (and that are reached through such nodes), in ascending order.
    pub(crate) fn reachable(
        &self,
        roots: &[NodeId],
        mut wanted: impl FnMut(NodeId) -> bool,
    ) -> Vec<NodeId> {
        // Room for a usual body, so that its thousands of uses do not grow a table step by step.
        let mut seen: FxHashSet<NodeId> =
            FxHashSet::with_capacity_and_hasher(USUAL_BODY, FxBuildHasher);
        let mut stack: Vec<NodeId> = Vec::with_capacity(USUAL_BODY);
        stack.extend_from_slice(roots);
        let mut order = Vec::with_capacity(USUAL_BODY);
        while let Some(id) = stack.pop() {
            if wanted(id) && seen.insert(id) {
                order.push(id);
                stack.extend(self.node(id).operands());
            }
        }
        order.sort_unstable();
        order
    }

    pub(crate) fn dependencies(&self, id: NodeId) -> InputSet {
        self.dependencies[id.index()]
    }

    /// Counts work.
    ///
    /// # Errors
    /// If it exceeds the limit, or the graph is already full.
    pub(crate) fn charge(&mut self, nodes: usize) -> Result<(), TooLarge> {
        self.work = self.work.saturating_add(nodes as u64);
        if self.overflowed || self.exhausted() {
            return Err(TooLarge);
        }
        Ok(())
    }

    pub(crate) fn mark(&self) -> Mark {
        Mark(self.nodes.len())
    }

    /// Removes all nodes created since the mark, and resets the overflow.
    pub(crate) fn roll_back(&mut self, mark: Mark) {
        for &node in &self.nodes[mark.0..] {
            self.ids.remove(&Key::new(node));
        }
        self.nodes.truncate(mark.0);
        self.dependencies.truncate(mark.0);
        // Derivatives refer to the removed nodes.
        self.derivatives.clear();
        self.overflowed = false;
    }

    /// Returns the handle of a node in canonical form, which only the constructors can create.
    pub(crate) fn intern(&mut self, node: Node) -> NodeId {
        let key = Key::new(node);
        if let Some(&id) = self.ids.get(&key) {
            return id;
        }
        if self.nodes.len() >= self.limit || self.exhausted() {
            self.overflowed = true;
            // One more than the limit: the constant that replaces all nodes beyond it.
            let undefined = Node::Constant(f64::NAN);
            return match self.ids.get(&Key::new(undefined)) {
                Some(&id) => id,
                None => self.push(undefined),
            };
        }
        self.work += 1;
        self.push(node)
    }

    fn push(&mut self, node: Node) -> NodeId {
        let id = NodeId(self.nodes.len() as u32);
        let dependencies = match node {
            Node::Input(input) => InputSet::of(input),
            node => node.operands().fold(InputSet(0), |all, operand| {
                InputSet(all.0 | self.dependencies(operand).0)
            }),
        };
        self.nodes.push(node);
        self.dependencies.push(dependencies);
        self.ids.insert(Key::new(node), id);
        id
    }

    fn exhausted(&self) -> bool {
        self.work > WORK_PER_NODE.saturating_mul(self.limit as u64)
    }
}

impl NodeId {
    /// Returns its index in the graph.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl Node {
    /// Returns the operands, from left to right; none for a leaf.
    pub fn operands(self) -> Operands {
        match self {
            Self::Constant(_) | Self::Input(_) => Operands([None, None]),
            Self::Unary(_, a) | Self::Power(a, _) => Operands([Some(a), None]),
            Self::Binary(_, a, b) => Operands([Some(a), Some(b)]),
        }
    }

    /// Returns true for operations, false for constants and inputs.
    pub(crate) fn is_operation(self) -> bool {
        !matches!(self, Self::Constant(_) | Self::Input(_))
    }

    fn map(self, to: impl Fn(NodeId) -> NodeId) -> Self {
        match self {
            Self::Constant(_) | Self::Input(_) => self,
            Self::Unary(op, a) => Self::Unary(op, to(a)),
            Self::Power(a, n) => Self::Power(to(a), n),
            Self::Binary(op, a, b) => Self::Binary(op, to(a), to(b)),
        }
    }
}

impl Iterator for Operands {
    type Item = NodeId;

    fn next(&mut self) -> Option<NodeId> {
        let [first, second] = self.0;
        self.0 = [second, None];
        first
    }
}

impl InputSet {
    /// The number of variables with their own bit. All others share the next bit.
    const VARIABLES: u32 = 23;
    /// The number of uniforms with their own bit.
    const UNIFORMS: u32 = 7;
    /// The bits that are shared by several inputs.
    const OTHERS: Self = Self(1 << Self::VARIABLES | 1 << (Self::VARIABLES + 1 + Self::UNIFORMS));

    pub(crate) fn of(input: Input) -> Self {
        Self(match input {
            Input::Variable(index) => 1 << index.min(Self::VARIABLES),
            Input::Uniform(index) => 1 << (Self::VARIABLES + 1 + index.min(Self::UNIFORMS)),
        })
    }

    /// Returns the inputs of the set that have their own bit.
    fn known(self) -> Vec<Input> {
        let variables = (0..Self::VARIABLES).map(Input::Variable);
        let uniforms = (0..Self::UNIFORMS).map(Input::Uniform);
        let all = variables.chain(uniforms);
        all.filter(|input| self.may_meet(Self::of(*input)))
            .collect()
    }

    pub(crate) fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Returns false only if the sets are disjoint.
    pub(crate) fn may_meet(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
}

impl Key {
    fn new(node: Node) -> Self {
        match node {
            Node::Constant(value) if value.is_nan() => Self::Constant(f64::NAN.to_bits()),
            Node::Constant(value) => Self::Constant(value.to_bits()),
            Node::Input(input) => Self::Input(input),
            Node::Unary(op, a) => Self::Unary(op, a),
            Node::Binary(op, a, b) => Self::Binary(op, a, b),
            Node::Power(a, n) => Self::Power(a, n),
        }
    }
}

impl std::fmt::Display for TooLarge {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("the expression, or a derivative of it, is too large")
    }
}

impl std::error::Error for TooLarge {}
