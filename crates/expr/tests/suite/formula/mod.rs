//! Formulas in x, y, z written with Rust's operators.
#![allow(dead_code, unreachable_pub)]

use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::rc::Rc;

use expr::ops::{Binary, Unary};
use expr::{Graph, Input, NodeId};

/// An expression of a graph that its operands share.
#[derive(Clone)]
pub struct Formula {
    graph: Rc<RefCell<Graph>>,
    node: NodeId,
}

/// x, y and z of a new graph.
pub fn variables() -> [Formula; 3] {
    let graph = Rc::new(RefCell::new(Graph::default()));
    [0, 1, 2].map(|k| {
        let node = graph.borrow_mut().input(Input::Variable(k));
        let graph = graph.clone();
        Formula { graph, node }
    })
}

impl Formula {
    pub fn node(&self) -> NodeId {
        self.node
    }

    pub fn graph(&self) -> std::cell::Ref<'_, Graph> {
        self.graph.borrow()
    }

    pub fn number(&self, value: f64) -> Self {
        let node = self.graph.borrow_mut().constant(value);
        self.with(node)
    }

    /// The uniform 0.
    pub fn uniform(&self) -> Self {
        let node = self.graph.borrow_mut().input(Input::Uniform(0));
        self.with(node)
    }

    pub fn unary(&self, op: Unary) -> Self {
        let node = self.graph.borrow_mut().unary(op, self.node);
        self.with(node)
    }

    pub fn binary(&self, op: Binary, other: &Self) -> Self {
        let node = self.graph.borrow_mut().binary(op, self.node, other.node);
        self.with(node)
    }

    pub fn powi(&self, n: i32) -> Self {
        let node = self.graph.borrow_mut().integer_power(self.node, n);
        self.with(node)
    }

    pub fn squared(&self) -> Self {
        self.powi(2)
    }

    pub fn sin(&self) -> Self {
        self.unary(Unary::Sin)
    }

    pub fn cos(&self) -> Self {
        self.unary(Unary::Cos)
    }

    pub fn exp(&self) -> Self {
        self.unary(Unary::Exp)
    }

    pub fn sqrt(&self) -> Self {
        self.unary(Unary::Sqrt)
    }

    pub fn abs(&self) -> Self {
        self.unary(Unary::Abs)
    }

    pub fn min(&self, other: &Self) -> Self {
        self.binary(Binary::Min, other)
    }

    pub fn max(&self, other: &Self) -> Self {
        self.binary(Binary::Max, other)
    }

    /// The derivative by a variable.
    pub fn derivative(&self, variable: u32) -> Self {
        let mut graph = self.graph.borrow_mut();
        let derivatives = graph.derivatives(&[self.node], Input::Variable(variable));
        let node = derivatives.map_or(self.node, |all| all[0]);
        drop(graph);
        self.with(node)
    }

    fn with(&self, node: NodeId) -> Self {
        Self {
            graph: self.graph.clone(),
            node,
        }
    }
}

macro_rules! operator {
    ($($trait:ident $function:ident $op:ident),+) => {$(
        impl $trait<&Formula> for &Formula {
            type Output = Formula;
            fn $function(self, other: &Formula) -> Formula {
                self.binary(Binary::$op, other)
            }
        }
        impl $trait<Formula> for Formula {
            type Output = Formula;
            fn $function(self, other: Formula) -> Formula {
                self.binary(Binary::$op, &other)
            }
        }
        impl $trait<&Formula> for Formula {
            type Output = Formula;
            fn $function(self, other: &Formula) -> Formula {
                self.binary(Binary::$op, other)
            }
        }
        impl $trait<Formula> for &Formula {
            type Output = Formula;
            fn $function(self, other: Formula) -> Formula {
                self.binary(Binary::$op, &other)
            }
        }
        impl $trait<f64> for Formula {
            type Output = Formula;
            fn $function(self, other: f64) -> Formula {
                self.binary(Binary::$op, &self.number(other))
            }
        }
        impl $trait<f64> for &Formula {
            type Output = Formula;
            fn $function(self, other: f64) -> Formula {
                self.binary(Binary::$op, &self.number(other))
            }
        }
        impl $trait<Formula> for f64 {
            type Output = Formula;
            fn $function(self, other: Formula) -> Formula {
                other.number(self).binary(Binary::$op, &other)
            }
        }
        impl $trait<&Formula> for f64 {
            type Output = Formula;
            fn $function(self, other: &Formula) -> Formula {
                other.number(self).binary(Binary::$op, other)
            }
        }
    )+};
}

operator!(Add add Add, Sub sub Sub, Mul mul Mul, Div div Div);

impl Neg for Formula {
    type Output = Formula;
    fn neg(self) -> Formula {
        self.unary(Unary::Neg)
    }
}
