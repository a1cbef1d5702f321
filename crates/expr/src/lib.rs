//! Expressions: scalar nodes in a hash-consed graph.
//!
//! ```text
//! language values (numbers, tuples) ──value.rs──▶ scalar nodes, graph.rs ──derivative.rs──▶ exact derivatives
//!                                                      │
//!                                    ops.rs: one table of operations
//!                                                      │
//!                                     tape.rs (f64, blocks of lanes)   crate wgsl (text)
//! ```
//!
//! This crate knows no syntax and no GPU: the WGSL column of the table is text.

pub mod conformance;
mod derivative;
pub mod graph;
pub mod ops;
mod statistics;
pub mod tape;
pub mod text;
pub mod value;
pub use graph::{Graph, Input, NodeId};
