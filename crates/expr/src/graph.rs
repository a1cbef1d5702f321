//! The graph of expressions.

/// Names a node of a [`Graph`].
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct NodeId(u32);

/// Where an expression takes a number from.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub enum Input {
    /// A parameter of a function, curve or surface: what derivatives are taken by and what an application
    /// substitutes. Numbered from 0 over the components of all parameters.
    Variable(u32),
    /// A number that is fixed while a picture is drawn: a component of a param or of a grid.
    Uniform(u32),
}

/// Hash-consed expressions: equal expressions have equal ids, and operands come before what uses them.
#[derive(Clone, Debug, Default)]
pub struct Graph {}

/// The expression has grown past [`Graph::limit`] nodes.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct TooLarge;

impl Graph {
    /// A constant.
    pub fn constant(&mut self, value: f64) -> NodeId {
        let _ = value;
        todo!()
    }
    /// An input.
    pub fn input(&mut self, input: Input) -> NodeId {
        let _ = input;
        todo!()
    }
    /// The exact derivative of each root by `input`, all roots sharing their work.
    pub fn derivatives(&mut self, roots: &[NodeId], input: Input) -> Result<Vec<NodeId>, TooLarge> {
        let _ = (roots, input);
        todo!()
    }
    /// Replaces inputs, all at once.
    pub fn substitute(
        &mut self,
        roots: &[NodeId],
        replace: &dyn Fn(Input) -> Option<NodeId>,
    ) -> Result<Vec<NodeId>, TooLarge> {
        let _ = (roots, replace);
        todo!()
    }
    /// A graph that holds just what the roots need, and the roots in it.
    pub fn extract(&self, roots: &[NodeId]) -> (Graph, Vec<NodeId>) {
        let _ = roots;
        todo!()
    }
    /// The inputs that the roots depend on, sorted.
    pub fn inputs(&self, roots: &[NodeId]) -> Vec<Input> {
        let _ = roots;
        todo!()
    }
    /// The value of a node that is a constant.
    pub fn value(&self, node: NodeId) -> Option<f64> {
        let _ = node;
        todo!()
    }
}
