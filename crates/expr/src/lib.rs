//! Expressions: scalar nodes in a hash-consed graph.
//!
//! ```text
//! language values (numbers, tuples) ──value.rs──▶ scalar nodes ──rewrite.rs──▶ derivative, substitution
//!                                                      │
//!                  graph.rs (the arena), simplify.rs (its constructors), ops.rs (the one table of operations)
//!                                                      │
//!   jets.rs (with derivatives, lanes)   tape.rs (f64, blocks, intervals)   print.rs (text)   statistics.rs   crate wgsl (shaders)
//! ```
//!
//! `polynomial.rs` reads the set where an expression is not positive as a combination of polynomials.
//!
//! This crate knows no syntax and no GPU: the WGSL column of the table is text. Every evaluator of these expressions,
//! here or elsewhere, must satisfy the cases of [`conformance`]. `elementary.rs` and `processor.rs` speed up jets and
//! other loops over lanes.
//!
//! ```
//! use expr::tape::{Registers, Tape};
//! use expr::{Graph, Input};
//!
//! let mut graph = Graph::default();
//! let x = graph.input(Input::Variable(0));
//! let square = graph.mul(x, x);
//! let derivative = graph.derivatives(&[square], Input::Variable(0)).unwrap();
//! let tape = Tape::new(&graph, &derivative);
//! let mut out = [f64::NAN];
//! tape.eval(&mut Registers::default(), &[3.0], &mut out);
//! assert_eq!(out, [6.0]);
//! ```

mod arithmetic;
pub mod conformance;
mod continuity;
pub mod elementary;
pub mod graph;
pub mod interval;
pub mod jets;
pub mod number;
pub mod ops;
pub mod polynomial;
pub mod print;
pub mod processor;
mod rewrite;
mod simplify;
pub mod statistics;
pub mod tape;
pub mod value;
pub mod vectors;
pub use graph::{Graph, Input, Node, NodeId, TooLarge};
pub use value::{DimensionError, Value};
